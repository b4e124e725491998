/* SPDX-License-Identifier: Apache-2.0 */
/* Answering primary rays by the samples that they are of; the others are passed on. */
#ifndef RT_ACCEL_ITEM_SEE_H
#define RT_ACCEL_ITEM_SEE_H

#include "accel/item/raster.h"
#include "accel/pairs.h"

/* Rays whose samples name triangles, waiting until there are sixteen. */
typedef struct Waiting {
    const RtTriangle *triangle[RT_ITEM_LANES];
    const float *dir[RT_ITEM_LANES]; /* and tmax */
    uint32_t id[RT_ITEM_LANES], ray[RT_ITEM_LANES];
    uint32_t count;
} Waiting;

enum { AHEAD = 64 }; /* rays so far ahead are fetched */

/* Rays that are passed on, together. */
enum { PASSED = 64 };
typedef struct Passed {
    RtRay ray[PASSED];
    size_t place[PASSED];
    uint32_t count;
} Passed;

typedef struct Question {
    const RtItemBuffer *buffer;
    const RtScratch *scratch;
    const RtRay *rays;
    RtHit *hits;
    uint64_t reciprocal; /* 2^64 / columns, rounded up; 0 for a single column */
    Waiting waiting;
    Passed passed;
} Question;

RT_KERNEL void pass_waiting(Question *q, RtTally *tallies) {
    Passed *p = &q->passed;
    RtHit hits[PASSED];
    if (tallies) tallies[RT_RAY_PRIMARY].passed_on += p->count;
    RT_OBSERVE(tallies, .kind = RT_TRACED_PASSED_ON, .what = "item");
    rt_hand_down_nearest(&q->buffer->isa.base, q->scratch, p->ray, p->count, hits, tallies);
    for (uint32_t i = 0; i < p->count; i++) q->hits[p->place[i]] = hits[i];
    p->count = 0;
}

RT_KERNEL void pass_on(Question *q, size_t i, RtTally *tallies) {
    Passed *p = &q->passed;
    p->ray[p->count] = q->rays[i];
    p->place[p->count++] = i;
    if (p->count == PASSED) pass_waiting(q, tallies);
}

/* The object that its sample names is hit, or, against all expectation, missed. */
RT_KERNEL void answer(Question *q, size_t i, RtHit hit, RtTally *tallies) {
    RtTally *tally = tallies ? &tallies[RT_RAY_PRIMARY] : NULL;
    if (hit.object == RT_NO_OBJECT)
        pass_on(q, i, tallies);
    else
        q->hits[i] = rt_answer_nearest(hit, tally);
}

RT_COLD static void observe_waiting(const RtGeometry *g, const Waiting *w, uint32_t hit, const float *t) {
    for (uint32_t k = 0; k < w->count; k++) {
        uint32_t id = w->id[k];
        rt_observe(&(RtTraced){.kind = RT_TRACED_OBJECT_TEST, .index = id, .box = &g->boxes[id]});
        if (hit >> k & 1) rt_observe(&(RtTraced){.kind = RT_TRACED_OBJECT_HIT, .index = id, .t = t[k]});
    }
}

/* Tests up to sixteen rays, all from the eye. */
RT_KERNEL void test_waiting(Question *q, RtTally *tallies) {
    const RtItemBuffer *buffer = q->buffer;
    Waiting *w = &q->waiting;
    _Alignas(64) float t[RT_ITEM_LANES];
    for (uint32_t k = w->count; k < RT_ITEM_LANES; k++) {
        w->triangle[k] = w->triangle[0];
        w->dir[k] = w->dir[0];
    }
    RtV16 four[4], at;
    RtPairs pairs = {.tmin = rt_v16_all((float)buffer->view.near), .tmax = rt_v16_all(INFINITY)};
    rt_v16_columns(w->dir, four);
    for (int a = 0; a < 3; a++) {
        pairs.org[a] = rt_v16_all((float)buffer->view.eye.at[a]);
        pairs.dir[a] = four[a];
    }
    rt_pairs_gather(w->triangle, pairs.v);
    uint32_t hit = rt_pairs_hit(&pairs, &at);
    rt_v16_store(t, at);
    if (tallies) {
        tallies[RT_RAY_PRIMARY].object_tests += w->count;
        tallies[RT_RAY_PRIMARY].object_hits += (uint32_t)__builtin_popcount(hit & ((1u << w->count) - 1));
        if (RT_OBSERVED(tallies)) observe_waiting(&buffer->isa.base.scene->geometry, w, hit, t);
    }
    for (uint32_t k = 0; k < w->count; k++)
        answer(q, w->ray[k], hit >> k & 1 ? (RtHit){t[k], w->id[k]} : RT_MISS, tallies);
    w->count = 0;
}

__extension__ typedef unsigned __int128 Wide;

