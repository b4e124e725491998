/* SPDX-License-Identifier: Apache-2.0 */
/* The simple shapes and their hit functions, each of which returns the first t in [tmin, tmax] at which the
 * ray meets the shape. Those of spheres and triangles are in raytally/hit.h. */
#ifndef RT_SHAPE_SHAPE_H
#define RT_SHAPE_SHAPE_H

#include "core/base/ray.h"
#include "core/base/status.h"

/* ---- spheres: the surface, hit from outside and from inside ---- */

typedef struct RtSphere {
    RtVec3 center;
    float radius; /* > 0 */
} RtSphere;

/* A bounding sphere, in double. */
typedef struct RtBall {
    RtVec3d center;
    double radius;
} RtBall;

/* The box, rounded outward. */
static inline RtBox rt_sphere_box(const RtSphere *sphere) {
    RtVec3d c = rt_widen(sphere->center);
    double r = (double)sphere->radius;
    return (RtBox){{rt_float_below(c.x - r), rt_float_below(c.y - r), rt_float_below(c.z - r)},
                   {rt_float_above(c.x + r), rt_float_above(c.y + r), rt_float_above(c.z + r)}};
}

/* The first t in [tmin, tmax] at which the ray meets the sphere. */
static inline bool rt_sphere_hit(const RtSphere *sphere, const RtBox *own, const RtPreparedRay *ray,
                                 float *t) {
    return raytally_sphere_hit((const float *)sphere, rt_public_box(own), ray, t);
}

/* ---- triangles: both sides, edges and vertices can be hit ---- */

typedef struct RtTriangle {
    RtVec3 v[3];
} RtTriangle;

/* The box: exact, no rounding. */
static inline RtBox rt_triangle_box(const RtTriangle *triangle) {
    return (RtBox){rt_vec_min(rt_vec_min(triangle->v[0], triangle->v[1]), triangle->v[2]),
                   rt_vec_max(rt_vec_max(triangle->v[0], triangle->v[1]), triangle->v[2])};
}

/* The largest dot product of `direction` with a point of the triangle. */
static inline double rt_triangle_support(const RtTriangle *triangle, RtVec3d direction) {
    double most = rt_dotd(rt_widen(triangle->v[0]), direction);
    for (int i = 1; i < 3; i++) most = fmax(most, rt_dotd(rt_widen(triangle->v[i]), direction));
    return most;
}

/* Unit normal by the right-hand rule over v[0], v[1], v[2]; zero for a triangle without area. */
static inline RtVec3d rt_triangle_normal(const RtTriangle *triangle) {
    const RtVec3 *v = triangle->v;
    return rt_normalized(rt_area_vector(rt_widen(v[0]), rt_widen(v[1]), rt_widen(v[2])));
}

/* The t in [tmin, tmax] at which the ray hits a triangle; a ray in its plane misses it. */
static inline bool rt_triangle_hit(const RtTriangle *triangle, const RtPreparedRay *ray, float *t) {
    return raytally_triangle_hit(triangle->v[0].at, 3, 1, ray, t);
}

/* ---- polygons: planar, n >= 3 vertices, convex or concave; both sides can be hit ----
 *
 * Hit by projection (the lecture's method): the ray meets the plane, and the point is tested in the
 * coordinate plane onto which the polygon projects best, by counting crossings of its edges. Edges and
 * vertices belong to the polygon; a ray exactly through an oblique edge may slip through all the same,
 * because the point is rounded. The plane is Newell's, through the centroid, in double. */

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

#define RT_ON_EDGE UINT32_MAX /* odd */

/* How many edges a half-line from the point along u crosses in the projection plane; RT_ON_EDGE for a point
 * on one. */
static inline uint32_t rt_polygon_crossings(const RtPolygon *polygon, const RtVec3 *vertices, RtVec3d point) {
    double pu = point.at[polygon->u], pv = point.at[polygon->v];
    const float *last = vertices[polygon->count - 1].at;
    double au = (double)last[polygon->u], av = (double)last[polygon->v];
    uint32_t crossings = 0;
    for (uint32_t i = 0; i < polygon->count; i++) {
        const float *vertex = vertices[i].at;
        double bu = (double)vertex[polygon->u], bv = (double)vertex[polygon->v];
        if ((av >= pv || bv >= pv) && (av <= pv || bv <= pv)) {
            double side = (bu - au) * (pv - av) - (pu - au) * (bv - av);
            if (side == 0 && (au >= pu || bu >= pu) && (au <= pu || bu <= pu)) return RT_ON_EDGE;
            bool crosses = (av > pv) != (bv > pv);
            crossings += crosses && (bv > av ? side > 0 : side < 0);
        }
        au = bu;
        av = bv;
    }
    return crossings;
}

