/* SPDX-License-Identifier: Apache-2.0 */
/* Rays, hits, and the one box test on which all pruning rests.
 *
 * A ray is org + t * dir for tmin <= t <= tmax; dir need not have length 1, so t is in multiples of |dir|.
 * Each ray is prepared once (rt_ray_prepare): reciprocals, signs, and a thickness.
 *
 * Thickness. Hit functions compute in rounded arithmetic, so they may report a hit on an object that the
 * exact ray misses by a few ulps of the distance. A conservative box test must be wider than that. It moves
 * the planes of the box outward by
 *
 *     thickness(ray, B) = 2^-20 * max over axes of max(|B.lo - org|, |B.hi - org|)          (16 half-ulps)
 *
 * at no cost, by using one origin for near planes and another for far planes (Woop, Benthin & Wald 2013,
 * "Watertight Ray/Triangle Intersection", section 3.4). The origin moves along each axis by a further 2^-23
 * |org| (raytally_shift4), since otherwise rounding would swallow the thickness far from the coordinate
 * origin.
 *
 * Why pruning is exact. The crossings (plane - org') * inv are monotone in the plane, in float32 as in the
 * real numbers, and the thickness grows with the box. So for b inside B, with the thickness of B or of
 * anything larger:
 *
 *     enter(B) <= enter(b)  and  leave(b) <= leave(B),  bit for bit.
 *
 * rt_box_admit makes enter(b) <= t <= leave(b) part of the definition of a hit on an object with box b. A
 * structure that skips B only if enter(B) > leave(B), or enter(B) > t of the best hit, therefore never
 * skips the answer, however the hit function rounds. No other epsilon is needed anywhere. */
#ifndef RT_BASE_RAY_H
#define RT_BASE_RAY_H

#include "core/base/box4.h"
#include "core/base/status.h"

#include <raytally/hit.h>

#include <float.h>
#include <stddef.h>
#include <stdint.h>

/* X(CONSTANT, name, meaning) */
#define RT_RAY_KINDS(X)                                                                                      \
    X(PRIMARY, primary, "from the eye through a sample of the image")                                        \
    X(SHADOW, shadow, "from a surface to a light; answered by `occluded`")                                   \
    X(REFLECTION, reflection, "mirrored at a reflective surface")                                            \
    X(TRANSMISSION, transmission, "refracted through a transparent surface")                                 \
    X(DIFFUSE, diffuse, "from a surface, cosine-distributed about the normal")                               \
    X(RANDOM, random, "a random chord of the scene's bounding sphere")                                       \
    X(OCCLUSION, occlusion, "a diffuse ray, traced for any hit; answered by `occluded`")

typedef enum RtRayKind {
#define RT_RAY_KIND_ENUM(CONSTANT, name, meaning) RT_RAY_##CONSTANT,
    RT_RAY_KINDS(RT_RAY_KIND_ENUM)
#undef RT_RAY_KIND_ENUM
        RT_RAY_KIND_COUNT
} RtRayKind;

/* Rays that test for any hit instead of the nearest: `occluded` answers them. */
static inline bool rt_ray_kind_is_any_hit(RtRayKind kind) {
    return kind == RT_RAY_SHADOW || kind == RT_RAY_OCCLUSION;
}

/* Ray kinds that rendering a frame traces. */
static inline bool rt_ray_kind_is_of_frame(RtRayKind kind) {
    return kind == RT_RAY_PRIMARY || kind == RT_RAY_SHADOW || kind == RT_RAY_REFLECTION ||
           kind == RT_RAY_TRANSMISSION;
}

/* "primary", ...; and the kind with that name, or RT_BAD_INPUT with the list of names. */
const char *rt_ray_kind_name(RtRayKind kind);
RtStatus rt_ray_kind_parse(const char *name, RtRayKind *kind, RtError *error);

/* Invariants (rt_ray_is_valid): org and dir finite, |org| <= RT_MAX_COORDINATE, dir not zero,
 * 0 <= tmin <= tmax, tmin finite, tmax possibly infinite. Of short directions: raytally/types.h. */
typedef struct RtRay {
    RtVec3 org;
    float tmin;
    RtVec3 dir;
    float tmax;
    uint32_t kind;   /* RtRayKind */
    uint32_t source; /* shadow: index of the light; primary, diffuse, occlusion: of the sample in the frame */
} RtRay;

/* "org (0, 0, 5) dir (0, 0, -1) t in [0, inf]", with nine digits, which read back to the same bits. */
#define RT_RAY_TEXT 192
void rt_ray_format(const RtRay *ray, char *out, size_t size);

#define RT_NO_OBJECT UINT32_MAX

/* The nearest hit: the least (t, object) in that order. A miss is {INFINITY, RT_NO_OBJECT}. */
typedef struct RtHit {
    float t;
    uint32_t object;
} RtHit;

