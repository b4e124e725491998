/* SPDX-License-Identifier: Apache-2.0 */
/* A failure: rays of which an accelerator answers one wrong, so that they can be asked about again: over the
 * same scene, over a part of it, by another build.
 *
 * It is asked by a fresh query, of an accelerator built anew, and as in a check (verify/equivalence.h):
 * `nearest` and `occluded` in turn, stream by stream, by one of the two kernels. The answer to one ray is
 * wrong; the others are there because a failure may depend on what was asked before or beside it. */
#ifndef RT_VERIFY_FAILURE_H
#define RT_VERIFY_FAILURE_H

#include "verify/equivalence.h"

/* How the accelerator in question is built over a scene. */
typedef struct RtMaker {
    RtStatus (*build)(const void *context, const RtScene *scene, int threads, RtAccel **out, RtError *error);
    const void *context; /* borrowed */
    int threads;         /* 0 = all processors; does not change the structure */
} RtMaker;

/* By a spec, which stays the caller's. */
RtMaker rt_maker_of_spec(const char *spec);
RtStatus rt_maker_build(const RtMaker *maker, const RtScene *scene, RtAccel **out, RtError *error);

typedef struct RtFailure {
    const RtRay *rays; /* [count] borrowed, valid */
    size_t count;
    size_t asked;  /* the ray that is answered wrong */
    size_t stream; /* length of the streams */
    bool occluded, counted;
} RtFailure;

typedef struct RtAnswer {
    RtHit expected; /* brute's nearest hit */
    RtHit got;      /* answer to `nearest` */
    bool blocked;   /* answer to `occluded` */
    bool wrong;     /* the one that was asked for */
} RtAnswer;

/* Builds over `scene`, asks, and compares with brute. */
RtStatus rt_failure_ask(const RtFailure *failure, const RtScene *scene, RtMaker maker, RtAnswer *answer,
                        RtError *error);

/* The failure of a wrong answer: its ray alone if that gives a wrong answer, too, and otherwise with all rays
 * that were asked together with it. `answer->wrong` is false where even then the answer is right: what was
 * wrong depended on more than that. */
RtStatus rt_failure_of(const RtReference *reference, const RtWrongAnswer *wrong, RtMaker maker,
                       RtFailure *failure, RtAnswer *answer, RtError *error);

#endif
