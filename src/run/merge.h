/* SPDX-License-Identifier: Apache-2.0 */
/* Joining the shards of an experiment that were measured on several machines. */
#ifndef RT_RUN_MERGE_H
#define RT_RUN_MERGE_H

#include "run/run.h"

#define RT_MAX_SHARDS RT_MAX_WORKLOADS

/* Writes the result directory options->directory from the finished shards in directories[0..count), as one
 * run would have left it. Loads the experiment from the path in the shards, and initialises and fills the
 * results: rt_results_clear, also after a failure. `options`: as of rt_run_experiment; RT_START_ANEW:
 * previous results may be lost; RT_SCRIPTS_ALL: also gnuplot scripts that raytally does not ship are run,
 * although the shards, not the user, name the experiment's path.
 *
 * Rejects unfinished shards, shards of different experiments, variants or builds, and missing or duplicate
 * shards. Measures nothing. The contents of the directory are removed only after the joined journal, the
 * pictures and the scripts are on the disk. Otherwise as rt_run_experiment. */
RtStatus rt_merge(const char *const *directories, uint32_t count, const RtRunOptions *options,
                  RtExperiment *experiment, RtResults *results, RtError *error);

#endif
