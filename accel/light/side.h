/* SPDX-License-Identifier: Apache-2.0 */
/* Does the plane of a flat object (triangle, polygon) lie between a ray's origin and its light?
 *
 * Exact. A hit at t is a point of the ray within delta of the object, along each axis, where for m the
 * distance along an axis from the origin to the farthest point of the object, e = 2^-24:
 *
 * - A triangle's hit function takes vertices that are displaced by at most 7 e m (accel/extent.h), and from
 *   there on computes with relative errors of 2^-52: weights that are not negative, and a t at which the ray
 *   passes through the point that they give. Rounding t to float32 and clamping it to where the thick ray is
 *   in the box, which is wider than the displacement, move the point by a few e m more.
 * - A polygon's hit function computes in double; of it only the rounding of t is left.
 *
 * delta = 32 e m = 2^-19 m is above both. So if the ray, at t = 0 and at t = 1 >= tmax, is on one side of the
 * plane by more than delta |normal|_1, then no t between can be a hit: distances are linear in t. The
 * rounding of the distances themselves, in double, is below 2^-48 of the products that they are made of. */
#ifndef RT_ACCEL_LIGHT_SIDE_H
#define RT_ACCEL_LIGHT_SIDE_H

#include "accel/kernel.h"

RT_KERNEL bool rt_light_is_flat(const RtGeometry *geometry, uint32_t id) {
    RtShape shape = rt_ref_shape(geometry->objects[id]);
    return shape == RT_SHAPE_TRIANGLE || shape == RT_SHAPE_POLYGON;
}

static inline double rt_light_norm(RtVec3d v) {
    return fabs(v.x) + fabs(v.y) + fabs(v.z);
}

/* `scale`: what the rounding errors of the normal are in proportion to. */
static inline bool rt_light_plane_is_between(RtVec3d point, RtVec3d normal, double scale, const RtBox *box,
                                             const RtPreparedRay *ray) {
    RtVec3d org = rt_widen(ray->org), dir = rt_widen(ray->dir);
    double away = 0;
    for (int a = 0; a < 3; a++) {
        away = fmax(away,
                    fmax(fabs((double)box->lo.at[a] - org.at[a]), fabs((double)box->hi.at[a] - org.at[a])));
    }
    double at_origin = rt_dotd(normal, rt_subd(org, point)), at_light = at_origin + rt_dotd(normal, dir);
    double most = 0x1p-19 * away * rt_light_norm(normal) + 0x1p-46 * scale * (away + rt_light_norm(dir));
    return !((at_origin > most && at_light > most) || (at_origin < -most && at_light < -most));
}

/* `id` is flat, the ray's tmax at most 1. False only if the object is not hit. */
static inline bool rt_light_is_between(const RtGeometry *geometry, uint32_t id, const RtPreparedRay *ray) {
    uint32_t index = rt_ref_index(geometry->objects[id]);
    const RtBox *box = &geometry->boxes[id];
    if (rt_ref_shape(geometry->objects[id]) == RT_SHAPE_POLYGON) {
        const RtPolygon *polygon = &geometry->polygons[index];
        return rt_light_plane_is_between(polygon->center, polygon->normal, 1, box, ray);
    }
    const RtVec3 *v = geometry->triangles[index].v;
    RtVec3d a = rt_widen(v[0]), ab = rt_subd(rt_widen(v[1]), a), ac = rt_subd(rt_widen(v[2]), a);
    return rt_light_plane_is_between(a, rt_crossd(ab, ac), rt_light_norm(ab) * rt_light_norm(ac), box, ray);
}

#endif
