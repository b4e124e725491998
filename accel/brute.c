/* SPDX-License-Identifier: Apache-2.0 */
/* brute: tests every object for every ray. It has no structure and defines the answer: the least (t,
 * id). */
#include "accel/kernel.h"

#include "base/memory.h"

typedef struct Brute {
    RtAccel base;
} Brute;

static RtStatus build(const RtBuild *what, RtAccel **out, RtError *error) {
    return rt_accel_new(what, sizeof(Brute), out, error);
}

static void destroy(RtAccel *accel) {
    rt_free(accel);
}

RT_KERNEL void search(const Brute *self, void *scratch, const RtPreparedRay *ray, bool any, RtHit *best,
                      RtTally *tally) {
    (void)scratch;
    rt_test_all(&self->base.scene->geometry, ray, any, best, tally);
}

RT_DEFINE_KERNELS(Brute, search)

static void describe(const RtAccel *accel, RtDescription *out) {
    uint32_t count = accel->scene->geometry.object_count;
    *out = (RtDescription){
        .references = count, .predicted_cost = count, .predicted_tests = count, RT_NO_QUALITY};
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
    RT_KERNEL_OPS,
    .describe = describe,
    .validate = validate,
};
