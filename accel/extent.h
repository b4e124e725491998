/* SPDX-License-Identifier: Apache-2.0 */
/* Extents: bounding volumes of one object or of a group, of four kinds, and ray-extent tests, for
 * accelerators that support any kind.
 *
 * The tests are exact for every kind: they never reject a ray that hits. For boxes this is the theorem in
 * core/base/ray.h. It does not cover spheres, oriented boxes and slabs, so these reject a ray only by two
 * conservative tests:
 *
 * 1. The *line* of the ray misses the extent, computed in double, with the extent widened by a pad. Let m be
 *    the largest distance along one axis from the origin to a corner of the scene's box, and e = 2^-24.
 *    Triangles have the least precise hit function: a sheared coordinate has an error of at most (1 + 4 + 2)
 *    e m (difference, shear and product, sum), and its signs are exact from there on, so a line that hits
 *    passes within sqrt(2) 7 e m < 16 e m = 2^-20 m of the triangle. The other shapes compute in double; the
 *    worst case, a ray near the tip of a cone, is off by the root of an ulp, 2^-25 m. The pad is 2^-18 m.
 *    The remaining 3 * 2^-20 m exceeds all rounding here: 2^-50 m for positions relative to the origin, and
 *    2^-50 c for absolute ones, where c is a coordinate of the scene; c <= |org| + m, so another 2^-48 |org|
 *    is added for scenes that are a point. Where float32 runs out of exponents, a rounding is not
 *    proportional to m, but at most 2^-150; 2^-140 is added for that. Rounding the direction moves the point
 *    of the hit by at most 2^-51 m, which is covered. Extents are built in double and inflated by 2^-46 c
 *    (extent.c); slabs are then rounded outward to float32.
 *    An instance may be hit wherever the thick ray is in its box, which its extent contains: within sqrt(3)
 *    (2^-20 m + 2^-23 |org|) of it, and roundings by 2^-24 |org| and 3 * 2^-24 m. So 2^-21 |org| is added.
 * 2. The box of the object or group, along the ray's major axis alone, begins beyond the best t or ends
 *    before tmin. The t of a hit is clamped to the object's box, so the theorem applies. The t at which the
 *    line enters the extent is no bound: a triangle seen edge-on may be hit at any t in its box. */
#ifndef RT_ACCEL_EXTENT_H
#define RT_ACCEL_EXTENT_H

#include "accel/kernel.h"

typedef enum RtExtentKind {
    RT_EXTENT_BOX,
    RT_EXTENT_SPHERE,
    RT_EXTENT_OBB,
    RT_EXTENT_SLABS,
    RT_EXTENT_KIND_COUNT
} RtExtentKind;

/* The choices of a parameter, in the order of RtExtentKind. */
#define RT_EXTENT_KINDS "box|sphere|obb|slabs"
#define RT_MAX_SLABS    13

/* The points whose offset from `center` is at most `half` along each of three orthonormal axes. */
typedef struct RtOrientedBox {
    RtVec3d axes[3], center;
    double half[3];
} RtOrientedBox;

typedef struct RtSlab {
    float lo, hi; /* along the unit normal of the plane set, rounded outward */
} RtSlab;

/* `count` extents of one kind; the arrays of other kinds are NULL. The owner has the axis-aligned boxes for
 * every kind, because they bound t. */
typedef struct RtExtentSet {
    RtExtentKind kind;
    uint32_t count;
    uint32_t slabs_each;     /* plane sets, 3..RT_MAX_SLABS */
    RtBall *balls;           /* [count] */
    RtOrientedBox *oriented; /* [count] */
    RtSlab *slabs;           /* [count][slabs_each] */
} RtExtentSet;

/* Objects that share an extent, ids[0..count), and the union of their boxes. */
typedef struct RtGroup {
    const RtGeometry *geometry;
    const uint32_t *ids;
    uint32_t count;
    RtBox box;
} RtGroup;

/* Unit normals of the plane sets (Kay & Kajiya 1986): the axes, the diagonals of a cube, those of its
 * faces. */
