/* SPDX-License-Identifier: Apache-2.0 */
/* Where triangles are seen from a light, sixteen at a time in lanes, for the kernels of every instruction
 * set: only + - * / and comparisons of float32, so that all give the same bits.
 *
 * Projection. An offset from the light is off by 2^-24 of itself, which the margin m = 1.25 * margin makes up
 * for. Only triangles at a depth of 16 m or more, and with |u|, |w| <= 2, are drawn here. Their u and w are
 * off by 2^-24 each for both offsets, the quotient, the difference from grid.u, the product with grid.scale
 * and that with the cells of a tile, of numbers of at most 4: less than 2^-18 - RT_LIGHT_EDGE. What lies
 * within m of them is at most 4 m / depth away in u and w, since (m + |u| m) / (depth - m) is less. So much,
 * and an EDGE, and SLACK cells for the lines below, the rectangle around the projected triangle grows; and so
 * much a line must be away from a cell. */
#ifndef RT_ACCEL_LIGHT_PROJECT_H
#define RT_ACCEL_LIGHT_PROJECT_H

#include "accel/kernel.h"
#include "accel/light/light.h"
#include "accel/pairs.h"
#include "accel/simd_words.h"

#define RT_LIGHT_SLACK 0x1p-6f

/* Seen from a light on a face. */
typedef struct Projected {
    RtV16 x[3], y[3];              /* columns and rows from the origin of the grid */
    RtV16 lo[2], hi[2], near, far; /* grown */
    RtV16 grow;                    /* in cells */
    uint32_t drawn, small;         /* can be drawn in lanes; and is small */
} Projected;

/* What projecting needs of the light. */
typedef struct Eye {
    RtV16 position[3], margin;
} Eye;

RT_KERNEL Eye make_eye(const RtLightBuffer *buffer, uint32_t light) {
    Eye eye;
    for (int a = 0; a < 3; a++)
        eye.position[a] = rt_v16_all(buffer->isa.base.scene->lights[light].position.at[a]);
    eye.margin = rt_v16_all(rt_float_above(1.25 * buffer->cubes[light].margin));
    return eye;
}

RT_KERNEL RtV16 least3(const RtV16 a[3]) {
    return rt_v16_min(rt_v16_min(a[0], a[1]), a[2]);
}

RT_KERNEL RtV16 most3(const RtV16 a[3]) {
    return rt_v16_max(rt_v16_max(a[0], a[1]), a[2]);
}

/* Offsets of triangles at[0..16) by vertex and axis. */
RT_KERNEL void offsets_of(const Eye *eye, const RtTriangle *const at[16], RtV16 v[3][3]) {
    rt_pairs_gather(at, v);
    for (int i = 0; i < 3; i++) {
        for (int a = 0; a < 3; a++) v[i][a] = rt_v16_sub(v[i][a], eye->position[a]);
    }
}

/* Depths of vertices, and how far they are to the side along u and w. */
RT_KERNEL void turn_to_face(int face, RtV16 v[3][3], RtV16 z[3], RtV16 side[2][3]) {
    const int axis = face / 2;
    for (int i = 0; i < 3; i++) {
        z[i] = face % 2 ? v[i][axis] : rt_v16_sub(rt_v16_all(0), v[i][axis]);
        side[0][i] = v[i][(axis + 1) % 3];
        side[1][i] = v[i][(axis + 2) % 3];
    }
}

/* Those that may be seen on a face. */
RT_KERNEL uint32_t seen_on(const Eye *eye, int face, RtV16 v[3][3]) {
    RtV16 z[3], side[2][3];
    turn_to_face(face, v, z, side);
    const RtV16 zero = rt_v16_all(0), far = rt_v16_add(most3(z), eye->margin);
    uint32_t seen = ~rt_v16_at_most(far, zero) & 0xffff;
    for (int k = 0; k < 2; k++) {
        RtV16 least = rt_v16_sub(least3(side[k]), eye->margin),
              most = rt_v16_add(most3(side[k]), eye->margin);
        seen &= rt_v16_at_most(least, far) & rt_v16_at_most(rt_v16_sub(zero, most), far);
    }
    return seen;
}

