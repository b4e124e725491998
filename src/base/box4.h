/* SPDX-License-Identifier: Apache-2.0 */
/* Boxes in vectors of four float32, for builds, which do little else than unite boxes and compare their
 * areas. The fourth lane holds anything. Every operation gives, lane by lane, the bits of its namesake in
 * box.h; the vectors are those of gcc and clang on every processor, and SSE2 where there is no operator. */
#ifndef RT_BASE_BOX4_H
#define RT_BASE_BOX4_H

#include "base/box.h"

#include <stdint.h>
#include <string.h>

#ifdef __SSE2__
#include <emmintrin.h>
#endif

typedef float RtFloat4 __attribute__((vector_size(16)));
typedef int32_t RtInt4 __attribute__((vector_size(16)));
typedef double RtDouble2 __attribute__((vector_size(16)));

typedef struct RtBox4 {
    RtFloat4 lo, hi;
} RtBox4;

static inline RtFloat4 rt_float4(float x) {
    return (RtFloat4){x, x, x, x};
}

static inline RtFloat4 rt_min4(RtFloat4 a, RtFloat4 b) {
#ifdef __SSE2__
    return _mm_min_ps(a, b);
#else
    return (RtFloat4){rt_minf(a[0], b[0]), rt_minf(a[1], b[1]), rt_minf(a[2], b[2]), rt_minf(a[3], b[3])};
#endif
}

static inline RtFloat4 rt_max4(RtFloat4 a, RtFloat4 b) {
#ifdef __SSE2__
    return _mm_max_ps(a, b);
#else
    return (RtFloat4){rt_maxf(a[0], b[0]), rt_maxf(a[1], b[1]), rt_maxf(a[2], b[2]), rt_maxf(a[3], b[3])};
#endif
}

/* The integer parts. */
static inline RtInt4 rt_truncate4(RtFloat4 a) {
    return __builtin_convertvector(a, RtInt4);
}

/* Bit i is set where a[i] >= b[i]. */
static inline unsigned rt_at_least4(RtFloat4 a, RtFloat4 b) {
#ifdef __SSE2__
    return (unsigned)_mm_movemask_ps(_mm_cmpge_ps(a, b));
#else
    return (unsigned)(a[0] >= b[0]) | (unsigned)(a[1] >= b[1]) << 1 | (unsigned)(a[2] >= b[2]) << 2 |
           (unsigned)(a[3] >= b[3]) << 3;
#endif
}

static inline RtDouble2 rt_max2(RtDouble2 a, RtDouble2 b) {
#ifdef __SSE2__
    return _mm_max_pd(a, b);
#else
    return (RtDouble2){a[0] > b[0] ? a[0] : b[0], a[1] > b[1] ? a[1] : b[1]};
#endif
}

/* Whether a[i] <= b[i] for any i. */
static inline bool rt_any_at_most2(RtDouble2 a, RtDouble2 b) {
#ifdef __SSE2__
    return _mm_movemask_pd(_mm_cmple_pd(a, b)) != 0;
#else
    return a[0] <= b[0] || a[1] <= b[1];
#endif
}

static inline RtBox4 rt_box4_empty(void) {
    return (RtBox4){rt_float4(INFINITY), rt_float4(-INFINITY)};
}

static inline RtBox4 rt_box4_load(const RtBox *box) {
    RtBox4 b; /* lo.xyz hi.x; lo.z hi.xyz */
    memcpy(&b.lo, box, sizeof b.lo);
    memcpy(&b.hi, (const char *)box + 8, sizeof b.hi);
    b.hi = __builtin_shufflevector(b.hi, b.hi, 1, 2, 3, 3);
    return b;
}

static inline void rt_box4_store(RtBox *box, RtBox4 b) {
    memcpy(box, &b.lo, sizeof b.lo);
    memcpy(&box->hi, &b.hi, sizeof box->hi);
}

static inline RtBox4 rt_box4_union(RtBox4 a, RtBox4 b) {
    return (RtBox4){rt_min4(a.lo, b.lo), rt_max4(a.hi, b.hi)};
}

static inline RtBox4 rt_box4_add_point(RtBox4 a, RtFloat4 p) {
    return (RtBox4){rt_min4(a.lo, p), rt_max4(a.hi, p)};
}

static inline RtFloat4 rt_box4_center(RtBox4 a) {
    return a.lo * rt_float4(0.5f) + a.hi * rt_float4(0.5f);
}

/* The half areas of two boxes, neither of them empty. */
static inline RtDouble2 rt_box4_half_areas(RtBox4 a, RtBox4 b) {
#ifdef __SSE2__
    RtDouble2 a_xy = _mm_cvtps_pd(a.hi) - _mm_cvtps_pd(a.lo), b_xy = _mm_cvtps_pd(b.hi) - _mm_cvtps_pd(b.lo);
    RtDouble2 z = _mm_cvtps_pd(__builtin_shufflevector(a.hi, b.hi, 2, 6, 2, 6)) -
                  _mm_cvtps_pd(__builtin_shufflevector(a.lo, b.lo, 2, 6, 2, 6));
    RtDouble2 x = __builtin_shufflevector(a_xy, b_xy, 0, 2), y = __builtin_shufflevector(a_xy, b_xy, 1, 3);
    return x * (y + z) + y * z;
#else
    RtBox boxes[2];
    rt_box4_store(&boxes[0], a);
    rt_box4_store(&boxes[1], b);
    return (RtDouble2){rt_box_half_area(boxes[0]), rt_box_half_area(boxes[1])};
#endif
}

#endif
