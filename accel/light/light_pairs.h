/* SPDX-License-Identifier: Apache-2.0 */
/* Pairs of a ray to a light and an object of its list: triangles and spheres in lanes, others one by one. */
#ifndef RT_ACCEL_LIGHT_LIGHT_PAIRS_H
#define RT_ACCEL_LIGHT_LIGHT_PAIRS_H

#include "accel/light/light_facing.h"
#include "accel/light/light_lookup.h"
#include "accel/sphere_pairs.h"

/* RT_LANES pairs, or fewer, of a ray to one light and a triangle. */
RT_KERNEL void load_pairs(const RayBatch *batch, uint32_t light, const uint32_t *ray, const uint32_t *object,
                          uint32_t count, RtRayTriangles *pairs) {
    LightRays s;
    load_origins(batch, light, ray, count, &s);
    rt_raster_gather(&batch->self->isa.base.scene->geometry, object, count, pairs->v);
    for (int k = 0; k < 3; k++) pairs->org[k] = s.org[k], pairs->dir[k] = s.dir[k];
    pairs->tmin = s.tmin;
}

RT_COLD static void observe_hits(const RtGeometry *g, const uint32_t *object, uint32_t hit,
                                 const RtFloats *at) {
    float t[RT_LANES];
    rt_store(t, *at);
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
                         RtRayTriangles *pairs) {
    const RtGeometry *g = &batch->self->isa.base.scene->geometry;
    _Alignas(RtFloats) float tmax[RT_LANES];
    RtFloats t;
    for (uint32_t i = 0; i < RT_LANES; i++) tmax[i] = batch->rays[ray[i < count ? i : 0]].tmax;
    pairs->tmax = rt_load(tmax);
    uint32_t hit = rt_hit_pairs(pairs, &t) & ((1u << count) - 1);
    RT_COUNT(batch->tally, object_hits, __builtin_popcount(hit));
    if (RT_OBSERVED(batch->tally)) observe_hits(g, object, hit, &t);
    for (; hit; hit &= hit - 1) {
        uint32_t i = (uint32_t)__builtin_ctz(hit);
        batch->occluders[ray[i]] = g->triangle_ids[rt_ref_index(object[i])];
    }
}

/* Tests pairs 0..count-1. Vectors of which at least half pass the prefilter are tested in full at once; from
 * others the pairs that pass are gathered first. */
RT_KERNEL void test_pairs(const RayBatch *batch, uint32_t light, uint32_t count) {
    uint32_t *ray = batch->stream->pair_ray, *object = batch->stream->pair_object, kept = 0;
    RtRayTriangles pairs;
    for (uint32_t first = 0; first < count; first += RT_LANES) {
        uint32_t n = count - first < RT_LANES ? count - first : RT_LANES;
        load_pairs(batch, light, ray + first, object + first, n, &pairs);
        uint32_t passed = rt_edge_prefilter_pairs(&pairs) & ((1u << n) - 1);
        if (2 * (uint32_t)__builtin_popcount(passed) >= n) {
            hit_pairs(batch, ray + first, object + first, n, &pairs);
            continue;
        }
        RtInts rays = rt_load_ints(ray + first), objects = rt_load_ints(object + first);
        rt_compress_store(ray + kept, passed, rays);
        rt_compress_store(object + kept, passed, objects);
        kept += (uint32_t)__builtin_popcount(passed);
    }
    for (uint32_t first = 0; first < kept; first += RT_LANES) {
        uint32_t n = kept - first < RT_LANES ? kept - first : RT_LANES;
        load_pairs(batch, light, ray + first, object + first, n, &pairs);
        hit_pairs(batch, ray + first, object + first, n, &pairs);
    }
}

/* Pairs with objects of other shapes that are tested together; a multiple of PAIRS. */
enum { OTHERS = 256 };

