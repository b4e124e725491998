/* SPDX-License-Identifier: Apache-2.0 */
/* What tests of accel/wide share: how it is made, for every instruction set that this machine has. */
#ifndef RT_TESTS_WIDE_TESTING_H
#define RT_TESTS_WIDE_TESTING_H

#include "slivers_testing.h"

#include "accel/wide/wide.h"

enum { BEST_SET, FIRST_SET };
static const char *const instruction_sets[] = {"best", "portable", "avx2", "avx512"};
enum { INSTRUCTION_SETS = sizeof instruction_sets / sizeof instruction_sets[0] };

/* "wide:isa=...,SETTINGS", built and valid; NULL if this machine or this build lacks the instruction set. */
static inline RtWide *make_wide(const RtScene *scene, int isa, const char *settings) {
    char spec[RT_MAX_SPEC_CHARS];
    snprintf(spec, sizeof spec, "wide:isa=%s%s%s", instruction_sets[isa], *settings ? "," : "", settings);
    RtAccel *accel = open_available(scene, spec, 0);
    if (accel) assert_ok(rt_accel_validate(accel, error));
    return (RtWide *)accel;
}

#endif
