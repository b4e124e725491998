/* SPDX-License-Identifier: Apache-2.0 */
/* ideal: recorded answers, with one object test for a ray that hits and none for one that misses: the cost of
 * an accelerator that knows everything in advance, a lower bound for all others.
 *
 * Layout: the nearest object for each recorded ray, or the instance that contains it. A ray is recognised by
 * its address, so the lookup costs nothing: rays between `rays` and `rays + count` are recorded. All other
 * rays are tested against every object, as by brute, so every answer is right. */
#include "accel/kernel.h"

typedef struct Ideal {
    RtAccel base;
    const RtRay *rays; /* borrowed; NULL before `learn` */
    uint32_t *objects; /* [count] the nearest object, or RT_NO_OBJECT */
    size_t count;
} Ideal;

static RtStatus learn(RtAccel *accel, const RtRay *rays, const RtHit *hits, size_t count, RtError *error) {
    Ideal *self = (Ideal *)accel;
    uint32_t *objects = rt_arena_alloc(&accel->memory, count, sizeof(uint32_t));
    RT_TRY(rt_arena_check(&accel->memory, "the answers of ideal", error));
    for (size_t i = 0; i < count; i++) {
        const uint32_t id = hits[i].object;
        objects[i] = id == RT_NO_OBJECT ? id : rt_geometry_holder(&accel->scene->geometry, id);
    }
    rt_arena_free(&accel->memory, self->objects);
    self->rays = rays;
    self->objects = objects;
    self->count = count;
    return RT_OK;
}

/* ---- queries ---- */

RT_KERNEL void search(const Ideal *self, void *scratch, const RtPreparedRay *ray, bool any, RtHit *best,
                      RtTally *tally) {
    (void)scratch;
    const RtGeometry *g = &self->base.scene->geometry;
    uintptr_t offset = (uintptr_t)ray->ray - (uintptr_t)self->rays;
    if (offset >= self->count * sizeof(RtRay)) {
        rt_test_all(g, ray, any, best, tally);
        return;
    }
    uint32_t id = self->objects[offset / sizeof(RtRay)];
    if (id != RT_NO_OBJECT) rt_test_object(g, id, ray, any, best, tally);
}

RT_DEFINE_KERNELS(Ideal, search)

/* ---- describe and validate ---- */

static void describe(const RtAccel *accel, RtDescription *out) {
    const Ideal *self = (const Ideal *)accel;
    *out = (RtDescription){.bytes = self->count * sizeof(uint32_t), RT_NO_PREDICTION};
}

static RtStatus validate(const RtAccel *accel, RtError *error) {
    const Ideal *self = (const Ideal *)accel;
    for (size_t i = 0; i < self->count; i++) {
        uint32_t id = self->objects[i];
        if (id == RT_NO_OBJECT || id < accel->scene->geometry.object_count) continue;
        return rt_fail(error, RT_MISMATCH,
                       "ideal: the recorded answer of ray %zu is object %u, which does not exist", i, id);
    }
    return RT_OK;
}

const RtAccelOps rt_ideal_ops = {
    .name = "ideal",
    .summary = "recorded answers: one test for a ray that hits, none for one that misses; a lower bound on "
               "object tests",
    .paper = "none: a reference",
    .bytes = sizeof(Ideal),
    .kernels = &kernels,
    .describe = describe,
    .validate = validate,
    .learn = learn,
};
