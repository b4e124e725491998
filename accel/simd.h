/* SPDX-License-Identifier: Apache-2.0 */
/* Vectors of floats for kernels, in the words of AVX2: its own intrinsics where a file is compiled for it,
 * else SIMDe's, which do the same lane by lane in whatever the machine has. Sixteen lanes are two halves of
 * eight, or one vector of AVX-512. simd_words.h has sixteen words, simd_doubles.h eight doubles. */
#ifndef RT_ACCEL_SIMD_H
#define RT_ACCEL_SIMD_H

#include "core/base/four.h"

#if defined(__AVX2__)
#include <immintrin.h>
#else
#define SIMDE_ENABLE_NATIVE_ALIASES
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wpedantic"
#include <simde/x86/avx2.h>
#pragma GCC diagnostic pop
/* clang 19 declares the first eight predicates for SSE, which SIMDe takes for all of them. */
#if !defined(_CMP_LE_OQ)
#define _CMP_NEQ_OQ SIMDE_CMP_NEQ_OQ
#define _CMP_LT_OQ  SIMDE_CMP_LT_OQ
#define _CMP_LE_OQ  SIMDE_CMP_LE_OQ
#define _CMP_GE_OQ  SIMDE_CMP_GE_OQ
#endif
#endif

/* Which of eight lanes: a[i] <= b[i]. */
#if defined(__AVX512VL__)
typedef __mmask8 RtV8Mask;
static inline RtV8Mask rt_v8_within(__m256 a, __m256 b) {
    return _mm256_cmp_ps_mask(a, b, _CMP_LE_OQ);
}
static inline uint32_t rt_v8_bits(RtV8Mask mask) {
    return mask;
}
/* The lesser of a and b in the lanes of the mask, else b. */
static inline __m256 rt_v8_min_where(RtV8Mask mask, __m256 a, __m256 b) {
    return _mm256_mask_min_ps(b, mask, a, b);
}
#else
typedef __m256 RtV8Mask;
static inline RtV8Mask rt_v8_within(__m256 a, __m256 b) {
    return _mm256_cmp_ps(a, b, _CMP_LE_OQ);
}
static inline uint32_t rt_v8_bits(RtV8Mask mask) {
    return (uint32_t)_mm256_movemask_ps(mask);
}
static inline __m256 rt_v8_min_where(RtV8Mask mask, __m256 a, __m256 b) {
    return _mm256_blendv_ps(b, _mm256_min_ps(a, b), mask);
}
#endif

