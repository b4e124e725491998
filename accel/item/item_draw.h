/* SPDX-License-Identifier: Apache-2.0 */
/* Facets of triangles, RT_HALF at a time in doubles: edges, depth, and the errors of both (item.h); and
 * drawing facets into a tile, block by block. */
#ifndef RT_ACCEL_ITEM_ITEM_DRAW_H
#define RT_ACCEL_ITEM_ITEM_DRAW_H

#include "accel/item/item_place.h"

/* ---- facets ---- */

/* Vectors of double in lanes. */
typedef struct Vectors {
    RtDoubles at[3];
} Vectors;

RT_KERNEL Vectors subtract(Vectors a, Vectors b) {
    return (Vectors){{a.at[0] - b.at[0], a.at[1] - b.at[1], a.at[2] - b.at[2]}};
}

RT_KERNEL Vectors add(Vectors a, Vectors b) {
    return (Vectors){{a.at[0] + b.at[0], a.at[1] + b.at[1], a.at[2] + b.at[2]}};
}

RT_KERNEL RtDoubles dot(Vectors a, Vectors b) {
    return a.at[0] * b.at[0] + a.at[1] * b.at[1] + a.at[2] * b.at[2];
}

RT_KERNEL Vectors cross(Vectors a, Vectors b) {
    return (Vectors){{a.at[1] * b.at[2] - a.at[2] * b.at[1], a.at[2] * b.at[0] - a.at[0] * b.at[2],
                      a.at[0] * b.at[1] - a.at[1] * b.at[0]}};
}

RT_KERNEL Vectors in_all_lanes(RtVec3d a) {
    return (Vectors){{rt_all_doubles(a.x), rt_all_doubles(a.y), rt_all_doubles(a.z)}};
}

/* The sum of |coordinates|, and the largest. */
RT_KERNEL RtDoubles sum_of_sizes(Vectors a) {
    return rt_abs(a.at[0]) + rt_abs(a.at[1]) + rt_abs(a.at[2]);
}

RT_KERNEL RtDoubles largest_size(Vectors a) {
    return rt_max(rt_max(rt_abs(a.at[0]), rt_abs(a.at[1])), rt_abs(a.at[2]));
}

RT_KERNEL Vectors project_lanes(const RtItemProjection *projection, Vectors q) {
    return (Vectors){{dot(in_all_lanes(projection->x), q), dot(in_all_lanes(projection->y), q),
                      dot(in_all_lanes(projection->depth), q)}};
}

/* `of` times `scale`, as the coefficients of (1, column, row) from the corner of the tile. */
RT_KERNEL void put_function(float to[3][RT_ITEM_FACETS], size_t at, const RtItemDrawing *drawing, Vectors of,
                            RtDoubles scale) {
    RtDoubles corner = of.at[0] * (double)drawing->column + of.at[1] * (double)drawing->row + of.at[2];
    rt_store_doubles(&to[0][at], corner * scale);
    rt_store_doubles(&to[1][at], of.at[0] * scale);
    rt_store_doubles(&to[2][at], of.at[1] * scale);
}

/* An upper bound, by a few per cent, of the length of the gradient of `of`, in units of slope. */
RT_KERNEL RtDoubles gradient(const RtItemProjection *projection, Vectors of) {
    RtDoubles x = rt_abs(of.at[0]) * projection->scale[0], y = rt_abs(of.at[1]) * projection->scale[1];
    return rt_max(x, y) + rt_min(x, y) * 0.4143;
}