/* In n x n cells of a tile; column and row are the first of them. */
RT_KERNEL void project(const Eye *eye, const RtLightGrid *grid, int face, uint32_t n, uint32_t column,
                       uint32_t row, RtV16 v[3][3], Projected *p) {
    const RtV16 m = eye->margin;
    RtV16 z[3], side[2][3];
    turn_to_face(face, v, z, side);
    RtV16 nearest = least3(z);
    p->near = rt_v16_sub(nearest, m);
    p->far = rt_v16_add(most3(z), m);
    p->drawn = rt_v16_at_most(rt_v16_mul(m, rt_v16_all(16)), nearest);
    for (int i = 0; i < 3; i++) {
        RtV16 wide = rt_v16_add(z[i], z[i]);
        p->drawn &= rt_v16_at_most(rt_v16_abs(side[0][i]), wide);
        p->drawn &= rt_v16_at_most(rt_v16_abs(side[1][i]), wide);
    }
    const RtV16 scale = rt_v16_all(grid->scale * (float)n), most_cells = rt_v16_all(0x1p13f);
    RtV16 grow = rt_v16_div(rt_v16_mul(m, rt_v16_all(4)), rt_v16_max(nearest, m));
    grow = rt_v16_add(rt_v16_all(0x1p-18f), grow);
    p->grow = rt_v16_add(rt_v16_mul(scale, grow), rt_v16_all(RT_LIGHT_SLACK));
    p->small = p->drawn;
    for (int k = 0; k < 2; k++) {
        RtV16 *to = k ? p->y : p->x;
        const RtV16 origin = rt_v16_all(k ? grid->w : grid->u), from = rt_v16_all((float)(k ? row : column));
        for (int i = 0; i < 3; i++) {
            to[i] = rt_v16_mul(rt_v16_sub(rt_v16_div(side[k][i], z[i]), origin), scale);
            to[i] = rt_v16_sub(to[i], from);
            p->drawn &= rt_v16_at_most(rt_v16_abs(to[i]), most_cells);
        }
        p->lo[k] = rt_v16_sub(least3(to), p->grow);
        p->hi[k] = rt_v16_add(most3(to), p->grow);
        p->small &= rt_v16_at_most(rt_v16_sub(p->hi[k], p->lo[k]), rt_v16_all(RT_LIGHT_SMALL_CELLS - 1));
    }
    p->small &= p->drawn;
}

static uint32_t place(const RtLightBuffer *buffer, uint32_t light, uint32_t first, uint32_t count,
                      RtLightPlace *places) {
    const RtLightCube *cube = &buffer->cubes[light];
    const Eye eye = make_eye(buffer, light);
    const RtTriangle *at[16];
    RtV16 v[3][3];
    uint32_t found = 0;
    for (uint32_t i = 0; i < 16; i++)
        at[i] = &buffer->isa.base.scene->geometry.triangles[first + (i < count ? i : 0)];
    offsets_of(&eye, at, v);
    for (int face = 0; face < 6; face++) {
        const RtLightGrid *grid = &cube->grids[face];
        if (grid->columns == 0) continue;
        uint32_t seen = seen_on(&eye, face, v) & ((1u << count) - 1);
        if (!seen) continue;
        Projected p;
        project(&eye, grid, face, 1, 0, 0, v, &p);
        _Alignas(64) uint32_t lo[2][16], hi[2][16];
        for (int k = 0; k < 2; k++) {
            const RtV16 zero = rt_v16_all(0), cells = rt_v16_all((float)(k ? grid->rows : grid->columns));
            seen &= ~(p.drawn & ~(rt_v16_at_most(zero, p.hi[k]) & ~rt_v16_at_most(cells, p.lo[k])));
            RtV16 last = rt_v16_sub(cells, rt_v16_all(1));
            rt_w16_put(lo[k], rt_w16_truncate(rt_v16_min(rt_v16_max(p.lo[k], zero), last)));
            rt_w16_put(hi[k], rt_w16_truncate(rt_v16_min(rt_v16_max(p.hi[k], zero), last)));
        }
        for (; seen; seen &= seen - 1) {
            uint32_t i = (uint32_t)__builtin_ctz(seen), bit = 1u << i;
            places[found++] = (RtLightPlace){.object = first + i,
                                             .lo = {(uint16_t)lo[0][i], (uint16_t)lo[1][i]},
                                             .hi = {(uint16_t)hi[0][i], (uint16_t)hi[1][i]},
                                             .face = (uint8_t)face,
                                             .drawn = (p.drawn & bit) != 0};
        }
    }
    return found;
}

#endif
