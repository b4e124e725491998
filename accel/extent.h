/* SPDX-License-Identifier: Apache-2.0 */
/* Extents: bounding volumes of one object or of a group of them, of four kinds, and the tests of a ray
 * against them. Shared by the accelerators that may use any kind.
 *
 * Exact for every kind. Boxes are, by the theorem in core/base/ray.h. There is none for spheres, oriented
 * boxes and slabs, so a ray is turned away by two tests that cannot be wrong:
 *
 * 1. Its *line* misses the extent widened by a pad, in double. Let m be the distance along an axis from the
 *    origin to the farthest corner of the scene's box, e = 2^-24. Triangles have the coarsest hit function: a
 *    sheared coordinate is off by at most (1 + 4 + 2) e m (difference, shear and product, sum), its signs are
 *    exact from there on, so a line said to hit passes within sqrt(2) 7 e m < 16 e m = 2^-20 m of the
 *    triangle. The other shapes compute in double; the worst, a ray by the tip of a cone, is off by the root
 *    of an ulp, 2^-25 m. The pad is 2^-18 m. What remains of it, 3 * 2^-20 m, is more than all rounding here:
 *    2^-50 m for positions relative to the origin and 2^-50 c for absolute ones, where c is a coordinate of
 *    the scene; c <= |org| + m, so another 2^-48 |org| is added for scenes that are a point. Where float32
 *    runs out of exponents a rounding is no part of m, but up to 2^-150, for which 2^-140 is added. A
 *    direction's rounding moves the point of the hit by 2^-51 m at most, and can be seen as part of that.
 *    Extents are built in double and inflated by 2^-46 c (extent.c), slabs then rounded outward to float32.
 * 2. The box of the object or the group, along the ray's largest axis alone, begins beyond the best t or ends
 *    before tmin. A hit's t is brought into its own box, so the theorem holds. Where the line enters the
 *    extent says nothing: the t of a triangle seen edge-on may lie anywhere in its box. */
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

/* The box of the points whose offset from `center` has, along each of three orthonormal axes, a length of at
 * most `half`. */
typedef struct RtOrientedBox {
    RtVec3d axes[3], center;
    double half[3];
} RtOrientedBox;

typedef struct RtSlab {
    float lo, hi; /* along the unit normal of the plane set, rounded outward */
} RtSlab;

/* `count` extents of one kind. Only the array of the kind is there; axis-aligned boxes are kept by the owner
 * for every kind, because they also say where along a ray an extent may be. */
typedef struct RtExtentSet {
    RtExtentKind kind;
    uint32_t count;
    uint32_t slabs_each;     /* plane sets, 3..RT_MAX_SLABS */
    RtBall *balls;           /* [count] */
    RtOrientedBox *oriented; /* [count] */
    RtSlab *slabs;           /* [count][slabs_each] */
} RtExtentSet;

/* Objects that share an extent: ids[0..count), with the union of their boxes. */
typedef struct RtGroup {
    const RtGeometry *geometry;
    const uint32_t *ids;
    uint32_t count;
    RtBox box;
} RtGroup;

/* Unit normals of the plane sets (Kay & Kajiya 1986): the axes, the diagonals of a cube, those of its
 * faces. */
extern const RtVec3d rt_slab_normals[RT_MAX_SLABS];

/* Makes room for `count` extents. On failure the set is empty. Free with rt_extent_set_clear. */
RtStatus rt_extent_set_init(RtExtentSet *set, RtExtentKind kind, uint32_t slabs_each, uint32_t count,
                            RtError *error);
void rt_extent_set_clear(RtExtentSet *set);

/* Bytes of the set's array. */
size_t rt_extent_set_bytes(const RtExtentSet *set);

/* Computes extent `index` as that of `group`, which is not empty. Of one object it is what the shape knows
 * best; of several, the ball is within a few per cent of the smallest (Badoiu & Clarkson 2003), and the
 * oriented box the best of three frames: the world's, that of the largest object, and the principal axes of
 * the centres (Gottschalk, Lin & Manocha 1996). */
void rt_extent_fit(RtExtentSet *set, uint32_t index, const RtGroup *group);

