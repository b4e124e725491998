/* SPDX-License-Identifier: Apache-2.0 */
/* Cones: the side of a truncated cone between two circles, open at both ends as in NFF. Equal radii make a
 * cylinder, one radius 0 a full cone. Both sides can be hit.
 *
 * With s the height along the axis and R(s) = base_radius + slope * s, a point is on the cone where its
 * distance from the axis equals R(s), 0 <= s <= height. This is a quadratic in t, solved in double about
 * the point of the ray nearest to the middle of the axis, so that distant origins cost no precision. */
#ifndef RT_SHAPE_CONE_H
#define RT_SHAPE_CONE_H

#include "core/base/ray.h"
#include "core/base/status.h"

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
