/* SPDX-License-Identifier: Apache-2.0 */
/* Random points for tests. */
#ifndef RT_TESTS_RANDOM_TESTING_H
#define RT_TESTS_RANDOM_TESTING_H

#include "core/base/random.h"

/* Uniform in the cube of points with coordinates in [-size, size). */
static inline RtVec3 rt_random_point(RtRandom *random, float size) {
    RtVec3 p;
    for (int a = 0; a < 3; a++) p.at[a] = rt_random_between(random, -size, size);
    return p;
}

#endif
