/* SPDX-License-Identifier: Apache-2.0 */
/* Triangles: three vertices; both sides, edges and vertices can be hit.
 *
 * Woop, Benthin & Wald 2013, "Watertight Ray/Triangle Intersection" (JCGT 2(1)): vertices are moved to the
 * ray's origin and sheared until the ray is the z axis; the three edge functions of the projection decide. A
 * shared vertex is transformed to the same position for every triangle, and the signs of edge functions are
 * exact. So neighbouring triangles agree, and no ray passes between them.
 *
 * An edge function in float32 has the right sign or is 0, because rounding is monotone; that rejects
 * nearly all rays. Only for the rest are the functions evaluated in double, where products of two float32
 * are exact and only one rounding is left. Their ratios, the barycentric weights, are then accurate too;
 * on a sliver those of float32 would be noise, and t with them. Only + - * / in a fixed order, so that
 * SIMD kernels can repeat it bit for bit: in float32 up to the first test, in double for the few lanes
 * that pass it. */
#ifndef RT_SHAPE_TRIANGLE_H
#define RT_SHAPE_TRIANGLE_H

#include "core/base/ray.h"
#include "core/shape/ball.h"

typedef struct RtTriangle {
    RtVec3 v[3];
} RtTriangle;

/* The box: exact, no rounding. */
static inline RtBox rt_triangle_box(const RtTriangle *triangle) {
    return (RtBox){rt_vec_min(rt_vec_min(triangle->v[0], triangle->v[1]), triangle->v[2]),
                   rt_vec_max(rt_vec_max(triangle->v[0], triangle->v[1]), triangle->v[2])};
}

/* The smallest enclosing ball. */
RtBall rt_triangle_ball(const RtTriangle *triangle);

/* The largest dot product of `direction` with a point of the triangle. */
double rt_triangle_support(const RtTriangle *triangle, RtVec3d direction);

/* Unit normal by the right-hand rule over v[0], v[1], v[2]; zero for a triangle without area. */
RtVec3d rt_triangle_normal(const RtTriangle *triangle);

/* Barycentric weights of v[0], v[1], v[2] at `point` in the plane of the triangle; they sum to 1. */
RtVec3d rt_triangle_weights(const RtTriangle *triangle, RtVec3d point);

/* A coordinate of each vertex, and 0: loading an arbitrary fourth lane would take another shuffle. */
static inline RtFloat4 rt_triangle_along(const float *v, size_t vertex, size_t axis) {
    v += axis;
    return (RtFloat4){v[0], v[vertex], v[2 * vertex], 0};
}

/* A vertex, and 0. */
static inline RtFloat4 rt_triangle_vertex(const float *v, size_t axis) {
    return (RtFloat4){v[0], v[axis], v[2 * axis], 0};
}

/* The t in [tmin, tmax] at which the ray hits a triangle; a ray in its plane misses it. Coordinate a of
 * vertex i is v[i * vertex + a * axis], so that a triangle stored coordinate by coordinate among others
 * can be tested in place. */
static inline bool rt_triangle_hit_strided(const float *v, size_t vertex, size_t axis,
                                           const RtPreparedRay *ray, float *t) {
    const float *org = ray->org.at;
    RtFloat4 z = rt_triangle_along(v, vertex, (size_t)ray->kz * axis) - org[ray->kz];
    RtFloat4 x = rt_triangle_along(v, vertex, (size_t)ray->kx * axis) - org[ray->kx] - ray->shear_x * z;
    RtFloat4 y = rt_triangle_along(v, vertex, (size_t)ray->ky * axis) - org[ray->ky] - ray->shear_y * z;
    RtFloat4 x1 = __builtin_shufflevector(x, x, 1, 2, 0, 3), x2 = __builtin_shufflevector(x, x, 2, 0, 1, 3);
    RtFloat4 y1 = __builtin_shufflevector(y, y, 1, 2, 0, 3), y2 = __builtin_shufflevector(y, y, 2, 0, 1, 3);
    RtFloat4 edges = x2 * y1 - y2 * x1;
    if ((rt_bits(edges < 0) & 7) && (rt_bits(edges > 0) & 7)) return false;
    double u = (double)x[2] * (double)y[1] - (double)y[2] * (double)x[1];
    double w1 = (double)x[0] * (double)y[2] - (double)y[0] * (double)x[2];
    double w2 = (double)x[1] * (double)y[0] - (double)y[1] * (double)x[0];
    if ((u < 0 || w1 < 0 || w2 < 0) && (u > 0 || w1 > 0 || w2 > 0)) return false;
    double determinant = u + w1 + w2;
    if (determinant == 0) return false;
    double depth = (u * (double)z[0] + w1 * (double)z[1] + w2 * (double)z[2]) / determinant;
    *t = (float)(depth / (double)ray->dir.at[ray->kz]);
    RtFloat4 a = rt_triangle_vertex(v, axis), b = rt_triangle_vertex(v + vertex, axis);
    RtFloat4 c = rt_triangle_vertex(v + 2 * vertex, axis);
    return rt_admit4(rt_min(rt_min(a, b), c), rt_max(rt_max(a, b), c), ray, t);
}

static inline bool rt_triangle_hit(const RtTriangle *triangle, const RtPreparedRay *ray, float *t) {
    return rt_triangle_hit_strided(triangle->v[0].at, 3, 1, ray, t);
}

#endif
