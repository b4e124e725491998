/* SPDX-License-Identifier: Apache-2.0 */
/* For structures that list an object only in cells near its surface, not in all cells that its box meets: how
 * near is enough, and for which rays.
 *
 * Let t be a hit on an object, p the ray's point there, org + t * dir in real numbers, and q the point of the
 * object's box nearest to p.
 *
 * 1. At t the thick ray is in every closed cell that contains q. On each axis a cell has two planes. If q and
 * p have the same coordinate, the ray reaches the near plane at or before t and the far plane at or after t
 * even without thickness, and the thickness, 16 half-ulps of the distance, exceeds the 4 roundings of a
 * crossing. If p lies outside the box, the same is true of the plane that separates p from q; and of the
 * other plane because rt_box_admit guarantees that t is between the crossings of the box, between which that
 * plane does not lie.
 *
 * 2. q is within `margin` of the surface along each axis: p is, and no point of the surface, all of which lie
 * in the box, is farther from q than from p. Let D be the largest distance along one axis from the origin to
 * a point of the scene. A triangle is hit as if its vertices, moved to the origin and sheared in float32,
 * were displaced by up to 8 * 2^-24 D (core/shape/triangle.h; the rest of that test is in double). Polygons
 * and spheres are tested in double, with an error below 2^-44 D. (The error of a sphere is divided by its
 * radius, whose square is subtracted.) So are cones; but near the apex an error of 2^-50 D^2 in the square of
 * the radius is 2^-25 D. Rounding t moves the point by 2^-24 D, and rt_box_admit moves it by at most 4 *
 * 2^-24 D: the hit itself is inside the thick box, and the crossing that bounds it has 4 roundings. The total
 * is less than 16 * 2^-24 D.
 *
 * So no hit is lost if some cell that contains q lists the object, and the traversal visits all cells that
 * the ray is in at t. For an origin in `domain`, the scene's box grown by 8 times its longest side, D is at
 * most 9 such sides. `margin` is 4 times the resulting bound, plus 2^-40 of the largest coordinate for the
 * arithmetic of core/shape/overlap.h. Rays from farther away are tested against every object; so are rays
 * whose dir is so long or so short that float32 runs out of exponents.
 *
 * Instead of enlarging cells, one can thicken the ray (rt_surface_thicken), wherever its origin is. Let s be
 * the point of the surface near p. Then at t the ray is in every box that contains s: enter(box) <= t <=
 * leave(box). The thickness is 32 * 2^-24 D. 16 of these move the line to s, on each axis; the others exceed
 * the 3 roundings of a crossing, (plane - org') * inv, each at most 2^-24 |plane - org'|; rt_shift4
 * compensates that of org'. */
#ifndef RT_ACCEL_SURFACE_H
#define RT_ACCEL_SURFACE_H

#include "accel/kernel.h"

#define RT_SURFACE_SIDES 8

typedef struct RtSurfaceRays {
    RtBox domain;  /* of the origins of rays that cells of surfaces serve */
    double margin; /* a cell lists the surfaces within this distance */
} RtSurfaceRays;

/* For a scene and a structure with these boxes; the second contains the first. */
static inline RtSurfaceRays rt_surface_rays(const RtBox *scene, const RtBox *structure) {
    RtSurfaceRays served;
    double longest = rt_box_longest_side(*scene), largest = rt_box_largest_coordinate(*structure);
    for (int a = 0; a < 3; a++) {
        served.domain.lo.at[a] = (float)((double)scene->lo.at[a] - RT_SURFACE_SIDES * longest);
        served.domain.hi.at[a] = (float)((double)scene->hi.at[a] + RT_SURFACE_SIDES * longest);
    }
    served.margin = 0x1p-18 * (RT_SURFACE_SIDES + 1) * longest + 0x1p-40 * largest + 0x1p-80;
    return served;
}

/* Whether float32 has enough exponents for this ray, so that its hits are near surfaces. */
RT_KERNEL bool rt_surface_is_near(const RtPreparedRay *ray) {
    float longest = fabsf(ray->dir.at[ray->kz]);
    return longest >= 0x1p-64f && longest <= 0x1p64f;
}

/* Thickens a ray so that at the t of a hit it is in every box of the scene that contains the point of the
 * surface near the hit. */
RT_KERNEL void rt_surface_thicken(RtPreparedRay *ray, const RtBox *scene) {
    rt_ray_set_thickness(ray, 2 * rt_thickness(ray->org, scene) + 0x1p-80f);
}

/* Whether cells that list surfaces serve this ray. */
RT_KERNEL bool rt_surface_serves(const RtSurfaceRays *served, const RtPreparedRay *ray) {
    bool inside = rt_surface_is_near(ray);
    for (int a = 0; a < 3; a++) {
        float org = ray->org.at[a];
        inside &= org >= served->domain.lo.at[a] && org <= served->domain.hi.at[a];
    }
    return inside;
}

#endif
