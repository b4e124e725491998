/* SPDX-License-Identifier: Apache-2.0 */
/* Result directories: running an experiment into one, and loading one.
 *
 *   cells.jsonl      the journal: a line for each measurement, written at once
 *   counts.csv       exact columns; byte-identical on every machine
 *   times.csv        measured columns, if anything is timed
 *   rounds.csv       the times of every round, the source of times.csv
 *   hardware.csv     hardware counters per ray, if the experiment has them
 *   distributions.csv, histograms.csv
 *                    distributions of counts, if the experiment has them; exact
 *   images/          a picture of each scene
 *   experiment.yaml  a copy of the experiment
 *   manifest.json    seed, fingerprints, version, compiler, machine, date
 *   published.csv, best.csv, published.md
 *                    published figures beside measured ones (experiments/published)
 *   plots/           plots, and the scripts that raytally does not ship
 *   tables.md, tables.tex, report.html
 *                    the results to read */
#ifndef RT_EXPERIMENT_RESULT_DIRECTORY_H
#define RT_EXPERIMENT_RESULT_DIRECTORY_H

#include "experiment/scripts.h"
#include "experiment/workload.h"
#include "measure/result_files.h"

/* When a file is written, and whether its bytes are reproducible. */
typedef enum RtFileSort {
    RT_FILE_OTHER,    /* none of these */
    RT_FILE_MEASURED, /* written as cells are measured; depends on times */
    RT_FILE_COUNTED   /* written as cells are measured; byte-identical on every machine */
} RtFileSort;

/* RT_FILE_OTHER also if the experiment has no such file. */
RtFileSort rt_result_file_sort(const RtExperiment *experiment, RtResultFile file);

/* A file of RT_FILE_MEASURED or RT_FILE_COUNTED. */
void rt_result_csv_write(RtResultFile file, const RtResults *results, FILE *out);

/* Writes what else is made from the results of a finished run (report/report.h) into the directory, which is
 * locked and has its manifest; draws plots with the allowed scripts. */
typedef RtStatus RtRunReport(const RtResults *results, const char *directory, RtScripts scripts,
                             const RtRunObserver *observer, RtError *error);

/* Results that were measured in shards, and are joined in a directory: experiment/merge.h. */
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
    bool renew;            /* when resuming, measure cells of changed plugins again */
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

/* The picture of a workload's scene in a result directory. */
RtStatus rt_run_image_path(const char *directory, const RtExperiment *experiment, uint32_t workload,
                           char *path, RtError *error);

/* Loads experiment and results of a result directory; this build may lack its accelerators. Initialises
 * `results`: rt_results_clear. */
RtStatus rt_run_load(const char *directory, RtExperiment *experiment, RtResults *results, RtError *error);

#endif
