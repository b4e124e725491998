/* SPDX-License-Identifier: Apache-2.0 */
/* brute: tests every object for every ray. It has no structure and gives the answer by its definition, the
 * least (t, id): rt_test_all in accel/kernel.h. It does that many objects and many rays at a time
 * (kernels.h), because every verification waits for it; the answers and the counts are those of rt_test_all,
 * and a test holds it to them. */
#include "accel/brute/brute.h"

#include "base/memory.h"

static RtStatus build(const RtBuild *what, RtAccel **out, RtError *error) {
    RT_TRY(rt_accel_new(what, sizeof(RtIsaAccel), out, error));
    ((RtIsaAccel *)*out)->kernels = RT_KERNELS_FOR(brute, rt_isa_best());
    return RT_OK;
}

static void destroy(RtAccel *accel) {
    rt_free(accel);
}

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
    RT_ISA_OPS,
    .scratch_bytes = rt_isa_scratch_bytes,
    .describe = describe,
    .validate = validate,
};
