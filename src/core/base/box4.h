/* SPDX-License-Identifier: Apache-2.0 */
/* Boxes as vectors of four float32, for builds, which mostly unite boxes and compare their areas.
 * The fourth lane may hold anything. Each operation returns, lane by lane, the bits of its namesake in
 * box.h. The vectors are those of gcc and clang on every processor, with SSE2 where there is no operator. */
#ifndef RT_BASE_BOX4_H
#define RT_BASE_BOX4_H

#include "core/base/box.h"
#include "core/base/simd.h"

#include <raytally/box.h>

#include <string.h>

typedef struct RtBox4 {
    RtFloat4 lo, hi;
} RtBox4;

/* The functions of the interface take boxes of its own type, which has the same layout, and load them
 * whatever their type. */
static inline const raytally_box *rt_public_box(const RtBox *box) {
    return (const raytally_box *)box;
}

/* The corners of a box. */
static inline RtFloat4 rt_box_lo4(const RtBox *box) {
    return raytally_box_lo4(rt_public_box(box));
}

static inline RtFloat4 rt_box_hi4(const RtBox *box) {
    return raytally_box_hi4(rt_public_box(box));
}

static inline RtBox4 rt_box4_empty(void) {
    return (RtBox4){rt_all4(INFINITY), rt_all4(-INFINITY)};
}

static inline RtBox4 rt_box4_load(const RtBox *box) {
    return (RtBox4){rt_box_lo4(box), rt_box_hi4(box)};
}

static inline void rt_box4_store(RtBox *box, RtBox4 b) {
    memcpy(box, &b.lo, sizeof b.lo);
    memcpy(&box->hi, &b.hi, sizeof box->hi);
}

static inline RtBox4 rt_box4_union(RtBox4 a, RtBox4 b) {
    return (RtBox4){rt_min(a.lo, b.lo), rt_max(a.hi, b.hi)};
}

static inline RtBox4 rt_box4_add_point(RtBox4 a, RtFloat4 p) {
    return (RtBox4){rt_min(a.lo, p), rt_max(a.hi, p)};
}

static inline RtFloat4 rt_box4_center(RtBox4 a) {
    return a.lo * rt_all4(0.5f) + a.hi * rt_all4(0.5f);
}

/* The half areas of two non-empty boxes. */
static inline RtDouble2 rt_box4_half_areas(RtBox4 a, RtBox4 b) {
    RtDouble2 a_xy = rt_widen_lower(a.hi) - rt_widen_lower(a.lo);
    RtDouble2 b_xy = rt_widen_lower(b.hi) - rt_widen_lower(b.lo);
    RtDouble2 z = rt_widen_lower(__builtin_shufflevector(a.hi, b.hi, 2, 6, 2, 6)) -
                  rt_widen_lower(__builtin_shufflevector(a.lo, b.lo, 2, 6, 2, 6));
    RtDouble2 x = __builtin_shufflevector(a_xy, b_xy, 0, 2), y = __builtin_shufflevector(a_xy, b_xy, 1, 3);
    return x * (y + z) + y * z;
}

#endif
