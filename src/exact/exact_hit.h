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

#include "exact/place.h"
#include "shape/geometry.h"

/* A ray whose origin need not be float32. */
typedef struct RtWideRay {
    RtVec3d org, dir;  /* finite; dir, rounded to float32, is not 0 */
    double tmin, tmax; /* tmin finite */
} RtWideRay;

RtWideRay rt_wide_ray(const RtRay *ray);

/* May the line meet what lies in `box`, within [tmin, tmax], and how soon at the earliest? In double; rounds
 * towards yes. */
bool rt_line_may_meet(const RtWideRay *line, const RtBox *box, double *soonest);

/* By how much that is wider than the box, in parts of the numbers it is computed from: far above the rounding
 * of a few operations in double, and far below what would let many objects in. */
#define RT_LINE_SLACK 0x1p-40

/* The same on a slate; tmax is at most FLT_MAX, for a hit at infinity is none. */
typedef struct RtExactLine {
    RtWideRay wide;
    RtExactVec org, dir;
    RtRational zero, tmin, tmax;
} RtExactLine;

RtExactLine rt_exact_line(RtSlate *slate, const RtWideRay *line);

typedef enum RtFinding { RT_MISSED, RT_HIT, RT_UNDECIDED } RtFinding;

/* Does the line meet object `id` within [tmin, tmax]? If so *t is the first such place. Undecided: a CSG tree
 * whose crossings memory does not suffice for, and nothing else. */
RtFinding rt_exact_hit(RtSlate *slate, const RtGeometry *geometry, uint32_t id, const RtExactLine *line,
                       RtPlace *t);

/* The part of it that is about trees, in exact_csg.c. */
RtFinding rt_exact_csg_hit(RtSlate *slate, const RtCsgForest *forest, const RtCsg *tree,
                           const RtExactLine *line, RtPlace *t);

/* And about meshes, in exact_mesh.c: where the whole line, whatever its interval, goes in and out of mesh
 * solid `index`, by turns and in ascending order; places beyond FLT_MAX may be left out. *places is the
 * caller's, who frees it by rt_free; the numbers are on the slate. */
RtStatus rt_exact_mesh_places(RtSlate *slate, const RtSolidSet *set, uint32_t index, const RtExactLine *line,
                              RtRational **places, uint32_t *count, RtError *error);

/* Is t within [tmin, tmax]? */
bool rt_exact_counts(RtSlate *slate, const RtExactLine *line, const RtPlace *t);

#endif
