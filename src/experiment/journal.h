/* SPDX-License-Identifier: Apache-2.0 */
/* The journal of a run: one JSON object a line for everything found, on the disk before the next is measured.
 * It is what an interrupted run resumes from, and what the tables and the report are made of.
 *
 * The first line names the experiment (the fingerprint of its YAML), whether it is the quick variant, the
 * build, and the plugins that the experiment uses; a journal of another experiment or build is refused. A
 * last line that was cut off is passed over; any other that no journal has is refused by its number. */
#ifndef RT_EXPERIMENT_JOURNAL_H
#define RT_EXPERIMENT_JOURNAL_H

#include "core/text/json_lines.h"
#include "experiment/workload.h"

/* Opens the journal at `path` for appending: with `resume` the one that is there, else a new one that takes
 * its place, which says of which shard it is (`only`). Close with rt_json_lines_close, also after a failure.
 */
RtStatus rt_journal_open(RtJsonLines *journal, const char *path, const RtExperiment *experiment,
                         const RtOnly *only, bool resume, RtError *error);

/* Adds a whole journal to files that change together: a header as above, and then these lines, borrowed. */
RtStatus rt_journal_add(RtOutputs *outputs, const char *path, const RtExperiment *experiment,
                        const RtOnly *only, const json_t *lines, RtError *error);

/* Writes down what the event says is known now. */
RtStatus rt_journal_append(RtJsonLines *journal, const RtResults *results, const RtEvent *event,
                           RtError *error);

/* Fills `results` with all that the journal at `path` knows. Refuses one of another experiment; with `only`,
 * that is to be gone on with, one of another build, another shard, or another build of a plugin that the
 * experiment uses. Of the last, `renew` takes all lines but those about what the plugin does, unless ratios
 * refer to that. One that says that its results are given up (previous_results.h) knows nothing. */
RtStatus rt_journal_load(const char *path, RtResults *results, const RtOnly *only, bool renew,
                         RtError *error);

/* Writes the journal at `path`, which was loaded with `renew`, anew: of what is loaded now, and without the
 * lines that were passed over. Whatever happens, the one before it or this one is whole. */
RtStatus rt_journal_renew(const char *path, const RtExperiment *experiment, const RtOnly *only,
                          RtError *error);

#endif
