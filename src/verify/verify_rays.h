/* SPDX-License-Identifier: Apache-2.0 */
/* The rays by which a scene is verified.
 *
 * A tenth of them come from a small frame of the scene's camera, in equal shares of primary, shadow,
 * reflection, transmission and diffuse rays as far as the scene produces them. The others are random chords
 * and rays of every family that is hard on accelerators, in equal shares. */
#ifndef RT_VERIFY_VERIFY_RAYS_H
#define RT_VERIFY_VERIFY_RAYS_H

#include "bench/rayset.h"

typedef struct RtVerifyRays {
    uint64_t count, seed;
    int threads;
    const RtRaySet *given; /* NULL; or the rays, `count` of them, that take the place of all others */
} RtVerifyRays;

/* Has the scene sampled as sparsely as its share of rays asks for; before accelerators are built over it. */
RtStatus rt_verify_sample(const RtVerifyRays *wanted, RtScene *scene, RtError *error);

/* Fills rays[0..wanted->count), the same ones at any number of threads. `oracle` is any exact accelerator. */
RtStatus rt_verify_rays(const RtVerifyRays *wanted, const RtAccel *oracle, RtRay *rays, RtError *error);

#endif
