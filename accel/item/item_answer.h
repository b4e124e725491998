/* SPDX-License-Identifier: Apache-2.0 */
/* Answering primary rays from the samples that they belong to. Rays of triangles are tested RT_LANES at a
 * time; rays that no sample decides are passed on, sixty-four at a time. */
#ifndef RT_ACCEL_ITEM_ITEM_ANSWER_H
#define RT_ACCEL_ITEM_ITEM_ANSWER_H

#include "accel/item/item.h"
#include "accel/kernel.h"
#include "accel/watertight.h"

enum {
    PREFETCH = 64, /* rays ahead */
    PASSED = 64,   /* rays passed on at once */
    RUN = 256 /* rays whose kinds are looked at before they are answered: they are read from memory once */
};

/* Rays and the triangles that their samples name. */
typedef struct PendingTests {
    const RtTriangle *triangle[RT_LANES];
    const float *dir[RT_LANES]; /* and tmax */
    uint32_t id[RT_LANES], ray[RT_LANES];
    uint32_t count;
} PendingTests;

typedef struct PassedRays {
    RtRay ray[PASSED];
    size_t place[PASSED];
    uint32_t count;
} PassedRays;

/* A run of primary rays. */
typedef struct RayRun {
    const RtItemBuffer *buffer;
    const RtScratch *scratch;
    const RtRay *rays;
    RtHit *hits;
    uint64_t reciprocal; /* 2^64 / columns, rounded up; 0 for a single column */
    PendingTests pending;
    PassedRays passed;
} RayRun;

RT_KERNEL void flush_passed(RayRun *run, RtTally *tallies) {
    PassedRays *p = &run->passed;
    RtHit hits[PASSED];
    if (tallies) tallies[RT_RAY_PRIMARY].passed_on += p->count;
    RT_OBSERVE(tallies, .kind = RT_TRACED_PASSED_ON, .what = "item");
    rt_hand_down_nearest(&run->buffer->isa.base, run->scratch, p->ray, p->count, hits, tallies);
    for (uint32_t i = 0; i < p->count; i++) run->hits[p->place[i]] = hits[i];
    p->count = 0;
}

RT_KERNEL void pass_on(RayRun *run, size_t i, RtTally *tallies) {
    PassedRays *p = &run->passed;
    p->ray[p->count] = run->rays[i];
    p->place[p->count++] = i;
    if (p->count == PASSED) flush_passed(run, tallies);
}

/* Writes the hit of the object that the ray's sample names; passes the ray on if it misses that object. */
RT_KERNEL void answer(RayRun *run, size_t i, RtHit hit, RtTally *tallies) {
    if (hit.object == RT_NO_OBJECT)
        pass_on(run, i, tallies);
    else
        run->hits[i] = rt_answer_nearest(hit, tallies ? &tallies[RT_RAY_PRIMARY] : NULL);
}

RT_COLD static void observe_pending(const RtGeometry *g, const PendingTests *p, uint32_t hit,
                                    const float *t) {
    for (uint32_t k = 0; k < p->count; k++) {
        uint32_t id = p->id[k];
        rt_observe(&(RtTraced){.kind = RT_TRACED_OBJECT_TEST, .index = id, .box = &g->boxes[id]});
        if (hit >> k & 1) rt_observe(&(RtTraced){.kind = RT_TRACED_OBJECT_HIT, .index = id, .t = t[k]});
    }
}

/* Tests up to RT_LANES rays, all from the eye. */
RT_KERNEL void flush_pending(RayRun *run, RtTally *tallies) {
    const RtItemBuffer *buffer = run->buffer;
    PendingTests *p = &run->pending;
    float t[RT_LANES];
    for (uint32_t k = p->count; k < RT_LANES; k++) {
        p->triangle[k] = p->triangle[0];
        p->dir[k] = p->dir[0];
    }
    RtFloats four[4], at;
    RtRayTriangles pairs = {.tmin = rt_all((float)buffer->view.near), .tmax = rt_all(INFINITY)};
    rt_load_columns(p->dir, four);
    for (int a = 0; a < 3; a++) {
        pairs.org[a] = rt_all((float)buffer->view.eye.at[a]);
        pairs.dir[a] = four[a];
    }
    rt_load_triangles(p->triangle, pairs.v);
    uint32_t hit = rt_hit_pairs(&pairs, &at);
    rt_store(t, at);
    if (tallies) {
        tallies[RT_RAY_PRIMARY].object_tests += p->count;
        tallies[RT_RAY_PRIMARY].object_hits += (uint32_t)__builtin_popcount(hit & ((1u << p->count) - 1));
        if (RT_OBSERVED(tallies)) observe_pending(rt_item_geometry(buffer), p, hit, t);
    }
    for (uint32_t k = 0; k < p->count; k++)
        answer(run, p->ray[k], hit >> k & 1 ? (RtHit){t[k], p->id[k]} : RT_MISS, tallies);
    p->count = 0;
}

