/* SPDX-License-Identifier: Apache-2.0 */
/* How far a command is, on stderr: one line, redrawn in place, on a terminal; one a minute where there is
 * none. Of a run whose results are kept, what is kept where it is interrupted. */
#ifndef RT_CLI_PROGRESS_H
#define RT_CLI_PROGRESS_H

#include "experiment/forecast.h"

#include <pthread.h>

typedef struct RtProgress {
    bool terminal;
    RtWorkloadOptions options; /* what is to be measured */
    double start, before;      /* wall seconds when it began; what of the forecast was known then */
    double asked;              /* when the forecast was made */
    double shown;              /* when a line was */
    double every;              /* seconds from a line to the next, while nothing else asks for one */
    RtForecast forecast;
    bool begun;
    char doing[2 * RT_MAX_LABEL + 64];
    pthread_mutex_t lock; /* of all above, from rt_progress_watch on */
    pthread_t watcher;
    bool watched, ended;
    char keeps[RT_MAX_PATH], go_on[RT_MAX_PATH + 256];
} RtProgress;

/* `options`: what is to be measured, without its observer. */
RtProgress rt_progress_begin(const RtWorkloadOptions *options);

/* Of a run: a thread shows a line every minute (on a terminal every second) also while nothing is finished.
 * From now on SIGINT and SIGTERM, blocked in all threads that are made later, end the process with 128 +
 * their number, after a word on what is kept in `directory`, and `go_on`, the command that goes on. Before
 * other threads are made. */
void rt_progress_watch(RtProgress *progress, const char *directory, const char *go_on);

/* What a workload tells its progress to; notices get a line of their own, on a terminal or not. */
RtRunObserver rt_progress_observer(RtProgress *progress);

/* Seconds that are left, by what the forecast said of what is done since the beginning and what that took;
 * NAN where that is not known yet. */
double rt_progress_left(const RtProgress *progress, double now);

/* "3 h 20 min", "5 min", "40 s"; room for RT_MAX_DURATION. */
#define RT_MAX_DURATION 32
void rt_format_duration(double seconds, char out[RT_MAX_DURATION]);

/* Takes the line away, and ends the watch. */
void rt_progress_end(RtProgress *progress);

#endif
