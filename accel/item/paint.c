/* SPDX-License-Identifier: Apache-2.0 */
/* What is left of a tile where vectors leave off: samples at which it is open what is nearest, and objects
 * that are not flat.
 *
 * With `settle` the objects' own hit functions are asked there, with the very ray that will be traced: their
 * t is exact. Without, such samples stay undecided, as in 1984. */
#include "accel/item/raster.h"
#include "accel/kernel.h"

/* Where along the ray of a sample an object is hit, if it is: at lo <= 1 / t <= hi. */
typedef struct Span {
    float lo, hi;
    float t; /* where its hit function was asked, else -1 */
} Span;

static uint32_t column_of(const RtItemPainter *p, uint32_t block, uint32_t lane) {
    return p->column + block % (RT_ITEM_TILE / RT_ITEM_BLOCK) * RT_ITEM_BLOCK + lane % RT_ITEM_BLOCK;
}

static uint32_t row_of(const RtItemPainter *p, uint32_t block, uint32_t lane) {
    return p->row + block / (RT_ITEM_TILE / RT_ITEM_BLOCK) * RT_ITEM_BLOCK + lane / RT_ITEM_BLOCK;
}

/* What is not in the image is as if it were hidden. */
static void hide_outside(RtItemPainter *p, uint32_t block) {
    RtItemTile *tile = &p->tile;
    tile->least[block] = INFINITY;
    for (uint32_t lane = 0; lane < RT_ITEM_LANES; lane++) {
        if (column_of(p, block, lane) >= p->column + p->columns || row_of(p, block, lane) >= p->row + p->rows)
            tile->lo[block][lane] = tile->hi[block][lane] = INFINITY;
        tile->least[block] = rt_minf(tile->lo[block][lane], tile->least[block]);
    }
}

void rt_item_begin_tile(RtItemPainter *p, size_t at) {
    const RtSampling *s = &p->buffer->view.sampling;
    uint32_t across = rt_item_tiles_across(p->buffer);
    p->column = (uint32_t)(at % across) * RT_ITEM_TILE;
    p->row = (uint32_t)(at / across) * RT_ITEM_TILE;
    p->columns = s->columns - p->column < RT_ITEM_TILE ? s->columns - p->column : RT_ITEM_TILE;
    p->rows = s->rows - p->row < RT_ITEM_TILE ? s->rows - p->row : RT_ITEM_TILE;
    p->nearest = rt_float_above((1 + 0x1p-20) / (double)(float)p->buffer->view.near);
    RtItemTile *tile = &p->tile;
    const bool whole = p->columns == RT_ITEM_TILE && p->rows == RT_ITEM_TILE;
    for (uint32_t block = 0; block < RT_ITEM_BLOCKS; block++) {
        for (uint32_t lane = 0; lane < RT_ITEM_LANES; lane++) {
            tile->id[block][lane] = RT_NO_OBJECT;
            tile->lo[block][lane] = tile->hi[block][lane] = -1;
            tile->t[block][lane] = tile->other[block][lane] = -1;
        }
        tile->least[block] = -1;
        if (!whole) hide_outside(p, block);
    }
}

/* ---- one sample ---- */

/* Makes a span exact; false if the ray misses the object. */
static bool ask(RtItemPainter *p, uint32_t block, uint32_t lane, uint32_t id, Span *span) {
    if (span->t >= 0) return true;
    const RtGeometry *g = &p->buffer->isa.base.scene->geometry;
    RtRay ray = rt_view_ray(&p->buffer->view, column_of(p, block, lane), row_of(p, block, lane));
    RtPreparedRay prepared;
    rt_hit_ray(&prepared, g, &ray, p->room);
    RtHit hit = RT_MISS;
    rt_test_object(g, id, &prepared, false, &hit, &p->tally);
    double w = 1 / fabs((double)hit.t); /* -0 is 0 */
    *span = (Span){rt_float_below(w), rt_float_above(w), fabsf(hit.t)};
    return hit.object != RT_NO_OBJECT;
}

static void note_other(RtItemTile *tile, uint32_t block, uint32_t lane, float hi) {
    tile->other[block][lane] = rt_maxf(tile->other[block][lane], hi);
}