/* Bit i: a[i] <= b[i]. */
static inline uint32_t rt_v8_at_most(__m256 a, __m256 b) {
    return rt_v8_bits(rt_v8_within(a, b));
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

/* ---- eight sets of up to sixty-four ---- */

#if defined(__AVX512F__)
typedef __m512i RtV8Sets;
static inline RtV8Sets rt_v8_sets_none(void) {
    return _mm512_setzero_si512();
}
/* Adds `members` to the sets of the mask. */
static inline void rt_v8_sets_add(RtV8Sets *sets, RtV8Mask mask, uint64_t members) {
    *sets = _mm512_mask_or_epi64(*sets, mask, *sets, _mm512_set1_epi64((long long)members));
}
/* Bit i: set i has members. */
static inline uint32_t rt_v8_sets_some(const RtV8Sets *sets) {
    return _mm512_test_epi64_mask(*sets, *sets);
}
/* All to to[0..8), 64-byte aligned; those of a mask of lanes, in ascending order, to to[0..8), anywhere. */
static inline void rt_v8_sets_put(uint64_t *to, const RtV8Sets *sets) {
    _mm512_store_si512(to, *sets);
}
static inline void rt_v8_sets_take(uint64_t *to, uint32_t mask, const RtV8Sets *sets) {
    _mm512_storeu_si512(to, _mm512_maskz_compress_epi64((__mmask8)mask, *sets));
}
#else
typedef struct RtV8Sets {
    __m256i lo, hi;
} RtV8Sets;
static inline RtV8Sets rt_v8_sets_none(void) {
    return (RtV8Sets){_mm256_setzero_si256(), _mm256_setzero_si256()};
}
static inline void rt_v8_sets_add(RtV8Sets *sets, RtV8Mask mask, uint64_t members) {
    const __m256i all = _mm256_set1_epi64x((long long)members), lanes = _mm256_castps_si256(mask);
    __m256i lo = _mm256_cvtepi32_epi64(_mm256_castsi256_si128(lanes));
    __m256i hi = _mm256_cvtepi32_epi64(_mm256_extracti128_si256(lanes, 1));
    sets->lo = _mm256_or_si256(sets->lo, _mm256_and_si256(lo, all));
    sets->hi = _mm256_or_si256(sets->hi, _mm256_and_si256(hi, all));
}
static inline uint32_t rt_v8_sets_some(const RtV8Sets *sets) {
    const __m256i zero = _mm256_setzero_si256();
    __m256d lo = _mm256_castsi256_pd(_mm256_cmpeq_epi64(sets->lo, zero));
    __m256d hi = _mm256_castsi256_pd(_mm256_cmpeq_epi64(sets->hi, zero));
    return 255 ^ (uint32_t)(_mm256_movemask_pd(lo) | _mm256_movemask_pd(hi) << 4);
}
static inline void rt_v8_sets_put(uint64_t *to, const RtV8Sets *sets) {
    _mm256_store_si256((__m256i *)to, sets->lo);
    _mm256_store_si256((__m256i *)(to + 4), sets->hi);
}
static inline void rt_v8_sets_take(uint64_t *to, uint32_t mask, const RtV8Sets *sets) {
    _Alignas(32) uint64_t all[8];
    rt_v8_sets_put(all, sets);
    for (; mask; mask &= mask - 1) *to++ = all[__builtin_ctz(mask)];
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
static inline RtV16 rt_v16_tile(__m128 a) {
    return _mm512_broadcast_f32x4(a);
}
/* Four floats from each place, which need not be aligned. */
static inline RtV16 rt_v16_join(const float *a, const float *b, const float *c, const float *d) {
    __m512 joined = _mm512_insertf32x4(_mm512_castps128_ps512(_mm_loadu_ps(a)), _mm_loadu_ps(b), 1);
    return _mm512_insertf32x4(_mm512_insertf32x4(joined, _mm_loadu_ps(c), 2), _mm_loadu_ps(d), 3);
}
#define rt_v16_spread(a, i) _mm512_permute_ps(a, 0x55 * (i))
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
typedef __mmask16 RtSet16;
static inline RtSet16 rt_v16_below(RtV16 a, RtV16 b) {
    return _mm512_cmp_ps_mask(a, b, _CMP_LT_OQ);
}
static inline RtSet16 rt_v16_negative(RtV16 a) {
    return _mm512_movepi32_mask(_mm512_castps_si512(a));
}
static inline RtV16 rt_v16_pick(RtSet16 set, RtV16 a, RtV16 b) {
    return _mm512_mask_mov_ps(a, set, b);
}
static inline uint32_t rt_v16_bits(RtSet16 set) {
    return set;
}
static inline void rt_v16_store_some(float *to, uint32_t lanes, RtV16 a) {
    _mm512_mask_store_ps(to, (__mmask16)lanes, a);
}
static inline RtV16 rt_v16_floor(RtV16 a) {
    return _mm512_roundscale_ps(a, _MM_FROUND_TO_NEG_INF | _MM_FROUND_NO_EXC);
}
static inline RtV16 rt_v16_ceil(RtV16 a) {
    return _mm512_roundscale_ps(a, _MM_FROUND_TO_POS_INF | _MM_FROUND_NO_EXC);
}
static inline void rt_v16_truncate(int32_t *to, RtV16 a) {
    _mm512_store_si512(to, _mm512_cvttps_epi32(a));
}
static inline __m256 rt_v16_half(RtV16 a, int half) {
    return half ? _mm512_extractf32x8_ps(a, 1) : _mm512_castps512_ps256(a);
}
static inline RtV16 rt_v16_halves(__m256 lo, __m256 hi) {
    return _mm512_insertf32x8(_mm512_castps256_ps512(lo), hi, 1);
}
static inline RtV16 rt_v16_unpack_lo(RtV16 a, RtV16 b) {
    return _mm512_unpacklo_ps(a, b);
}
static inline RtV16 rt_v16_unpack_hi(RtV16 a, RtV16 b) {
    return _mm512_unpackhi_ps(a, b);
}
#define rt_v16_shuffle(a, b, order) _mm512_shuffle_ps(a, b, order)
static inline float rt_v16_most(RtV16 a) {
    return _mm512_reduce_max_ps(a);
}
static inline __m256 rt_v16_fold(RtV16 a) {
    return _mm256_min_ps(_mm512_castps512_ps256(a), _mm512_extractf32x8_ps(a, 1));
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
static inline RtV16 rt_v16_tile(__m128 a) {
    return (RtV16){_mm256_set_m128(a, a), _mm256_set_m128(a, a)};
}
static inline RtV16 rt_v16_join(const float *a, const float *b, const float *c, const float *d) {
    return (RtV16){_mm256_set_m128(_mm_loadu_ps(b), _mm_loadu_ps(a)),
                   _mm256_set_m128(_mm_loadu_ps(d), _mm_loadu_ps(c))};
}
#define rt_v16_spread(a, i)                                                                                  \
    ((RtV16){_mm256_permute_ps((a).lo, 0x55 * (i)), _mm256_permute_ps((a).hi, 0x55 * (i))})
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
/* Some of sixteen lanes: those with the sign bit set. */
typedef RtV16 RtSet16;
/* Those where a < b; those with the sign bit set; and b in the lanes of a set, else a. */
static inline RtSet16 rt_v16_below(RtV16 a, RtV16 b) {
    return (RtSet16){_mm256_cmp_ps(a.lo, b.lo, _CMP_LT_OQ), _mm256_cmp_ps(a.hi, b.hi, _CMP_LT_OQ)};
}
static inline RtSet16 rt_v16_negative(RtV16 a) {
    return a;
}
static inline RtV16 rt_v16_pick(RtSet16 set, RtV16 a, RtV16 b) {
    return (RtV16){_mm256_blendv_ps(a.lo, b.lo, set.lo), _mm256_blendv_ps(a.hi, b.hi, set.hi)};
}
/* Bit i: lane i is in the set. */
static inline uint32_t rt_v16_bits(RtSet16 set) {
    return rt_v16_signs(set);
}
/* The lanes of a mask to to[0..16), 64-byte aligned, whose others stay. */
static inline void rt_v8_store_some(float *to, uint32_t lanes, __m256 a) {
    __m256i kept = rt_v8_get(to);
    rt_v8_put(to, rt_v8_pick(lanes, kept, _mm256_castps_si256(a)));
}
static inline void rt_v16_store_some(float *to, uint32_t lanes, RtV16 a) {
    rt_v8_store_some(to, lanes & 255, a.lo);
    rt_v8_store_some(to + 8, lanes >> 8, a.hi);
}
static inline RtV16 rt_v16_floor(RtV16 a) {
    return (RtV16){_mm256_floor_ps(a.lo), _mm256_floor_ps(a.hi)};
}
static inline RtV16 rt_v16_ceil(RtV16 a) {
    return (RtV16){_mm256_ceil_ps(a.lo), _mm256_ceil_ps(a.hi)};
}
/* The integer parts, to to[0..16), 64-byte aligned. */
static inline void rt_v16_truncate(int32_t *to, RtV16 a) {
    rt_v8_put(to, _mm256_cvttps_epi32(a.lo));
    rt_v8_put(to + 8, _mm256_cvttps_epi32(a.hi));
}
/* The lower eight, 0, or the upper, 1; and of both. */
static inline __m256 rt_v16_half(RtV16 a, int half) {
    return half ? a.hi : a.lo;
}
static inline RtV16 rt_v16_halves(__m256 lo, __m256 hi) {
    return (RtV16){lo, hi};
}
/* As of SSE, four lanes at a time. */
static inline RtV16 rt_v16_unpack_lo(RtV16 a, RtV16 b) {
    return (RtV16){_mm256_unpacklo_ps(a.lo, b.lo), _mm256_unpacklo_ps(a.hi, b.hi)};
}
static inline RtV16 rt_v16_unpack_hi(RtV16 a, RtV16 b) {
    return (RtV16){_mm256_unpackhi_ps(a.lo, b.lo), _mm256_unpackhi_ps(a.hi, b.hi)};
}
#define rt_v16_shuffle(a, b, order)                                                                          \
    ((RtV16){_mm256_shuffle_ps((a).lo, (b).lo, order), _mm256_shuffle_ps((a).hi, (b).hi, order)})
static inline float rt_v8_least(__m256 a) {
    __m128 b = _mm_min_ps(_mm256_castps256_ps128(a), _mm256_extractf128_ps(a, 1));
    b = _mm_min_ps(b, _mm_movehl_ps(b, b));
    return _mm_cvtss_f32(_mm_min_ss(b, _mm_shuffle_ps(b, b, 1)));
}
static inline __m256 rt_v16_fold(RtV16 a) {
    return _mm256_min_ps(a.lo, a.hi);
}
static inline float rt_v16_most(RtV16 a) {
    const __m256 sign = _mm256_set1_ps(-0.0f);
    return -rt_v8_least(_mm256_xor_ps(_mm256_max_ps(a.lo, a.hi), sign));
}
#endif

/* The least of the lanes. */
static inline float rt_v16_least(RtV16 a) {
#if defined(__AVX512F__)
    return _mm512_reduce_min_ps(a);
#else
    return rt_v8_least(rt_v16_fold(a));
#endif
}

/* The least of the lanes of each of four vectors. */
static inline RtFour rt_v16_least4(RtV16 a, RtV16 b, RtV16 c, RtV16 d) {
    __m256 x = rt_v16_fold(a), y = rt_v16_fold(b), z = rt_v16_fold(c), w = rt_v16_fold(d);
    __m256d xy = _mm256_castps_pd(_mm256_min_ps(_mm256_unpacklo_ps(x, y), _mm256_unpackhi_ps(x, y)));
    __m256d zw = _mm256_castps_pd(_mm256_min_ps(_mm256_unpacklo_ps(z, w), _mm256_unpackhi_ps(z, w)));
    __m256 all = _mm256_min_ps(_mm256_castpd_ps(_mm256_unpacklo_pd(xy, zw)),
                               _mm256_castpd_ps(_mm256_unpackhi_pd(xy, zw)));
    return (RtFour)_mm_min_ps(_mm256_castps256_ps128(all), _mm256_extractf128_ps(all, 1));
}

/* Column k, of 4, of the sixteen places, from each of which four floats are read, to columns[k]. */
static inline void rt_v16_columns(const float *const from[16], RtV16 columns[4]) {
    RtV16 r[4];
    for (int i = 0; i < 4; i++) r[i] = rt_v16_join(from[i], from[4 + i], from[8 + i], from[12 + i]);
    RtV16 a = rt_v16_unpack_lo(r[0], r[1]), b = rt_v16_unpack_lo(r[2], r[3]);
    RtV16 c = rt_v16_unpack_hi(r[0], r[1]), d = rt_v16_unpack_hi(r[2], r[3]);
    columns[0] = rt_v16_shuffle(a, b, 0x44);
    columns[1] = rt_v16_shuffle(a, b, 0xee);
    columns[2] = rt_v16_shuffle(c, d, 0x44);
    columns[3] = rt_v16_shuffle(c, d, 0xee);
}

#endif
