/* SPDX-License-Identifier: Apache-2.0 */
/* What an earlier run has left in a result directory, and what becomes of it: nothing is overwritten unasked.
 */
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

/* The journals of experiments and of verifications, and what either writes when it has found everything. */
#define RT_RUN_JOURNAL    "cells.jsonl"
#define RT_VERIFY_JOURNAL "rows.jsonl"
#define RT_MANIFEST       "manifest.json"

/* Tables that only some experiments have. */
#define RT_DISTRIBUTIONS_CSV "distributions.csv"
#define RT_HISTOGRAMS_CSV    "histograms.csv"
#define RT_HARDWARE_CSV      "hardware.csv"
#define RT_FRAME_CSV         "frame.csv"

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
