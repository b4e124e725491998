/* SPDX-License-Identifier: Apache-2.0 */
/* One line of a journal: what an event added to the results. */
#ifndef RT_RESULTS_JOURNAL_LINES_H
#define RT_RESULTS_JOURNAL_LINES_H

#include "results/journal.h"
#include "results/record.h"

/* The line of an event: a new reference, NULL if memory is short. */
json_t *rt_journal_line(const RtResults *results, const RtEvent *event);

/* Fills the results with what the line says. Ignores scenes and accelerators that the experiment does not
 * have. */
void rt_journal_line_take(RtRecordReader *reader, RtResults *results, const json_t *line);

/* Whether a line is about a candidate that has a layer of one of `plugins` (experiment/plugins_used.h). */
bool rt_journal_line_concerns(const json_t *line, const RtExperiment *experiment, const json_t *plugins);

/* The ray set of each kind in an RtWorkloadResult: how many rays it has, and had before the limit, and its
 * hash. */
extern const RtRecord rt_ray_set_records[RT_RAY_KIND_COUNT];

#endif
