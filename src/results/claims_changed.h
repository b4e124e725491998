/* SPDX-License-Identifier: Apache-2.0 */
/* Claims that are not those with which a run began: they may be edited afterwards, but not in secret.
 * Readouts claim nothing, and may come and go. */
#ifndef RT_RESULTS_CLAIMS_CHANGED_H
#define RT_RESULTS_CLAIMS_CHANGED_H

#include "experiment/claim.h"
#include "results/results.h"

#define RT_CLAIM_LATER "stated after the run began"

/* The texts of all claims, readouts too: a new reference, NULL if memory is short. */
json_t *rt_claims_json(const RtExperiment *experiment);

/* Whether claim number `i` was not there when the run began. False if that is unknown, as in runs of version
 * 1.0. */
bool rt_claim_is_later(const RtResults *results, uint32_t i);

/* Calls visit(context, claim) with each claim that was there when the run began and is not any more; returns
 * their number. */
uint32_t rt_claims_dropped(const RtResults *results, void (*visit)(void *context, const char *claim),
                           void *context);

/* Whether any claim is later or dropped. */
bool rt_claims_are_changed(const RtResults *results);

#endif
