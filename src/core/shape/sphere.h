/* SPDX-License-Identifier: Apache-2.0 */
/* Spheres: centre and radius > 0; the surface, hit from outside and from inside. raytally/hit.h has the hit
 * function. */
#ifndef RT_SHAPE_SPHERE_H
#define RT_SHAPE_SPHERE_H

#include "core/base/ray.h"
#include "core/shape/ball.h"

typedef struct RtSphere {
    RtVec3 center;
    float radius;
} RtSphere;

/* The box, rounded outward. */
RtBox rt_sphere_box(const RtSphere *sphere);

/* The sphere itself. */
RtBall rt_sphere_ball(const RtSphere *sphere);

/* The largest dot product of `direction` with a point of the sphere. */
double rt_sphere_support(const RtSphere *sphere, RtVec3d direction);

/* Unit normal at `point` on the sphere, pointing outward. */
RtVec3d rt_sphere_normal(const RtSphere *sphere, RtVec3d point);

/* The first t in [tmin, tmax] at which the ray meets the sphere. */
static inline bool rt_sphere_hit(const RtSphere *sphere, const RtBox *own, const RtPreparedRay *ray,
                                 float *t) {
    return raytally_sphere_hit((const float *)sphere, rt_public_box(own), ray, t);
}

#endif
