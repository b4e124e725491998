/* SPDX-License-Identifier: Apache-2.0 */
/* Families of rays that are hard on accelerators: they graze, start or end on surfaces, or run along axes,
 * edges and the faces of boxes.
 *
 * All are generated from a seed, ray by ray from a stream of its own: ray i of a family is the same whoever
 * asks, in any order, on any thread. A family that has nothing to aim at (no vertices in a scene of spheres,
 * an empty scene) aims at points that serve as well. */
#ifndef RT_VERIFY_RAY_FAMILIES_H
#define RT_VERIFY_RAY_FAMILIES_H

#include "accel/accel.h"
#include "core/base/random.h"

/* So many in a row, from a multiple of it on, go nearly the same way where the family is of bundles. */
enum { RT_RAY_BUNDLE = 256 };

/* The first family is `chord`: random chords of the scene's bounding sphere. */
size_t rt_ray_family_count(void);
const char *rt_ray_family_name(size_t family);

/* Rays first..first+count-1 of a family for the scene of `query`, to rays[0..count): every one is valid. They
 * are of kind random, but for those towards lights and through the samples of the image. `query` belongs to
 * any exact accelerator: some families need the hit of a ray. */
void rt_ray_family_fill(size_t family, RtQuery *query, uint64_t seed, uint64_t first, size_t count,
                        RtRay *rays);

#endif
