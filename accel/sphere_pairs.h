/* SPDX-License-Identifier: Apache-2.0 */
/* Pairs of a ray and a sphere, of many rays and lists: raytally_sphere_hit (raytally/hit.h) of four at once,
 * by the same operations in double.
 *
 * A hit at a sure t (defined below) needs no rt_box_admit: if tmin <= t <= tmax, the result is the same, for
 * the reason given in wide/ray.h. The proof there needs a point P of the box near t dir: |t d_x - P_x|
 * <= 7 e D for each axis x, and 2 e D along the longest. Let s be the root in double of which t is the
 * rounding. Then 1.1 e D is enough, because org + s dir is within 2^-29 D of the ball, and t = s within e.
 *
 * 1. Let o be org from the centre, so |o| and the radius r are at most sqrt(3) D. The computed l is within
 * 2^-48 D of the true one. So l and half_chord_squared = h^2 are, exactly, those of a ball that differs from
 * the sphere by less than 2^-47 D, in its centre and its radius.
 * 2. In the root q / dd, q is a sum of numbers of one sign: it is within 2^-47 D of an end of that chord.
 * 3. In the root c / q, c is within 2^-44 D^2 of that ball's. So the root is off by at most w = 2^-44 D^2 /
 * (b + h), where b = |od| / |dir|. If r <= |o| / 2, then b >= 0.8 |o| >= D / 2, so w < 2^-42 D. If not, D <=
 * 3 r, and a step of w along the ray leaves the ball by at most (2 h w + w^2) / 2r. Here h w <= 2^-44 D^2,
 * and h >= 2^-27 r, as the square root of a difference of doubles below r^2 that is not 0, so w < 2^-15 D:
 * together less than 2^-29 D. */
#ifndef RT_ACCEL_SPHERE_PAIRS_H
#define RT_ACCEL_SPHERE_PAIRS_H

#include "accel/clipping.h"
#include "accel/kernel.h"
#include "accel/watertight.h"
#include "core/base/simd_across.h"

enum { PAIRS = 4 }; /* that are tested at once */

typedef struct SpherePair {
    const RtRay *ray;
    const RtSphere *sphere;
    uint32_t id; /* of the sphere */
} SpherePair;

/* The t of rt_sphere_hit, or NaN. */
static __attribute__((noinline, cold)) float hit_unsure_pair(const RtGeometry *g, const SpherePair *pair) {
    RtPreparedRay ray;
    float t;
    rt_hit_ray(&ray, g, pair->ray, NULL);
    return rt_sphere_hit(pair->sphere, &g->boxes[pair->id], &ray, &t) ? t : NAN;
}

/* Four doubles, in parts. */
#if RT_LANES == 4
typedef RtDouble2 Doubles;
#define PART rt_to_doubles
#define JOIN RT_ROUND_HALVES
#else
typedef RtDouble4 Doubles;
#define PART RT_FOUR_DOUBLES
#define JOIN RT_ROUND_FOUR
#endif
enum { PART_PAIRS = sizeof(Doubles) / sizeof(double), PARTS = PAIRS / PART_PAIRS };

/* The variables of raytally_sphere_roots. */
typedef struct Chords {
    Doubles dd[PARTS], od[PARTS], c[PARTS], half_chord_squared[PARTS];
    uint32_t met; /* bit i: the line of ray i meets its sphere */
} Chords;

