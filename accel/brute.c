/* brute: tests every object for every ray. It has no structure and defines the answer: the least (t, id).
 * One loop per shape, each in ascending order of ids. */
#include "accel/kernel.h"

#include "base/memory.h"

typedef struct Brute {
    RtAccel base;
} Brute;

extern const RtAccelOps rt_brute_ops;

static RtStatus build(const RtScene *scene, const RtValue *values, RtAccel **out, RtError *error) {
    (void)values;
    Brute *self = rt_alloc(1, sizeof(Brute));
    if (!self) return rt_fail_memory(error, "brute", sizeof(Brute));
    self->base = (RtAccel){.ops = &rt_brute_ops, .scene = scene, .exact = true, .counts = true};
    *out = &self->base;
    return RT_OK;
}

static void destroy(RtAccel *accel) {
    rt_free(accel);
}

RT_KERNEL RtHit find_nearest(const Brute *self, void *scratch, const RtPreparedRay *ray, RtTally *tally) {
    (void)scratch;
    const RtGeometry *g = &self->base.scene->geometry;
    RtHit best = RT_MISS;
#define LOOP(CONSTANT, name, Type)                                                                           \
    for (uint32_t i = 0; i < g->name##_count; i++) rt_test_nearest(g, g->name##_ids[i], ray, &best, tally);
    RT_SHAPES(LOOP)
#undef LOOP
    return best;
}

RT_KERNEL bool find_any(const Brute *self, void *scratch, const RtPreparedRay *ray, RtTally *tally) {
    (void)scratch;
    const RtGeometry *g = &self->base.scene->geometry;
#define LOOP(CONSTANT, name, Type)                                                                           \
    for (uint32_t i = 0; i < g->name##_count; i++) {                                                         \
        if (rt_test_any(g, g->name##_ids[i], ray, tally)) return true;                                       \
    }
    RT_SHAPES(LOOP)
#undef LOOP
    return false;
}

RT_DEFINE_KERNELS(Brute, find_nearest, find_any)

static void describe(const RtAccel *accel, RtDescription *out) {
    uint32_t count = accel->scene->geometry.object_count;
    *out = (RtDescription){.references = count, .bytes = sizeof(Brute), .predicted_cost = count};
}

static RtStatus validate(const RtAccel *accel, RtError *error) {
    (void)accel, (void)error;
    return RT_OK;
}

const RtAccelOps rt_brute_ops = {
    .name = "brute",
    .summary = "every object for every ray: no structure, and the definition of the answer",
    .paper = "Whitted 1980, An Improved Illumination Model for Shaded Display, CACM 23(6)",
    .build = build,
    .destroy = destroy,
    .nearest = nearest_timed,
    .occluded = occluded_timed,
    .nearest_counted = nearest_counted,
    .occluded_counted = occluded_counted,
    .describe = describe,
    .validate = validate,
};
