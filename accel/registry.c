/* SPDX-License-Identifier: Apache-2.0 */
/* The one list of accelerators. To add one: write its file, add a line here, add the file to
 * CMakeLists.txt. */
#include "accel/accel.h"

#include "base/words.h"

#include <string.h>

/* X(ops) */
#define ACCELERATORS(X)                                                                                      \
    X(rt_brute_ops)                                                                                          \
    X(rt_bvh_ops)                                                                                            \
    X(rt_wide_ops)                                                                                           \
    X(rt_clusters_ops)                                                                                       \
    X(rt_extents_ops)                                                                                        \
    X(rt_grid_ops)                                                                                           \
    X(rt_octree_ops)                                                                                         \
    X(rt_kd_ops)                                                                                             \
    X(rt_ideal_ops)                                                                                          \
    X(rt_item_ops)                                                                                           \
    X(rt_cache_ops)                                                                                          \
    X(rt_light_ops)

#ifdef RT_WITH_EMBREE
#define EMBREE_ACCELERATORS(X) X(rt_embree_ops)
#else
#define EMBREE_ACCELERATORS(X)
#endif

#define DECLARE(ops) extern const RtAccelOps ops;
ACCELERATORS(DECLARE)
EMBREE_ACCELERATORS(DECLARE)
#undef DECLARE

static const RtAccelOps *const registry[] = {
#define ENTRY(ops) &ops,
    ACCELERATORS(ENTRY) EMBREE_ACCELERATORS(ENTRY)
#undef ENTRY
};

enum { REGISTRY_COUNT = sizeof registry / sizeof registry[0] };

size_t rt_accel_count(void) {
    return REGISTRY_COUNT;
}

const RtAccelOps *rt_accel_at(size_t i) {
    return registry[i];
}

const char *rt_accel_default(void) {
    return "bvh";
}

const char *rt_accel_truth(void) {
    return "brute";
}

const char *rt_accel_yardstick(void) {
    return "ideal";
}

RtStatus rt_accel_find(const char *name, const RtAccelOps **out, RtError *error) {
    const char *names[REGISTRY_COUNT];
    for (size_t i = 0; i < REGISTRY_COUNT; i++) {
        names[i] = registry[i]->name;
        if (strcmp(names[i], name) != 0) continue;
        *out = registry[i];
        return RT_OK;
    }
#ifndef RT_WITH_EMBREE
    if (strcmp(name, "embree") == 0) {
        return rt_fail(error, RT_NOT_AVAILABLE,
                       "this raytally was built without Embree: install its package and build again");
    }
#endif
    char suggestion[RT_MAX_SUGGESTION];
    rt_suggest(name, names, REGISTRY_COUNT, suggestion);
    return rt_fail(error, RT_BAD_INPUT, "there is no accelerator '%s'%s%s `raytally accels` lists them", name,
                   suggestion, *suggestion ? "" : ";");
}
