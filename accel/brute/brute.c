/* SPDX-License-Identifier: Apache-2.0 */
/* brute: tests every object for every ray. It has no structure and gives the answer by its definition, the
 * least (t, id): rt_test_all in accel/kernel.h. It does that many objects and many rays at a time
 * (kernels.h), because every verification waits for it; the answers and the counts are those of rt_test_all,
 * and a test holds it to them. */
#include "accel/brute/brute.h"

#include "base/memory.h"

typedef struct Brute {
    RtAccel base;
    const RtBruteKernels *kernels;
} Brute;

const RtBruteKernels *rt_brute_kernels(RtIsa isa) {
    return isa == RT_ISA_AVX512 ? &rt_brute_avx512 : isa == RT_ISA_AVX2 ? &rt_brute_avx2 : &rt_brute_portable;
}

static RtStatus build(const RtBuild *what, RtAccel **out, RtError *error) {
    RT_TRY(rt_accel_new(what, sizeof(Brute), out, error));
    ((Brute *)*out)->kernels = rt_brute_kernels(rt_isa_best());
    return RT_OK;
}

static void destroy(RtAccel *accel) {
    rt_free(accel);
}

static const RtBruteKernels *kernels_of(const RtAccel *accel) {
    return ((const Brute *)accel)->kernels;
}

static void nearest(const RtAccel *accel, const RtScratch *scratch, const RtRay *rays, size_t count,
                    RtHit *hits) {
    kernels_of(accel)->nearest(accel, scratch, rays, count, hits);
}

static void occluded(const RtAccel *accel, const RtScratch *scratch, const RtRay *rays, size_t count,
                     uint32_t *blockers) {
    kernels_of(accel)->occluded(accel, scratch, rays, count, blockers);
}

static void count_nearest(const RtAccel *accel, const RtScratch *scratch, const RtRay *rays, size_t count,
                          RtHit *hits, RtTally *tallies) {
    kernels_of(accel)->nearest_counted(accel, scratch, rays, count, hits, tallies);
}

static void count_occluded(const RtAccel *accel, const RtScratch *scratch, const RtRay *rays, size_t count,
                           uint32_t *blockers, RtTally *tallies) {
    kernels_of(accel)->occluded_counted(accel, scratch, rays, count, blockers, tallies);
}

static size_t scratch_bytes(const RtAccel *accel) {
    return kernels_of(accel)->scratch_bytes;
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
    .nearest = nearest,
    .occluded = occluded,
    .nearest_counted = count_nearest,
    .occluded_counted = count_occluded,
    .scratch_bytes = scratch_bytes,
    .describe = describe,
    .validate = validate,
};
