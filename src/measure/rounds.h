/* SPDX-License-Identifier: Apache-2.0 */
/* Interleaved rounds: timing several runners against each other. After a warm-up, each round runs all of them
 * once, in a new random order, so that drift of the machine affects all alike and the times of one round can
 * be paired. Where data lies in memory changes its speed, too, for as long as it lies there: rounds are
 * independent measurements only if the data is laid out anew for each (`renew`). */
#ifndef RT_MEASURE_ROUNDS_H
#define RT_MEASURE_ROUNDS_H

#include "core/base/status.h"

#include <stdbool.h>
#include <stdint.h>

#define RT_MAX_ROUNDS 1000 /* most measurements of one runner */

typedef struct RtRunner {
    RtStatus (*run)(void *context, RtError *error); /* all of its work once */
    /* Optional, before rounds: does a sample of the work on this thread, for about `seconds`; *part gets
     * the part of a run that it was, above 0. NULL: a whole run. */
    RtStatus (*warm)(void *context, double seconds, double *part, RtError *error);
    /* For work in another process: runs it `repeats` times, and returns the time that took there. NULL: it
     * runs here, and this thread's clocks are used. */
    RtStatus (*time)(void *context, uint32_t repeats, double *seconds, double *wall, RtError *error);
    void *context;
    double work;      /* units of work in one run, > 0: times are per unit */
    double *seconds;  /* [most] out: by the clock of the comparison, else the thread's processor time */
    double *wall;     /* [most] out: by the wall clock, or NULL */
    double once;      /* out: seconds of a run in the last round */
    uint32_t repeats; /* out: runs in the last round */
    bool parallel;    /* runs on several threads: the wall clock is then the clock of the comparison */
    bool *broken;     /* in and out: set by RT_BROKEN, and never run again. NULL: RT_BROKEN ends the rounds */
} RtRunner;

typedef struct RtRounds {
    uint32_t rounds; /* 1..most, after a warm-up */
    uint32_t most;   /* ..RT_MAX_ROUNDS: rounds to run unless `enough` ends them earlier */
    double least;    /* seconds: shorter runs are repeated within a round until they take this long */
    uint64_t seed;   /* of the order */
    /* Called after each round from number `rounds` on: whether these are enough. NULL: they are. */
    bool (*enough)(void *context, uint32_t rounds);
    void *context;
    /* Called before each round but the first: replaces what the runners work on by the same at other
     * addresses. It may change their `context`. NULL: nothing is replaced. */
    RtStatus (*renew)(void *renew_context, RtError *error);
    void *renew_context;
} RtRounds;

/* *done gets the number of rounds. */
RtStatus rt_rounds_run(RtRunner *runners, size_t count, const RtRounds *rounds, uint32_t *done,
                       RtError *error);

/* Runs one of them `repeats` times; returns the seconds of all runs by both clocks. */
RtStatus rt_runner_time(const RtRunner *runner, uint32_t repeats, double *seconds, double *wall,
                        RtError *error);

/* How often a run of `seconds` must be repeated to last `least` seconds. */
uint32_t rt_runner_repeats(double seconds, double least);

#endif