/* Is it, bit for bit, the ray of its sample? */
RT_KERNEL bool is_of_sample(const RtItemBuffer *self, const RtRay *ray, __m128 org, uint64_t reciprocal) {
    if (ray->source >= rt_item_sample_count(self)) return false;
    uint32_t row = reciprocal ? (uint32_t)((Wide)reciprocal * ray->source >> 64) : ray->source;
    uint32_t column = ray->source - row * self->view.sampling.columns;
    __m256d dir = _mm256_add_pd(_mm256_load_pd(self->columns[column].at), _mm256_load_pd(self->rows[row].at));
    __m128i same = _mm_cmpeq_epi32(_mm_castps_si128(_mm256_cvtpd_ps(dir)),
                                   _mm_loadu_si128((const __m128i *)(const void *)&ray->dir));
    same = _mm_and_si128(same, _mm_cmpeq_epi32(_mm_castps_si128(org),
                                               _mm_loadu_si128((const __m128i *)(const void *)&ray->org)));
    return _mm_movemask_epi8(same) == 0xffff;
}

/* If it is, *triangle is its index. */
RT_KERNEL bool is_triangle(const RtGeometry *g, uint32_t id, uint32_t *triangle) {
    *triangle = rt_ref_index(g->objects[id]);
    return rt_ref_shape(g->objects[id]) == RT_SHAPE_TRIANGLE;
}

RT_KERNEL void see(const RtAccel *accel, const RtScratch *scratch, const RtRay *rays, size_t count,
                   RtHit *hits, RtTally *tallies) {
    const RtItemBuffer *self = (const RtItemBuffer *)accel;
    const RtGeometry *g = &accel->scene->geometry;
    RtTally *tally = tallies ? &tallies[RT_RAY_PRIMARY] : NULL;
    Question q;
    q.buffer = self;
    q.scratch = scratch;
    q.rays = rays;
    q.hits = hits;
    q.reciprocal = UINT64_MAX / self->view.sampling.columns + 1;
    q.waiting.count = q.passed.count = 0;
    const bool mixed = g->triangle_count < g->object_count;
    const __m128 org = _mm_setr_ps((float)self->view.eye.x, (float)self->view.eye.y, (float)self->view.eye.z,
                                   (float)self->view.near);
    for (size_t i = 0; i < count; i++) {
        const RtRay *ray = &rays[i];
        if (!is_of_sample(self, ray, org, q.reciprocal)) {
            pass_on(&q, i, tallies);
            continue;
        }
        uint32_t id = self->samples[ray->source], triangle = id;
        RT_COUNT(tally, steps, 1);
        RT_OBSERVE(tally, .kind = RT_TRACED_STEP, .what = "sample", .index = ray->source);
        __builtin_prefetch(ray + AHEAD);
        if (id == RT_NO_OBJECT) {
            hits[i] = rt_answer_nearest(RT_MISS, tally);
        } else if (id == RT_ITEM_UNDECIDED) {
            pass_on(&q, i, tallies);
        } else if (mixed ? is_triangle(g, id, &triangle) : true) {
            Waiting *w = &q.waiting;
            const RtTriangle *at = &g->triangles[triangle];
            __builtin_prefetch(at);
            __builtin_prefetch(&at->v[2].z);
            w->triangle[w->count] = at;
            w->dir[w->count] = ray->dir.at;
            w->id[w->count] = id;
            w->ray[w->count++] = (uint32_t)i;
            if (w->count == RT_ITEM_LANES) test_waiting(&q, tallies);
        } else {
            RtPreparedRay prepared;
            RtHit hit = RT_MISS;
            rt_hit_ray(&prepared, g, ray, scratch->room);
            rt_test_object(g, id, &prepared, false, &hit, tally);
            answer(&q, i, hit, tallies);
        }
    }
    if (q.waiting.count > 0) test_waiting(&q, tallies);
    if (q.passed.count > 0) pass_waiting(&q, tallies);
}

/* Rays looked at before they are answered: they are read from memory once. */
enum { RUN = 256 };

/* Primary rays of a stream; runs of others are handed down. */
RT_KERNEL void see_all(const RtAccel *accel, const RtScratch *scratch, const RtRay *rays, size_t count,
                       RtHit *hits, RtTally *tallies) {
    for (size_t i = 0, next; i < count; i = next) {
        bool own = rays[i].kind == RT_RAY_PRIMARY;
        for (next = i + 1; next < count && (!own || next - i < RUN); next++) {
            if ((rays[next].kind == RT_RAY_PRIMARY) != own) break;
        }
        if (own)
            see(accel, scratch, rays + i, next - i, hits + i, tallies);
        else
            rt_hand_down_nearest(accel, scratch, rays + i, next - i, hits + i, tallies);
    }
}

#endif
