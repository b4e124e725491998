/* SPDX-License-Identifier: Apache-2.0 */
/* The rays of a block, and the lookup of their cells, RT_LANES at a time. */
#ifndef RT_ACCEL_LIGHT_LIGHT_LOOKUP_H
#define RT_ACCEL_LIGHT_LIGHT_LOOKUP_H

#include "accel/light/light_project.h"
#include "core/base/simd_across.h"

#include <string.h>

/* Rays, and entries that a ray looks at in a round: one, two, and then so many. */
enum { BLOCK = 1024, DEEPEST = 4 };

/* Rays that go through lists: number in the block, the next entry and the end; a key's depth, and below
 * it the number of the part of the cell. */
typedef struct Cursors {
    uint32_t ray[BLOCK + 16], at[BLOCK + 16], end[BLOCK + 16], key[BLOCK + 16];
} Cursors;

typedef struct Stream {
    Cursors cursors;
    uint32_t pair_ray[DEEPEST * BLOCK + 16], pair_object[DEEPEST * BLOCK + 16];
    uint32_t other_ray[DEEPEST * BLOCK + 16], other_object[DEEPEST * BLOCK + 16]; /* no triangles */
    uint32_t ended[BLOCK + 16], ended_count; /* of the light, at the end of a list that was cut */
    uint32_t passed[BLOCK + 1], passed_count;
    uint32_t passed_occluders[BLOCK];
    RtRay passed_rays[BLOCK];
} Stream;

/* A block of rays. */
typedef struct RayBatch {
    const RtLightBuffer *self;
    const RtScratch *scratch;
    Stream *stream;
    const RtRay *rays;
    uint32_t *occluders;
    RtTally *tally;
} RayBatch;

/* ---- from rays to cells ---- */

/* RT_LANES rays to one light, or fewer. */
typedef struct LightRays {
    RtFloats org[3], tmin;
    RtFloats dir[3]; /* light - org, which is the ray's own if it is served */
} LightRays;

/* Sets origins, tmin, and directions to the light. */
RT_KERNEL void load_origins(const RayBatch *batch, uint32_t light, const uint32_t *order, uint32_t count,
                            LightRays *s) {
    const RtVec3 position = batch->self->isa.base.scene->lights[light].position;
    const float *from[RT_LANES];
    RtFloats four[4];
    for (uint32_t i = 0; i < RT_LANES; i++) from[i] = &batch->rays[order[i < count ? i : 0]].org.x;
    rt_load_columns(from, four);
    for (int k = 0; k < 3; k++) {
        s->org[k] = four[k];
        s->dir[k] = position.at[k] - four[k];
    }
    s->tmin = four[3];
}

/* The rays that the lists are made for. */
RT_KERNEL uint32_t to_light(const RayBatch *batch, const uint32_t *order, uint32_t count,
                            const LightRays *s) {
    const RtLightBuffer *self = batch->self;
    const float *from[RT_LANES];
    RtFloats four[4]; /* dir and tmax */
    for (uint32_t i = 0; i < RT_LANES; i++) from[i] = &batch->rays[order[i < count ? i : 0]].dir.x;
    rt_load_columns(from, four);
    uint32_t good = rt_le_bits(four[3], rt_all(1));
    for (int a = 0; a < 3; a++) {
        good &= rt_eq_bits((RtInts)s->dir[a], (RtInts)four[a]); /* bit by bit */
        good &= rt_le_bits(rt_all(self->domain.lo.at[a]), s->org[a]);
        good &= rt_le_bits(s->org[a], rt_all(self->domain.hi.at[a]));
    }
    return good;
}

RT_KERNEL RtFloats whole(RtFloats a) {
    return rt_to_floats(rt_to_ints(a));
}

