/* SPDX-License-Identifier: Apache-2.0 */
/* Verdicts: how an answer of an accelerator with arithmetic of its own (Embree's native mode) compares with
 * the answer of our hit functions.
 *
 * Both compute in rounded arithmetic, so where a ray grazes an object, or begins or ends on one, either
 * answer can be the wrong one. Where they differ the referee (exact/referee.h) says in exact arithmetic
 * who is right. An answer that is exactly right is never wrong, whatever our hit functions say. One that is
 * not is excused, as marginal, only where the ray is nearer to the border that decides than float32
 * arithmetic can tell. Each object has such a margin: where it may be found hit, the places of its corners
 * and of the ray being wrong by
 *
 *     error = 2^-20 * the largest coordinate of the scene's box or of the ray's origin     (16 half-ulps)
 *
 * For triangles and spheres, which such an accelerator tests by arithmetic of its own, the margin is computed
 * in double: edge functions within their error of 0, and t with an error that grows as the plane is seen edge
 * on, or anything where products of three lengths overflow float32; distance of the line from the centre
 * within the error of the radius, and every t on the chord between the smaller and the larger sphere. Other
 * shapes are tested by our hit functions, and their margin is found by trying: the ray is moved by half the
 * error along the 26 directions of a cube's faces, edges and corners, and once its direction loses all
 * components below 2^-24 of the largest; its interval is once widened and once narrowed by the tolerance; t
 * lies between those found for the front or between those for the back.
 *
 * An object that is hit all over its margin is certain, one that is hit somewhere is possible. An answer that
 * names a possible or certain object, at a t that is possible for it, with no certain object clearly before
 * it, is marginal; so is a miss where nothing is certain. */
#ifndef RT_VERIFY_VERDICT_H
#define RT_VERIFY_VERDICT_H

#include "exact/referee.h"

/* In order of severity. */
typedef enum RtVerdict {
    RT_EQUAL,    /* the same object, t within the tolerance: 2^-18 * the largest coordinate / |dir| */
    RT_TIE,      /* another object, exactly met within the tolerance of the exact t of ours */
    RT_MARGINAL, /* exactly right, or explained by rounding, as above */
    RT_WRONG,    /* anything else */
    RT_VERDICT_COUNT
} RtVerdict;

/* "equal", "tie", "marginal", "wrong" */
const char *rt_verdict_name(RtVerdict verdict);

/* All three fail with RT_NO_MEMORY where the referee lacks memory, and then say nothing. */

/* Judges the nearest hit `answer` of a valid ray; `expected` is brute's, `room` of rt_hit_room. */
RtStatus rt_verdict_nearest(const RtGeometry *geometry, const RtRay *ray, RtHit expected, RtHit answer,
                            RtCrossing *room, RtVerdict *verdict, RtError *error);

/* Whose answer to `nearest` is the exact one, within that tolerance? */
RtStatus rt_verdict_side(const RtGeometry *geometry, const RtRay *ray, RtHit expected, RtHit answer,
                         RtSide *side, RtError *error);

/* Judges an answer to `occluded`: equal, marginal or wrong. */
RtStatus rt_verdict_occluded(const RtGeometry *geometry, const RtRay *ray, bool expected, bool answer,
                             RtCrossing *room, RtVerdict *verdict, RtError *error);

#endif
