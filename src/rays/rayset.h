/* SPDX-License-Identifier: Apache-2.0 */
/* Ray sets: rays of one kind recorded from one scene, and traced by every accelerator alike.
 *
 * Primary, shadow, reflection and transmission rays are those of a frame of the scene, in the order of the
 * frame's tiles (each along a Z-order curve: render/frame.h), on any number of threads: neighbours in a set
 * start and end close to one another if the kind allows it. Diffuse rays start at the primary hits,
 * cosine-distributed about the normal; random rays are chords of the scene's bounding sphere between two
 * uniform points of it. Occlusion rays are the diffuse ones, of another kind. */
#ifndef RT_RAYS_RAYSET_H
#define RT_RAYS_RAYSET_H

#include "core/base/random.h"
#include "render/frame.h"

#define RT_MAX_RAYS_A_KIND UINT64_C(100000000)

/* Neighbours that stay together when a set is thinned, unless the user asks for another number. */
#define RT_COHERENT_RUN 256

typedef struct RtRaySet {
    RtRayKind kind;
    uint64_t count;
    RtRay *rays;          /* [count], owned; every ray is valid */
    uint64_t fingerprint; /* XXH3 of the rays: equal sets have equal fingerprints on every machine */
} RtRaySet;

typedef struct RtRecording {
    uint32_t kinds;          /* that are needed, bits 1 << RtRayKind; 0: all */
    uint32_t depth;          /* levels of the ray tree */
    uint64_t seed;           /* of diffuse and random rays */
    uint64_t random;         /* number of random rays */
    int threads;             /* 0 = all processors; does not change the sets */
    bool light_from_outside; /* as in RtFrameOptions */
} RtRecording;

/* Fills sets[RT_RAY_KIND_COUNT], indexed by kind; a kind that the scene does not produce gets an empty set,
 * and so does one that is not needed. No frame is traced for random rays, and only one level of the ray tree
 * where no kind needs those below. `accel` answers the recorded rays; it may be any exact one. Free each set
 * with rt_rayset_clear. */
RtStatus rt_rayset_record(RtRaySet *sets, const RtAccel *accel, const RtRecording *recording, RtError *error);

/* Keeps each `stride`th ray, starting with the first; 1 keeps all. */
RtStatus rt_rayset_thin(const RtRaySet *from, uint64_t stride, RtRaySet *to, RtError *error);

/* Keeps at most `limit` rays, evenly spread, in runs of `run` neighbours: one of every ceil(count / limit)
 * runs. Runs of 1 thin the set as above: the widest spread, for counting. Longer runs are picked at random
 * within their group; they preserve the coherence that packets and caches need, for timing. A run is at most
 * a 64th of `limit`, so that a small limit still samples many places of the image, at least 32. Runs of 64
 * and more are cut to a multiple of 64, which keeps whole blocks of 8 x 8 samples of primary rays. */
RtStatus rt_rayset_limit(const RtRaySet *from, uint64_t limit, uint64_t run, RtRaySet *to, RtError *error);

/* Makes a set of `count` rays, unset, for the caller to fill; rt_rayset_seal then sets its fingerprint. */
RtStatus rt_rayset_init(RtRaySet *set, RtRayKind kind, uint64_t count, RtError *error);
void rt_rayset_seal(RtRaySet *set);

void rt_rayset_clear(RtRaySet *set);

/* The sphere through the corners of `box`; the unit sphere for the empty box. */
RtBall rt_bounding_sphere(const RtBox *box);

/* A random ray from one uniform point of `sphere` towards another; dir is not normalised: t = 1 is the other
 * point; tmin 0, tmax infinite. Such chords are uniformly distributed lines, by direction and by area. */
RtRay rt_sphere_chord(const RtBall *sphere, RtRandom *random);

/* A chord of the bounding sphere of `box`. */
RtRay rt_random_chord(const RtBox *box, RtRandom *random);

#endif
