/* SPDX-License-Identifier: Apache-2.0 */
/* Hit functions in exact arithmetic: where a line meets an object, from the stored numbers of the object
 * alone. The exact definition of each object:
 *
 *   triangle   all points of its plane within or on its three edges. A triangle without area, and a line in
 *              the plane, have no hits.
 *   polygon    the points of its plane that, projected along the axis dropped by the hit function
 *              (polygon.h), lie within or on the edges, by the even-odd rule. The plane goes through the mean
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
 * role. */
#ifndef RT_EXACT_EXACT_HIT_H
#define RT_EXACT_EXACT_HIT_H

#include "core/base/memory.h"
#include "core/shape/geometry.h"
#include "exact/exact.h"

/* Does the line meet an object within [tmin, tmax]? */
typedef enum RtExactResult { RT_MISSED, RT_HIT, RT_UNDECIDED } RtExactResult;

/* Does the line meet object `id` within [tmin, tmax]? If so, *t is the first such number. Undecided only
 * if memory does not suffice for the crossings of a CSG tree. */
RtExactResult rt_exact_hit(const RtGeometry *geometry, uint32_t id, const RtExactLine *line, RtRoot *t);

/* ---- CSG trees: exact_csg.c ---- */

RtExactResult rt_exact_csg_hit(const RtCsgForest *forest, const RtCsg *tree, const RtExactLine *line,
                               RtRoot *t);

/* Where the whole line enters and leaves a CSG tree whose solids have grown by `grow`, or shrunk if it is
 * below 0 (margin.h): t in ascending order, in the memory of `owner`. */
RtStatus rt_exact_csg_boundaries(const RtCsgForest *forest, const RtCsg *tree, const RtWideRay *line,
                                 double grow, RtArena *owner, double **at, uint32_t *count, RtError *error);

#endif
