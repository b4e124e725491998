/* SPDX-License-Identifier: Apache-2.0 */
/* Drawing on the cells of a light in lanes: sixteen triangles at a time are projected, and sixteen cells at a
 * time are parted from one. Included once for each instruction set; only + - * / and comparisons of float32,
 * so that all give the same bits.
 *
 * Projection. An offset from the light is off by 2^-24 of itself, which the margin m = 1.25 * margin makes up
 * for. Only triangles at a depth of 16 m or more, and with |u|, |w| <= 2, are drawn here. Their u and w are
 * off by 2^-24 each for both offsets, the quotient, the difference from grid.u, the product with grid.scale
 * and that with the cells of a tile, of numbers of at most 4: less than 2^-18 - RT_LIGHT_EDGE. What lies
 * within m of them is at most 4 m / depth away in u and w, since (m + |u| m) / (depth - m) is less. So much,
 * and an EDGE, and SLACK cells for the lines below, the rectangle around the projected triangle grows; and so
 * much a line must be away from a cell.
 *
 * Lines. Coordinates are columns and rows from the corner of a tile. A line through two vertices, evaluated
 * in the middle of a cell, is off by a few 2^-24 of the sum of |coefficient| * 2^7, as a small triangle with
 * a cell in the tile and all of the tile are within 2^7: far less than SLACK = 2^-6 of it. If rounding turns
 * the triangle over, its area is less than that, and its lines part nothing that they should not. */
#ifndef RT_ACCEL_LIGHT_RASTER_H
#define RT_ACCEL_LIGHT_RASTER_H

#include "accel/kernel.h"
#include "accel/light/light.h"
#include "accel/pairs.h"
#include "accel/simd_words.h"

#define RT_LIGHT_SLACK 0x1p-6f

/* ---- sixteen triangles ---- */

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
        eye.position[a] = rt_v16_all(buffer->base.scene->lights[light].position.at[a]);
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
        at[i] = &buffer->base.scene->geometry.triangles[first + (i < count ? i : 0)];
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

/* ---- sixteen small triangles in a tile ---- */

/* To be drawn one by one. Lines and rectangles are from the corner of the tile. */
typedef struct Small {
    _Alignas(64) float line[3][3][16]; /* edge; x, y and 1; `inside` is where all are >= 0 */
    float around[3][16];               /* what is added for the part of a cell about a point */
    float near[16], far[16];
    uint32_t depth[16];
    uint32_t lo[2][16], hi[2][16];   /* cells of the tile; none where lo > hi */
    float least[2][16], most[2][16]; /* the rectangle */
    uint32_t large;                  /* those that are not small */
} Small;

/* a, rounded down; of less than 2^31. */
RT_KERNEL RtW16 floor16(RtV16 a) {
    RtW16 whole = rt_w16_truncate(a);
    uint32_t above = ~rt_v16_at_most(rt_v16_of_words(whole), a) & 0xffff;
    return rt_w16_pick(above, whole, rt_w16_sub(whole, rt_w16_all(1)));
}

