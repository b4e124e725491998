/* SPDX-License-Identifier: Apache-2.0 */
/* brute: tests every object for every ray. It has no structure and gives the answer by its definition, the
 * least (t, id): rt_test_all in accel/kernel.h. With lanes=1 it calls that loop, as a scalar baseline for the
 * other scalar structures. With lanes=16, the default, it tests many objects and many rays at a time
 * (brute_kernels.c), because every verification waits for it. Both return the same answers and counts, and a
 * test compares them. */
#include "accel/isa.h"
#include "accel/kernel.h"

RT_DECLARE_KERNELS(brute);

#define PARAMS(X) X(PARAM_LANES, RT_LANES_PARAM("spheres or triangles"))

enum { PARAMS(RT_PARAM_INDEX) };
static const RtParam params[] = {PARAMS(RT_PARAM_ENTRY)};

RT_KERNEL void search(const RtAccel *self, void *scratch, const RtPreparedRay *ray, bool any, RtHit *best,
                      RtTally *tally) {
    (void)scratch;
    rt_test_all(&self->scene->geometry, ray, any, best, tally);
}

RT_DEFINE_KERNELS(RtAccel, search)

static RtStatus build(RtAccel *accel, const RtBuild *what, RtError *error) {
    (void)error;
    if (rt_has_lanes(what->values[PARAM_LANES])) rt_isa_use(accel, RT_KERNELS_FOR(brute, rt_isa_best()));
    return RT_OK;
}

static void describe(const RtAccel *accel, RtDescription *out) {
    uint32_t count = accel->scene->geometry.object_count;
    *out = (RtDescription){
        .references = count, .predicted_cost = count, .predicted_tests = count, RT_NO_QUALITY};
}

const RtAccelOps rt_brute_ops = {
    .name = "brute",
    .summary = "tests every object for every ray: no structure; defines the correct answer",
    .paper = "Whitted 1980, An Improved Illumination Model for Shaded Display, CACM 23(6)",
    RT_PARAMS_OF(params),
    .bytes = sizeof(RtAccel),
    .build = build,
    .kernels = &kernels,
    .describe = describe,
};
