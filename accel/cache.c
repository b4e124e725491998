/* SPDX-License-Identifier: Apache-2.0 */
/* cache: the shadow cache of Haines & Greenberg 1986, an overlay for shadow rays.
 *
 * The same object shadows most neighbouring points. So the last occluder of each light is tested first; if it
 * occludes this ray too, one object test answers it. Otherwise the ray is passed on, and its occluder is
 * cached.
 *
 * Layout: the scratch memory of a query has one id per light, the last occluder or RT_NO_OBJECT. There is no
 * structure, and building costs nothing.
 *
 * Exact, because the cached object is tested by its own hit function, and any occluder is a right answer.
 *
 * The cached object depends on earlier rays. rt_query_begin empties the cache, so counts do not depend on the
 * number of threads: between two of its calls the rays come in one order, in streams of any length. */
#include "accel/kernel.h"

static RtStatus build(RtAccel *accel, const RtBuild *what, RtError *error) {
    (void)error;
    accel->scratch_bytes = what->scene->light_count * sizeof(uint32_t);
    return RT_OK;
}

static void begin(const RtAccel *accel, void *scratch) {
    uint32_t *last = scratch;
    for (uint32_t i = 0; i < accel->scene->light_count; i++) last[i] = RT_NO_OBJECT;
}

/* ---- queries ---- */

RT_KERNEL void find_occluder(const RtAccel *self, const RtScratch *scratch, const RtRay *ray,
                             uint32_t *occluder, RtTally *tallies) {
    const RtScene *scene = self->scene;
    const RtGeometry *g = &scene->geometry;
    RtTally *tally = tallies ? &tallies[RT_RAY_SHADOW] : NULL;
    uint32_t *last = ray->source < scene->light_count ? (uint32_t *)scratch->own + ray->source : NULL;
    if (last && *last != RT_NO_OBJECT) {
        RtPreparedRay prepared;
        rt_hit_ray(&prepared, g, ray, scratch->hit_memory);
        RtHit hit = RT_MISS;
        RT_COUNT(tally, steps, 1);
        RT_OBSERVE(tally, .kind = RT_TRACED_STEP, .what = "object", .index = *last);
        if (rt_test_object(g, *last, &prepared, true, &hit, tally)) {
            rt_count_answer(true, tally);
            *occluder = hit.object;
            return;
        }
    }
    RT_COUNT(tally, passed_on, 1);
    RT_OBSERVE(tally, .kind = RT_TRACED_PASSED_ON, .what = self->ops->name);
    rt_hand_down(self, scratch, ray, 1, NULL, occluder, tallies);
    if (last && *occluder < rt_geometry_id_count(g)) *last = rt_geometry_holder(g, *occluder);
}

/* Queries for nearest hits, and runs of rays of other kinds, are handed down. */
RT_KERNEL void trace(const RtAccel *accel, const RtScratch *scratch, const RtRay *rays, size_t count,
                     RtHit *hits, uint32_t *occluders, RtTally *tallies, bool any, bool counted) {
    (void)counted;
    if (!any) rt_hand_down(accel, scratch, rays, count, hits, NULL, tallies);
    for (size_t i = 0, first = 0; any && i < count; first = i) {
        while (i < count && rays[i].kind != RT_RAY_SHADOW) i++;
        if (i > first)
            rt_hand_down(accel, scratch, rays + first, i - first, NULL, occluders + first, tallies);
        for (; i < count && rays[i].kind == RT_RAY_SHADOW; i++)
            find_occluder(accel, scratch, &rays[i], &occluders[i], tallies);
    }
}

RT_DEFINE_STREAM_KERNELS(trace, 0)

static void describe(const RtAccel *accel, RtDescription *out) {
    (void)accel;
    *out = (RtDescription){RT_NO_PREDICTION};
}

const RtAccelOps rt_cache_ops = {
    .name = "cache",
    .summary = "overlay: the last occluder of each light is tested first",
    .paper = "Haines & Greenberg 1986, The Light Buffer: A Shadow-Testing Accelerator, CG&A 6(9)",
    .kinds = 1u << RT_RAY_SHADOW,
    .bytes = sizeof(RtAccel),
    .build = build,
    .kernels = &kernels,
    .begin = begin,
    .describe = describe,
};
