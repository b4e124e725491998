/* SPDX-License-Identifier: Apache-2.0 */
/* Drawing on the cells of a light: small triangles by RT_LANES corners or parts of cells at a time, other
 * objects by their outline and RT_LANES cells of a row. Included once for each instruction set.
 *
 * Lines. Coordinates are columns and rows from the corner of a tile. A line through two vertices, evaluated
 * in the middle of a cell, is off by a few 2^-24 of the sum of |coefficient| * 2^7, because a small triangle
 * with a cell in the tile and all of the tile are within 2^7: far less than SLACK = 2^-6 of it. If rounding
 * turns the triangle over, its area is less than that, and its lines exclude nothing that they should not. */
#ifndef RT_ACCEL_LIGHT_LIGHT_DRAW_H
#define RT_ACCEL_LIGHT_LIGHT_DRAW_H

#include "accel/light/light_project.h"

/* ---- small triangles in a tile ---- */

/* RT_LANES triangles, to be drawn one by one. Lines and rectangles are from the corner of the tile. */
typedef struct Small {
    float line[3][3][RT_LANES]; /* edge; x, y and 1; `inside` is where all are >= 0 */
    float around[3][RT_LANES];  /* what is added for the part of a cell about a point */
    float near[RT_LANES], far[RT_LANES];
    uint32_t depth[RT_LANES];
    uint32_t lo[2][RT_LANES], hi[2][RT_LANES];   /* cells of the tile; none where lo > hi */
    float least[2][RT_LANES], most[2][RT_LANES]; /* the rectangle */
    uint32_t large;                              /* those that are not small */
} Small;

RT_KERNEL void prepare_small(const RtLightTile *tile, const RtRef *triangles, uint32_t count, Small *s) {
    const RtLightGrid *grid = tile->on.grid;
    const Center center = make_center(&tile->on);
    RtFloats v[3][3];
    Projected p;
    rt_raster_gather(tile->on.geometry, triangles, count, v);
    subtract_center(&center, v);
    project(&center, grid, tile->on.face, tile->n, tile->column * tile->n, tile->row * tile->n, v, &p);
    s->large = ~p.small & rt_raster_first_lanes(count);

    RtFloats abx = p.x[1] - p.x[0], aby = p.y[1] - p.y[0];
    RtFloats acx = p.x[2] - p.x[0], acy = p.y[2] - p.y[0];
    RtFloats area = abx * acy - aby * acx;
    RtFloats sign = rt_select((RtInts)area < 0, rt_all(-1), rt_all(1));
    const RtFloats half = 0.5f / RT_LIGHT_PART + p.grow;
    for (int i = 0; i < 3; i++) {
        int k = (i + 1) % 3;
        RtFloats nx = (p.y[i] - p.y[k]) * sign;
        RtFloats ny = (p.x[k] - p.x[i]) * sign;
        RtFloats c = nx * p.x[i] + ny * p.y[i];
        rt_store(s->line[i][0], nx);
        rt_store(s->line[i][1], ny);
        rt_store(s->line[i][2], -c);
        rt_store(s->around[i], (rt_abs(nx) + rt_abs(ny)) * half);
    }
    rt_store(s->depth, depth_steps(grid, p.near));
    rt_store(s->near, p.near);
    rt_store(s->far, p.far);
    for (int k = 0; k < 2; k++) {
        RtInts lo = rt_to_ints(rt_floor(p.lo[k])), hi = rt_to_ints(rt_floor(p.hi[k]));
        /* The rectangle may miss the tile: then lo > hi, below or above. */
        rt_store(s->lo[k], rt_max(lo, rt_all_ints(0)));
        rt_store(s->hi[k], rt_min(hi, rt_all_ints((int32_t)(tile->n - 1))));
        rt_store(s->least[k], p.lo[k]);
        rt_store(s->most[k], p.hi[k]);
    }
}

/* The lanes of the first `columns` of four columns, and of the first `rows` of RT_GROUPS rows. */
RT_KERNEL uint32_t lanes_of(uint32_t columns, uint32_t rows) {
    uint32_t row = columns < 4 ? (1u << columns) - 1 : 15;
    return row * 0x1111 & rt_raster_first_lanes(rows < RT_GROUPS ? 4 * rows : RT_LANES);
}

