/* SPDX-License-Identifier: Apache-2.0 */
/* For structures that list an object only in cells near its surface, not in all that its box meets: how near
 * that is, and for which rays.
 *
 * Let a hit on an object be at t, p the ray's point there, org + t * dir in real numbers, and q the point
 * nearest to p of the object's own box.
 *
 * At t the thick ray is in every closed cell that holds q. On each axis a cell has two planes. Where q is as
 * far as p, the ray reaches the near plane at or before t and the far plane at or after it even without
 * thickness, and the thickness, 16 half-ulps of the distance, outweighs the 4 roundings of a crossing. Where
 * p lies outside the own box, the same holds of the plane that p is beyond q of; and of the other because
 * rt_box_admit saw to it that t is within the crossings of the own box, between which the plane is not.
 *
 * And q is within `margin`, along each axis, of the surface, for p is and points of the surface lie in the
 * own box, where q is no farther from them than p is. Let D be the distance, along the axis where it is
 * largest, from the origin to the farthest point of the scene. A triangle is hit as if its vertices, moved to
 * the origin and sheared in float32, lay up to 8 * 2^-24 D elsewhere (core/shape/triangle.h; what follows is
 * in double). Polygons and spheres are hit in double: off by less than 2^-44 D. So are cones; but near the
 * apex an error of 2^-50 D^2 in the square of the radius is 2^-25 D. (A sphere's error is divided by its
 * radius, that of which the square is subtracted.) Rounding t moves the point by 2^-24 D, and rt_box_admit by
 * at most 4 * 2^-24 D: the hit itself is inside the thick box, and the crossing it is held to has 4
 * roundings. In all less than 16 * 2^-24 D.
 *
 * So a hit is not lost if some cell that holds q lists the object, and all cells that the ray is in at t are
 * visited. For an origin in `domain`, the scene's box grown by 8 times its longest side, D is at most 9 such
 * sides: `margin` is 4 times what that asks for, plus 2^-40 of the largest coordinate for the arithmetic of
 * core/shape/overlap.h. Rays from farther away are to be tested against every object; so are those with a dir
 * so long or short that float32 runs out of exponents.
 *
 * Instead of the cells the ray may be made thicker (rt_surface_thicken), from wherever it comes. Let s be the
 * point of the surface near to p. Then at t the ray is in every box that holds s: enter(box) <= t <=
 * leave(box). The thickness is 32 * 2^-24 D. Of these 16 bring the line to s, on each axis; the rest
 * outweighs the 3 roundings of a crossing, (plane - org') * inv, each of 2^-24 |plane - org'|, as that of
 * org' is made up for by rt_shift4. */
#ifndef RT_ACCEL_SURFACE_H
#define RT_ACCEL_SURFACE_H

#include "accel/kernel.h"

#define RT_SURFACE_SIDES 8

typedef struct RtSurfaceRays {
    RtBox domain;  /* of the origins of the rays that are served */
    double margin; /* cells are grown by so much before surfaces are put into them */
} RtSurfaceRays;

/* For a scene with this box, in a structure with one that contains it. */
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

/* Has float32 the exponents for this ray, so that its hits are near surfaces? */
RT_KERNEL bool rt_surface_is_near(const RtPreparedRay *ray) {
    float longest = fabsf(ray->dir.at[ray->kz]);
    return longest >= 0x1p-64f && longest <= 0x1p64f;
}

/* Makes a ray so thick that at the t of a hit it is in every box of the scene that holds the point of the
 * surface near to the hit. */
RT_KERNEL void rt_surface_thicken(RtPreparedRay *ray, const RtBox *scene) {
    rt_ray_set_thickness(ray, 2 * rt_thickness(ray->org, scene) + 0x1p-80f);
}

/* Do cells that list surfaces serve this ray? */
RT_KERNEL bool rt_surface_serves(const RtSurfaceRays *served, const RtPreparedRay *ray) {
    bool inside = rt_surface_is_near(ray);
    for (int a = 0; a < 3; a++) {
        float org = ray->org.at[a];
        inside &= org >= served->domain.lo.at[a] && org <= served->domain.hi.at[a];
    }
    return inside;
}

#endif
