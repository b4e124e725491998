/* SPDX-License-Identifier: Apache-2.0 */
/* Verdicts: compare the answer of an accelerator with its own arithmetic (Embree's native mode) with that of
 * our hit functions.
 *
 * Both compute in rounded arithmetic, so if a ray grazes an object, or starts or ends on one, either answer
 * may be wrong. Where they differ, the referee (exact/referee.h) decides in exact arithmetic. An exactly
 * right answer is never wrong, whatever our hit functions return. Other answers are excused as marginal only
 * if the ray is closer to the decision boundary than float32 arithmetic can resolve. Each object has such a
 * margin: where it may be hit if its vertices and the ray are displaced by up to
 *
 *     error = 2^-20 * the largest coordinate of the scene's box or of the ray's origin     (16 half-ulps)
 *
 * For triangles and spheres, which such an accelerator tests with its own arithmetic, the margin is computed
 * in double: edge functions within their error of 0, and t with an error that grows as the plane is seen
 * edge-on, or arbitrary where products of three lengths overflow float32; for spheres, the distance of the
 * line from the centre within the error of the radius, and every t on the chord between the smaller and the
 * larger sphere. Other shapes are tested with our hit functions, and their margin is found by probing: the
 * ray is moved by half the error along the 26 directions of a cube's faces, edges and corners, and once its
 * direction loses all components below 2^-24 of the largest; its interval is once widened and once narrowed
 * by the tolerance; t lies between those found for the front or between those for the back.
 *
 * An object that is hit all over its margin is certain, one that is hit somewhere is possible. An answer
 * is marginal if it names a possible or certain object, at a t that is possible for it, with no certain
 * object clearly before it. A miss is marginal if nothing is certain. */
#ifndef RT_VERIFY_VERDICT_H
#define RT_VERIFY_VERDICT_H

#include "exact/referee.h"

/* In order of severity. */
typedef enum RtVerdict {
    RT_EQUAL,    /* the same object, t within the tolerance: 2^-18 * the largest coordinate / |dir| */
    RT_TIE,      /* another object, whose exact t is within the tolerance of the exact t of ours */
    RT_MARGINAL, /* exactly right, or explained by rounding as above */
    RT_WRONG,    /* anything else */
    RT_VERDICT_COUNT
} RtVerdict;

/* "equal", "tie", "marginal", "wrong" */
const char *rt_verdict_name(RtVerdict verdict);

/* All three fail with RT_NO_MEMORY if the referee lacks memory, without a result. */

/* Judges the nearest hit `answer` of a valid ray; `expected` is brute's, `crossings` comes from
 * rt_crossings_alloc. */
RtStatus rt_verdict_nearest(const RtGeometry *geometry, const RtRay *ray, RtHit expected, RtHit answer,
                            RtCrossing *crossings, RtVerdict *verdict, RtError *error);

/* Which answer to `nearest` is exactly right, within that tolerance? */
RtStatus rt_verdict_side(const RtGeometry *geometry, const RtRay *ray, RtHit expected, RtHit answer,
                         RtSide *side, RtError *error);

/* Judges an answer to `occluded`: equal, marginal or wrong. */
RtStatus rt_verdict_occluded(const RtGeometry *geometry, const RtRay *ray, bool expected, bool answer,
                             RtCrossing *crossings, RtVerdict *verdict, RtError *error);

#endif
