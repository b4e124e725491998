/* SPDX-License-Identifier: Apache-2.0 */
/* Vectors for the kernels of `wide`, in the words of AVX2: its own intrinsics where a file is compiled for
 * it, else SIMDe's, which do the same lane by lane in whatever the machine has. */
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

/* b in the lanes of the mask, else a. */
static inline __m256i rt_v8_pick(uint32_t mask, __m256i a, __m256i b) {
#if defined(__AVX512VL__)
    return _mm256_mask_mov_epi32(a, (__mmask8)mask, b);
#else
    const __m256i bits = _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
    __m256i in = _mm256_cmpeq_epi32(_mm256_and_si256(_mm256_set1_epi32((int)mask), bits), bits);
    return _mm256_blendv_epi8(a, b, in);
#endif
}

/* Eight words from and to anywhere. */
static inline __m256i rt_v8_get(const void *from) {
    return _mm256_loadu_si256((const __m256i *)from);
}
static inline void rt_v8_put(void *to, __m256i a) {
    _mm256_storeu_si256((__m256i *)to, a);
}

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

/* ---- sixteen floats ---- */

#if defined(__AVX512F__)
typedef __m512 RtV16;
static inline RtV16 rt_v16_all(float a) {
    return _mm512_set1_ps(a);
}
static inline RtV16 rt_v16_load(const float *a) {
    return _mm512_load_ps(a);
}
static inline void rt_v16_store(float *to, RtV16 a) {
    _mm512_store_ps(to, a);
}
/* table[index[i]] in lane i, of sixteen. */
static inline RtV16 rt_v16_lookup(const float *table, const uint32_t *index) {
    return _mm512_permutexvar_ps(_mm512_load_si512(index), _mm512_load_ps(table));
}
static inline RtV16 rt_v16_add(RtV16 a, RtV16 b) {
    return _mm512_add_ps(a, b);
}
static inline RtV16 rt_v16_sub(RtV16 a, RtV16 b) {
    return _mm512_sub_ps(a, b);
}
static inline RtV16 rt_v16_mul(RtV16 a, RtV16 b) {
    return _mm512_mul_ps(a, b);
}
static inline RtV16 rt_v16_div(RtV16 a, RtV16 b) {
    return _mm512_div_ps(a, b);
}
static inline RtV16 rt_v16_min(RtV16 a, RtV16 b) {
    return _mm512_min_ps(a, b);
}
static inline RtV16 rt_v16_max(RtV16 a, RtV16 b) {
    return _mm512_max_ps(a, b);
}
static inline RtV16 rt_v16_abs(RtV16 a) {
    return _mm512_abs_ps(a);
}
static inline uint32_t rt_v16_at_most(RtV16 a, RtV16 b) {
    return _mm512_cmp_ps_mask(a, b, _CMP_LE_OQ);
}
static inline uint32_t rt_v16_signs(RtV16 a) {
    return _mm512_movepi32_mask(_mm512_castps_si512(a));
}
static inline float rt_v16_least(RtV16 a) {
    return _mm512_reduce_min_ps(a);
}
static inline float rt_v16_most(RtV16 a) {
    return _mm512_reduce_max_ps(a);
}
#else
typedef struct RtV16 {
    __m256 lo, hi;
} RtV16;
#define RT_V16_PAIR(name)                                                                                    \
    static inline RtV16 rt_v16_##name(RtV16 a, RtV16 b) {                                                    \
        return (RtV16){_mm256_##name##_ps(a.lo, b.lo), _mm256_##name##_ps(a.hi, b.hi)};                      \
    }
RT_V16_PAIR(add)
RT_V16_PAIR(sub)
RT_V16_PAIR(mul)
RT_V16_PAIR(div)
RT_V16_PAIR(min)
RT_V16_PAIR(max)
#undef RT_V16_PAIR
static inline RtV16 rt_v16_all(float a) {
    return (RtV16){_mm256_set1_ps(a), _mm256_set1_ps(a)};
}
static inline RtV16 rt_v16_load(const float *a) {
    return (RtV16){_mm256_load_ps(a), _mm256_load_ps(a + 8)};
}
static inline void rt_v16_store(float *to, RtV16 a) {
    _mm256_store_ps(to, a.lo);
    _mm256_store_ps(to + 8, a.hi);
}
static inline RtV16 rt_v16_lookup(const float *table, const uint32_t *index) {
    __m256i lo = _mm256_load_si256((const __m256i *)index),
            hi = _mm256_load_si256((const __m256i *)(index + 8));
    return (RtV16){_mm256_i32gather_ps(table, lo, 4), _mm256_i32gather_ps(table, hi, 4)};
}
static inline RtV16 rt_v16_abs(RtV16 a) {
    const __m256 sign = _mm256_set1_ps(-0.0f);
    return (RtV16){_mm256_andnot_ps(sign, a.lo), _mm256_andnot_ps(sign, a.hi)};
}
static inline uint32_t rt_v16_at_most(RtV16 a, RtV16 b) {
    return rt_v8_at_most(a.lo, b.lo) | rt_v8_at_most(a.hi, b.hi) << 8;
}
static inline uint32_t rt_v16_signs(RtV16 a) {
    return (uint32_t)_mm256_movemask_ps(a.lo) | (uint32_t)_mm256_movemask_ps(a.hi) << 8;
}
static inline float rt_v8_least(__m256 a) {
    __m128 b = _mm_min_ps(_mm256_castps256_ps128(a), _mm256_extractf128_ps(a, 1));
    b = _mm_min_ps(b, _mm_movehl_ps(b, b));
    return _mm_cvtss_f32(_mm_min_ss(b, _mm_shuffle_ps(b, b, 1)));
}
static inline float rt_v16_least(RtV16 a) {
    return rt_v8_least(_mm256_min_ps(a.lo, a.hi));
}
static inline float rt_v16_most(RtV16 a) {
    const __m256 sign = _mm256_set1_ps(-0.0f);
    return -rt_v8_least(_mm256_xor_ps(_mm256_max_ps(a.lo, a.hi), sign));
}
#endif

#endif
