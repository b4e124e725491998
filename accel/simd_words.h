/* SPDX-License-Identifier: Apache-2.0 */
/* Sixteen words: from and to memory, arithmetic, comparisons, conversions, and as places in tables. Words are
 * signed where they are compared. */
#ifndef RT_ACCEL_SIMD_WORDS_H
#define RT_ACCEL_SIMD_WORDS_H

#include "accel/simd.h"

/* ---- memory and tables of floats ---- */

#if defined(__AVX512F__)
typedef __m512i RtW16;
static inline RtW16 rt_w16_all(uint32_t a) {
    return _mm512_set1_epi32((int)a);
}
static inline RtW16 rt_w16_get(const uint32_t *from) {
    return _mm512_loadu_si512(from);
}
static inline RtW16 rt_w16_of(RtV16 a) {
    return _mm512_castps_si512(a);
}
static inline RtW16 rt_w16_add(RtW16 a, RtW16 b) {
    return _mm512_add_epi32(a, b);
}
/* The lanes of a mask to to[0..16), whose others stay. */
static inline void rt_w16_store_some(uint32_t *to, uint32_t lanes, RtW16 a) {
    _mm512_mask_storeu_epi32(to, (__mmask16)lanes, a);
}
/* The lanes of a mask in ascending order to to[0..16), of which the others may be written over. */
static inline void rt_w16_put_some(uint32_t *to, uint32_t mask, RtW16 a) {
    _mm512_storeu_si512(to, _mm512_maskz_compress_epi32((__mmask16)mask, a));
}
/* table[index[i]] in lane i; an index is less than 2^31. */
static inline RtV16 rt_v16_lookup(const float *table, RtW16 index) {
    return _mm512_i32gather_ps(index, table, 4);
}
/* The same of a table of sixty-four, 64-byte aligned. */
static inline RtV16 rt_v16_pick64(const float *table, RtW16 index) {
    __m512 lo = _mm512_permutex2var_ps(_mm512_load_ps(table), index, _mm512_load_ps(table + 16));
    __m512 hi = _mm512_permutex2var_ps(_mm512_load_ps(table + 32), index, _mm512_load_ps(table + 48));
    return _mm512_mask_mov_ps(lo, _mm512_test_epi32_mask(index, _mm512_set1_epi32(32)), hi);
}
#else
typedef struct RtW16 {
    __m256i lo, hi;
} RtW16;
static inline RtW16 rt_w16_all(uint32_t a) {
    return (RtW16){_mm256_set1_epi32((int)a), _mm256_set1_epi32((int)a)};
}
static inline RtW16 rt_w16_get(const uint32_t *from) {
    return (RtW16){rt_v8_get(from), rt_v8_get(from + 8)};
}
static inline RtW16 rt_w16_of(RtV16 a) {
    return (RtW16){_mm256_castps_si256(a.lo), _mm256_castps_si256(a.hi)};
}
static inline RtW16 rt_w16_add(RtW16 a, RtW16 b) {
    return (RtW16){_mm256_add_epi32(a.lo, b.lo), _mm256_add_epi32(a.hi, b.hi)};
}
static inline void rt_w16_store_some(uint32_t *to, uint32_t lanes, RtW16 a) {
    rt_v8_put(to, rt_v8_pick(lanes & 255, rt_v8_get(to), a.lo));
    rt_v8_put(to + 8, rt_v8_pick(lanes >> 8, rt_v8_get(to + 8), a.hi));
}
static inline void rt_w16_put_some(uint32_t *to, uint32_t mask, RtW16 a) {
    rt_v8_put(to, rt_v8_take(rt_v8_order(mask & 255), a.lo));
    rt_v8_put(to + __builtin_popcount(mask & 255), rt_v8_take(rt_v8_order(mask >> 8), a.hi));
}
static inline RtV16 rt_v16_lookup(const float *table, RtW16 index) {
    return (RtV16){_mm256_i32gather_ps(table, index.lo, 4), _mm256_i32gather_ps(table, index.hi, 4)};
}
static inline RtV16 rt_v16_pick64(const float *table, RtW16 index) {
    return rt_v16_lookup(table, index);
}
#endif

/* ---- arithmetic, comparisons, tables of words ---- */

#if defined(__AVX512F__)
#define RT_W16_PAIR(name, intrinsic)                                                                         \
    static inline RtW16 rt_w16_##name(RtW16 a, RtW16 b) {                                                    \
        return _mm512_##intrinsic(a, b);                                                                     \
    }
