/* SPDX-License-Identifier: Apache-2.0 */
/* Queries of a plugin's accelerator: what it may call, and what becomes of its answers.
 *
 * Whatever the plugin answers is looked at before anybody else sees it: an object that there is, a t within
 * the ray. It goes to memory that ends where a page ends that nobody may write to, as does the memory of a
 * query; next to both are known bytes. Object tests are counted here, whatever the plugin does with its
 * counters. */
#ifndef RT_ACCEL_PLUGIN_QUERY_H
#define RT_ACCEL_PLUGIN_QUERY_H

#include "accel/accel.h"

#include <raytally/accel.h>

#include <pthread.h>
#include <stdatomic.h>

typedef struct RtPluginAccel {
    RtAccel base;
    const raytally_accel_ops *table;
    void *self;
    size_t query_bytes;
    atomic_bool nonsense; /* what it was is in `said` */
    pthread_mutex_t lock;
    RtError said;
} RtPluginAccel;

static inline const RtPluginAccel *rt_plugin_of(const RtAccel *accel) {
    return (const RtPluginAccel *)accel;
}

/* That it is broken, and why. The first thing that is said counts. */
void rt_plugin_say(RtPluginAccel *accel, const RtError *what);

/* Sets the kernels, what opens and closes queries, and `check`. */
void rt_plugin_query_ops(RtAccelOps *ops);

#endif
