/* SPDX-License-Identifier: Apache-2.0 */
/* Eight doubles, made of eight floats and rounded to them. */
#ifndef RT_ACCEL_SIMD_DOUBLES_H
#define RT_ACCEL_SIMD_DOUBLES_H

#include "accel/simd.h"

#if defined(__AVX512F__)
typedef __m512d RtD8;
#define RT_D8_PAIR(name)                                                                                     \
    static inline RtD8 rt_d8_##name(RtD8 a, RtD8 b) {                                                        \
        return _mm512_##name##_pd(a, b);                                                                     \
    }
static inline RtD8 rt_d8_all(double a) {
    return _mm512_set1_pd(a);
}
static inline RtD8 rt_d8_of(__m256 a) {
    return _mm512_cvtps_pd(a);
}
static inline __m256 rt_d8_narrow(RtD8 a) {
    return _mm512_cvtpd_ps(a);
}
static inline uint32_t rt_d8_at_most(RtD8 a, RtD8 b) {
    return _mm512_cmp_pd_mask(a, b, _CMP_LE_OQ);
}
static inline uint32_t rt_d8_differ(RtD8 a, RtD8 b) {
    return _mm512_cmp_pd_mask(a, b, _CMP_NEQ_OQ);
}
static inline RtD8 rt_d8_abs(RtD8 a) {
    return _mm512_abs_pd(a);
}
static inline RtD8 rt_d8_sign(RtD8 a, RtD8 sign) {
    return _mm512_or_pd(a, _mm512_and_pd(sign, _mm512_set1_pd(-0.0)));
}
#else
typedef struct RtD8 {
    __m256d lo, hi;
} RtD8;
#define RT_D8_PAIR(name)                                                                                     \
    static inline RtD8 rt_d8_##name(RtD8 a, RtD8 b) {                                                        \
        return (RtD8){_mm256_##name##_pd(a.lo, b.lo), _mm256_##name##_pd(a.hi, b.hi)};                       \
    }
static inline RtD8 rt_d8_all(double a) {
    return (RtD8){_mm256_set1_pd(a), _mm256_set1_pd(a)};
}
static inline RtD8 rt_d8_of(__m256 a) {
    return (RtD8){_mm256_cvtps_pd(_mm256_castps256_ps128(a)), _mm256_cvtps_pd(_mm256_extractf128_ps(a, 1))};
}
static inline __m256 rt_d8_narrow(RtD8 a) {
    return _mm256_set_m128(_mm256_cvtpd_ps(a.hi), _mm256_cvtpd_ps(a.lo));
}
/* Bit i: a[i] <= b[i]; and both are numbers and differ. */
static inline uint32_t rt_d8_at_most(RtD8 a, RtD8 b) {
    return (uint32_t)_mm256_movemask_pd(_mm256_cmp_pd(a.lo, b.lo, _CMP_LE_OQ)) |
           (uint32_t)_mm256_movemask_pd(_mm256_cmp_pd(a.hi, b.hi, _CMP_LE_OQ)) << 4;
}
static inline uint32_t rt_d8_differ(RtD8 a, RtD8 b) {
    return (uint32_t)_mm256_movemask_pd(_mm256_cmp_pd(a.lo, b.lo, _CMP_NEQ_OQ)) |
           (uint32_t)_mm256_movemask_pd(_mm256_cmp_pd(a.hi, b.hi, _CMP_NEQ_OQ)) << 4;
}
static inline RtD8 rt_d8_abs(RtD8 a) {
    const __m256d sign = _mm256_set1_pd(-0.0);
    return (RtD8){_mm256_andnot_pd(sign, a.lo), _mm256_andnot_pd(sign, a.hi)};
}
/* |a|, with the sign of another; a >= 0. */
static inline RtD8 rt_d8_sign(RtD8 a, RtD8 sign) {
    const __m256d bit = _mm256_set1_pd(-0.0);
    return (RtD8){_mm256_or_pd(a.lo, _mm256_and_pd(sign.lo, bit)),
                  _mm256_or_pd(a.hi, _mm256_and_pd(sign.hi, bit))};
}
#endif
/* Rounded to float32, to to[0..8), anywhere. */
static inline void rt_d8_put(float *to, RtD8 a) {
    _mm256_storeu_ps(to, rt_d8_narrow(a));
}
RT_D8_PAIR(add)
RT_D8_PAIR(sub)
RT_D8_PAIR(mul)
RT_D8_PAIR(div)
RT_D8_PAIR(min)
RT_D8_PAIR(max)
#undef RT_D8_PAIR

#endif
