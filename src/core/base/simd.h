/* SPDX-License-Identifier: Apache-2.0 */
/* SIMD by the vector extension of gcc and clang, lane by lane. Only this file and simd_across.h, for what
 * moves between lanes or combines them, know an instruction set.
 *
 * How to write a kernel. Operators compute lane by lane, to the bits of the scalar operators:
 *
 *     RtFloats x = rt_load(&block->x[i]) - ray->org.x;    a scalar operand counts for all lanes
 *     RtInts inside = (x >= 0) & (x <= limit);            a comparison is -1 in lanes where it holds, else 0
 *     nearest = rt_min(rt_select(inside, x, far), nearest);
 *
 * RtFloats, RtInts and RtDoubles fill a register of the instruction set that the file is compiled
 * for: RT_LANES floats (16 with AVX-512, 8 with AVX2, else 4, as with SSE2 and NEON), as many 32-bit
 * integers, half as many doubles. A kernel takes its items RT_LANES at a time. gcc would keep
 * wider vectors in memory, which doubles the instructions. Where the data set the width, use RtFloat4 or
 * RtFloat8.
 *
 * The helpers below do what operators cannot. Those that take a vector accept each width and
 * element. Those that make one end in the number of its lanes (rt_load8), or make RT_LANES (rt_load). A mask
 * is a vector of -1 and 0, for rt_select, or an integer whose bit i is lane i, for loops and branches:
 * rt_le_bits(a, b) and its kin compare straight to such bits, which AVX-512 does in one instruction.
 *
 * rt_min(a, b) is a < b ? a : b, as in x86 and rt_minf: b where one is NaN. rt_max likewise. */
#ifndef RT_BASE_SIMD_H
#define RT_BASE_SIMD_H

#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#if defined(__AVX2__)
#include <immintrin.h>
#elif defined(__SSE2__)
#include <emmintrin.h>
#elif defined(__aarch64__) && defined(__ARM_NEON)
#include <arm_neon.h>
#define RT_NEON 1
#endif
#if !defined(RT_NEON)
#define RT_NEON 0
#endif

#if defined(__AVX512F__) && defined(__AVX512VL__) && defined(__AVX512DQ__) && defined(__AVX512BW__)
#define RT_AVX512 1
#define RT_LANES  16
#define RT_HALF   8
#define RT_MM(op) _mm512_##op
#elif defined(__AVX2__)
#define RT_AVX512 0
#define RT_LANES  8
#define RT_HALF   4
#define RT_MM(op) _mm256_##op
#else
#define RT_AVX512 0
#define RT_LANES  4
#define RT_HALF   2
#endif

#define RT_INLINE static inline __attribute__((always_inline))

/* ---- types, and what operators do for every width ----
 *
 * rt_all(x): x in all lanes (x - 0 keeps -0)
 * rt_load(p): aligned to the vector; rt_loadu(p), rt_load_ints(p), rt_store(p, a): anywhere
 * rt_abs(a): of floats or doubles
 * rt_select(mask, a, b): a where the mask is -1, b where it is 0; of floats or words */

