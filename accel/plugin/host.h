/* SPDX-License-Identifier: Apache-2.0 */
/* An accelerator of a plugin as an RtAccel, in the process where it lives: what raytally's side of
 * include/raytally/accel.h is. */
#ifndef RT_ACCEL_PLUGIN_HOST_H
#define RT_ACCEL_PLUGIN_HOST_H

#include "accel/accel.h"

#include <raytally/accel.h>

/* The operations of a plugin's table, which the registry knows by the first member. */
typedef struct RtPluginOps {
    RtAccelOps ops;
    RtParam params[RAYTALLY_MAX_PARAMS];
    const char *path;         /* of the library */
    uint64_t fingerprint;     /* of its bytes, when it was loaded */
    uint32_t place;           /* of the table in the library */
    raytally_accel_ops table; /* where it is entered (rt_plugin_enter); else nothing */
} RtPluginOps;

/* Fills the operations and parameters from a table that was looked at, the text of which has to stay. */
void rt_plugin_ops_init(RtPluginOps *ops, const raytally_accel_ops *table);

#endif
