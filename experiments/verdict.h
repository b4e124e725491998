/* Verdicts: how an answer of an accelerator with arithmetic of its own (Embree's native mode) compares with
 * the answer of our hit functions.
 *
 * Both compute in rounded arithmetic, so where a ray grazes an object, or begins or ends on one, both answers
 * can be right. The margin of an object is found by trying: the ray is moved by the float32 error bound
 *
 *     shift = 2^-21 * the largest coordinate of the scene's box or of the ray's origin     (8 half-ulps)
 *
 * along the 26 directions of a cube's faces, edges and corners, and its interval is once widened and once
 * narrowed by the tolerance. An object that all these rays hit is certain, one that some hit is possible, one
 * that none hits is impossible. An answer that names a possible or certain object, at a t between those found
 * for its front or between those for its back, with no certain object clearly before it, is marginal; so is a
 * miss where nothing is certain.
 *
 * This trusts our hit functions to be within the bound of the truth; a referee in exact arithmetic, which
 * trusts nobody, is to take its place. */
#ifndef RT_EXPERIMENTS_VERDICT_H
#define RT_EXPERIMENTS_VERDICT_H

#include "shape/geometry.h"

/* In order of severity. */
typedef enum RtVerdict {
    RT_EQUAL,    /* the same object, t within the tolerance: 2^-18 * the largest coordinate / |dir| */
    RT_TIE,      /* another object that our hit function finds within the tolerance of the nearest t */
    RT_MARGINAL, /* explained by rounding, as above */
    RT_WRONG,    /* anything else */
    RT_VERDICT_COUNT
} RtVerdict;

/* "equal", "tie", "marginal", "wrong" */
const char *rt_verdict_name(RtVerdict verdict);

/* Judges the nearest hit `answer` of a valid ray; `expected` is brute's. */
RtVerdict rt_verdict_nearest(const RtGeometry *geometry, const RtRay *ray, RtHit expected, RtHit answer);

/* Judges an answer to `occluded`: equal, marginal or wrong. */
RtVerdict rt_verdict_occluded(const RtGeometry *geometry, const RtRay *ray, bool expected, bool answer);

#endif
