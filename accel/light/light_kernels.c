/* SPDX-License-Identifier: Apache-2.0 */
/* Answering shadow rays in streams, and drawing from the light; compiled once for each instruction set
 * (accel/isa.h).
 *
 * A stream is answered in blocks of rays, light by light. First each ray finds its cell, RT_LANES rays at a
 * time. Then the rays walk through their lists in rounds of one entry, of two, and of four. An entry that is
 * not deeper than its ray, and is seen in the ray's part of the cell, makes a pair of a ray and an object.
 * Pairs with triangles are tested in lanes. A ray drops out when it is occluded or at the end of its list. No
 * ray depends on another, so counts are the same in streams of any length. Rays at the end of a list that was
 * cut, and rays that are not exactly a shadow ray, are passed on together.
 *
 * A step is an entry that is not deeper than the ray. An extent test is that of the part of the cell, or of
 * the side of a polygon or sphere (light_facing.h). */
#include "accel/light/light_draw.h"
#include "accel/light/light_pairs.h"

/* ---- a round ---- */

/* The pairs of a round, and the rays that remain. */
typedef struct Round {
    uint32_t pairs, others, left;
    bool all_triangles;
} Round;

/* Appends the pairs of lanes `met`. */
RT_KERNEL void add_pairs(const RayBatch *batch, Round *round, uint32_t met, RtInts ray, RtInts object) {
    const RtGeometry *g = &batch->self->isa.base.scene->geometry;
    Stream *stream = batch->stream;
    if (!round->all_triangles) {
        const RtInts triangle = rt_all_ints(RT_SHAPE_TRIANGLE);
        uint32_t other = met & ~rt_eq_bits((RtInts)((RtWords)object >> RT_REF_INDEX_BITS), triangle);
        rt_compress_store(stream->other_ray + round->others, other, ray);
        rt_compress_store(stream->other_object + round->others, other, object);
        round->others += (uint32_t)__builtin_popcount(other);
        met &= ~other;
    }
    rt_compress_store(stream->pair_ray + round->pairs, met, ray);
    rt_compress_store(stream->pair_object + round->pairs, met, object);
    uint32_t after = round->pairs + (uint32_t)__builtin_popcount(met);
    for (uint32_t i = round->pairs; i < after; i++) {
        const RtTriangle *t = &g->triangles[rt_ref_index(stream->pair_object[i])];
        __builtin_prefetch(t);
        __builtin_prefetch(&t->v[2].z);
    }
    round->pairs = after;
}

/* Takes no RayBatch: if its address escaped, the compiler could not see that its tally stays NULL. */
RT_COLD static void observe_entries(const RtGeometry *g, bool extents, const RtInts *object, uint32_t lanes,
                                    uint32_t met) {
    uint32_t objects[RT_LANES];
    rt_store(objects, *object);
    for (; lanes; lanes &= lanes - 1) {
        uint32_t lane = (uint32_t)__builtin_ctz(lanes), id = rt_raster_id(g, objects[lane]);
        const char *what = "entry of object";
        rt_observe(&(RtTraced){.kind = RT_TRACED_STEP, .what = what, .index = id});
        if (!extents) continue;
        rt_observe(
            &(RtTraced){.kind = RT_TRACED_EXTENT_TEST, .what = what, .index = id, .met = met >> lane & 1});
    }
}

