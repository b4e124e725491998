/* SPDX-License-Identifier: Apache-2.0 */
/* The rays of a block, and the lookup of their cells, sixteen in lanes. */
#ifndef RT_ACCEL_LIGHT_LIGHT_LOOKUP_H
#define RT_ACCEL_LIGHT_LIGHT_LOOKUP_H

#include "accel/light/light_project.h"

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

/* Sixteen rays to one light, or fewer. */
typedef struct Sixteen {
    RtV16 org[3], tmin;
    RtV16 dir[3]; /* light - org, which is the ray's own if it is served */
} Sixteen;

/* Their origins, and all that follows from them. */
RT_KERNEL void load_origins(const RayBatch *batch, uint32_t light, const uint32_t *order, uint32_t count,
                            Sixteen *s) {
    const RtVec3 position = batch->self->isa.base.scene->lights[light].position;
    const float *from[16];
    RtV16 four[4];
    for (uint32_t i = 0; i < 16; i++) from[i] = &batch->rays[order[i < count ? i : 0]].org.x;
    rt_v16_columns(from, four);
    for (int k = 0; k < 3; k++) {
        s->org[k] = four[k];
        s->dir[k] = rt_v16_sub(rt_v16_all(position.at[k]), four[k]);
    }
    s->tmin = four[3];
}

/* The rays that the lists are made for. */
RT_KERNEL uint32_t to_light(const RayBatch *batch, const uint32_t *order, uint32_t count, const Sixteen *s) {
    const RtLightBuffer *self = batch->self;
    const float *from[16];
    RtV16 four[4]; /* dir and tmax */
    for (uint32_t i = 0; i < 16; i++) from[i] = &batch->rays[order[i < count ? i : 0]].dir.x;
    rt_v16_columns(from, four);
    uint32_t good = rt_v16_at_most(four[3], rt_v16_all(1));
    for (int a = 0; a < 3; a++) {
        good &= rt_w16_equal(rt_w16_of(s->dir[a]), rt_w16_of(four[a])); /* bit by bit */
        good &= rt_v16_at_most(rt_v16_all(self->domain.lo.at[a]), s->org[a]);
        good &= rt_v16_at_most(s->org[a], rt_v16_all(self->domain.hi.at[a]));
    }
    return good;
}

RT_KERNEL RtV16 whole(RtV16 a) {
    return rt_v16_of_words(rt_w16_truncate(a));
}

/* Puts the rays of `lanes`, which are in this face, on their way: appends them to the cursors. */
RT_KERNEL uint32_t enter_cells(const RtLightCube *cube, int face, const Sixteen *s, uint32_t lanes,
                               const uint32_t *order, Cursors *cursors, uint32_t count) {
    const RtLightGrid *grid = &cube->grids[face];
    const int z = face / 2, x = (z + 1) % 3, y = (z + 2) % 3;
    const RtV16 zero = rt_v16_all(0), scale = rt_v16_all(grid->scale);
    if (grid->columns == 0) return count;
    RtV16 inv = rt_v16_div(rt_v16_all(1), s->dir[z]);
    RtV16 u = rt_v16_mul(s->dir[x], inv), w = rt_v16_mul(s->dir[y], inv);
    if (face % 2 == 0) u = rt_v16_sub(zero, u), w = rt_v16_sub(zero, w);
    u = rt_v16_mul(rt_v16_sub(u, rt_v16_all(grid->u)), scale);
    w = rt_v16_mul(rt_v16_sub(w, rt_v16_all(grid->w)), scale);
    lanes &= rt_v16_at_most(zero, u) & ~rt_v16_at_most(rt_v16_all((float)grid->columns), u);
    lanes &= rt_v16_at_most(zero, w) & ~rt_v16_at_most(rt_v16_all((float)grid->rows), w);
    if (!lanes) return count;

    /* The tile, and then the cell: products of small whole numbers are exact. */
    const RtW16 none = rt_w16_all(0);
    RtV16 column = whole(u), row = whole(w);
    RtW16 tile = rt_w16_truncate(rt_v16_add(rt_v16_mul(row, rt_v16_all((float)grid->columns)), column));
    tile = rt_w16_pick(lanes, none, rt_w16_add(tile, rt_w16_all(grid->first_tile)));
    tile = rt_w16_lookup(cube->tiles, tile);
    RtV16 n = rt_v16_of_words(rt_w16_and(tile, rt_w16_all(63)));
    u = rt_v16_mul(rt_v16_sub(u, column), n);
    w = rt_v16_mul(rt_v16_sub(w, row), n);
    RtV16 last = rt_v16_sub(n, rt_v16_all(1)); /* what is just below n may be rounded to it */
    column = rt_v16_min(whole(u), last);
    row = rt_v16_min(whole(w), last);
    RtW16 cell = rt_w16_truncate(rt_v16_add(rt_v16_mul(row, n), column));
    cell = rt_w16_add(rt_w16_add(cell, rt_w16_all(grid->first_cell)), rt_w16_right(tile, 6));
    cell = rt_w16_pick(lanes, none, cell);
    RtW16 at = rt_w16_lookup(cube->first, cell), end = rt_w16_lookup(cube->first + 1, cell);
    lanes &= rt_w16_below(at, end);

    RtV16 depth = rt_v16_abs(s->dir[z]);
    depth = rt_v16_add(depth, rt_v16_mul(depth, rt_v16_all(0x1p-22f)));
    const RtV16 parts = rt_v16_all(RT_LIGHT_PART);
    const RtW16 most = rt_w16_all(RT_LIGHT_PART - 1);
    RtW16 part_x = rt_w16_least(rt_w16_truncate(rt_v16_mul(rt_v16_sub(u, column), parts)), most);
    RtW16 part_y = rt_w16_least(rt_w16_truncate(rt_v16_mul(rt_v16_sub(w, row), parts)), most);
    RtW16 part = rt_w16_or(part_x, rt_w16_left(part_y, 2));
    RtW16 key = rt_w16_or(rt_w16_left(depth_steps(grid, depth), 16), part);

    rt_w16_put_some(cursors->ray + count, lanes, rt_w16_get(order));
    rt_w16_put_some(cursors->at + count, lanes, at);
    rt_w16_put_some(cursors->end + count, lanes, end);
    rt_w16_put_some(cursors->key + count, lanes, key);
    uint32_t after = count + (uint32_t)__builtin_popcount(lanes);
    for (uint32_t i = count; i < after; i++) __builtin_prefetch(&cube->entries[cursors->at[i]]);
    return after;
}

