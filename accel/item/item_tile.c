/* SPDX-License-Identifier: Apache-2.0 */
/* What a tile needs beside vectors: samples at which it is open which object is nearest, and objects that are
 * no triangles.
 *
 * With `settle` the objects' own hit functions are called there, with the very ray that will be traced: their
 * t is exact. Without, such samples stay undecided, as in 1984. */
#include "accel/item/item.h"
#include "accel/kernel.h"

#include <string.h>

/* The ray of a sample hits an object, if at all, at lo <= 1 / t <= hi. */
typedef struct Span {
    float lo, hi;
    float t; /* if its hit function was asked, else -1 */
} Span;

/* Column and row of a sample in the tile, and back. */
static uint32_t column_of(uint32_t sample) {
    return sample / RT_ITEM_BLOCK_SAMPLES % RT_ITEM_ACROSS * RT_ITEM_BLOCK + sample % RT_ITEM_BLOCK;
}

static uint32_t row_of(uint32_t sample) {
    uint32_t block_row = sample / (RT_ITEM_BLOCK_SAMPLES * RT_ITEM_ACROSS);
    return block_row * RT_ITEM_BLOCK + sample / RT_ITEM_BLOCK % RT_ITEM_BLOCK;
}

static uint32_t sample_at(uint32_t column, uint32_t row) {
    uint32_t block = row / RT_ITEM_BLOCK * RT_ITEM_ACROSS + column / RT_ITEM_BLOCK;
    return block * RT_ITEM_BLOCK_SAMPLES + row % RT_ITEM_BLOCK * RT_ITEM_BLOCK + column % RT_ITEM_BLOCK;
}

static void update_least(RtItemTile *tile, uint32_t block) {
    const float *lo = &tile->lo[(size_t)block * RT_ITEM_BLOCK_SAMPLES];
    tile->least[block] = lo[0];
    for (uint32_t i = 1; i < RT_ITEM_BLOCK_SAMPLES; i++)
        tile->least[block] = rt_minf(lo[i], tile->least[block]);
}

static uint32_t lesser(uint32_t a, uint32_t b) {
    return a < b ? a : b;
}

void rt_item_begin_tile(RtItemDrawing *d, size_t at) {
    const RtSampling *s = &d->buffer->view.sampling;
    uint32_t across = rt_item_tiles(s->columns);
    d->column = (uint32_t)(at % across) * RT_ITEM_TILE;
    d->row = (uint32_t)(at / across) * RT_ITEM_TILE;
    d->columns = lesser(s->columns - d->column, RT_ITEM_TILE);
    d->rows = lesser(s->rows - d->row, RT_ITEM_TILE);
    d->nearest = rt_float_above((1 + 0x1p-20) / (double)(float)d->buffer->view.near);
    RtItemTile *tile = &d->tile;
    for (uint32_t i = 0; i < RT_ITEM_TILE_SAMPLES; i++) {
        tile->id[i] = RT_NO_OBJECT;
        tile->lo[i] = tile->hi[i] = tile->t[i] = tile->other[i] = -1;
    }
    for (uint32_t block = 0; block < RT_ITEM_BLOCKS; block++) tile->least[block] = -1;
    if (d->columns == RT_ITEM_TILE && d->rows == RT_ITEM_TILE) return;
    /* Samples outside of the image are as if hidden. */
    for (uint32_t i = 0; i < RT_ITEM_TILE_SAMPLES; i++) {
        if (column_of(i) >= d->columns || row_of(i) >= d->rows) tile->lo[i] = tile->hi[i] = INFINITY;
    }
    for (uint32_t block = 0; block < RT_ITEM_BLOCKS; block++) update_least(tile, block);
}

/* ---- one sample ---- */

/* Makes a span exact; false if the ray misses the object. */
static bool ask(RtItemDrawing *d, uint32_t sample, uint32_t id, Span *span) {
    if (span->t >= 0) return true;
    const RtGeometry *g = rt_item_geometry(d->buffer);
    RtRay ray = rt_view_ray(&d->buffer->view, d->column + column_of(sample), d->row + row_of(sample));
    RtPreparedRay prepared;
    rt_hit_ray(&prepared, g, &ray, d->crossings);
    RtHit hit = RT_MISS;
    rt_test_object(g, id, &prepared, false, &hit, &d->tally);
    double w = 1 / fabs((double)hit.t); /* -0 is 0 */
    *span = (Span){rt_float_below(w), rt_float_above(w), fabsf(hit.t)};
    return hit.object != RT_NO_OBJECT;
}

