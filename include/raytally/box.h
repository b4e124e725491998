/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Boxes, prepared rays, and the one box test that exactness depends on. It is frozen: within a major version
 * these operations give the same bits (docs/interface.md).
 *
 * Why a traversal that uses it is exact. Hit functions compute in rounded arithmetic, so a ray may hit an
 * object that it misses by a few ulps. A prepared ray is therefore thick: it moves the planes of a box
 * outward by a little, enough for every box within the scene's. Every hit that raytally reports on an object
 * is clamped to the interval in which the thick ray is within the object's own box. Crossings are monotone in
 * the planes, in float32 as in real numbers. So for a box B that contains the box of an object,
 *
 *     enter(B) <= t <= leave(B), bit for bit, for every hit t on that object.
 *
 * A structure may skip a box only if raytally_box_hit returns 0, or if the ray enters it beyond the best hit
 * so far: enter > t. If enter == t, the box may hold another object at the same t with a lower number, which
 * is then the answer; so `>=` is wrong. No other tolerance is needed anywhere.
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

/** For functions that must be inlined. */
#define RAYTALLY_INLINE static inline __attribute__((always_inline))

/** An axis-aligned box, closed: its faces belong to it. The box of an empty scene has lo = INFINITY and
 * hi = -INFINITY. */
typedef struct raytally_box {
    float lo[3]; /**< The least x, y, z. */
    float hi[3]; /**< The largest x, y, z. */
} raytally_box;

struct raytally_query;

/** A ray with the values that box tests need, computed once by raytally_prepare. Arrays are indexed by axis
 * x, y, z; the fourth number of each is padding for vector loads. It may be copied. */
typedef struct raytally_prepared {
    float tmin;              /**< As in the ray. */
    float tmax;              /**< As in the ray, but finite: there are no hits at infinity. */
    float org[4];            /**< Origin. */
    float dir[4];            /**< Direction. */
    float inv[4];            /**< 1 / dir, possibly infinite. */
    float org_near[4];       /**< Origin moved by the thickness, for the planes that are crossed first ... */
    float org_far[4];        /**< ... and for those that are crossed last. */
    uint32_t negative[4];    /**< 1 if dir has its sign bit set, -0 included; else 0. */
    uint32_t first[4];       /**< Byte offset, in a raytally_box, of the side that is crossed first ... */
    uint32_t last[4];        /**< ... and of the side that is crossed last. */
    const raytally_ray *ray; /**< The original, which must outlive this. */
    struct raytally_query *query; /**< Its query. */
    uint64_t own[40];             /**< Private to raytally. */
} raytally_prepared;

/** The side of a box at a byte offset (raytally_prepared.first). */
RAYTALLY_INLINE float raytally_box_side(const raytally_box *box, uint32_t place) {
    float at;
    memcpy(&at, (const char *)box + place, sizeof at);
    return at;
}

/** Whether the thick ray intersects the box for some t in [ray->tmin, tmax]: the slab test of Kay & Kajiya
 * 1986. A ray whose origin lies on a plane that it is parallel to gives NaN there, and counts as inside.
 * @param box    within the scene's box
 * @param ray    from raytally_prepare
 * @param tmax   from raytally_tmax
 * @param enter  out: the t of entry, at least tmin; set in any case
 * @return 1 or 0 */
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

/** The end of the search: t of the best hit so far, or the ray's tmax if there is none. */
RAYTALLY_INLINE float raytally_tmax(const raytally_prepared *ray, const raytally_hit *best) {
    return best->t < ray->tmax ? best->t : ray->tmax;
}

#ifdef __cplusplus
}
#endif

#endif