/* Facets 0..RT_HALF-1, half 0, or RT_HALF..RT_LANES-1, without lo, hi, most and id. */
RT_KERNEL void make_half(const RtItemDrawing *drawing, RtFloats v[3][3], int half, RtItemFacets *f) {
    const RtItemProjection *projection = &drawing->buffer->projection;
    const double g = projection->longest, b = 0x1.01p-24 * g,
                 product = projection->scale[0] * projection->scale[1] * g * g;
    const double coarse = 1 / fmin(projection->scale[0], projection->scale[1]);
    const size_t at = half ? RT_HALF : 0;
    Vectors vertex[3];
    for (int i = 0; i < 3; i++) {
        for (int a = 0; a < 3; a++) vertex[i].at[a] = rt_to_doubles(v[i][a], half);
    }
    const Vectors eye = in_all_lanes(drawing->buffer->view.eye);
    Vectors q = subtract(vertex[0], eye), u = subtract(vertex[1], vertex[0]);
    Vectors w = subtract(vertex[2], vertex[1]), p[3], d[3];
    p[0] = project_lanes(projection, q);
    d[0] = project_lanes(projection, u);
    d[1] = project_lanes(projection, w);
    d[2] = subtract(in_all_lanes(rt_vec3d(0, 0, 0)), add(d[0], d[1]));
    p[1] = add(p[0], d[0]);
    p[2] = add(p[1], d[1]);
    RtDoubles far = rt_max(largest_size(subtract(vertex[1], eye)), largest_size(subtract(vertex[2], eye)));
    far = rt_max(largest_size(q), far) * (1 + 0x1p-10) + 0x1p-120;
    Vectors normal = cross(d[0], d[1]);
    RtDoubles height = dot(normal, p[0]), lengths = sum_of_sizes(u) + sum_of_sizes(w);

    /* The rounding of double arithmetic, relative to the height, and below relative to the gradients. */
    RtDoubles rough = sum_of_sizes(u) * sum_of_sizes(w) * far * (0x1p-40 * product);
    rough = rough / rt_abs(height); /* infinite or NaN for the plane of the eye */
    RtDoubles steep = rt_all_doubles(0);
    for (int i = 0; i < 3; i++) {
        Vectors edge = cross(p[i], d[i]);
        RtDoubles scale = 1 / gradient(projection, edge);
        steep = rt_max(scale, steep);
        put_function(f->edge[i], at, drawing, edge, rt_copy_sign(scale, height));
    }
    RtDoubles rounding = far * lengths * (0x1p-40 * product) * steep;
    rt_store_doubles(&f->edge_error[0][at], rounding + (1.25 * g * b + 0x1p-14 * coarse));
    rt_store_doubles(&f->edge_error[1][at], far * (1.25 * g * 0.65 * 0x1p-20));

    RtDoubles inverse = 1 / height;
    put_function(f->depth, at, drawing, normal, inverse);
    RtDoubles slope = gradient(projection, normal) * rt_abs(inverse) * g, e = far * 0x1p-19;
    RtDoubles none = slope * (2 * b + 0x1p-13 * coarse) + rough / far * 4;
    RtDoubles once = (e * slope + b) * 2 + rough * 4;
    rt_store_doubles(&f->depth_error[0][at], none);
    rt_store_doubles(&f->depth_error[1][at], once + 0x1p-19);
    rt_store_doubles(&f->depth_error[2][at], e * 2);

    /* If the side from which a facet is seen is unknown, its edges bound nothing. */
    uint32_t known = rt_le_bits(rough, rt_all_doubles(0x1p-4));
    for (size_t k = 0; k < RT_HALF; k++) {
        if (!(known >> k & 1)) f->edge_error[0][at + k] = f->depth_error[0][at + k] = INFINITY;
    }
}

/* ---- drawing ---- */

RT_KERNEL RtFloats function(const float of[3][RT_ITEM_FACETS], uint32_t k, RtFloats column, RtFloats row) {
    return of[0][k] + of[1][k] * column + of[2][k] * row;
}

RT_KERNEL void update_least(RtItemTile *tile, uint32_t block) {
    const float *lo = &tile->lo[(size_t)block * RT_ITEM_BLOCK_SAMPLES];
    RtFloats least = rt_load(lo);
    for (int i = RT_LANES; i < RT_ITEM_BLOCK_SAMPLES; i += RT_LANES) least = rt_min(least, rt_load(lo + i));
    tile->least[block] = rt_least(least);
}

/* Draws facet k at the samples first..first+RT_LANES-1 that are in `lanes`, where it may be nearest. Returns
 * the samples of which the block's least w does not know yet. */