/* Even-odd rule; a point on an edge is inside. */
static inline bool rt_polygon_inside(const RtPolygon *polygon, const RtVec3 *vertices, RtVec3d point) {
    return rt_polygon_crossings(polygon, vertices, point) % 2;
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

/* ---- cones ----
 *
 * The side of a truncated cone between two circles, open at both ends as in NFF. Equal radii make a
 * cylinder, one radius 0 a full cone. Both sides can be hit.
 *
 * With s the height along the axis and R(s) = base_radius + slope * s, a point is on the cone where its
 * distance from the axis equals R(s), 0 <= s <= height. This is a quadratic in t, solved in double about
 * the point of the ray nearest to the middle of the axis, so that distant origins cost no precision. */

typedef struct RtCone {
    RtVec3 base, apex; /* centres of the circles */
    float base_radius, apex_radius;
    RtVec3d axis;   /* unit, base to apex */
    RtVec3d middle; /* of the axis */
    double height;  /* length of the axis */
    double slope;   /* change of radius per unit of height */
} RtCone;

/* Fills `cone`; rejects negative radii, two radii of 0 and equal centres. */
RtStatus rt_cone_init(RtCone *cone, RtVec3 base, float base_radius, RtVec3 apex, float apex_radius,
                      RtError *error);

/* True if across + root * d_across, an offset from the axis, is as long as some radius of the cone. On a
 * flat cone the height of a point is no criterion: if it is 2^-20 of the radius, say, it has lost all its
 * digits. */
static inline bool rt_cone_between_radii(const RtCone *cone, RtVec3d across, RtVec3d d_across, double root) {
    RtVec3d offset = rt_add_scaledd(across, d_across, root);
    double lo = (double)rt_minf(cone->base_radius, cone->apex_radius);
    double hi = (double)rt_maxf(cone->base_radius, cone->apex_radius);
    double squared = rt_dotd(offset, offset);
    return squared >= lo * lo && squared <= hi * hi;
}

/* The first t in [tmin, tmax] at which the ray meets the side. */
static inline bool rt_cone_hit(const RtCone *cone, const RtBox *own, const RtPreparedRay *ray, float *t) {
    RtVec3d org = rt_widen(rt_vec3_load(ray->org));
    RtVec3d dir = rt_widen(rt_vec3_load(ray->dir));
    RtVec3d from_middle = rt_subd(org, cone->middle);
    double closest = -rt_dotd(from_middle, dir) / rt_dotd(dir, dir);
    RtVec3d near = rt_add_scaledd(from_middle, dir, closest);

    /* Split position and direction into the parts along and across the axis. */
    double s0 = rt_dotd(near, cone->axis), ds = rt_dotd(dir, cone->axis);
    RtVec3d across = rt_add_scaledd(near, cone->axis, -s0), d_across = rt_add_scaledd(dir, cone->axis, -ds);
    double half = cone->height / 2;
    double radius = (double)cone->base_radius + cone->slope * (s0 + half), d_radius = cone->slope * ds;

    double a = rt_dotd(d_across, d_across) - d_radius * d_radius;
    double half_b = rt_dotd(across, d_across) - radius * d_radius;
    double c = rt_dotd(across, across) - radius * radius;
    double roots[2];
    int count = raytally_quadratic_roots(a, half_b, c, half_b * half_b - a * c, roots);
    for (int i = 0; i < count; i++) {
        double s = s0 + roots[i] * ds;
        if (!(fabs(s) <= half)) continue;
        if (fabs(cone->slope) > 1 && !rt_cone_between_radii(cone, across, d_across, roots[i])) continue;
        *t = (float)(closest + roots[i]);
        if (rt_box_admit(own, ray, t)) return true;
    }
    return false;
}

#endif
