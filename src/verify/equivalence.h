/* SPDX-License-Identifier: Apache-2.0 */
/* Equivalence: does an accelerator answer every ray like brute?
 *
 * Each ray is traced four times, by the timed and the counted kernels of `nearest` and `occluded`, in streams
 * of 1, 7, 64 or a whole chunk of rays in turn. An exact accelerator is queried both in short and in long
 * streams, and must return the t bits and the id of the reference in each. Other accelerators get verdicts
 * (verify/verdict.h), the most severe of the four. Recorded answers of any other program are judged like
 * theirs. Results are the same on any number of threads. */
#ifndef RT_VERIFY_EQUIVALENCE_H
#define RT_VERIFY_EQUIVALENCE_H

#include "accel/accel.h"
#include "verify/verdict.h"

#include <jansson.h>

typedef struct RtReference {
    const RtScene *scene; /* borrowed */
    const RtRay *rays;    /* [count] borrowed; they must not move */
    size_t count;
    RtHit *hits;   /* [count] owned */
    bool *differs; /* [count] owned: rays with a marginal or wrong answer in some check */
} RtReference;

/* Computes the answers to rays[0..count), all valid, with `oracle`: usually brute, or an accelerator
 * proved exact if the scene is too large for it. */
RtStatus rt_reference_init(RtReference *reference, const RtAccel *oracle, const RtRay *rays, size_t count,
                           int threads, RtError *error);
void rt_reference_clear(RtReference *reference);

/* One answer, usually a wrong one. */
typedef struct RtWrongAnswer {
    size_t index; /* of the ray in the reference */
    bool occluded, counted;
    size_t stream; /* length of its streams; 0: a recorded answer */
    RtRay ray;
    RtHit expected;
    RtHit got;    /* of `nearest` */
    bool blocked; /* of `occluded` */
} RtWrongAnswer;

typedef struct RtEquivalence {
    uint64_t rays;
    uint64_t verdicts[RT_VERDICT_COUNT]; /* sum to `rays` */
    /* Rays with a marginal or wrong answer to `nearest`, by which answer is exactly right. */
    uint64_t sides[RT_SIDE_COUNT];
    uint64_t missed;    /* of those rays: a miss, but the ray exactly hits */
    double largest_off; /* the largest part of t by which an equal answer or a tie, not exact, differs */
    uint64_t faults[RT_FAULT_COUNT]; /* of wrong answers to `nearest`, unless it is exact */
    uint64_t occluded_wrong;         /* rays, regardless of their verdict */
    bool any_wrong;
    RtWrongAnswer first_wrong; /* if any_wrong: of the lowest ray index */
} RtEquivalence;

/* Compares `accel`, built over the reference's scene. Wrong answers are a result, not an error. An
 * accelerator that learns receives the reference's hits first. */
RtStatus rt_equivalence_check(const RtReference *reference, RtAccel *accel, int threads, RtEquivalence *out,
                              RtError *error);

/* Judges recorded answers to `nearest`, hits[0..reference->count), as those of an accelerator that is not
 * exact. Object RT_UNNAMED_OBJECT is a hit of which only t is known. Nothing is said of `occluded`. */
RtStatus rt_equivalence_judge(const RtReference *reference, const RtHit *hits, int threads,
                              RtEquivalence *out, RtError *error);

/* Rays of a reference whose answer is certain (verify/verdict.h), for accelerators with absolute coordinates
 * or for others. If there are too many objects for all rays, every kth one is examined. */
typedef struct RtCertain {
    uint64_t rays, hits;        /* examined, and those that brute says hit */
    uint64_t certain, must_hit; /* only one answer is right; a miss is wrong */
} RtCertain;

RtStatus rt_reference_certain(const RtReference *reference, bool absolute, int threads, RtCertain *out,
                              RtError *error);

/* Do enough of `rays` rays have a certain answer for a verdict on an accelerator that is not exact? 1000
 * must, and a tenth of the hits, or 1000, must hit something, since an accelerator that hits nothing is right
 * on every ray that misses for certain; of rays from a file (`given`) half must, and half of the hits. */
bool rt_certain_suffices(const RtCertain *certain, uint64_t rays, bool given);

/* "undecided: ...", with a remedy, to out[0..size). */
void rt_certain_undecided(const RtCertain *certain, uint64_t rays, bool given, bool absolute, char *out,
                          size_t size);

/* The verdict on an answer of the query's accelerator, which may be right: RT_EQUAL or RT_WRONG for an exact
 * accelerator. RT_NO_MEMORY as in verify/verdict.h. */
RtStatus rt_answer_verdict(const RtQuery *query, const RtWrongAnswer *answer, RtVerdict *verdict,
                           RtError *error);

/* The rays that were traced together with that of a wrong answer, up to the end of its stream: `count` of
 * the reference's, from `first` on. */
void rt_wrong_answer_context(const RtReference *reference, const RtWrongAnswer *wrong, size_t *first,
                             size_t *count);

/* The row of `verify --json`, without the number of certain rays: a new reference, NULL if memory is short.
 * Floats are strings that read back to the same bits ("inf" included). A recorded first_wrong has no kernel
 * and no stream. */
json_t *rt_equivalence_json(const RtEquivalence *result, const char *scene, const char *accel,
                            const char *against);

/* Describes the query, the expected and the actual answer in one line, to out[0..size). */
void rt_wrong_answer_format(const RtWrongAnswer *wrong, char *out, size_t size);

#endif
