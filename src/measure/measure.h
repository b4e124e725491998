/* SPDX-License-Identifier: Apache-2.0 */
/* Measuring an accelerator on a ray set: counting and timing, which are separate passes over the same rays.
 * Shadow and occlusion rays are asked of `occluded`, all others of `nearest`. */
#ifndef RT_MEASURE_MEASURE_H
#define RT_MEASURE_MEASURE_H

#include "measure/statistics.h"
#include "rays/rayset.h"

/* ---- counting ---- */

/* The right answers to `set`: hits[0..set->count), by the timed kernel of an exact accelerator. */
RtStatus rt_measure_answers(const RtAccel *accel, const RtRaySet *set, int threads, RtHit *hits,
                            RtError *error);

typedef struct RtCount {
    RtTally tally;
    uint64_t differ; /* answers unlike the expected ones */
    uint64_t first;  /* index of the first of them */
} RtCount;

/* Counts what `set` costs, the same at any number of threads, and compares each answer with
 * expected[0..set->count): object id and bits of t, or for those of `occluded` whether there is a hit. */
RtStatus rt_measure_count(const RtAccel *accel, const RtRaySet *set, const RtHit *expected, int threads,
                          RtCount *count, RtError *error);

/* Compares the answers of the timed kernel in the same way. Nothing is counted. */
RtStatus rt_measure_differ(const RtAccel *accel, const RtRaySet *set, const RtHit *expected, int threads,
                           RtCount *count, RtError *error);

/* What each ray of a set met and cost, row by row. */
typedef struct RtRows {
    uint64_t count;
    RtHit *hits;      /* [count] owned; NULL where the kind is asked for any hit */
    bool *blocked;    /* [count] owned; NULL where it is not */
    RtTally *tallies; /* [count] owned */
} RtRows;

/* Answers as the timed kernel gives them to streams, and counts of each ray asked by itself, one after the
 * other: they sum to those of rt_measure_count unless an accelerator has the rays of a stream share what they
 * do. Clear with rt_rows_clear, also after a failure. */
RtStatus rt_measure_rows(const RtAccel *accel, const RtRaySet *set, int threads, RtRows *rows,
                         RtError *error);
void rt_rows_clear(RtRows *rows);

/* ---- timing ---- */

/* One of the things that are timed against each other: an accelerator on its rays. */
typedef struct RtTimed {
    const RtAccel *accel;
    const RtRaySet *set; /* not empty */
    double *seconds;     /* [rounds.most] out: seconds a ray, by the clock of the comparison */
    double *wall;        /* [rounds.most] out: seconds a ray on the wall clock, all threads together */
    bool *broken;        /* as of RtRunner, or NULL */
} RtTimed;

typedef struct RtTiming {
    RtRounds rounds;
    int threads; /* 1: the clock of the comparison is the thread's processor time; more: the wall's;
                    0 = all processors */
} RtTiming;

/* Makes a runner of it, whose run is one pass over the rays, on `threads` threads; for rt_runner_close, also
 * after a failure. */
RtStatus rt_runner_open(RtRunner *runner, const RtTimed *timed, int threads, RtError *error);
void rt_runner_close(RtRunner *runner);

/* Times timed[0..count) in interleaved rounds (rounds.h), as many as *done gets. */
RtStatus rt_measure_time(const RtTimed *timed, size_t count, const RtTiming *timing, uint32_t *done,
                         RtError *error);

#endif