/* Tests the objects that touch the light; returns the rays that are left. */
RT_KERNEL uint32_t test_near(const RayBatch *batch, const RtLightCube *cube, uint32_t lanes,
                             const uint32_t *order) {
    const RtGeometry *g = &batch->self->isa.base.scene->geometry;
    uint32_t left = lanes;
    for (; lanes; lanes &= lanes - 1) {
        uint32_t i = (uint32_t)__builtin_ctz(lanes);
        RtPreparedRay prepared;
        RtHit hit = RT_MISS;
        rt_hit_ray(&prepared, g, &batch->rays[order[i]], batch->scratch->room);
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

/* rt_major_axis, the first of the largest: z, or else y, or else x. */
RT_KERNEL void major_axes(const RtV16 dir[3], RtSet16 *y, RtSet16 *z) {
    RtV16 size[3];
    for (int k = 0; k < 3; k++) size[k] = rt_v16_abs(dir[k]);
    *y = rt_v16_below(size[0], size[1]);
    *z = rt_v16_below(rt_v16_max(size[0], size[1]), size[2]);
}

/* All rays order[0..count) to a light; returns how many go through lists. */
RT_KERNEL uint32_t begin_light(const RayBatch *batch, uint32_t light, const uint32_t *order, uint32_t count) {
    const RtLightCube *cube = &batch->self->cubes[light];
    Stream *stream = batch->stream;
    uint32_t on_way = 0;
    for (uint32_t first = 0; first < count; first += 16) {
        _Alignas(64) uint32_t padded[16];
        const uint32_t *some = order + first;
        uint32_t n = count - first < 16 ? count - first : 16, lanes = (1u << n) - 1;
        if (n < 16) some = memcpy(padded, some, n * sizeof *some);
        Sixteen s;
        load_origins(batch, light, some, n, &s);
        uint32_t good = lanes & to_light(batch, some, n, &s);
        for (uint32_t bad = lanes & ~good; bad; bad &= bad - 1)
            stream->passed[stream->passed_count++] = some[__builtin_ctz(bad)];
        if (cube->near_count > 0) good = test_near(batch, cube, good, some);
        RtSet16 y_set, z_set;
        major_axes(s.dir, &y_set, &z_set);
        uint32_t z = rt_v16_bits(z_set), y = rt_v16_bits(y_set) & ~z;
        const uint32_t axis[3] = {~z & ~y, y, z};
        for (int face = 0; face < 6; face++) {
            uint32_t down = rt_v16_signs(s.dir[face / 2]);
            uint32_t here = good & axis[face / 2] & (face % 2 ? down : ~down);
            if (here) on_way = enter_cells(cube, face, &s, here, some, &stream->cursors, on_way);
        }
    }
    return on_way;
}

#endif
