/* SPDX-License-Identifier: Apache-2.0 */
/* Joining the shards of an experiment that were measured on several machines. */
#ifndef RT_REPORT_MERGE_H
#define RT_REPORT_MERGE_H

#include "report/result_directory.h"

#define RT_MAX_SHARDS RT_MAX_WORKLOADS

/* Writes the result directory `out` from the finished shards in directories[0..count), as one run that
 * measured all of it would have left it. Loads the experiment from where the shards say it lies, and
 * initialises and fills the results: rt_results_clear, also after a failure. `start`: whether results in
 * `out` may be lost (RT_START_ANEW). `trust`: whether gnuplot scripts are run, too, that raytally does not
 * ship: the shards say where the experiment lies, and so which scripts are its own.
 *
 * Refuses what is no finished shard, shards of different experiments, variants or builds, and one that is
 * missing or there twice. Nothing is measured. What lies in `out` is removed only once the joined journal,
 * the pictures and the scripts are whole on its disk. As rt_run_experiment otherwise. */
RtStatus rt_merge(const char *const *directories, uint32_t count, const char *out, RtStart start, bool trust,
                  RtExperiment *experiment, RtResults *results, const RtRunObserver *observer,
                  RtError *error);

#endif
