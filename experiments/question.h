/* A question that an accelerator answers wrong, so that it can be asked again: over the same scene, over a
 * part of it, by another build.
 *
 * It is asked by a fresh query, of an accelerator built anew, and as in a check (experiments/equivalence.h):
 * `nearest` and `occluded` in turn, stream by stream, by one of the two kernels. One ray is in question; the
 * others are there because a failure may depend on what was asked before or beside it. */
#ifndef RT_EXPERIMENTS_QUESTION_H
#define RT_EXPERIMENTS_QUESTION_H

#include "experiments/equivalence.h"

/* How the accelerator in question is built over a scene. */
typedef struct RtMaker {
    RtStatus (*build)(const void *context, const RtScene *scene, int threads, RtAccel **out, RtError *error);
    const void *context; /* borrowed */
    int threads;         /* 0 = all processors; does not change the structure */
} RtMaker;

/* By a spec, which stays the caller's. */
RtMaker rt_maker_of_spec(const char *spec);
RtStatus rt_maker_build(const RtMaker *maker, const RtScene *scene, RtAccel **out, RtError *error);

typedef struct RtQuestion {
    const RtRay *rays; /* [count] borrowed, valid */
    size_t count;
    size_t asked;  /* the ray in question */
    size_t stream; /* length of the streams */
    bool occluded, counted;
} RtQuestion;

typedef struct RtReply {
    RtHit expected; /* brute's nearest hit */
    RtHit got;      /* answer to `nearest` */
    bool blocked;   /* answer to `occluded` */
    bool wrong;     /* the one that was asked for */
} RtReply;

/* Builds over `scene`, asks, and compares with brute. */
RtStatus rt_question_ask(const RtQuestion *question, const RtScene *scene, RtMaker maker, RtReply *reply,
                         RtError *error);

/* The question of a witness: its ray alone if that gives a wrong answer, too, and otherwise with all rays
 * that were asked together with it. `reply->wrong` is false where even then the answer is right: what was
 * wrong depended on more than the question. */
RtStatus rt_question_of_witness(const RtReference *reference, const RtWitness *witness, RtMaker maker,
                                RtQuestion *question, RtReply *reply, RtError *error);

#endif
