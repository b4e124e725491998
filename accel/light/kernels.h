/* SPDX-License-Identifier: Apache-2.0 */
/* Answering shadow rays in streams; included once for each instruction set: RT_LIGHT_KERNELS is the name of
 * the table that is defined.
 *
 * Of a stream a block of rays is taken at a time, light by light. First each ray finds its cell, sixteen in
 * lanes. Then the rays that have a list go through it in rounds, of one entry, of two, and of four: those
 * whose entry is not deeper and is seen in their part of the cell make pairs of a ray and an object, which
 * are tested in lanes where they are triangles. Who is blocked, or at the end of its list, drops out. What a
 * ray does depends on no other, so that counts are the same in streams of any length. Rays at the end of a
 * list that was cut, and those that are not exactly what a shadow ray is, are passed on together.
 *
 * A step is an entry looked at that is not deeper than the ray; an extent test that of the part of the cell,
 * and of the side of a polygon or sphere (side.h). */
#include "accel/light/light.h"
#include "accel/light/raster.h"
#include "accel/light/side.h"

#include <string.h>

/* Rays, and entries that a ray looks at in a round: one, two, and then so many. */
enum { BLOCK = 1024, DEEPEST = 4 };

/* Rays on their way through lists: number in the block, the next entry and the end; a key's depth, and below
 * it the number of the part of the cell. */
typedef struct Way {
    uint32_t ray[BLOCK + 16], at[BLOCK + 16], end[BLOCK + 16], key[BLOCK + 16];
} Way;

typedef struct Stream {
    Way way;
    uint32_t pair_ray[DEEPEST * BLOCK + 16], pair_object[DEEPEST * BLOCK + 16];
    uint32_t other_ray[DEEPEST * BLOCK + 16], other_object[DEEPEST * BLOCK + 16]; /* no triangles */
    uint32_t ended[BLOCK + 16], ended_count; /* of the light, at the end of a list that was cut */
    uint32_t passed[BLOCK + 1], passed_count;
    uint32_t passed_blockers[BLOCK];
    RtRay passed_rays[BLOCK];
} Stream;

/* What all rays of a block share. */
typedef struct Asking {
    const RtLightBuffer *self;
    const RtScratch *scratch;
    Stream *stream;
    const RtRay *rays;
    uint32_t *blockers;
    RtTally *tally;
} Asking;

/* ---- from rays to cells ---- */

/* Sixteen rays to one light, or fewer. */
typedef struct Sixteen {
    RtV16 org[3], tmin;
    RtV16 dir[3]; /* light - org, which is the ray's own if it is served */
} Sixteen;

/* Their origins, and all that follows from them. */
RT_KERNEL void load_origins(const Asking *a, uint32_t light, const uint32_t *order, uint32_t count,
                            Sixteen *s) {
    const RtVec3 position = a->self->base.scene->lights[light].position;
    const float *from[16];
    RtV16 four[4];
    for (uint32_t i = 0; i < 16; i++) from[i] = &a->rays[order[i < count ? i : 0]].org.x;
    rt_v16_columns(from, four);
    for (int k = 0; k < 3; k++) {
        s->org[k] = four[k];
        s->dir[k] = rt_v16_sub(rt_v16_all(position.at[k]), four[k]);
    }
    s->tmin = four[3];
}