/* Half the surface of extent `index` with the box `box`; NaN for slabs, whose polytope is not worth the
 * trouble. */
double rt_extent_half_area(const RtExtentSet *set, uint32_t index, const RtBox *box);

/* RT_OK, or RT_MISMATCH with a message that begins with `owner` if extent `index` does not hold `group`, as
 * far as support functions tell. */
RtStatus rt_extent_check(const RtExtentSet *set, uint32_t index, const RtGroup *group, const char *owner,
                         RtError *error);

/* ---- tests ---- */

/* A ray as the line it lies on, in double, with what the tests of one kind need. */
typedef struct RtLine {
    RtVec3d org, dir;
    double pad;
    double dir_squared;           /* spheres */
    double along[RT_MAX_SLABS];   /* slabs: org . normal, ... */
    double inverse[RT_MAX_SLABS]; /* ... 1 / (dir . normal), possibly infinite */
} RtLine;

static inline double rt_line_pad(RtVec3d org, const RtBox *scene_box) {
    double away = 0, most = 0;
    for (int a = 0; a < 3; a++) {
        double lo = fabs((double)scene_box->lo.at[a] - org.at[a]);
        double hi = fabs((double)scene_box->hi.at[a] - org.at[a]);
        double at = fabs(org.at[a]);
        away = lo > away ? lo : away;
        away = hi > away ? hi : away;
        most = at > most ? at : most;
    }
    return 0x1p-18 * away + 0x1p-48 * most + 0x1p-140;
}

static inline RtLine rt_line(const RtExtentSet *set, RtExtentKind kind, const RtBox *scene_box,
                             const RtPreparedRay *ray) {
    RtLine line;
    line.org = rt_widen(ray->org);
    line.dir = rt_widen(ray->dir);
    line.pad = rt_line_pad(line.org, scene_box);
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

/* Separating axes of a line and a box: the line's direction crossed with each axis of the box. */
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

/* Where the line runs along a plane set its crossings are infinite, or NaN, which is passed over. */
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

/* Can a hit on an object within `box` lie in [ray->tmin, limit]? Asks the ray's largest axis only. *enter is
 * where the ray enters the box along that axis. */
static inline bool rt_box_in_reach(const RtBox *box, const RtPreparedRay *ray, float limit, float *enter) {
    int k = ray->kz;
    float near = ray->negative[k] ? box->hi.at[k] : box->lo.at[k];
    float far = ray->negative[k] ? box->lo.at[k] : box->hi.at[k];
    *enter = (near - ray->org_near[k]) * ray->inv[k];
    return !(*enter > limit) && !((far - ray->org_far[k]) * ray->inv[k] < ray->tmin);
}

/* The extent test: false only if no hit of an object in extent `index`, whose box is `box`, lies in
 * [ray->tmin, limit]; else *enter is no larger than any such hit's t. `kind` is a constant where this is
 * inlined. */
RT_KERNEL bool rt_extent_hit(const RtExtentSet *set, RtExtentKind kind, uint32_t index, const RtBox *box,
                             const RtPreparedRay *ray, const RtLine *line, float limit, float *enter) {
    if (kind == RT_EXTENT_BOX) return rt_box_hit(box, ray, limit, enter);
    if (!rt_box_in_reach(box, ray, limit, enter)) return false;
    if (kind == RT_EXTENT_SPHERE) return rt_line_meets_ball(line, &set->balls[index]);
    if (kind == RT_EXTENT_OBB) return rt_line_meets_oriented_box(line, &set->oriented[index]);
    return rt_line_meets_slabs(line, set->slabs + (size_t)index * set->slabs_each, set->slabs_each);
}

/* Extent `index` for an onlooker (core/base/observe.h): NULL where it is no ball. */
RT_KERNEL const RtBall *rt_extent_ball(const RtExtentSet *set, RtExtentKind kind, uint32_t index) {
    return kind == RT_EXTENT_SPHERE ? &set->balls[index] : NULL;
}

/* Calls one of four copies of the inlined function f(kind, ...), in each of which `kind` is a constant. */
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
