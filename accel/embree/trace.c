/* SPDX-License-Identifier: Apache-2.0 */
/* The kernels, and user mode: a stream of our rays goes to Embree in chunks, as single rays, packets of 8 or
 * 16, or streams, and comes back as hits. The loop is written once; query and counting are constants where it
 * is inlined. Native mode, which has nothing to count but rays and hits, is in native.c. */
#include "accel/embree/batch.h"

#include <assert.h>

size_t rt_embree_scratch_bytes(const RtAccel *accel) {
    (void)accel;
    return sizeof(RtEmbreeBatch);
}

/* ---- rays in ---- */

/* Out of the way of the common case, once with and once without a tally. */
static __attribute__((noinline)) void test_all_timed(const RtGeometry *geometry, RtEmbreeSearch *search,
                                                     bool any) {
    rt_test_all(geometry, &search->ray, any, &search->best, NULL);
}

static __attribute__((noinline)) void test_all_counted(const RtGeometry *geometry, RtEmbreeSearch *search,
                                                       bool any) {
    rt_test_all(geometry, &search->ray, any, &search->best, search->tally);
}

/* Is what Embree proposes for this ray all there is to find (embree.h)? |dir| is at most 2^17 * shrink. */
RT_KERNEL bool may_ask(const RtEmbree *self, const RtRay *ray, double shrink) {
    return rt_thickness(ray->org, &self->base.scene->geometry.box) <= self->max_thickness &&
           0x1p-150 * 0x1p17 * shrink <= 0.25 * (double)self->growth;
}

/* A ray that Embree may not be asked about is answered here and now, and sent along as an inactive one. */
RT_KERNEL void put_search(const RtEmbree *self, RtEmbreeBatch *batch, unsigned lanes, size_t i,
                          const RtRay *ray, RtCrossing *room, bool any, RtTally *tally) {
    const RtGeometry *geometry = &self->base.scene->geometry;
    double stretch = rt_embree_stretch(ray->dir);
    RtEmbreeSearch *search = &batch->searches[i];
    rt_hit_ray(&search->ray, geometry, ray, room);
    search->shrink = 1 / stretch;
    search->best = RT_MISS;
    search->tally = tally;
    float tnear = (float)((double)ray->tmin * search->shrink * (1 - 0x1p-20));
    rt_embree_put_constants(batch, lanes, i);
    rt_embree_put_ray(batch, lanes, i, ray, stretch, tnear, rt_embree_limit(ray->tmax, search->shrink));
    if (may_ask(self, ray, search->shrink)) return;
    if (tally) {
        test_all_counted(geometry, search, any);
    } else {
        test_all_timed(geometry, search, any);
    }
    batch->valid[i] = 0;
    rt_embree_at(batch, lanes, i, RT_EMBREE_TFAR)->f = -INFINITY;
}

/* ---- user mode ---- */

/* Nearest hits to `hits`, or where that is NULL occluders to `occluders`. */
RT_KERNEL void answer(const RtEmbree *self, const RtScratch *scratch, const RtRay *rays, size_t count,
                      RtHit *hits, uint32_t *occluders, RtTally *tallies, unsigned lanes, bool stream) {
    const size_t chunk = stream ? RT_EMBREE_STREAM_RAYS : RT_EMBREE_PACKET_RAYS;
    const bool any = !hits;
    RtEmbreeBatch *batch = scratch->own;
    for (size_t begin = 0; begin < count; begin += chunk) {
        const RtRay *ray = rays + begin;
        size_t n = count - begin < chunk ? count - begin : chunk;
        for (size_t i = 0; i < n; i++) {
            RtTally *tally = tallies ? &tallies[ray[i].kind] : NULL;
            put_search(self, batch, lanes, i, &ray[i], scratch->room, any, tally);
        }
        RtEmbreeTrace trace;
        bool coherent = rt_embree_is_coherent(ray);
        rt_embree_trace_init(&trace, coherent, tallies != NULL, batch->searches, scratch->room);
        rt_embree_trace(self, batch, &trace.context, coherent, n, any, lanes, stream);
        for (size_t i = 0; i < n; i++) {
            if (any) {
                occluders[begin + i] = batch->searches[i].best.object;
            } else {
                hits[begin + i] = batch->searches[i].best;
            }
        }
    }
}

RT_KERNEL void answer_query(const RtEmbree *self, const RtScratch *scratch, const RtRay *rays, size_t count,
                            RtHit *hits, uint32_t *occluders, RtTally *tallies) {
    switch (self->query) {
    case RT_EMBREE_ONE: answer(self, scratch, rays, count, hits, occluders, tallies, 1, false); break;
    case RT_EMBREE_EIGHT: answer(self, scratch, rays, count, hits, occluders, tallies, 8, false); break;
    case RT_EMBREE_SIXTEEN: answer(self, scratch, rays, count, hits, occluders, tallies, 16, false); break;
    case RT_EMBREE_STREAM: answer(self, scratch, rays, count, hits, occluders, tallies, 1, true); break;
    }
}

/* ---- the kernels ---- */

/* Rays and hits, from the answers: either hits or occluders. */
RT_KERNEL void count_answers(const RtRay *rays, size_t count, const RtHit *hits, const uint32_t *occluders,
                             RtTally *tallies) {
    for (size_t i = 0; i < count; i++) {
        uint32_t object = hits ? hits[i].object : occluders[i];
        RT_COUNT(&tallies[rays[i].kind], rays, 1);
        RT_COUNT(&tallies[rays[i].kind], hits, object != RT_NO_OBJECT);
    }
}

RT_KERNEL void answer_all(const RtAccel *accel, const RtScratch *scratch, const RtRay *rays, size_t count,
                          RtHit *hits, uint32_t *occluders, RtTally *tallies) {
    const RtEmbree *self = (const RtEmbree *)accel;
    assert(!hits != !occluders);
    if (self->user) {
        answer_query(self, scratch, rays, count, hits, occluders, tallies);
    } else if (hits) {
        rt_embree_native_nearest(self, scratch, rays, count, hits);
    } else {
        rt_embree_native_occlusion(self, scratch, rays, count, occluders);
    }
    if (tallies) count_answers(rays, count, hits, occluders, tallies);
}

void rt_embree_nearest_timed(const RtAccel *accel, const RtScratch *scratch, const RtRay *rays, size_t count,
                             RtHit *hits) {
    answer_all(accel, scratch, rays, count, hits, NULL, NULL);
}

void rt_embree_nearest_counted(const RtAccel *accel, const RtScratch *scratch, const RtRay *rays,
                               size_t count, RtHit *hits, RtTally *tallies) {
    answer_all(accel, scratch, rays, count, hits, NULL, tallies);
}

void rt_embree_occluded_timed(const RtAccel *accel, const RtScratch *scratch, const RtRay *rays, size_t count,
                              uint32_t *occluders) {
    answer_all(accel, scratch, rays, count, NULL, occluders, NULL);
}

void rt_embree_occluded_counted(const RtAccel *accel, const RtScratch *scratch, const RtRay *rays,
                                size_t count, uint32_t *occluders, RtTally *tallies) {
    answer_all(accel, scratch, rays, count, NULL, occluders, tallies);
}