/* Finds the cells of the rays in `lanes`, which are on this face, and appends the rays to the cursors. */
RT_KERNEL uint32_t enter_cells(const RtLightCube *cube, int face, const LightRays *s, uint32_t lanes,
                               const uint32_t *order, Cursors *cursors, uint32_t count) {
    const RtLightGrid *grid = &cube->grids[face];
    const int z = face / 2, x = (z + 1) % 3, y = (z + 2) % 3;
    const RtFloats zero = rt_all(0), scale = rt_all(grid->scale);
    if (grid->columns == 0) return count;
    RtFloats inv = 1 / s->dir[z];
    RtFloats u = s->dir[x] * inv, w = s->dir[y] * inv;
    if (face % 2 == 0) u = zero - u, w = zero - w;
    u = (u - grid->u) * scale;
    w = (w - grid->w) * scale;
    lanes &= rt_le_bits(zero, u) & ~rt_le_bits(rt_all((float)grid->columns), u);
    lanes &= rt_le_bits(zero, w) & ~rt_le_bits(rt_all((float)grid->rows), w);
    if (!lanes) return count;

    /* The tile, and then the cell: products of small whole numbers are exact. */
    const RtInts none = rt_all_ints(0);
    RtFloats column = whole(u), row = whole(w);
    RtInts tile = rt_to_ints(row * (float)grid->columns + column);
    tile = rt_select_bits(lanes, tile + (int32_t)grid->first_tile, none);
    tile = rt_gather_words(cube->tiles, tile, 1);
    RtFloats n = rt_to_floats(tile & 63);
    u = (u - column) * n;
    w = (w - row) * n;
    RtFloats last = n - 1; /* what is just below n may be rounded to it */
    column = rt_min(whole(u), last);
    row = rt_min(whole(w), last);
    RtInts cell = rt_to_ints(row * n + column);
    cell = cell + (int32_t)grid->first_cell + (RtInts)((RtWords)tile >> 6);
    cell = rt_select_bits(lanes, cell, none);
    RtInts at = rt_gather_words(cube->first, cell, 1), end = rt_gather_words(cube->first + 1, cell, 1);
    lanes &= rt_lt_bits(at, end);

    RtFloats depth = rt_abs(s->dir[z]);
    depth += depth * 0x1p-22f;
    const RtInts most = rt_all_ints(RT_LIGHT_PART - 1);
    RtInts part_x = rt_min(rt_to_ints((u - column) * RT_LIGHT_PART), most);
    RtInts part_y = rt_min(rt_to_ints((w - row) * RT_LIGHT_PART), most);
    RtInts key = depth_steps(grid, depth) << 16 | part_y << 2 | part_x;

    rt_compress_store(cursors->ray + count, lanes, rt_load_ints(order));
    rt_compress_store(cursors->at + count, lanes, at);
    rt_compress_store(cursors->end + count, lanes, end);
    rt_compress_store(cursors->key + count, lanes, key);
    uint32_t after = count + (uint32_t)__builtin_popcount(lanes);
    for (uint32_t i = count; i < after; i++) __builtin_prefetch(&cube->entries[cursors->at[i]]);
    return after;
}

/* Tests the objects that touch the light; returns the rays without a hit. */
RT_KERNEL uint32_t test_near(const RayBatch *batch, const RtLightCube *cube, uint32_t lanes,
                             const uint32_t *order) {
    const RtGeometry *g = &batch->self->isa.base.scene->geometry;
    uint32_t left = lanes;
    for (; lanes; lanes &= lanes - 1) {
        uint32_t i = (uint32_t)__builtin_ctz(lanes);
        RtPreparedRay prepared;
        RtHit hit = RT_MISS;
        rt_hit_ray(&prepared, g, &batch->rays[order[i]], batch->scratch->crossings);
        for (uint32_t k = 0; k < cube->near_count && hit.object == RT_NO_OBJECT; k++) {
            RT_COUNT(batch->tally, steps, 1);
            RT_OBSERVE(batch->tally, .kind = RT_TRACED_STEP, .what = "object", .index = cube->near[k]);
            rt_test_object(g, cube->near[k], &prepared, true, &hit, batch->tally);
        }
        if (hit.object == RT_NO_OBJECT) continue;
        batch->occluders[order[i]] = hit.object;
        left &= ~(1u << i);
    }
    return left;
}

/* All rays order[0..count) to a light; returns how many go through lists. */
RT_KERNEL uint32_t begin_light(const RayBatch *batch, uint32_t light, const uint32_t *order, uint32_t count) {
    const RtLightCube *cube = &batch->self->cubes[light];
    Stream *stream = batch->stream;
    uint32_t on_way = 0;
    for (uint32_t first = 0; first < count; first += RT_LANES) {
        uint32_t padded[RT_LANES];
        const uint32_t *some = order + first;
        uint32_t n = count - first < RT_LANES ? count - first : RT_LANES, lanes = (1u << n) - 1;
        if (n < RT_LANES) some = memcpy(padded, some, n * sizeof *some);
        LightRays s;
        load_origins(batch, light, some, n, &s);
        uint32_t good = lanes & to_light(batch, some, n, &s);
        for (uint32_t bad = lanes & ~good; bad; bad &= bad - 1)
            stream->passed[stream->passed_count++] = some[__builtin_ctz(bad)];
        if (cube->near_count > 0) good = test_near(batch, cube, good, some);
        RtInts y_set, z_set;
        rt_major_axes(s.dir, &y_set, &z_set);
        uint32_t z = rt_bits(z_set), y = rt_bits(y_set) & ~z;
        const uint32_t axis[3] = {~z & ~y, y, z};
        for (int face = 0; face < 6; face++) {
            uint32_t down = rt_bits((RtInts)s.dir[face / 2]);
            uint32_t here = good & axis[face / 2] & (face % 2 ? down : ~down);
            if (here) on_way = enter_cells(cube, face, &s, here, some, &stream->cursors, on_way);
        }
    }
    return on_way;
}

#endif
