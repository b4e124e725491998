/* SPDX-License-Identifier: Apache-2.0 */
/* Pairs of a ray to a light and an object of its list: triangles in lanes, other shapes one by one. */
#ifndef RT_ACCEL_LIGHT_LIGHT_PAIRS_H
#define RT_ACCEL_LIGHT_LIGHT_PAIRS_H

#include "accel/light/light_facing.h"
#include "accel/light/light_lookup.h"

/* Sixteen pairs, or fewer, of a ray to one light and a triangle. */
RT_KERNEL void load_pairs(const RayBatch *batch, uint32_t light, const uint32_t *ray, const uint32_t *object,
                          uint32_t count, RtPairs *pairs) {
    Sixteen s;
    load_origins(batch, light, ray, count, &s);
    rt_raster_gather(&batch->self->isa.base.scene->geometry, object, count, pairs->v);
    for (int k = 0; k < 3; k++) pairs->org[k] = s.org[k], pairs->dir[k] = s.dir[k];
    pairs->tmin = s.tmin;
}

/* The edge-function prefilter: those that the first test of rt_triangle_hit lets pass. */
RT_KERNEL uint32_t prefilter_pairs(const RtPairs *p) {
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

RT_COLD static void observe_hits(const RtGeometry *g, const uint32_t *object, uint32_t hit, const RtV16 *at) {
    _Alignas(64) float t[16];
    rt_v16_store(t, *at);
    for (; hit; hit &= hit - 1) {
        uint32_t i = (uint32_t)__builtin_ctz(hit), id = g->triangle_ids[rt_ref_index(object[i])];
        rt_observe(&(RtTraced){.kind = RT_TRACED_OBJECT_HIT, .index = id, .t = t[i]});
    }
}

RT_COLD static void observe_pairs(const RtGeometry *g, const uint32_t *object, uint32_t count) {
    for (uint32_t i = 0; i < count; i++) {
        uint32_t id = g->triangle_ids[rt_ref_index(object[i])];
        rt_observe(&(RtTraced){.kind = RT_TRACED_OBJECT_TEST, .index = id, .box = &g->boxes[id]});
    }
}

/* Tests pairs in full. */
RT_KERNEL void hit_pairs(const RayBatch *batch, const uint32_t *ray, const uint32_t *object, uint32_t count,
                         RtPairs *pairs) {
    const RtGeometry *g = &batch->self->isa.base.scene->geometry;
    _Alignas(64) float tmax[16];
    RtV16 t;
    for (uint32_t i = 0; i < 16; i++) tmax[i] = batch->rays[ray[i < count ? i : 0]].tmax;
    pairs->tmax = rt_v16_load(tmax);
    uint32_t hit = rt_pairs_hit(pairs, &t) & ((1u << count) - 1);
    RT_COUNT(batch->tally, object_hits, __builtin_popcount(hit));
    if (RT_OBSERVED(batch->tally)) observe_hits(g, object, hit, &t);
    for (; hit; hit &= hit - 1) {
        uint32_t i = (uint32_t)__builtin_ctz(hit);
        batch->occluders[ray[i]] = g->triangle_ids[rt_ref_index(object[i])];
    }
}

/* Tests pairs 0..count-1. Sixteen of which at least half pass the prefilter are tested in full at once; of
 * others those that pass are gathered first. */
RT_KERNEL void test_pairs(const RayBatch *batch, uint32_t light, uint32_t count) {
    uint32_t *ray = batch->stream->pair_ray, *object = batch->stream->pair_object, kept = 0;
    RtPairs pairs;
    for (uint32_t first = 0; first < count; first += 16) {
        uint32_t n = count - first < 16 ? count - first : 16;
        load_pairs(batch, light, ray + first, object + first, n, &pairs);
        uint32_t passed = prefilter_pairs(&pairs) & ((1u << n) - 1);
        if (2 * (uint32_t)__builtin_popcount(passed) >= n) {
            hit_pairs(batch, ray + first, object + first, n, &pairs);
            continue;
        }
        RtW16 rays = rt_w16_get(ray + first), objects = rt_w16_get(object + first);
        rt_w16_put_some(ray + kept, passed, rays);
        rt_w16_put_some(object + kept, passed, objects);
        kept += (uint32_t)__builtin_popcount(passed);
    }
    for (uint32_t first = 0; first < kept; first += 16) {
        uint32_t n = kept - first < 16 ? kept - first : 16;
        load_pairs(batch, light, ray + first, object + first, n, &pairs);
        hit_pairs(batch, ray + first, object + first, n, &pairs);
    }
}

/* Tests objects of other shapes one by one. */
RT_KERNEL void test_others(const RayBatch *batch, uint32_t count) {
    const RtGeometry *g = &batch->self->isa.base.scene->geometry;
    for (uint32_t i = 0; i < count; i++) {
        RtRef object = batch->stream->other_object[i];
        uint32_t number = batch->stream->other_ray[i], id = rt_raster_id(g, object);
        const RtRay *ray = &batch->rays[number];
        if (batch->self->extents && rt_light_has_facing_test(object)) {
            RT_COUNT(batch->tally, extent_tests, 1);
            bool leaves = rt_light_leaves(g, id, ray);
            RT_OBSERVE(batch->tally, .kind = RT_TRACED_EXTENT_TEST, .what = "side of object", .index = id,
                       .met = !leaves);
            if (leaves) continue;
        }
        RtPreparedRay prepared;
        RtHit hit = RT_MISS;
        rt_hit_ray(&prepared, g, ray, batch->scratch->room);
        if (rt_test_object(g, id, &prepared, true, &hit, batch->tally)) batch->occluders[number] = id;
    }
}

#endif
