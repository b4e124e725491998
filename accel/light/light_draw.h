/* SPDX-License-Identifier: Apache-2.0 */
/* Drawing on the cells of a light in lanes: small triangles by sixteen corners or parts of cells at a time,
 * other objects by their outline and sixteen cells of a row. Included once for each instruction set.
 *
 * Lines. Coordinates are columns and rows from the corner of a tile. A line through two vertices, evaluated
 * in the middle of a cell, is off by a few 2^-24 of the sum of |coefficient| * 2^7, because a small triangle
 * with a cell in the tile and all of the tile are within 2^7: far less than SLACK = 2^-6 of it. If rounding
 * turns the triangle over, its area is less than that, and its lines exclude nothing that they should not. */
#ifndef RT_ACCEL_LIGHT_LIGHT_DRAW_H
#define RT_ACCEL_LIGHT_LIGHT_DRAW_H

#include "accel/light/light_project.h"

/* ---- small triangles in a tile ---- */

/* Sixteen, to be drawn one by one. Lines and rectangles are from the corner of the tile. */
typedef struct Small {
    _Alignas(64) float line[3][3][16]; /* edge; x, y and 1; `inside` is where all are >= 0 */
    float around[3][16];               /* what is added for the part of a cell about a point */
    float near[16], far[16];
    uint32_t depth[16];
    uint32_t lo[2][16], hi[2][16];   /* cells of the tile; none where lo > hi */
    float least[2][16], most[2][16]; /* the rectangle */
    uint32_t large;                  /* those that are not small */
} Small;

RT_KERNEL void prepare_small(const RtLightTile *tile, const RtRef *triangles, uint32_t count, Small *s) {
    const RtLightGrid *grid = tile->on.grid;
    const Center center = make_center(&tile->on);
    RtV16 v[3][3];
    Projected p;
    rt_raster_gather(tile->on.geometry, triangles, count, v);
    subtract_center(&center, v);
    project(&center, grid, tile->on.face, tile->n, tile->column * tile->n, tile->row * tile->n, v, &p);
    s->large = ~p.small & rt_raster_first_lanes(count);

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
    rt_w16_put(s->depth, depth_steps(grid, p.near));
    rt_v16_store(s->near, p.near);
    rt_v16_store(s->far, p.far);
    for (int k = 0; k < 2; k++) {
        RtW16 lo = rt_w16_truncate(rt_v16_floor(p.lo[k])), hi = rt_w16_truncate(rt_v16_floor(p.hi[k]));
        /* The rectangle may miss the tile: then lo > hi, below or above. */
        rt_w16_put(s->lo[k], rt_w16_most(lo, rt_w16_all(0)));
        rt_w16_put(s->hi[k], rt_w16_least(hi, rt_w16_all(tile->n - 1)));
        rt_v16_store(s->least[k], p.lo[k]);
        rt_v16_store(s->most[k], p.hi[k]);
    }
}

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

static uint32_t cover(const RtLightTile *tile, const RtRef *triangles, uint32_t count, RtLightDraft *draft) {
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
                RtV16 x = rt_raster_columns((float)column), y = rt_raster_rows((float)row);
                uint32_t in = inside_lines(&s, i, x, y);
                in &= lanes_of((uint32_t)(hi[0] - column + 1), (uint32_t)(hi[1] - row + 1));
                for (; in; in &= in - 1) {
                    int lane = __builtin_ctz(in);
                    float *corner = &draft->corner[row + lane / 4][column + lane % 4];
                    *corner = rt_minf(s.far[i], *corner);
                }
            }
        }
    }
    return s.large;
}

RT_KERNEL void add_run(RtLightDraft *draft, RtRef object, uint32_t before) {
    if (draft->count > before)
        draft->runs[draft->run_count++] = (RtLightEntry){draft->count - before, object};
}

/* Middles of the 4 x 4 parts of the cell (0, 0). */
RT_KERNEL RtV16 part_middles(const float lanes[16]) {
    return rt_v16_add(rt_v16_mul(rt_v16_load(lanes), rt_v16_all(1.0f / RT_LIGHT_PART)), rt_v16_all(0.125f));
}

static uint32_t draw(const RtLightTile *tile, const RtRef *triangles, uint32_t count, RtLightDraft *draft) {
    Small s;
    prepare_small(tile, triangles, count, &s);
    const RtV16 x = part_middles(rt_raster_column), y = part_middles(rt_raster_row), zero = rt_v16_all(0);
    for (uint32_t i = 0; i < count; i++) {
        if (s.large >> i & 1) continue;
        const uint32_t before = draft->count;
        const int last_column = (int)s.hi[0][i], last_row = (int)s.hi[1][i];
        RtV16 at[3]; /* in the parts of cell (0, 0) */
        for (int e = 0; e < 3; e++) {
            at[e] = rt_v16_add(rt_v16_mul(rt_v16_all(s.line[e][0][i]), x),
                               rt_v16_mul(rt_v16_all(s.line[e][1][i]), y));
            at[e] = rt_v16_add(at[e], rt_v16_all(s.line[e][2][i] + s.around[e][i]));
        }
        /* The lines of slivers leave parts beyond the rectangle. */
        const RtV16 least_x = rt_v16_all(s.least[0][i] - 0.125f), most_x = rt_v16_all(s.most[0][i] + 0.125f);
        const RtV16 least_y = rt_v16_all(s.least[1][i] - 0.125f), most_y = rt_v16_all(s.most[1][i] + 0.125f);
        for (int row = (int)s.lo[1][i]; row <= last_row; row++) {
            RtV16 part_row = rt_v16_add(y, rt_v16_all((float)row));
            uint32_t rows = rt_v16_at_most(least_y, part_row) & rt_v16_at_most(part_row, most_y);
            for (int column = (int)s.lo[0][i]; column <= last_column; column++) {
                if (s.near[i] > draft->cover[row][column]) { /* even if it is not in the cell */
                    draft->cut[row] |= UINT64_C(1) << column;
                    continue;
                }
                RtV16 worst = rt_v16_all(INFINITY);
                for (int e = 0; e < 3; e++) {
                    float moved = s.line[e][0][i] * (float)column + s.line[e][1][i] * (float)row;
                    worst = rt_v16_min(rt_v16_add(at[e], rt_v16_all(moved)), worst);
                }
                RtV16 part_column = rt_v16_add(x, rt_v16_all((float)column));
                uint32_t parts = rows & rt_v16_at_most(zero, worst);
                parts &= rt_v16_at_most(least_x, part_column) & rt_v16_at_most(part_column, most_x);
                if (!parts) continue;
                draft->cell[draft->count] = (uint32_t)row * tile->n + (uint32_t)column;
                draft->key[draft->count++] = s.depth[i] << 16 | parts;
            }
        }
        add_run(draft, triangles[i], before);
    }
    return s.large;
}