extern const RtVec3d rt_slab_normals[RT_MAX_SLABS];

/* Allocates `count` extents in `memory`. */
RtStatus rt_extent_set_init(RtExtentSet *set, RtArena *memory, RtExtentKind kind, uint32_t slabs_each,
                            uint32_t count, RtError *error);

/* Bytes of the set's array. */
size_t rt_extent_set_bytes(const RtExtentSet *set);

/* Fits extent `index` to `group`, which is not empty. For one object the shape provides the extent. For
 * several, the ball is within a few per cent of the smallest (Badoiu & Clarkson 2003), and the oriented box
 * is the best of three frames: the world's, that of the largest object, and the principal axes of the centres
 * (Gottschalk, Lin & Manocha 1996). */
void rt_extent_fit(RtExtentSet *set, uint32_t index, const RtGroup *group);

/* Half the surface area of extent `index`, whose box is `box`; NaN for slabs. */
double rt_extent_half_area(const RtExtentSet *set, uint32_t index, const RtBox *box);

/* RT_OK, or RT_MISMATCH with a message that begins with `owner` if extent `index` does not contain `group`
 * according to support functions. */
RtStatus rt_extent_check(const RtExtentSet *set, uint32_t index, const RtGroup *group, const char *owner,
                         RtError *error);

/* ---- tests ---- */

/* The line of a ray, in double, prepared for the tests of one kind. */
typedef struct RtLine {
    RtVec3d org, dir;
    double pad;
    double dir_squared;           /* spheres */
    double along[RT_MAX_SLABS];   /* slabs: org . normal, ... */
    double inverse[RT_MAX_SLABS]; /* ... 1 / (dir . normal), possibly infinite */
} RtLine;

static inline double rt_line_pad(RtVec3d org, const RtGeometry *geometry) {
    const RtBox *scene_box = &geometry->box;
    double away = 0, most = 0;
    for (int a = 0; a < 3; a++) {
        double lo = fabs((double)scene_box->lo.at[a] - org.at[a]);
        double hi = fabs((double)scene_box->hi.at[a] - org.at[a]);
        double at = fabs(org.at[a]);
        away = lo > away ? lo : away;
        away = hi > away ? hi : away;
        most = at > most ? at : most;
    }
    return 0x1p-18 * away + (geometry->instance_count > 0 ? 0x1p-21 : 0x1p-48) * most + 0x1p-140;
}

static inline RtLine rt_line(const RtExtentSet *set, RtExtentKind kind, const RtGeometry *geometry,
                             const RtPreparedRay *ray) {
    RtLine line;
    line.org = rt_widen(rt_vec3_load(ray->org));
    line.dir = rt_widen(rt_vec3_load(ray->dir));
    line.pad = rt_line_pad(line.org, geometry);
    if (kind == RT_EXTENT_SPHERE) line.dir_squared = rt_dotd(line.dir, line.dir);
    for (uint32_t i = 0; kind == RT_EXTENT_SLABS && i < set->slabs_each; i++) {
        line.along[i] = rt_dotd(line.org, rt_slab_normals[i]);
        line.inverse[i] = 1 / rt_dotd(line.dir, rt_slab_normals[i]);
    }
    return line;
}

/* The distance of the line from the centre is |offset x dir| / |dir|. */
static inline bool rt_line_meets_ball(const RtLine *line, const RtBall *ball) {
    RtVec3d across = rt_crossd(rt_subd(ball->center, line->org), line->dir);
    double radius = ball->radius + line->pad;
    return !(rt_dotd(across, across) > radius * radius * line->dir_squared);
}

