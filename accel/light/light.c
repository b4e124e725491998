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
 * Exact: every object is tested by its own hit function, or the same in lanes (light_pairs.h); lists hold
 * more than needed rather than less (light_footprint.c). Passed on are also rays that are not exactly what a
 * shadow ray is: from inside the domain, dir = light - origin, tmax at most 1. */
#include "accel/light/light.h"

const RtAccelOps rt_light_ops = {
    .name = "light",
    .summary = "overlay: a cube of cells around each light, with the objects seen in each cell by depth",
    .paper = "Haines & Greenberg 1986, The Light Buffer: A Shadow-Testing Accelerator, CG&A 6(9)",
    RT_PARAMS_OF(rt_light_params),
    .kinds = 1u << RT_RAY_SHADOW,
    .trial = "light:cells=100", /* a scene of few objects has no cells but those asked for */
    .build = rt_light_build,
    .destroy = rt_light_destroy,
    RT_ISA_OPS,
    .scratch_bytes = rt_isa_scratch_bytes,
    .describe = rt_light_describe,
    .validate = rt_light_validate,
    .find_cell = rt_light_find_cell,
};
