/* SPDX-License-Identifier: Apache-2.0 */
/* An accelerator of a plugin as an RtAccel, in the process where it lives: what raytally's side of
 * include/raytally/accel.h is.
 *
 * Whatever the plugin answers is looked at before anybody else sees it: an object that there is, a t within
 * the ray. It goes to memory that ends where a page ends that nobody may write to, as does the memory of a
 * query; next to both are known bytes. Object tests are counted here, whatever the plugin does with its
 * counters. */
#ifndef RT_ACCEL_PLUGIN_HOST_H
#define RT_ACCEL_PLUGIN_HOST_H

#include "accel/accel.h"

#include <raytally/accel.h>

/* The operations of a plugin's table, which the registry knows by the first member. */
typedef struct RtPluginOps {
    RtAccelOps ops;
    const raytally_accel_ops *table;
    RtParam params[RAYTALLY_MAX_PARAMS];
} RtPluginOps;

/* Fills them from a table that was looked at. */
void rt_plugin_ops_init(RtPluginOps *ops, const raytally_accel_ops *table);

#endif
