/* SPDX-License-Identifier: Apache-2.0 */
/* Accelerators whose kernels are compiled once for each instruction set, and chosen among at run time. All
 * return the same bits and counts; they differ in how many lanes a vector has (core/base/simd.h).
 *
 * Such an accelerator NAME has its kernels in accel/NAME/NAME_kernels.c, which ends with a table of them
 * (RT_DEFINE_KERNEL_TABLE in accel/kernel.h). CMakeLists.txt compiles it three times, with RT_ISA portable,
 * avx2 and avx512, and on processors other than x86 once, with RT_ISA portable. Its `build` chooses
 * RT_KERNELS_FOR(NAME, isa). */
#ifndef RT_ACCEL_ISA_H
#define RT_ACCEL_ISA_H

#include "accel/accel.h"

typedef enum RtIsa {
    RT_ISA_PORTABLE, /* whatever the program itself is compiled for: SSE2 on x86-64, NEON on 64-bit ARM */
    RT_ISA_AVX2,     /* and BMI2 */
    RT_ISA_AVX512,   /* F, VL, DQ and BW */
} RtIsa;

/* The best that this machine has and this build has kernels for. */
RtIsa rt_isa_best(void);

/* Whether this machine has it, and this build kernels for it. */
bool rt_isa_runs(RtIsa isa);

/* As its parameter has it: portable, avx2 or avx512. */
const char *rt_isa_name(RtIsa isa);

/* RT_OK, or RT_NOT_AVAILABLE where this build is for a better machine. */
RtStatus rt_isa_best_available(RtError *error);

/* The name of a table in a file that is compiled for the instruction set RT_ISA. */
#define RT_OF_ISA(name)             RT_OF_ISA_NAMED(name, RT_ISA)
#define RT_OF_ISA_NAMED(name, isa)  RT_OF_ISA_JOINED(name, isa)
#define RT_OF_ISA_JOINED(name, isa) rt_##name##_##isa

#define RT_DECLARE_KERNELS(name)                                                                             \
    extern const RtKernels *const rt_##name##_portable, *const rt_##name##_avx2, *const rt_##name##_avx512

/* Those of an accelerator for an RtIsa that runs. A build for one instruction set alone, as by the option
 * RT_KERNELS=native, has RT_ONLY_ISA. */
#define RT_KERNELS_OF(name, isa) rt_##name##_##isa
#if defined(RT_ONLY_ISA)
#define RT_KERNELS_FOR(name, isa) ((void)(isa), RT_EXPAND(RT_KERNELS_OF, name, RT_ONLY_ISA))
#define RT_EXPAND(macro, ...)     macro(__VA_ARGS__)
#else
#define RT_KERNELS_FOR(name, isa)                                                                            \
    ((isa) == RT_ISA_AVX512 ? RT_KERNELS_OF(name, avx512)                                                    \
     : (isa) == RT_ISA_AVX2 ? RT_KERNELS_OF(name, avx2)                                                      \
                            : RT_KERNELS_OF(name, portable))
#endif

/* For `build`: sets the kernels. */
static inline void rt_isa_use(RtAccel *accel, const RtKernels *kernels) {
    accel->kernels = kernels;
    accel->scratch_bytes = kernels->scratch_bytes;
}

/* ---- as parameters ---- */

#define RT_ISA_PARAM                                                                                         \
    "isa", RT_CHOICE("best", "best|portable|avx2|avx512"),                                                   \
        "instruction set; does not affect hits or counts", "best: the widest of this machine"

/* What a value of it asks for. */
RtIsa rt_isa_asked(RtValue value);

/* RT_OK, or RT_NOT_AVAILABLE where what a value asks for does not run. */
RtStatus rt_isa_available(RtValue value, RtError *error);

/* For accelerators that have their kernels in lanes and, to be compared with scalar structures, one record at
 * a time too. */
#define RT_LANES_PARAM(records)                                                                              \
    "lanes", RT_CHOICE("16", "1|16"), records " tested at once; does not affect hits or counts",             \
        "the faster; the same for brute and extents"

/* Whether a value of it asks for the kernels in lanes. */
static inline bool rt_has_lanes(RtValue value) {
    return value.choice == 1;
}

#endif