/* The separating axes are the line's direction crossed with each axis of the box. */
static inline bool rt_line_meets_oriented_box(const RtLine *line, const RtOrientedBox *box) {
    RtVec3d offset = rt_subd(line->org, box->center);
    double at[3], d[3], half[3];
    for (int a = 0; a < 3; a++) {
        at[a] = rt_dotd(offset, box->axes[a]);
        d[a] = rt_dotd(line->dir, box->axes[a]);
        half[a] = box->half[a] + line->pad;
    }
    for (int a = 0; a < 3; a++) {
        int b = a == 2 ? 0 : a + 1;
        if (fabs(at[a] * d[b] - at[b] * d[a]) > half[a] * fabs(d[b]) + half[b] * fabs(d[a])) return false;
    }
    return true;
}

/* If the line is parallel to a plane set, its crossings are infinite, or NaN, which is ignored. */
static inline bool rt_line_meets_slabs(const RtLine *line, const RtSlab *slabs, uint32_t count) {
    double near = -INFINITY, far = INFINITY;
    for (uint32_t i = 0; i < count; i++) {
        double lo = ((double)slabs[i].lo - line->pad - line->along[i]) * line->inverse[i];
        double hi = ((double)slabs[i].hi + line->pad - line->along[i]) * line->inverse[i];
        double first = signbit(line->inverse[i]) ? hi : lo;
        double second = signbit(line->inverse[i]) ? lo : hi;
        near = first > near ? first : near;
        far = second < far ? second : far;
        if (near > far) return false;
    }
    return true;
}

/* Whether a hit on an object within `box` may lie in [ray->tmin, limit], by the ray's major axis alone.
 * *enter is the t at which the ray enters the box along that axis. */
static inline bool rt_box_in_reach(const RtBox *box, const RtPreparedRay *ray, float limit, float *enter) {
    int k = ray->kz;
    float near = ray->negative[k] ? box->hi.at[k] : box->lo.at[k];
    float far = ray->negative[k] ? box->lo.at[k] : box->hi.at[k];
    *enter = (near - ray->org_near[k]) * ray->inv[k];
    return !(*enter > limit) && !((far - ray->org_far[k]) * ray->inv[k] < ray->tmin);
}

/* The extent test: false only if no hit of an object in extent `index`, whose box is `box`, lies in
 * [ray->tmin, limit]; otherwise *enter is at most the t of such a hit. `kind` becomes a constant. */
RT_KERNEL bool rt_extent_hit(const RtExtentSet *set, RtExtentKind kind, uint32_t index, const RtBox *box,
                             const RtPreparedRay *ray, const RtLine *line, float limit, float *enter) {
    if (kind == RT_EXTENT_BOX) return rt_box_hit(box, ray, limit, enter);
    if (!rt_box_in_reach(box, ray, limit, enter)) return false;
    if (kind == RT_EXTENT_SPHERE) return rt_line_meets_ball(line, &set->balls[index]);
    if (kind == RT_EXTENT_OBB) return rt_line_meets_oriented_box(line, &set->oriented[index]);
    return rt_line_meets_slabs(line, set->slabs + (size_t)index * set->slabs_each, set->slabs_each);
}

/* Extent `index` for RT_OBSERVE (core/base/observe.h): NULL if it is not a ball. */
RT_KERNEL const RtBall *rt_extent_ball(const RtExtentSet *set, RtExtentKind kind, uint32_t index) {
    return kind == RT_EXTENT_SPHERE ? &set->balls[index] : NULL;
}

/* Calls one of four inlined copies of f(kind, ...), each with a constant `kind`. */
#define RT_BY_EXTENT_KIND(kind, f, ...)                                                                      \
    do {                                                                                                     \
        switch (kind) {                                                                                      \
        case RT_EXTENT_BOX: f(RT_EXTENT_BOX, __VA_ARGS__); break;                                            \
        case RT_EXTENT_SPHERE: f(RT_EXTENT_SPHERE, __VA_ARGS__); break;                                      \
        case RT_EXTENT_OBB: f(RT_EXTENT_OBB, __VA_ARGS__); break;                                            \
        case RT_EXTENT_SLABS: f(RT_EXTENT_SLABS, __VA_ARGS__); break;                                        \
        case RT_EXTENT_KIND_COUNT: break;                                                                    \
        }                                                                                                    \
    } while (0)

#endif
