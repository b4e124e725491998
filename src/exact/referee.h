/* SPDX-License-Identifier: Apache-2.0 */
/* The referee: which of two answers to a ray is right, in exact arithmetic from the float32 input alone
 * (exact/exact_hit.h). It trusts no margin and no hit function, and takes some 0.1 ms per object that
 * the ray comes near to, a few ms at a tree of many tori: it is asked where others disagree.
 *
 * What is exact about an answer is its object. Its t is a rounded number, and two objects nearer to one
 * another than rounding are told apart by luck: hence the tolerance. An answer is right if its object is met,
 * first at t, with
 *
 *     t - (the nearest exact t of the scene) <= tolerance   and   |answer.t - t| <= tolerance,
 *
 * and a miss is right if nothing is met. No tolerance is less than one ulp of t in float32. */
#ifndef RT_EXACT_REFEREE_H
#define RT_EXACT_REFEREE_H

#include "exact/exact_hit.h"

/* X(CONSTANT, name, meaning) */
#define RT_SIDES(X)                                                                                          \
    X(BOTH, both, "both answers are right")                                                                  \
    X(EXPECTED, expected, "the expected answer alone is right")                                              \
    X(GOT, got, "the other answer alone is right")                                                           \
    X(NEITHER, neither, "none is right")                                                                     \
    X(UNDECIDED, undecided, "memory did not suffice to decide on a CSG tree that may be nearest")

typedef enum RtSide {
#define RT_SIDE_ENUM(CONSTANT, name, meaning) RT_SIDE_##CONSTANT,
    RT_SIDES(RT_SIDE_ENUM)
#undef RT_SIDE_ENUM
        RT_SIDE_COUNT
} RtSide;

/* "both", ... */
const char *rt_side_name(RtSide side);

/* The exact answer: what a ray meets first. */
typedef struct RtRuling {
    RtSide side;
    RtFinding finding;
    uint32_t object;   /* the lowest id of those at the nearest t, or RT_NO_OBJECT */
    uint32_t together; /* objects at exactly that t: above 1 a true tie */
    long double t;     /* INFINITY where nothing is met */
} RtRuling;

/* The exact nearest hit of a valid ray in the scene; `side` is not filled in. */
RtRuling rt_referee_nearest(const RtGeometry *geometry, const RtRay *ray);

/* The same, and which of two answers it finds right. */
RtRuling rt_referee_judge(const RtGeometry *geometry, const RtRay *ray, RtHit expected, RtHit got,
                          double tolerance);

/* Does the ray meet anything at all? The first object that it does meet ends the search. */
RtFinding rt_referee_occluded(const RtGeometry *geometry, const RtRay *ray);

/* ---- one or two objects ---- */

/* Does the line meet object `id`, and where first? *t is not touched unless it does. */
RtFinding rt_referee_hit(const RtGeometry *geometry, uint32_t id, const RtWideRay *line, long double *t);

/* Which of two objects that the ray meets does it meet first? *order is -1 (a), 1 (b), 0 for a true tie, and
 * *apart |difference of t|. RT_MISSED if one of them is not met. */
RtFinding rt_referee_order(const RtGeometry *geometry, uint32_t a, uint32_t b, const RtRay *ray, int *order,
                           long double *apart);

/* One ulp of x in float32: the distance between floats of its size, never 0. */
long double rt_float_ulp(long double x);

#endif
