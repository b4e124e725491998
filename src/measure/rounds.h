/* SPDX-License-Identifier: Apache-2.0 */
/* Interleaved rounds: how things are timed against each other. After a warm-up, each round runs all of them
 * once, in an order drawn anew, so that a drift of the machine meets them all alike and the times of one
 * round may be paired. */
#ifndef RT_MEASURE_ROUNDS_H
#define RT_MEASURE_ROUNDS_H

#include "core/base/status.h"

#include <stdbool.h>
#include <stdint.h>

#define RT_MAX_ROUNDS 1000 /* measurements of one thing */

/* One of the things that are timed. */
typedef struct RtRunner {
    RtStatus (*run)(void *context, RtError *error); /* all of its work once */
    /* Optional, for the warm-up: some of the work on this thread, spread over all of it, for about `seconds`;
     * *part gets how much of a run that was, above 0. NULL: a whole run, which then takes as long as a round.
     */
    RtStatus (*warm)(void *context, double seconds, double *part, RtError *error);
    /* Of one whose work is done in another process: runs it `repeats` times, and says how long that took
     * there. NULL: it is run here, and the clocks of this thread say. */
    RtStatus (*time)(void *context, uint32_t repeats, double *seconds, double *wall, RtError *error);
    void *context;
    double work;      /* pieces of work in one run, > 0: times are per piece */
    bool parallel;    /* runs on several threads: the wall clock is then the clock of the comparison */
    double *seconds;  /* [most] out: by the clock of the comparison, else the thread's processor time */
    double *wall;     /* [most] out: by the wall clock; NULL if nobody asks */
    uint32_t repeats; /* scratch: runs in a round */
    bool *broken; /* in and out: it is never run while this is true. RT_BROKEN sets it; NULL: RT_BROKEN ends
                     the rounds */
} RtRunner;

typedef struct RtRounds {
    uint32_t rounds; /* 1..most, after a warm-up */
    uint32_t most;   /* ..RT_MAX_ROUNDS: as many as are run unless `enough` ends it before */
    double least;    /* seconds: what is shorter is repeated within a round until it takes this long */
    uint64_t seed;   /* of the order */
    /* Asked from `rounds` rounds on, after each, with their number, whether these will do. NULL: they do. */
    bool (*enough)(void *context, uint32_t rounds);
    void *context;
} RtRounds;

/* *done gets the number of rounds. */
RtStatus rt_rounds_run(RtRunner *runners, size_t count, const RtRounds *rounds, uint32_t *done,
                       RtError *error);

/* Runs one of them `repeats` times: seconds by both clocks for all of that. */
RtStatus rt_runner_time(const RtRunner *runner, uint32_t repeats, double *seconds, double *wall,
                        RtError *error);

/* How often a run that takes `seconds` is to be repeated to last `least` seconds. */
uint32_t rt_runner_repeats(double seconds, double least);

#endif
