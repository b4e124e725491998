/* SPDX-License-Identifier: Apache-2.0 */
/* The watertight triangle test for many pairs of a ray and a triangle at once, by width: RT_LANES pairs, or
 * four. It repeats rt_triangle_hit (core/shape/shape.h) operation by operation, to the same bits.
 *
 *     rt_shear        moves vertices to the ray's origin and shears them, until the ray is the z axis
 *     rt_edge_prefilter    the edge functions in float32: rejects nearly all pairs
 *     rt_cross        the edge functions in double, and t
 *     rt_admit        rt_box_admit with the triangle's own box
 *
 * The prefilter rejects just the pairs that rt_triangle_hit rejects by its edge functions in float32, except
 * where one of these is NaN; rt_triangle_hit finds no hit there either. */
#ifndef RT_ACCEL_WATERTIGHT_H
#define RT_ACCEL_WATERTIGHT_H

#include "accel/kernel.h"
#include "core/base/simd_across.h"

/* RtSheared: vertices, x and y along kx and ky of the ray, z along kz. RtShear: the same of each ray's
 * origin, and its shear. */
#define RT_DEFINE_PREFILTER(N)                                                                               \
    typedef struct RtSheared##N {                                                                            \
        RtFloat##N x[3], y[3], z[3];                                                                         \
    } RtSheared##N;                                                                                          \
    typedef struct RtShear##N {                                                                              \
        RtFloat##N org_x, org_y, org_z, shear_x, shear_y;                                                    \
    } RtShear##N;                                                                                            \
    RT_KERNEL void rt_shear##N(const RtShear##N *ray, RtSheared##N *s) {                                     \
        for (int i = 0; i < 3; i++) {                                                                        \
            s->z[i] = s->z[i] - ray->org_z;                                                                  \
            s->x[i] = s->x[i] - ray->org_x - ray->shear_x * s->z[i];                                         \
            s->y[i] = s->y[i] - ray->org_y - ray->shear_y * s->z[i];                                         \
        }                                                                                                    \
    }                                                                                                        \
    RT_KERNEL uint32_t rt_edge_prefilter##N(const RtSheared##N *s) {                                         \
        const RtFloat##N *x = s->x, *y = s->y;                                                               \
        RtFloat##N u = x[2] * y[1] - y[2] * x[1], v = x[0] * y[2] - y[0] * x[2];                             \
        RtFloat##N w = x[1] * y[0] - y[1] * x[0];                                                            \
        return rt_one_sign_bits(rt_min(rt_min(u, v), w), rt_max(rt_max(u, v), w));                           \
    }

/* In parts of D doubles: PART(a, i) is part i of N floats, ROUND(parts) the floats of all parts. `major`: dir
 * along kz. */
#define RT_DEFINE_CROSS(N, D, PART, ROUND)                                                                   \
    RT_KERNEL uint32_t rt_cross##N(const RtSheared##N *s, RtFloat##N major, RtFloat##N *t) {                 \
        RtDouble##D at[(N) / (D)];                                                                           \
        uint32_t within = 0;                                                                                 \
        for (int part = 0; part < (N) / (D); part++) {                                                       \
            RtDouble##D x[3], y[3], z[3];                                                                    \
            for (int i = 0; i < 3; i++)                                                                      \
                x[i] = PART(s->x[i], part), y[i] = PART(s->y[i], part), z[i] = PART(s->z[i], part);          \
            RtDouble##D u = x[2] * y[1] - y[2] * x[1], v = x[0] * y[2] - y[0] * x[2];                        \
            RtDouble##D w = x[1] * y[0] - y[1] * x[0];                                                       \
            RtDouble##D least = rt_min(rt_min(u, v), w), most = rt_max(rt_max(u, v), w);                     \
            RtDouble##D determinant = u + v + w;                                                             \
            within |= rt_inside_bits(least, most, determinant) << part * (D);                                \
            at[part] = (u * z[0] + v * z[1] + w * z[2]) / determinant / PART(major, part);                   \
        }                                                                                                    \
        *t = ROUND(at);                                                                                      \
        return within;                                                                                       \
    }

#define RT_ROUND_HALVES(halves) rt_round_doubles((halves)[0], (halves)[1])

