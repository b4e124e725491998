/* SPDX-License-Identifier: Apache-2.0 */
/* Memory for a plugin between guard pages, where an access crashes. Known bytes (canaries) fill the rest of
 * its own pages: they show what was written beside it. */
#ifndef RT_ACCEL_PLUGIN_GUARD_H
#define RT_ACCEL_PLUGIN_GUARD_H

#include "core/base/status.h"

#include <stdbool.h>
#include <stddef.h>

/* `mapping` includes the guard pages. */
typedef struct RtGuarded {
    char *mapping; /* [mapped] or NULL */
    size_t mapped;
    char *begin, *end; /* of the pages that may be accessed */
} RtGuarded;

/* Maps at least `bytes`, set to zero. */
RtStatus rt_guarded_map(RtGuarded *guarded, size_t bytes, RtError *error);
void rt_guarded_unmap(RtGuarded *guarded);

void rt_canaries_lay(char *from, const char *end);
bool rt_canaries_are_intact(const char *from, const char *end);

#endif
