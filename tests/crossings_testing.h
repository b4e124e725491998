/* SPDX-License-Identifier: Apache-2.0 */
/* For tests that call hit functions directly, one thread at a time: scratch memory, rays, and hits. */
#ifndef RT_TESTS_CROSSINGS_TESTING_H
#define RT_TESTS_CROSSINGS_TESTING_H

#include "core/shape/geometry.h"

static inline RtHitMemory *hit_memory_of_tests(void) {
    static _Alignas(RtHitMemory) char memory[sizeof(RtHitMemory) + (sizeof(RtCrossing) << 16)];
    return (RtHitMemory *)memory;
}

static inline RtRay ray_along(RtVec3 org, RtVec3 dir) {
    return (RtRay){.org = org, .dir = dir, .tmax = INFINITY};
}

static inline bool hit(const RtGeometry *g, uint32_t id, const RtRay *ray, float *t) {
    RtPreparedRay prepared;
    rt_hit_ray(&prepared, g, ray, hit_memory_of_tests());
    return rt_object_hit(g, id, &prepared, t, NULL);
}

#endif
