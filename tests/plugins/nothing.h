/* SPDX-License-Identifier: Apache-2.0 */
/* An accelerator that finds no hits, for plugins that only test tables or loading. */
#ifndef RT_TESTS_PLUGINS_NOTHING_H
#define RT_TESTS_PLUGINS_NOTHING_H

#include <raytally/accel.h>

static int build(const raytally_build_input *from, void **self) {
    (void)from;
    *self = NULL;
    return RAYTALLY_BUILD_OK;
}

static void destroy(void *self) {
    (void)self;
}

RAYTALLY_INLINE void search(const int *self, void *memory, const raytally_prepared *ray, int any,
                            raytally_hit *best, raytally_counters *counters) {
    (void)self, (void)memory, (void)ray, (void)any, (void)best, (void)counters;
}
RAYTALLY_DEFINE_KERNELS(int, search)

#endif
