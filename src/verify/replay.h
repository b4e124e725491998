/* SPDX-License-Identifier: Apache-2.0 */
/* A replay file: a wrong answer with everything needed to repeat the query, as one JSON document.
 *
 *   scene, fingerprint   the scene's name and rt_scene_fingerprint; "yaml" is the scene itself if it came
 *                        from a file and is not too large
 *   sampling             [columns, rows] of the camera's image, which item buffers depend on
 *   accel                the spec
 *   query, kernel        nearest or occluded, timed or counted
 *   stream, rays, asked  the length of streams, the rays in order (floats in hexadecimal, bit for bit), and
 *                        the index of the ray with the wrong answer
 *   expected, got        brute's nearest hit of that ray, and the accelerator's answer
 *   shrunk               null, or the ids of the remaining objects, their scene as YAML, the answers there,
 *                        and "minimal": whether the answers differ only if all of them are present */
#ifndef RT_VERIFY_REPLAY_H
#define RT_VERIFY_REPLAY_H

#include "verify/failure.h"

/* The content of a replay file. */
typedef struct RtReplayRecord {
    const char *scene_spec;
    const RtScene *scene;
    const RtFailure *failure;
    const RtAnswer *answer;
    const RtShrunk *shrunk; /* NULL if the failure could not be repeated */
} RtReplayRecord;

RtStatus rt_replay_save(const char *path, const RtReplayRecord *record, RtError *error);

/* A replay file in memory. Clear with rt_replay_clear. */
typedef struct RtReplay {
    json_t *document;
    RtRay *rays;                                 /* owned */
    RtFailure failure;                           /* of `rays`, of a spec in the document */
    const char *scene_spec, *yaml, *shrunk_yaml; /* in the document; the last two or NULL */
    uint64_t fingerprint;
    uint32_t columns, rows;
} RtReplay;

/* Rejects other files, and invalid rays. On failure nothing is owned. */
RtStatus rt_replay_load(RtReplay *replay, const char *path, RtError *error);
void rt_replay_clear(RtReplay *replay);

/* Repeats the query over the scene, or over its remaining objects if `shrunk`. RT_NOT_AVAILABLE if nothing
 * was shrunk, RT_BAD_INPUT if the scene has changed; then nothing is known about the answer. */
RtStatus rt_replay_ask(const RtReplay *replay, bool shrunk, RtAnswer *answer, RtError *error);

#endif
