/* SPDX-License-Identifier: Apache-2.0 */
/* Plugins: accelerators in shared libraries (include/raytally/accel.h).
 *
 * rt_plugin_load tries a library in a process of its own, and registers what its tables describe; the library
 * is never loaded into this process. Its accelerators are remote (accel/remote.h): accel/plugin/host.c makes
 * an RtAccel of each table in another process. */
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

#endif
