/* SPDX-License-Identifier: Apache-2.0 */
/* Runs: an experiment measured into a result directory (results/result_directory.h); and the shards of one,
 * measured on several machines, joined. */
#ifndef RT_RUN_RUN_H
#define RT_RUN_RUN_H

#include "experiment/scripts.h"
#include "measure/result_files.h"
#include "run/workload.h"

/* Writes what else is made from the results of a finished run (report/report.h) into the directory, which is
 * locked and has its manifest; draws plots with the allowed scripts. */
typedef RtStatus RtRunReport(const RtResults *results, const char *directory, RtScripts scripts,
                             const RtRunObserver *observer, RtError *error);

typedef struct RtRunOptions {
    const char *directory; /* created if missing */
    RtStart start;         /* what happens to the results of a previous run */
    RtScripts scripts;
    RtRunReport *report;        /* or NULL */
    RtWorkloadOptions workload; /* its observer is called after the journal */
} RtRunOptions;

/* Measures what is missing, and writes everything. `results` is initialised for the experiment, and filled.
 *
 * The directory is locked meanwhile. Every check is made, and every scene opened, before anything of a
 * previous run is removed. Whenever the process ends, either the previous run is whole or this one can be
 * resumed. */
RtStatus rt_run_experiment(RtResults *results, const RtRunOptions *options, RtError *error);

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
