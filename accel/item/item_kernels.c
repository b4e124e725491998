/* SPDX-License-Identifier: Apache-2.0 */
/* The kernels of item, compiled once for each instruction set (accel/isa.h): answering primary rays from the
 * samples that they belong to, and drawing triangles (item_triangles.h). Rays of triangles are tested
 * RT_LANES at a time; rays that are not those of samples are passed on, sixty-four at a time. */
#include "accel/item/item_triangles.h"

enum {
    PREFETCH = 64, /* rays ahead */
    PASSED = 64,   /* rays passed on at once */
    RUN = 256 /* rays whose kinds are looked at before they are answered: they are read from memory once */
};

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
    double rows_per_sample; /* 1 / columns */
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

RT_COLD static void observe_pending(const RtGeometry *g, const PendingTests *p, const float *t) {
    for (uint32_t k = 0; k < p->count; k++) {
        uint32_t id = p->id[k];
        rt_observe(&(RtTraced){.kind = RT_TRACED_OBJECT_TEST, .index = id, .box = &g->boxes[id]});
        rt_observe(&(RtTraced){.kind = RT_TRACED_OBJECT_HIT, .index = id, .t = t[k]});
    }
}

/* All hit: these are the rays for which the samples were drawn. */
RT_KERNEL void flush_pending(RayRun *run, RtTally *tallies) {
    PendingTests *p = &run->pending;
    RtTally *tally = tallies ? &tallies[RT_RAY_PRIMARY] : NULL;
    float t[RT_ITEM_PENDING];
    uint32_t hits = test_pending(run->buffer, p, t);
    RT_COUNT(tally, object_tests, p->count);
    RT_COUNT(tally, object_hits, (uint32_t)__builtin_popcount(hits));
    if (RT_OBSERVED(tallies)) observe_pending(rt_item_geometry(run->buffer), p, t);
    for (uint32_t k = 0; k < p->count; k++)
        run->hits[p->place[k]] = rt_answer_nearest((RtHit){t[k], p->id[k]}, tally);
    p->count = 0;
}

/* Is a ray, bit for bit, the ray of its sample? */
RT_KERNEL bool is_of_sample(const RtItemBuffer *self, const RtRay *ray, RtFloat4 org,
                            double rows_per_sample) {
    if (ray->source >= rt_item_sample_count(self)) return false;
    /* The half is more than the product's rounding can lose or add. */
    uint32_t row = (uint32_t)((ray->source + 0.5) * rows_per_sample);
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
    run.rows_per_sample = 1.0 / self->view.sampling.columns;
    run.pending.count = run.passed.count = 0;
    const bool mixed = g->triangle_count < g->object_count;
    const RtFloat4 org = {(float)self->view.eye.x, (float)self->view.eye.y, (float)self->view.eye.z,
                          (float)self->view.near};
    for (size_t i = 0; i < count; i++) {
        const RtRay *ray = &rays[i];
        if (!is_of_sample(self, ray, org, run.rows_per_sample)) {
            pass_on(&run, i, tallies);
            continue;
        }
        uint32_t id = self->samples[ray->source], triangle = id;
        RT_COUNT(tally, steps, 1);
        RT_OBSERVE(tally, .kind = RT_TRACED_STEP, .what = "sample", .index = ray->source);
        __builtin_prefetch(ray + PREFETCH);
        if (id == RT_NO_OBJECT) {
            hits[i] = rt_answer_nearest(RT_MISS, tally);
        } else if (mixed ? is_triangle(g, id, &triangle) : true) {
            __builtin_prefetch(&g->triangles[triangle]);
            __builtin_prefetch(&g->triangles[triangle].v[2].z);
            add_pending(&run.pending, g, triangle, ray->dir.at, (uint32_t)i);
            if (run.pending.count == RT_ITEM_PENDING) flush_pending(&run, tallies);
        } else {
            RtPreparedRay prepared;
            RtHit hit = RT_MISS;
            rt_hit_ray(&prepared, g, ray, scratch->crossings);
            rt_test_object(g, id, &prepared, false, &hit, tally);
            hits[i] = rt_answer_nearest(hit, tally);
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

RT_DEFINE_BOTH(nearest, RtHit, answer_all)
RT_DEFINE_HANDED_DOWN(occluded, uint32_t)
RT_DEFINE_KERNEL_TABLE(item, 0);
const RtItemRaster RT_OF_ISA(item_raster) = {place, draw};