RT_DEFINE_PREFILTER(4)
#if RT_LANES == 4
RT_DEFINE_CROSS(4, 2, rt_to_doubles, RT_ROUND_HALVES)
#else
#define RT_FOUR_DOUBLES(a, part) rt_widen4(a)
#define RT_ROUND_FOUR(whole)     rt_round4((whole)[0])
RT_DEFINE_CROSS(4, 4, RT_FOUR_DOUBLES, RT_ROUND_FOUR)
#endif
#if RT_LANES == 8
RT_DEFINE_PREFILTER(8)
RT_DEFINE_CROSS(8, 4, rt_to_doubles, RT_ROUND_HALVES)
#elif RT_LANES == 16
RT_DEFINE_PREFILTER(16)
RT_DEFINE_CROSS(16, 8, rt_to_doubles, RT_ROUND_HALVES)
#endif

/* ---- RT_LANES pairs ---- */

typedef RT_OF_LANES(RtSheared) RtSheared;
typedef RT_OF_LANES(RtShear) RtShear;
#define rt_shear          RT_OF_LANES(rt_shear)
#define rt_edge_prefilter RT_OF_LANES(rt_edge_prefilter)
#define rt_cross          RT_OF_LANES(rt_cross)

/* The thickness of rays by rt_ray_prepare_in, for hits in `box`, and by how much it shifts their origins
 * along an axis. */
RT_KERNEL RtFloats rt_lanes_thickness(const RtFloats org[3], const RtBox *box) {
    RtFloats farthest = rt_all(0);
    for (int a = 0; a < 3; a++) {
        farthest = rt_max(rt_abs(box->lo.at[a] - org[a]), farthest);
        farthest = rt_max(rt_abs(box->hi.at[a] - org[a]), farthest);
    }
    return farthest * 0x1p-20f;
}

RT_KERNEL RtFloats rt_lanes_shift(RtFloats thickness, RtFloats org) {
    return thickness + rt_abs(org) * 0x1p-23f;
}

/* What rt_box_own_span needs of each ray, by axis, and for rt_box_admit tmin and tmax. */
typedef struct RtLaneRays {
    RtFloats org[3], inv[3], tmin, tmax; /* tmax finite */
    RtInts negative[3];                  /* -1 where dir has its sign bit set, else 0 */
} RtLaneRays;

/* rt_box_own_span: where each ray is in the thick box lo..hi. */
RT_KERNEL void rt_own_span(const RtLaneRays *ray, const RtFloats lo[3], const RtFloats hi[3], RtFloats *near,
                           RtFloats *far) {
    RtFloats farthest = rt_all(0);
    for (int a = 0; a < 3; a++) {
        farthest = rt_max(rt_abs(lo[a] - ray->org[a]), farthest);
        farthest = rt_max(rt_abs(hi[a] - ray->org[a]), farthest);
    }
    const RtFloats thickness = farthest * 0x1p-20f;
    *near = rt_all(-INFINITY);
    *far = rt_all(INFINITY);
    for (int a = 0; a < 3; a++) {
        RtFloats org = ray->org[a], shift = rt_lanes_shift(thickness, org);
        RtFloats above = org + shift, below = org - shift;
        RtInts down = ray->negative[a];
        RtFloats first = rt_select(down, hi[a], lo[a]) - rt_select(down, below, above);
        RtFloats second = rt_select(down, lo[a], hi[a]) - rt_select(down, above, below);
        *near = rt_max(first * ray->inv[a], *near);
        *far = rt_min(second * ray->inv[a], *far);
    }
}

/* The hits that stay; *t is brought into the box. */
RT_KERNEL uint32_t rt_admit(const RtLaneRays *ray, RtFloats v[3][3], uint32_t hit, RtFloats *t) {
    RtFloats lo[3], hi[3], near, far;
    for (int a = 0; a < 3; a++) {
        lo[a] = rt_min(rt_min(v[0][a], v[1][a]), v[2][a]);
        hi[a] = rt_max(rt_max(v[0][a], v[1][a]), v[2][a]);
    }
    rt_own_span(ray, lo, hi, &near, &far);
    *t = rt_min(far, rt_max(near, *t)); /* NaN stays, and is no hit */
    return hit & rt_le_bits(near, far) & rt_le_bits(ray->tmin, *t) & rt_le_bits(*t, ray->tmax);
}

