/* SPDX-License-Identifier: Apache-2.0 */
#include "core/base/simd_across.h"

/* Lanes i, i + 1, ... of the bits, given those from i + 1 on. */
#define LANE(later, bits, i) ((uint64_t)(later) << 8 * ((bits) >> (i)&1) | (uint64_t)(i) * ((bits) >> (i)&1))
#define LANES_4(bits)        LANE(LANE(LANE(LANE(0, bits, 7), bits, 6), bits, 5), bits, 4)
#define LANES(bits)          LANE(LANE(LANE(LANE(LANES_4(bits), bits, 3), bits, 2), bits, 1), bits, 0)
#define FOUR(bits)           LANES(bits), LANES((bits) + 1), LANES((bits) + 2), LANES((bits) + 3)
#define SIXTEEN(bits)        FOUR(bits), FOUR((bits) + 4), FOUR((bits) + 8), FOUR((bits) + 12)
#define MANY(bits)           SIXTEEN(bits), SIXTEEN((bits) + 16), SIXTEEN((bits) + 32), SIXTEEN((bits) + 48)

const uint64_t rt_lanes_of_bits[256] = {MANY(0), MANY(64), MANY(128), MANY(192)};
