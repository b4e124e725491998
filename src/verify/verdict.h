/* SPDX-License-Identifier: Apache-2.0 */
/* Verdicts: is an answer of an accelerator with its own arithmetic (Embree's native mode, a library) right?
 *
 * Each object has a margin (exact/margin.h), which depends on the ray and the scene, not on the accelerator:
 * it may be hit (possible), or every careful float32 implementation must hit it (certain). So an answer is
 * wrong
 *
 *     if it is a miss, and an object is certain
 *     if it names an object at a t at which that is not possible
 *     if another object is certainly hit before
 *
 * and a ray is certain if only one answer is not wrong: if nothing is possible, or a certain object precedes
 * all other possible ones. A verdict on an accelerator needs enough certain rays (equivalence.h). */
#ifndef RT_VERIFY_VERDICT_H
#define RT_VERIFY_VERDICT_H

#include "exact/margin.h"
#include "exact/referee.h"

/* In order of severity. */
typedef enum RtVerdict {
    RT_EQUAL, /* the same object, at a t that rounding makes of ours */
    RT_TIE, /* another object, whose exact t differs from that of ours by at most the lesser delta / |dir| */
    RT_MARGINAL, /* another answer that rounding explains */
    RT_WRONG,    /* anything else */
    RT_VERDICT_COUNT
} RtVerdict;

/* "equal", "tie", "marginal", "wrong" */
const char *rt_verdict_name(RtVerdict verdict);

/* What answers to a valid ray are judged by. `absolute`: the accelerator computes with absolute coordinates
 * (RtAccel.absolute). Geometry and ray are borrowed. */
typedef struct RtJudge {
    const RtGeometry *geometry;
    const RtRay *ray;
    RtMarginRay margin;
} RtJudge;

static inline RtJudge rt_judge(const RtGeometry *geometry, const RtRay *ray, bool absolute) {
    return (RtJudge){geometry, ray, rt_margin_ray(geometry, ray, absolute)};
}

/* What is wrong with a wrong answer to `nearest`. X(CONSTANT, name, meaning) */
#define RT_FAULTS(X)                                                                                         \
    X(LOST, lost, "a certain hit is missed")                                                                 \
    X(BEHIND, behind, "another object is certainly hit before")                                              \
    X(BESIDE, beside, "the ray cannot hit the object between tmin and tmax")                                 \
    X(DISPLACED, displaced, "the object may be hit, but not at that t")                                      \
    X(EDGE_ON, edge_on, "the triangle or polygon is seen edge on, and t lies outside its box")

typedef enum RtFault {
#define RT_FAULT_ENUM(CONSTANT, name, meaning) RT_FAULT_##CONSTANT,
    RT_FAULTS(RT_FAULT_ENUM)
#undef RT_FAULT_ENUM
        RT_FAULT_COUNT
} RtFault;

/* "lost", ... */
const char *rt_fault_name(RtFault fault);

/* All of these fail with RT_NO_MEMORY if exact arithmetic on a CSG tree lacks memory, without a result. */

/* Gives an answer with object RT_UNNAMED_OBJECT, a t alone, the object that excuses it: expected's if that
 * may be hit at this t, otherwise the first that may; otherwise expected's all the same, if there is one. The
 * verdict on it is the same for all that excuse it. Other answers do not change. */
RtStatus rt_verdict_name_object(RtJudge judge, RtHit expected, RtHit *answer, RtError *error);

/* Judges the nearest hit `answer`; `expected` is brute's. */
RtStatus rt_verdict_nearest(RtJudge judge, RtHit expected, RtHit answer, RtVerdict *verdict, RtError *error);

/* The fault of an answer that is wrong. */
RtStatus rt_verdict_fault(RtJudge judge, RtHit answer, RtFault *fault, RtError *error);

/* Judges an answer to `occluded`: equal, marginal or wrong. */
RtStatus rt_verdict_occluded(RtJudge judge, bool expected, bool answer, RtVerdict *verdict, RtError *error);

/* Is the ray certain, and must it hit something (even if several objects may be the nearest)? */
RtStatus rt_verdict_certain(RtJudge judge, bool *certain, bool *must_hit, RtError *error);

/* Which answer to `nearest` is exactly right, up to delta / |dir|? */
RtStatus rt_verdict_side(RtJudge judge, RtHit expected, RtHit answer, RtSide *side, RtError *error);

#endif
