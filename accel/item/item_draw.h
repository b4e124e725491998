/* SPDX-License-Identifier: Apache-2.0 */
/* Drawing facets into a tile, block by block of sixteen samples. */
#ifndef RT_ACCEL_ITEM_ITEM_DRAW_H
#define RT_ACCEL_ITEM_ITEM_DRAW_H

#include "accel/item/item_facets.h"
#include "accel/item/item_place.h"

RT_KERNEL RtV16 function(const float of[3][RT_ITEM_FACETS], uint32_t k, RtV16 column, RtV16 row) {
    return rt_v16_add(rt_v16_add(rt_v16_all(of[0][k]), rt_v16_mul(rt_v16_all(of[1][k]), column)),
                      rt_v16_mul(rt_v16_all(of[2][k]), row));
}

/* The samples of a block where facet k may be nearest. */
RT_KERNEL void draw_block(RtItemDrawing *d, uint32_t block, const RtItemFacets *f, uint32_t k, uint32_t edges,
                          uint32_t lanes, RtV16 column, RtV16 row) {
    RtItemTile *tile = &d->tile;
    const uint32_t first = block * RT_ITEM_LANES;
    float *tile_lo = &tile->lo[first], *tile_hi = &tile->hi[first];
    const RtV16 zero = rt_v16_all(0), nearest = rt_v16_all(d->nearest);
    RtV16 w = function(f->depth, k, column, row), size = rt_v16_abs(w);
    RtV16 half = rt_v16_mul(w, rt_v16_all(0.5f));
    RtV16 error = rt_v16_mul(rt_v16_all(f->depth_error[2][k]), size);
    error = rt_v16_mul(rt_v16_add(error, rt_v16_all(f->depth_error[1][k])), size);
    error = rt_v16_add(error, rt_v16_all(f->depth_error[0][k]));
    RtSet16 known = rt_v16_below(error, half);
    RtV16 lo = rt_v16_pick(known, zero, rt_v16_sub(w, error));
    RtV16 hi = rt_v16_pick(known, rt_v16_all(f->most[k]), rt_v16_add(w, error));
    uint32_t behind = rt_v16_bits(rt_v16_below(error, rt_v16_sub(zero, half)));
    uint32_t front = lanes & ~behind & rt_v16_at_most(rt_v16_load(tile_lo), hi);
    if (!front) return;

    RtV16 margin = rt_v16_mul(rt_v16_all(f->edge_error[1][k]), hi);
    margin = rt_v16_add(margin, rt_v16_all(f->edge_error[0][k]));
    RtV16 outside = rt_v16_sub(zero, margin);
    uint32_t inside = rt_v16_bits(known);
    for (uint32_t i = 0; i < edges; i++) {
        RtV16 edge = function(f->edge[i], k, column, row);
        front &= ~rt_v16_bits(rt_v16_below(edge, outside));
        inside &= rt_v16_bits(rt_v16_below(margin, edge));
    }
    front &= rt_v16_at_most(lo, nearest);
    if (!front) return;
    inside &= rt_v16_at_most(rt_v16_mul(hi, rt_v16_all(1 + 0x1p-18f)), nearest);
    uint32_t clear = front & inside & rt_v16_bits(rt_v16_below(rt_v16_load(tile_hi), lo));
    if (clear) {
        rt_v16_store_some(tile_lo, clear, lo);
        rt_v16_store_some(tile_hi, clear, hi);
        rt_v16_store_some(&tile->t[first], clear, rt_v16_all(-1));
        rt_w16_store_some(&tile->id[first], clear, rt_w16_all(f->id[k]));
        tile->least[block] = rt_v16_least(rt_v16_load(tile_lo));
    }
    front &= ~clear;
    if (!front) return;
    _Alignas(64) float los[RT_ITEM_LANES], his[RT_ITEM_LANES];
    rt_v16_store(los, lo);
    rt_v16_store(his, hi);
    for (; front; front &= front - 1) {
        uint32_t lane = (uint32_t)__builtin_ctz(front);
        rt_item_resolve(d, first + lane, f->id[k], los[lane], his[lane], inside >> lane & 1);
    }
}

/* The facets of triangles that may hold a sample: all that are seen at more than two columns or rows, and the
 * others if one of their samples is inside all edges. */
RT_KERNEL uint32_t holding_samples(const RtItemFacets *f, const Bounds *b, const RtV16 corner[2]) {
    const RtV16 one = rt_v16_all(1);
    RtV16 margin = rt_v16_mul(rt_v16_load(f->edge_error[1]), rt_v16_load(f->most));
    RtV16 outside = rt_v16_sub(rt_v16_all(0), rt_v16_add(rt_v16_load(f->edge_error[0]), margin)), start[2];
    uint32_t some = 0, wide[2];
    for (int a = 0; a < 2; a++) {
        start[a] = rt_v16_sub(b->lo[a], corner[a]);
        RtV16 more = rt_v16_sub(b->hi[a], b->lo[a]);
        wide[a] = rt_v16_at_most(one, more);
        some |= ~rt_v16_at_most(more, one);
    }
    for (int i = 0; i < 4; i++) {
        RtV16 column = i & 1 ? rt_v16_add(start[0], one) : start[0];
        RtV16 row = i & 2 ? rt_v16_add(start[1], one) : start[1];
        uint32_t in = (i & 1 ? wide[0] : ~0u) & (i & 2 ? wide[1] : ~0u);
        for (int e = 0; e < 3; e++) {
            RtV16 edge = rt_v16_mul(rt_v16_load(f->edge[e][1]), column);
            edge = rt_v16_add(rt_v16_add(rt_v16_load(f->edge[e][0]), edge),
                              rt_v16_mul(rt_v16_load(f->edge[e][2]), row));
            in &= ~rt_v16_bits(rt_v16_below(edge, outside));
        }
        some |= in;
    }
    return some;
}

