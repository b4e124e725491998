/* SPDX-License-Identifier: Apache-2.0 */
/* The files of a result directory, and how results of a previous run are treated: nothing is overwritten
 * unless the user asks for it. */
#ifndef RT_MEASURE_RESULT_FILES_H
#define RT_MEASURE_RESULT_FILES_H

#include "core/base/status.h"

#include <stdbool.h>

/* How a run or a verification treats a directory with results. */
typedef enum RtStart {
    RT_START_FRESH,  /* it is rejected */
    RT_START_RESUME, /* continued, if it is the same run by the same build */
    RT_START_ANEW    /* its results are removed */
} RtStart;

/* Every file of a result directory, X(ID, name). Journals come first; experiment.yaml is a copy, not a
 * result. results/result_directory.h defines which experiments have which files, and writes them. */
#define RT_RESULT_FILES(X)                                                                                   \
    X(RUN_JOURNAL, "cells.jsonl")                                                                            \
    X(PACKED_JOURNAL, "cells.jsonl.gz")                                                                      \
    X(VERIFY_JOURNAL, "rows.jsonl")                                                                          \
    X(MANIFEST, "manifest.json")                                                                             \
    X(COUNTS, "counts.csv")                                                                                  \
    X(TIMES, "times.csv")                                                                                    \
    X(ROUNDS, "rounds.csv")                                                                                  \
    X(DISTRIBUTIONS, "distributions.csv")                                                                    \
    X(HISTOGRAMS, "histograms.csv")                                                                          \
    X(HARDWARE, "hardware.csv") /* of version 1.0 */                                                         \
    X(RENDER, "render.csv")                                                                                  \
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

/* *goes_on gets whether the start continues a journal. Rejects results that must not be touched: any by a
 * fresh start, and those without a journal by one that resumes, unless they were given up. */
RtStatus rt_result_files_look(const char *directory, const char *journal, RtStart start, bool *goes_on,
                              RtError *error);

/* Removes all results in the directory: tables, manifest, report, pictures, plots, and the journal of the
 * other kind. Scripts, replay files and everything else stay. First, one line that marks the results as given
 * up replaces the journal in one step: if the process ends at any time, either nothing was removed, or a
 * start that resumes begins anew. */
RtStatus rt_result_files_remove(const char *directory, const char *journal, RtError *error);

#endif
