/* SPDX-License-Identifier: Apache-2.0 */
/* The journal of a run: a line of JSON for each measurement, on the disk before the next one starts.
 * Interrupted runs resume from it; the tables and the report are made from it.
 *
 * The first line names the experiment (the fingerprint of its YAML), the variant (quick or not), the build,
 * and the plugins that the experiment uses. A journal of another experiment or build is rejected. A truncated
 * last line is ignored; any other invalid line is rejected by its number. */
#ifndef RT_RESULTS_JOURNAL_H
#define RT_RESULTS_JOURNAL_H

#include "core/text/json_lines.h"
#include "experiment/experiment.h"
#include "results/events.h"

/* Opens the journal at `path` for appending: with `resume` the existing one, else a new one, which records
 * its shard (`only`). Close with rt_json_lines_close, also after a failure. */
RtStatus rt_journal_open(RtJsonLines *journal, const char *path, const RtExperiment *experiment,
                         const RtSelection *only, bool resume, RtError *error);

/* Adds a whole journal to files that are replaced together: a header as above, then `lines`, borrowed. */
RtStatus rt_journal_add(RtOutputs *outputs, const char *path, const RtExperiment *experiment,
                        const RtSelection *only, const json_t *lines, RtError *error);

/* Fills `results` from the journal at `path`. Rejects a journal of another experiment; with `only`, to resume
 * it, also of another build or another shard. A plugin of the experiment that has changed loses its lines; if
 * it is the baseline, the journal is rejected. A journal whose results are given up (measure/result_files.h)
 * is empty. */
RtStatus rt_journal_load(const char *path, RtResults *results, const RtSelection *only, RtError *error);

/* Rewrites the journal at `path`, which was loaded, without the lines of changed plugins, and says which they
 * are; if none has changed, it stays. At any time the old or the new journal is whole. */
RtStatus rt_journal_drop_changed(const char *path, const RtExperiment *experiment, const RtSelection *only,
                                 const RtRunObserver *observer, RtError *error);

#endif
