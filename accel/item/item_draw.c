/* SPDX-License-Identifier: Apache-2.0 */
/* Drawing all objects: they are sorted into the tiles of the image that they may be seen in, by class of
 * depth (accel/raster/bins.h), then each tile is drawn by one thread. Objects that are in many tiles are kept
 * in a list of their own, which every tile draws first: so no list is long, and large objects hide others.
 *
 * Neither the samples nor the hit functions asked depend on the number of threads. */
#include "accel/item/item.h"
#include "accel/kernel.h"
#include "core/base/memory.h"
#include "core/base/parallel.h"

#include <stdlib.h>

enum { MANY_TILES = 64 }; /* of an object that is kept apart */

typedef struct Drawing {
    RtItemBuffer *buffer;
    RtBins bins;
    RtItemTile *tiles; /* [threads] */
} Drawing;

static uint32_t lesser(uint32_t a, uint32_t b) {
    return a < b ? a : b;
}

/* ---- one tile ---- */

/* A sample by its column and row in the tile. */
static uint32_t sample_at(uint32_t column, uint32_t row) {
    uint32_t block = row / RT_ITEM_BLOCK * RT_ITEM_ACROSS + column / RT_ITEM_BLOCK;
    return block * RT_ITEM_BLOCK_SAMPLES + row % RT_ITEM_BLOCK * RT_ITEM_BLOCK + column % RT_ITEM_BLOCK;
}

static void begin_tile(RtItemTile *tile, size_t at) {
    const RtItemBuffer *buffer = tile->buffer;
    const RtSampling *s = &buffer->view.sampling;
    uint32_t across = rt_item_tiles(s->columns);
    tile->column = (uint32_t)(at % across) * RT_ITEM_TILE;
    tile->row = (uint32_t)(at / across) * RT_ITEM_TILE;
    tile->columns = lesser(s->columns - tile->column, RT_ITEM_TILE);
    tile->rows = lesser(s->rows - tile->row, RT_ITEM_TILE);
    for (uint32_t row = 0; row < RT_ITEM_TILE; row++) {
        for (uint32_t column = 0; column < RT_ITEM_TILE; column++) {
            const uint32_t i = sample_at(column, row);
            rt_store_float4(tile->dir[i], rt_round4(buffer->columns[tile->column + column] +
                                                    buffer->rows[tile->row + row]));
            tile->t[i] = column < tile->columns && row < tile->rows ? INFINITY : -1;
            tile->id[i] = RT_NO_OBJECT;
        }
    }
    for (uint32_t block = 0; block < RT_ITEM_BLOCKS; block++) tile->farthest[block] = INFINITY;
}

void rt_item_update_farthest(RtItemTile *tile, uint32_t block) {
    const float *t = &tile->t[(size_t)block * RT_ITEM_BLOCK_SAMPLES];
    tile->farthest[block] = t[0];
    for (uint32_t i = 1; i < RT_ITEM_BLOCK_SAMPLES; i++)
        tile->farthest[block] = rt_maxf(t[i], tile->farthest[block]);
}

/* Tests the samples of a block that are in columns lo[0]..end[0]-1 and rows lo[1]..end[1]-1 of the tile. */
static void draw_block(RtItemTile *tile, uint32_t block, const RtItemFootprint *at, uint32_t id,
                       const uint32_t lo[2], const uint32_t end[2]) {
    const RtGeometry *g = rt_item_geometry(tile->buffer);
    const uint32_t left = block % RT_ITEM_ACROSS * RT_ITEM_BLOCK,
                   top = block / RT_ITEM_ACROSS * RT_ITEM_BLOCK;
    RtRay ray = rt_view_ray(&tile->buffer->view, tile->column, tile->row);
    for (uint32_t k = 0; k < RT_ITEM_BLOCK_SAMPLES; k++) {
        const uint32_t i = block * RT_ITEM_BLOCK_SAMPLES + k;
        const uint32_t column = left + k % RT_ITEM_BLOCK, row = top + k / RT_ITEM_BLOCK;
        RtHit nearest = {tile->t[i], tile->id[i]};
        if (column < lo[0] || column >= end[0] || row < lo[1] || row >= end[1] || at->near > nearest.t)
            continue;
        ray.dir = rt_vec3(tile->dir[i][0], tile->dir[i][1], tile->dir[i][2]);
        RtPreparedRay prepared;
        rt_hit_ray(&prepared, g, &ray, tile->crossings);
        rt_test_object(g, id, &prepared, false, &nearest, &tile->tally);
        tile->t[i] = nearest.t;
        tile->id[i] = nearest.object;
    }
    rt_item_update_farthest(tile, block);
}

void rt_item_draw_object(RtItemTile *tile, uint32_t id) {
    const uint32_t corner[2] = {tile->column, tile->row}, count[2] = {tile->columns, tile->rows};
    uint32_t lo[2], end[2];
    RtItemFootprint at;
    if (!rt_item_footprint(tile->buffer, id, &at)) return;
    for (int a = 0; a < 2; a++) {
        lo[a] = at.lo[a] > corner[a] ? at.lo[a] - corner[a] : 0;
        end[a] = lesser(at.hi[a] + 1 - corner[a], count[a]);
    }
    for (uint32_t row = lo[1] / RT_ITEM_BLOCK; row * RT_ITEM_BLOCK < end[1]; row++) {
        for (uint32_t column = lo[0] / RT_ITEM_BLOCK; column * RT_ITEM_BLOCK < end[0]; column++) {
            const uint32_t block = row * RT_ITEM_ACROSS + column;
            if (at.near <= tile->farthest[block]) draw_block(tile, block, &at, id, lo, end);
        }
    }
}

