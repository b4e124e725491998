/* SPDX-License-Identifier: Apache-2.0 */
/* Spheres: centre and radius > 0; the surface, hit from outside and from inside. raytally/hit.h has the hit
 * function. */
#ifndef RT_SHAPE_SPHERE_H
#define RT_SHAPE_SPHERE_H

#include "core/base/ray.h"

typedef struct RtSphere {
    RtVec3 center;
    float radius;
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

#endif
