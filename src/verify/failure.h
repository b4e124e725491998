/* SPDX-License-Identifier: Apache-2.0 */
/* A failure: rays one of which an accelerator answers wrong, for repeating the query: over the same scene,
 * over a part of it, or with another build.
 *
 * The query is repeated with a newly built accelerator as in a check (verify/equivalence.h): `nearest` and
 * `occluded` in turn, stream by stream, with one of the two kernels. The other rays are included because a
 * failure may depend on earlier or simultaneous queries. */
#ifndef RT_VERIFY_FAILURE_H
#define RT_VERIFY_FAILURE_H

#include "verify/equivalence.h"

/* Builds the accelerator in question over a scene. */
typedef struct RtAccelBuilder {
    RtStatus (*build)(const void *context, const RtScene *scene, int threads, RtAccel **out, RtError *error);
    const void *context; /* borrowed */
    int threads;         /* 0 = all processors; does not affect the structure */
} RtAccelBuilder;

/* Builds from a spec, which is borrowed. */
RtAccelBuilder rt_accel_builder_of_spec(const char *spec);
RtStatus rt_accel_builder_run(const RtAccelBuilder *builder, const RtScene *scene, RtAccel **out,
                              RtError *error);

typedef struct RtFailure {
    const RtRay *rays; /* [count] borrowed, valid */
    size_t count;
    size_t asked;  /* the ray with the wrong answer */
    size_t stream; /* length of the streams */
    bool occluded, counted;
} RtFailure;

typedef struct RtAnswer {
    RtHit expected; /* brute's nearest hit */
    RtHit got;      /* answer to `nearest` */
    bool blocked;   /* answer to `occluded` */
    bool wrong;     /* the answer in question is wrong */
} RtAnswer;

/* Builds over `scene`, traces the rays, and compares with brute. */
RtStatus rt_failure_ask(const RtFailure *failure, const RtScene *scene, RtAccelBuilder builder,
                        RtAnswer *answer, RtError *error);

/* The failure for a wrong answer: its ray alone if that suffices, otherwise with all rays that were traced
 * together with it. `answer->wrong` is false if even then the answer is right: the error depended on more. */
RtStatus rt_failure_of(const RtReference *reference, const RtWrongAnswer *wrong, RtAccelBuilder builder,
                       RtFailure *failure, RtAnswer *answer, RtError *error);

#endif
