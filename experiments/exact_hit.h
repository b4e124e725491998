/* Hit functions in exact arithmetic: where a line meets an object, from the numbers that the object is made
 * of and nothing else. What an object is, exactly:
 *
 *   triangle   all points of its plane within or on its three edges. One without area, and a line in the
 * plane, have no hits. polygon    the points of its plane that, along the axis dropped by the hit function
 * (polygon.h), lie within or on the edges between its vertices, by the even-odd rule. Its plane goes through
 * the mean of the vertices and is perpendicular to Newell's normal, both exact; so it is also defined where
 * the vertices, being rounded, lie in no plane. Where they do the choice of the axis makes no difference.
 *   sphere     the points whose distance from the centre is the radius. A tangent touches it.
 *   cone       its side: the points at a height 0..h along the axis whose distance from it is the radius
 * there, both circles and the tip included. A line along the side has no hits. CSG tree   where the inside of
 * the tree begins or ends, by the one rule of csg.h with places that are numbers, not float32: walls have no
 * least thickness. Solids are what their place, ratio and planes say in double (solid.h). Tori, whose
 * equation is of degree 4, and meshes are undecided.
 *
 * Edges, vertices, circles and the ends of the interval belong to it: all sets are closed. The own box of an
 * object plays no part. */
#ifndef RT_EXPERIMENTS_EXACT_HIT_H
#define RT_EXPERIMENTS_EXACT_HIT_H

#include "experiments/exact.h"
#include "shape/geometry.h"

/* A ray whose origin need not be float32. */
typedef struct RtWideRay {
    RtVec3d org, dir;  /* finite */
    double tmin, tmax; /* tmin finite */
} RtWideRay;

RtWideRay rt_wide_ray(const RtRay *ray);

/* The same on a slate; tmax is at most FLT_MAX, for a hit at infinity is none. */
typedef struct RtExactLine {
    RtExactVec org, dir;
    RtRational tmin, tmax;
} RtExactLine;

RtExactLine rt_exact_line(RtSlate *slate, const RtWideRay *line);

typedef enum RtFinding { RT_MISSED, RT_HIT, RT_UNDECIDED } RtFinding;

/* Does the line meet object `id` within [tmin, tmax]? If so *t is the first such place. Undecided: a CSG tree
 * with a torus or a mesh, or one whose crossings memory does not suffice for. */
RtFinding rt_exact_hit(RtSlate *slate, const RtGeometry *geometry, uint32_t id, const RtExactLine *line,
                       RtSurd *t);

/* The part of it that is about trees, in exact_csg.c. */
RtFinding rt_exact_csg_hit(RtSlate *slate, const RtCsgForest *forest, const RtCsg *tree,
                           const RtExactLine *line, RtSurd *t);

/* Is t within [tmin, tmax]? */
bool rt_exact_counts(RtSlate *slate, const RtExactLine *line, const RtSurd *t);

#endif
