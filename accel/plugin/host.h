/* SPDX-License-Identifier: Apache-2.0 */
/* An accelerator of a plugin as an RtAccel, in its own process: the host's side of include/raytally/accel.h.
 *
 * Queries check every answer of the plugin before anything else reads it: the object exists, and t is on the
 * ray. Answers and the plugin's memory for a query lie between guard pages, and known bytes (canaries) fill
 * the rest of their pages. Object tests are counted here, whatever the plugin does with its counters, unless
 * it has hit functions of its own. */
#ifndef RT_ACCEL_PLUGIN_HOST_H
#define RT_ACCEL_PLUGIN_HOST_H

#include "accel/accel.h"

#include <raytally/accel.h>

#include <pthread.h>
#include <stdatomic.h>

/* The operations of a plugin's table; the registry holds pointers to the first member. */
typedef struct RtPluginOps {
    RtAccelOps ops;
    RtParam params[RAYTALLY_MAX_PARAMS];
    const char *path;         /* of the library */
    uint64_t fingerprint;     /* of its bytes when it was loaded */
    uint32_t place;           /* of the table in the library */
    raytally_accel_ops table; /* once rt_plugin_enter has opened the library here */
} RtPluginOps;

/* Fills the operations and parameters from a checked table, whose text must stay valid. */
void rt_plugin_ops_init(RtPluginOps *ops, const raytally_accel_ops *table);

typedef struct RtPluginAccel {
    RtAccel base;
    const raytally_accel_ops *table;
    void *self;
    uint32_t *other_objects; /* the list of raytally_build_input */
    size_t query_bytes;
    atomic_bool broken; /* `error` says why */
    pthread_mutex_t lock;
    RtError error;
} RtPluginAccel;

static inline const RtPluginAccel *rt_plugin_of(const RtAccel *accel) {
    return (const RtPluginAccel *)accel;
}

/* Marks it as broken, with a message as of printf. Only the first failure is kept. */
__attribute__((format(printf, 2, 3))) void rt_plugin_break(RtPluginAccel *accel, const char *what, ...);

/* Sets the kernels, what opens and closes queries, and `check`. */
void rt_plugin_query_ops(RtAccelOps *ops);

/* Once the plugin has built its structure: sets what queries need. */
void rt_plugin_query_init(RtPluginAccel *self);

/* ---- what a query is doing, for reports of crashes ---- */

typedef struct RtPluginNow {
    raytally_query face; /* the plugin's; its ray is the last that it prepared, or NULL */
    const RtRay *stream; /* NULL: idle */
    /* The plugin's memory and, from `middle` on, its answers, between guard pages, where an access crashes.
     */
    char *mapping, *middle;
    size_t mapped; /* bytes of all that */
} RtPluginNow;

/* Of the calling thread, or of any that traces; NULL if it, or none, does. Safe in signal handlers. */
const RtPluginNow *rt_plugin_now(bool any_thread);

#endif