RT_KERNEL uint32_t inside_lines(const Small *s, uint32_t i, RtFloats x, RtFloats y) {
    RtFloats worst = rt_all(INFINITY);
    for (int e = 0; e < 3; e++) {
        RtFloats at = s->line[e][0][i] * x + s->line[e][1][i] * y;
        worst = rt_min(at + s->line[e][2][i], worst);
    }
    return rt_le_bits(rt_all(0), worst);
}

RT_KERNEL uint32_t cover_small(const RtLightTile *tile, const RtRef *triangles, uint32_t count,
                               RtLightDraft *draft) {
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
        for (int row = lo[1]; row <= hi[1]; row += RT_GROUPS) {
            for (int column = lo[0]; column <= hi[0]; column += 4) {
                RtFloats x = rt_raster_columns((float)column), y = rt_raster_rows((float)row);
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

/* Middles of the 4 x 4 parts of the cell (0, 0), from the part at (column, row) on. */
enum { CELL_PARTS = RT_LIGHT_PART * RT_LIGHT_PART };
RT_KERNEL RtFloats part_middles(RtFloats parts) {
    return parts * (1.0f / RT_LIGHT_PART) + 0.125f;
}

/* The parts of a cell where no line has a value below 0. `moved`: what is added to the values `at`, those of
 * the parts of cell (0, 0). */
RT_KERNEL uint32_t parts_inside(const RtFloats at[3], const float moved[3]) {
    RtFloats worst = rt_all(INFINITY);
    for (int e = 0; e < 3; e++) worst = rt_min(at[e] + moved[e], worst);
    return rt_le_bits(rt_all(0), worst);
}

RT_KERNEL uint32_t draw_small(const RtLightTile *tile, const RtRef *triangles, uint32_t count,
                              RtLightDraft *draft) {
    enum { VECTORS = CELL_PARTS / RT_LANES };
    Small s;
    prepare_small(tile, triangles, count, &s);
    const RtFloats x = part_middles(rt_raster_columns(0));
    RtFloats y[VECTORS];
    for (int i = 0; i < VECTORS; i++) y[i] = part_middles(rt_raster_rows((float)(i * RT_GROUPS)));
    for (uint32_t i = 0; i < count; i++) {
        if (s.large >> i & 1) continue;
        const uint32_t before = draft->count;
        const int last_column = (int)s.hi[0][i], last_row = (int)s.hi[1][i];
        RtFloats at[VECTORS][3]; /* in the parts of cell (0, 0) */
        for (int v = 0; v < VECTORS; v++) {
            for (int e = 0; e < 3; e++) {
                at[v][e] = s.line[e][0][i] * x + s.line[e][1][i] * y[v];
                at[v][e] += s.line[e][2][i] + s.around[e][i];
            }
        }
        /* The lines of slivers leave parts beyond the rectangle. */
        const float least_x = s.least[0][i] - 0.125f, most_x = s.most[0][i] + 0.125f;
        const float least_y = s.least[1][i] - 0.125f, most_y = s.most[1][i] + 0.125f;
        for (int row = (int)s.lo[1][i]; row <= last_row; row++) {
            uint32_t rows[VECTORS];
            for (int v = 0; v < VECTORS; v++) {
                RtFloats part_row = y[v] + (float)row;
                rows[v] = rt_bits((part_row >= least_y) & (part_row <= most_y));
            }
            for (int column = (int)s.lo[0][i]; column <= last_column; column++) {
                if (s.near[i] > draft->cover[row][column]) { /* even if it is not in the cell */
                    draft->cut[row] |= UINT64_C(1) << column;
                    continue;
                }
                float moved[3];
                for (int e = 0; e < 3; e++)
                    moved[e] = s.line[e][0][i] * (float)column + s.line[e][1][i] * (float)row;
                RtFloats part_column = x + (float)column;
                uint32_t columns = rt_bits((part_column >= least_x) & (part_column <= most_x)), parts = 0;
                for (int v = 0; v < VECTORS; v++)
                    parts |= (rows[v] & columns & parts_inside(at[v], moved)) << v * RT_LANES;
                if (!parts) continue;
                draft->cell[draft->count] = (uint32_t)row * tile->n + (uint32_t)column;
                draft->key[draft->count++] = s.depth[i] << 16 | parts;
            }
        }
        add_run(draft, triangles[i], before);
    }
    return s.large;
}

#define DEFINE_BY_LANES(name, function)                                                                      \
    static uint32_t name(const RtLightTile *tile, const RtRef *triangles, uint32_t count,                    \
                         RtLightDraft *draft) {                                                              \
        uint32_t large = 0;                                                                                  \
        for (uint32_t i = 0; i < count; i += RT_LANES) {                                                     \
            uint32_t n = count - i < RT_LANES ? count - i : RT_LANES;                                        \
            large |= function(tile, triangles + i, n, draft) << i;                                           \
        }                                                                                                    \
        return large;                                                                                        \
    }
DEFINE_BY_LANES(cover, cover_small)
DEFINE_BY_LANES(draw, draw_small)

/* ---- RT_LANES cells of a row, and one object ---- */

/* `from`, and one more in each lane. */
RT_KERNEL RtFloats counted_from(float from) {
    return rt_to_floats(rt_lane_numbers()) + from;
}

RT_KERNEL RtFloats line_at(const float line[3], RtFloats x, float y) {
    return line[0] * x + (line[1] * y + line[2]);
}

static void cover_outline(const RtLightOutline *outline, const RtLightCells *at, RtLightDraft *draft) {
    if (!outline->covers) return;
    const int last = at->hi[0] + 1; /* a cell more: its corner is that of the cell before, too */
    for (int row = at->lo[1]; row <= at->hi[1] + 1; row++) {
        for (int column = at->lo[0]; column <= last; column += RT_LANES) {
            RtFloats x = counted_from((float)column);
            uint32_t in = rt_raster_first_lanes((uint32_t)(last - column + 1));
            for (uint32_t e = 0; e < outline->edges; e++)
                in &= rt_le_bits(rt_all(0), line_at(outline->inside[e], x, (float)row));
            float depth[RT_LANES];
            rt_store(depth, 1 / line_at(outline->face, x, (float)row));
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
    const RtFloats x = part_middles(rt_raster_columns(0)) + (float)column;
    for (uint32_t i = 0; i < CELL_PARTS; i += RT_LANES) {
        const uint32_t first = i / RT_LIGHT_PART; /* row of parts */
        RtFloats y = part_middles(rt_raster_rows((float)first)) + (float)row;
        uint32_t in = ~0u;
        for (uint32_t e = 0; e < outline->count; e++) {
            const float *line = outline->parts[e];
            in &= rt_le_bits(rt_all(RT_LIGHT_NARROWER - line[2]), line[0] * x + line[1] * y);
        }
        parts &= ~(((1u << RT_LANES) - 1) << i) | in << i;
    }
    return parts;
}

static void draw_outline(const RtLightTile *tile, const RtLightOutline *outline, const RtLightFootprint *from,
                         const RtLightCells *at, RtRef object, RtLightDraft *draft) {
    const RtLightGrid *grid = tile->on.grid;
    const uint32_t before = draft->count;
    const RtFloats nearest = rt_all(from->near), flattest = rt_all(1 / from->far);
    for (int row = at->lo[1]; row <= at->hi[1]; row++) {
        for (int column = at->lo[0]; column <= at->hi[0]; column += RT_LANES) {
            RtFloats middle = counted_from((float)column + 0.5f);
            uint32_t in = rt_raster_first_lanes((uint32_t)(at->hi[0] - column + 1));
            for (uint32_t e = 0; e < outline->count; e++)
                in &= rt_le_bits(rt_all(0), line_at(outline->parts[e], middle, (float)row + 0.5f));
            if (!in) continue;
            RtFloats slope = rt_max(line_at(outline->slope, middle, (float)row + 0.5f), flattest);
            RtFloats near = rt_max((1 - 0x1p-20f) / slope, nearest);
            const float *cover = &draft->cover[row][column];
            uint32_t covered = in & ~rt_le_bits(near, rt_loadu(cover));
            draft->cut[row] |= (uint64_t)covered << column;
            uint32_t depth[RT_LANES];
            rt_store(depth, depth_steps(grid, near));
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
