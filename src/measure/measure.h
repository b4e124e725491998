/* SPDX-License-Identifier: Apache-2.0 */
/* Measuring an accelerator on a ray set: counting and timing, which are separate passes over the same rays.
 * Shadow and occlusion rays are traced by `occluded`, all others by `nearest`. */
#ifndef RT_MEASURE_MEASURE_H
#define RT_MEASURE_MEASURE_H

#include "measure/statistics.h"
#include "rays/rayset.h"

#include <stdio.h>

/* ---- counting ---- */

/* Writes the right answers to hits[0..set->count), by the timed kernel of an exact accelerator. */
RtStatus rt_measure_answers(const RtAccel *accel, const RtRaySet *set, int threads, RtHit *hits,
                            RtError *error);

typedef struct RtCount {
    RtTally tally;
    uint64_t differ;   /* answers that differ from the expected ones */
    uint64_t first;    /* index of the first of them */
    bool timed_kernel; /* they are answers of the timed kernel */
    double seconds;    /* wall seconds of the pass that counted */
} RtCount;

/* Counts what `set` costs, the same at any number of threads, and compares each answer with
 * expected[0..set->count): object id and bits of t, or for `occluded` whether there is a hit. A remote
 * accelerator is not trusted: it is counted twice, RT_BROKEN if the counts differ, and its timed kernel is
 * compared, too. */
RtStatus rt_measure_count(const RtAccel *accel, const RtRaySet *set, const RtHit *expected, int threads,
                          RtCount *count, RtError *error);

/* RT_BROKEN unless two counts of the same rays of a kind are equal. */
RtStatus rt_counts_check(const RtAccel *accel, const RtTally *first, const RtTally *second, RtRayKind kind,
                         RtError *error);

/* What each ray of a set hit and cost, row by row. */
typedef struct RtRows {
    uint64_t count;
    RtHit *hits;      /* [count] owned; NULL for kinds of `occluded` */
    bool *blocked;    /* [count] owned; NULL for other kinds */
    RtTally *tallies; /* [count] owned */
} RtRows;

/* Answers of the timed kernel to streams, and counts of each ray traced by itself, which sum to those of
 * rt_measure_count. Clear with rt_rows_clear, also after a failure. */
RtStatus rt_measure_rows(const RtAccel *accel, const RtRaySet *set, int threads, RtRows *rows,
                         RtError *error);
void rt_rows_clear(RtRows *rows);

/* ---- rounds (rounds.c) ---- */

/* Interleaved rounds: timing several runners against each other. After a warm-up, each round runs all of them
 * once, in a new random order, so that drift of the machine affects all alike and the times of one round can
 * be paired. Where data lies in memory changes its speed, too, for as long as it lies there: rounds are
 * independent measurements only if the data is laid out anew for each (`renew`). */

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

/* ---- timing ---- */

/* One of the accelerators that are timed against each other, and its rays. */
typedef struct RtTimed {
    const RtAccel *accel;
    const RtRaySet *set; /* not empty */
    double *seconds;     /* [rounds.most] out: seconds per ray, by the clock of the comparison */
    double *wall;        /* [rounds.most] out: seconds per ray by the wall clock, all threads together */
    bool *broken;        /* as in RtRunner, or NULL */
    uint32_t repeats;    /* out: passes over the rays in the last round */
} RtTimed;

typedef struct RtTiming {
    RtRounds rounds; /* its `renew` is not used */
    /* Called before each round but the first, while nothing uses the accelerators: may replace those of
     * timed[] by others that are built alike, at other addresses; NULL for one that cannot be built any more,
     * which is then `broken`. The memory of queries and answers is renewed with them. NULL: the same
     * structures are timed in every round. */
    RtStatus (*renew)(void *context, RtTimed *timed, size_t count, RtError *error);
    int threads; /* 1: the clock of the comparison is the thread's processor time; more: the wall clock;
                    0 = all processors */
} RtTiming;

/* Makes a runner, whose run is one pass over the rays on `threads` threads. The pass of a remote accelerator
 * runs in its process, on a copy of the rays, and is timed by the clocks there: no communication is timed.
 * Close with rt_runner_close, also after a failure. */
RtStatus rt_runner_open(RtRunner *runner, const RtTimed *timed, int threads, RtError *error);
void rt_runner_close(RtRunner *runner);

/* Times timed[0..count) in interleaved rounds, *done of them. */
RtStatus rt_measure_time(RtTimed *timed, size_t count, const RtTiming *timing, uint32_t *done,
                         RtError *error);

/* How much longer a pass over `set` takes, on one thread, if passes over other rays lie between its passes:
 * *learnt gets the median of paired ratios. Much above 1 where branch predictors and caches hold what the
 * rays of `set` need, which they do not among the rays of a frame. At most `most` passes in a row, those of
 * a round. Not for remote accelerators. */
RtStatus rt_measure_learning(const RtAccel *accel, const RtRaySet *set, const RtRaySet *others, uint32_t most,
                             double *learnt, RtError *error);

/* ---- files (ray_file.c) ---- */

/* Ray sets as NumPy arrays, or with the extension .csv as text: rays and answers may come from any other
 * renderer, and go to any other program. docs/guide/own-rays.md describes the files. */

/* Floats per row: origin, tmin, direction, tmax. */
#define RT_RAY_COLUMNS 8

/* The broken invariant of a ray that is not valid (rt_ray_is_valid), as in "its direction is zero". */
const char *rt_ray_fault(const RtRay *ray);

/* Writes the rays, whole or not at all: float32, one row each; as text with nine digits, which read back to
 * the same bits. */
RtStatus rt_rays_save(const RtRaySet *set, const char *path, RtError *error);

/* Reads rays; they get the kind `kind` and source 0. A text has the columns ox,oy,oz,tmin,dx,dy,dz,tmax in
 * any order, among others; without tmin and tmax it is 0 to infinity. Rejects an empty file, and an invalid
 * ray (rt_ray_is_valid) by its row. Free with rt_rayset_clear. */
RtStatus rt_rays_load(const char *path, RtRayKind kind, RtRaySet *set, RtError *error);

/* Writes the hit of each ray, in the format of the extension of `path`: fields t (float32; inf for a miss)
 * and object (int64; -1 for a miss); for any-hit kinds bools, in a text the column `blocked`. */
void rt_hits_put(const RtRows *rows, const char *path, FILE *out);

/* Reads the hits of `rays` rays by any program on a scene of `objects` objects to (*hits)[0..rays), owned
 * (rt_free): what rt_hits_put writes, with an `object` of 4 or 8 bytes, signed or not, all bits of which are
 * set for a miss, and other fields, which are ignored; or an array of t, infinity for a miss, which become
 * hits of RT_UNNAMED_OBJECT. Rejects other lengths and, by its row, an object that is not in the scene. */
RtStatus rt_hits_load(const char *path, uint64_t rays, uint32_t objects, RtHit **hits, RtError *error);

#endif
