/* SPDX-License-Identifier: Apache-2.0 */
/* What the process of a remote accelerator uses and leaves behind, seen from raytally's process by /proc:
 * memory far beyond what the structure describes, and threads and processes that still run when it is
 * destroyed. Each becomes a notice (rt_remote_notice), one of a kind for each accelerator. And whether its
 * memory exceeds a limit. Without /proc there are no notices and no limit. */
#ifndef RT_ACCEL_PLUGIN_USAGE_H
#define RT_ACCEL_PLUGIN_USAGE_H

#include "core/base/process.h"

#include <stdint.h>

typedef struct RtUsage {
    char name[64];          /* of the accelerator */
    uint64_t before, built; /* bytes of memory that the process holds, at the fork and once it was built */
    uint64_t limit;         /* the most bytes that it may hold beyond `before`; UINT64_MAX: any */
} RtUsage;

/* Before the process is forked; the limit is that of rt_memory_limit. */
void rt_usage_begin(RtUsage *usage, const char *name);

/* Whether it has ever held more than the limit; *most gets the most that it held beyond `before`. */
bool rt_usage_exceeds_limit(const RtUsage *usage, const RtProcess *process, uint64_t *most);

/* Once a structure of so many bytes is built. */
void rt_usage_built(RtUsage *usage, const RtProcess *process, uint64_t bytes);

/* Before the structure is destroyed, when all its queries are closed. */
void rt_usage_traced(const RtUsage *usage, const RtProcess *process);

/* After that, while the process still runs. */
void rt_usage_destroyed(const RtUsage *usage, const RtProcess *process);

/* Once the process has ended. */
void rt_usage_ended(const RtUsage *usage, const RtProcessEnd *end);

#endif