#define RT_MISS ((RtHit){INFINITY, RT_NO_OBJECT})

/* Largest coordinate of scenes and ray origins (about 2^59): products of four of them are finite in
 * double, and Embree, which drops anything above 1.8e18, sees all that we see. */
#define RT_MAX_COORDINATE 5e17f

struct RtHitMemory;

/* A ray with everything that box and hit tests need, computed once. It is that of the plugin interface, so
 * that plugins test boxes and objects by the same code. `crossings` is the memory of hit functions, an
 * RtHitMemory; NULL: for box tests only. */
typedef raytally_prepared RtPreparedRay;

static inline bool rt_ray_is_valid(const RtRay *ray) {
    return rt_finite(ray->org) && rt_finite(ray->dir) && fabsf(ray->org.x) <= RT_MAX_COORDINATE &&
           fabsf(ray->org.y) <= RT_MAX_COORDINATE && fabsf(ray->org.z) <= RT_MAX_COORDINATE &&
           (ray->dir.x != 0 || ray->dir.y != 0 || ray->dir.z != 0) && ray->tmin >= 0 && isfinite(ray->tmin) &&
           ray->tmin <= ray->tmax;
}

/* org + t * dir, in double. */
static inline RtVec3d rt_ray_point(const RtRay *ray, float t) {
    return rt_add_scaledd(rt_widen(ray->org), rt_widen(ray->dir), (double)t);
}

/* True if (t, object) precedes `best` in the order that defines the nearest hit. */
static inline bool rt_hit_before(float t, uint32_t object, RtHit best) {
    return t < best.t || (t == best.t && object < best.object);
}

static inline float rt_thickness(RtVec3 org, const RtBox *box) {
    return raytally_thickness4(rt_box_lo4(box), rt_box_hi4(box), (RtFloat4){org.x, org.y, org.z, org.z});
}

/* Sets the thickness for boxes inside `around`. */
static inline void rt_ray_thicken(RtPreparedRay *ray, const RtBox *around) {
    raytally_thicken(rt_loadu4(ray->org), rt_loadu4(ray->dir), rt_public_box(around), ray->org_near,
                     ray->org_far);
}

/* Prepares *p. `scene_box` must contain every box that the ray will be tested against; it sets the
 * thickness. `hit_memory` is for hit functions; NULL if none will be called (rt_hit_ray in
 * core/shape/geometry.h). */
static inline void rt_ray_prepare_in(RtPreparedRay *p, const RtRay *ray, const RtBox *scene_box,
                                     struct RtHitMemory *hit_memory) {
    raytally_prepare_in(p, (const raytally_ray *)ray, rt_public_box(scene_box));
    p->crossings = hit_memory;
}

/* The same for box tests only. */
static inline RtPreparedRay rt_ray_prepare(const RtRay *ray, const RtBox *scene_box) {
    RtPreparedRay p;
    rt_ray_prepare_in(&p, ray, scene_box, NULL);
    return p;
}

/* The side of a box at a byte offset. The side that a ray crosses first is looked up instead of branched
 * on: with rays in all directions that branch would be unpredictable. */
static inline float rt_box_side(const RtBox *box, uint32_t place) {
    return raytally_box_side(rt_public_box(box), place);
}

/* The slab test (Kay & Kajiya 1986): clips [*near, *far] to the interval in which the thick ray is within
 * the box, empty if *near > *far. If a component of dir is 0, inv is infinite and the crossings are -inf
 * or +inf, or NaN for an origin exactly on a moved plane. NaN is skipped, so such a ray counts as inside. */
static inline void rt_box_cut(const RtBox *box, const RtPreparedRay *ray, float *near, float *far) {
    for (int a = 0; a < 3; a++) {
        float first = (rt_box_side(box, ray->first[a]) - ray->org_near[a]) * ray->inv[a];
        float second = (rt_box_side(box, ray->last[a]) - ray->org_far[a]) * ray->inv[a];
        *near = rt_maxf(first, *near);
        *far = rt_minf(second, *far);
    }
}

/* True if the thick ray meets the box for some t in [ray->tmin, tmax]; *enter is the first such t. */
static inline bool rt_box_hit(const RtBox *box, const RtPreparedRay *ray, float tmax, float *enter) {
    return raytally_box_hit(rt_public_box(box), ray, tmax, enter);
}

/* raytally_own_span4 and raytally_admit4 (hit.h) for a box in memory. */
static inline void rt_box_own_span(const RtBox *own, const RtPreparedRay *ray, float *near, float *far) {
    raytally_own_span4(rt_box_lo4(own), rt_box_hi4(own), ray, near, far);
}

static inline bool rt_box_admit(const RtBox *own, const RtPreparedRay *ray, float *t) {
    return raytally_admit4(rt_box_lo4(own), rt_box_hi4(own), ray, t);
}

#endif