/* Fetches what keep_facing reads of the object of a later pair: first where it is, then its box. */
RT_KERNEL void fetch_facing(const RtGeometry *g, const RtRef *object, uint32_t i, uint32_t count) {
    enum { FIRST = 16, SECOND = 8 };
    if (i + FIRST < count && rt_ref_shape(object[i + FIRST]) == RT_SHAPE_SPHERE) {
        __builtin_prefetch(&g->spheres[rt_ref_index(object[i + FIRST])]);
        __builtin_prefetch(&g->sphere_ids[rt_ref_index(object[i + FIRST])]);
    }
    if (i + SECOND < count) __builtin_prefetch(&g->boxes[rt_raster_id(g, object[i + SECOND])]);
}

/* Keeps the pairs whose ray does not leave its object, and returns their number. */
RT_KERNEL uint32_t keep_facing(const RayBatch *batch, uint32_t *ray, RtRef *object, uint32_t count) {
    const RtGeometry *g = &batch->self->isa.base.scene->geometry;
    uint32_t kept = 0;
    for (uint32_t i = 0; i < count; i++) {
        fetch_facing(g, object, i, count);
        if (batch->self->extents && rt_light_has_facing_test(object[i])) {
            const uint32_t id = rt_raster_id(g, object[i]);
            RT_COUNT(batch->tally, extent_tests, 1);
            bool leaves = rt_light_leaves(g, object[i], id, &batch->rays[ray[i]]);
            RT_OBSERVE(batch->tally, .kind = RT_TRACED_EXTENT_TEST, .what = "side of object", .index = id,
                       .met = !leaves);
            if (leaves) continue;
        }
        ray[kept] = ray[i];
        object[kept++] = object[i];
    }
    return kept;
}

/* Tests the spheres. t[i]: NaN if pair i is not hit, or no sphere. */
RT_KERNEL void hit_spheres(const RayBatch *batch, const uint32_t *ray, const RtRef *object, uint32_t count,
                           float *t) {
    const RtGeometry *g = &batch->self->isa.base.scene->geometry;
    SpherePair pairs[OTHERS];
    float at[OTHERS];
    uint32_t spheres = 0, next = 0;
    for (uint32_t i = 0; i < count; i++) {
        if (rt_ref_shape(object[i]) == RT_SHAPE_SPHERE)
            pairs[spheres++] = (SpherePair){&batch->rays[ray[i]], &g->spheres[rt_ref_index(object[i])],
                                            rt_raster_id(g, object[i])};
    }
    hit_sphere_pairs(g, pairs, spheres, at);
    for (uint32_t i = 0; i < count; i++) t[i] = rt_ref_shape(object[i]) == RT_SHAPE_SPHERE ? at[next++] : NAN;
}

/* Tests pairs with objects of other shapes. */
RT_KERNEL void test_others(const RayBatch *batch, uint32_t count) {
    const RtGeometry *g = &batch->self->isa.base.scene->geometry;
    for (uint32_t first = 0; first < count; first += OTHERS) {
        uint32_t *ray = batch->stream->other_ray + first;
        RtRef *object = batch->stream->other_object + first;
        float t[OTHERS];
        uint32_t n = keep_facing(batch, ray, object, count - first < OTHERS ? count - first : OTHERS);
        hit_spheres(batch, ray, object, n, t);
        for (uint32_t i = 0; i < n; i++) {
            const uint32_t id = rt_raster_id(g, object[i]);
            RtPreparedRay prepared;
            RtHit hit = RT_MISS;
            bool met;
            if (rt_ref_shape(object[i]) == RT_SHAPE_SPHERE) {
                met = rt_take_test(g, id, t[i], true, &hit, batch->tally);
            } else {
                rt_hit_ray(&prepared, g, &batch->rays[ray[i]], batch->scratch->crossings);
                met = rt_test_object(g, id, &prepared, true, &hit, batch->tally);
            }
            if (met) batch->occluders[ray[i]] = id;
        }
    }
}

#endif
