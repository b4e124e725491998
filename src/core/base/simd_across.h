/* SPDX-License-Identifier: Apache-2.0 */
/* SIMD across lanes: compression, tables, rearrangement, and the least of all lanes. simd.h describes the
 * types, names and masks. */
#ifndef RT_BASE_SIMD_ACROSS_H
#define RT_BASE_SIMD_ACROSS_H

#include "core/base/simd.h"

/* ---- compression: the lanes of some bits brought to the front, in order ---- */

/* For each eight bits the lanes in them, in ascending order, a byte each from the lowest on. */
extern const uint64_t rt_lanes_of_bits[256];

/* rt_compress8(rt_order8(bits), a): what is behind them is anything. */
#if RT_AVX512
typedef __mmask8 RtOrder8;
RT_INLINE RtOrder8 rt_order8(uint32_t bits) {
    return (__mmask8)bits;
}
RT_INLINE RtInt8 rt_compress8(RtOrder8 order, RtInt8 a) {
    return (RtInt8)_mm256_maskz_compress_epi32(order, (__m256i)a);
}
#elif defined(__AVX2__)
typedef __m256i RtOrder8;
RT_INLINE RtOrder8 rt_order8(uint32_t bits) {
    return _mm256_cvtepu8_epi32(_mm_loadl_epi64((const __m128i *)&rt_lanes_of_bits[bits]));
}
RT_INLINE RtInt8 rt_compress8(RtOrder8 order, RtInt8 a) {
    return (RtInt8)_mm256_permutevar8x32_epi32((__m256i)a, order);
}
#elif RT_NEON
typedef uint8x16x2_t RtOrder8; /* of bytes */
RT_INLINE RtOrder8 rt_order8(uint32_t bits) {
    const uint8x16_t byte = {0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3};
    uint8x16_t lanes = (uint8x16_t)vdupq_n_u64(rt_lanes_of_bits[bits]), twice = vzip1q_u8(lanes, lanes);
    return (RtOrder8){
        {vsliq_n_u8(byte, vzip1q_u8(twice, twice), 2), vsliq_n_u8(byte, vzip2q_u8(twice, twice), 2)}};
}
RT_INLINE RtInt8 rt_compress8(RtOrder8 order, RtInt8 a) {
    const uint8x16x2_t from = {{(uint8x16_t)rt_lower4((RtFloat8)a), (uint8x16_t)rt_upper4((RtFloat8)a)}};
    return (RtInt8)rt_join4((RtFloat4)vqtbl2q_u8(from, order.val[0]),
                            (RtFloat4)vqtbl2q_u8(from, order.val[1]));
}
#else
typedef uint64_t RtOrder8;
RT_INLINE RtOrder8 rt_order8(uint32_t bits) {
    return rt_lanes_of_bits[bits];
}
RT_INLINE RtInt8 rt_compress8(RtOrder8 order, RtInt8 a) {
    RtInt8 out;
    for (int i = 0; i < 8; i++) out[i] = a[order >> 8 * i & 7];
    return out;
}
#endif

/* To at[0..RT_LANES): so much is written. */
RT_INLINE void rt_compress_store(uint32_t *at, uint32_t bits, RtInts a) {
#if RT_AVX512
    _mm512_storeu_si512(at, _mm512_maskz_compress_epi32((__mmask16)bits, (__m512i)a));
#elif RT_LANES == 8
    rt_store(at, rt_compress8(rt_order8(bits), a));
#elif RT_NEON
    rt_store(at, (RtInt4)vqtbl1q_u8((uint8x16_t)a, rt_order8(bits).val[0]));
#else
    for (int i = 0; i < RT_LANES; i++) at[i] = (uint32_t)a[rt_lanes_of_bits[bits] >> 8 * i & 3];
#endif
}

/* ---- eight lanes whose mask stays as the machine makes it, and eight sets of up to sixty-four ---- */

/* rt_le_mask8: where a <= b; rt_mask8_bits: the same as bits; rt_one_mask8: lane i alone;
 * rt_select_mask8(mask, a, b): a there, else b;
 * rt_sets8_add: adds members to the sets of a mask; rt_sets8_bits: bit i: set i is not empty;
 * rt_sets8_compress: the sets of some bits, in order, to at[0..8). */
