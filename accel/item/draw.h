/* SPDX-License-Identifier: Apache-2.0 */
/* Drawing facets into a tile, block by block of sixteen samples. */
#ifndef RT_ACCEL_ITEM_DRAW_H
#define RT_ACCEL_ITEM_DRAW_H

#include "accel/item/facets.h"
#include "accel/item/place.h"
#include "accel/simd_words.h"

/* Columns and rows of the samples of a block, in the tile. */
typedef struct Grid {
    RtV16 along[RT_ITEM_TILE / RT_ITEM_BLOCK][2];
    RtV16
        blocks[1 + RT_ITEM_BLOCKS / RT_ITEM_LANES]; /* columns of the first samples of sixteen blocks; rows */
} Grid;

RT_KERNEL void make_grid(Grid *grid) {
    _Alignas(64) float at[2][RT_ITEM_LANES];
    for (int i = 0; i < RT_ITEM_TILE / RT_ITEM_BLOCK; i++) {
        for (int k = 0; k < RT_ITEM_LANES; k++) {
            const int down = k / RT_ITEM_BLOCK;
            at[0][k] = (float)(i * RT_ITEM_BLOCK + k % RT_ITEM_BLOCK);
            at[1][k] = (float)(i * RT_ITEM_BLOCK + down);
        }
        grid->along[i][0] = rt_v16_load(at[0]);
        grid->along[i][1] = rt_v16_load(at[1]);
    }
    for (int i = 0; i < RT_ITEM_BLOCKS / RT_ITEM_LANES; i++) {
        for (int k = 0; k < RT_ITEM_LANES; k++) {
            const int block = i * RT_ITEM_LANES + k, across = RT_ITEM_TILE / RT_ITEM_BLOCK;
            const int row = block / across * RT_ITEM_BLOCK;
            at[0][k] = (float)(block % across * RT_ITEM_BLOCK);
            at[1][k] = (float)row;
        }
        grid->blocks[0] = rt_v16_load(at[0]);
        grid->blocks[1 + i] = rt_v16_load(at[1]);
    }
}

RT_KERNEL RtV16 function(const float of[3][RT_ITEM_FACETS], uint32_t k, RtV16 column, RtV16 row) {
    return rt_v16_add(rt_v16_add(rt_v16_all(of[0][k]), rt_v16_mul(rt_v16_all(of[1][k]), column)),
                      rt_v16_mul(rt_v16_all(of[2][k]), row));
}

/* The samples of a block where facet k may be nearest. */
RT_KERNEL void paint_block(RtItemPainter *p, uint32_t block, const RtItemFacets *f, uint32_t k,
                           uint32_t edges, uint32_t lanes, RtV16 column, RtV16 row) {
    RtItemTile *tile = &p->tile;
    const RtV16 zero = rt_v16_all(0), there_lo = rt_v16_load(tile->lo[block]);
    RtV16 w = function(f->depth, k, column, row), size = rt_v16_abs(w),
          half = rt_v16_mul(w, rt_v16_all(0.5f));
    RtV16 spread = rt_v16_mul(rt_v16_all(f->spread[2][k]), size);
    spread = rt_v16_mul(rt_v16_add(spread, rt_v16_all(f->spread[1][k])), size);
    spread = rt_v16_add(spread, rt_v16_all(f->spread[0][k]));
    RtSet16 known = rt_v16_below(spread, half);
    RtV16 lo = rt_v16_pick(known, zero, rt_v16_sub(w, spread));
    RtV16 hi = rt_v16_pick(known, rt_v16_all(f->most[k]), rt_v16_add(w, spread));
    uint32_t behind = rt_v16_bits(rt_v16_below(spread, rt_v16_sub(zero, half)));
    uint32_t front = lanes & ~behind & rt_v16_at_most(there_lo, hi);
    if (!front) return;

    RtV16 doubt = rt_v16_mul(rt_v16_all(f->doubt[1][k]), hi);
    doubt = rt_v16_add(doubt, rt_v16_all(f->doubt[0][k]));
    RtV16 minus = rt_v16_sub(zero, doubt);
    uint32_t inside = rt_v16_bits(known);
    for (uint32_t i = 0; i < edges; i++) {
        RtV16 edge = function(f->edge[i], k, column, row);
        front &= ~rt_v16_bits(rt_v16_below(edge, minus));
        inside &= rt_v16_bits(rt_v16_below(doubt, edge));
    }
    front &= rt_v16_at_most(lo, rt_v16_all(p->nearest));
    if (!front) return;
    inside &= rt_v16_at_most(rt_v16_mul(hi, rt_v16_all(1 + 0x1p-18f)), rt_v16_all(p->nearest));
    uint32_t clear = front & inside & rt_v16_bits(rt_v16_below(rt_v16_load(tile->hi[block]), lo));
    if (clear) {
        rt_v16_store_some(tile->lo[block], clear, lo);
        rt_v16_store_some(tile->hi[block], clear, hi);
        rt_v16_store_some(tile->t[block], clear, rt_v16_all(-1));
        rt_w16_store_some(tile->id[block], clear, rt_w16_all(f->id[k]));
        tile->least[block] = rt_v16_least(rt_v16_load(tile->lo[block]));
    }
    front &= ~clear;
    if (!front) return;
    _Alignas(64) float los[RT_ITEM_LANES], his[RT_ITEM_LANES];
    rt_v16_store(los, lo);
    rt_v16_store(his, hi);
    for (; front; front &= front - 1) {
        uint32_t lane = (uint32_t)__builtin_ctz(front);
        rt_item_doubt(p, block, lane, f->id[k], los[lane], his[lane], inside >> lane & 1);
    }
}

