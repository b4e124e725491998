/* Families of scenes and of rays that are hard on accelerators: where objects coincide, are flat, huge, tiny
 * or far away; where rays graze, start or end on surfaces, or run along axes, edges and the faces of boxes.
 *
 * All are generated from a seed, ray by ray from a stream of its own: ray i of a family is the same whoever
 * asks, in any order, on any thread. A family that has nothing to aim at (no vertices in a scene of spheres,
 * an empty scene) aims at points that serve as well. */
#ifndef RT_EXPERIMENTS_FAMILIES_H
#define RT_EXPERIMENTS_FAMILIES_H

#include "accel/accel.h"
#include "base/random.h"

size_t rt_scene_family_count(void);
const char *rt_scene_family_name(size_t family);

/* Builds scene number `seed` of a family, finished, with 0 to a few hundred objects and an image of a
 * thousand pixels; its name is the family's. Owned by the caller: rt_scene_clear. */
RtStatus rt_scene_family_build(size_t family, uint64_t seed, RtScene *scene, RtError *error);

/* The words by which a scene of a family is opened: "family:NAME,seed=N". */
#define RT_FAMILY_PREFIX "family:"

/* Opens such a scene, or any that rt_scene_open does. */
RtStatus rt_hard_scene_open(const char *spec, RtScene *scene, RtError *error);

/* The first family is `chord`: random chords of the scene's bounding sphere. */
size_t rt_ray_family_count(void);
const char *rt_ray_family_name(size_t family);

/* Rays first..first+count-1 of a family for the scene of `query`, to rays[0..count): every one is valid. They
 * are of kind random, but for those towards lights and through the samples of the image. `query` belongs to
 * any exact accelerator: some families need the hit of a ray. */
void rt_ray_family_fill(size_t family, RtQuery *query, uint64_t seed, uint64_t first, size_t count,
                        RtRay *rays);

#endif
