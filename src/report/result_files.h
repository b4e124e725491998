/* SPDX-License-Identifier: Apache-2.0 */
/* The files of a result directory that are made from results (measure/previous_results.h lists all files). */
#ifndef RT_REPORT_RESULT_FILES_H
#define RT_REPORT_RESULT_FILES_H

#include "literature/published.h"
#include "measure/previous_results.h"

/* When a file is written, and what its bytes depend on. */
typedef enum RtFileSort {
    RT_FILE_OTHER,    /* not made by rt_result_file_write */
    RT_FILE_MEASURED, /* written as cells are measured; depends on times */
    RT_FILE_COUNTED,  /* written as cells are measured; byte-identical wherever it is made */
    RT_FILE_COMPARED  /* written at the end, from published figures; byte-identical wherever it is made */
} RtFileSort;

/* RT_FILE_OTHER also where the experiment has no such file. */
RtFileSort rt_result_file_sort(const RtExperiment *experiment, RtResultFile file);

/* `published` is used by files of RT_FILE_COMPARED alone. */
void rt_result_file_write(RtResultFile file, const RtResults *results, const RtPublished *published,
                          FILE *out);

/* All files of one sort that the experiment has, into the directory. */
RtStatus rt_result_files_write(RtFileSort sort, const RtResults *results, const RtPublished *published,
                               const char *directory, RtError *error);

#endif