/* RT_LANES rays in lists look at their next `deep` entries. */
RT_KERNEL void look_up(const RayBatch *batch, const RtLightEntry *entries, uint32_t first, uint32_t count,
                       uint32_t deep, Round *round) {
    Stream *stream = batch->stream;
    Cursors *cursors = &stream->cursors;
    const RtInts beyond = rt_all_ints((int32_t)RT_LIGHT_BEYOND), none = rt_all_ints(0);
    uint32_t lanes = rt_raster_first_lanes(count - first);
    RtInts ray = rt_select_bits(lanes, rt_load_ints(cursors->ray + first), none);
    RtInts at = rt_select_bits(lanes, rt_load_ints(cursors->at + first), none);
    RtInts end = rt_load_ints(cursors->end + first), key = rt_load_ints(cursors->key + first);
    const RtInts depth = (RtInts)((RtWords)key >> 16);
    const RtInts part = key & (CELL_PARTS - 1);
    lanes &= rt_eq_bits(rt_gather_words(batch->occluders, ray, 1), rt_all_ints((int32_t)RT_NO_OBJECT));
    for (uint32_t i = 0; i < deep && lanes; i++) {
        RtInts object = rt_gather_words(&entries[0].object, at, 2);
        RtInts of_entry = rt_gather_words(&entries[0].key, at, 2);
        lanes &= ~rt_lt_bits(depth, (RtInts)((RtWords)of_entry >> 16));
        uint32_t ends = lanes & rt_eq_bits(object, beyond);
        lanes &= ~ends;
        rt_compress_store(stream->ended + stream->ended_count, ends, ray);
        stream->ended_count += (uint32_t)__builtin_popcount(ends);
        RT_COUNT(batch->tally, steps, __builtin_popcount(lanes));
        uint32_t met = lanes;
        if (batch->self->extents) {
            RT_COUNT(batch->tally, extent_tests, __builtin_popcount(lanes));
            met &= rt_eq_bits((RtInts)((RtWords)of_entry >> (RtWords)part) & 1, rt_all_ints(1));
        }
        if (RT_OBSERVED(batch->tally))
            observe_entries(&batch->self->isa.base.scene->geometry, batch->self->extents, &object, lanes,
                            met);
        if (met) add_pairs(batch, round, met, ray, object);
        RtInts next = at + 1;
        lanes &= rt_lt_bits(next, end);
        at = rt_select_bits(lanes, next, none);
    }
    rt_compress_store(cursors->ray + round->left, lanes, ray);
    rt_compress_store(cursors->at + round->left, lanes, at);
    rt_compress_store(cursors->end + round->left, lanes, end);
    rt_compress_store(cursors->key + round->left, lanes, key);
    round->left += (uint32_t)__builtin_popcount(lanes);
}

/* A round of all rays in lists; returns the number that remain. */
RT_KERNEL uint32_t take_round(const RayBatch *batch, uint32_t light, uint32_t count, uint32_t deep,
                              bool all_triangles) {
    const RtLightEntry *entries = batch->self->cubes[light].entries;
    Round round = {0, 0, 0, all_triangles};
    for (uint32_t first = 0; first < count; first += RT_LANES)
        look_up(batch, entries, first, count, deep, &round);
    RT_COUNT(batch->tally, object_tests, round.pairs);
    if (RT_OBSERVED(batch->tally))
        observe_pairs(&batch->self->isa.base.scene->geometry, batch->stream->pair_object, round.pairs);
    test_pairs(batch, light, round.pairs);
    test_others(batch, round.others);
    return round.left;
}

/* Rays order[0..count) to a light that serves. */
RT_KERNEL void shade_light(const RayBatch *batch, uint32_t light, const uint32_t *order, uint32_t count,
                           bool all_triangles) {
    Stream *stream = batch->stream;
    stream->ended_count = 0;
    uint32_t on_way = begin_light(batch, light, order, count);
    for (uint32_t deep = 1; on_way > 0; deep = deep < DEEPEST ? 2 * deep : DEEPEST)
        on_way = take_round(batch, light, on_way, deep, all_triangles);
    /* Those at the end of a list that was cut; some were occluded in the same round. */
    for (uint32_t i = 0; i < stream->ended_count; i++) {
        uint32_t ray = stream->ended[i];
        stream->passed[stream->passed_count] = ray;
        stream->passed_count += batch->occluders[ray] == RT_NO_OBJECT;
    }
}

/* ---- streams ---- */

