/* SPDX-License-Identifier: Apache-2.0 */
/* The progress of a command on stderr: one line, redrawn in place, on a terminal; else one per minute. An
 * interrupted run says what it keeps and how to continue. */
#ifndef RT_CLI_PROGRESS_H
#define RT_CLI_PROGRESS_H

#include "experiment/workload.h"

#include <pthread.h>

/* The cells that are to be measured, and of them the finished ones. */
typedef struct RtCellCount {
    uint32_t cells, finished;
} RtCellCount;

/* Ignores kinds of rays that a recorded scene does not have, and cells that are left out. */
RtCellCount rt_count_cells(const RtResults *results, const RtWorkloadOptions *options);

typedef struct RtProgress {
    bool terminal;
    RtWorkloadOptions options; /* the measurement */
    double start;              /* wall seconds */
    double counted;            /* time of the last count */
    double shown;              /* time of the last line */
    double every;              /* seconds between lines */
    RtCellCount count;
    uint32_t before; /* cells that were finished at the start */
    bool begun;
    char title[RT_MAX_LABEL + 32]; /* before what is shown: which of several runs this is; or "" */
    char doing[2 * RT_MAX_LABEL + 64];
    pthread_mutex_t lock; /* protects all above after rt_progress_watch */
    pthread_t watcher;
    bool watched, ended;
    const char *keeps, *go_on; /* of rt_progress_watch */
} RtProgress;

/* `options`: of the measurement, without its observer. */
RtProgress rt_progress_begin(const RtWorkloadOptions *options);

/* For a run: a thread shows a line every minute (on a terminal every second), even if nothing finishes. From
 * now on the signals of rt_stop_signals, blocked in all later threads, end the process with rt_stop_code,
 * after saying what is kept in `directory`, and `go_on`, the command that continues; both are borrowed until
 * the end. Call before other threads are made. */
void rt_progress_watch(RtProgress *progress, const char *directory, const char *go_on);

/* Clears the line, if stderr is a terminal. */
void rt_progress_clear(void);

/* Prints a message on a line of its own. `context` is not used. */
void rt_progress_notice(void *context, const char *message);

/* The observer of a workload. */
RtRunObserver rt_progress_observer(RtProgress *progress);

/* "3 h 20 min", "5 min", "40 s"; room for RT_MAX_DURATION. */
#define RT_MAX_DURATION 32
void rt_format_duration(double seconds, char out[RT_MAX_DURATION]);

/* Clears the line, and ends the thread. */
void rt_progress_end(RtProgress *progress);

#endif
