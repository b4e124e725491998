/* SPDX-License-Identifier: Apache-2.0 */
/* Drawing facets into a tile, block by block. */
#ifndef RT_ACCEL_ITEM_ITEM_DRAW_H
#define RT_ACCEL_ITEM_ITEM_DRAW_H

#include "accel/item/item_facets.h"
#include "accel/item/item_place.h"

RT_KERNEL RtFloats function(const float of[3][RT_ITEM_FACETS], uint32_t k, RtFloats column, RtFloats row) {
    return of[0][k] + of[1][k] * column + of[2][k] * row;
}

RT_KERNEL void update_least(RtItemTile *tile, uint32_t block) {
    const float *lo = &tile->lo[(size_t)block * RT_ITEM_BLOCK_SAMPLES];
    RtFloats least = rt_load(lo);
    for (int i = RT_LANES; i < RT_ITEM_BLOCK_SAMPLES; i += RT_LANES) least = rt_min(least, rt_load(lo + i));
    tile->least[block] = rt_least(least);
}

/* Draws facet k at the samples first..first+RT_LANES-1 that are in `lanes`, where it may be nearest. */
RT_KERNEL void draw_samples(RtItemDrawing *d, uint32_t first, const RtItemFacets *f, uint32_t k,
                            uint32_t edges, uint32_t lanes, RtFloats column, RtFloats row) {
    RtItemTile *tile = &d->tile;
    float *tile_lo = &tile->lo[first], *tile_hi = &tile->hi[first];
    RtFloats w = function(f->depth, k, column, row), size = rt_abs(w), half = w * 0.5f;
    RtFloats error = f->depth_error[2][k] * size;
    error = (error + f->depth_error[1][k]) * size + f->depth_error[0][k];
    RtInts known = error < half;
    RtFloats lo = rt_select(known, w - error, rt_all(0));
    RtFloats hi = rt_select(known, w + error, rt_all(f->most[k]));
    uint32_t behind = rt_lt_bits(error, -half);
    uint32_t front = lanes & ~behind & rt_le_bits(rt_load(tile_lo), hi);
    if (!front) return;

    RtFloats margin = f->edge_error[1][k] * hi + f->edge_error[0][k], outside = -margin;
    uint32_t inside = rt_bits(known);
    for (uint32_t i = 0; i < edges; i++) {
        RtFloats edge = function(f->edge[i], k, column, row);
        front &= ~rt_lt_bits(edge, outside);
        inside &= rt_lt_bits(margin, edge);
    }
    front &= rt_le_bits(lo, rt_all(d->nearest));
    if (!front) return;
    inside &= rt_le_bits(hi * (1 + 0x1p-18f), rt_all(d->nearest));
    uint32_t clear = front & inside & rt_lt_bits(rt_load(tile_hi), lo);
    if (clear) {
        rt_store_lanes(tile_lo, clear, (RtInts)lo);
        rt_store_lanes(tile_hi, clear, (RtInts)hi);
        rt_store_lanes(&tile->t[first], clear, (RtInts)rt_all(-1));
        rt_store_lanes(&tile->id[first], clear, rt_all_ints((int32_t)f->id[k]));
        update_least(tile, first / RT_ITEM_BLOCK_SAMPLES);
    }
    front &= ~clear;
    if (!front) return;
    float los[RT_LANES], his[RT_LANES];
    rt_store(los, lo);
    rt_store(his, hi);
    for (; front; front &= front - 1) {
        uint32_t lane = (uint32_t)__builtin_ctz(front);
        rt_item_resolve(d, first + lane, f->id[k], los[lane], his[lane], inside >> lane & 1);
    }
}

/* The facets of triangles that may hold a sample: all that are seen at more than two columns or rows, and the
 * others if one of their samples is inside all edges. */
