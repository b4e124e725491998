/* SPDX-License-Identifier: Apache-2.0 */
/* Plugins: accelerators in shared libraries (include/raytally/accel.h).
 *
 * A library is tried in a process of its own (rt_plugin_load). What its tables say joins the registry; the
 * library itself is never loaded here. What is built of it lives in a process of its own again
 * (accel/remote.h), in which accel/plugin/host.c makes an RtAccel of each table. */
#ifndef RT_ACCEL_PLUGIN_H
#define RT_ACCEL_PLUGIN_H

#include "accel/accel.h"

/* A library that was loaded. */
typedef struct RtPlugin {
    char path[4096];      /* in full */
    uint64_t fingerprint; /* of its bytes (XXH3) */
    uint32_t count;
    const char *names[64]; /* [count] of its accelerators */
} RtPlugin;

/* Loads the library at `path` and registers its accelerators; one that is loaded already is left as it is.
 * RT_BAD_INPUT, and nothing is registered, where it is no plugin, is of another version, has a broken table
 * or a name that is taken, or does not survive being loaded. */
RtStatus rt_plugin_load(const char *path, RtError *error);

/* Every library in `list`, of files and folders joined by ':', which is written '\:' where it belongs to a
 * name, as '\\' may be for a '\'; of a folder, each file in it that ends in .so, by name. */
RtStatus rt_plugin_load_all(const char *list, RtError *error);

/* Opens in this very process the libraries of which `spec` has accelerators, so that they can be built here
 * (rt_accel_build_here), for a process that may end with what they do. RT_BROKEN where one has changed. */
RtStatus rt_plugin_enter(const RtSpec *spec, RtError *error);

/* RT_BAD_INPUT where the registry has no room for so many more accelerators of plugins. */
RtStatus rt_accel_has_room(size_t more, RtError *error);

/* Those that were loaded, in order. */
size_t rt_plugin_count(void);
const RtPlugin *rt_plugin_at(size_t i);

#endif