__extension__ typedef unsigned __int128 Wide;

/* Is a ray, bit for bit, the ray of its sample? */
RT_KERNEL bool is_of_sample(const RtItemBuffer *self, const RtRay *ray, RtFloat4 org, uint64_t reciprocal) {
    if (ray->source >= rt_item_sample_count(self)) return false;
    uint32_t row = reciprocal ? (uint32_t)((Wide)reciprocal * ray->source >> 64) : ray->source;
    uint32_t column = ray->source - row * self->view.sampling.columns;
    RtFloat4 dir = rt_round4(self->columns[column] + self->rows[row]);
    RtInt4 same = ((RtInt4)dir == rt_load_ints4(&ray->dir)) & ((RtInt4)org == rt_load_ints4(&ray->org));
    return rt_bits(same) == 15;
}

/* If it is, *triangle is its index. */
RT_KERNEL bool is_triangle(const RtGeometry *g, uint32_t id, uint32_t *triangle) {
    *triangle = rt_ref_index(g->objects[id]);
    return rt_raster_is_triangle(g->objects[id]);
}

RT_KERNEL void answer_run(const RtAccel *accel, const RtScratch *scratch, const RtRay *rays, size_t count,
                          RtHit *hits, RtTally *tallies) {
    const RtItemBuffer *self = (const RtItemBuffer *)accel;
    const RtGeometry *g = &accel->scene->geometry;
    RtTally *tally = tallies ? &tallies[RT_RAY_PRIMARY] : NULL;
    RayRun run;
    run.buffer = self;
    run.scratch = scratch;
    run.rays = rays;
    run.hits = hits;
    run.reciprocal = UINT64_MAX / self->view.sampling.columns + 1;
    run.pending.count = run.passed.count = 0;
    const bool mixed = g->triangle_count < g->object_count;
    const RtFloat4 org = {(float)self->view.eye.x, (float)self->view.eye.y, (float)self->view.eye.z,
                          (float)self->view.near};
    for (size_t i = 0; i < count; i++) {
        const RtRay *ray = &rays[i];
        if (!is_of_sample(self, ray, org, run.reciprocal)) {
            pass_on(&run, i, tallies);
            continue;
        }
        uint32_t id = self->samples[ray->source], triangle = id;
        RT_COUNT(tally, steps, 1);
        RT_OBSERVE(tally, .kind = RT_TRACED_STEP, .what = "sample", .index = ray->source);
        __builtin_prefetch(ray + PREFETCH);
        if (id == RT_NO_OBJECT) {
            hits[i] = rt_answer_nearest(RT_MISS, tally);
        } else if (id == RT_ITEM_UNDECIDED) {
            pass_on(&run, i, tallies);
        } else if (mixed ? is_triangle(g, id, &triangle) : true) {
            PendingTests *p = &run.pending;
            const RtTriangle *at = &g->triangles[triangle];
            __builtin_prefetch(at);
            __builtin_prefetch(&at->v[2].z);
            p->triangle[p->count] = at;
            p->dir[p->count] = ray->dir.at;
            p->id[p->count] = id;
            p->ray[p->count++] = (uint32_t)i;
            if (p->count == RT_LANES) flush_pending(&run, tallies);
        } else {
            RtPreparedRay prepared;
            RtHit hit = RT_MISS;
            rt_hit_ray(&prepared, g, ray, scratch->crossings);
            rt_test_object(g, id, &prepared, false, &hit, tally);
            answer(&run, i, hit, tallies);
        }
    }
    if (run.pending.count > 0) flush_pending(&run, tallies);
    if (run.passed.count > 0) flush_passed(&run, tallies);
}

/* Primary rays of a stream; runs of others are handed down. */
RT_KERNEL void answer_all(const RtAccel *accel, const RtScratch *scratch, const RtRay *rays, size_t count,
                          RtHit *hits, RtTally *tallies) {
    for (size_t i = 0, next; i < count; i = next) {
        bool own = rays[i].kind == RT_RAY_PRIMARY;
        for (next = i + 1; next < count && (!own || next - i < RUN); next++) {
            if ((rays[next].kind == RT_RAY_PRIMARY) != own) break;
        }
        if (own)
            answer_run(accel, scratch, rays + i, next - i, hits + i, tallies);
        else
            rt_hand_down_nearest(accel, scratch, rays + i, next - i, hits + i, tallies);
    }
}

#endif
