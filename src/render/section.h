/* SPDX-License-Identifier: Apache-2.0 */
/* Where a plane cuts flat shapes. */
#ifndef RT_RENDER_SECTION_H
#define RT_RENDER_SECTION_H

#include "base/vec.h"

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

#endif
