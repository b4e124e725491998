/* SPDX-License-Identifier: Apache-2.0 */
/* Clipped objects, which a structure lists only in cells near their surfaces, not in all cells that their
 * boxes meet: how near is enough, and for which rays.
 *
 * Let t be a hit on an object, p the ray's point there, org + t * dir in real numbers, and q the point of the
 * object's box nearest to p.
 *
 * 1. At t the thick ray is in every closed cell that contains q. On each axis a cell has two planes. If q and
 * p have the same coordinate, the ray reaches the near plane at or before t and the far plane at or after t
 * even without thickness, and the thickness, 16 half-ulps of the distance, exceeds the 2 roundings of a
 * crossing. If p lies outside the box, the same is true of the plane that separates p from q; and of the
 * other plane because rt_box_admit guarantees that t is between the crossings of the box, between which that
 * plane does not lie.
 *
 * 2. p is within 9 units of a point s of the surface, along each axis. Let D be the largest distance along
 * one axis from the origin to a point of the scene; a unit is 2^-24 D.
 * - Triangles: 9 units, by accel/wide/ray.h, 1, which includes the rounding of t.
 * - Others: that moves p by a unit. Before it, polygons and spheres, in double, are off by less than a unit.
 *   (The error of a sphere is divided by its radius, whose square is subtracted. Coordinates are at most 2^24
 *   times as large as D.)
 * - Cones: in double, but near the apex the error is a root. Let C be the largest distance of the cone from
 *   the middle of its axis, at most 2.12 D. The roundings add up to less than 150 * 2^-53 C^2 in the square
 *   of the radius (times the square of the slope, if that is above 1, and then s is above or below p): 5
 * units. rt_box_admit does not move t: by 3, with D for the object's box, that box contains s. q is as near
 * to s as p is, because s is in the box. CSG trees are not in this sum.
 *
 * So no hit is lost if some cell that contains q lists the object, and the traversal visits all cells that
 * the ray is in at t. For an origin in `domain`, the scene's box grown by 8 times its longest side, D is at
 * most 9 such sides. `margin` is 4 times the resulting bound, plus 2^-40 of the largest coordinate for the
 * arithmetic of core/shape/overlap.h. Rays from farther away are tested against every object; so are rays
 * whose dir is so long or so short that float32 runs out of exponents.
 *
 * 3. Trees of split references need no margin, wherever the origin is: at t the ray is in every box of the
 * scene that contains a point s within 14 units of p, enter(box) <= t <= leave(box). The near plane is at
 * most s, and org' is 16 units ahead of org; raytally_shift4 compensates the rounding of that. So (plane -
 * org') / dir is at least 2 units of distance before t. plane - org' and 1 / dir are rounded, by a unit each;
 * rounding the product cannot take it past t, a float32. The far plane likewise. 9 of the 14 units
 * suffice, by 2. CSG trees are cut like their boxes, so that q is in some part, and 1 applies. Scenes smaller
 * than RT_CLIPPED_LEAST_SIDE, where t may be denormal, are not cut. */
#ifndef RT_ACCEL_CLIPPING_H
#define RT_ACCEL_CLIPPING_H

#include "accel/kernel.h"

#define RT_CLIPPED_SIDES      8
#define RT_CLIPPED_LEAST_SIDE 0x1p-50
#define RT_ORDINARY_LEAST_DIR 0x1p-64f
#define RT_ORDINARY_MOST_DIR  0x1p64f

typedef struct RtClippedRays {
    RtBox domain;  /* of the origins of rays that cells of surfaces serve */
    double margin; /* a cell lists the surfaces within this distance */
} RtClippedRays;

/* For a scene and a structure with these boxes; the second contains the first. */
static inline RtClippedRays rt_clipped_rays(const RtBox *scene, const RtBox *structure) {
    RtClippedRays served;
    double longest = rt_box_longest_side(*scene), largest = rt_box_largest_coordinate(*structure);
    for (int a = 0; a < 3; a++) {
        served.domain.lo.at[a] = (float)((double)scene->lo.at[a] - RT_CLIPPED_SIDES * longest);
        served.domain.hi.at[a] = (float)((double)scene->hi.at[a] + RT_CLIPPED_SIDES * longest);
    }
    served.margin = 0x1p-18 * (RT_CLIPPED_SIDES + 1) * longest + 0x1p-40 * largest + 0x1p-80;
    return served;
}

/* Whether float32 has enough exponents for a ray whose longest component of dir is this, so that its hits are
 * near surfaces. */
RT_KERNEL bool rt_dir_is_ordinary(float longest) {
    return fabsf(longest) >= RT_ORDINARY_LEAST_DIR && fabsf(longest) <= RT_ORDINARY_MOST_DIR;
}

/* Whether cells that list surfaces serve this ray. */
RT_KERNEL bool rt_clipped_serves(const RtClippedRays *served, const RtPreparedRay *ray) {
    bool inside = rt_dir_is_ordinary(ray->dir[ray->kz]);
    for (int a = 0; a < 3; a++) {
        float org = ray->org[a];
        inside &= org >= served->domain.lo.at[a] && org <= served->domain.hi.at[a];
    }
    return inside;
}

#endif
