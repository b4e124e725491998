/* SPDX-License-Identifier: Apache-2.0 */
/* What tests of accel/extents share: a spec for each kind of extent, and boxes without lanes. */
#ifndef RT_TESTS_EXTENTS_TESTING_H
#define RT_TESTS_EXTENTS_TESTING_H

#include "accel_testing.h"

static const char *const specs[] = {"extents:kind=box",           "extents:kind=box,lanes=1",
                                    "extents:kind=sphere",        "extents:kind=obb",
                                    "extents:kind=slabs,slabs=3", "extents:kind=slabs,slabs=7",
                                    "extents:kind=slabs,slabs=13"};
enum { SPEC_COUNT = sizeof specs / sizeof specs[0] };

#endif
