/* SPDX-License-Identifier: Apache-2.0 */
/* An experiment as the manifest of its results has it: for those who read results, where the accelerators
 * need not be there, or may be others by now (of a plugin that is not loaded, or was changed; settings of a
 * library on another machine). */
#ifndef RT_EXPERIMENT_MANIFEST_EXPERIMENT_H
#define RT_EXPERIMENT_MANIFEST_EXPERIMENT_H

#include "experiment/experiment.h"

#include <jansson.h>

/* The label of the baseline, or NULL. */
const char *rt_manifest_baseline(const json_t *manifest);

/* Spec and label of accelerator number `i` to *candidate; false where there are no more. */
bool rt_manifest_candidate(const json_t *manifest, uint32_t i, RtCandidate *candidate);

/* Whether the build that ran it lacked accelerator number `i`. */
bool rt_manifest_is_missing(const json_t *manifest, uint32_t i);

/* Whether every value that parameter `key` of the accelerator `owner` has in it is a whole number, as those
 * of a parameter that takes no other are. */
bool rt_manifest_is_whole(const json_t *manifest, const char *owner, const char *key);

#endif