#if RT_AVX512
typedef __mmask8 RtMask8;
typedef RtLong8 RtSets8;
RT_INLINE RtMask8 rt_le_mask8(RtFloat8 a, RtFloat8 b) {
    return _mm256_cmp_ps_mask(a, b, _CMP_LE_OQ);
}
RT_INLINE uint32_t rt_mask8_bits(RtMask8 mask) {
    return mask;
}
RT_INLINE RtMask8 rt_one_mask8(uint32_t i) {
    return (RtMask8)(1u << i);
}
RT_INLINE RtFloat8 rt_select_mask8(RtMask8 mask, RtFloat8 a, RtFloat8 b) {
    return _mm256_mask_mov_ps(b, mask, a);
}
RT_INLINE void rt_sets8_add(RtSets8 *sets, RtMask8 mask, uint64_t members) {
    __m512i old = (__m512i)*sets;
    *sets = (RtSets8)_mm512_mask_or_epi64(old, mask, old, _mm512_set1_epi64((long long)members));
}
RT_INLINE uint32_t rt_sets8_bits(const RtSets8 *sets) {
    return _mm512_test_epi64_mask((__m512i)*sets, (__m512i)*sets);
}
RT_INLINE void rt_sets8_compress(uint64_t *at, uint32_t bits, const RtSets8 *sets) {
    _mm512_storeu_si512(at, _mm512_maskz_compress_epi64((__mmask8)bits, (__m512i)*sets));
}
#else
typedef RtInt8 RtMask8;
RT_INLINE RtMask8 rt_le_mask8(RtFloat8 a, RtFloat8 b) {
    return rt_le_float8(a, b);
}
RT_INLINE uint32_t rt_mask8_bits(RtMask8 mask) {
    return rt_bits_int8(mask);
}
RT_INLINE RtMask8 rt_one_mask8(uint32_t i) {
    const RtInt8 lanes = {0, 1, 2, 3, 4, 5, 6, 7};
    return rt_eq_int8(lanes, rt_all_ints8((int32_t)i));
}
RT_INLINE RtFloat8 rt_select_mask8(RtMask8 mask, RtFloat8 a, RtFloat8 b) {
    return rt_select(mask, a, b);
}
#if defined(__AVX2__)
typedef struct RtSets8 {
    RtLong4 lower, upper;
} RtSets8;
/* Each lane of a mask twice as wide. */
RT_INLINE RtLong4 rt_widen_mask4(RtFloat4 mask) {
    return (RtLong4)_mm256_cvtepi32_epi64((__m128i)mask);
}
RT_INLINE void rt_sets8_add(RtSets8 *sets, RtMask8 mask, uint64_t members) {
    sets->lower |= rt_widen_mask4(rt_lower4((RtFloat8)mask)) & (int64_t)members;
    sets->upper |= rt_widen_mask4(rt_upper4((RtFloat8)mask)) & (int64_t)members;
}
RT_INLINE uint32_t rt_sets8_bits(const RtSets8 *sets) {
    return 255 ^ (rt_bits_long4(sets->lower == 0) | rt_bits_long4(sets->upper == 0) << 4);
}
#else
typedef struct RtSets8 {
    RtLong2 pair[4];
} RtSets8;
RT_INLINE void rt_sets8_add(RtSets8 *sets, RtMask8 mask, uint64_t members) {
    RtFloat4 lower = rt_lower4((RtFloat8)mask), upper = rt_upper4((RtFloat8)mask);
    sets->pair[0] |= (RtLong2)__builtin_shufflevector(lower, lower, 0, 0, 1, 1) & (int64_t)members;
    sets->pair[1] |= (RtLong2)__builtin_shufflevector(lower, lower, 2, 2, 3, 3) & (int64_t)members;
    sets->pair[2] |= (RtLong2)__builtin_shufflevector(upper, upper, 0, 0, 1, 1) & (int64_t)members;
    sets->pair[3] |= (RtLong2)__builtin_shufflevector(upper, upper, 2, 2, 3, 3) & (int64_t)members;
}
/* The four of two pairs: are there any? */
RT_INLINE RtFloat4 rt_some4(RtLong2 a, RtLong2 b) {
    return __builtin_shufflevector((RtFloat4)(a != 0), (RtFloat4)(b != 0), 0, 2, 4, 6);
}
RT_INLINE uint32_t rt_sets8_bits(const RtSets8 *sets) {
    return rt_bits_int8(
        (RtInt8)rt_join4(rt_some4(sets->pair[0], sets->pair[1]), rt_some4(sets->pair[2], sets->pair[3])));
}
#endif
RT_INLINE void rt_sets8_compress(uint64_t *at, uint32_t bits, const RtSets8 *sets) {
    _Alignas(32) RtSets8 all = *sets;
    const uint64_t *set = (const uint64_t *)&all;
    for (; bits; bits &= bits - 1) *at++ = set[__builtin_ctz(bits)];
}
#endif

/* ---- tables ---- */

/* table[index[i]] in lane i, index < 2^31. */
RT_INLINE RtFloats rt_gather(const float *table, RtInts index) {
#if RT_AVX512
    return _mm512_i32gather_ps((__m512i)index, table, 4);
#elif RT_LANES == 8
    return _mm256_i32gather_ps(table, (__m256i)index, 4);
#else
    return (RtFloats){table[index[0]], table[index[1]], table[index[2]], table[index[3]]};
#endif
}
/* The same of a table of sixty-four floats, aligned to 64 bytes. */
RT_INLINE RtFloats rt_gather64(const float *table, RtInts index) {
#if RT_AVX512
    __m512i i = (__m512i)index;
    __m512 lo = _mm512_permutex2var_ps(_mm512_load_ps(table), i, _mm512_load_ps(table + 16));
    __m512 hi = _mm512_permutex2var_ps(_mm512_load_ps(table + 32), i, _mm512_load_ps(table + 48));
    return _mm512_mask_mov_ps(lo, _mm512_test_epi32_mask(i, _mm512_set1_epi32(32)), hi);
#else
    return rt_gather(table, index);
#endif
}

