/* SPDX-License-Identifier: Apache-2.0 */
/* What the accelerators of plugins are at, for who has to say what became of one: the queries that are open
 * in this process, and the ray that each is tracing. */
#ifndef RT_ACCEL_PLUGIN_NOW_H
#define RT_ACCEL_PLUGIN_NOW_H

#include "core/base/ray.h"

/* What lies behind memory that a plugin writes to, and may not be touched: [begin, end). */
typedef struct RtPluginGuard {
    const char *begin, *end;
} RtPluginGuard;

enum { RT_GUARD_QUERY, RT_GUARD_ANSWERS, RT_GUARD_COUNT };

typedef struct RtPluginNow {
    const RtRay *volatile ray; /* the last that was prepared; NULL: the query is idle */
    RtPluginGuard guards[RT_GUARD_COUNT];
} RtPluginNow;

/* Of the calling thread; NULL where it traces nothing. Safe in signal handlers. */
const RtPluginNow *rt_plugin_now(void);

/* One that is busy, of whatever thread. */
const RtPluginNow *rt_plugin_busy(void);

#endif