RT_KERNEL uint32_t holding_samples(const RtItemFacets *f, const Bounds *b, const RtFloats corner[2]) {
    RtFloats outside = -(rt_load(f->edge_error[0]) + rt_load(f->edge_error[1]) * rt_load(f->most)), start[2];
    uint32_t some = 0, wide[2];
    for (int a = 0; a < 2; a++) {
        start[a] = b->lo[a] - corner[a];
        RtFloats more = b->hi[a] - b->lo[a];
        wide[a] = rt_bits(more >= 1);
        some |= ~rt_bits(more <= 1);
    }
    for (int i = 0; i < 4; i++) {
        RtFloats column = i & 1 ? start[0] + 1 : start[0], row = i & 2 ? start[1] + 1 : start[1];
        uint32_t in = (i & 1 ? wide[0] : ~0u) & (i & 2 ? wide[1] : ~0u);
        for (int e = 0; e < 3; e++) {
            RtFloats edge =
                rt_load(f->edge[e][0]) + rt_load(f->edge[e][1]) * column + rt_load(f->edge[e][2]) * row;
            in &= ~rt_lt_bits(edge, outside);
        }
        some |= in;
    }
    return some;
}

/* From so many blocks on, blocks are tested against the edges first. */
enum { MANY_BLOCKS = 4 };

/* Bit i: facet k may be seen in block i. An edge is largest in a block at the corner on its inner side. */
RT_KERNEL uint64_t blocks_of(const RtItemDrawing *d, const RtItemFacets *f, uint32_t k, uint32_t edges) {
    const float last = RT_ITEM_BLOCK - 1;
    const RtFloats outside = rt_all(-(f->edge_error[0][k] + f->edge_error[1][k] * f->most[k]));
    uint64_t open = 0;
    for (int i = 0; i < RT_ITEM_BLOCKS; i += RT_LANES) {
        RtInts block = rt_lane_numbers() + i;
        RtFloats column = rt_to_floats(block % RT_ITEM_ACROSS * RT_ITEM_BLOCK);
        RtFloats row = rt_to_floats(block / RT_ITEM_ACROSS * RT_ITEM_BLOCK);
        uint32_t in = rt_le_bits(rt_load(&d->tile.least[i]), rt_all(f->most[k]));
        for (uint32_t e = 0; e < edges; e++) {
            float more = last * (rt_maxf(f->edge[e][1][k], 0) + rt_maxf(f->edge[e][2][k], 0));
            in &= ~rt_lt_bits(function(f->edge[e], k, column, row) + more, outside);
        }
        open |= (uint64_t)in << i;
    }
    return open;
}

RT_KERNEL void draw_one(RtItemDrawing *d, const RtItemFacets *f, uint32_t k, uint32_t edges) {
    int32_t lo[2], hi[2], first[2], last[2];
    for (int a = 0; a < 2; a++) {
        lo[a] = f->lo[a][k] > 0 ? f->lo[a][k] : 0;
        hi[a] = f->hi[a][k] < RT_ITEM_TILE - 1 ? f->hi[a][k] : RT_ITEM_TILE - 1;
        first[a] = lo[a] / RT_ITEM_BLOCK;
        last[a] = hi[a] / RT_ITEM_BLOCK;
    }
    int32_t blocks = (last[0] - first[0] + 1) * (last[1] - first[1] + 1);
    uint64_t open = blocks < MANY_BLOCKS ? ~UINT64_C(0) : blocks_of(d, f, k, edges);
    for (int32_t y = first[1]; y <= last[1]; y++) {
        uint32_t in_rows = 0xffff;
        if (y == first[1]) in_rows &= 0xffffu << 4 * (lo[1] % RT_ITEM_BLOCK);
        if (y == last[1]) in_rows &= 0xffffu >> 4 * (RT_ITEM_BLOCK - 1 - hi[1] % RT_ITEM_BLOCK);
        for (int32_t x = first[0]; x <= last[0]; x++) {
            uint32_t block = (uint32_t)(y * RT_ITEM_ACROSS + x), in = 15;
            if (!(open >> block & 1) || f->most[k] < d->tile.least[block]) continue;
            if (x == first[0]) in &= 15u << lo[0] % RT_ITEM_BLOCK;
            if (x == last[0]) in &= 15u >> (RT_ITEM_BLOCK - 1 - hi[0] % RT_ITEM_BLOCK);
            RtFloats columns = rt_raster_columns((float)(x * RT_ITEM_BLOCK));
            in = in_rows & in * 0x1111;
            for (int i = 0; i < RT_ITEM_BLOCK_SAMPLES; i += RT_LANES) {
                uint32_t lanes = in >> i & ((1u << RT_LANES) - 1);
                if (!lanes) continue;
                const int row = y * RT_ITEM_BLOCK + i / RT_ITEM_BLOCK;
                RtFloats rows = rt_raster_rows((float)row);
                draw_samples(d, block * RT_ITEM_BLOCK_SAMPLES + (uint32_t)i, f, k, edges, lanes, columns,
                             rows);
            }
        }
    }
}

