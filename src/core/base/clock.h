/* SPDX-License-Identifier: Apache-2.0 */
/* Clocks, in seconds: wall time, and the processor time of the calling thread. */
#ifndef RT_BASE_CLOCK_H
#define RT_BASE_CLOCK_H

#include <time.h>

static inline double rt_clock_seconds(clockid_t clock) {
    struct timespec now;
    clock_gettime(clock, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static inline double rt_wall_seconds(void) {
    return rt_clock_seconds(CLOCK_MONOTONIC);
}

static inline double rt_thread_seconds(void) {
    return rt_clock_seconds(CLOCK_THREAD_CPUTIME_ID);
}

#endif
