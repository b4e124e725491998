/* SPDX-License-Identifier: Apache-2.0 */
/* The plugins that were loaded. */
#include "accel/plugin/library.h"

enum { MOST_LIBRARIES = 32 };

static RtPlugin plugins[MOST_LIBRARIES];
static size_t count;

size_t rt_plugin_count(void) {
    return count;
}

const RtPlugin *rt_plugin_at(size_t i) {
    return &plugins[i];
}

RtPlugin *rt_plugin_next(RtError *error) {
    if (count < MOST_LIBRARIES) {
        plugins[count] = (RtPlugin){0};
        return &plugins[count];
    }
    rt_fail(error, RT_BAD_INPUT, "more than %d plugins", MOST_LIBRARIES);
    return NULL;
}

void rt_plugin_join(void) {
    count++;
}