RT_W16_PAIR(sub, sub_epi32)
RT_W16_PAIR(and, and_si512)
RT_W16_PAIR(or, or_si512)
RT_W16_PAIR(least, min_epi32)
RT_W16_PAIR(most, max_epi32)
#undef RT_W16_PAIR
#define rt_w16_left(a, bits)  _mm512_slli_epi32(a, bits)
#define rt_w16_right(a, bits) _mm512_srli_epi32(a, bits)
/* Bit i: a[i] == b[i]; a[i] < b[i]. */
static inline uint32_t rt_w16_equal(RtW16 a, RtW16 b) {
    return _mm512_cmpeq_epi32_mask(a, b);
}
static inline uint32_t rt_w16_below(RtW16 a, RtW16 b) {
    return _mm512_cmplt_epi32_mask(a, b);
}
/* Towards 0, of what is less than 2^31; and back. */
static inline RtW16 rt_w16_truncate(RtV16 a) {
    return _mm512_cvttps_epi32(a);
}
static inline RtV16 rt_v16_of_words(RtW16 a) {
    return _mm512_cvtepi32_ps(a);
}
/* a[i] moved right by bits[i], 0..31. */
static inline RtW16 rt_w16_down(RtW16 a, RtW16 bits) {
    return _mm512_srlv_epi32(a, bits);
}
/* table[2 * index[i]]: one of a row of pairs. */
static inline RtW16 rt_w16_lookup_pair(const uint32_t *table, RtW16 index) {
    return _mm512_i32gather_epi32(index, table, 8);
}
static inline RtW16 rt_w16_lookup(const uint32_t *table, RtW16 index) {
    return _mm512_i32gather_epi32(index, table, 4);
}
static inline void rt_w16_put(uint32_t *to, RtW16 a) {
    _mm512_storeu_si512(to, a);
}
/* b in the lanes of the mask, else a. */
static inline RtW16 rt_w16_pick(uint32_t mask, RtW16 a, RtW16 b) {
    return _mm512_mask_mov_epi32(a, (__mmask16)mask, b);
}
#else
#define RT_W16_PAIR(name, intrinsic)                                                                         \
    static inline RtW16 rt_w16_##name(RtW16 a, RtW16 b) {                                                    \
        return (RtW16){_mm256_##intrinsic(a.lo, b.lo), _mm256_##intrinsic(a.hi, b.hi)};                      \
    }
RT_W16_PAIR(sub, sub_epi32)
RT_W16_PAIR(and, and_si256)
RT_W16_PAIR(or, or_si256)
RT_W16_PAIR(least, min_epi32)
RT_W16_PAIR(most, max_epi32)
#undef RT_W16_PAIR
#define rt_w16_left(a, bits)  ((RtW16){_mm256_slli_epi32((a).lo, bits), _mm256_slli_epi32((a).hi, bits)})
#define rt_w16_right(a, bits) ((RtW16){_mm256_srli_epi32((a).lo, bits), _mm256_srli_epi32((a).hi, bits)})
static inline uint32_t rt_w16_signs(__m256i lo, __m256i hi) {
    return (uint32_t)_mm256_movemask_ps(_mm256_castsi256_ps(lo)) |
           (uint32_t)_mm256_movemask_ps(_mm256_castsi256_ps(hi)) << 8;
}
static inline uint32_t rt_w16_equal(RtW16 a, RtW16 b) {
    return rt_w16_signs(_mm256_cmpeq_epi32(a.lo, b.lo), _mm256_cmpeq_epi32(a.hi, b.hi));
}
static inline uint32_t rt_w16_below(RtW16 a, RtW16 b) {
    return rt_w16_signs(_mm256_cmpgt_epi32(b.lo, a.lo), _mm256_cmpgt_epi32(b.hi, a.hi));
}
static inline RtW16 rt_w16_truncate(RtV16 a) {
    return (RtW16){_mm256_cvttps_epi32(a.lo), _mm256_cvttps_epi32(a.hi)};
}
static inline RtV16 rt_v16_of_words(RtW16 a) {
    return (RtV16){_mm256_cvtepi32_ps(a.lo), _mm256_cvtepi32_ps(a.hi)};
}
static inline RtW16 rt_w16_down(RtW16 a, RtW16 bits) {
    return (RtW16){_mm256_srlv_epi32(a.lo, bits.lo), _mm256_srlv_epi32(a.hi, bits.hi)};
}
static inline RtW16 rt_w16_lookup_pair(const uint32_t *table, RtW16 index) {
    return (RtW16){_mm256_i32gather_epi32((const int *)table, index.lo, 8),
                   _mm256_i32gather_epi32((const int *)table, index.hi, 8)};
}
static inline RtW16 rt_w16_lookup(const uint32_t *table, RtW16 index) {
    return (RtW16){_mm256_i32gather_epi32((const int *)table, index.lo, 4),
                   _mm256_i32gather_epi32((const int *)table, index.hi, 4)};
}
static inline void rt_w16_put(uint32_t *to, RtW16 a) {
    rt_v8_put(to, a.lo);
    rt_v8_put(to + 8, a.hi);
}
static inline RtW16 rt_w16_pick(uint32_t mask, RtW16 a, RtW16 b) {
    return (RtW16){rt_v8_pick(mask & 255, a.lo, b.lo), rt_v8_pick(mask >> 8, a.hi, b.hi)};
}
#endif

#endif
