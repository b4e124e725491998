/* SPDX-License-Identifier: Apache-2.0 */
/* A run of an experiment: what is not yet known is measured, and kept as it is found.
 *
 *   cells.jsonl      the journal: everything found, line by line as it was found
 *   counts.csv       exact columns; byte-identical wherever the same version is run
 *   times.csv        measured columns, where anything is timed
 *   rounds.csv       every round's times, of which those are made
 *   hardware.csv     what the machine did for a ray, where the experiment asks for that
 *   distributions.csv, histograms.csv
 *                    how counts are distributed, where the experiment asks for that; exact, too
 *   images/          a picture of each scene
 *
 * rt_run_open looks, rt_run_begin makes the directory and keeps others away, rt_run_replace removes what an
 * earlier run has left, rt_run_measure begins the journal and does the work. All that may fail is to be tried
 * before anything is removed. Whenever the process ends, either the earlier run is whole or this one can be
 * resumed. */
#ifndef RT_EXPERIMENT_RUN_H
#define RT_EXPERIMENT_RUN_H

#include "core/base/lock.h"
#include "core/text/json_lines.h"
#include "core/text/table.h"
#include "experiment/workload.h"
#include "measure/previous_results.h"

/* Which gnuplot scripts are run (report/scripts.h). */
typedef enum RtScripts {
    RT_SCRIPTS_SHIPPED, /* those that raytally ships */
    RT_SCRIPTS_OWN,     /* also those beside the experiment */
    RT_SCRIPTS_ALL
} RtScripts;

typedef struct RtRunOptions {
    const char *directory; /* created where missing */
    RtStart start;         /* what becomes of what an earlier run in it has found */
    bool renew;      /* of one that is resumed, what plugins did that have changed since is measured again */
    uint32_t joined; /* the journal that is resumed was joined from those of so many shards; else 0 */
    RtScripts scripts;
    RtWorkloadOptions workload; /* its observer is told after the journal */
} RtRunOptions;

typedef struct RtRun {
    RtResults *results;             /* borrowed, like what follows */
    const RtExperiment *experiment; /* that of the results */
    const RtRunOptions *options;
    RtLock lock;
    bool resumed;                     /* the directory has the journal that is gone on with */
    bool measured;                    /* anything that the journal did not know */
    RtScene scenes[RT_MAX_WORKLOADS]; /* each until its last workload is over */
    bool opened[RT_MAX_WORKLOADS];
    RtJsonLines journal;
} RtRun;

/* Takes the directory where it is there, and the journal in it, and opens every scene that is needed, once.
 * `results` is initialised for the experiment. To be closed by rt_run_close, also after a failure. */
RtStatus rt_run_open(RtRun *run, RtResults *results, const RtRunOptions *options, RtError *error);

/* Makes the directory with plots/ and images/ in it, and removes temporary files of a run that was killed. */
RtStatus rt_run_begin(RtRun *run, RtError *error);

/* Removes the results of an earlier run, unless they are gone on with. */
RtStatus rt_run_replace(RtRun *run, RtError *error);

/* Begins the journal, or goes on with it, and fills the results. */
RtStatus rt_run_measure(RtRun *run, RtError *error);

/* Whether nothing is left to measure, of which `only` may leave much. */
bool rt_run_is_complete(const RtRun *run);

void rt_run_close(RtRun *run);

/* For those who add to the directory: a path in it, a CSV file in it, and a word to whoever looks on. */
RtStatus rt_run_path(const RtRun *run, const char *name, char *path, RtError *error);
RtStatus rt_run_write_table(const RtRun *run, const char *name, const RtTable *table, RtError *error);
void rt_run_notice(const RtRun *run, const char *message);

#endif
