/* SPDX-License-Identifier: Apache-2.0 */
/* Axis-aligned boxes in float32, the usual extent. A box is closed: its faces belong to it. The empty box has
 * lo = +inf, hi = -inf and is the neutral element of the union.
 *
 * Bounds computed in wider arithmetic are rounded outward (rt_float_below, rt_float_above), so a box
 * always contains its contents. */
#ifndef RT_BASE_BOX_H
#define RT_BASE_BOX_H

#include "core/base/vec.h"

typedef struct RtBox {
    RtVec3 lo, hi;
} RtBox;

#define RT_EMPTY_BOX ((RtBox){{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}})

/* a > b ? a : b skips a NaN in `a`: the slab test relies on it. */
static inline float rt_maxf(float a, float b) {
    return a > b ? a : b;
}

static inline float rt_minf(float a, float b) {
    return a < b ? a : b;
}

static inline RtVec3 rt_vec_min(RtVec3 a, RtVec3 b) {
    return (RtVec3){rt_minf(a.x, b.x), rt_minf(a.y, b.y), rt_minf(a.z, b.z)};
}

static inline RtVec3 rt_vec_max(RtVec3 a, RtVec3 b) {
    return (RtVec3){rt_maxf(a.x, b.x), rt_maxf(a.y, b.y), rt_maxf(a.z, b.z)};
}

/* The largest float32 not above x; the smallest not below x. */
static inline float rt_float_below(double x) {
    float f = (float)x;
    return (double)f > x ? nextafterf(f, -INFINITY) : f;
}

static inline float rt_float_above(double x) {
    float f = (float)x;
    return (double)f < x ? nextafterf(f, INFINITY) : f;
}

static inline RtBox rt_box_union(RtBox a, RtBox b) {
    return (RtBox){rt_vec_min(a.lo, b.lo), rt_vec_max(a.hi, b.hi)};
}

static inline RtBox rt_box_add_point(RtBox a, RtVec3 p) {
    return (RtBox){rt_vec_min(a.lo, p), rt_vec_max(a.hi, p)};
}

/* The intersection of two boxes; if that is empty, the result is an empty box but not always RT_EMPTY_BOX. */
static inline RtBox rt_box_common(RtBox a, RtBox b) {
    return (RtBox){rt_vec_max(a.lo, b.lo), rt_vec_min(a.hi, b.hi)};
}

static inline bool rt_box_is_empty(RtBox a) {
    return !(a.lo.x <= a.hi.x && a.lo.y <= a.hi.y && a.lo.z <= a.hi.z);
}

/* Every point of `inner` is in `outer`. */
static inline bool rt_box_contains(RtBox outer, RtBox inner) {
    return outer.lo.x <= inner.lo.x && outer.lo.y <= inner.lo.y && outer.lo.z <= inner.lo.z &&
           outer.hi.x >= inner.hi.x && outer.hi.y >= inner.hi.y && outer.hi.z >= inner.hi.z;
}

static inline bool rt_box_equals(RtBox a, RtBox b) {
    return rt_box_contains(a, b) && rt_box_contains(b, a);
}

static inline RtVec3 rt_box_size(RtBox a) {
    return rt_sub(a.hi, a.lo);
}

/* Halved before the sum, so that the centre of a huge box does not overflow. */
static inline RtVec3 rt_box_center(RtBox a) {
    return rt_add(rt_scale(a.lo, 0.5f), rt_scale(a.hi, 0.5f));
}

/* Widens a box by `part` of its width along each axis, equally at both ends. */
static inline RtBox rt_box_widened(RtBox a, double part) {
    for (int i = 0; i < 3; i++) {
        double lo = (double)a.lo.at[i], hi = (double)a.hi.at[i];
        double grow = part * (hi - lo) / 2;
        a.lo.at[i] = rt_float_below(lo - grow);
        a.hi.at[i] = rt_float_above(hi + grow);
    }
    return a;
}

/* Half the surface area, in double because float32 would under- or overflow; 0 for the empty box. */
static inline double rt_box_half_area(RtBox a) {
    if (rt_box_is_empty(a)) return 0;
    RtVec3d s = rt_subd(rt_widen(a.hi), rt_widen(a.lo));
    return s.x * (s.y + s.z) + s.y * s.z;
}

/* The longest side, and the largest magnitude of a coordinate; undefined for the empty box. */
static inline double rt_box_longest_side(RtBox a) {
    RtVec3d s = rt_subd(rt_widen(a.hi), rt_widen(a.lo));
    return fmax(s.x, fmax(s.y, s.z));
}

static inline double rt_box_largest_coordinate(RtBox a) {
    double largest = 0;
    for (int i = 0; i < 3; i++)
        largest = fmax(largest, fmax(fabs((double)a.lo.at[i]), fabs((double)a.hi.at[i])));
    return largest;
}

#endif