#define RT_DEFINE_VECTORS(N, HALF)                                                                           \
    typedef float RtFloat##N __attribute__((vector_size(4 * N)));                                            \
    typedef int32_t RtInt##N __attribute__((vector_size(4 * N)));                                            \
    typedef double RtDouble##HALF __attribute__((vector_size(4 * N)));                                       \
    typedef int64_t RtLong##HALF __attribute__((vector_size(4 * N)));                                        \
    typedef RtFloat##N RtFloatAt##N __attribute__((may_alias));                                              \
    typedef RtFloat##N RtFloatAnywhere##N __attribute__((aligned(4), may_alias));                            \
    typedef RtInt##N RtIntAnywhere##N __attribute__((aligned(4), may_alias));                                \
    RT_INLINE RtFloat##N rt_all##N(float x) {                                                                \
        return x - (RtFloat##N){0};                                                                          \
    }                                                                                                        \
    RT_INLINE RtInt##N rt_all_ints##N(int32_t x) {                                                           \
        return x - (RtInt##N){0};                                                                            \
    }                                                                                                        \
    RT_INLINE RtFloat##N rt_load##N(const void *at) {                                                        \
        return *(const RtFloatAt##N *)at;                                                                    \
    }                                                                                                        \
    RT_INLINE RtFloat##N rt_loadu##N(const void *at) {                                                       \
        return *(const RtFloatAnywhere##N *)at;                                                              \
    }                                                                                                        \
    RT_INLINE RtInt##N rt_load_ints##N(const void *at) {                                                     \
        return *(const RtIntAnywhere##N *)at;                                                                \
    }                                                                                                        \
    RT_INLINE void rt_store_float##N(void *at, RtFloat##N a) {                                               \
        *(RtFloatAnywhere##N *)at = a;                                                                       \
    }                                                                                                        \
    RT_INLINE void rt_store_int##N(void *at, RtInt##N a) {                                                   \
        *(RtIntAnywhere##N *)at = a;                                                                         \
    }                                                                                                        \
    RT_INLINE RtFloat##N rt_abs_float##N(RtFloat##N a) {                                                     \
        return (RtFloat##N)((RtInt##N)a & INT32_MAX);                                                        \
    }                                                                                                        \
    RT_INLINE RtDouble##HALF rt_abs_double##HALF(RtDouble##HALF a) {                                         \
        return (RtDouble##HALF)((RtLong##HALF)a & INT64_MAX);                                                \
    }                                                                                                        \
    RT_INLINE RtInt##N rt_select_int##N(RtInt##N mask, RtInt##N a, RtInt##N b) {                             \
        return RT_BLEND(N, mask, a, b);                                                                      \
    }                                                                                                        \
    RT_INLINE RtFloat##N rt_select_float##N(RtInt##N mask, RtFloat##N a, RtFloat##N b) {                     \
        return (RtFloat##N)rt_select_int##N(mask, (RtInt##N)a, (RtInt##N)b);                                 \
    }                                                                                                        \
    RT_INLINE RtDouble##HALF rt_select_double##HALF(RtLong##HALF mask, RtDouble##HALF a, RtDouble##HALF b) { \
        return (RtDouble##HALF)rt_select_int##N((RtInt##N)mask, (RtInt##N)a, (RtInt##N)b);                   \
    }

#if defined(__AVX2__) && !RT_AVX512
#define RT_BLEND(N, mask, a, b) RT_BLEND_##N(mask, a, b)
#define RT_BLEND_4(mask, a, b)  ((RtInt4)_mm_blendv_epi8((__m128i)(b), (__m128i)(a), (__m128i)(mask)))
#define RT_BLEND_8(mask, a, b)  ((RtInt8)_mm256_blendv_epi8((__m256i)(b), (__m256i)(a), (__m256i)(mask)))
#else
#define RT_BLEND(N, mask, a, b) (((mask) & (a)) | (~(mask) & (b)))
#endif

RT_DEFINE_VECTORS(4, 2)
RT_DEFINE_VECTORS(8, 4)
#if RT_AVX512
RT_DEFINE_VECTORS(16, 8)
#endif

/* A function of a; of a and b. */
#define RT_DEFINE_OF_ONE(Result, name, Type, ...)                                                            \
    RT_INLINE Result name(Type a) {                                                                          \
        return __VA_ARGS__;                                                                                  \
    }
#define RT_DEFINE_OF_TWO(Type, name, value)                                                                  \
    RT_INLINE Type name(Type a, Type b) {                                                                    \
        return value;                                                                                        \
    }

/* ---- halves ---- */

