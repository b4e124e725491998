/* SPDX-License-Identifier: Apache-2.0 */
/* Verification: does every accelerator answer every ray of every scene like brute?
 *
 * A row is a scene and a spec. It says how many answers are equal, ties, marginal and wrong; its first wrong
 * answer is kept in a replay file (verify/replay.h). The first of a spec is shrunk to the few objects that it
 * takes, up to eight in all, each within half the time that the one before may take. Rows go to
 * a journal as they are found, from which an interrupted run goes on, and in the end to the tables of
 * verify_table.h: the same bytes for the same seed, at any number of threads and however often the run was
 * interrupted. */
#ifndef RT_VERIFY_VERIFY_H
#define RT_VERIFY_VERIFY_H

#include "measure/previous_results.h"
#include "verify/failure.h"
#include "verify/verify_rays.h"

/* One accelerator to verify. One that was not asked for by name may be missing on this machine, or refuse a
 * scene: then it has no row there. */
typedef struct RtVerifySpec {
    char spec[RT_MAX_SPEC_CHARS];
    bool named;
    RtMaker maker; /* how it is built: by the spec, if that is zero */
} RtVerifySpec;

typedef struct RtVerify {
    const char *const *scenes; /* [scene_count] as rt_scene_open knows them */
    uint32_t scene_count;
    const RtVerifySpec *specs; /* [spec_count] */
    uint32_t spec_count;
    RtVerifyRays rays; /* for each row */
    /* For journal, tables, manifest and replay files; NULL: replay files alone, to verify-failures. */
    const char *folder;
    RtStart start; /* what becomes of what is there */
} RtVerify;

typedef struct RtVerifyProgress {
    uint32_t scene; /* index of the one at hand */
    const char *what;
    uint64_t done, all; /* rays answered, each by each accelerator; those of an earlier run do not count */
} RtVerifyProgress;

typedef struct RtVerifyObserver {
    void (*doing)(void *context, const RtVerifyProgress *progress);
    void (*row)(void *context, const json_t *row);
    void (*notice)(void *context, const char *message);
    void *context;
} RtVerifyObserver;

/* Runs it all. Each scene is opened once, all of them before the first is verified, and kept until its turn
 * is over; only then is the folder touched, and no other process writes into it meanwhile. *rows is a new
 * array, of rows as `verify --json` prints them, in the order of scenes and specs; each is shown to the
 * observer, those of an earlier run too. A wrong answer is a result, not an error. */
RtStatus rt_verify_run(const RtVerify *verify, const RtVerifyObserver *observer, json_t **rows,
                       RtError *error);

#endif