/* Writes the tile into the image. */
static void end_tile(const RtItemTile *tile) {
    const size_t columns = tile->buffer->view.sampling.columns;
    uint32_t *corner = tile->buffer->samples + tile->row * columns + tile->column;
    for (uint32_t row = 0; row < tile->rows; row++) {
        for (uint32_t column = 0; column < tile->columns; column++)
            corner[row * columns + column] = tile->id[sample_at(column, row)];
    }
}

static RtStatus draw_tile(void *context, size_t item, int thread, RtError *error) {
    enum { SOME = 64 }; /* large objects drawn at once */
    (void)error;
    const Drawing *drawing = context;
    const RtBins *bins = &drawing->bins;
    const RtItemRaster *raster = drawing->buffer->raster;
    RtItemTile *tile = &drawing->tiles[thread];
    const size_t *first = &bins->first[item * RT_ITEM_CLASSES];
    RtRef large[SOME];
    size_t count = 0;
    begin_tile(tile, item);
    const uint32_t x = tile->column / RT_ITEM_TILE, y = tile->row / RT_ITEM_TILE;
    for (size_t i = 0; i < bins->large_count; i++) {
        const RtTileRange *range = &bins->large[i];
        if (x < range->lo[0] || x > range->hi[0] || y < range->lo[1] || y > range->hi[1]) continue;
        large[count++] = range->object;
        if (count < SOME) continue;
        raster->draw(tile, large, count);
        count = 0;
    }
    raster->draw(tile, large, count);
    raster->draw(tile, bins->objects + first[0], first[RT_ITEM_CLASSES] - first[0]);
    end_tile(tile);
    return RT_OK;
}

/* ---- all of them ---- */

void rt_item_place(const RtItemBuffer *buffer, RtRef object, const RtItemFootprint *at, RtTileRange *to) {
    to->object = object;
    to->layer = 0;
    while (to->layer < RT_ITEM_CLASSES - 1 && at->near >= buffer->farther[to->layer]) to->layer++;
    for (int a = 0; a < 2; a++) {
        to->lo[a] = (uint16_t)(at->lo[a] / RT_ITEM_TILE);
        to->hi[a] = (uint16_t)(at->hi[a] / RT_ITEM_TILE);
    }
}

/* The same of an object that is no triangle, by its footprint; returns how many ranges are placed. */
static uint32_t place_object(const void *view, uint32_t id, RtTileRange *to) {
    const RtItemBuffer *buffer = view;
    RtItemFootprint at;
    if (!rt_item_footprint(buffer, id, &at)) return 0;
    rt_item_place(buffer, rt_item_geometry(buffer)->objects[id], &at, to);
    return 1;
}

static int compare_floats(const void *a, const void *b) {
    float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

/* Each class gets as many objects, by a sample of them. */
static void choose_classes(RtItemBuffer *buffer) {
    enum { SOME = 1024 };
    const RtGeometry *g = rt_item_geometry(buffer);
    const uint64_t some = g->object_count < SOME ? g->object_count : SOME;
    float depth[SOME];
    uint32_t count = 0;
    for (uint64_t i = 0; i < some; i++) {
        RtVec3 q = rt_box_center(g->boxes[i * g->object_count / some]);
        double at = rt_dotd(rt_subd(rt_widen(q), buffer->view.eye), buffer->projection.depth);
        if (at > 0) depth[count++] = (float)at;
    }
    qsort(depth, count, sizeof *depth, compare_floats);
    for (uint32_t i = 0; i < RT_ITEM_CLASSES - 1; i++)
        buffer->farther[i] = count > 0 ? depth[(i + 1) * count / RT_ITEM_CLASSES] : 0;
}

static RtStatus draw_tiles(Drawing *drawing, int threads, RtError *error) {
    RtItemBuffer *buffer = drawing->buffer;
    const size_t tile_count = (size_t)rt_thread_count(threads);
    const uint32_t across = rt_item_tiles(buffer->view.sampling.columns);
    const size_t tiles = (size_t)across * rt_item_tiles(buffer->view.sampling.rows);
    RtBinning binning = {.geometry = rt_item_geometry(buffer),
                         .what = "an item buffer",
                         .view = buffer,
                         .place_triangles = buffer->raster->place,
                         .place_object = place_object,
                         .lists = tiles * RT_ITEM_CLASSES,
                         .most_tiles = MANY_TILES};
    for (uint32_t i = 0; i < RT_ITEM_CLASSES; i++)
        binning.layers[i] = (RtTileLayer){i, RT_ITEM_CLASSES, RT_ITEM_CLASSES * across};
    RT_TRY(rt_bins_fill(&binning, threads, &drawing->bins, error));
    drawing->tiles = rt_alloc(tile_count, sizeof(RtItemTile));
    if (!drawing->tiles) return rt_fail_memory(error, "an item buffer", tile_count * sizeof(RtItemTile));
    RtStatus status = RT_OK;
    for (size_t k = 0; k < tile_count && status == RT_OK; k++) {
        drawing->tiles[k].buffer = buffer;
        status = rt_crossings_alloc(rt_item_geometry(buffer), &drawing->tiles[k].crossings, error);
    }
    if (status == RT_OK) status = rt_parallel_for(tiles, threads, draw_tile, drawing, error);
    for (size_t k = 0; k < tile_count; k++) {
        rt_tally_add(&buffer->isa.base.build_tally, &drawing->tiles[k].tally);
        rt_free(drawing->tiles[k].crossings);
    }
    return status;
}

RtStatus rt_item_draw_all(RtItemBuffer *buffer, int threads, RtError *error) {
    Drawing drawing = {.buffer = buffer};
    choose_classes(buffer);
    RtStatus status = draw_tiles(&drawing, threads, error);
    rt_free(drawing.tiles);
    rt_bins_clear(&drawing.bins);
    return status;
}
