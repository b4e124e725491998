/* SPDX-License-Identifier: Apache-2.0 */
/* For tests that call hit functions directly: rays, and scratch memory for one thread at a time. */
#ifndef RT_TESTS_CROSSINGS_TESTING_H
#define RT_TESTS_CROSSINGS_TESTING_H

#include "core/shape/csg.h"

static inline RtCrossing *crossings_of_tests(void) {
    static RtCrossing crossings[1 << 16];
    return crossings;
}

static inline RtRay ray_along(RtVec3 org, RtVec3 dir) {
    return (RtRay){.org = org, .dir = dir, .tmax = INFINITY};
}

#endif
