/* SPDX-License-Identifier: Apache-2.0 */
/* embree: Intel's ray tracing kernels, as a competitor and as a reference.
 *
 *   mode=native  Triangles and spheres are Embree's own geometry, with its own arithmetic: fast, and judged
 *                by verdicts. Polygons and cones, which Embree lacks, use our hit functions.
 *   mode=user    Everything uses our hit functions in Embree's hierarchy: the same bits as brute (embree.h
 *                proves it), independent of our structures. Its time is that of the callbacks; never quote
 *                it as Embree's.
 *
 * Paper: Wald, Woop, Benthin, Johnson & Ernst 2014, "Embree: A Kernel Framework for Efficient CPU Ray
 * Tracing", ACM TOG 33(4). Object tests are counted in user mode only. Embree exposes no extent tests, steps
 * or structure, so these are reported as 0.
 *
 * A stream of rays goes to Embree in chunks: as single rays, packets of 8 or 16, or streams. The loop is
 * written once; after inlining, the kind of query and whether it counts are constants. */
#include "accel/embree/embree_batch.h"

#include <assert.h>

/* The fastest setting depends on the scene and on the rays: packets for coherent rays, AVX2 on some machines
 * that have AVX-512. `robust` costs speed, so it is off. */
static const RtBestOf bests[] = {
    {"best", "query=1|8|16|stream,quality=medium|high,isa=avx2|avx512",
     "Embree's fastest setting for each scene and ray kind"},
    {"one", "query=1,quality=medium|high,isa=avx2|avx512", "its fastest setting for single rays"},
};

/* ---- rays in ---- */

/* Whether Embree proposes all objects that this ray hits (embree.h). |dir| is at most 2^17 * shrink. */
RT_KERNEL bool is_in_reach(const RtEmbree *self, const RtRay *ray, double shrink) {
    return rt_thickness(ray->org, &self->base.scene->geometry.box) <= self->max_thickness &&
           0x1p-150 * 0x1p17 * shrink <= 0.25 * (double)self->growth;
}

/* Writes a ray to the batch; one out of reach is answered at once, and is inactive in the batch. */
RT_KERNEL void put_search(const RtEmbree *self, RtEmbreeBatch *batch, unsigned lanes, size_t i,
                          const RtRay *ray, RtCrossing *crossings, bool any, RtTally *tally) {
    const RtGeometry *geometry = &self->base.scene->geometry;
    double stretch = rt_embree_stretch(ray->dir);
    RtEmbreeSearch *search = &batch->searches[i];
    rt_hit_ray(&search->ray, geometry, ray, crossings);
    search->shrink = 1 / stretch;
    search->best = RT_MISS;
    search->tally = tally;
    float tnear = (float)((double)ray->tmin * search->shrink * (1 - 0x1p-20));
    rt_embree_put_constants(batch, lanes, i);
    rt_embree_put_ray(batch, lanes, i, ray, stretch, tnear, rt_embree_limit(ray->tmax, search->shrink));
    if (is_in_reach(self, ray, search->shrink)) return;
    rt_test_all(geometry, &search->ray, any, &search->best, tally);
    batch->valid[i] = 0;
    rt_embree_at(batch, lanes, i, RT_EMBREE_TFAR)->f = -INFINITY;
}

/* ---- user mode ---- */

/* Writes nearest hits to `hits`, or if that is NULL, occluders to `occluders`. */
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
            put_search(self, batch, lanes, i, &ray[i], scratch->crossings, any, tally);
        }
        RtEmbreeTrace trace;
        bool coherent = rt_embree_is_coherent(ray);
        rt_embree_trace_init(&trace, coherent, tallies != NULL, batch->searches, scratch->crossings);
        rt_embree_trace(self, batch, &trace.context, coherent, n, any, lanes, stream);
        for (size_t i = 0; i < n; i++) {
            if (any)
                occluders[begin + i] = batch->searches[i].best.object;
            else
                hits[begin + i] = batch->searches[i].best;
        }
    }
}

/* ---- the kernels ---- */

/* Counts rays and hits from the answers, which are either hits or occluders. */
RT_KERNEL void count_answers(const RtRay *rays, size_t count, const RtHit *hits, const uint32_t *occluders,
                             RtTally *tallies) {
    assert(hits || occluders);
    for (size_t i = 0; i < count; i++) {
        uint32_t object = hits ? hits[i].object : occluders[i];
        RT_COUNT(&tallies[rays[i].kind], rays, 1);
        RT_COUNT(&tallies[rays[i].kind], hits, object != RT_NO_OBJECT);
    }
}

RT_KERNEL void answer_all(const RtAccel *accel, const RtScratch *scratch, const RtRay *rays, size_t count,
                          RtHit *hits, uint32_t *occluders, RtTally *tallies, bool any, bool counted) {
    const RtEmbree *self = (const RtEmbree *)accel;
    (void)any;
    if (self->user)
        RT_EMBREE_BY_QUERY(self->query, answer, self, scratch, rays, count, hits, occluders, tallies);
    else
        rt_embree_answer_native(self, scratch, rays, count, hits, occluders);
    if (counted) count_answers(rays, count, hits, occluders, tallies);
}

RT_DEFINE_STREAM_KERNELS(answer_all)

const RtAccelOps rt_embree_ops = {
    .name = "embree",
    .summary = "Intel's library: the competitor (mode=native) and a reference (mode=user)",
    .paper = "Wald, Woop, Benthin, Johnson & Ernst 2014, Embree: A Kernel Framework for Efficient CPU Ray "
             "Tracing, ACM TOG 33(4)",
    RT_PARAMS_OF(rt_embree_params),
    .bests = bests,
    .best_count = sizeof bests / sizeof bests[0],
    .available = rt_embree_available,
    .bytes = sizeof(RtEmbree),
    .build = rt_embree_build,
    .destroy = rt_embree_destroy,
    RT_KERNEL_OPS,
    .describe = rt_embree_describe,
    .validate = rt_embree_validate,
    .library = rt_embree_library,
    .check = rt_embree_check,
};
