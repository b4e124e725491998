/* SPDX-License-Identifier: Apache-2.0 */
/* The rays by which a scene is verified, and the scene with its rays and reference answers.
 *
 * A tenth of the rays come from a small frame of the scene's camera, in equal shares of primary, shadow,
 * reflection, transmission and diffuse rays as far as the scene produces them. The others are random
 * chords and rays of every hard family, in equal shares. */
#ifndef RT_VERIFY_VERIFY_RAYS_H
#define RT_VERIFY_VERIFY_RAYS_H

#include "rays/rayset.h"
#include "verify/equivalence.h"

/* ---- families ---- */

/* Rays that are hard on accelerators: they graze, start or end on surfaces, or run along axes, edges and the
 * faces of boxes. Each is generated from its own stream of the seed, so ray i of a family is always the same.
 * A family without a target (no vertices in a scene of spheres) aims at other suitable points. */

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

/* ---- all rays of a scene ---- */

typedef struct RtVerifyRays {
    uint64_t count, seed;
    int threads;
    const RtRaySet *given; /* NULL, or `count` rays to use instead */
} RtVerifyRays;

/* Fills rays[0..wanted->count), identically for any number of threads. `oracle` is any exact accelerator. */
RtStatus rt_verify_rays(const RtVerifyRays *wanted, const RtAccel *oracle, RtRay *rays, RtError *error);

/* A scene prepared for verification. It must not move, because its members point to each other. */
typedef struct RtVerifyScene {
    /* A shallow copy of the caller's scene, which must outlive it and is not changed. Its image is sampled
     * according to the share of camera rays (unchanged for given rays). The accelerators under test are
     * built over this copy, since some (item) depend on the samples. */
    RtScene scene;
    RtAccel *truth;
    RtRay *rays;
    RtReference reference; /* `truth` at `rays`; set by the caller, who knows when it is needed */
    const char *name;      /* for the rows; set by the caller */
} RtVerifyScene;

/* Samples the scene and records the rays, which depend on `wanted` and the scene alone, not on its
 * sampling. Call rt_verify_scene_clear also after a failure. */
RtStatus rt_verify_scene_init(RtVerifyScene *scene, const RtScene *from, const RtVerifyRays *wanted,
                              RtError *error);
/* A zeroed struct may be cleared. */
void rt_verify_scene_clear(RtVerifyScene *scene);

#endif
