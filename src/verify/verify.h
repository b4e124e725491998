/* SPDX-License-Identifier: Apache-2.0 */
/* Verification: does every accelerator answer every ray of every scene like brute?
 *
 * A row is a scene and a spec, with the numbers of equal, tied, marginal and wrong answers; its first wrong
 * answer is kept in a replay file, or that of another program in a small scene (verify/failure.h). The first
 * failure of a spec is shrunk to a few objects, up to eight failures in all, each with half the budget of the
 * one before; if more than one is asked for (RtVerify.shrink), each has the whole budget. Rows are appended
 * to a journal, from which an interrupted run resumes, and finally to the tables of verify_table.h. */
#ifndef RT_VERIFY_VERIFY_H
#define RT_VERIFY_VERIFY_H

#include "measure/result_files.h"
#include "verify/failure.h"
#include "verify/verify_rays.h"

/* One accelerator to verify, or the answers of another program. Unless it was requested by name, it may be
 * missing on this machine or reject a scene: then it has no row there. With its own arithmetic it has rows
 * only if `judged`. */
typedef struct RtVerifySpec {
    char spec[RT_MAX_SPEC_CHARS];
    bool named, judged;
    bool recorded; /* `spec` is a file of hits instead (rt_hits_load): one at most, of one scene */
} RtVerifySpec;

#define RT_SHRINK_ALL UINT32_MAX

typedef struct RtVerify {
    const char *const *scenes; /* [scene_count] for rt_scene_open */
    uint32_t scene_count;
    const RtVerifySpec *specs; /* [spec_count] */
    uint32_t spec_count;
    RtVerifyRays rays; /* for each row */
    uint64_t memory;   /* bytes for each accelerator (rt_memory_limit); 0: no limit */
    uint32_t shrink;   /* the most failures of a spec to shrink, RT_SHRINK_ALL: each; 0: the default, 1 */
    /* For journal, tables, manifest and replay files; NULL: only replay files, in verify-failures. */
    const char *folder;
    RtStart start; /* what to do with existing results */
    /* NULL, or a file for the rays with a marginal or wrong answer of any accelerator (rt_rays_save), maybe
     * none; for one scene, and no earlier run. */
    const char *differing_rays;
} RtVerify;

typedef struct RtVerifyProgress {
    uint32_t scene; /* index of the current scene */
    const char *what;
    uint64_t done, all; /* rays times accelerators, without those of an earlier run */
} RtVerifyProgress;

typedef struct RtVerifyObserver {
    void (*doing)(void *context, const RtVerifyProgress *progress);
    void (*row)(void *context, const json_t *row);
    void (*notice)(void *context, const char *message);
    void *context;
} RtVerifyObserver;

/* Runs the verification. All scenes are opened before the folder is touched; no other process can write into
 * it meanwhile. *rows is a new array of rows as `verify --json` prints them, in the order of scenes and
 * specs; the observer sees each, including those of an earlier run. A wrong answer is a result, not an error.
 */
RtStatus rt_verify_run(const RtVerify *verify, const RtVerifyObserver *observer, json_t **rows,
                       RtError *error);

/* ---- the spread of an accelerator: its defaults, then each parameter at each test value, one at a time ----
 */

/* Writes the `n`th spec of the spread, "name" or "name:key=value", to out[0..RT_MAX_SPEC_CHARS); false past
 * the last. Default values are skipped. An overlay lies over the default accelerator. After the defaults
 * comes the trial (RtAccelOps.trial), if there is one; the others include its values, too. */
bool rt_spread_spec(const RtAccelOps *ops, size_t n, char *out);

/* The trial of a valid spec without parameters ("light+wide"), with that of each layer that has one, to
 * out[0..RT_MAX_SPEC_CHARS); false if there is none. */
bool rt_trial_spec(const char *spec, char *out);

#endif