static void name(RtItemTile *tile, uint32_t block, uint32_t lane, uint32_t id, Span span) {
    tile->id[block][lane] = id;
    tile->lo[block][lane] = span.lo;
    tile->hi[block][lane] = span.hi;
    tile->t[block][lane] = span.t;
    tile->least[block] = tile->lo[block][0];
    for (uint32_t i = 1; i < RT_ITEM_LANES; i++)
        tile->least[block] = rt_minf(tile->lo[block][i], tile->least[block]);
}

void rt_item_doubt(RtItemPainter *p, uint32_t block, uint32_t lane, uint32_t id, float lo, float hi,
                   bool certain) {
    RtItemTile *tile = &p->tile;
    Span span = {lo, hi, -1}, seen = {tile->lo[block][lane], tile->hi[block][lane], tile->t[block][lane]};
    bool named = tile->id[block][lane] != RT_NO_OBJECT;
    if (p->buffer->settle) {
        if (!certain && !ask(p, block, lane, id, &span)) return;
        if (named && span.hi < seen.lo) return;
        if (named && span.lo <= seen.hi) {
            if (!ask(p, block, lane, tile->id[block][lane], &seen)) {
                note_other(tile, block, lane, INFINITY); /* it was to be hit: leave it open */
                return;
            }
            bool hit = ask(p, block, lane, id, &span);
            if (!hit || seen.t < span.t || (seen.t == span.t && tile->id[block][lane] < id)) {
                name(tile, block, lane, tile->id[block][lane], seen);
                return;
            }
        }
        name(tile, block, lane, id, span);
        return;
    }
    if (!certain || (named && span.lo <= seen.lo)) {
        note_other(tile, block, lane, hi);
        return;
    }
    if (named) note_other(tile, block, lane, seen.hi);
    name(tile, block, lane, id, span);
}

/* ---- objects with curves, or concave ---- */

/* Wherever it may be nearest it is asked for, or in doubt. */
static void paint_footprint(RtItemPainter *p, uint32_t id, const RtItemFootprint *at) {
    uint32_t end[2] = {p->column + p->columns - 1, p->row + p->rows - 1};
    float most = rt_float_above(1 / (double)at->near);
    for (uint32_t row = at->lo[1] > p->row ? at->lo[1] : p->row; row <= at->hi[1] && row <= end[1]; row++) {
        uint32_t down = row - p->row, column = at->lo[0] > p->column ? at->lo[0] : p->column;
        for (; column <= at->hi[0] && column <= end[0]; column++) {
            uint32_t right = column - p->column;
            uint32_t block = down / RT_ITEM_BLOCK * (RT_ITEM_TILE / RT_ITEM_BLOCK) + right / RT_ITEM_BLOCK;
            uint32_t lane = down % RT_ITEM_BLOCK * RT_ITEM_BLOCK + right % RT_ITEM_BLOCK;
            if (most >= p->tile.lo[block][lane]) rt_item_doubt(p, block, lane, id, 0, most, false);
        }
    }
}

void rt_item_paint_curved(RtItemPainter *p, uint32_t id) {
    RtItemFootprint at;
    RtItemFacets facet;
    uint32_t edges;
    if (!rt_item_footprint(p->buffer, id, &at)) return;
    if (rt_item_polygon(p, id, &at, &facet, &edges))
        p->buffer->painting->paint_facet(p, &facet, edges);
    else
        paint_footprint(p, id, &at);
}

/* ---- the end of a tile ---- */

/* Where the nearest object is not known for certain, none is named. */
void rt_item_end_tile(RtItemPainter *p) {
    const RtItemTile *tile = &p->tile;
    const size_t columns = p->buffer->view.sampling.columns;
    uint32_t *corner = p->buffer->samples + (size_t)p->row * columns + p->column;
    for (uint32_t row = 0; row < p->rows; row++) {
        uint32_t first = row / RT_ITEM_BLOCK * (RT_ITEM_TILE / RT_ITEM_BLOCK);
        for (uint32_t column = 0; column < p->columns; column++) {
            uint32_t block = first + column / RT_ITEM_BLOCK;
            uint32_t lane = row % RT_ITEM_BLOCK * RT_ITEM_BLOCK + column % RT_ITEM_BLOCK;
            float other = tile->other[block][lane];
            bool open = other >= 0 && other >= tile->lo[block][lane];
            corner[row * columns + column] = open ? RT_ITEM_UNDECIDED : tile->id[block][lane];
        }
    }
}