RT_KERNEL void prepare_small(const RtLightTile *tile, const uint32_t *triangles, uint32_t count, Small *s) {
    const RtLightBuffer *buffer = tile->buffer;
    const RtLightGrid *grid = &buffer->cubes[tile->light].grids[tile->face];
    const Eye eye = make_eye(buffer, tile->light);
    const RtTriangle *at[16];
    RtV16 v[3][3];
    Projected p;
    for (uint32_t i = 0; i < 16; i++)
        at[i] = &buffer->base.scene->geometry.triangles[triangles[i < count ? i : 0]];
    offsets_of(&eye, at, v);
    project(&eye, grid, tile->face, tile->n, tile->column * tile->n, tile->row * tile->n, v, &p);
    s->large = ~p.small & ((1u << count) - 1);

    RtV16 abx = rt_v16_sub(p.x[1], p.x[0]), aby = rt_v16_sub(p.y[1], p.y[0]);
    RtV16 acx = rt_v16_sub(p.x[2], p.x[0]), acy = rt_v16_sub(p.y[2], p.y[0]);
    RtV16 area = rt_v16_sub(rt_v16_mul(abx, acy), rt_v16_mul(aby, acx));
    RtV16 sign = rt_v16_pick(rt_v16_negative(area), rt_v16_all(1), rt_v16_all(-1));
    const RtV16 half = rt_v16_add(rt_v16_all(0.5f / RT_LIGHT_PART), p.grow);
    for (int i = 0; i < 3; i++) {
        int k = (i + 1) % 3;
        RtV16 nx = rt_v16_mul(rt_v16_sub(p.y[i], p.y[k]), sign);
        RtV16 ny = rt_v16_mul(rt_v16_sub(p.x[k], p.x[i]), sign);
        RtV16 c = rt_v16_add(rt_v16_mul(nx, p.x[i]), rt_v16_mul(ny, p.y[i]));
        rt_v16_store(s->line[i][0], nx);
        rt_v16_store(s->line[i][1], ny);
        rt_v16_store(s->line[i][2], rt_v16_sub(rt_v16_all(0), c));
        rt_v16_store(s->around[i], rt_v16_mul(rt_v16_add(rt_v16_abs(nx), rt_v16_abs(ny)), half));
    }
    RtV16 step = rt_v16_mul(rt_v16_sub(p.near, rt_v16_all(grid->depth)), rt_v16_all(grid->depth_scale));
    step = rt_v16_min(rt_v16_max(step, rt_v16_all(0)), rt_v16_all(RT_LIGHT_DEPTHS - 1));
    rt_w16_put(s->depth, rt_w16_truncate(step));
    rt_v16_store(s->near, p.near);
    rt_v16_store(s->far, p.far);
    for (int k = 0; k < 2; k++) {
        RtW16 lo = floor16(p.lo[k]), hi = floor16(p.hi[k]);
        /* The rectangle may miss the tile: then lo > hi, below or above. */
        rt_w16_put(s->lo[k], rt_w16_most(lo, rt_w16_all(0)));
        rt_w16_put(s->hi[k], rt_w16_least(hi, rt_w16_all(tile->n - 1)));
        rt_v16_store(s->least[k], p.lo[k]);
        rt_v16_store(s->most[k], p.hi[k]);
    }
}

/* Lanes are 4 x 4 cells. */
static const float lane_column[16]
    __attribute__((aligned(64))) = {0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3};
static const float lane_row[16]
    __attribute__((aligned(64))) = {0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3};

/* The lanes of the first `columns` columns and `rows` rows of 4 x 4. */
RT_KERNEL uint32_t lanes_of(uint32_t columns, uint32_t rows) {
    uint32_t row = columns < 4 ? (1u << columns) - 1 : 15;
    return row * 0x1111 & (rows < 4 ? (1u << 4 * rows) - 1 : 0xffff);
}

RT_KERNEL uint32_t inside_lines(const Small *s, uint32_t i, RtV16 x, RtV16 y) {
    RtV16 worst = rt_v16_all(INFINITY);
    for (int e = 0; e < 3; e++) {
        RtV16 at = rt_v16_add(rt_v16_mul(rt_v16_all(s->line[e][0][i]), x),
                              rt_v16_mul(rt_v16_all(s->line[e][1][i]), y));
        worst = rt_v16_min(rt_v16_add(at, rt_v16_all(s->line[e][2][i])), worst);
    }
    return rt_v16_at_most(rt_v16_all(0), worst);
}

static uint32_t cover(const RtLightTile *tile, const uint32_t *triangles, uint32_t count, RtLightDesk *desk) {
    Small s;
    prepare_small(tile, triangles, count, &s);
    for (uint32_t i = 0; i < count; i++) {
        if (s.large >> i & 1) continue;
        /* Corners of cells within the rectangle, borders of the tile included. */
        int lo[2], hi[2];
        for (int k = 0; k < 2; k++) {
            lo[k] = (int)s.lo[k][i] + (s.least[k][i] > 0);
            hi[k] = (int)s.hi[k][i] + (s.most[k][i] >= (float)((int)s.hi[k][i] + 1));
        }
        for (int row = lo[1]; row <= hi[1]; row += 4) {
            for (int column = lo[0]; column <= hi[0]; column += 4) {
                RtV16 x = rt_v16_add(rt_v16_load(lane_column), rt_v16_all((float)column));
                RtV16 y = rt_v16_add(rt_v16_load(lane_row), rt_v16_all((float)row));
                uint32_t in = inside_lines(&s, i, x, y);
                in &= lanes_of((uint32_t)(hi[0] - column + 1), (uint32_t)(hi[1] - row + 1));
                for (; in; in &= in - 1) {
                    int lane = __builtin_ctz(in);
                    float *corner = &desk->corner[row + lane / 4][column + lane % 4];
                    *corner = rt_minf(s.far[i], *corner);
                }
            }
        }
    }
    return s.large;
}

RT_KERNEL void add_run(RtLightDesk *desk, RtRef object, uint32_t before) {
    if (desk->count > before) desk->runs[desk->run_count++] = (RtLightEntry){desk->count - before, object};
}

