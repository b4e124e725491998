/* SPDX-License-Identifier: Apache-2.0 */
/* Triangles: three vertices, both sides hit, edges and vertices included.
 *
 * Woop, Benthin & Wald 2013, "Watertight Ray/Triangle Intersection" (JCGT 2(1)): vertices are moved to the
 * ray's origin and sheared until the ray is the z axis; the three edge functions of the projection decide.
 * The transformed position of a shared vertex is the same for every triangle that shares it, and the signs of
 * edge functions are exact: so neighbours agree, and a ray cannot pass between them.
 *
 * An edge function in float32 has the right sign or is 0, because rounding is monotone; that turns nearly all
 * rays away. Only for the rest are the functions evaluated in double, where products of two float32 are exact
 * and one rounding is left. Their ratios, the weights, are then right too: on a sliver those of float32 would
 * be noise, and the t with them. Only + - * / in a fixed order, for SIMD kernels to repeat bit for bit: in
 * float32 up to the first test, and in double for the few lanes that pass it. */
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
    float fu = x[2] * y[1] - y[2] * x[1];
    float fv = x[0] * y[2] - y[0] * x[2];
    float fw = x[1] * y[0] - y[1] * x[0];
    if ((fu < 0 || fv < 0 || fw < 0) && (fu > 0 || fv > 0 || fw > 0)) return false;
    double u = (double)x[2] * (double)y[1] - (double)y[2] * (double)x[1];
    double v = (double)x[0] * (double)y[2] - (double)y[0] * (double)x[2];
    double w = (double)x[1] * (double)y[0] - (double)y[1] * (double)x[0];
    if ((u < 0 || v < 0 || w < 0) && (u > 0 || v > 0 || w > 0)) return false;
    double determinant = u + v + w;
    if (determinant == 0) return false;
    double depth = (u * (double)z[0] + v * (double)z[1] + w * (double)z[2]) / determinant;
    *t = (float)(depth / (double)ray->dir.at[ray->kz]);
    RtBox own = rt_triangle_box(triangle);
    return rt_box_admit(&own, ray, t);
}

#endif