/* Of facets of triangles those that may hold a sample: all that are seen at more than two columns or rows,
 * and of the others, sixteen at a time, those whose edges let one pass. */
RT_KERNEL uint32_t hold_some(const RtItemFacets *f, const Bounds *b, const RtV16 corner[2]) {
    const RtV16 one = rt_v16_all(1);
    RtV16 doubt =
        rt_v16_add(rt_v16_load(f->doubt[0]), rt_v16_mul(rt_v16_load(f->doubt[1]), rt_v16_load(f->most)));
    RtV16 minus = rt_v16_sub(rt_v16_all(0), doubt), start[2];
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
            in &= ~rt_v16_bits(rt_v16_below(edge, minus));
        }
        some |= in;
    }
    return some;
}

/* From so many blocks on it is looked first which of them a facet is in. */
enum { MANY_BLOCKS = 4 };

/* Bit i: facet k may be seen in block i. An edge is largest in a block at the corner on its inner side. */
RT_KERNEL uint64_t blocks_of(const RtItemPainter *p, const Grid *grid, const RtItemFacets *f, uint32_t k,
                             uint32_t edges) {
    const float last = RT_ITEM_BLOCK - 1;
    const RtV16 least = rt_v16_all(-(f->doubt[0][k] + f->doubt[1][k] * f->most[k]));
    uint64_t open = 0;
    for (size_t i = 0; i < RT_ITEM_BLOCKS / RT_ITEM_LANES; i++) {
        uint32_t in = rt_v16_at_most(rt_v16_load(&p->tile.least[i * RT_ITEM_LANES]), rt_v16_all(f->most[k]));
        for (uint32_t e = 0; e < edges; e++) {
            RtV16 edge = function(f->edge[e], k, grid->blocks[0], grid->blocks[1 + i]);
            float more = last * (rt_maxf(f->edge[e][1][k], 0) + rt_maxf(f->edge[e][2][k], 0));
            in &= ~rt_v16_bits(rt_v16_below(rt_v16_add(edge, rt_v16_all(more)), least));
        }
        open |= (uint64_t)(in & 0xffff) << i * RT_ITEM_LANES;
    }
    return open;
}