/* From so many blocks on, blocks are tested against the edges first. */
enum { MANY_BLOCKS = 4 };

/* Bit i: facet k may be seen in block i. An edge is largest in a block at the corner on its inner side. */
RT_KERNEL uint64_t blocks_of(const RtItemDrawing *d, const RtItemFacets *f, uint32_t k, uint32_t edges) {
    static const _Alignas(64) float column[16] = {0, 4, 8, 12, 16, 20, 24, 28, 0, 4, 8, 12, 16, 20, 24, 28};
    static const _Alignas(64) float row[16] = {0, 0, 0, 0, 0, 0, 0, 0, 4, 4, 4, 4, 4, 4, 4, 4};
    const float last = RT_ITEM_BLOCK - 1;
    const RtV16 outside = rt_v16_all(-(f->edge_error[0][k] + f->edge_error[1][k] * f->most[k]));
    uint64_t open = 0;
    for (int i = 0; i < RT_ITEM_BLOCKS; i += RT_ITEM_LANES) {
        RtV16 y =
            rt_v16_add(rt_v16_load(row), rt_v16_all((float)(i / 2))); /* two rows of blocks are 8 samples */
        uint32_t in = rt_v16_at_most(rt_v16_load(&d->tile.least[i]), rt_v16_all(f->most[k]));
        for (uint32_t e = 0; e < edges; e++) {
            RtV16 edge = function(f->edge[e], k, rt_v16_load(column), y);
            float more = last * (rt_maxf(f->edge[e][1][k], 0) + rt_maxf(f->edge[e][2][k], 0));
            in &= ~rt_v16_bits(rt_v16_below(rt_v16_add(edge, rt_v16_all(more)), outside));
        }
        open |= (uint64_t)(in & 0xffff) << i;
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
        const RtV16 rows = rt_raster_rows((float)(y * RT_ITEM_BLOCK));
        uint32_t in_rows = 0xffff;
        if (y == first[1]) in_rows &= 0xffffu << 4 * (lo[1] % RT_ITEM_BLOCK);
        if (y == last[1]) in_rows &= 0xffffu >> 4 * (RT_ITEM_BLOCK - 1 - hi[1] % RT_ITEM_BLOCK);
        for (int32_t x = first[0]; x <= last[0]; x++) {
            uint32_t block = (uint32_t)(y * RT_ITEM_ACROSS + x), in = 15;
            if (!(open >> block & 1) || f->most[k] < d->tile.least[block]) continue;
            if (x == first[0]) in &= 15u << lo[0] % RT_ITEM_BLOCK;
            if (x == last[0]) in &= 15u >> (RT_ITEM_BLOCK - 1 - hi[0] % RT_ITEM_BLOCK);
            RtV16 columns = rt_raster_columns((float)(x * RT_ITEM_BLOCK));
            draw_block(d, block, f, k, edges, in_rows & in * 0x1111, columns, rows);
        }
    }
}

/* The least w of the tile: what is less is hidden everywhere. */
RT_KERNEL float farthest(const RtItemTile *tile) {
    RtV16 least = rt_v16_load(tile->least);
    for (int i = RT_ITEM_LANES; i < RT_ITEM_BLOCKS; i += RT_ITEM_LANES)
        least = rt_v16_min(least, rt_v16_load(&tile->least[i]));
    return rt_v16_least(least);
}

RT_KERNEL void draw_sixteen(RtItemDrawing *d, const LaneProjection *projection, const RtRef *triangles,
                            uint32_t count, RtItemFacets *f) {
    const RtGeometry *g = rt_item_geometry(d->buffer);
    const RtV16 corner[2] = {rt_v16_all((float)d->column), rt_v16_all((float)d->row)};
    RtV16 v[3][3];
    Bounds b;
    rt_raster_gather(g, triangles, count, v);
    bound(projection, v, &b);
    uint32_t there = rt_raster_first_lanes(count), by_box = ~b.known & there;
    there &= by_box | rt_v16_at_most(rt_v16_all(farthest(&d->tile)), b.most);
    if (!there) return;
    make_half(d, v, 0, f);
    if (there >> 8) make_half(d, v, 1, f);
    for (int a = 0; a < 2; a++) {
        rt_v16_truncate(f->lo[a], rt_v16_sub(b.lo[a], corner[a]));
        rt_v16_truncate(f->hi[a], rt_v16_sub(b.hi[a], corner[a]));
    }
    rt_v16_store(f->most, b.most);
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
        RtRef triangles[RT_ITEM_FACETS];
        uint32_t some = 0;
        for (; i < count && some < RT_ITEM_FACETS; i++) {
            if (rt_raster_is_triangle(objects[i])) triangles[some++] = objects[i];
        }
        if (some > 0) draw_sixteen(d, &projection, triangles, some, &facets);
    }
}

static void draw_facet(RtItemDrawing *d, const RtItemFacets *facets, uint32_t edges) {
    draw_one(d, facets, 0, edges);
}

#endif
