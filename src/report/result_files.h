/* SPDX-License-Identifier: Apache-2.0 */
/* The files of a result directory that are made from results (measure/previous_results.h lists all files). */
#ifndef RT_REPORT_RESULT_FILES_H
#define RT_REPORT_RESULT_FILES_H

#include "literature/published.h"
#include "measure/previous_results.h"

/* When a file is written, and whether its bytes are reproducible. */
typedef enum RtFileSort {
    RT_FILE_OTHER,    /* not made by rt_result_file_write */
    RT_FILE_MEASURED, /* written as cells are measured; depends on times */
    RT_FILE_COUNTED,  /* written as cells are measured; byte-identical on every machine */
    RT_FILE_COMPARED  /* written at the end, from published figures; byte-identical on every machine */
} RtFileSort;

/* RT_FILE_OTHER also if the experiment has no such file. */
RtFileSort rt_result_file_sort(const RtExperiment *experiment, RtResultFile file);

/* Only files of RT_FILE_COMPARED use `published`. */
void rt_result_file_write(RtResultFile file, const RtResults *results, const RtPublished *published,
                          FILE *out);

/* Writes all files of one sort that the experiment has. */
RtStatus rt_result_files_write(RtFileSort sort, const RtResults *results, const RtPublished *published,
                               const char *directory, RtError *error);

#endif
