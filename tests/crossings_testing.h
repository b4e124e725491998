/* SPDX-License-Identifier: Apache-2.0 */
/* Scratch memory for tests that call hit functions directly, one thread at a time. */
#ifndef RT_TESTS_CROSSINGS_TESTING_H
#define RT_TESTS_CROSSINGS_TESTING_H

#include "core/shape/csg.h"

static inline RtCrossing *crossings_of_tests(void) {
    static RtCrossing crossings[1 << 16];
    return crossings;
}

#endif