RT_KERNEL Doubles dot(const Doubles a[3], const Doubles b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* ball: centre and radius. */
RT_KERNEL void find_chords(const RtFloat4 org[3], const RtFloat4 dir[3], const RtFloat4 ball[4],
                           Chords *out) {
    out->met = 0;
    for (int part = 0; part < PARTS; part++) {
        Doubles o[3], d[3], l[3], radius = PART(ball[3], part);
        for (int a = 0; a < 3; a++) {
            o[a] = PART(org[a], part) - PART(ball[a], part);
            d[a] = PART(dir[a], part);
        }
        Doubles dd = dot(d, d), od = dot(o, d), closest = -od / dd;
        for (int a = 0; a < 3; a++) l[a] = o[a] + d[a] * closest;
        out->dd[part] = dd;
        out->od[part] = od;
        out->c[part] = dot(o, o) - radius * radius;
        out->half_chord_squared[part] = radius * radius - dot(l, l);
        out->met |= rt_le_bits((Doubles){0}, out->half_chord_squared[part]) << part * PART_PAIRS;
    }
}

/* raytally_quadratic_roots; NaN where half_chord_squared < 0. */
RT_KERNEL void find_roots(const Chords *chords, RtFloat4 *first, RtFloat4 *second) {
    Doubles lesser[PARTS], greater[PARTS];
    for (int part = 0; part < PARTS; part++) {
        Doubles dd = chords->dd[part], od = chords->od[part];
        Doubles discriminant = chords->half_chord_squared[part] * dd, root = rt_sqrt(discriminant);
        Doubles q = rt_select(od > 0, -(od + root), root - od), x = q / dd;
        Doubles y = rt_select(discriminant > 0, chords->c[part] / q, x);
        lesser[part] = rt_select(x < y, x, y);
        greater[part] = rt_select(x < y, y, x);
    }
    *first = JOIN(lesser);
    *second = JOIN(greater);
}

/* The same of each; t is sure if |t dir| >= 2^-60 along the longest axis, unless dir is extreme. */
RT_KERNEL void hit_four_pairs(const RtGeometry *g, const SpherePair pairs[PAIRS], float t[PAIRS]) {
    RtFloat4 org[PAIRS], dir[PAIRS], ball[PAIRS], first, second; /* org[3], dir[3]: tmin, tmax */
    Chords chords;
    for (int i = 0; i < PAIRS; i++) {
        org[i] = rt_loadu4(pairs[i].ray);
        dir[i] = rt_loadu4((const char *)pairs[i].ray + offsetof(RtRay, dir));
        ball[i] = rt_loadu4(pairs[i].sphere);
    }
    rt_transpose4(org);
    rt_transpose4(dir);
    rt_transpose4(ball);
    find_chords(org, dir, ball, &chords);
    if (chords.met == 0) {
        rt_store(t, rt_all4(NAN));
        return;
    }
    find_roots(&chords, &first, &second);
    const RtFloat4 longest = rt_max(rt_max(rt_abs(dir[0]), rt_abs(dir[1])), rt_abs(dir[2]));
    const RtFloat4 tmin = org[3], tmax = rt_min(dir[3], rt_all4(FLT_MAX));
    const RtInt4 usual = (longest >= RT_ORDINARY_LEAST_DIR) & (longest <= RT_ORDINARY_MOST_DIR);
    const RtInt4 first_sure = usual & (rt_abs(first) * longest >= 0x1p-60f);
    const RtInt4 both_sure = first_sure & (rt_abs(second) * longest >= 0x1p-60f);
    const RtInt4 first_hit = first_sure & (first >= tmin) & (first <= tmax);
    const RtInt4 second_hit = both_sure & (second >= tmin) & (second <= tmax);
    rt_store(t, rt_select(first_hit, first, rt_select(second_hit, second, rt_all4(NAN))));
    for (uint32_t unsure = chords.met & ~rt_bits(first_hit | both_sure); unsure; unsure &= unsure - 1) {
        int i = __builtin_ctz(unsure);
        t[i] = hit_unsure_pair(g, &pairs[i]);
    }
}

/* The same of `count` pairs. Both arrays have room for `count` rounded up to PAIRS. */
static __attribute__((noinline)) void hit_sphere_pairs(const RtGeometry *g, SpherePair *pairs, uint32_t count,
                                                       float *t) {
    for (uint32_t i = count; i % PAIRS; i++) pairs[i] = pairs[0];
    for (uint32_t i = 0; i < count; i += PAIRS) hit_four_pairs(g, &pairs[i], &t[i]);
}

#endif
