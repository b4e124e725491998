/* SPDX-License-Identifier: Apache-2.0 */
/* Triangles: three vertices; both sides, edges and vertices can be hit. The hit function is in
 * raytally/hit.h. */
#ifndef RT_SHAPE_TRIANGLE_H
#define RT_SHAPE_TRIANGLE_H

#include "core/base/ray.h"

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

#endif
