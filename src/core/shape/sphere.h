/* SPDX-License-Identifier: Apache-2.0 */
/* Spheres: centre and radius > 0; the surface, hit from outside and from inside.
 *
 * The hit is computed in double about the point of the ray nearest to the centre (Haines, Günther &
 * Akenine-Möller 2019, "Precision Improvements for Ray/Sphere Intersection", Ray Tracing Gems ch. 7): the
 * half chord is sqrt(r^2 - |l|^2), with l the vector from the centre to that point, which loses no
 * precision for distant origins. */
#ifndef RT_SHAPE_SPHERE_H
#define RT_SHAPE_SPHERE_H

#include "core/base/ray.h"
#include "core/shape/ball.h"
#include "core/shape/quadratic.h"

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

/* Writes the t at which the line of a ray meets the sphere, in ascending order, and returns their number. */
static inline int rt_sphere_roots(const RtSphere *sphere, RtVec3 ray_org, RtVec3 ray_dir, double roots[2]) {
    RtVec3d org = rt_subd(rt_widen(ray_org), rt_widen(sphere->center)), dir = rt_widen(ray_dir);
    double radius = (double)sphere->radius;
    double dd = rt_dotd(dir, dir), od = rt_dotd(org, dir);
    double closest = -od / dd;
    RtVec3d l = rt_add_scaledd(org, dir, closest);
    double half_chord_squared = radius * radius - rt_dotd(l, l);
    if (!(half_chord_squared >= 0)) return 0;
    return rt_quadratic_roots(dd, od, rt_dotd(org, org) - radius * radius, half_chord_squared * dd, roots);
}

/* The first t in [tmin, tmax] at which the ray meets the sphere. */
static inline bool rt_sphere_hit(const RtSphere *sphere, const RtBox *own, const RtPreparedRay *ray,
                                 float *t) {
    double roots[2];
    int count = rt_sphere_roots(sphere, ray->org, ray->dir, roots);
    for (int i = 0; i < count; i++) {
        *t = (float)roots[i];
        if (rt_box_admit(own, ray, t)) return true;
    }
    return false;
}

#endif
