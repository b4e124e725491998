/* SPDX-License-Identifier: Apache-2.0 */
/* Boxes as vectors of four float32 (four.h), for builds, which mostly unite boxes and compare their areas.
 * The fourth lane may hold anything. Each operation returns, lane by lane, the bits of its namesake in
 * box.h. The vectors are those of gcc and clang on every processor, with SSE2 where there is no operator. */
#ifndef RT_BASE_BOX4_H
#define RT_BASE_BOX4_H

#include "core/base/four.h"

#ifdef __SSE2__
#include <emmintrin.h>
#endif

typedef double RtDouble2 __attribute__((vector_size(16)));

typedef struct RtBox4 {
    RtFour lo, hi;
} RtBox4;

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
    return (RtBox4){rt_four_all(INFINITY), rt_four_all(-INFINITY)};
}

static inline RtBox4 rt_box4_load(const RtBox *box) {
    return (RtBox4){rt_four_lo(box), rt_four_hi(box)};
}

static inline void rt_box4_store(RtBox *box, RtBox4 b) {
    memcpy(box, &b.lo, sizeof b.lo);
    memcpy(&box->hi, &b.hi, sizeof box->hi);
}

static inline RtBox4 rt_box4_union(RtBox4 a, RtBox4 b) {
    return (RtBox4){rt_four_min(a.lo, b.lo), rt_four_max(a.hi, b.hi)};
}

static inline RtBox4 rt_box4_add_point(RtBox4 a, RtFour p) {
    return (RtBox4){rt_four_min(a.lo, p), rt_four_max(a.hi, p)};
}

static inline RtFour rt_box4_center(RtBox4 a) {
    return a.lo * rt_four_all(0.5f) + a.hi * rt_four_all(0.5f);
}

/* The half areas of two non-empty boxes. */
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
