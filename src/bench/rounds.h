/* SPDX-License-Identifier: Apache-2.0 */
/* Interleaved rounds: how things are timed against each other. After a warm-up, each round runs all of them
 * once, in an order drawn anew, so that a drift of the machine meets them all alike and the times of one
 * round may be paired. */
#ifndef RT_BENCH_ROUNDS_H
#define RT_BENCH_ROUNDS_H

#include "base/status.h"

#include <stdbool.h>
#include <stdint.h>

#define RT_MAX_ROUNDS 1000 /* measurements of one thing */

/* One of the things that are timed. */
typedef struct RtRunner {
    RtStatus (*run)(void *context, RtError *error); /* all of its work once */
    void *context;
    double work;      /* pieces of work in one run, > 0: times are per piece */
    bool parallel;    /* runs on several threads: the wall clock is then the clock of the comparison */
    double *seconds;  /* [rounds] out: by the clock of the comparison, else the thread's processor time */
    double *wall;     /* [rounds] out: by the wall clock; NULL if nobody asks */
    uint32_t repeats; /* scratch: runs in a round */
} RtRunner;

typedef struct RtRounds {
    uint32_t rounds; /* 1..RT_MAX_ROUNDS, after one more that warms up */
    double least;    /* seconds: what is shorter is repeated within a round until it takes this long */
    uint64_t seed;   /* of the order */
} RtRounds;

RtStatus rt_rounds_run(RtRunner *runners, size_t count, const RtRounds *rounds, RtError *error);

#endif
