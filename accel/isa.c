/* SPDX-License-Identifier: Apache-2.0 */
/* The widest instruction set that this processor has and this program was built with. RT_ONLY_ISA: a build
 * for one. */
#include "accel/isa.h"

/* What this processor has. */
static RtIsa machine_isa(void) {
#if defined(__x86_64__)
    if (!__builtin_cpu_supports("avx2") || !__builtin_cpu_supports("bmi2") || !__builtin_cpu_supports("fma"))
        return RT_ISA_PORTABLE;
    if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
        __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw")) {
        return RT_ISA_AVX512;
    }
    return RT_ISA_AVX2;
#else
    return RT_ISA_PORTABLE;
#endif
}

RtIsa rt_isa_best(void) {
#if defined(RT_ONLY_ISA)
    enum { portable = RT_ISA_PORTABLE, avx2 = RT_ISA_AVX2, avx512 = RT_ISA_AVX512 };
    return (RtIsa)RT_ONLY_ISA;
#else
    return machine_isa();
#endif
}

bool rt_isa_runs(RtIsa isa) {
#if defined(RT_ONLY_ISA)
    if (isa != rt_isa_best()) return false;
#endif
    return isa <= machine_isa();
}

/* The choices of RT_ISA_PARAM are "best" and then those of RtIsa. */
RtIsa rt_isa_asked(RtValue value) {
    return value.choice == 0 ? rt_isa_best() : (RtIsa)(value.choice - 1);
}

const char *rt_isa_name(RtIsa isa) {
    return isa == RT_ISA_PORTABLE ? "portable" : isa == RT_ISA_AVX2 ? "avx2" : "avx512";
}

static RtStatus available(RtIsa isa, RtError *error) {
    if (rt_isa_runs(isa)) return RT_OK;
    if (rt_isa_best() > machine_isa())
        return rt_fail(error, RT_NOT_AVAILABLE,
                       "this build has kernels only for %s, which this processor lacks: configure it with "
                       "-DRT_KERNELS=all",
                       rt_isa_name(rt_isa_best()));
    if (isa > machine_isa())
        return rt_fail(error, RT_NOT_AVAILABLE, "this processor has no %s: leave isa out", rt_isa_name(isa));
    return rt_fail(error, RT_NOT_AVAILABLE,
                   "this build has no kernels for %s: configure it with -DRT_KERNELS=all", rt_isa_name(isa));
}

RtStatus rt_isa_best_available(RtError *error) {
    return available(rt_isa_best(), error);
}

RtStatus rt_isa_available(RtValue value, RtError *error) {
    return available(rt_isa_asked(value), error);
}
