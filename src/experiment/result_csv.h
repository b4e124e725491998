/* SPDX-License-Identifier: Apache-2.0 */
/* The CSV files of a result directory that are made from its cells (measure/result_files.h lists all
 * files). */
#ifndef RT_EXPERIMENT_RESULT_CSV_H
#define RT_EXPERIMENT_RESULT_CSV_H

#include "experiment/results.h"
#include "measure/result_files.h"

/* When a file is written, and whether its bytes are reproducible. */
typedef enum RtFileSort {
    RT_FILE_OTHER,    /* none of these */
    RT_FILE_MEASURED, /* written as cells are measured; depends on times */
    RT_FILE_COUNTED,  /* written as cells are measured; byte-identical on every machine */
    RT_FILE_COMPARED  /* made from published figures (literature/published_tables.h); as identical */
} RtFileSort;

/* RT_FILE_OTHER also if the experiment has no such file. */
RtFileSort rt_result_file_sort(const RtExperiment *experiment, RtResultFile file);

/* A file of RT_FILE_MEASURED or RT_FILE_COUNTED. */
void rt_result_csv_write(RtResultFile file, const RtResults *results, FILE *out);

/* All of them that the experiment has. */
RtStatus rt_result_csvs_write(const RtResults *results, const char *directory, RtError *error);

#endif