#if defined(__AVX2__)
RT_DEFINE_OF_ONE(RtFloat4, rt_lower4, RtFloat8, _mm256_castps256_ps128(a))
RT_DEFINE_OF_ONE(RtFloat4, rt_upper4, RtFloat8, _mm256_extractf128_ps(a, 1))
#else
/* Without registers of eight gcc would move and compare lane by lane what is not in a union. */
typedef union RtHalves {
    RtFloat8 whole;
    RtFloat4 half[2];
} RtHalves;
RT_INLINE RtFloat4 rt_lower4(RtFloat8 a) {
    return (RtHalves){.whole = a}.half[0];
}
RT_INLINE RtFloat4 rt_upper4(RtFloat8 a) {
    return (RtHalves){.whole = a}.half[1];
}
RT_INLINE RtFloat8 rt_join4(RtFloat4 lower, RtFloat4 upper) {
    return (RtHalves){.half = {lower, upper}}.whole;
}
#endif

/* ---- minimum, maximum, signs ----
 *
 * rt_bits(mask): bit i is the sign of lane i */

#define RT_DEFINE_BY_REGISTER(N, HALF, MM)                                                                   \
    RT_DEFINE_OF_TWO(RtFloat##N, rt_min_float##N, MM##_min_ps(a, b))                                         \
    RT_DEFINE_OF_TWO(RtFloat##N, rt_max_float##N, MM##_max_ps(a, b))                                         \
    RT_DEFINE_OF_TWO(RtDouble##HALF, rt_min_double##HALF, MM##_min_pd(a, b))                                 \
    RT_DEFINE_OF_TWO(RtDouble##HALF, rt_max_double##HALF, MM##_max_pd(a, b))

#define RT_DEFINE_INTS_BY_REGISTER(N, MM, Reg)                                                               \
    RT_DEFINE_OF_TWO(RtInt##N, rt_min_int##N, (RtInt##N)MM##_min_epi32((Reg)a, (Reg)b))                      \
    RT_DEFINE_OF_TWO(RtInt##N, rt_max_int##N, (RtInt##N)MM##_max_epi32((Reg)a, (Reg)b))

#define RT_DEFINE_BITS_BY_REGISTER(N, HALF, MM)                                                              \
    RT_INLINE uint32_t rt_bits_int##N(RtInt##N mask) {                                                       \
        return (uint32_t)MM##_movemask_ps((RtFloat##N)mask);                                                 \
    }                                                                                                        \
    RT_INLINE uint32_t rt_bits_long##HALF(RtLong##HALF mask) {                                               \
        return (uint32_t)MM##_movemask_pd((RtDouble##HALF)mask);                                             \
    }

#define RT_DEFINE_BY_OPERATOR(Type, type)                                                                    \
    RT_DEFINE_OF_TWO(Type, rt_min_##type, rt_select_##type(a < b, a, b))                                     \
    RT_DEFINE_OF_TWO(Type, rt_max_##type, rt_select_##type(a > b, a, b))

#define RT_DEFINE_BITS_BY_LANE(Type, type, lanes)                                                            \
    RT_INLINE uint32_t rt_bits_##type(Type mask) {                                                           \
        uint32_t bits = 0;                                                                                   \
        for (int i = 0; i < lanes; i++) bits |= (uint32_t)(mask[i] < 0) << i;                                \
        return bits;                                                                                         \
    }

#if defined(__SSE2__)
RT_DEFINE_BY_REGISTER(4, 2, _mm)
RT_DEFINE_BITS_BY_REGISTER(4, 2, _mm)
#else
RT_DEFINE_BY_OPERATOR(RtFloat4, float4)
RT_DEFINE_BY_OPERATOR(RtDouble2, double2)
RT_DEFINE_BITS_BY_LANE(RtLong2, long2, 2)
#endif
#if RT_NEON
RT_INLINE uint32_t rt_bits_int4(RtInt4 mask) {
    return vaddvq_u32((uint32x4_t)((mask < 0) & (RtInt4){1, 2, 4, 8}));
}
RT_INLINE uint32_t rt_bits_int8(RtInt8 mask) {
    RtInt4 lower = (RtInt4)rt_lower4((RtFloat8)mask) < 0, upper = (RtInt4)rt_upper4((RtFloat8)mask) < 0;
    return vaddvq_u32((uint32x4_t)((lower & (RtInt4){1, 2, 4, 8}) | (upper & (RtInt4){16, 32, 64, 128})));
}
RT_DEFINE_OF_TWO(RtInt4, rt_min_int4, (RtInt4)vminq_s32((int32x4_t)a, (int32x4_t)b))
RT_DEFINE_OF_TWO(RtInt4, rt_max_int4, (RtInt4)vmaxq_s32((int32x4_t)a, (int32x4_t)b))
#elif !defined(__AVX2__)
RT_DEFINE_BY_OPERATOR(RtInt4, int4)
#if !defined(__SSE2__)
RT_DEFINE_BITS_BY_LANE(RtInt4, int4, 4)
#endif
RT_INLINE uint32_t rt_bits_int8(RtInt8 mask) {
    return rt_bits_int4((RtInt4)rt_lower4((RtFloat8)mask)) | rt_bits_int4((RtInt4)rt_upper4((RtFloat8)mask))
                                                                 << 4;
}
#endif

#if defined(__AVX2__)
RT_DEFINE_BY_REGISTER(8, 4, _mm256)
RT_DEFINE_INTS_BY_REGISTER(4, _mm, __m128i)
RT_DEFINE_INTS_BY_REGISTER(8, _mm256, __m256i)
RT_DEFINE_BITS_BY_REGISTER(8, 4, _mm256)
#else
/* f of both halves of a and b */
#define RT_HALVES(f, Result, Type, a, b)                                                                     \
    ((Result##8)rt_join4((RtFloat4)f((Type##4)rt_lower4((RtFloat8)(a)), (Type##4)rt_lower4((RtFloat8)(b))),  \
                         (RtFloat4)f((Type##4)rt_upper4((RtFloat8)(a)), (Type##4)rt_upper4((RtFloat8)(b)))))
#define RT_DEFINE_BY_HALVES(Type, type)                                                                      \
    RT_DEFINE_OF_TWO(Type##8, rt_min_##type##8, RT_HALVES(rt_min_##type##4, Type, Type, a, b))               \
    RT_DEFINE_OF_TWO(Type##8, rt_max_##type##8, RT_HALVES(rt_max_##type##4, Type, Type, a, b))
RT_DEFINE_BY_HALVES(RtFloat, float)
RT_DEFINE_BY_HALVES(RtInt, int)
#endif
#if RT_AVX512
RT_DEFINE_BY_REGISTER(16, 8, _mm512)
RT_DEFINE_INTS_BY_REGISTER(16, _mm512, __m512i)
RT_INLINE uint32_t rt_bits_int16(RtInt16 mask) {
    return _mm512_movepi32_mask((__m512i)mask);
}
#endif

/* ---- products less a number, rounded once ----
 *
 * rt_fused_less8(a, b, c): a * b - c, where RT_FUSES */

#if defined(__FMA__)
#define RT_FUSES 1
RT_INLINE RtFloat8 rt_fused_less8(RtFloat8 a, RtFloat8 b, RtFloat8 c) {
    return _mm256_fmsub_ps(a, b, c);
}
#else
#define RT_FUSES 0
RT_INLINE RtFloat8 rt_fused_less8(RtFloat8 a, RtFloat8 b, RtFloat8 c) {
    return a * b - c;
}
#endif

/* ---- square roots of doubles ---- */

#if defined(__SSE2__)
RT_DEFINE_OF_ONE(RtDouble2, rt_sqrt_double2, RtDouble2, _mm_sqrt_pd(a))
#elif RT_NEON
RT_DEFINE_OF_ONE(RtDouble2, rt_sqrt_double2, RtDouble2, vsqrtq_f64(a))
#else
RT_DEFINE_OF_ONE(RtDouble2, rt_sqrt_double2, RtDouble2, (RtDouble2){sqrt(a[0]), sqrt(a[1])})
#endif
#if defined(__AVX2__)
RT_DEFINE_OF_ONE(RtDouble4, rt_sqrt_double4, RtDouble4, _mm256_sqrt_pd(a))
#endif
#if RT_AVX512
RT_DEFINE_OF_ONE(RtDouble8, rt_sqrt_double8, RtDouble8, _mm512_sqrt_pd(a))
#endif

/* ---- comparisons to bits ---- */

/* rt_le_float8(a, b) and its kin: masks */
#define RT_DEFINE_COMPARISON(name, type, Type, sign, Sign, mask)                                             \
    RT_INLINE Sign rt_##name##_##type(Type a, Type b) {                                                      \
        return (Sign)(mask);                                                                                 \
    }                                                                                                        \
    RT_INLINE uint32_t rt_##name##_bits_##type(Type a, Type b) {                                             \
        return rt_bits_##sign(rt_##name##_##type(a, b));                                                     \
    }
#define RT_DEFINE_COMPARISONS(N)                                                                             \
    RT_DEFINE_COMPARISON(le, float##N, RtFloat##N, int##N, RtInt##N, a <= b)                                 \
    RT_DEFINE_COMPARISON(lt, float##N, RtFloat##N, int##N, RtInt##N, a < b)                                  \
    RT_DEFINE_COMPARISON(lt, int##N, RtInt##N, int##N, RtInt##N, a < b)                                      \
    RT_DEFINE_COMPARISON(eq, int##N, RtInt##N, int##N, RtInt##N, a == b)
#define RT_DEFINE_DOUBLE_COMPARISONS(N)                                                                      \
    RT_DEFINE_COMPARISON(le, double##N, RtDouble##N, long##N, RtLong##N, a <= b)
#define RT_DEFINE_COMPARISON_BY_HALVES(name, type, Type)                                                     \
    RT_DEFINE_COMPARISON(name, type##8, Type##8, int8, RtInt8,                                               \
                         RT_HALVES(rt_##name##_##type##4, RtInt, Type, a, b))
#define RT_DEFINE_MASK_COMPARISON(name, type, Type, intrinsic, Reg, predicate)                               \
    RT_INLINE uint32_t rt_##name##_bits_##type(Type a, Type b) {                                             \
        return intrinsic((Reg)a, (Reg)b, predicate);                                                         \
    }

RT_DEFINE_COMPARISONS(4)
RT_DEFINE_DOUBLE_COMPARISONS(2)
#if RT_AVX512
RT_DEFINE_MASK_COMPARISON(le, float8, RtFloat8, _mm256_cmp_ps_mask, __m256, _CMP_LE_OQ)
RT_DEFINE_MASK_COMPARISON(lt, float8, RtFloat8, _mm256_cmp_ps_mask, __m256, _CMP_LT_OQ)
RT_DEFINE_MASK_COMPARISON(lt, int8, RtInt8, _mm256_cmp_epi32_mask, __m256i, _MM_CMPINT_LT)
RT_DEFINE_MASK_COMPARISON(le, float16, RtFloat16, _mm512_cmp_ps_mask, __m512, _CMP_LE_OQ)
RT_DEFINE_MASK_COMPARISON(lt, float16, RtFloat16, _mm512_cmp_ps_mask, __m512, _CMP_LT_OQ)
RT_DEFINE_MASK_COMPARISON(lt, int16, RtInt16, _mm512_cmp_epi32_mask, __m512i, _MM_CMPINT_LT)
RT_DEFINE_MASK_COMPARISON(le, double8, RtDouble8, _mm512_cmp_pd_mask, __m512d, _CMP_LE_OQ)
#elif defined(__AVX2__)
RT_DEFINE_COMPARISONS(8)
#else
RT_DEFINE_COMPARISON_BY_HALVES(le, float, RtFloat)
RT_DEFINE_COMPARISON_BY_HALVES(lt, float, RtFloat)
RT_DEFINE_COMPARISON_BY_HALVES(lt, int, RtInt)
RT_DEFINE_COMPARISON_BY_HALVES(eq, int, RtInt)
#endif
#if defined(__AVX2__)
RT_DEFINE_DOUBLE_COMPARISONS(4)
#endif

/* rt_one_sign_bits(least, most), floats: bit i: numbers between the two are not of different signs.
 * rt_inside_bits(least, most, sum), doubles: and `sum` is not 0. */
#define RT_DEFINE_SIGNS(N, HALF)                                                                             \
    RT_INLINE uint32_t rt_one_sign_float##N(RtFloat##N least, RtFloat##N most) {                             \
        return rt_bits_int##N((least >= 0) | (most <= 0));                                                   \
    }                                                                                                        \
    RT_INLINE uint32_t rt_inside_double##HALF(RtDouble##HALF least, RtDouble##HALF most,                     \
                                              RtDouble##HALF sum) {                                          \
        return rt_bits_long##HALF(((least >= 0) | (most <= 0)) & (sum != 0));                                \
    }
RT_DEFINE_SIGNS(4, 2)
#if RT_AVX512
RT_INLINE uint32_t rt_one_sign_float8(RtFloat8 least, RtFloat8 most) {
    return rt_le_bits_float8((RtFloat8){0}, least) | rt_le_bits_float8(most, (RtFloat8){0});
}
RT_INLINE uint32_t rt_one_sign_float16(RtFloat16 least, RtFloat16 most) {
    return rt_le_bits_float16((RtFloat16){0}, least) | rt_le_bits_float16(most, (RtFloat16){0});
}
RT_INLINE uint32_t rt_inside_double4(RtDouble4 least, RtDouble4 most, RtDouble4 sum) {
    return rt_bits_long4(((least >= 0) | (most <= 0)) & (sum != 0));
}
RT_INLINE uint32_t rt_inside_double8(RtDouble8 least, RtDouble8 most, RtDouble8 sum) {
    const RtDouble8 zero = {0};
    uint32_t one_sign = rt_le_bits_double8(zero, least) | rt_le_bits_double8(most, zero);
    return one_sign & _mm512_cmp_pd_mask((__m512d)sum, (__m512d)zero, _CMP_NEQ_UQ);
}
#elif defined(__AVX2__)
RT_DEFINE_SIGNS(8, 4)
#else
RT_INLINE uint32_t rt_one_sign_float8(RtFloat8 least, RtFloat8 most) {
    const RtFloat8 zero = {0};
    return rt_bits_int8(rt_le_float8(zero, least) | rt_le_float8(most, zero));
}
#endif

/* ---- the width of the instruction set ---- */

#define RT_CONCATENATE(name, lanes) name##lanes
#define RT_OF_WIDTH(name, lanes)    RT_CONCATENATE(name, lanes)
#define RT_OF_LANES(name)           RT_OF_WIDTH(name, RT_LANES)
#define RT_OF_HALF(name)            RT_OF_WIDTH(name, RT_HALF)

typedef RT_OF_LANES(RtFloat) RtFloats;
typedef RT_OF_LANES(RtInt) RtInts;
typedef RT_OF_HALF(RtDouble) RtDoubles;

#define rt_all       RT_OF_LANES(rt_all)
#define rt_all_ints  RT_OF_LANES(rt_all_ints)
#define rt_load      RT_OF_LANES(rt_load)
#define rt_loadu     RT_OF_LANES(rt_loadu)
#define rt_load_ints RT_OF_LANES(rt_load_ints)

#if RT_AVX512
#define RT_BY_WIDTH(Type, f)        Type##4 : f##4, Type##8 : f##8, Type##16 : f##16
#define RT_BY_DOUBLE_WIDTH(Type, f) Type##4 : f##4, Type##8 : f##8
#elif RT_LANES == 8
#define RT_BY_WIDTH(Type, f)        Type##4 : f##4, Type##8 : f##8
#define RT_BY_DOUBLE_WIDTH(Type, f) Type##2 : f##2, Type##4 : f##4
#else
#define RT_BY_WIDTH(Type, f)        Type##4 : f##4, Type##8 : f##8
#define RT_BY_DOUBLE_WIDTH(Type, f) Type##2 : f##2
#endif
#define RT_BY_FLOATS(f)  RT_BY_WIDTH(RtFloat, f##_float)
#define RT_BY_INTS(f)    RT_BY_WIDTH(RtInt, f##_int)
#define RT_BY_DOUBLES(f) RT_BY_DOUBLE_WIDTH(RtDouble, f##_double)

#define rt_store(at, a) _Generic((a), RT_BY_FLOATS(rt_store), RT_BY_INTS(rt_store))(at, a)
#define rt_sqrt(a)      _Generic((a), RT_BY_DOUBLES(rt_sqrt))(a)
#define rt_abs(a)       _Generic((a), RT_BY_FLOATS(rt_abs), RT_BY_DOUBLES(rt_abs))(a)
#define rt_min(a, b)    _Generic((a), RT_BY_FLOATS(rt_min), RT_BY_INTS(rt_min), RT_BY_DOUBLES(rt_min))(a, b)
#define rt_max(a, b)    _Generic((a), RT_BY_FLOATS(rt_max), RT_BY_INTS(rt_max), RT_BY_DOUBLES(rt_max))(a, b)
#define rt_select(mask, a, b)                                                                                \
    _Generic((a), RT_BY_FLOATS(rt_select), RT_BY_INTS(rt_select), RT_BY_DOUBLES(rt_select))(mask, a, b)
#define rt_bits(mask)                    _Generic((mask), RT_BY_INTS(rt_bits))(mask)
#define rt_le_bits(a, b)                 _Generic((a), RT_BY_FLOATS(rt_le_bits), RT_BY_DOUBLES(rt_le_bits))(a, b)
#define rt_lt_bits(a, b)                 _Generic((a), RT_BY_FLOATS(rt_lt_bits), RT_BY_INTS(rt_lt_bits))(a, b)
#define rt_one_sign_bits(least, most)    _Generic((least), RT_BY_FLOATS(rt_one_sign))(least, most)
#define rt_inside_bits(least, most, sum) _Generic((least), RT_BY_DOUBLES(rt_inside))(least, most, sum)
#define rt_to_ints(a)                    __builtin_convertvector(a, RtInts) /* towards 0 */
#define rt_to_ints4(a)                   __builtin_convertvector(a, RtInt4)
#define rt_to_floats(a)                  __builtin_convertvector(a, RtFloats)

/* Lane i holds i. */
RT_INLINE RtInts rt_lane_numbers(void) {
#if RT_LANES == 16
    return (RtInts){0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};
#elif RT_LANES == 8
    return (RtInts){0, 1, 2, 3, 4, 5, 6, 7};
#else
    return (RtInts){0, 1, 2, 3};
#endif
}

/* ---- bits as masks ---- */

/* a in the lanes of the bits, else b. */
RT_INLINE RtInt8 rt_select_bits8(uint32_t bits, RtInt8 a, RtInt8 b) {
#if RT_AVX512
    return (RtInt8)_mm256_mask_mov_epi32((__m256i)b, (__mmask8)bits, (__m256i)a);
#else
    const RtInt8 lanes = {1, 2, 4, 8, 16, 32, 64, 128};
    return rt_select(rt_eq_int8(rt_all_ints8((int32_t)bits) & lanes, lanes), a, b);
#endif
}

/* ---- rounding, and doubles ---- */

#if RT_LANES > 4
RT_DEFINE_OF_ONE(RtFloats, rt_floor, RtFloats, RT_MM(floor_ps)(a))
RT_DEFINE_OF_ONE(RtFloats, rt_ceil, RtFloats, RT_MM(ceil_ps)(a))
#elif RT_NEON
RT_DEFINE_OF_ONE(RtFloats, rt_floor, RtFloats, vrndmq_f32(a))
RT_DEFINE_OF_ONE(RtFloats, rt_ceil, RtFloats, vrndpq_f32(a))
#else
RT_DEFINE_OF_ONE(RtFloats, rt_floor, RtFloats,
                 (RtFloats){floorf(a[0]), floorf(a[1]), floorf(a[2]), floorf(a[3])})
RT_DEFINE_OF_ONE(RtFloats, rt_ceil, RtFloats, (RtFloats){ceilf(a[0]), ceilf(a[1]), ceilf(a[2]), ceilf(a[3])})
#endif

/* Four floats as doubles, and four doubles rounded to floats. gcc 12 makes five instructions of a conversion
 * by __builtin_convertvector that changes the size of a vector. */
#if defined(__AVX2__)
RT_DEFINE_OF_ONE(RtDouble4, rt_widen4, RtFloat4, _mm256_cvtps_pd(a))
RT_DEFINE_OF_ONE(RtFloat4, rt_round4, RtDouble4, _mm256_cvtpd_ps(a))
#else
RT_DEFINE_OF_ONE(RtDouble4, rt_widen4, RtFloat4, __builtin_convertvector(a, RtDouble4))
RT_DEFINE_OF_ONE(RtFloat4, rt_round4, RtDouble4, __builtin_convertvector(a, RtFloat4))
#endif

/* The lower two of four floats as doubles. */
RT_INLINE RtDouble2 rt_widen_lower(RtFloat4 a) {
#if defined(__SSE2__)
    return _mm_cvtps_pd(a);
#elif RT_NEON
    return vcvt_f64_f32(vget_low_f32(a));
#else
    return (RtDouble2){(double)a[0], (double)a[1]};
#endif
}

/* The lower lanes, half 0, or the upper, half 1, as doubles; and floats of both, rounded. */
#if RT_AVX512
RT_INLINE RtDoubles rt_to_doubles(RtFloats a, int half) {
    return _mm512_cvtps_pd(half ? _mm512_extractf32x8_ps(a, 1) : _mm512_castps512_ps256(a));
}
RT_INLINE RtFloats rt_round_doubles(RtDoubles lower, RtDoubles upper) {
    return _mm512_insertf32x8(_mm512_castps256_ps512(_mm512_cvtpd_ps(lower)), _mm512_cvtpd_ps(upper), 1);
}
#elif RT_LANES == 8
RT_INLINE RtDoubles rt_to_doubles(RtFloats a, int half) {
    return _mm256_cvtps_pd(half ? rt_upper4(a) : rt_lower4(a));
}
RT_INLINE RtFloats rt_round_doubles(RtDoubles lower, RtDoubles upper) {
    return _mm256_set_m128(_mm256_cvtpd_ps(upper), _mm256_cvtpd_ps(lower));
}
#elif defined(__SSE2__)
RT_INLINE RtDoubles rt_to_doubles(RtFloats a, int half) {
    return _mm_cvtps_pd(half ? (RtFloats)_mm_movehl_ps(a, a) : a);
}
RT_INLINE RtFloats rt_round_doubles(RtDoubles lower, RtDoubles upper) {
    return _mm_movelh_ps(_mm_cvtpd_ps(lower), _mm_cvtpd_ps(upper));
}
#elif RT_NEON
RT_INLINE RtDoubles rt_to_doubles(RtFloats a, int half) {
    return half ? vcvt_high_f64_f32(a) : vcvt_f64_f32(vget_low_f32(a));
}
RT_INLINE RtFloats rt_round_doubles(RtDoubles lower, RtDoubles upper) {
    return vcvt_high_f32_f64(vcvt_f32_f64(lower), upper);
}
#else
RT_INLINE RtDoubles rt_to_doubles(RtFloats a, int half) {
    return (RtDoubles){(double)a[2 * half], (double)a[2 * half + 1]};
}
RT_INLINE RtFloats rt_round_doubles(RtDoubles lower, RtDoubles upper) {
    return (RtFloats){(float)lower[0], (float)lower[1], (float)upper[0], (float)upper[1]};
}
#endif

#endif
