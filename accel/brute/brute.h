/* SPDX-License-Identifier: Apache-2.0 */
/* The kernels of brute: the same for every instruction set, and the same answers and counts as rt_test_all,
 * which is what they do many lanes at a time. */
#ifndef RT_ACCEL_BRUTE_BRUTE_H
#define RT_ACCEL_BRUTE_BRUTE_H

#include "accel/accel.h"
#include "accel/isa.h"

typedef struct RtBruteKernels {
    RtNearestKernel *nearest;
    RtOccludedKernel *occluded;
    RtNearestCounted *nearest_counted;
    RtOccludedCounted *occluded_counted;
    size_t scratch_bytes; /* of a query */
} RtBruteKernels;

extern const RtBruteKernels rt_brute_portable, rt_brute_avx2, rt_brute_avx512;

/* Those for an instruction set, which this machine must have. */
const RtBruteKernels *rt_brute_kernels(RtIsa isa);

#endif
