/* SPDX-License-Identifier: Apache-2.0 */
/* Where a plane cuts flat shapes, and what of the cut is to be seen. */
#ifndef RT_PICTURE_SECTION_H
#define RT_PICTURE_SECTION_H

#include "core/base/clamp.h"
#include "core/base/vec.h"

#include <stdbool.h>
#include <stdint.h>

/* Where the plane through `on` with the normal `normal` crosses the first two of the edges that it crosses,
 * of the closed line through corners[0..count): to cut[2]. False where there are no two. */
static inline bool rt_section_flat(const RtVec3 *corners, uint32_t count, RtVec3d on, RtVec3d normal,
                                   RtVec3d cut[2]) {
    int crossings = 0;
    for (uint32_t i = 0; i < count && crossings < 2; i++) {
        RtVec3d a = rt_widen(corners[i]), b = rt_widen(corners[(i + 1) % count]);
        double at_a = rt_dotd(rt_subd(a, on), normal), at_b = rt_dotd(rt_subd(b, on), normal);
        if ((at_a < 0) != (at_b < 0))
            cut[crossings++] = rt_add_scaledd(a, rt_subd(b, a), at_a / (at_a - at_b));
    }
    return crossings == 2;
}

/* Cuts the line from (a[0], a[1]) to (b[0], b[1]) to the rectangle lo..hi, sides included (Liang & Barsky
 * 1984): an end that is inside keeps its bits. False, and nothing is changed, where no part is inside. */
static inline bool rt_section_clip(double a[2], double b[2], const double lo[2], const double hi[2]) {
    double from = 0, to = 1, start[2] = {a[0], a[1]}, along[2] = {b[0] - a[0], b[1] - a[1]};
    for (int i = 0; i < 2; i++) {
        if (along[i] == 0) {
            if (a[i] < lo[i] || a[i] > hi[i]) return false;
            continue;
        }
        double at_lo = (lo[i] - a[i]) / along[i], at_hi = (hi[i] - a[i]) / along[i];
        from = fmax(from, fmin(at_lo, at_hi));
        to = fmin(to, fmax(at_lo, at_hi));
    }
    if (!(from <= to)) return false;
    for (int i = 0; i < 2; i++) { /* rounding may have left a cut a little outside */
        if (from > 0) a[i] = rt_clampd(start[i] + from * along[i], lo[i], hi[i]);
        if (to < 1) b[i] = rt_clampd(start[i] + to * along[i], lo[i], hi[i]);
    }
    return true;
}

#endif
