/* SPDX-License-Identifier: Apache-2.0 */
/* The progress of a command on stderr, whenever something is finished: one line, redrawn in place, on a
 * terminal; else at most one per minute. */
#ifndef RT_CLI_PROGRESS_H
#define RT_CLI_PROGRESS_H

#include "run/workload.h"

/* The cells that are to be measured, and of them the finished ones. */
typedef struct RtCellCount {
    uint32_t cells, finished;
} RtCellCount;

/* Ignores kinds of rays that a recorded scene does not have, and cells that are left out. */
RtCellCount rt_count_cells(const RtResults *results, const RtWorkloadOptions *options);

typedef struct RtProgress {
    bool terminal, begun;
    RtWorkloadOptions options; /* the measurement */
    double start, shown;       /* wall seconds: at the start, and of the last line */
    double every;              /* seconds between lines, without a terminal */
    RtCellCount count;
    uint32_t before;               /* cells that were finished at the start */
    char title[RT_MAX_LABEL + 32]; /* before what is shown: which of several runs this is; or "" */
    char doing[2 * RT_MAX_LABEL + 64];
} RtProgress;

/* Becomes the observer of the measurement with these options. */
void rt_progress_begin(RtProgress *progress, RtWorkloadOptions *options);

/* Clears the line, if stderr is a terminal. */
void rt_progress_clear(void);

/* Prints a message on a line of its own. `context` is not used. */
void rt_progress_notice(void *context, const char *message);

/* "3 h 20 min", "5 min", "40 s"; room for RT_MAX_DURATION. */
#define RT_MAX_DURATION 32
void rt_format_duration(double seconds, char out[RT_MAX_DURATION]);

#endif