RT_KERNEL void paint_one(RtItemPainter *p, const Grid *grid, const RtItemFacets *f, uint32_t k,
                         uint32_t edges) {
    static const uint32_t from[2][RT_ITEM_BLOCK] = {{0xffff, 0xeeee, 0xcccc, 0x8888},
                                                    {0xffff, 0xfff0, 0xff00, 0xf000}};
    static const uint32_t to[2][RT_ITEM_BLOCK] = {{0x1111, 0x3333, 0x7777, 0xffff},
                                                  {0x000f, 0x00ff, 0x0fff, 0xffff}};
    int32_t lo[2], hi[2];
    for (int a = 0; a < 2; a++) {
        lo[a] = f->lo[a][k] > 0 ? f->lo[a][k] : 0;
        hi[a] = f->hi[a][k] < RT_ITEM_TILE - 1 ? f->hi[a][k] : RT_ITEM_TILE - 1;
    }
    int32_t blocks = (hi[0] / RT_ITEM_BLOCK - lo[0] / RT_ITEM_BLOCK + 1) *
                     (hi[1] / RT_ITEM_BLOCK - lo[1] / RT_ITEM_BLOCK + 1);
    uint64_t open = blocks < MANY_BLOCKS ? ~UINT64_C(0) : blocks_of(p, grid, f, k, edges);
    for (int32_t y = lo[1] / RT_ITEM_BLOCK; y <= hi[1] / RT_ITEM_BLOCK; y++) {
        uint32_t rows = y == lo[1] / RT_ITEM_BLOCK ? from[1][lo[1] % RT_ITEM_BLOCK] : 0xffff;
        if (y == hi[1] / RT_ITEM_BLOCK) rows &= to[1][hi[1] % RT_ITEM_BLOCK];
        for (int32_t x = lo[0] / RT_ITEM_BLOCK; x <= hi[0] / RT_ITEM_BLOCK; x++) {
            uint32_t block = (uint32_t)(y * (RT_ITEM_TILE / RT_ITEM_BLOCK) + x), lanes = rows;
            if (!(open >> block & 1) || f->most[k] < p->tile.least[block]) continue;
            if (x == lo[0] / RT_ITEM_BLOCK) lanes &= from[0][lo[0] % RT_ITEM_BLOCK];
            if (x == hi[0] / RT_ITEM_BLOCK) lanes &= to[0][hi[0] % RT_ITEM_BLOCK];
            paint_block(p, block, f, k, edges, lanes, grid->along[x][0], grid->along[y][1]);
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

RT_KERNEL void paint_some(RtItemPainter *painter, const Lens *lens, const Grid *grid,
                          const uint32_t *triangles, uint32_t count, RtItemFacets *f) {
    const RtGeometry *g = &painter->buffer->isa.base.scene->geometry;
    const RtV16 corner[2] = {rt_v16_all((float)painter->column), rt_v16_all((float)painter->row)};
    const RtTriangle *at[RT_ITEM_FACETS];
    RtV16 v[3][3];
    Bounds b;
    for (uint32_t k = 0; k < RT_ITEM_FACETS; k++) at[k] = &g->triangles[triangles[k < count ? k : 0]];
    rt_pairs_gather(at, v);
    bound(lens, v, &b);
    uint32_t there = (1u << count) - 1, around = ~b.known & there;
    there &= around | rt_v16_at_most(rt_v16_all(farthest(&painter->tile)), b.most);
    if (!there) return;
    make_half(painter, v, 0, f);
    if (there >> 8) make_half(painter, v, 1, f);
    for (int a = 0; a < 2; a++) {
        rt_v16_truncate(f->lo[a], rt_v16_sub(b.lo[a], corner[a]));
        rt_v16_truncate(f->hi[a], rt_v16_sub(b.hi[a], corner[a]));
    }
    rt_v16_store(f->most, b.most);
    there &= around | hold_some(f, &b, corner);
    for (; around; around &= around - 1) {
        uint32_t k = (uint32_t)__builtin_ctz(around);
        RtItemFootprint footprint;
        rt_item_footprint(painter->buffer, g->triangle_ids[triangles[k]], &footprint);
        place_around(painter, &footprint, f, k);
    }
    for (; there; there &= there - 1) {
        uint32_t k = (uint32_t)__builtin_ctz(there);
        f->id[k] = g->triangle_ids[triangles[k]];
        paint_one(painter, grid, f, k, 3);
    }
}

static void paint(RtItemPainter *painter, const RtRef *objects, size_t count) {
    RtItemFacets facets;
    Lens lens;
    Grid grid;
    make_lens(&lens, painter->buffer);
    make_grid(&grid);
    for (size_t i = 0; i < count;) {
        uint32_t triangles[RT_ITEM_FACETS], some = 0;
        for (; i < count && some < RT_ITEM_FACETS; i++) {
            if (rt_ref_shape(objects[i]) == RT_SHAPE_TRIANGLE) triangles[some++] = rt_ref_index(objects[i]);
        }
        if (some > 0) paint_some(painter, &lens, &grid, triangles, some, &facets);
    }
}

static void paint_facet(RtItemPainter *painter, const RtItemFacets *facets, uint32_t edges) {
    Grid grid;
    make_grid(&grid);
    paint_one(painter, &grid, facets, 0, edges);
}

#endif
