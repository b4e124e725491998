/* SPDX-License-Identifier: Apache-2.0 */
/* Plugins: accelerators in shared libraries (include/raytally/accel.h).
 *
 * rt_plugin_load tries a library in a process of its own, and registers what its tables describe; the library
 * is never loaded into this process. Its accelerators are remote: accel/plugin/host.c makes an RtAccel of
 * each table in another process, so that a faulty plugin damages only its own results.
 *
 * rt_accel_build builds a spec remotely if one of its layers is a plugin's. The result represents the whole
 * stack: an RtAccel without layers, whose kernels send rays to that process and receive the answers. If the
 * process crashes, hangs, exits or returns invalid answers, the accelerator is broken: its rays miss, and
 * rt_accel_check and every other function that can fail return RT_BROKEN and the reason. */
#ifndef RT_ACCEL_PLUGIN_H
#define RT_ACCEL_PLUGIN_H

#include "accel/accel.h"

enum { RT_MAX_PLUGIN_ACCELS = 96 }; /* that all plugins may register */

typedef struct RtPlugin {
    char path[4096];      /* absolute */
    uint64_t fingerprint; /* hash of its bytes (XXH3) */
    uint32_t count;
    const char *names[RT_MAX_PLUGIN_ACCELS]; /* [count] of its accelerators */
} RtPlugin;

/* Loads the library at `path` and registers its accelerators, unless it is loaded already. RT_BAD_INPUT, and
 * nothing is registered, if it is not a plugin or of another version, has an invalid table or a name that is
 * taken, or cannot be loaded. */
RtStatus rt_plugin_load(const char *path, RtError *error);

/* Opens, in this process, the libraries of the accelerators in `spec`, so that rt_accel_build_here can build
 * them; for a process that a fault of theirs may end. RT_BROKEN if a library has changed. */
RtStatus rt_plugin_enter(const RtSpec *spec, RtError *error);

/* RT_BAD_INPUT if the registry has no room for so many more accelerators of plugins. */
RtStatus rt_accel_has_room(size_t more, RtError *error);

/* The loaded libraries, in order. */
size_t rt_plugin_count(void);
const RtPlugin *rt_plugin_at(size_t i);

/* ---- remote accelerators ---- */

/* Builds `spec` in a new process. RT_BROKEN if the process does not survive it. */
RtStatus rt_remote_build(const RtSpec *spec, const RtScene *scene, int threads, RtAccel **out,
                         RtError *error);

bool rt_accel_is_remote(const RtAccel *accel);

/* Runs `work` where the query's accelerator is: for a remote one in its process, with the query there, and
 * with copies of rays[0..count), at most RT_REMOTE_RAYS, and of the `message`, of at most RT_REMOTE_BYTES,
 * which is copied back. The message must not contain pointers to memory of one process that the
 * other reads. Returns what `work` returns, whose message names the accelerator unless it is RT_BROKEN; for a
 * broken accelerator RT_BROKEN and why; nothing runs, and the message is unchanged. */
enum { RT_REMOTE_RAYS = 4096, RT_REMOTE_BYTES = 256 * 1024 };
typedef RtStatus RtRemoteWork(RtQuery *query, const RtRay *rays, void *message, RtError *error);
RtStatus rt_remote_do(RtQuery *query, RtRemoteWork *work, const RtRay *rays, size_t count, void *message,
                      size_t bytes, RtError *error);

/* A pass over rays (accel/pass.h) that is timed in the process of a remote accelerator, on a copy of the rays
 * and by the clocks there: no communication is timed. `rays` is not empty. Close it also after a failure;
 * NULL is allowed. */
typedef struct RtRemotePass RtRemotePass;
RtStatus rt_remote_pass_open(RtRemotePass **out, const RtAccel *accel, const RtRay *rays, size_t count,
                             bool any, int threads, RtError *error);

/* The seconds of `repeats` passes, by the wall clock and by the clock of the comparison: the thread's
 * processor time, or the wall clock if there are several threads. */
RtStatus rt_remote_pass_time(RtRemotePass *pass, uint32_t repeats, double *seconds, double *wall,
                             RtError *error);
void rt_remote_pass_close(RtRemotePass *pass);

/* Marks a remote accelerator as broken: `what` was found wrong with it while it did `doing`. */
void rt_remote_break(const RtAccel *accel, const char *what, const char *doing);

/* Answers of a plugin are not trusted: whether `hit` is a miss, or an object 0..objects-1 at a finite t on
 * the ray. */
static inline bool rt_hit_is_possible(uint32_t objects, const RtRay *ray, RtHit hit) {
    if (hit.object == RT_NO_OBJECT) return hit.t == INFINITY;
    return hit.object < objects && hit.t >= ray->tmin && hit.t <= ray->tmax && hit.t < INFINITY;
}

/* The same of an occluder. An exact accelerator must name it. */
static inline bool rt_occluder_is_possible(const RtAccel *accel, uint32_t objects, uint32_t occluder) {
    return (occluder == RT_NO_OBJECT) | (occluder < objects) |
           ((occluder == RT_UNNAMED_OBJECT) & !accel->exact);
}

/* The same of a counter after so many rays. No ray costs that much: the plugin counted below zero, or copied
 * unset memory. */
static inline bool rt_count_is_possible(uint64_t count, size_t rays) {
    return count <= rays * (UINT64_C(1) << 32);
}

/* A number of a description, or count of its build, that no structure has: usually below zero. 0 if there is
 * none. */
uint64_t rt_description_impossible(const RtDescription *description);

/* Reports progress; long work calls it regularly. A process without progress for 60 seconds, or for
 * RAYTALLY_PLUGIN_SECONDS, counts as hung; a build has ten times as long. With RAYTALLY_PLUGIN_WAIT set there
 * is no limit, and the process waits for a debugger before it loads the plugin. */
void rt_remote_progress(void);

/* Why the last accelerator that the calling thread destroyed did not survive it, or NULL. */
const char *rt_remote_exit_message(void);

/* What raytally noticed of remote accelerators that affects no answer: sentence number `i` about memory that
 * they do not describe, and threads and processes that they left behind; NULL after the last. */
const char *rt_remote_notice(size_t i);

#endif