/* Middles of the parts of the cell (0, 0). */
static const float middle_x[16]
    __attribute__((aligned(64))) = {0.125f, 0.375f, 0.625f, 0.875f, 0.125f, 0.375f, 0.625f, 0.875f,
                                    0.125f, 0.375f, 0.625f, 0.875f, 0.125f, 0.375f, 0.625f, 0.875f};
static const float middle_y[16]
    __attribute__((aligned(64))) = {0.125f, 0.125f, 0.125f, 0.125f, 0.375f, 0.375f, 0.375f, 0.375f,
                                    0.625f, 0.625f, 0.625f, 0.625f, 0.875f, 0.875f, 0.875f, 0.875f};

static uint32_t draw(const RtLightTile *tile, const uint32_t *triangles, uint32_t count, RtLightDesk *desk) {
    Small s;
    prepare_small(tile, triangles, count, &s);
    const RtV16 x = rt_v16_load(middle_x), y = rt_v16_load(middle_y), zero = rt_v16_all(0);
    for (uint32_t i = 0; i < count; i++) {
        if (s.large >> i & 1) continue;
        const uint32_t before = desk->count;
        const int last_column = (int)s.hi[0][i], last_row = (int)s.hi[1][i];
        RtV16 at[3]; /* in the parts of cell (0, 0) */
        for (int e = 0; e < 3; e++) {
            at[e] = rt_v16_add(rt_v16_mul(rt_v16_all(s.line[e][0][i]), x),
                               rt_v16_mul(rt_v16_all(s.line[e][1][i]), y));
            at[e] = rt_v16_add(at[e], rt_v16_all(s.line[e][2][i] + s.around[e][i]));
        }
        /* Parts beyond the rectangle are left by the lines of slivers. */
        const RtV16 least_x = rt_v16_all(s.least[0][i] - 0.125f), most_x = rt_v16_all(s.most[0][i] + 0.125f);
        const RtV16 least_y = rt_v16_all(s.least[1][i] - 0.125f), most_y = rt_v16_all(s.most[1][i] + 0.125f);
        for (int row = (int)s.lo[1][i]; row <= last_row; row++) {
            RtV16 part_row = rt_v16_add(y, rt_v16_all((float)row));
            uint32_t rows = rt_v16_at_most(least_y, part_row) & rt_v16_at_most(part_row, most_y);
            for (int column = (int)s.lo[0][i]; column <= last_column; column++) {
                RtV16 worst = rt_v16_all(INFINITY);
                for (int e = 0; e < 3; e++) {
                    float moved = s.line[e][0][i] * (float)column + s.line[e][1][i] * (float)row;
                    worst = rt_v16_min(rt_v16_add(at[e], rt_v16_all(moved)), worst);
                }
                RtV16 part_column = rt_v16_add(x, rt_v16_all((float)column));
                uint32_t parts = rows & rt_v16_at_most(zero, worst);
                parts &= rt_v16_at_most(least_x, part_column) & rt_v16_at_most(part_column, most_x);
                if (!parts) continue;
                if (s.near[i] > desk->cover[row][column]) {
                    desk->cut[row] |= UINT64_C(1) << column;
                    continue;
                }
                desk->cell[desk->count] = (uint32_t)row * tile->n + (uint32_t)column;
                desk->key[desk->count++] = s.depth[i] << 16 | parts;
            }
        }
        add_run(desk, rt_ref(RT_SHAPE_TRIANGLE, triangles[i]), before);
    }
    return s.large;
}

/* ---- sixteen cells of a row, and one object ---- */

static const float lane_number[16]
    __attribute__((aligned(64))) = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};

RT_KERNEL RtV16 line_at(const float line[3], RtV16 x, float y) {
    return rt_v16_add(rt_v16_mul(rt_v16_all(line[0]), x), rt_v16_all(line[1] * y + line[2]));
}

RT_KERNEL uint32_t first_lanes(int count) {
    return count < 16 ? (1u << count) - 1 : 0xffff;
}

