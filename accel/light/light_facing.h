/* SPDX-License-Identifier: Apache-2.0 */
/* Does a ray to a light stay on one side of a polygon's plane, or leave a sphere for good? This culls the
 * object on which it starts.
 *
 * Exact. A hit at t is a point of the ray within delta of the object, along each axis, where for m the
 * distance along an axis from the origin to the farthest point of the object's box, e = 2^-24: hit functions
 * of polygons and spheres compute in double, and from there on rounding t to float32 and clamping it to where
 * the thick ray is in the box move the point by a few e m. delta = 32 e m = 2^-19 m is above that.
 *
 * - If the ray, at t = 0 and at t = 1 >= tmax, is on one side of the plane by more than delta |normal|_1,
 * then no t between can be a hit: distances are linear in t. The rounding of the distances themselves, in
 * double, is below 2^-46 of the lengths that they are made of.
 * - If the ray leaves the sphere's centre, its distance from it is least at the origin; if that is above the
 *   radius by more than sqrt(3) delta, and 2^-46 of it for rounding, no t >= 0 can be a hit. */
#ifndef RT_ACCEL_LIGHT_LIGHT_FACING_H
#define RT_ACCEL_LIGHT_LIGHT_FACING_H

#include "accel/kernel.h"

RT_KERNEL bool rt_light_has_facing_test(RtRef object) {
    return rt_ref_shape(object) == RT_SHAPE_POLYGON || rt_ref_shape(object) == RT_SHAPE_SPHERE;
}

/* The object is one that has sides, the ray's tmin at least 0 and tmax at most 1. True only if it is not
 * hit. */
RT_KERNEL bool rt_light_leaves(const RtGeometry *geometry, RtRef object, uint32_t id, const RtRay *ray) {
    uint32_t index = rt_ref_index(object);
    const RtBox *box = &geometry->boxes[id];
    RtVec3d org = rt_widen(ray->org), dir = rt_widen(ray->dir);
    double far = 0;
    for (int a = 0; a < 3; a++) {
        far = fmax(far, fabs((double)box->lo.at[a] - org.at[a]));
        far = fmax(far, fabs((double)box->hi.at[a] - org.at[a]));
    }
    if (rt_ref_shape(object) == RT_SHAPE_SPHERE) {
        const RtSphere *sphere = &geometry->spheres[index];
        RtVec3d from = rt_subd(org, rt_widen(sphere->center));
        double reach = (double)sphere->radius * (1 + 0x1p-40) + 0x1.cp-19 * far;
        return rt_dotd(from, dir) > 0x1p-40 * far * rt_lengthd(dir) && rt_dotd(from, from) > reach * reach;
    }
    const RtPolygon *polygon = &geometry->polygons[index];
    RtVec3d n = polygon->normal;
    double at_origin = rt_dotd(n, rt_subd(org, polygon->center)), at_light = at_origin + rt_dotd(n, dir);
    double norm = fabs(n.x) + fabs(n.y) + fabs(n.z);
    double most = 0x1p-19 * far * norm + 0x1p-46 * (far + rt_lengthd(dir));
    return (at_origin > most && at_light > most) || (at_origin < -most && at_light < -most);
}

#endif
