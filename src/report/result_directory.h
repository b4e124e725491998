/* SPDX-License-Identifier: Apache-2.0 */
/* Running an experiment into a result directory, and working on one that is there. Besides what a run keeps
 * (experiment/run.h) it has:
 *
 *   experiment.yaml  a copy of what was run
 *   manifest.json    with what it was run: seed, fingerprints, version, compiler, machine, date
 *   published.csv, best.csv, published.md
 *                    published figures beside measured ones, where the experiment names any; exact, too
 *   published/       or what folder they come from: copies of the published tables
 *   plots/           the scripts and what they drew
 *   report.html      all of it in one page */
#ifndef RT_REPORT_RESULT_DIRECTORY_H
#define RT_REPORT_RESULT_DIRECTORY_H

#include "experiment/run.h"
#include "literature/published.h"

/* Runs what is not yet known, and writes everything. `results` is initialised for the experiment, and filled.
 *
 * No other process writes into the directory meanwhile. What an earlier run has left there is touched only
 * once all that may be refused has been looked at, every scene been opened: each once, to be kept until its
 * workload is over. Whenever the process ends, either the earlier run is whole or this one can be resumed.
 *
 * Without gnuplot there is a notice, and a report without plots. RT_MISMATCH, with everything written, where
 * gnuplot fails, or published figures are missed (rt_published_check). */
RtStatus rt_run_experiment(RtResults *results, const RtRunOptions *options, RtError *error);

/* Loads experiment and results of a result directory, whose accelerators need not be here. `results` is
 * initialised here: rt_results_clear. */
RtStatus rt_run_load(const char *directory, RtExperiment *experiment, RtResults *results, RtError *error);

/* The files that are byte-identical wherever they are made, from what was found. */
typedef struct RtExactFile {
    const char *name;
    bool (*is_wanted)(const RtExperiment *experiment);
    void (*write)(const RtResults *results, const RtPublished *published, FILE *out);
} RtExactFile;

#define RT_EXACT_FILES 6
extern const RtExactFile rt_exact_files[RT_EXACT_FILES];

#endif
