/* Triangles: three vertices, both sides hit, edges and vertices included.
 *
 * Woop, Benthin & Wald 2013, "Watertight Ray/Triangle Intersection" (JCGT 2(1)): vertices are moved to the
 * ray's origin and sheared until the ray is the z axis; the three edge functions of the projection decide.
 * The transformed position of a shared vertex is the same for every triangle that shares it, and where an
 * edge function is 0 in float32 it is evaluated again in double, where its sign is exact: so neighbours
 * agree, and a ray cannot pass between them.
 *
 * All arithmetic is float32 + - * / in a fixed order, for SIMD kernels to repeat bit for bit. */
#ifndef RT_SHAPE_TRIANGLE_H
#define RT_SHAPE_TRIANGLE_H

#include "base/ray.h"
#include "shape/ball.h"

typedef struct RtTriangle {
    RtVec3 v[3];
} RtTriangle;

/* The box: exact, no rounding. */
static inline RtBox rt_triangle_box(const RtTriangle *triangle) {
    return (RtBox){rt_vec_min(rt_vec_min(triangle->v[0], triangle->v[1]), triangle->v[2]),
                   rt_vec_max(rt_vec_max(triangle->v[0], triangle->v[1]), triangle->v[2])};
}

/* The smallest ball. */
RtBall rt_triangle_ball(const RtTriangle *triangle);

/* Largest dot product of `direction` with a point of the triangle. */
double rt_triangle_support(const RtTriangle *triangle, RtVec3d direction);

/* Unit normal by the right-hand rule over v[0], v[1], v[2]; zero for a triangle without area. */
RtVec3d rt_triangle_normal(const RtTriangle *triangle);

/* Barycentric weights of v[0], v[1], v[2] at `point` in the plane of the triangle; they sum to 1. */
RtVec3d rt_triangle_weights(const RtTriangle *triangle, RtVec3d point);

/* The t in [tmin, tmax] at which the ray meets the triangle; a ray in its plane misses it. */
static inline bool rt_triangle_hit(const RtTriangle *triangle, const RtPreparedRay *ray, float *t) {
    float x[3], y[3], z[3];
    for (int i = 0; i < 3; i++) {
        const float *v = triangle->v[i].at;
        z[i] = v[ray->kz] - ray->org.at[ray->kz];
        x[i] = v[ray->kx] - ray->org.at[ray->kx] - ray->shear_x * z[i];
        y[i] = v[ray->ky] - ray->org.at[ray->ky] - ray->shear_y * z[i];
    }
    float u = x[2] * y[1] - y[2] * x[1];
    float v = x[0] * y[2] - y[0] * x[2];
    float w = x[1] * y[0] - y[1] * x[0];
    if (u == 0 || v == 0 || w == 0) {
        u = (float)((double)x[2] * (double)y[1] - (double)y[2] * (double)x[1]);
        v = (float)((double)x[0] * (double)y[2] - (double)y[0] * (double)x[2]);
        w = (float)((double)x[1] * (double)y[0] - (double)y[1] * (double)x[0]);
    }
    if ((u < 0 || v < 0 || w < 0) && (u > 0 || v > 0 || w > 0)) return false;
    float determinant = u + v + w;
    if (determinant == 0) return false;
    /* Weights first: u * z would underflow in scenes of size 2^-40. */
    float scale = 1 / determinant;
    float depth = (u * scale) * z[0] + (v * scale) * z[1] + (w * scale) * z[2];
    *t = depth * ray->shear_z;
    RtBox own = rt_triangle_box(triangle);
    return rt_box_admit(&own, ray, t);
}

#endif
