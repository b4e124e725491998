/* SPDX-License-Identifier: Apache-2.0 */
/* Where triangles are seen from a light, RT_LANES at a time, for the kernels of every instruction set. All
 * return the same bits, because only + - * / and comparisons of float32 are used.
 *
 * Projection. An offset from the light is off by 2^-24 of itself, which the margin m = 1.25 * margin makes up
 * for. Only triangles at a depth of 16 m or more, and with |u|, |w| <= 2, are drawn here. Their u and w are
 * off by 2^-24 each for both offsets, the quotient, the difference from grid.u, the product with grid.scale
 * and that with the cells of a tile, of numbers of at most 4: less than 2^-18 - RT_LIGHT_EDGE. Points within
 * m of them are at most 4 m / depth away in u and w (accel/raster/raster.h, 2). By so much, an EDGE, and
 * SLACK cells for the lines of light_draw.h, the rectangle around the projected triangle grows; and by so
 * much a line must miss a cell. */
#ifndef RT_ACCEL_LIGHT_LIGHT_PROJECT_H
#define RT_ACCEL_LIGHT_LIGHT_PROJECT_H

#include "accel/light/light.h"
#include "accel/raster/lanes.h"

#define RT_LIGHT_SLACK 0x1p-6f

/* Seen from a light on a face. */
typedef struct Projected {
    RtFloats x[3], y[3];              /* columns and rows from the origin of the grid */
    RtFloats lo[2], hi[2], near, far; /* grown */
    RtFloats grow;                    /* in cells */
    uint32_t drawn, small;            /* can be drawn in lanes; and is small */
} Projected;

/* rt_light_depth_key in lanes. */
RT_KERNEL RtInts depth_steps(const RtLightGrid *grid, RtFloats depth) {
    RtFloats step = (depth - grid->depth) * grid->depth_scale;
    return rt_to_ints(rt_min(rt_max(step, rt_all(0)), rt_all(RT_LIGHT_DEPTHS - 1)));
}

/* The position and margin of a light. */
typedef struct Center {
    RtFloats position[3], margin;
} Center;

RT_KERNEL Center make_center(const RtLightFace *on) {
    Center center;
    for (int a = 0; a < 3; a++) center.position[a] = rt_all(on->position.at[a]);
    center.margin = rt_all(rt_float_above(1.25 * on->cube->margin));
    return center;
}

/* From vertices to offsets. */
RT_KERNEL void subtract_center(const Center *center, RtFloats v[3][3]) {
    for (int i = 0; i < 3; i++) {
        for (int a = 0; a < 3; a++) v[i][a] -= center->position[a];
    }
}

/* Depths of vertices, and how far they are to the side along u and w. */
RT_KERNEL void turn_to_face(int face, RtFloats v[3][3], RtFloats z[3], RtFloats side[2][3]) {
    const int axis = face / 2;
    for (int i = 0; i < 3; i++) {
        z[i] = face % 2 ? v[i][axis] : -v[i][axis];
        side[0][i] = v[i][(axis + 1) % 3];
        side[1][i] = v[i][(axis + 2) % 3];
    }
}

/* Those that may be seen on a face. */
RT_KERNEL uint32_t seen_on(const Center *center, int face, RtFloats v[3][3]) {
    RtFloats z[3], side[2][3];
    turn_to_face(face, v, z, side);
    const RtFloats zero = rt_all(0), far = rt_raster_most3(z) + center->margin;
    uint32_t seen = ~rt_le_bits(far, zero);
    for (int k = 0; k < 2; k++) {
        RtFloats least = rt_raster_least3(side[k]) - center->margin,
                 most = rt_raster_most3(side[k]) + center->margin;
        seen &= rt_le_bits(least, far) & rt_le_bits(-most, far);
    }
    return seen;
}

