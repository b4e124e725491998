/* SPDX-License-Identifier: Apache-2.0 */
/* Polygons: planar, n >= 3 vertices, convex or concave; both sides can be hit.
 *
 * Hit by projection (the lecture's method): the ray meets the plane, and the point is tested in the
 * coordinate plane onto which the polygon projects best, by counting crossings of its edges. Edges and
 * vertices belong to the polygon; a ray exactly through an oblique edge may slip through all the same,
 * because the point is rounded. The plane is Newell's, through the centroid, in double. */
#ifndef RT_SHAPE_POLYGON_H
#define RT_SHAPE_POLYGON_H

#include "core/base/ray.h"

typedef struct RtPolygon {
    RtVec3d normal; /* unit, right-hand rule over the vertices */
    RtVec3d center; /* a point of the plane */
    uint32_t first; /* first vertex */
    uint32_t count; /* vertices */
    uint32_t u, v;  /* axes of the projection plane */
    float warp;     /* largest distance of a vertex from the plane along the third axis, rounded up */
} RtPolygon;

/* A polygon is rejected if a vertex is farther from its plane (along the normal) than this fraction of its
 * size. */
#define RT_POLYGON_MAX_WARP 1e-3

/* Below, `vertices` are the polygon's own: the geometry's array from `first` on. */

/* Even-odd rule in the projection plane; a point on an edge is inside. */
static inline bool rt_polygon_inside(const RtPolygon *polygon, const RtVec3 *vertices, RtVec3d point) {
    double pu = point.at[polygon->u], pv = point.at[polygon->v];
    const float *last = vertices[polygon->count - 1].at;
    double au = (double)last[polygon->u], av = (double)last[polygon->v];
    bool inside = false;
    for (uint32_t i = 0; i < polygon->count; i++) {
        const float *vertex = vertices[i].at;
        double bu = (double)vertex[polygon->u], bv = (double)vertex[polygon->v];
        if ((av >= pv || bv >= pv) && (av <= pv || bv <= pv)) {
            double side = (bu - au) * (pv - av) - (pu - au) * (bv - av);
            if (side == 0 && (au >= pu || bu >= pu) && (au <= pu || bu <= pu)) return true;
            bool crosses = (av > pv) != (bv > pv);
            if (crosses && (bv > av ? side > 0 : side < 0)) inside = !inside;
        }
        au = bu;
        av = bv;
    }
    return inside;
}

/* The t in [tmin, tmax] at which the ray meets the polygon; a ray in its plane misses it. */
static inline bool rt_polygon_hit(const RtPolygon *polygon, const RtVec3 *vertices, const RtBox *own,
                                  const RtPreparedRay *ray, float *t) {
    RtVec3d org = rt_widen(rt_vec3_load(ray->org));
    RtVec3d dir = rt_widen(rt_vec3_load(ray->dir));
    double approach = rt_dotd(polygon->normal, dir);
    if (approach == 0) return false;
    double at = rt_dotd(polygon->normal, rt_subd(polygon->center, org)) / approach;
    if (!rt_polygon_inside(polygon, vertices, rt_add_scaledd(org, dir, at))) return false;
    *t = (float)at;
    return rt_box_admit(own, ray, t);
}

#endif
