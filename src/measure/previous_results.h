/* SPDX-License-Identifier: Apache-2.0 */
/* The files of a result directory, and what becomes of those that a previous run left there: nothing is
 * overwritten unasked. */
#ifndef RT_MEASURE_PREVIOUS_RESULTS_H
#define RT_MEASURE_PREVIOUS_RESULTS_H

#include "core/base/status.h"

#include <stdbool.h>

/* How a run or a verification takes a directory with results. */
typedef enum RtStart {
    RT_START_FRESH,  /* it is refused */
    RT_START_RESUME, /* gone on with, if it is the same run by the same build; what is known stays */
    RT_START_ANEW    /* the results are lost */
} RtStart;

/* Every file of a result directory, X(ID, name). Journals come first; experiment.yaml, which is a copy, is
 * not a result. report/result_files.h says which experiments have which, and writes them. */
#define RT_RESULT_FILES(X)                                                                                   \
    X(RUN_JOURNAL, "cells.jsonl")                                                                            \
    X(VERIFY_JOURNAL, "rows.jsonl")                                                                          \
    X(MANIFEST, "manifest.json")                                                                             \
    X(COUNTS, "counts.csv")                                                                                  \
    X(TIMES, "times.csv")                                                                                    \
    X(ROUNDS, "rounds.csv")                                                                                  \
    X(DISTRIBUTIONS, "distributions.csv")                                                                    \
    X(HISTOGRAMS, "histograms.csv")                                                                          \
    X(HARDWARE, "hardware.csv")                                                                              \
    X(FRAME, "frame.csv")                                                                                    \
    X(PUBLISHED, "published.csv")                                                                            \
    X(BEST, "best.csv")                                                                                      \
    X(PUBLISHED_PAGE, "published.md")                                                                        \
    X(TABLES_MD, "tables.md")                                                                                \
    X(TABLES_TEX, "tables.tex")                                                                              \
    X(REPORT, "report.html")                                                                                 \
    X(VERIFY_CSV, "verify.csv")                                                                              \
    X(VERIFY_MD, "verify.md")                                                                                \
    X(EXPERIMENT, "experiment.yaml")

typedef enum RtResultFile {
#define RT_FILE_ENUM(ID, name) RT_FILE_##ID,
    RT_RESULT_FILES(RT_FILE_ENUM)
#undef RT_FILE_ENUM
        RT_RESULT_FILE_COUNT
} RtResultFile;

extern const char *const rt_result_files[RT_RESULT_FILE_COUNT];

#define RT_RUN_JOURNAL    "cells.jsonl"
#define RT_VERIFY_JOURNAL "rows.jsonl"
#define RT_MANIFEST       "manifest.json"

/* Whether a result directory has a file of that name of its own. */
bool rt_previous_results_has(const char *name);

/* Whether there is the journal that such a start goes on with. Refuses results that are not to be touched:
 * any at all by a fresh start, any without the journal by one that resumes, unless they are given up. */
RtStatus rt_previous_results_look(const char *directory, const char *journal, RtStart start, bool *goes_on,
                                  RtError *error);

/* Removes the results in the directory, where there are any: tables, manifest, report, pictures, plots, and
 * the journal of the other kind. Scripts, replay files and all else stay. Before that, one line takes the
 * place of the journal, in one step: it says that the results are given up. So whenever the process ends,
 * either nothing is removed, or a start that resumes begins anew. */
RtStatus rt_previous_results_remove(const char *directory, const char *journal, RtError *error);

#endif
