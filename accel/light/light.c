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
 * Exact: every object is tested by its own hit function, or the same in lanes (accel/pairs.h); lists hold more
 * than needed rather than less (footprint.c). Passed on are also rays that are not exactly what a shadow ray
 * is: from inside the domain, dir = light - origin, tmax at most 1. */
#include "accel/kernel.h"
#include "accel/light/light.h"

const RtLightKernels *rt_light_kernels(RtIsa isa) {
    return isa == RT_ISA_AVX512 ? &rt_light_avx512 : isa == RT_ISA_AVX2 ? &rt_light_avx2 : &rt_light_portable;
}

static const RtLightBuffer *buffer_of(const RtAccel *accel) {
    return (const RtLightBuffer *)accel;
}

static void occluded_timed(const RtAccel *accel, const RtScratch *scratch, const RtRay *rays, size_t count,
                           uint32_t *blockers) {
    buffer_of(accel)->kernels->occluded(accel, scratch, rays, count, blockers);
}

static void occluded_counted(const RtAccel *accel, const RtScratch *scratch, const RtRay *rays, size_t count,
                             uint32_t *blockers, RtTally *tallies) {
    buffer_of(accel)->kernels->occluded_counted(accel, scratch, rays, count, blockers, tallies);
}

RT_REFUSE_QUESTION(nearest, RtHit)

static size_t scratch_bytes(const RtAccel *accel) {
    return buffer_of(accel)->kernels->scratch_bytes;
}

const RtAccelOps rt_light_ops = {
    .name = "light",
    .summary = "overlay: a cube of cells around each light, with the objects seen in each cell by depth",
    .paper = "Haines & Greenberg 1986, The Light Buffer: A Shadow-Testing Accelerator, CG&A 6(9)",
    RT_PARAMS_OF(rt_light_params),
    .kinds = 1u << RT_RAY_SHADOW,
    .build = rt_light_build,
    .destroy = rt_light_destroy,
    RT_KERNEL_OPS,
    .scratch_bytes = scratch_bytes,
    .describe = rt_light_describe,
    .validate = rt_light_validate,
};
