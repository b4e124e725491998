/* SPDX-License-Identifier: Apache-2.0 */
/* For tests of --threads: who has done the work. */
#ifndef RT_TESTS_CLOCK_TESTING_H
#define RT_TESTS_CLOCK_TESTING_H

#include "core/base/clock.h"

/* Processor time of the calling thread, and of all others of this process. */
typedef struct Labour {
    double own, others; /* seconds */
} Labour;

static inline Labour labour_so_far(void) {
    double own = rt_thread_seconds();
    return (Labour){own, rt_clock_seconds(CLOCK_PROCESS_CPUTIME_ID) - own};
}

static inline Labour labour_since(Labour before) {
    Labour now = labour_so_far();
    return (Labour){now.own - before.own, now.others - before.others};
}

#endif
