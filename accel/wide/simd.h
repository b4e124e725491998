/* SPDX-License-Identifier: Apache-2.0 */
/* Vectors for the kernels of `wide`, in the words of AVX2: its own intrinsics where a file is compiled for it, else
 * SIMDe's, which do the same lane by lane in whatever the machine has. */
#ifndef RT_ACCEL_WIDE_SIMD_H
#define RT_ACCEL_WIDE_SIMD_H

#include <stdint.h>

#if defined(__AVX2__)
#include <immintrin.h>
#else
#define SIMDE_ENABLE_NATIVE_ALIASES
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wpedantic"
#include <simde/x86/avx2.h>
#pragma GCC diagnostic pop
#endif

/* Bit i: a[i] <= b[i]. */
static inline uint32_t rt_v8_at_most(__m256 a, __m256 b) {
#if defined(__AVX512VL__)
    return _mm256_cmp_ps_mask(a, b, _CMP_LE_OQ);
#else
    return (uint32_t)_mm256_movemask_ps(_mm256_cmp_ps(a, b, _CMP_LE_OQ));
#endif
}

#if !defined(__AVX512VL__)
/* For each mask of eight lanes the lanes in it, in ascending order, a byte each. */
extern const uint64_t rt_v8_lanes[256];
#endif

/* The order that brings the lanes of a mask to the front, for rt_v8_take. */
#if defined(__AVX512VL__)
typedef __mmask8 RtV8Order;
static inline RtV8Order rt_v8_order(uint32_t mask) {
    return (__mmask8)mask;
}
static inline __m256i rt_v8_take(RtV8Order order, __m256i a) {
    return _mm256_maskz_compress_epi32(order, a);
}
#else
typedef __m256i RtV8Order;
static inline RtV8Order rt_v8_order(uint32_t mask) {
    return _mm256_cvtepu8_epi32(_mm_loadl_epi64((const __m128i *)&rt_v8_lanes[mask]));
}
static inline __m256i rt_v8_take(RtV8Order order, __m256i a) {
    return _mm256_permutevar8x32_epi32(a, order);
}
#endif

#endif
