/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Boxes, prepared rays, and the one box test that exactness depends on, which raytally's own accelerators
 * use, too. It is frozen: within a major version these operations give the same bits (docs/interface.md).
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

#include <float.h>
#include <stddef.h>
#include <string.h>
#ifdef __SSE2__
#include <emmintrin.h>
#endif

#if defined(__FAST_MATH__) || (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__)
#error "raytally's box test needs NaN and infinities: compile without -ffast-math and -ffinite-math-only"
#endif

#ifdef __cplusplus
extern "C" {
#endif

/** For functions that must be inlined. */
#define RAYTALLY_INLINE static inline __attribute__((always_inline))

/** Keeps the compiler from fusing a product with a sum (-ffp-contract), which would give other bits. No
 * instruction. */
#if defined(__x86_64__) && (defined(__FMA__) || defined(__FMA4__))
#define RAYTALLY_ROUND(product) __asm__("" : "+x"(product))
#elif defined(__aarch64__)
#define RAYTALLY_ROUND(product) __asm__("" : "+w"(product))
#elif defined(__FP_FAST_FMA) || defined(__FP_FAST_FMAF)
#define RAYTALLY_ROUND(product) __asm__("" : "+m"(product))
#else
#define RAYTALLY_ROUND(product) ((void)0)
#endif

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
    void *crossings;              /**< Private to raytally. */
    int32_t kx;                   /**< The axis after kz, in a cycle. */
    int32_t ky;                   /**< The axis before kz. */
    int32_t kz;                   /**< The axis of the largest |dir|. */
    float shear_x;                /**< dir[kx] / dir[kz], by inv. */
    float shear_y;                /**< dir[ky] / dir[kz], by inv. */
} raytally_prepared;

/* ---- vectors ----
 *
 * Four lanes of gcc and clang, for the functions of this file and of hit.h. */

/** Four numbers. */
typedef float raytally_float4 __attribute__((vector_size(16)));
/** Four integers, or a mask: -1 where it holds, 0 where not. */
typedef int32_t raytally_int4 __attribute__((vector_size(16)));

/** Loads from anywhere. */
RAYTALLY_INLINE raytally_float4 raytally_load4(const void *at) {
    raytally_float4 lanes;
    memcpy(&lanes, at, sizeof lanes);
    return lanes;
}

/** a where the mask is -1, b where it is 0. */
RAYTALLY_INLINE raytally_float4 raytally_select4(raytally_int4 mask, raytally_float4 a, raytally_float4 b) {
    return (raytally_float4)((mask & (raytally_int4)a) | (~mask & (raytally_int4)b));
}

/** a < b ? a : b in each lane: b if one is NaN. */
RAYTALLY_INLINE raytally_float4 raytally_min4(raytally_float4 a, raytally_float4 b) {
#ifdef __SSE2__
    return _mm_min_ps(a, b);
#else
    return raytally_select4(a < b, a, b);
#endif
}

/** a > b ? a : b in each lane: b if one is NaN. */
RAYTALLY_INLINE raytally_float4 raytally_max4(raytally_float4 a, raytally_float4 b) {
#ifdef __SSE2__
    return _mm_max_ps(a, b);
#else
    return raytally_select4(a > b, a, b);
#endif
}

RAYTALLY_INLINE raytally_float4 raytally_abs4(raytally_float4 a) {
    return (raytally_float4)((raytally_int4)a & 0x7FFFFFFF);
}

/** A product that is not fused with a sum. */
RAYTALLY_INLINE raytally_float4 raytally_rounded4(raytally_float4 product) {
    RAYTALLY_ROUND(product);
    return product;
}

/* ---- boxes ---- */

/** The least coordinates of a box; the fourth lane may hold anything. */
RAYTALLY_INLINE raytally_float4 raytally_box_lo4(const raytally_box *box) {
    return raytally_load4(box);
}

/** The largest. */
RAYTALLY_INLINE raytally_float4 raytally_box_hi4(const raytally_box *box) {
    const raytally_float4 end = raytally_load4((const char *)box + sizeof *box - sizeof(raytally_float4));
    return __builtin_shufflevector(end, end, 1, 2, 3, 3);
}

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

/** The thickness of a ray for a box lo..hi: 2^-20 of the farthest coordinate from its origin. */
RAYTALLY_INLINE float raytally_thickness4(raytally_float4 lo, raytally_float4 hi, raytally_float4 org) {
    const raytally_float4 far = raytally_max4(raytally_abs4(lo - org), raytally_abs4(hi - org)); /* not NaN */
    const float most = far[1] > far[0] ? far[1] : far[0];
    return (far[2] > most ? far[2] : most) * 9.5367431640625e-07f;
}

/** How far an origin moves along each axis for a thickness: by 2^-23 |org| more, against the ray's direction,
 * whose sign bits are `sign`. */
RAYTALLY_INLINE raytally_float4 raytally_shift4(float thickness, raytally_float4 org, raytally_int4 sign) {
    const raytally_float4 shift = thickness + raytally_rounded4(raytally_abs4(org) * 1.1920928955078125e-07f);
    return (raytally_float4)((raytally_int4)shift ^ sign);
}

/** Moves an origin by the thickness for boxes inside `around`: raytally_prepared.org_near and org_far. */
RAYTALLY_INLINE void raytally_thicken(raytally_float4 org, raytally_float4 dir, const raytally_box *around,
                                      float near[4], float far[4]) {
    const float thickness = raytally_thickness4(raytally_box_lo4(around), raytally_box_hi4(around), org);
    const raytally_float4 shift = raytally_shift4(thickness, org, (raytally_int4)dir & INT32_MIN);
    const raytally_float4 ahead = org + shift, back = org - shift;
    memcpy(near, &ahead, sizeof ahead);
    memcpy(far, &back, sizeof back);
}

/** Prepares a ray for boxes inside `around`. Does not set `query` and `crossings`. */
RAYTALLY_INLINE void raytally_prepare_in(raytally_prepared *out, const raytally_ray *ray,
                                         const raytally_box *around) {
    /* The loads rely on the layout of raytally_ray: org, tmin, dir, tmax. */
    const raytally_float4 org = raytally_load4(ray->org), dir = raytally_load4(ray->dir), inv = 1.0f / dir;
    const raytally_int4 below = (raytally_int4)dir < 0, negative = below & 1;
    const raytally_int4 from_lo = {0, 4, 8, 8}, from_hi = {12, 16, 20, 20};
    const raytally_int4 first = from_lo + (below & 12), last = from_hi - (below & 12);
    out->tmin = org[3];
    out->tmax = dir[3] < FLT_MAX ? dir[3] : FLT_MAX;
    memcpy(out->org, &org, sizeof org);
    memcpy(out->dir, &dir, sizeof dir);
    memcpy(out->inv, &inv, sizeof inv);
    raytally_thicken(org, dir, around, out->org_near, out->org_far);
    memcpy(out->negative, &negative, sizeof negative);
    memcpy(out->first, &first, sizeof first);
    memcpy(out->last, &last, sizeof last);
    out->ray = ray;
    /* The lower axis wins a tie. Without branches, which could not be predicted. */
    const raytally_float4 size = raytally_abs4(dir);
    const int z = (size[2] > size[0]) & (size[2] > size[1]);
    out->kz = 2 * z | ((size[1] > size[0]) & !z);
    out->kx = 9 >> 2 * out->kz & 3;
    out->ky = 9 >> 2 * out->kx & 3;
    out->shear_x = out->dir[out->kx] * out->inv[out->kz];
    out->shear_y = out->dir[out->ky] * out->inv[out->kz];
}

#ifdef __cplusplus
}
#endif

#endif
