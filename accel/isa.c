/* SPDX-License-Identifier: Apache-2.0 */
#include "accel/isa.h"

typedef enum Choice { BEST, PORTABLE, AVX2, AVX512 } Choice; /* of RT_ISA_PARAM */

RtIsa rt_isa_best(void) {
#if defined(__x86_64__)
    if (!__builtin_cpu_supports("avx2") || !__builtin_cpu_supports("bmi2")) return RT_ISA_PORTABLE;
    if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
        __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw")) {
        return RT_ISA_AVX512;
    }
    return RT_ISA_AVX2;
#else
    return RT_ISA_PORTABLE;
#endif
}

RtIsa rt_isa_asked(RtValue value) {
    switch ((Choice)value.choice) {
    case BEST: break;
    case PORTABLE: return RT_ISA_PORTABLE;
    case AVX2: return RT_ISA_AVX2;
    case AVX512: return RT_ISA_AVX512;
    }
    return rt_isa_best();
}

RtStatus rt_isa_available(RtValue value, RtError *error) {
    static const RtParam param = {RT_ISA_PARAM};
    char name[RT_MAX_SPEC_CHARS];
    if (rt_isa_asked(value) <= rt_isa_best()) return RT_OK;
    rt_param_format(&param, value, name, sizeof name);
    return rt_fail(error, RT_NOT_AVAILABLE, "this processor has no %s: leave isa out", name);
}

static const RtKernels *kernels_of(const RtAccel *accel) {
    return ((const RtIsaAccel *)accel)->kernels;
}

void rt_isa_nearest(const RtAccel *accel, const RtScratch *scratch, const RtRay *rays, size_t count,
                    RtHit *hits) {
    kernels_of(accel)->nearest(accel, scratch, rays, count, hits);
}

void rt_isa_occluded(const RtAccel *accel, const RtScratch *scratch, const RtRay *rays, size_t count,
                     uint32_t *occluders) {
    kernels_of(accel)->occluded(accel, scratch, rays, count, occluders);
}

void rt_isa_nearest_counted(const RtAccel *accel, const RtScratch *scratch, const RtRay *rays, size_t count,
                            RtHit *hits, RtTally *tallies) {
    kernels_of(accel)->nearest_counted(accel, scratch, rays, count, hits, tallies);
}

void rt_isa_occluded_counted(const RtAccel *accel, const RtScratch *scratch, const RtRay *rays, size_t count,
                             uint32_t *occluders, RtTally *tallies) {
    kernels_of(accel)->occluded_counted(accel, scratch, rays, count, occluders, tallies);
}

size_t rt_isa_scratch_bytes(const RtAccel *accel) {
    return kernels_of(accel)->scratch_bytes;
}
