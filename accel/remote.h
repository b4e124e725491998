/* SPDX-License-Identifier: Apache-2.0 */
/* Accelerators that live away, in a process of their own: whatever one of a plugin does there, results of
 * others are safe.
 *
 * rt_accel_build builds a spec away as soon as one of its layers is a plugin's. What it gives back stands in
 * for the whole stack: an RtAccel without layers, kernels of which send rays there and fetch the answers. If
 * the process crashes, hangs, ends, or answers nonsense, the accelerator is broken: rays miss,
 * rt_accel_check says what happened, RT_BROKEN, and so does all else that can. */
#ifndef RT_ACCEL_REMOTE_H
#define RT_ACCEL_REMOTE_H

#include "accel/accel.h"

/* Builds `spec` in a new process. RT_BROKEN where that did not survive it. */
RtStatus rt_remote_build(const RtSpec *spec, const RtScene *scene, int threads, RtAccel **out,
                         RtError *error);

bool rt_accel_is_remote(const RtAccel *accel);

/* Runs `work` in the process of the query's accelerator, which is away, with the query that is there;
 * `message` of `bytes` <= RT_AWAY_BYTES, which has no pointers that both follow, goes there and comes back.
 * Of a broken one nothing is run, and the message stays as it is. */
enum { RT_AWAY_BYTES = 256 * 1024 };
typedef void RtRemoteWork(RtQuery *query, void *message);
void rt_remote_do(RtQuery *query, RtRemoteWork *work, void *message, size_t bytes);

/* Breaks an accelerator that is away, for what was found wrong with it while it did `doing`. */
void rt_remote_break(const RtAccel *accel, const char *what, const char *doing);

/* To be called now and then by work that takes long: it goes on. What does not for 60 seconds, or what
 * RAYTALLY_PLUGIN_SECONDS says, is taken to hang; ten times that for building. Where RAYTALLY_PLUGIN_WAIT is
 * set nothing is, and the process waits for a debugger before it loads the plugin. */
void rt_remote_beat(void);

/* A status that came from there, as far as it is one. */
static inline RtStatus rt_remote_status(RtStatus status) {
    return status >= RT_OK && status <= RT_IO ? status : RT_BROKEN;
}

/* Why the last accelerator that the calling thread destroyed did not survive it, or NULL. */
const char *rt_remote_exit_message(void);

#endif
