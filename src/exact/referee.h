/* SPDX-License-Identifier: Apache-2.0 */
/* The referee: decides in exact arithmetic, from the float32 input alone (below), which of two
 * answers to a ray is right. It takes about 0.1 ms per object near the ray, and a few ms for a tree of many
 * tori, so it is used only where others disagree.
 *
 * Rounding can swap two objects that are closer than it, hence the tolerance. An answer is right if its
 * object is met, first at t, with
 *
 *     t - (the nearest exact t of the scene) <= tolerance   and   |answer.t - t| <= tolerance,
 *
 * and a miss is right if nothing is met. The tolerance is at least one ulp of t in float32. */
#ifndef RT_EXACT_REFEREE_H
#define RT_EXACT_REFEREE_H

#include "core/base/memory.h"
#include "core/shape/geometry.h"
#include "exact/exact.h"

/* ---- hit functions: exact_hit.c ----
 *
 * Where a line meets an object, from the stored numbers of the object alone. The exact definition of each
 * object:
 *
 *   triangle   all points of its plane within or on its three edges. A triangle without area, and a line in
 *              the plane, have no hits.
 *   polygon    the points of its plane that, projected along the axis dropped by the hit function
 *              (shape.h), lie within or on the edges, by the even-odd rule. The plane goes through the mean
 *              of the vertices, perpendicular to Newell's normal, both exact.
 *   sphere     the points whose distance from the centre is the radius. A tangent touches it.
 *   cone       its side: the points at a height 0..h along the axis whose distance from it is the radius
 *              there, both circles and the tip included. A line along the side has no hits.
 *   CSG tree   where the inside of the tree begins or ends, by the merging rule of csg.h with exact numbers
 *              instead of float32: walls have no minimum thickness. Solids are defined by their transform,
 *              ratio and planes in double, meshes by their triangles in float32 (solid.h). A line through an
 *              edge of a mesh, or in the plane of a face, passes beside it, on the side that exact_csg.c
 *              defines.
 *
 * Edges, vertices, circles and the ends of the interval are included. The own box of an object plays no
 * role. An object in instances is met by the line that the exact inverses of their `to_world`, a matrix of
 * doubles, move into its part. */

/* Does the line meet an object within [tmin, tmax]? */
typedef enum RtExactResult { RT_MISSED, RT_HIT, RT_UNDECIDED } RtExactResult;

/* Does the line meet object `id` within [tmin, tmax]? If so, *t is the first such number. Undecided only
 * if memory does not suffice for the crossings of a CSG tree. */
RtExactResult rt_exact_hit(const RtGeometry *geometry, uint32_t id, const RtExactLine *line, RtRoot *t);

/* Moves the line into the part of an instance; t stays what it is. False if nothing there can be met, because
 * the matrix has no inverse or the direction vanishes in float32. */
bool rt_exact_enter(const RtExactLine *line, const RtInstance *instance, RtExactLine *inside);

/* ---- CSG trees: exact_csg.c ---- */

RtExactResult rt_exact_csg_hit(const RtCsgForest *forest, const RtCsg *tree, const RtExactLine *line,
                               RtRoot *t);

/* Where the whole line enters and leaves a CSG tree whose solids have grown by `grow`, or shrunk if it is
 * below 0 (margin.h): t in ascending order, in the memory of `owner`. */
RtStatus rt_exact_csg_boundaries(const RtCsgForest *forest, const RtCsg *tree, const RtWideRay *line,
                                 double grow, RtArena *owner, double **at, uint32_t *count, RtError *error);

/* ---- judging ---- */

/* X(CONSTANT, name, meaning) */
#define RT_SIDES(X)                                                                                          \
    X(BOTH, both, "both answers are right")                                                                  \
    X(EXPECTED, expected, "only the expected answer is right")                                               \
    X(GOT, got, "only the other answer is right")                                                            \
    X(NEITHER, neither, "neither is right")                                                                  \
    X(UNDECIDED, undecided, "there was not enough memory to decide on a CSG tree that may be nearest")

typedef enum RtSide {
#define RT_SIDE_ENUM(CONSTANT, name, meaning) RT_SIDE_##CONSTANT,
    RT_SIDES(RT_SIDE_ENUM)
#undef RT_SIDE_ENUM
        RT_SIDE_COUNT
} RtSide;

/* "both", ... */
const char *rt_side_name(RtSide side);

/* The exact answer to `nearest`. */
typedef struct RtExactAnswer {
    RtSide side;
    RtExactResult result;
    uint32_t object; /* the lowest id at the nearest t, or RT_NO_OBJECT */
    uint32_t tied;   /* objects at exactly that t: above 1 in a true tie */
    long double t;   /* INFINITY for a miss */
} RtExactAnswer;

/* The exact nearest hit of a valid ray; `side` is not set. */
RtExactAnswer rt_referee_nearest(const RtGeometry *geometry, const RtRay *ray);

/* The same, and which of two answers is right. */
RtExactAnswer rt_referee_judge(const RtGeometry *geometry, const RtRay *ray, RtHit expected, RtHit got,
                               double tolerance);

/* ---- one or two objects ---- */

/* Does the line meet object `id`? If so, *t is the first t. */
RtExactResult rt_referee_hit(const RtGeometry *geometry, uint32_t id, const RtWideRay *line, long double *t);

/* Which of two objects does the ray meet first? *order is -1 (a), 1 (b) or 0 for a true tie, and *apart is
 * |difference of t|. RT_MISSED if one of them is missed. */
RtExactResult rt_referee_order(const RtGeometry *geometry, uint32_t a, uint32_t b, const RtRay *ray,
                               int *order, long double *apart);

/* One ulp of x in float32, never 0. */
long double rt_float_ulp(long double x);

#endif
