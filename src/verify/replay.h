/* SPDX-License-Identifier: Apache-2.0 */
/* A replay file: a wrong answer with all that it takes to ask again, on any machine, in one JSON document.
 *
 *   scene, fingerprint   the scene as it was named, and its rt_scene_fingerprint; "yaml" is the scene itself
 *                        where it came from a file and is not too large
 *   sampling             [columns, rows] of the camera's image, which item buffers depend on
 *   accel                the spec
 *   query, kernel        nearest or occluded, timed or counted
 *   stream, rays, asked  the length of streams, the rays in the order of asking, floats in hexadecimal, bit
 *                        for bit, and which of the rays is in question
 *   expected, got        brute's nearest hit of that ray, and what the accelerator answered
 *   shrunk               null, or the objects that are left, by id, their scene as YAML, the answers there,
 *                        and "minimal": whether each of them is needed for the answers to differ */
#ifndef RT_VERIFY_REPLAY_H
#define RT_VERIFY_REPLAY_H

#include "verify/shrink.h"

/* What is written. */
typedef struct RtReplayRecord {
    const char *scene_spec, *accel_spec;
    const RtScene *scene;
    const RtFailure *failure;
    const RtAnswer *answer;
    const RtShrunk *shrunk; /* NULL where the answer could not be repeated */
} RtReplayRecord;

RtStatus rt_replay_save(const char *path, const RtReplayRecord *record, RtError *error);

/* A replay file in memory. Clear with rt_replay_clear. */
typedef struct RtReplay {
    json_t *document;
    RtRay *rays;                                              /* owned */
    RtFailure failure;                                        /* of `rays` */
    const char *scene_spec, *accel_spec, *yaml, *shrunk_yaml; /* in the document; the last two or NULL */
    uint64_t fingerprint;
    uint32_t columns, rows;
} RtReplay;

/* Refuses what is not a replay file, and rays that are not valid. On failure nothing is owned. */
RtStatus rt_replay_load(RtReplay *replay, const char *path, RtError *error);
void rt_replay_clear(RtReplay *replay);

/* Asks what `maker` builds (as a rule, what the spec says) again over the scene, or with `shrunk` over what
 * was left of it: RT_NOT_AVAILABLE where nothing was shrunk, RT_BAD_INPUT where the scene is no longer what
 * it was: then nothing is said about the answer. */
RtStatus rt_replay_ask(const RtReplay *replay, RtMaker maker, bool shrunk, RtAnswer *answer, RtError *error);

#endif
