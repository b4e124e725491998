/* SPDX-License-Identifier: Apache-2.0 */
/* One line of progress on stderr, redrawn in place, and only on a terminal. */
#ifndef RT_CLI_PROGRESS_H
#define RT_CLI_PROGRESS_H

#include "bench/workload.h"

typedef struct RtProgress {
    bool terminal;
    uint32_t done, all; /* cells counted or timed, and how many there will be at most */
    double start;       /* of the run, wall seconds */
} RtProgress;

/* `parts`: measurements a cell, 1 when only counting, else 2. */
RtProgress rt_progress_begin(const RtExperiment *experiment, uint32_t parts);

/* What a workload tells its progress to; notices get a line of their own, on a terminal or not. */
RtObserver rt_progress_observer(RtProgress *progress);

/* Takes the line away. */
void rt_progress_end(RtProgress *progress);

#endif