/* In n x n cells of a tile; column and row are the first of them. */
RT_KERNEL void project(const Center *center, const RtLightGrid *grid, int face, uint32_t n, uint32_t column,
                       uint32_t row, RtFloats v[3][3], Projected *p) {
    const RtFloats m = center->margin;
    RtFloats z[3], side[2][3];
    turn_to_face(face, v, z, side);
    RtFloats nearest = rt_raster_least3(z);
    p->near = nearest - m;
    p->far = rt_raster_most3(z) + m;
    p->drawn = rt_le_bits(m * 16, nearest);
    for (int i = 0; i < 3; i++) {
        RtFloats wide = z[i] + z[i];
        p->drawn &= rt_le_bits(rt_abs(side[0][i]), wide);
        p->drawn &= rt_le_bits(rt_abs(side[1][i]), wide);
    }
    const RtFloats scale = rt_all(grid->scale * (float)n), most_cells = rt_all(0x1p13f);
    p->grow = scale * (0x1p-18f + m * 4 / rt_max(nearest, m)) + RT_LIGHT_SLACK;
    p->small = p->drawn;
    for (int k = 0; k < 2; k++) {
        RtFloats *to = k ? p->y : p->x;
        const RtFloats origin = rt_all(k ? grid->w : grid->u), from = rt_all((float)(k ? row : column));
        for (int i = 0; i < 3; i++) {
            to[i] = (side[k][i] / z[i] - origin) * scale - from;
            p->drawn &= rt_le_bits(rt_abs(to[i]), most_cells);
        }
        p->lo[k] = rt_raster_least3(to) - p->grow;
        p->hi[k] = rt_raster_most3(to) + p->grow;
        p->small &= rt_le_bits(p->hi[k] - p->lo[k], rt_all(RT_LIGHT_SMALL_CELLS - 1));
    }
    p->small &= p->drawn;
}

static uint32_t place(const void *view, uint32_t first, uint32_t count, RtTileRange *to) {
    const RtLightFace *faces = view;
    const RtGeometry *g = faces[0].geometry;
    const Center center = make_center(&faces[0]);
    uint32_t placed = 0;
    for (const uint32_t end = first + count; first < end; first += RT_LANES) {
        RtFloats v[3][3];
        rt_raster_gather_row(g, first, end - first, v);
        subtract_center(&center, v);
        for (int face = 0; face < 6; face++) {
            const RtLightGrid *grid = faces[face].grid;
            if (grid->columns == 0) continue;
            uint32_t seen = seen_on(&center, face, v) & rt_raster_first_lanes(end - first);
            if (!seen) continue;
            Projected p;
            project(&center, grid, face, 1, 0, 0, v, &p);
            uint32_t lo[2][RT_LANES], hi[2][RT_LANES];
            for (int k = 0; k < 2; k++) {
                const RtFloats zero = rt_all(0), cells = rt_all((float)(k ? grid->rows : grid->columns));
                seen &= ~(p.drawn & ~(rt_le_bits(zero, p.hi[k]) & ~rt_le_bits(cells, p.lo[k])));
                RtFloats last = cells - 1;
                rt_store(lo[k], rt_to_ints(rt_min(rt_max(p.lo[k], zero), last)));
                rt_store(hi[k], rt_to_ints(rt_min(rt_max(p.hi[k], zero), last)));
            }
            for (; seen; seen &= seen - 1) {
                uint32_t i = (uint32_t)__builtin_ctz(seen), id = g->triangle_ids[first + i];
                if (p.drawn >> i & 1)
                    to[placed++] = (RtTileRange){.object = rt_ref(RT_SHAPE_TRIANGLE, first + i),
                                                 .lo = {(uint16_t)lo[0][i], (uint16_t)lo[1][i]},
                                                 .hi = {(uint16_t)hi[0][i], (uint16_t)hi[1][i]},
                                                 .layer = (uint16_t)face};
                else if (!rt_light_is_near(&faces[face], id))
                    placed += rt_light_place(&faces[face], id, &to[placed]);
            }
        }
    }
    return placed;
}

#endif
