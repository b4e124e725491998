/* SPDX-License-Identifier: Apache-2.0 */
/* Sixteen pairs of a ray and a triangle in lanes, tested in full: what rt_triangle_hit does, operation by
 * operation, to the same bits (core/shape/triangle.h). accel/sieve.h is the part of it that turns most pairs
 * away. */
#ifndef RT_ACCEL_PAIRS_H
#define RT_ACCEL_PAIRS_H

#include "accel/sieve.h"
#include "accel/simd_doubles.h"

/* Vertices of sheared triangles: x, y along kx and ky of the ray, z along kz. */
typedef struct RtPairsSheared {
    RtV16 x[3], y[3], z[3];
} RtPairsSheared;

/* The part in double of eight of them, the lower or the upper half: bit i where the plane is crossed within
 * triangle i, and where, to t. */
RT_KERNEL uint32_t rt_pairs_cross8(const RtPairsSheared *s, int half, __m256 major, __m256 *t) {
    const RtD8 zero = rt_d8_all(0);
    RtD8 x[3], y[3], z[3];
    for (int i = 0; i < 3; i++) {
        x[i] = rt_d8_of(rt_v16_half(s->x[i], half));
        y[i] = rt_d8_of(rt_v16_half(s->y[i], half));
        z[i] = rt_d8_of(rt_v16_half(s->z[i], half));
    }
    RtD8 u = rt_d8_sub(rt_d8_mul(x[2], y[1]), rt_d8_mul(y[2], x[1]));
    RtD8 v = rt_d8_sub(rt_d8_mul(x[0], y[2]), rt_d8_mul(y[0], x[2]));
    RtD8 w = rt_d8_sub(rt_d8_mul(x[1], y[0]), rt_d8_mul(y[1], x[0]));
    RtD8 least = rt_d8_min(rt_d8_min(u, v), w), most = rt_d8_max(rt_d8_max(u, v), w);
    RtD8 determinant = rt_d8_add(rt_d8_add(u, v), w);
    uint32_t within = rt_d8_at_most(zero, least) | rt_d8_at_most(most, zero);
    within &= rt_d8_differ(determinant, zero);
    RtD8 depth = rt_d8_add(rt_d8_add(rt_d8_mul(u, z[0]), rt_d8_mul(v, z[1])), rt_d8_mul(w, z[2]));
    *t = rt_d8_narrow(rt_d8_div(rt_d8_div(depth, determinant), rt_d8_of(major)));
    return within;
}

/* All sixteen. `major`: dir along kz. */
RT_KERNEL uint32_t rt_pairs_cross(const RtPairsSheared *s, RtV16 major, RtV16 *t) {
    __m256 lower, upper;
    uint32_t within = rt_pairs_cross8(s, 0, rt_v16_half(major, 0), &lower);
    within |= rt_pairs_cross8(s, 1, rt_v16_half(major, 1), &upper) << 8;
    *t = rt_v16_halves(lower, upper);
    return within;
}

/* What rt_box_admit needs of each ray, by axis. */
typedef struct RtPairsRays {
    RtV16 org[3], inv[3], tmin, tmax; /* tmax finite */
    RtSet16 negative[3];              /* whose dir has its sign bit set */
} RtPairsRays;

/* rt_box_admit with the triangles' own boxes: of the hits those that stay, *t brought into the box. */
RT_KERNEL uint32_t rt_pairs_admit(const RtPairsRays *ray, RtV16 v[3][3], uint32_t hit, RtV16 *t) {
    RtV16 lo[3], hi[3], farthest = rt_v16_all(0);
    for (int a = 0; a < 3; a++) {
        lo[a] = rt_v16_min(rt_v16_min(v[0][a], v[1][a]), v[2][a]);
        hi[a] = rt_v16_max(rt_v16_max(v[0][a], v[1][a]), v[2][a]);
        farthest = rt_v16_max(rt_v16_abs(rt_v16_sub(lo[a], ray->org[a])), farthest);
        farthest = rt_v16_max(rt_v16_abs(rt_v16_sub(hi[a], ray->org[a])), farthest);
    }
    RtV16 thickness = rt_v16_mul(farthest, rt_v16_all(0x1p-20f));
    RtV16 near = rt_v16_all(-INFINITY), far = rt_v16_all(INFINITY);
    for (int a = 0; a < 3; a++) {
        RtV16 org = ray->org[a];
        RtV16 shift = rt_v16_add(thickness, rt_v16_mul(rt_v16_abs(org), rt_v16_all(0x1p-23f)));
        RtV16 above = rt_v16_add(org, shift), below = rt_v16_sub(org, shift);
        RtSet16 down = ray->negative[a];
        RtV16 first = rt_v16_sub(rt_v16_pick(down, lo[a], hi[a]), rt_v16_pick(down, above, below));
        RtV16 second = rt_v16_sub(rt_v16_pick(down, hi[a], lo[a]), rt_v16_pick(down, below, above));
        near = rt_v16_max(rt_v16_mul(first, ray->inv[a]), near);
        far = rt_v16_min(rt_v16_mul(second, ray->inv[a]), far);
    }
    *t = rt_v16_min(far, rt_v16_max(near, *t)); /* what is no number stays so, and is no hit */
    return hit & rt_v16_at_most(near, far) & rt_v16_at_most(ray->tmin, *t) & rt_v16_at_most(*t, ray->tmax);
}

