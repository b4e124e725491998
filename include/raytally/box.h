/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Boxes, rays prepared for tests of boxes, and the one box test that exactness rests on. It is frozen: within
 * a major version these operations give the same bits.
 *
 * Why a traversal that uses it is exact. Hit functions compute in rounded arithmetic, so a ray may be said to
 * hit an object that it misses by a few ulps. A prepared ray is therefore thick: the planes of a box are
 * moved outward by a little, enough for every box within the scene's. What raytally calls a hit on an object
 * is brought into the interval in which the thick ray is within the object's own box. Crossings are monotone
 * in the planes, in float32 as in the real numbers. So for a box B that contains the box of an object,
 *
 *     enter(B) <= t <= leave(B), bit for bit, for every hit t on that object.
 *
 * A structure may skip a box only where raytally_box_hit says no, or where it enters beyond the best hit so
 * far: enter > t. Where enter == t there may lie another object at the same t with a lower number, which is
 * then the answer; so `>=` is wrong. No other tolerance is needed anywhere.
 *
 * Compile without -ffast-math and -ffinite-math-only: NaN and infinities are part of the test. */
#ifndef RAYTALLY_BOX_H
#define RAYTALLY_BOX_H

#include "raytally/types.h"

#include <stddef.h>
#include <string.h>

#if defined(__FAST_MATH__) || (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__)
#error "raytally's box test needs NaN and infinities: compile without -ffast-math and -ffinite-math-only"
#endif

#ifdef __cplusplus
extern "C" {
#endif

/** For functions that are to vanish into their callers. */
#define RAYTALLY_INLINE static inline __attribute__((always_inline))

/** An axis-aligned box, closed: its faces belong to it. That of an empty scene has lo = INFINITY and
 * hi = -INFINITY. */
typedef struct raytally_box {
    float lo[3]; /**< The least x, y, z. */
    float hi[3]; /**< The largest x, y, z. */
} raytally_box;

struct raytally_query;

/** A ray with what box tests need, computed once by raytally_prepare. Arrays are indexed by axis, x, y, z;
 * the fourth number of each is there for vectors and has no meaning. It may be copied. */
typedef struct raytally_prepared {
    float tmin;                   /**< As in the ray. */
    float tmax;                   /**< As in the ray, but finite: a hit at infinity is none. */
    float org[4];                 /**< Origin. */
    float dir[4];                 /**< Direction. */
    float inv[4];                 /**< 1 / dir, possibly infinite. */
    float org_near[4];            /**< The origin moved by the thickness, for planes crossed first ... */
    float org_far[4];             /**< ... and for those crossed last. */
    uint32_t negative[4];         /**< 1 where dir has its sign bit set, -0 included; else 0. */
    uint32_t first[4];            /**< Where in a box the sides are that it crosses first, in bytes ... */
    uint32_t last[4];             /**< ... and those that it crosses last. */
    const raytally_ray *ray;      /**< What it was made from; it must outlive it. */
    struct raytally_query *query; /**< That it was made for. */
    uint64_t own[40];             /**< raytally's own. */
} raytally_prepared;

/** A side of a box, so many bytes from its beginning (raytally_prepared.first). */
RAYTALLY_INLINE float raytally_box_side(const raytally_box *box, uint32_t place) {
    float at;
    memcpy(&at, (const char *)box + place, sizeof at);
    return at;
}

/** True if the thick ray meets the box for some t in [ray->tmin, tmax]; then *enter is where, at least tmin.
 * (The slab test of Kay & Kajiya 1986.) A NaN, of an origin on a plane that the ray runs along, is passed
 * over: such a ray counts as inside.
 * @param box    within the scene's box
 * @param ray    of raytally_prepare
 * @param tmax   raytally_limit: the best hit so far, or the ray's end
 * @param enter  set in any case */
RAYTALLY_INLINE int raytally_box_hit(const raytally_box *box, const raytally_prepared *ray, float tmax,
                                     float *enter) {
    float from = ray->tmin, to = tmax;
    for (int a = 0; a < 3; a++) {
        const float in = (raytally_box_side(box, ray->first[a]) - ray->org_near[a]) * ray->inv[a];
        const float out = (raytally_box_side(box, ray->last[a]) - ray->org_far[a]) * ray->inv[a];
        from = in > from ? in : from;
        to = out < to ? out : to;
    }
    *enter = from;
    return from <= to;
}

/** What a traversal compares boxes with: t of the best hit so far, or the ray's end while there is none. */
RAYTALLY_INLINE float raytally_limit(const raytally_prepared *ray, const raytally_hit *best) {
    return best->t < ray->tmax ? best->t : ray->tmax;
}

#ifdef __cplusplus
}
#endif

#endif
