/* SPDX-License-Identifier: Apache-2.0 */
/* The operations of a plugin's accelerator, and what its process reports of a crash. */
#ifndef RT_ACCEL_PLUGIN_HOST_H
#define RT_ACCEL_PLUGIN_HOST_H

#include "accel/accel.h"

#include <raytally/accel.h>

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
