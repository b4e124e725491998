/* SPDX-License-Identifier: Apache-2.0 */
/* A failure: rays one of which an accelerator answers wrong, for repeating the query: over the same scene,
 * over a part of it, or with another build; and the fewest objects over which it still fails.
 *
 * The query is repeated with a newly built accelerator as in a check (verify/equivalence.h): `nearest` and
 * `occluded` in turn, stream by stream, with one of the two kernels. The other rays are included because a
 * failure may depend on earlier or simultaneous queries.
 *
 * Shrinking is delta debugging (Zeller & Hildebrandt 2002, "Simplifying and Isolating Failure-Inducing
 * Input", IEEE TSE 28(2)): objects are removed in halves, quarters, ... down to single ones while the answer
 * stays wrong; each try builds the accelerator over the remaining objects and repeats the query. Objects keep
 * their order. In the end every remaining object is necessary, unless the budget was exhausted. */
#ifndef RT_VERIFY_FAILURE_H
#define RT_VERIFY_FAILURE_H

#include "verify/equivalence.h"

typedef struct RtFailure {
    const char *spec;  /* the accelerator; borrowed */
    int threads;       /* to build it on; 0 = all processors. They do not affect the structure */
    const RtRay *rays; /* [count] borrowed, valid */
    size_t count;
    size_t asked;  /* the ray with the wrong answer */
    size_t stream; /* length of the streams */
    bool occluded, counted;
} RtFailure;

typedef struct RtAnswer {
    RtHit expected; /* brute's nearest hit */
    RtHit got;      /* answer to `nearest` */
    bool blocked;   /* answer to `occluded` */
    bool wrong;     /* the answer in question is wrong */
} RtAnswer;

/* Builds over `scene`, traces the rays, and compares with brute. */
RtStatus rt_failure_ask(const RtFailure *failure, const RtScene *scene, RtAnswer *answer, RtError *error);

/* The failure for a wrong answer of the accelerator of `spec`: its ray alone if that suffices, otherwise with
 * all rays that were traced together with it. `answer->wrong` is false if even then the answer is right: the
 * error depended on more. */
RtStatus rt_failure_of(const RtReference *reference, const RtWrongAnswer *wrong, const char *spec,
                       int threads, RtFailure *failure, RtAnswer *answer, RtError *error);

/* ---- recorded answers ---- */

/* Nothing can be repeated for a wrong answer of rt_equivalence_judge. Writes the objects near its ray, those
 * that rounding lets it hit and both of the answers, to a scene file, a .yaml, whose first lines say what it
 * is; *count: their number. 0: there is none, and no file. Objects of instances become copies, if they can;
 * otherwise there is none. */
RtStatus rt_near_save(const RtScene *scene, const RtWrongAnswer *wrong, const char *path, uint32_t *count,
                      RtError *error);

/* ---- shrinking ---- */

typedef void RtShrinkTried(void *context, uint32_t left, uint32_t tries);

/* The budget counts objects built over, so that the result does not depend on a clock; it lasts some
 * seconds. */
#define RT_SHRINK_BUDGET (UINT64_C(1) << 21)

typedef struct RtShrunk {
    uint32_t *ids; /* [count] remaining objects, ascending; owned: rt_free */
    uint32_t count, tries;
    bool minimal;    /* false: the budget was exhausted */
    RtAnswer answer; /* over the remaining objects; its ids are positions in `ids` */
} RtShrunk;

/* Shrinks `scene` for a failure with `answer`. After each try, tried(context, remaining objects, tries) is
 * called unless it is NULL. If the accelerator cannot be built over a part, its answer there counts as right.
 */
RtStatus rt_shrink(const RtScene *scene, const RtFailure *failure, const RtAnswer *answer, uint64_t budget,
                   RtShrinkTried *tried, void *context, RtShrunk *out, RtError *error);

/* ---- replay files ---- */

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
