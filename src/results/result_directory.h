/* SPDX-License-Identifier: Apache-2.0 */
/* Result directories: their files, and loading one.
 *
 *   cells.jsonl      the journal: a line for each measurement, written at once
 *   counts.csv       exact columns; byte-identical on every machine
 *   times.csv        measured columns, if anything is timed
 *   rounds.csv       the times of every round, the source of times.csv
 *   distributions.csv, histograms.csv
 *                    distributions of counts, if the experiment has them; exact
 *   frame.csv, render.csv
 *                    frames as sums of their rays, and rendered ones, if the experiment has them
 *   images/          a picture of each scene
 *   experiment.yaml  a copy of the experiment
 *   manifest.json    seed, fingerprints, version, compiler, machine, date
 *   published.csv, best.csv, published.md
 *                    published figures beside measured ones (experiments/published)
 *   plots/           plots, and the scripts that raytally does not ship
 *   tables.md, tables.tex, report.html
 *                    the results to read */
#ifndef RT_RESULTS_RESULT_DIRECTORY_H
#define RT_RESULTS_RESULT_DIRECTORY_H

#include "measure/result_files.h"
#include "results/results.h"

/* ---- the manifest ---- */

/* Writes `directory`/manifest.json, dated now. `counting`, `timing`: threads; 0 = all processors. */
RtStatus rt_manifest_write(const RtResults *results, int counting, int timing, const char *directory,
                           RtError *error);

/* Sets the claims in the manifest of a finished run: `claims`, with which it began, and `claims_changed`,
 * those of now, if they are others. */
RtStatus rt_manifest_set_claims(const RtResults *results, const char *directory, RtError *error);

/* Reads it back; the caller owns the reference. */
RtStatus rt_manifest_read(const char *directory, json_t **manifest, RtError *error);

/* Loads the experiment of the manifest in `directory`, in the same variant, from the file that it names,
 * relative to the current folder. If there is none, and the directory may have been sent elsewhere, from the
 * copy in it. Scenes are relative to the file that is loaded. RT_MISMATCH if it has changed. */
RtStatus rt_manifest_experiment(const char *directory, bool elsewhere, RtExperiment *experiment,
                                RtError *error);

/* ---- the other files ---- */

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

/* The picture of a workload's scene in a result directory. */
RtStatus rt_results_image_path(const char *directory, const RtExperiment *experiment, uint32_t workload,
                               char *path, RtError *error);

/* Loads experiment and results of a result directory; this build may lack its accelerators. Initialises
 * `results`: rt_results_clear. */
RtStatus rt_results_load(const char *directory, RtExperiment *experiment, RtResults *results, RtError *error);

#endif
