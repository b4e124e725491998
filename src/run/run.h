/* SPDX-License-Identifier: Apache-2.0 */
/* Runs: an experiment measured into a result directory (results/result_directory.h). */
#ifndef RT_RUN_RUN_H
#define RT_RUN_RUN_H

#include "experiment/scripts.h"
#include "measure/result_files.h"
#include "run/workload.h"

/* Writes what else is made from the results of a finished run (report/report.h) into the directory, which is
 * locked and has its manifest; draws plots with the allowed scripts. */
typedef RtStatus RtRunReport(const RtResults *results, const char *directory, RtScripts scripts,
                             const RtRunObserver *observer, RtError *error);

/* Results that were measured in shards, and are joined in a directory: run/merge.h. */
typedef struct RtRunJoin {
    uint32_t shards;
    const void *context;
    /* Adds their journal and pictures to the files of the directory. */
    RtStatus (*add)(const void *context, const RtExperiment *experiment, const char *directory,
                    RtOutputs *files, RtError *error);
} RtRunJoin;

typedef struct RtRunOptions {
    const char *directory; /* created if missing */
    RtStart start;         /* what happens to the results of a previous run */
    RtScripts scripts;
    const RtRunJoin *join;      /* or NULL; with it, `start` does not resume */
    RtRunReport *report;        /* or NULL */
    RtWorkloadOptions workload; /* its observer is called after the journal */
} RtRunOptions;

/* Measures what is missing, and writes everything. `results` is initialised for the experiment, and filled.
 *
 * The directory is locked meanwhile. Every check is made, and every scene opened, before anything of a
 * previous run is removed. Whenever the process ends, either the previous run is whole or this one can be
 * resumed. */
RtStatus rt_run_experiment(RtResults *results, const RtRunOptions *options, RtError *error);

#endif
