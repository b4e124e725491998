/* SPDX-License-Identifier: Apache-2.0 */
/* light: the light buffer of Haines & Greenberg 1986, an overlay for shadow rays.
 *
 * A ray to a light lies in one cell of the cube around it, and can be blocked by the objects in the list of
 * that cell alone, and of these by none that is deeper than the ray's origin or not around the ray's place in
 * the cell. Lists end where a cell is likely to be covered, or where they would be too long: a ray that comes
 * to such an end is passed on. So nothing need be proved about covers, and lists may be cut anywhere.
 *
 * Every object is opaque: shadow rays are blocked by whatever they meet, transmission or not (rt_shadow_ray
 * in render/illumination.c and its caller attenuate nothing). So any shape that fills a cell can cover it.
 *
 * Exact: every object is tested by its own hit function, or the same in lanes (accel/pairs.h); lists hold
 * more than needed rather than less (footprint.c). Passed on are also rays that are not exactly what a shadow
 * ray is: from inside the domain, dir = light - origin, tmax at most 1. */
#include "accel/light/light.h"

static const RtLightKernels *kernels_of(const RtAccel *accel) {
    return ((const RtLightBuffer *)accel)->kernels;
}

static void nearest(const RtAccel *accel, const RtScratch *scratch, const RtRay *rays, size_t count,
                    RtHit *hits) {
    kernels_of(accel)->nearest(accel, scratch, rays, count, hits);
}

static void occluded(const RtAccel *accel, const RtScratch *scratch, const RtRay *rays, size_t count,
                     uint32_t *blockers) {
    kernels_of(accel)->occluded(accel, scratch, rays, count, blockers);
}

static void count_nearest(const RtAccel *accel, const RtScratch *scratch, const RtRay *rays, size_t count,
                          RtHit *hits, RtTally *tallies) {
    kernels_of(accel)->nearest_counted(accel, scratch, rays, count, hits, tallies);
}

static void count_occluded(const RtAccel *accel, const RtScratch *scratch, const RtRay *rays, size_t count,
                           uint32_t *blockers, RtTally *tallies) {
    kernels_of(accel)->occluded_counted(accel, scratch, rays, count, blockers, tallies);
}

static size_t scratch_bytes(const RtAccel *accel) {
    return kernels_of(accel)->scratch_bytes;
}

const RtAccelOps rt_light_ops = {
    .name = "light",
    .summary = "overlay: a cube of cells around each light, with the objects seen in each cell by depth",
    .paper = "Haines & Greenberg 1986, The Light Buffer: A Shadow-Testing Accelerator, CG&A 6(9)",
    RT_PARAMS_OF(rt_light_params),
    .kinds = 1u << RT_RAY_SHADOW,
    .build = rt_light_build,
    .destroy = rt_light_destroy,
    .nearest = nearest,
    .occluded = occluded,
    .nearest_counted = count_nearest,
    .occluded_counted = count_occluded,
    .scratch_bytes = scratch_bytes,
    .describe = rt_light_describe,
    .validate = rt_light_validate,
    .look_up = rt_light_look_up,
};