/* The least w of the tile: what is less is hidden everywhere. */
RT_KERNEL float farthest(const RtItemTile *tile) {
    RtFloats least = rt_load(tile->least);
    for (int i = RT_LANES; i < RT_ITEM_BLOCKS; i += RT_LANES) least = rt_min(least, rt_load(&tile->least[i]));
    return rt_least(least);
}

RT_KERNEL void draw_triangles(RtItemDrawing *d, const LaneProjection *projection, const RtRef *triangles,
                              uint32_t count, RtItemFacets *f) {
    const RtGeometry *g = rt_item_geometry(d->buffer);
    const RtFloats corner[2] = {rt_all((float)d->column), rt_all((float)d->row)};
    RtFloats v[3][3];
    Bounds b;
    rt_raster_gather(g, triangles, count, v);
    bound(projection, v, &b);
    uint32_t there = rt_raster_first_lanes(count), by_box = ~b.known & there;
    there &= by_box | rt_le_bits(rt_all(farthest(&d->tile)), b.most);
    if (!there) return;
    make_half(d, v, 0, f);
    if (there >> RT_HALF) make_half(d, v, 1, f);
    for (int a = 0; a < 2; a++) {
        rt_store(f->lo[a], rt_to_ints(b.lo[a] - corner[a]));
        rt_store(f->hi[a], rt_to_ints(b.hi[a] - corner[a]));
    }
    rt_store(f->most, b.most);
    there &= by_box | holding_samples(f, &b, corner);
    for (; by_box; by_box &= by_box - 1) {
        uint32_t k = (uint32_t)__builtin_ctz(by_box);
        RtItemFootprint footprint;
        rt_item_footprint(d->buffer, g->triangle_ids[rt_ref_index(triangles[k])], &footprint);
        rt_item_place_facet(d, &footprint, f, k);
    }
    for (; there; there &= there - 1) {
        uint32_t k = (uint32_t)__builtin_ctz(there);
        f->id[k] = g->triangle_ids[rt_ref_index(triangles[k])];
        draw_one(d, f, k, 3);
    }
}

static void draw(RtItemDrawing *d, const RtRef *objects, size_t count) {
    RtItemFacets facets;
    LaneProjection projection;
    make_lane_projection(&projection, d->buffer);
    for (size_t i = 0; i < count;) {
        RtRef triangles[RT_LANES];
        uint32_t some = 0;
        for (; i < count && some < RT_LANES; i++) {
            if (rt_raster_is_triangle(objects[i])) triangles[some++] = objects[i];
        }
        if (some > 0) draw_triangles(d, &projection, triangles, some, &facets);
    }
}

static void draw_facet(RtItemDrawing *d, const RtItemFacets *facets, uint32_t edges) {
    draw_one(d, facets, 0, edges);
}

#endif
