/* SPDX-License-Identifier: Apache-2.0 */
/* Watching the process of a remote accelerator: waiting for its answers, and saying how it failed. */
#ifndef RT_ACCEL_PLUGIN_WATCH_H
#define RT_ACCEL_PLUGIN_WATCH_H

#include "accel/plugin/usage.h"
#include "accel/plugin/wire.h"
#include "core/base/process.h"

#include <pthread.h>

typedef struct RtWatched RtWatched;

/* Searches the stream of a process that has ended for a ray that fails by itself: an index, RT_FAILS_TOGETHER
 * if there is none, or RT_FAILS_SOMEHOW if that cannot be found out. */
typedef uint32_t RtFindRay(const RtWatched *child);
#define RT_FAILS_TOGETHER (UINT32_MAX - 1)
#define RT_FAILS_SOMEHOW  UINT32_MAX

struct RtWatched {
    char name[RT_MAX_SPEC_CHARS]; /* for messages */
    Wire *wire;
    RtProcess process;
    RtUsage usage;
    double time_limit;        /* seconds without progress after which it counts as hung */
    unsigned asked[CHANNELS]; /* number of the last request on each channel */
    RtFindRay *find_ray;      /* called with the lock held; NULL: not searched */
    pthread_mutex_t lock;     /* of the following members */
    atomic_bool broken;       /* error says why */
    bool ended;
    RtError error; /* its status is RT_BROKEN; RT_BAD_INPUT if the structure exceeds the limit of memory */
};

/* Marks it as broken: `what` was found wrong while it did `doing`. Only the first failure is kept. */
void rt_watched_break(RtWatched *child, const char *what, const char *doing);

/* Waits for the answer to the last request on a channel. False if none will come, because the process ended,
 * overwrote shared memory, exceeded its limit of memory, or made no progress for `limit` seconds: then it is
 * broken, and has ended. */
bool rt_watched_wait(RtWatched *child, uint32_t channel, const char *doing, double limit);

#endif
