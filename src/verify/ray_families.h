/* SPDX-License-Identifier: Apache-2.0 */
/* Families of rays that are hard on accelerators: they graze, start or end on surfaces, or run along axes,
 * edges and the faces of boxes.
 *
 * Each ray is generated from its own stream of the seed, so ray i of a family is always the same. A family
 * without a target (no vertices in a scene of spheres) aims at other suitable points. */
#ifndef RT_VERIFY_RAY_FAMILIES_H
#define RT_VERIFY_RAY_FAMILIES_H

#include "accel/accel.h"

/* Rays in a bundle; a bundle starts at a multiple of this number. */
enum { RT_RAY_BUNDLE = 256 };

/* The first family is `chord`: random chords of the scene's bounding sphere. */
size_t rt_ray_family_count(void);
const char *rt_ray_family_name(size_t family);

/* Generates rays first..first+count-1 of a family for the scene of `query`; all are valid. They are of
 * kind random, except those towards lights and through samples of the image. `query` belongs to any exact
 * accelerator: some families need the hit of a ray. */
void rt_ray_family_fill(size_t family, RtQuery *query, uint64_t seed, uint64_t first, size_t count,
                        RtRay *rays);

#endif