static void cover_outline(const RtLightOutline *outline, const RtLightCells *at, RtLightDesk *desk) {
    if (!outline->covers) return;
    const int last = at->hi[0] + 1; /* a cell more: its corner is that of the cell before, too */
    for (int row = at->lo[1]; row <= at->hi[1] + 1; row++) {
        for (int column = at->lo[0]; column <= last; column += 16) {
            RtV16 x = rt_v16_add(rt_v16_load(lane_number), rt_v16_all((float)column));
            uint32_t in = first_lanes(last - column + 1);
            for (uint32_t e = 0; e < outline->edges; e++) {
                in &= rt_v16_at_most(rt_v16_all(0), line_at(outline->inside[e], x, (float)row));
            }
            _Alignas(64) float depth[16];
            rt_v16_store(depth, rt_v16_div(rt_v16_all(1), line_at(outline->face, x, (float)row)));
            for (; in; in &= in - 1) {
                int lane = __builtin_ctz(in);
                float *corner = &desk->corner[row][column + lane];
                if (depth[lane] > 0) *corner = rt_minf(depth[lane], *corner);
            }
        }
    }
}

/* The parts of a cell that lie in a rectangle of parts. */
RT_KERNEL uint32_t parts_within(const RtLightCells *at, int column, int row) {
    uint32_t within[2];
    for (int k = 0; k < 2; k++) {
        int first = (k ? row : column) * RT_LIGHT_PART, lo = at->part_lo[k] - first;
        int hi = at->part_hi[k] - first;
        lo = lo < 0 ? 0 : lo;
        hi = hi < RT_LIGHT_PART - 1 ? hi : RT_LIGHT_PART - 1;
        within[k] = hi < lo ? 0 : (2u << hi) - (1u << lo);
    }
    uint32_t rows = within[1];
    rows = (rows & 1) | (rows & 2) << 3 | (rows & 4) << 6 | (rows & 8) << 9;
    return rows * within[0];
}

/* The parts of a cell that no line parts from the object. */
RT_KERNEL uint32_t parts_of(const RtLightOutline *outline, const RtLightCells *at, int column, int row) {
    uint32_t parts = parts_within(at, column, row);
    RtV16 x = rt_v16_add(rt_v16_load(middle_x), rt_v16_all((float)column));
    RtV16 y = rt_v16_add(rt_v16_load(middle_y), rt_v16_all((float)row));
    for (uint32_t e = 0; e < outline->count; e++) {
        const float *line = outline->parts[e];
        RtV16 on = rt_v16_add(rt_v16_mul(rt_v16_all(line[0]), x), rt_v16_mul(rt_v16_all(line[1]), y));
        parts &= rt_v16_at_most(rt_v16_all(RT_LIGHT_NARROWER - line[2]), on);
    }
    return parts;
}

static void draw_outline(const RtLightTile *tile, const RtLightOutline *outline, const RtLightFootprint *from,
                         const RtLightCells *at, RtRef object, RtLightDesk *desk) {
    const RtLightGrid *grid = &tile->buffer->cubes[tile->light].grids[tile->face];
    const uint32_t before = desk->count;
    const RtV16 nearest = rt_v16_all(from->near), flattest = rt_v16_all(1 / from->far);
    for (int row = at->lo[1]; row <= at->hi[1]; row++) {
        for (int column = at->lo[0]; column <= at->hi[0]; column += 16) {
            RtV16 middle = rt_v16_add(rt_v16_load(lane_number), rt_v16_all((float)column + 0.5f));
            uint32_t in = first_lanes(at->hi[0] - column + 1);
            for (uint32_t e = 0; e < outline->count; e++) {
                in &= rt_v16_at_most(rt_v16_all(0), line_at(outline->parts[e], middle, (float)row + 0.5f));
            }
            if (!in) continue;
            RtV16 slope = rt_v16_max(line_at(outline->slope, middle, (float)row + 0.5f), flattest);
            RtV16 near = rt_v16_max(rt_v16_div(rt_v16_all(1 - 0x1p-20f), slope), nearest);
            const float *cover = &desk->cover[row][column];
            uint32_t covered =
                in & ~rt_v16_at_most(near, rt_v16_join(cover, cover + 4, cover + 8, cover + 12));
            desk->cut[row] |= (uint64_t)covered << column;
            RtV16 step = rt_v16_mul(rt_v16_sub(near, rt_v16_all(grid->depth)), rt_v16_all(grid->depth_scale));
            step = rt_v16_min(rt_v16_max(step, rt_v16_all(0)), rt_v16_all(RT_LIGHT_DEPTHS - 1));
            uint32_t depth[16];
            rt_w16_put(depth, rt_w16_truncate(step));
            for (in &= ~covered; in; in &= in - 1) {
                int lane = __builtin_ctz(in);
                uint32_t parts = parts_of(outline, at, column + lane, row);
                if (!parts) continue;
                desk->cell[desk->count] = (uint32_t)row * tile->n + (uint32_t)(column + lane);
                desk->key[desk->count++] = depth[lane] << 16 | parts;
            }
        }
    }
    add_run(desk, object, before);
}

#endif
