/* SPDX-License-Identifier: Apache-2.0 */
/* Rays and points at the limits of float32, and a scalar version of the vector code in core/base/ray.h. */
#ifndef RT_TESTS_RAY_TESTING_H
#define RT_TESTS_RAY_TESTING_H

#include "core/base/ray.h"

#include "random_testing.h"

#include <string.h>

/* How large coordinates may be: as a rule RT_MAX_COORDINATE; or so little that thickness, too, is denormal.
 */
static inline float hostile_size(RtRandom *random) {
    return rt_random_below(random, 4) ? RT_MAX_COORDINATE : 0x1p-128f;
}

static inline float hostile_number(RtRandom *random, float most) {
    static const float numbers[] = {0,        -0.0f,     0x1p-149f, -0x1p-149f, 0x1p-126f,     -0x1.8p-130f,
                                    0x1p-70f, -0x1p-70f, 1,         -1,         0x1.000002p0f, 0x1.fffffep-1f,
                                    0x1p24f,  -0x1p24f,  0x1p59f,   -0x1p59f};
    enum { NUMBERS = sizeof numbers / sizeof numbers[0] };
    uint32_t pick = rt_random_below(random, NUMBERS + 16);
    if (pick >= NUMBERS + 2) return rt_minf(most, 1) * rt_random_between(random, -1, 1);
    float number = pick < NUMBERS ? numbers[pick] : pick == NUMBERS ? most : -most;
    return fabsf(number) <= most ? number : most;
}

static inline RtVec3 hostile_point(RtRandom *random, float size) {
    RtVec3 p;
    for (int a = 0; a < 3; a++) p.at[a] = hostile_number(random, size);
    return p;
}

static inline RtRay hostile_ray(RtRandom *random, float size) {
    RtRay ray = {.tmax = INFINITY};
    do {
        ray.org = hostile_point(random, size);
        for (int a = 0; a < 3; a++) ray.dir.at[a] = hostile_number(random, FLT_MAX);
        ray.tmin = rt_random_below(random, 4) ? 0 : fabsf(hostile_number(random, 1));
        ray.tmax = rt_random_below(random, 4) ? INFINITY : ray.tmin + fabsf(hostile_number(random, FLT_MAX));
    } while (!rt_ray_is_valid(&ray));
    return ray;
}

static inline RtBox hostile_box(RtRandom *random, float size) {
    RtBox box = rt_box_add_point(RT_EMPTY_BOX, hostile_point(random, size));
    return rt_random_below(random, 4) ? rt_box_add_point(box, hostile_point(random, size)) : box;
}

/* The same bits, or both no number. */
static inline bool same_bits(float a, float b) {
    return memcmp(&a, &b, sizeof a) == 0 || (isnan(a) && isnan(b));
}

/* By how much the planes along an axis move outward for a ray that is tested against what is in `around`. */
static inline float shift_by_hand(const RtRay *ray, const RtBox *around, int axis) {
    float most = 0;
    for (int a = 0; a < 3; a++) {
        float lo = fabsf(around->lo.at[a] - ray->org.at[a]), hi = fabsf(around->hi.at[a] - ray->org.at[a]);
        if (lo > most) most = lo;
        if (hi > most) most = hi;
    }
    return most * 0x1p-20f + fabsf(ray->org.at[axis]) * 0x1p-23f;
}

/* Where the ray is within a box that is as thick as it is itself: rt_box_own_span. */
static inline void own_span_by_hand(const RtBox *own, const RtRay *ray, float *near, float *far) {
    *near = -INFINITY, *far = INFINITY;
    for (int a = 0; a < 3; a++) {
        float org = ray->org.at[a], shift = shift_by_hand(ray, own, a), inv = 1 / ray->dir.at[a];
        bool backward = signbit(ray->dir.at[a]);
        float first = backward ? own->hi.at[a] - (org - shift) : own->lo.at[a] - (org + shift);
        float last = backward ? own->lo.at[a] - (org + shift) : own->hi.at[a] - (org - shift);
        first *= inv, last *= inv;
        if (first > *near) *near = first; /* NaN is passed over */
        if (last < *far) *far = last;
    }
}

#endif
