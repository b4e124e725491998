/* SPDX-License-Identifier: Apache-2.0 */
/* The rays by which a scene is verified, and the stage on which accelerators are asked them.
 *
 * A tenth of them come from a small frame of the scene's camera, in equal shares of primary, shadow,
 * reflection, transmission and diffuse rays as far as the scene produces them. The others are random chords
 * and rays of every family that is hard on accelerators, in equal shares. */
#ifndef RT_VERIFY_VERIFY_RAYS_H
#define RT_VERIFY_VERIFY_RAYS_H

#include "rays/rayset.h"
#include "verify/equivalence.h"

typedef struct RtVerifyRays {
    uint64_t count, seed;
    int threads;
    const RtRaySet *given; /* NULL; or the rays, `count` of them, that take the place of all others */
} RtVerifyRays;

/* Fills rays[0..wanted->count), the same ones at any number of threads. `oracle` is any exact accelerator. */
RtStatus rt_verify_rays(const RtVerifyRays *wanted, const RtAccel *oracle, RtRay *rays, RtError *error);

/* A scene as it is verified: its rays, and the right answers. It stays where it is, for its members know one
 * another's places. */
typedef struct RtVerifyStage {
    /* The scene, its image sampled as sparsely as its share of the rays asks for; as it was where rays are
     * given. Accelerators know the samples (item): those to be verified are built over this one. Its arrays
     * are those of the scene that it is made from, which is left as it is and outlives the stage. */
    RtScene scene;
    RtAccel *truth;
    RtRay *rays;
    RtReference reference;
} RtVerifyStage;

/* Samples the scene and records the rays: the same ones for equal `wanted`, whoever asks, however the scene
 * is sampled. *stage is cleared whatever comes of it. */
RtStatus rt_verify_stage_init(RtVerifyStage *stage, const RtScene *scene, const RtVerifyRays *wanted,
                              RtError *error);
/* Answers them, by every object for each: to stage->reference. */
RtStatus rt_verify_stage_answer(RtVerifyStage *stage, const RtVerifyRays *wanted, RtError *error);
/* A zeroed stage may be cleared. */
void rt_verify_stage_clear(RtVerifyStage *stage);

#endif
