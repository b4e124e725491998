/* SPDX-License-Identifier: Apache-2.0 */
#ifndef RT_BASE_CLAMP_H
#define RT_BASE_CLAMP_H

/* `value`, or the end of lo..hi that it is beyond; a NaN stays. */
static inline double rt_clampd(double value, double lo, double hi) {
    return value < lo ? lo : value > hi ? hi : value;
}

#endif