RT_KERNEL uint32_t draw_samples(RtItemDrawing *d, uint32_t first, const RtItemFacets *f, uint32_t k,
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
    if (!front) return 0;

    RtFloats margin = f->edge_error[1][k] * hi + f->edge_error[0][k], outside = -margin;
    uint32_t inside = rt_bits(known);
    for (uint32_t i = 0; i < edges; i++) {
        RtFloats edge = function(f->edge[i], k, column, row);
        front &= ~rt_lt_bits(edge, outside);
        inside &= rt_lt_bits(margin, edge);
    }
    front &= rt_le_bits(lo, rt_all(d->nearest));
    if (!front) return 0;
    inside &= rt_le_bits(hi * (1 + 0x1p-18f), rt_all(d->nearest));
    uint32_t clear = front & inside & rt_lt_bits(rt_load(tile_hi), lo);
    if (clear) {
        rt_store_lanes(tile_lo, clear, (RtInts)lo);
        rt_store_lanes(tile_hi, clear, (RtInts)hi);
        rt_store_lanes(&tile->t[first], clear, (RtInts)rt_all(-1));
        rt_store_lanes(&tile->id[first], clear, rt_all_ints((int32_t)f->id[k]));
    }
    front &= ~clear;
    if (!front) return clear;
    float los[RT_LANES], his[RT_LANES];
    rt_store(los, lo);
    rt_store(his, hi);
    for (; front; front &= front - 1) {
        uint32_t lane = (uint32_t)__builtin_ctz(front);
        rt_item_resolve(d, first + lane, f->id[k], los[lane], his[lane], inside >> lane & 1);
    }
    return clear;
}

enum {
    MANY_BLOCKS = 4, /* from so many on, blocks are tested against the edges first */
    AHEAD = 24       /* objects from a triangle to the one that is prefetched meanwhile */
};

/* Bit i: facet k may be seen in block i of some rows of blocks. An edge is largest in a block at the corner
 * on its inner side. */