/* Rays and their triangles as they come, coordinates along the axes of the scene. */
typedef struct RtPairs {
    RtV16 org[3], dir[3], tmin, tmax; /* tmax may be infinite */
    RtV16 v[3][3];                    /* vertex, axis */
} RtPairs;

/* Of a vector by axis the one along kz, kx or ky: `z` if it is 2, `y` 1 (of kz), else 0. */
RT_KERNEL RtV16 rt_pairs_along(const RtV16 at[3], RtSet16 y, RtSet16 z, int next) {
    return rt_v16_pick(z, rt_v16_pick(y, at[next], at[(1 + next) % 3]), at[(2 + next) % 3]);
}

/* The pairs that hit, bit by bit, and where, to *t: any ray, any triangle. */
RT_KERNEL uint32_t rt_pairs_hit(RtPairs *p, RtV16 *t) {
    RtPairsRays rays = {.tmin = p->tmin, .tmax = rt_v16_min(p->tmax, rt_v16_all(FLT_MAX))};
    RtV16 size[3];
    for (int a = 0; a < 3; a++) {
        rays.org[a] = p->org[a];
        rays.inv[a] = rt_v16_div(rt_v16_all(1), p->dir[a]);
        rays.negative[a] = rt_v16_negative(p->dir[a]);
        size[a] = rt_v16_abs(p->dir[a]);
    }
    /* rt_major_axis: the first of the largest. */
    RtSet16 y = rt_v16_below(size[0], size[1]);
    RtSet16 z = rt_v16_below(rt_v16_max(size[0], size[1]), size[2]);
    RtV16 major = rt_pairs_along(p->dir, y, z, 0), inv = rt_pairs_along(rays.inv, y, z, 0);
    RtV16 org_z = rt_pairs_along(p->org, y, z, 0), org_x = rt_pairs_along(p->org, y, z, 1);
    RtV16 org_y = rt_pairs_along(p->org, y, z, 2);
    const RtSieveLine line = {org_x, org_y, org_z, rt_v16_mul(rt_pairs_along(p->dir, y, z, 1), inv),
                              rt_v16_mul(rt_pairs_along(p->dir, y, z, 2), inv)};
    RtPairsSheared s;
    for (int i = 0; i < 3; i++) {
        s.z[i] = rt_pairs_along(p->v[i], y, z, 0);
        s.x[i] = rt_pairs_along(p->v[i], y, z, 1);
        s.y[i] = rt_pairs_along(p->v[i], y, z, 2);
    }
    rt_sieve_shear(&line, s.x, s.y, s.z);
    uint32_t hit = rt_pairs_cross(&s, major, t);
    return rt_pairs_admit(&rays, p->v, hit, t);
}

/* The triangles at[0..16), each 36 bytes anywhere, to v. */
RT_KERNEL void rt_pairs_gather(const RtTriangle *const at[16], RtV16 v[3][3]) {
    const float *from[16];
    RtV16 four[4];
    for (int i = 0; i < 16; i++) from[i] = at[i]->v[0].at;
    rt_v16_columns(from, four);
    for (int k = 0; k < 4; k++) v[k / 3][k % 3] = four[k];
    for (int i = 0; i < 16; i++) from[i] += 4;
    rt_v16_columns(from, four);
    for (int k = 0; k < 4; k++) v[(4 + k) / 3][(4 + k) % 3] = four[k];
    for (int i = 0; i < 16; i++) from[i] += 1; /* not beyond the triangle */
    rt_v16_columns(from, four);
    v[2][2] = four[3];
}

#endif
