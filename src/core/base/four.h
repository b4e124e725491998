/* SPDX-License-Identifier: Apache-2.0 */
/* Four floats at once: x, y, z, and one that does not matter; or one of each vertex of a triangle. What is
 * done with them is done in each lane as with a float alone, to the bit. */
#ifndef RT_BASE_FOUR_H
#define RT_BASE_FOUR_H

#include "core/base/box.h"

#include <stdint.h>
#include <string.h>

#if defined(__SSE__)
#include <xmmintrin.h>
#endif

typedef float RtFour __attribute__((vector_size(16)));
typedef int32_t RtFourBits __attribute__((vector_size(16)));
typedef int64_t RtFourHalves __attribute__((vector_size(16)));

/* Four floats from `at` on, which need not be aligned. */
static inline RtFour rt_four(const void *at) {
    RtFour a;
    memcpy(&a, at, sizeof a);
    return a;
}

static inline RtFour rt_four_all(float a) {
    return (RtFour){a, a, a, a};
}

/* The corners of a box. */
static inline RtFour rt_four_lo(const RtBox *box) {
    return rt_four(box);
}

static inline RtFour rt_four_hi(const RtBox *box) {
    RtFour end = rt_four((const char *)box + sizeof *box - sizeof(RtFour));
    return __builtin_shufflevector(end, end, 1, 2, 3, 3);
}

static inline RtFour rt_four_abs(RtFour a) {
    return (RtFour)((RtFourBits)a & INT32_MAX);
}

/* The sign bits of `a`, all others 0. */
static inline RtFourBits rt_four_sign(RtFour a) {
    return (RtFourBits)a & INT32_MIN;
}

/* As rt_minf and rt_maxf. */
static inline RtFour rt_four_min(RtFour a, RtFour b) {
#if defined(__SSE__)
    return (RtFour)_mm_min_ps((__m128)a, (__m128)b);
#else
    return (RtFour){rt_minf(a[0], b[0]), rt_minf(a[1], b[1]), rt_minf(a[2], b[2]), rt_minf(a[3], b[3])};
#endif
}

static inline RtFour rt_four_max(RtFour a, RtFour b) {
#if defined(__SSE__)
    return (RtFour)_mm_max_ps((__m128)a, (__m128)b);
#else
    return (RtFour){rt_maxf(a[0], b[0]), rt_maxf(a[1], b[1]), rt_maxf(a[2], b[2]), rt_maxf(a[3], b[3])};
#endif
}

/* The integer parts. */
static inline RtFourBits rt_four_truncate(RtFour a) {
    return __builtin_convertvector(a, RtFourBits);
}

/* Bit i is set where a[i] >= b[i]. */
static inline unsigned rt_four_at_least(RtFour a, RtFour b) {
#if defined(__SSE__)
    return (unsigned)_mm_movemask_ps(_mm_cmpge_ps((__m128)a, (__m128)b));
#else
    return (unsigned)(a[0] >= b[0]) | (unsigned)(a[1] >= b[1]) << 1 | (unsigned)(a[2] >= b[2]) << 2 |
           (unsigned)(a[3] >= b[3]) << 3;
#endif
}

/* Lane k of row i becomes lane i of row k. */
static inline void rt_four_transpose(RtFour rows[4]) {
    RtFour a = __builtin_shufflevector(rows[0], rows[1], 0, 4, 1, 5);
    RtFour b = __builtin_shufflevector(rows[0], rows[1], 2, 6, 3, 7);
    RtFour c = __builtin_shufflevector(rows[2], rows[3], 0, 4, 1, 5);
    RtFour d = __builtin_shufflevector(rows[2], rows[3], 2, 6, 3, 7);
    rows[0] = __builtin_shufflevector(a, c, 0, 1, 4, 5);
    rows[1] = __builtin_shufflevector(a, c, 2, 3, 6, 7);
    rows[2] = __builtin_shufflevector(b, d, 0, 1, 4, 5);
    rows[3] = __builtin_shufflevector(b, d, 2, 3, 6, 7);
}

/* b where the sign bit of `sign` is set, else a. */
static inline RtFour rt_four_pick(RtFourBits sign, RtFour a, RtFour b) {
    RtFourBits mask = sign >> 31;
    return (RtFour)((mask & (RtFourBits)b) | (~mask & (RtFourBits)a));
}

/* Whether a comparison of x, y and z held in any of them. */
static inline bool rt_four_any(RtFourBits held) {
#if defined(__SSE__)
    return (_mm_movemask_ps((__m128)held) & 7) != 0;
#else
    RtFourHalves halves = (RtFourHalves)(held & (RtFourBits){-1, -1, -1, 0});
    return (halves[0] | halves[1]) != 0;
#endif
}

/* The largest of x, y and z, none of which is NaN. */
static inline float rt_four_most(RtFour a) {
    return rt_maxf(a[2], rt_maxf(a[1], a[0]));
}

#endif
