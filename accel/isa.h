/* SPDX-License-Identifier: Apache-2.0 */
/* Instruction sets that kernels are compiled for more than once, and which of them this machine has. Every
 * one gives the same bits: what differs is how many lanes a vector has. */
#ifndef RT_ACCEL_ISA_H
#define RT_ACCEL_ISA_H

typedef enum RtIsa {
    RT_ISA_PORTABLE, /* whatever the program itself is compiled for */
    RT_ISA_AVX2,     /* and BMI2 */
    RT_ISA_AVX512,   /* F, VL, DQ and BW */
} RtIsa;

/* The most that this machine has. */
static inline RtIsa rt_isa_best(void) {
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

#endif