/* ---- rearranging lanes, in groups of four ---- */

/* Lane k of row i becomes lane i of row k. */
RT_INLINE void rt_transpose4(RtFloat4 rows[4]) {
    RtFloat4 a = __builtin_shufflevector(rows[0], rows[1], 0, 4, 1, 5);
    RtFloat4 b = __builtin_shufflevector(rows[0], rows[1], 2, 6, 3, 7);
    RtFloat4 c = __builtin_shufflevector(rows[2], rows[3], 0, 4, 1, 5);
    RtFloat4 d = __builtin_shufflevector(rows[2], rows[3], 2, 6, 3, 7);
    rows[0] = __builtin_shufflevector(a, c, 0, 1, 4, 5);
    rows[1] = __builtin_shufflevector(a, c, 2, 3, 6, 7);
    rows[2] = __builtin_shufflevector(b, d, 0, 1, 4, 5);
    rows[3] = __builtin_shufflevector(b, d, 2, 3, 6, 7);
}

/* rt_repeat4(a): a in each group. rt_load_groups(at): group i from at[i], anywhere. rt_spread4(a, i): lane i
 * of each group, a constant, in all of the group. */
enum { RT_GROUPS = RT_LANES / 4 };
#if RT_AVX512
RT_DEFINE_OF_ONE(RtFloats, rt_repeat4, RtFloat4, _mm512_broadcast_f32x4(a))
RT_INLINE RtFloats rt_load_groups(const float *const at[RT_GROUPS]) {
    __m512 joined = _mm512_insertf32x4(_mm512_castps128_ps512(rt_loadu4(at[0])), rt_loadu4(at[1]), 1);
    return _mm512_insertf32x4(_mm512_insertf32x4(joined, rt_loadu4(at[2]), 2), rt_loadu4(at[3]), 3);
}
#define rt_spread4(a, i) ((RtFloats)_mm512_permute_ps(a, 0x55 * (i)))
#elif RT_LANES == 8
RT_DEFINE_OF_ONE(RtFloats, rt_repeat4, RtFloat4, _mm256_set_m128(a, a))
RT_INLINE RtFloats rt_load_groups(const float *const at[RT_GROUPS]) {
    return _mm256_set_m128(rt_loadu4(at[1]), rt_loadu4(at[0]));
}
#define rt_spread4(a, i) ((RtFloats)_mm256_permute_ps(a, 0x55 * (i)))
#else
RT_DEFINE_OF_ONE(RtFloats, rt_repeat4, RtFloat4, a)
RT_INLINE RtFloats rt_load_groups(const float *const at[RT_GROUPS]) {
    return rt_loadu4(at[0]);
}
#define rt_spread4(a, i) __builtin_shufflevector(a, a, i, i, i, i)
#endif

/* Four floats from each of RT_LANES places: float k of place i to lane i of columns[k]. */
RT_INLINE void rt_load_columns(const float *const from[RT_LANES], RtFloats columns[4]) {
    RtFloats r[4];
    for (int i = 0; i < 4; i++) {
        const float *at[RT_GROUPS];
        for (int k = 0; k < RT_GROUPS; k++) at[k] = from[4 * k + i];
        r[i] = rt_load_groups(at);
    }
#if RT_LANES == 4
    rt_transpose4(r);
    for (int k = 0; k < 4; k++) columns[k] = r[k];
#else
    RtFloats a = RT_MM(unpacklo_ps)(r[0], r[1]), b = RT_MM(unpacklo_ps)(r[2], r[3]);
    RtFloats c = RT_MM(unpackhi_ps)(r[0], r[1]), d = RT_MM(unpackhi_ps)(r[2], r[3]);
    columns[0] = RT_MM(shuffle_ps)(a, b, 0x44);
    columns[1] = RT_MM(shuffle_ps)(a, b, 0xee);
    columns[2] = RT_MM(shuffle_ps)(c, d, 0x44);
    columns[3] = RT_MM(shuffle_ps)(c, d, 0xee);
#endif
}

/* ---- the least and the most of all lanes ---- */

/* Lane i: the least of the lanes i modulo 4. */
RT_INLINE RtFloat4 rt_fold4(RtFloats a) {
#if RT_AVX512
    RtFloat8 half = rt_min_float8(_mm512_castps512_ps256(a), _mm512_extractf32x8_ps(a, 1));
    return rt_min_float4(rt_lower4(half), rt_upper4(half));
#elif RT_LANES == 8
    return rt_min_float4(rt_lower4(a), rt_upper4(a));
#else
    return a;
#endif
}
RT_INLINE float rt_least4(RtFloat4 a) {
    a = rt_min_float4(a, __builtin_shufflevector(a, a, 2, 3, 0, 1));
    return rt_min_float4(a, __builtin_shufflevector(a, a, 1, 0, 3, 2))[0];
}
RT_DEFINE_OF_ONE(float, rt_least, RtFloats, rt_least4(rt_fold4(a)))
RT_DEFINE_OF_ONE(float, rt_most, RtFloats, -rt_least(-a))

#endif
