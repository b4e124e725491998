/* SPDX-License-Identifier: Apache-2.0 */
/* Shared by tests of shapes: rays, and their hits on an object. */
#ifndef RT_TESTS_SHAPE_TESTING_H
#define RT_TESTS_SHAPE_TESTING_H

#include "crossings_testing.h"
#include "testing.h"

#include "core/shape/geometry.h"

static inline bool hit(const RtGeometry *g, uint32_t id, const RtRay *ray, float *t) {
    RtPreparedRay prepared;
    rt_hit_ray(&prepared, g, ray, crossings_of_tests());
    return rt_object_hit(g, id, &prepared, t, NULL);
}

#endif
