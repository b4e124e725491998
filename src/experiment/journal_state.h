/* SPDX-License-Identifier: Apache-2.0 */
/* What writing and reading a journal share. */
#ifndef RT_EXPERIMENT_JOURNAL_STATE_H
#define RT_EXPERIMENT_JOURNAL_STATE_H

#include "experiment/results.h"

#include <jansson.h>

/* The members in which the times of rounds are. */
extern const char *const rt_journal_each_names[RT_EACH_COUNT];

/* Whether a line is about a candidate that has a layer of one of `plugins` (experiment/plugins_used.h). */
bool rt_journal_line_concerns(const json_t *line, const RtExperiment *experiment, const json_t *plugins);

#endif
