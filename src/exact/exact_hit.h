/* SPDX-License-Identifier: Apache-2.0 */
/* Hit functions in exact arithmetic: where a line meets an object, from the numbers that the object is made
 * of and nothing else. What an object is, exactly:
 *
 *   triangle   all points of its plane within or on its three edges. One without area, and a line in the
 *              plane, have no hits.
 *   polygon    the points of its plane that, along the axis dropped by the hit function (polygon.h), lie
 *              within or on the edges between its vertices, by the even-odd rule. Its plane goes through the
 *              mean of the vertices and is perpendicular to Newell's normal, both exact; so it is also
 *              defined where the vertices, being rounded, lie in no plane. Where they do the choice of the
 *              axis makes no difference.
 *   sphere     the points whose distance from the centre is the radius. A tangent touches it.
 *   cone       its side: the points at a height 0..h along the axis whose distance from it is the radius
 *              there, both circles and the tip included. A line along the side has no hits.
 *   CSG tree   where the inside of the tree begins or ends, by the one rule of csg.h with places that are
 *              numbers, not float32: walls have no least thickness. Solids are what their place, ratio and
 *              planes say in double, meshes what their triangles say in float32 (solid.h). A line through an
 *              edge of a mesh, or in the plane of a face, passes beside it, on the side that exact_mesh.c
 *              names.
 *
 * Edges, vertices, circles and the ends of the interval belong to it: all sets are closed. The own box of an
 * object plays no part. */
#ifndef RT_EXACT_EXACT_HIT_H
#define RT_EXACT_EXACT_HIT_H

#include "core/shape/geometry.h"
#include "exact/line.h"

/* Does the line meet object `id` within [tmin, tmax]? If so *t is the first such place. Undecided: a CSG tree
 * whose crossings memory does not suffice for, and nothing else. */
RtFinding rt_exact_hit(RtExactArena *arena, const RtGeometry *geometry, uint32_t id, const RtExactLine *line,
                       RtPlace *t);

#endif