static void note_other(RtItemTile *tile, uint32_t sample, float hi) {
    tile->other[sample] = rt_maxf(tile->other[sample], hi);
}

static void name(RtItemTile *tile, uint32_t sample, uint32_t id, Span span) {
    tile->id[sample] = id;
    tile->lo[sample] = span.lo;
    tile->hi[sample] = span.hi;
    tile->t[sample] = span.t;
    update_least(tile, sample / RT_ITEM_BLOCK_SAMPLES);
}

void rt_item_resolve(RtItemDrawing *d, uint32_t sample, uint32_t id, float lo, float hi, bool certain) {
    RtItemTile *tile = &d->tile;
    Span span = {lo, hi, -1}, named_span = {tile->lo[sample], tile->hi[sample], tile->t[sample]};
    const uint32_t named = tile->id[sample];
    const bool is_named = named != RT_NO_OBJECT;
    if (!d->buffer->settle) {
        if (!certain || (is_named && span.lo <= named_span.lo)) {
            note_other(tile, sample, hi);
            return;
        }
        if (is_named) note_other(tile, sample, named_span.hi);
        name(tile, sample, id, span);
        return;
    }
    if (!certain && !ask(d, sample, id, &span)) return;
    if (is_named && span.hi < named_span.lo) return;
    if (is_named && span.lo <= named_span.hi) {
        if (!ask(d, sample, named, &named_span)) {
            note_other(tile, sample, INFINITY); /* it was certain to be hit: leave the sample open */
            return;
        }
        bool hit = ask(d, sample, id, &span);
        if (!hit || named_span.t < span.t || (named_span.t == span.t && named < id)) {
            name(tile, sample, named, named_span);
            return;
        }
    }
    name(tile, sample, id, span);
}

/* ---- objects that are no triangles ---- */

/* It is resolved wherever it may be nearest. */
static void draw_footprint(RtItemDrawing *d, uint32_t id, const RtItemFootprint *at) {
    const uint32_t corner[2] = {d->column, d->row}, count[2] = {d->columns, d->rows};
    uint32_t lo[2], end[2];
    float most = rt_float_above(1 / (double)at->near);
    for (int a = 0; a < 2; a++) {
        lo[a] = at->lo[a] > corner[a] ? at->lo[a] - corner[a] : 0;
        end[a] = lesser(at->hi[a] + 1 - corner[a], count[a]);
    }
    for (uint32_t row = lo[1]; row < end[1]; row++) {
        for (uint32_t column = lo[0]; column < end[0]; column++) {
            uint32_t sample = sample_at(column, row);
            if (most >= d->tile.lo[sample]) rt_item_resolve(d, sample, id, 0, most, false);
        }
    }
}

void rt_item_draw_object(RtItemDrawing *d, uint32_t id) {
    RtItemFootprint at;
    RtItemFacets facet;
    uint32_t edges;
    if (!rt_item_footprint(d->buffer, id, &at)) return;
    if (rt_item_polygon(d, id, &at, &facet, &edges))
        d->buffer->raster->draw_facet(d, &facet, edges);
    else
        draw_footprint(d, id, &at);
}

/* ---- the end of a tile ---- */

/* Where the nearest object is not known for certain, none is named. */
void rt_item_end_tile(RtItemDrawing *d) {
    RtItemTile *tile = &d->tile;
    const size_t columns = d->buffer->view.sampling.columns;
    uint32_t *corner = d->buffer->samples + d->row * columns + d->column;
    for (uint32_t i = 0; i < RT_ITEM_TILE_SAMPLES; i++) {
        bool open = (tile->other[i] >= 0) & (tile->other[i] >= tile->lo[i]);
        tile->id[i] = open ? RT_ITEM_UNDECIDED : tile->id[i];
    }
    for (uint32_t row = 0; row < d->rows; row++) {
        for (uint32_t column = 0; column < d->columns; column += RT_ITEM_BLOCK) {
            uint32_t some = lesser(d->columns - column, RT_ITEM_BLOCK);
            memcpy(&corner[row * columns + column], &tile->id[sample_at(column, row)], some * sizeof *corner);
        }
    }
}
