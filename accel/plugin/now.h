/* SPDX-License-Identifier: Apache-2.0 */
/* What the accelerators of plugins are at, for who has to say what became of one: the queries that are open
 * in this process, and the ray that each is tracing. */
#ifndef RT_ACCEL_PLUGIN_NOW_H
#define RT_ACCEL_PLUGIN_NOW_H

#include "base/ray.h"

typedef struct RtPluginNow {
    const RtRay *volatile ray;  /* the last that was prepared; NULL: the query is idle */
    const char *guard, *behind; /* [guard, behind) is the memory that follows the query's own */
} RtPluginNow;

/* Of the calling thread; NULL where it traces nothing. Safe in signal handlers. */
const RtPluginNow *rt_plugin_now(void);

/* One that is busy, of whatever thread. */
const RtPluginNow *rt_plugin_busy(void);

#endif