/* Rays and their triangles, by axis of the scene. */
typedef struct RtRayTriangles {
    RtFloats org[3], dir[3], tmin, tmax; /* tmax may be infinite */
    RtFloats v[3][3];                    /* vertex, axis */
} RtRayTriangles;

/* rt_major_axis: the first of the largest. -1 where it is y, if it is not z; and where it is z. */
RT_KERNEL void rt_major_axes(const RtFloats dir[3], RtInts *y, RtInts *z) {
    RtFloats size[3] = {rt_abs(dir[0]), rt_abs(dir[1]), rt_abs(dir[2])};
    *y = size[0] < size[1];
    *z = rt_max(size[0], size[1]) < size[2];
}

/* The coordinate of a vector along kz, kx or ky, `next` 0, 1 or 2. */
RT_KERNEL RtFloats rt_along(const RtFloats at[3], RtInts y, RtInts z, int next) {
    return rt_select(z, at[(2 + next) % 3], rt_select(y, at[(1 + next) % 3], at[next]));
}

/* Sets up the shear of each ray and moves the triangles by it. */
RT_KERNEL void rt_shear_pairs(const RtRayTriangles *p, RtInts y, RtInts z, RtSheared *s) {
    RtFloats inv = 1 / rt_along(p->dir, y, z, 0);
    const RtShear shear = {rt_along(p->org, y, z, 1), rt_along(p->org, y, z, 2), rt_along(p->org, y, z, 0),
                           rt_along(p->dir, y, z, 1) * inv, rt_along(p->dir, y, z, 2) * inv};
    for (int i = 0; i < 3; i++) {
        s->z[i] = rt_along(p->v[i], y, z, 0);
        s->x[i] = rt_along(p->v[i], y, z, 1);
        s->y[i] = rt_along(p->v[i], y, z, 2);
    }
    rt_shear(&shear, s);
}

/* The pairs that the prefilter lets pass. */
RT_KERNEL uint32_t rt_edge_prefilter_pairs(const RtRayTriangles *p) {
    RtInts y, z;
    RtSheared s;
    rt_major_axes(p->dir, &y, &z);
    rt_shear_pairs(p, y, z, &s);
    return rt_edge_prefilter(&s);
}

/* The pairs that hit, and t of each: any ray, any triangle. */
RT_KERNEL uint32_t rt_hit_pairs(RtRayTriangles *p, RtFloats *t) {
    RtLaneRays rays = {.tmin = p->tmin, .tmax = rt_min(p->tmax, rt_all(FLT_MAX))};
    RtInts y, z;
    RtSheared s;
    for (int a = 0; a < 3; a++) {
        rays.org[a] = p->org[a];
        rays.inv[a] = 1 / p->dir[a];
        rays.negative[a] = (RtInts)p->dir[a] < 0;
    }
    rt_major_axes(p->dir, &y, &z);
    rt_shear_pairs(p, y, z, &s);
    uint32_t hit = rt_cross(&s, rt_along(p->dir, y, z, 0), t);
    return rt_admit(&rays, p->v, hit, t);
}

/* The triangles at[0..RT_LANES), anywhere, to v. */
RT_KERNEL void rt_load_triangles(const RtTriangle *const at[RT_LANES], RtFloats v[3][3]) {
    const float *from[RT_LANES];
    RtFloats four[4];
    for (int i = 0; i < RT_LANES; i++) from[i] = at[i]->v[0].at;
    rt_load_columns(from, four);
    for (int k = 0; k < 4; k++) v[k / 3][k % 3] = four[k];
    for (int i = 0; i < RT_LANES; i++) from[i] += 4;
    rt_load_columns(from, four);
    for (int k = 0; k < 4; k++) v[(4 + k) / 3][(4 + k) % 3] = four[k];
    for (int i = 0; i < RT_LANES; i++) from[i] += 1; /* not beyond the triangle */
    rt_load_columns(from, four);
    v[2][2] = four[3];
}

#endif