RT_KERNEL void pass_on(const RayBatch *batch, RtTally *tallies) {
    Stream *stream = batch->stream;
    uint32_t count = stream->passed_count;
    if (count == 0) return;
    RT_COUNT(batch->tally, passed_on, count);
    RT_OBSERVE(batch->tally, .kind = RT_TRACED_PASSED_ON, .what = "light");
    for (uint32_t i = 0; i < count; i++) stream->passed_rays[i] = batch->rays[stream->passed[i]];
    rt_hand_down_occluded(&batch->self->isa.base, batch->scratch, stream->passed_rays, count,
                          stream->passed_occluders, tallies);
    for (uint32_t i = 0; i < count; i++) batch->occluders[stream->passed[i]] = stream->passed_occluders[i];
}

/* Rays by light: those of lights[0] first, in their order. Returns how many these are; the others go to
 * others[0..*other_count). */
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
RT_KERNEL void shade_block(RayBatch *batch, uint32_t count, RtTally *tallies) {
    const RtScene *scene = batch->self->isa.base.scene;
    const bool all_triangles = scene->geometry.triangle_count == scene->geometry.object_count;
    Stream *stream = batch->stream;
    uint32_t two[2][BLOCK], *order = two[0], *others = two[1];
    stream->passed_count = 0;
    for (uint32_t i = 0; i < count; i++) {
        order[i] = i;
        batch->occluders[i] = RT_NO_OBJECT;
    }
    for (uint32_t left = count; left > 0;) {
        uint32_t light = batch->rays[order[0]].source, rest;
        uint32_t n = gather_light(batch->rays, order, left, others, &rest);
        if (light < scene->light_count && batch->self->cubes[light].serves) {
            shade_light(batch, light, order, n, all_triangles);
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
    if (batch->tally) {
        for (uint32_t i = 0; i < count; i++) hits += batch->occluders[i] != RT_NO_OBJECT;
    }
    pass_on(batch, tallies);
    RT_COUNT(batch->tally, rays, count - stream->passed_count);
    RT_COUNT(batch->tally, hits, hits);
}

/* Where the buffer serves no light: hands down all at once, because packets are made of rays that come
 * together. */
RT_KERNEL void pass_all(const RtAccel *accel, const RtScratch *scratch, const RtRay *rays, size_t count,
                        uint32_t *occluders, RtTally *tallies) {
    for (size_t i = 0; tallies && i < count; i++) {
        if (rays[i].kind != RT_RAY_SHADOW) continue;
        RT_COUNT(&tallies[RT_RAY_SHADOW], passed_on, 1);
        RT_OBSERVE(&tallies[RT_RAY_SHADOW], .kind = RT_TRACED_PASSED_ON, .what = "light");
    }
    rt_hand_down_occluded(accel, scratch, rays, count, occluders, tallies);
}

RT_KERNEL void occluded_all(const RtAccel *accel, const RtScratch *scratch, const RtRay *rays, size_t count,
                            uint32_t *occluders, RtTally *tallies) {
    const RtLightBuffer *self = (const RtLightBuffer *)accel;
    if (!self->serves) {
        pass_all(accel, scratch, rays, count, occluders, tallies);
        return;
    }
    for (size_t i = 0, next; i < count; i = next) {
        for (next = i; next < count && rays[next].kind != RT_RAY_SHADOW; next++) {
        }
        if (next > i) rt_hand_down_occluded(accel, scratch, rays + i, next - i, occluders + i, tallies);
        i = next;
        while (next < count && next - i < BLOCK && rays[next].kind == RT_RAY_SHADOW) next++;
        if (next == i) continue;
        RayBatch batch = {self,     scratch,       scratch->own,
                          rays + i, occluders + i, tallies ? &tallies[RT_RAY_SHADOW] : NULL};
        shade_block(&batch, (uint32_t)(next - i), tallies);
    }
}

RT_DEFINE_HANDED_DOWN(nearest, RtHit)
RT_DEFINE_BOTH(occluded, uint32_t, occluded_all)

RT_DEFINE_KERNEL_TABLE(light, sizeof(Stream));
const RtLightRaster RT_OF_ISA(light_raster) = {place, cover, draw, cover_outline, draw_outline};
