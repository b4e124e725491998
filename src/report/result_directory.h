/* SPDX-License-Identifier: Apache-2.0 */
/* Result directories: running an experiment into one, and loading one.
 *
 *   cells.jsonl      the journal: everything that is found, a line each, written as soon as it is found
 *   counts.csv       exact columns; byte-identical wherever the same version is run
 *   times.csv        measured columns, where anything is timed
 *   rounds.csv       the times of every round, of which times.csv is made
 *   hardware.csv     hardware counters per ray, where the experiment asks for them
 *   distributions.csv, histograms.csv
 *                    how counts are distributed, where the experiment asks for it; exact, too
 *   images/          a picture of each scene
 *   experiment.yaml  a copy of what was run
 *   manifest.json    with what it was run: seed, fingerprints, version, compiler, machine, date
 *   published.csv, best.csv, published.md
 *                    published figures beside measured ones, where the experiment names any; exact, too
 *   published/       or what folder they come from: copies of the published tables
 *   plots/           the scripts and what they drew
 *   tables.md, tables.tex, report.html
 *                    all of it to be read */
#ifndef RT_REPORT_RESULT_DIRECTORY_H
#define RT_REPORT_RESULT_DIRECTORY_H

#include "experiment/workload.h"
#include "measure/previous_results.h"
#include "report/scripts.h"

typedef struct RtRunOptions {
    const char *directory; /* created where missing */
    RtStart start;         /* what becomes of the results of a previous run in it */
    bool renew; /* of a run that is resumed, cells of plugins that have changed since are measured again */
    uint32_t joined; /* the journal that is resumed was joined from those of so many shards; else 0 */
    RtScripts scripts;
    RtWorkloadOptions workload; /* its observer is told after the journal */
} RtRunOptions;

/* Runs what is not yet known, and writes everything. `results` is initialised for the experiment, and filled.
 *
 * No other process writes into the directory meanwhile. All that may be refused is looked at, and every scene
 * opened, before anything of a previous run is removed. Whenever the process ends, either the previous run is
 * whole or this one can be resumed.
 *
 * Without gnuplot there is a notice, and a report without plots. RT_MISMATCH, with everything written, where
 * gnuplot fails, or published figures are missed (rt_published_check). */
RtStatus rt_run_experiment(RtResults *results, const RtRunOptions *options, RtError *error);

/* Loads experiment and results of a result directory, whose accelerators need not be here. `results` is
 * initialised here: rt_results_clear. */
RtStatus rt_run_load(const char *directory, RtExperiment *experiment, RtResults *results, RtError *error);

#endif