RT_KERNEL uint64_t blocks_of(const RtItemDrawing *d, const RtItemFacets *f, uint32_t k, uint32_t edges,
                             uint32_t first_row, uint32_t last_row) {
    const float last = RT_ITEM_BLOCK - 1;
    const RtFloats outside = rt_all(-(f->edge_error[0][k] + f->edge_error[1][k] * f->most[k]));
    uint64_t open = 0;
    for (uint32_t i = first_row * RT_ITEM_ACROSS / RT_LANES * RT_LANES; i < (last_row + 1) * RT_ITEM_ACROSS;
         i += RT_LANES) {
        RtInts block = rt_lane_numbers() + (int32_t)i;
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
    uint32_t in[2], first[2], last[2]; /* samples, a bit each, and blocks */
    for (int a = 0; a < 2; a++) {
        uint32_t lo = (uint32_t)f->lo[a][k], hi = (uint32_t)f->hi[a][k];
        in[a] = ~0u << lo & ~0u >> (RT_ITEM_TILE - 1 - hi);
        first[a] = lo / RT_ITEM_BLOCK;
        last[a] = hi / RT_ITEM_BLOCK;
    }
    uint64_t open =
        (0xffu << first[0] & 0xffu >> (RT_ITEM_ACROSS - 1 - last[0])) * UINT64_C(0x0101010101010101);
    open &= ~UINT64_C(0) << 8 * first[1] & ~UINT64_C(0) >> 8 * (RT_ITEM_ACROSS - 1 - last[1]);
    if (__builtin_popcountll(open) >= MANY_BLOCKS) open &= blocks_of(d, f, k, edges, first[1], last[1]);
    for (; open; open &= open - 1) {
        uint32_t block = (uint32_t)__builtin_ctzll(open), x = block % RT_ITEM_ACROSS,
                 y = block / RT_ITEM_ACROSS;
        if (f->most[k] < d->tile.least[block]) continue;
        uint32_t column = x * RT_ITEM_BLOCK, row = y * RT_ITEM_BLOCK, some = in[1] >> row & 15, changed = 0;
        some = ((some | some << 3 | some << 6 | some << 9) & 0x1111) * 15 & (in[0] >> column & 15) * 0x1111;
        RtFloats columns = rt_raster_columns((float)column);
        for (uint32_t i = 0; i < RT_ITEM_BLOCK_SAMPLES; i += RT_LANES) {
            uint32_t lanes = some >> i & ((1u << RT_LANES) - 1);
            if (!lanes) continue;
            uint32_t first_row = row + i / RT_ITEM_BLOCK;
            RtFloats rows = rt_raster_rows((float)first_row);
            changed |= draw_samples(d, block * RT_ITEM_BLOCK_SAMPLES + i, f, k, edges, lanes, columns, rows);
        }
        if (changed) update_least(&d->tile, block);
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
    make_half(d, v, 0, f);
    if (there >> RT_HALF) make_half(d, v, 1, f);
    for (int a = 0; a < 2; a++) {
        rt_store(f->lo[a], rt_to_ints(rt_max(b.lo[a] - corner[a], rt_all(0))));
        rt_store(f->hi[a], rt_to_ints(rt_min(b.hi[a] - corner[a], rt_all(RT_ITEM_TILE - 1))));
    }
    rt_store(f->most, b.most);
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

/* Writes the triangles that may be seen beside what is drawn to `to`, which has room for RT_LANES; returns
 * how many they are. */
RT_KERNEL uint32_t not_hidden(const RtItemDrawing *d, const LaneProjection *projection,
                              const uint32_t *triangles, uint32_t count, uint32_t *to) {
    const RtFloats corner[2] = {rt_all((float)d->column), rt_all((float)d->row)};
    const RtFloats zero = rt_all(0), last = rt_all(RT_ITEM_TILE - 1);
    RtFloats v[3][3];
    RtInts lo[2], hi[2];
    Bounds b;
    rt_raster_gather(rt_item_geometry(d->buffer), triangles, count, v);
    bound(projection, v, &b);
    for (int a = 0; a < 2; a++) {
        lo[a] = rt_to_ints(rt_max(b.lo[a] - corner[a], zero)) / RT_ITEM_BLOCK;
        hi[a] = rt_to_ints(rt_min(b.hi[a] - corner[a], last)) / RT_ITEM_BLOCK;
    }
    RtFloats least = rt_all(INFINITY);
    for (int i = 0; i < 4; i++) {
        RtInts block = (i & 2 ? hi[1] : lo[1]) * RT_ITEM_ACROSS + (i & 1 ? hi[0] : lo[0]);
        least = rt_min(least, rt_gather(d->tile.least, block & (RT_ITEM_BLOCKS - 1)));
    }
    uint32_t few = rt_bits((hi[0] - lo[0] < 2) & (hi[1] - lo[1] < 2));
    uint32_t hidden = (few & rt_lt_bits(b.most, least)) | rt_lt_bits(b.most, rt_all(farthest(&d->tile)));
    uint32_t seen = rt_raster_first_lanes(count) & ~(hidden & b.known);
    rt_compress_store(to, seen, rt_load_ints(triangles));
    return (uint32_t)__builtin_popcount(seen);
}

static void draw(RtItemDrawing *d, const RtRef *objects, size_t count) {
    const RtTriangle *triangles = rt_item_geometry(d->buffer)->triangles;
    RtItemFacets facets;
    LaneProjection projection;
    RtRef seen[2 * RT_LANES] = {0};
    uint32_t seen_count = 0;
    make_lane_projection(&projection, d->buffer);
    for (size_t i = 0; i < count;) {
        RtRef some[RT_LANES];
        uint32_t some_count = 0;
        for (; i < count && some_count < RT_LANES; i++) {
            if (!rt_raster_is_triangle(objects[i])) continue;
            const RtTriangle *ahead = &triangles[rt_ref_index(objects[i + AHEAD < count ? i + AHEAD : i])];
            __builtin_prefetch(ahead);
            __builtin_prefetch(&ahead->v[2].z);
            some[some_count++] = objects[i];
        }
        if (some_count > 0) seen_count += not_hidden(d, &projection, some, some_count, seen + seen_count);
        while (seen_count >= RT_LANES || (i >= count && seen_count > 0)) {
            uint32_t drawn = seen_count < RT_LANES ? seen_count : RT_LANES;
            draw_triangles(d, &projection, seen, drawn, &facets);
            rt_store(seen, rt_load_ints(seen + RT_LANES));
            seen_count -= drawn;
        }
    }
}

static void draw_facet(RtItemDrawing *d, const RtItemFacets *facets, uint32_t edges) {
    draw_one(d, facets, 0, edges);
}

#endif