/* Those that the lists are made for. */
RT_KERNEL uint32_t to_light(const Asking *q, const uint32_t *order, uint32_t count, const Sixteen *s) {
    const RtLightBuffer *self = q->self;
    const float *from[16];
    RtV16 four[4]; /* dir and tmax */
    for (uint32_t i = 0; i < 16; i++) from[i] = &q->rays[order[i < count ? i : 0]].dir.x;
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

/* Puts the rays of `lanes`, which see the light from its face, on their way. */
RT_KERNEL uint32_t enter_cells(const RtLightCube *cube, int face, const Sixteen *s, uint32_t lanes,
                               const uint32_t *order, Way *way, uint32_t count) {
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
    cell = rt_w16_pick(lanes, none, rt_w16_add(cell, rt_w16_right(tile, 6)));
    RtW16 at = rt_w16_lookup(cube->first, cell), end = rt_w16_lookup(cube->first + 1, cell);
    lanes &= rt_w16_below(at, end);

    RtV16 depth = rt_v16_abs(s->dir[z]);
    depth = rt_v16_add(depth, rt_v16_mul(depth, rt_v16_all(0x1p-22f)));
    depth = rt_v16_mul(rt_v16_sub(depth, rt_v16_all(grid->depth)), rt_v16_all(grid->depth_scale));
    depth = rt_v16_min(rt_v16_max(depth, zero), rt_v16_all(RT_LIGHT_DEPTHS - 1));
    const RtV16 parts = rt_v16_all(RT_LIGHT_PART);
    const RtW16 most = rt_w16_all(RT_LIGHT_PART - 1);
    RtW16 part_x = rt_w16_least(rt_w16_truncate(rt_v16_mul(rt_v16_sub(u, column), parts)), most);
    RtW16 part_y = rt_w16_least(rt_w16_truncate(rt_v16_mul(rt_v16_sub(w, row), parts)), most);
    RtW16 part = rt_w16_or(part_x, rt_w16_left(part_y, 2));
    RtW16 key = rt_w16_or(rt_w16_left(rt_w16_truncate(depth), 16), part);

    rt_w16_put_some(way->ray + count, lanes, rt_w16_get(order));
    rt_w16_put_some(way->at + count, lanes, at);
    rt_w16_put_some(way->end + count, lanes, end);
    rt_w16_put_some(way->key + count, lanes, key);
    uint32_t after = count + (uint32_t)__builtin_popcount(lanes);
    for (uint32_t i = count; i < after; i++) __builtin_prefetch(&cube->entries[way->at[i]]);
    return after;
}

/* Tests the objects that touch the light; gives the rays that are left. */
RT_KERNEL uint32_t test_near(const Asking *a, const RtLightCube *cube, uint32_t lanes,
                             const uint32_t *order) {
    const RtGeometry *g = &a->self->base.scene->geometry;
    uint32_t left = lanes;
    for (; lanes; lanes &= lanes - 1) {
        uint32_t i = (uint32_t)__builtin_ctz(lanes);
        RtPreparedRay prepared;
        RtHit hit = RT_MISS;
        rt_hit_ray(&prepared, g, &a->rays[order[i]], a->scratch->room);
        for (uint32_t k = 0; k < cube->near_count && hit.object == RT_NO_OBJECT; k++) {
            RT_COUNT(a->tally, steps, 1);
            rt_test_object(g, cube->near[k], &prepared, true, &hit, a->tally);
        }
        if (hit.object == RT_NO_OBJECT) continue;
        a->blockers[order[i]] = hit.object;
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

RT_KERNEL uint32_t set_bits(RtSet16 set) {
#if defined(__AVX512F__)
    return set;
#else
    return rt_v16_signs(set);
#endif
}

/* All rays order[0..count) to a light; gives how many are on their way. */
RT_KERNEL uint32_t begin_light(const Asking *a, uint32_t light, const uint32_t *order, uint32_t count) {
    const RtLightCube *cube = &a->self->cubes[light];
    Stream *stream = a->stream;
    uint32_t on_way = 0;
    for (uint32_t first = 0; first < count; first += 16) {
        _Alignas(64) uint32_t padded[16];
        const uint32_t *some = order + first;
        uint32_t n = count - first < 16 ? count - first : 16, lanes = (1u << n) - 1;
        if (n < 16) some = memcpy(padded, some, n * sizeof *some);
        Sixteen s;
        load_origins(a, light, some, n, &s);
        uint32_t good = lanes & to_light(a, some, n, &s);
        for (uint32_t bad = lanes & ~good; bad; bad &= bad - 1)
            stream->passed[stream->passed_count++] = some[__builtin_ctz(bad)];
        if (cube->near_count > 0) good = test_near(a, cube, good, some);
        RtSet16 y_set, z_set;
        major_axes(s.dir, &y_set, &z_set);
        uint32_t z = set_bits(z_set), y = set_bits(y_set) & ~z;
        const uint32_t axis[3] = {~z & ~y, y, z};
        for (int face = 0; face < 6; face++) {
            uint32_t down = rt_v16_signs(s.dir[face / 2]);
            uint32_t here = good & axis[face / 2] & (face % 2 ? down : ~down);
            if (here) on_way = enter_cells(cube, face, &s, here, some, &stream->way, on_way);
        }
    }
    return on_way;
}

/* ---- a round ---- */

/* The triangles of sixteen pairs, or fewer. */
RT_KERNEL void load_triangles(const RtGeometry *g, const uint32_t *objects, uint32_t count, RtV16 v[3][3]) {
    const RtTriangle *at[16];
    for (uint32_t i = 0; i < 16; i++) at[i] = &g->triangles[rt_ref_index(objects[i < count ? i : 0])];
    rt_pairs_gather(at, v);
}

/* Sixteen pairs, or fewer, of a ray to one light and a triangle. */
RT_KERNEL void load_pairs(const Asking *a, uint32_t light, const uint32_t *ray, const uint32_t *object,
                          uint32_t count, RtPairs *pairs) {
    const RtGeometry *g = &a->self->base.scene->geometry;
    const RtTriangle *at[16];
    Sixteen s;
    load_origins(a, light, ray, count, &s);
    for (uint32_t i = 0; i < 16; i++) at[i] = &g->triangles[rt_ref_index(object[i < count ? i : 0])];
    rt_pairs_gather(at, pairs->v);
    for (int k = 0; k < 3; k++) pairs->org[k] = s.org[k], pairs->dir[k] = s.dir[k];
    pairs->tmin = s.tmin;
}

/* Those that the first test of rt_triangle_hit lets pass. */
RT_KERNEL uint32_t sieve_pairs(const RtPairs *p) {
    RtV16 x[3], y[3], z[3];
    RtSet16 in_y, in_z;
    major_axes(p->dir, &in_y, &in_z);
    RtV16 inv = rt_v16_div(rt_v16_all(1), rt_pairs_along(p->dir, in_y, in_z, 0));
    const RtSieveLine line = {rt_pairs_along(p->org, in_y, in_z, 1), rt_pairs_along(p->org, in_y, in_z, 2),
                              rt_pairs_along(p->org, in_y, in_z, 0),
                              rt_v16_mul(rt_pairs_along(p->dir, in_y, in_z, 1), inv),
                              rt_v16_mul(rt_pairs_along(p->dir, in_y, in_z, 2), inv)};
    for (int i = 0; i < 3; i++) {
        x[i] = rt_pairs_along(p->v[i], in_y, in_z, 1);
        y[i] = rt_pairs_along(p->v[i], in_y, in_z, 2);
        z[i] = rt_pairs_along(p->v[i], in_y, in_z, 0);
    }
    rt_sieve_shear(&line, x, y, z);
    return rt_sieve(x, y);
}

/* Tests pairs in full. */
RT_KERNEL void hit_pairs(const Asking *a, const uint32_t *ray, const uint32_t *object, uint32_t count,
                         RtPairs *pairs) {
    const RtGeometry *g = &a->self->base.scene->geometry;
    _Alignas(64) float tmax[16];
    RtV16 t;
    for (uint32_t i = 0; i < 16; i++) tmax[i] = a->rays[ray[i < count ? i : 0]].tmax;
    pairs->tmax = rt_v16_load(tmax);
    uint32_t hit = rt_pairs_hit(pairs, &t) & ((1u << count) - 1);
    RT_COUNT(a->tally, object_hits, __builtin_popcount(hit));
    for (; hit; hit &= hit - 1) {
        uint32_t i = (uint32_t)__builtin_ctz(hit);
        a->blockers[ray[i]] = g->triangle_ids[rt_ref_index(object[i])];
    }
}

/* Tests pairs 0..count-1. Sixteen of which the sieve lets at least half pass are tested in full at once; of
 * others those that pass come together first. */
RT_KERNEL void test_pairs(const Asking *a, uint32_t light, uint32_t count) {
    uint32_t *ray = a->stream->pair_ray, *object = a->stream->pair_object, kept = 0;
    RtPairs pairs;
    for (uint32_t first = 0; first < count; first += 16) {
        uint32_t n = count - first < 16 ? count - first : 16;
        load_pairs(a, light, ray + first, object + first, n, &pairs);
        uint32_t passed = sieve_pairs(&pairs) & ((1u << n) - 1);
        if (2 * (uint32_t)__builtin_popcount(passed) >= n) {
            hit_pairs(a, ray + first, object + first, n, &pairs);
            continue;
        }
        RtW16 rays = rt_w16_get(ray + first), objects = rt_w16_get(object + first);
        rt_w16_put_some(ray + kept, passed, rays);
        rt_w16_put_some(object + kept, passed, objects);
        kept += (uint32_t)__builtin_popcount(passed);
    }
    for (uint32_t first = 0; first < kept; first += 16) {
        uint32_t n = kept - first < 16 ? kept - first : 16;
        load_pairs(a, light, ray + first, object + first, n, &pairs);
        hit_pairs(a, ray + first, object + first, n, &pairs);
    }
}

/* Tests objects of other shapes one by one. */
RT_KERNEL void test_others(const Asking *a, uint32_t count) {
    const RtGeometry *g = &a->self->base.scene->geometry;
    for (uint32_t i = 0; i < count; i++) {
        RtRef object = a->stream->other_object[i];
        uint32_t number = a->stream->other_ray[i], id = rt_light_id_of(g, object);
        const RtRay *ray = &a->rays[number];
        if (a->self->extents && rt_light_has_side(object)) {
            RT_COUNT(a->tally, extent_tests, 1);
            if (rt_light_is_aside(g, id, ray)) continue;
        }
        RtPreparedRay prepared;
        RtHit hit = RT_MISS;
        rt_hit_ray(&prepared, g, ray, a->scratch->room);
        if (rt_test_object(g, id, &prepared, true, &hit, a->tally)) a->blockers[number] = id;
    }
}

/* What is looked up in a round. */
typedef struct Round {
    uint32_t pairs, others, left;
    bool all_triangles;
} Round;

/* Appends the pairs of lanes `met`. */
RT_KERNEL void add_pairs(const Asking *a, Round *round, uint32_t met, RtW16 ray, RtW16 object) {
    const RtGeometry *g = &a->self->base.scene->geometry;
    Stream *stream = a->stream;
    if (!round->all_triangles) {
        const RtW16 triangle = rt_w16_all(RT_SHAPE_TRIANGLE);
        uint32_t other = met & ~rt_w16_equal(rt_w16_right(object, RT_REF_INDEX_BITS), triangle);
        rt_w16_put_some(stream->other_ray + round->others, other, ray);
        rt_w16_put_some(stream->other_object + round->others, other, object);
        round->others += (uint32_t)__builtin_popcount(other);
        met &= ~other;
    }
    rt_w16_put_some(stream->pair_ray + round->pairs, met, ray);
    rt_w16_put_some(stream->pair_object + round->pairs, met, object);
    uint32_t after = round->pairs + (uint32_t)__builtin_popcount(met);
    for (uint32_t i = round->pairs; i < after; i++) {
        const RtTriangle *t = &g->triangles[rt_ref_index(stream->pair_object[i])];
        __builtin_prefetch(t);
        __builtin_prefetch(&t->v[2].z);
    }
    round->pairs = after;
}

/* Sixteen rays on their way look at their next `deep` entries. */
RT_KERNEL void look_up(const Asking *a, const RtLightEntry *entries, uint32_t first, uint32_t count,
                       uint32_t deep, Round *round) {
    Stream *stream = a->stream;
    Way *way = &stream->way;
    const RtW16 beyond = rt_w16_all(RT_LIGHT_BEYOND), one = rt_w16_all(1), none = rt_w16_all(0);
    uint32_t lanes = count - first < 16 ? (1u << (count - first)) - 1 : 0xffff;
    RtW16 ray = rt_w16_pick(lanes, none, rt_w16_get(way->ray + first));
    RtW16 at = rt_w16_pick(lanes, none, rt_w16_get(way->at + first));
    RtW16 end = rt_w16_get(way->end + first), key = rt_w16_get(way->key + first);
    const RtW16 depth = rt_w16_right(key, 16);
    const RtW16 part = rt_w16_and(key, rt_w16_all(RT_LIGHT_PART * RT_LIGHT_PART - 1));
    lanes &= rt_w16_equal(rt_w16_lookup(a->blockers, ray), rt_w16_all(RT_NO_OBJECT));
    for (uint32_t i = 0; i < deep && lanes; i++) {
        RtW16 object = rt_w16_lookup_pair(&entries[0].object, at);
        RtW16 of_entry = rt_w16_lookup_pair(&entries[0].key, at);
        lanes &= ~rt_w16_below(depth, rt_w16_right(of_entry, 16));
        uint32_t ends = lanes & rt_w16_equal(object, beyond);
        lanes &= ~ends;
        rt_w16_put_some(stream->ended + stream->ended_count, ends, ray);
        stream->ended_count += (uint32_t)__builtin_popcount(ends);
        RT_COUNT(a->tally, steps, __builtin_popcount(lanes));
        uint32_t met = lanes;
        if (a->self->extents) {
            RT_COUNT(a->tally, extent_tests, __builtin_popcount(lanes));
            met &= rt_w16_equal(rt_w16_and(rt_w16_down(of_entry, part), one), one);
        }
        if (met) add_pairs(a, round, met, ray, object);
        RtW16 next = rt_w16_add(at, one);
        lanes &= rt_w16_below(next, end);
        at = rt_w16_pick(lanes, none, next);
    }
    rt_w16_put_some(way->ray + round->left, lanes, ray);
    rt_w16_put_some(way->at + round->left, lanes, at);
    rt_w16_put_some(way->end + round->left, lanes, end);
    rt_w16_put_some(way->key + round->left, lanes, key);
    round->left += (uint32_t)__builtin_popcount(lanes);
}

/* A round of all rays on their way; gives how many are left. */
RT_KERNEL uint32_t take_round(const Asking *a, uint32_t light, uint32_t count, uint32_t deep,
                              bool all_triangles) {
    const RtLightEntry *entries = a->self->cubes[light].entries;
    Round round = {0, 0, 0, all_triangles};
    for (uint32_t first = 0; first < count; first += 16) look_up(a, entries, first, count, deep, &round);
    RT_COUNT(a->tally, object_tests, round.pairs);
    test_pairs(a, light, round.pairs);
    test_others(a, round.others);
    return round.left;
}

/* Rays order[0..count) to a light that serves. */
RT_KERNEL void shade_light(const Asking *a, uint32_t light, const uint32_t *order, uint32_t count,
                           bool all_triangles) {
    Stream *stream = a->stream;
    stream->ended_count = 0;
    uint32_t on_way = begin_light(a, light, order, count);
    for (uint32_t deep = 1; on_way > 0; deep = deep < DEEPEST ? 2 * deep : DEEPEST)
        on_way = take_round(a, light, on_way, deep, all_triangles);
    /* Those at the end of a list that was cut; some were blocked in the same round. */
    for (uint32_t i = 0; i < stream->ended_count; i++) {
        uint32_t ray = stream->ended[i];
        stream->passed[stream->passed_count] = ray;
        stream->passed_count += a->blockers[ray] == RT_NO_OBJECT;
    }
}

/* ---- streams ---- */

RT_KERNEL void pass_on(const Asking *a, RtTally *tallies) {
    Stream *stream = a->stream;
    uint32_t count = stream->passed_count;
    if (count == 0) return;
    RT_COUNT(a->tally, passed_on, count);
    for (uint32_t i = 0; i < count; i++) stream->passed_rays[i] = a->rays[stream->passed[i]];
    rt_hand_down_occluded(&a->self->base, a->scratch, stream->passed_rays, count, stream->passed_blockers,
                          tallies);
    for (uint32_t i = 0; i < count; i++) a->blockers[stream->passed[i]] = stream->passed_blockers[i];
}

/* Rays by light: those of lights[0] first, in their order. Gives how many are of it; the others are put
 * behind, to be gone over again. */
RT_KERNEL uint32_t gather_light(const RtRay *rays, uint32_t *order, uint32_t count, uint32_t *others,
                                uint32_t *other_count) {
    uint32_t light = rays[order[0]].source, same = 0, other = 0;
    for (uint32_t i = 0; i < count; i++) {
        uint32_t ray = order[i];
        bool is_same = rays[ray].source == light;
        others[other] = ray;
        order[same] = ray;
        same += is_same;
        other += !is_same;
    }
    *other_count = other;
    return same;
}

/* A block of shadow rays. */
RT_KERNEL void shade_block(Asking *a, uint32_t count, RtTally *tallies) {
    const RtScene *scene = a->self->base.scene;
    const bool all_triangles = scene->geometry.triangle_count == scene->geometry.object_count;
    Stream *stream = a->stream;
    uint32_t two[2][BLOCK], *order = two[0], *others = two[1];
    stream->passed_count = 0;
    for (uint32_t i = 0; i < count; i++) {
        order[i] = i;
        a->blockers[i] = RT_NO_OBJECT;
    }
    for (uint32_t left = count; left > 0;) {
        uint32_t light = a->rays[order[0]].source, rest;
        uint32_t n = gather_light(a->rays, order, left, others, &rest);
        if (light < scene->light_count && a->self->cubes[light].serves) {
            shade_light(a, light, order, n, all_triangles);
        } else {
            memcpy(stream->passed + stream->passed_count, order, n * sizeof *order);
            stream->passed_count += n;
        }
        left = rest;
        uint32_t *swap = order;
        order = others;
        others = swap;
    }
    uint32_t hits = 0;
    if (a->tally) {
        for (uint32_t i = 0; i < count; i++) hits += a->blockers[i] != RT_NO_OBJECT;
    }
    pass_on(a, tallies);
    RT_COUNT(a->tally, rays, count - stream->passed_count);
    RT_COUNT(a->tally, hits, hits);
}

RT_KERNEL void occluded_all(const RtAccel *accel, const RtScratch *scratch, const RtRay *rays, size_t count,
                            uint32_t *blockers, RtTally *tallies) {
    for (size_t i = 0, next; i < count; i = next) {
        for (next = i; next < count && rays[next].kind != RT_RAY_SHADOW; next++) {
        }
        if (next > i) rt_hand_down_occluded(accel, scratch, rays + i, next - i, blockers + i, tallies);
        i = next;
        while (next < count && next - i < BLOCK && rays[next].kind == RT_RAY_SHADOW) next++;
        if (next == i) continue;
        Asking a = {(const RtLightBuffer *)accel,
                    scratch,
                    scratch->own,
                    rays + i,
                    blockers + i,
                    tallies ? &tallies[RT_RAY_SHADOW] : NULL};
        if (a.self->serves) {
            shade_block(&a, (uint32_t)(next - i), tallies);
        } else {
            RT_COUNT(a.tally, passed_on, next - i);
            rt_hand_down_occluded(accel, scratch, rays + i, next - i, blockers + i, tallies);
        }
    }
}

RT_REFUSE_QUESTION(nearest, RtHit)
RT_DEFINE_BOTH(occluded, uint32_t, occluded_all)

const RtLightKernels RT_LIGHT_KERNELS = {nearest_timed,  occluded_timed, nearest_counted, occluded_counted,
                                         sizeof(Stream), place,          cover,           draw,
                                         cover_outline,  draw_outline};
