/* SPDX-License-Identifier: Apache-2.0 */
/* Memory that a plugin writes to, so that what it writes beside it is noticed: pages around it that nobody
 * may touch, and known bytes (canaries) between those and it. */
#ifndef RT_ACCEL_PLUGIN_GUARD_H
#define RT_ACCEL_PLUGIN_GUARD_H

#include "accel/plugin/now.h"
#include "core/base/status.h"

#include <stdbool.h>

typedef struct RtGuarded {
    char *mapping; /* [mapped] or NULL */
    size_t mapped;
    char *begin, *end; /* of the pages that may be touched */
} RtGuarded;

/* Pages for `bytes`; where the pages around them lie, to *guard. */
RtStatus rt_guarded_map(RtGuarded *guarded, size_t bytes, RtPluginGuard *guard, RtError *error);
void rt_guarded_unmap(RtGuarded *guarded);

void rt_canaries_lay(char *from, const char *end);

/* Whether nobody has written to [from, end). */
bool rt_canaries_live(const char *from, const char *end);

#endif
