/* SPDX-License-Identifier: Apache-2.0 */
/* What tests of accel/wide share: how it is made, for every instruction set that this machine has. */
#ifndef RT_TESTS_WIDE_TESTING_H
#define RT_TESTS_WIDE_TESTING_H

#include "slivers_testing.h"

#include "accel/wide/wide.h"

#include <stdio.h>

enum { BEST_SET, FIRST_SET };
static const char *const instruction_sets[] = {"best", "portable", "avx2", "avx512"};
enum { INSTRUCTION_SETS = sizeof instruction_sets / sizeof instruction_sets[0] };

/* "wide:isa=...,SETTINGS", built and valid; NULL if this machine or this build lacks the instruction set. */
static inline RtWide *make_wide(const RtScene *scene, int isa, const char *settings) {
    char spec[RT_MAX_SPEC_CHARS];
    RtError error = {RT_OK, ""};
    RtAccel *accel;
    snprintf(spec, sizeof spec, "wide:isa=%s%s%s", instruction_sets[isa], *settings ? "," : "", settings);
    RtStatus status = rt_accel_open(spec, scene, &accel, &error);
    if (status == RT_NOT_AVAILABLE) return NULL;
    if (status == RT_OK) status = rt_accel_validate(accel, &error);
    if (status != RT_OK) fail_msg("%s: %s", spec, error.message);
    return (RtWide *)accel;
}

#endif