/* ---- sixteen cells of a row, and one object ---- */

static const _Alignas(64) float lane_number[16] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};

RT_KERNEL RtV16 line_at(const float line[3], RtV16 x, float y) {
    return rt_v16_add(rt_v16_mul(rt_v16_all(line[0]), x), rt_v16_all(line[1] * y + line[2]));
}

static void cover_outline(const RtLightOutline *outline, const RtLightCells *at, RtLightDraft *draft) {
    if (!outline->covers) return;
    const int last = at->hi[0] + 1; /* a cell more: its corner is that of the cell before, too */
    for (int row = at->lo[1]; row <= at->hi[1] + 1; row++) {
        for (int column = at->lo[0]; column <= last; column += 16) {
            RtV16 x = rt_v16_add(rt_v16_load(lane_number), rt_v16_all((float)column));
            uint32_t in = rt_raster_first_lanes((uint32_t)(last - column + 1));
            for (uint32_t e = 0; e < outline->edges; e++) {
                in &= rt_v16_at_most(rt_v16_all(0), line_at(outline->inside[e], x, (float)row));
            }
            _Alignas(64) float depth[16];
            rt_v16_store(depth, rt_v16_div(rt_v16_all(1), line_at(outline->face, x, (float)row)));
            for (; in; in &= in - 1) {
                int lane = __builtin_ctz(in);
                float *corner = &draft->corner[row][column + lane];
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

/* The parts of a cell that no line separates from the object. */
RT_KERNEL uint32_t parts_of(const RtLightOutline *outline, const RtLightCells *at, int column, int row) {
    uint32_t parts = parts_within(at, column, row);
    RtV16 x = rt_v16_add(part_middles(rt_raster_column), rt_v16_all((float)column));
    RtV16 y = rt_v16_add(part_middles(rt_raster_row), rt_v16_all((float)row));
    for (uint32_t e = 0; e < outline->count; e++) {
        const float *line = outline->parts[e];
        RtV16 on = rt_v16_add(rt_v16_mul(rt_v16_all(line[0]), x), rt_v16_mul(rt_v16_all(line[1]), y));
        parts &= rt_v16_at_most(rt_v16_all(RT_LIGHT_NARROWER - line[2]), on);
    }
    return parts;
}

static void draw_outline(const RtLightTile *tile, const RtLightOutline *outline, const RtLightFootprint *from,
                         const RtLightCells *at, RtRef object, RtLightDraft *draft) {
    const RtLightGrid *grid = tile->on.grid;
    const uint32_t before = draft->count;
    const RtV16 nearest = rt_v16_all(from->near), flattest = rt_v16_all(1 / from->far);
    for (int row = at->lo[1]; row <= at->hi[1]; row++) {
        for (int column = at->lo[0]; column <= at->hi[0]; column += 16) {
            RtV16 middle = rt_v16_add(rt_v16_load(lane_number), rt_v16_all((float)column + 0.5f));
            uint32_t in = rt_raster_first_lanes((uint32_t)(at->hi[0] - column + 1));
            for (uint32_t e = 0; e < outline->count; e++) {
                in &= rt_v16_at_most(rt_v16_all(0), line_at(outline->parts[e], middle, (float)row + 0.5f));
            }
            if (!in) continue;
            RtV16 slope = rt_v16_max(line_at(outline->slope, middle, (float)row + 0.5f), flattest);
            RtV16 near = rt_v16_max(rt_v16_div(rt_v16_all(1 - 0x1p-20f), slope), nearest);
            const float *cover = &draft->cover[row][column];
            uint32_t covered =
                in & ~rt_v16_at_most(near, rt_v16_join(cover, cover + 4, cover + 8, cover + 12));
            draft->cut[row] |= (uint64_t)covered << column;
            uint32_t depth[16];
            rt_w16_put(depth, depth_steps(grid, near));
            for (in &= ~covered; in; in &= in - 1) {
                int lane = __builtin_ctz(in);
                uint32_t parts = parts_of(outline, at, column + lane, row);
                if (!parts) continue;
                draft->cell[draft->count] = (uint32_t)row * tile->n + (uint32_t)(column + lane);
                draft->key[draft->count++] = depth[lane] << 16 | parts;
            }
        }
    }
    add_run(draft, object, before);
}

#endif
