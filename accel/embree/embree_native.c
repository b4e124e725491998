/* SPDX-License-Identifier: Apache-2.0 */
/* Native mode: the competitor, so converting rays and hits must cost almost nothing. Rays are written to
 * packets four at a time, by transposing 4 x 4 words; the only arithmetic replaces -0 and tiny components of
 * dir by 0. Fields that are the same for all rays are written once per call. Consecutive object ids are
 * computed, not looked up. A chunk with a direction that is not ordinary (embree_batch.h) takes a slow path.
 *
 * Denormals are disabled from the first ray to the last, except where the slow path uses double. */
#include "accel/embree/embree_batch.h"
#include "core/base/simd_across.h"

#include <stddef.h>
#include <string.h>

/* ---- rays in ---- */

/* The words of an RtRay: org, tmin, dir, tmax are eight in a row. */
enum { ORG_WORDS = 0, DIR_WORDS = 4 };
_Static_assert(offsetof(RtRay, tmin) == 12 && offsetof(RtRay, dir) == 16 && offsetof(RtRay, tmax) == 28,
               "a ray is read as two vectors of four words");

RT_KERNEL RtFloat4 read_words(const RtRay *ray, size_t first) {
    return rt_loadu4((const char *)ray + first * sizeof(float));
}

RT_KERNEL void write_words(RtEmbreeWord *to, RtFloat4 words) {
    memcpy(to, &words, sizeof words);
}

RT_KERNEL RtFloat4 without_tiny(RtFloat4 dir) {
    return (RtFloat4)((RtInt4)dir & (rt_abs(dir) >= RT_EMBREE_LEAST_DIR));
}

/* Writes four rays to lanes i, i + 1, ... of a packet as if their directions were ordinary. Returns -1 for
 * each ray whose direction is. */
RT_KERNEL RtInt4 put_four(RtEmbreeBatch *batch, unsigned lanes, size_t i, const RtRay *rays) {
    RtFloat4 org[4], dir[4];
    RtInt4 is_short = {-1, -1, -1, -1}, is_long = {0, 0, 0, 0};
    for (size_t k = 0; k < 4; k++) {
        org[k] = read_words(&rays[k], ORG_WORDS) + 0.0f; /* -0 becomes 0, which matters to tnear */
        dir[k] = read_words(&rays[k], DIR_WORDS);
    }
    rt_transpose4(org);
    rt_transpose4(dir);
    for (unsigned a = 0; a < 4; a++) write_words(rt_embree_at(batch, lanes, i, RT_EMBREE_ORG + a), org[a]);
    for (unsigned a = 0; a < 3; a++) {
        is_short &= rt_abs(dir[a]) < RT_EMBREE_SHORT;
        is_long |= rt_abs(dir[a]) > RT_EMBREE_LONG;
        write_words(rt_embree_at(batch, lanes, i, RT_EMBREE_DIR + a), without_tiny(dir[a]));
    }
    write_words(rt_embree_at(batch, lanes, i, RT_EMBREE_TFAR), dir[3]);
    return ~(is_short | is_long);
}

/* The same for a ray that is a packet of its own. */
RT_KERNEL bool put_one(RtEmbreeBatch *batch, size_t i, const RtRay *ray) {
    RtFloat4 org = read_words(ray, ORG_WORDS) + 0.0f, dir = without_tiny(read_words(ray, DIR_WORDS));
    write_words(rt_embree_at(batch, 1, i, RT_EMBREE_ORG), org);
    write_words(rt_embree_at(batch, 1, i, RT_EMBREE_DIR), dir);
    rt_embree_at(batch, 1, i, RT_EMBREE_TIME)->f = 0; /* where tmax was written */
    rt_embree_at(batch, 1, i, RT_EMBREE_TFAR)->f = ray->tmax;
    return rt_embree_is_ordinary(ray->dir);
}

/* Rays of any direction: the slow path, out of line. */
static __attribute__((noinline)) void put_any(RtEmbreeBatch *batch, unsigned lanes, const RtRay *rays,
                                              size_t first, size_t end) {
    for (size_t i = first; i < end; i++) {
        double stretch = rt_embree_stretch(rays[i].dir), shrink = 1 / stretch;
        rt_embree_put_ray(batch, lanes, i, &rays[i], stretch, (float)((double)rays[i].tmin * shrink),
                          (float)((double)rt_minf(rays[i].tmax, FLT_MAX) * shrink));
    }
}

/* Writes a chunk of rays; false if one of their directions is not ordinary, in which case all took the slow
 * path. */
RT_KERNEL bool put_chunk(RtEmbreeBatch *batch, unsigned lanes, const RtRay *rays, size_t count,
                         unsigned denormals) {
    bool ordinary = true;
    if (lanes == 1) {
        for (size_t i = 0; i < count; i++) ordinary &= put_one(batch, i, &rays[i]);
    } else {
        RtInt4 all = {-1, -1, -1, -1};
        size_t i = 0;
        for (; i + 4 <= count; i += 4) all &= put_four(batch, lanes, i, &rays[i]);
        ordinary = (all[0] & all[1] & all[2] & all[3]) == -1;
        for (size_t k = i; k < count; k++) ordinary &= rt_embree_is_ordinary(rays[k].dir);
        if (ordinary && i < count) put_any(batch, lanes, rays, i, count);
    }
    if (ordinary) return true;
    rt_embree_denormals_restore(denormals);
    put_any(batch, lanes, rays, 0, count);
    rt_embree_denormals_off();
    return false;
}

/* ---- hits out ---- */

/* A hit at infinity, where Embree's products overflow, counts as a miss. */
RT_KERNEL RtHit take_hit(const RtEmbree *self, RtEmbreeBatch *batch, unsigned lanes, size_t i,
                         double stretch) {
    uint32_t geometry = rt_embree_at(batch, lanes, i, RT_EMBREE_GEOMETRY)->u;
    if (geometry == RTC_INVALID_GEOMETRY_ID) return RT_MISS;
    float t = (float)((double)rt_embree_at(batch, lanes, i, RT_EMBREE_TFAR)->f * stretch);
    if (!(t <= FLT_MAX)) return RT_MISS;
    const RtEmbreeSlot *slot = &self->slots[geometry];
    uint32_t primitive = rt_embree_at(batch, lanes, i, RT_EMBREE_PRIMITIVE)->u;
    return (RtHit){t, slot->consecutive ? slot->first + primitive : slot->ids[primitive]};
}

static __attribute__((noinline)) void take_any(const RtEmbree *self, RtEmbreeBatch *batch, unsigned lanes,
                                               const RtRay *rays, size_t count, RtHit *hits) {
    for (size_t i = 0; i < count; i++)
        hits[i] = take_hit(self, batch, lanes, i, rt_embree_stretch(rays[i].dir));
}

/* ---- queries ---- */

/* Prefetches the rays of the next chunk while this one is traced. */
RT_KERNEL void prefetch_rays(const RtRay *rays, size_t count) {
    for (size_t i = 0; i < count * sizeof(RtRay); i += RT_CACHE_LINE)
        __builtin_prefetch((const char *)rays + i);
}

RT_KERNEL void answer_chunk(const RtEmbree *self, RtEmbreeBatch *batch, RtEmbreeContext *context,
                            const RtRay *rays, size_t count, RtHit *hits, uint32_t *occluders, unsigned lanes,
                            bool stream, unsigned denormals) {
    const bool any = !hits;
    bool ordinary = put_chunk(batch, lanes, rays, count, denormals);
    for (size_t i = 0; !any && i < count; i++)
        rt_embree_at(batch, lanes, i, RT_EMBREE_GEOMETRY)->u = RTC_INVALID_GEOMETRY_ID;
    rt_embree_trace(self, batch, context, rt_embree_is_coherent(rays), count, any, lanes, stream);
    if (any) {
        for (size_t i = 0; i < count; i++) {
            bool blocked = rt_embree_at(batch, lanes, i, RT_EMBREE_TFAR)->f < 0;
            occluders[i] = blocked ? RT_UNNAMED_OBJECT : RT_NO_OBJECT;
        }
    } else if (ordinary) {
        for (size_t i = 0; i < count; i++) hits[i] = take_hit(self, batch, lanes, i, 1);
    } else {
        rt_embree_denormals_restore(denormals);
        take_any(self, batch, lanes, rays, count, hits);
        rt_embree_denormals_off();
    }
}

RT_KERNEL void answer(const RtEmbree *self, const RtScratch *scratch, const RtRay *rays, size_t count,
                      RtHit *hits, uint32_t *occluders, unsigned lanes, bool stream) {
    const size_t chunk = stream ? RT_EMBREE_STREAM_RAYS : RT_EMBREE_PACKET_RAYS;
    RtEmbreeBatch *batch = scratch->own;
    RtEmbreeTrace trace;
    if (count == 0) return;
    rt_embree_trace_init(&trace, rt_embree_is_coherent(rays), false, NULL, scratch->crossings);
    for (size_t i = 0; i < chunk && i < count; i++) rt_embree_put_constants(batch, lanes, i);
    unsigned denormals = rt_embree_denormals_off();
    for (size_t begin = 0; begin < count; begin += chunk) {
        size_t left = count - begin, n = left < chunk ? left : chunk;
        prefetch_rays(rays + begin + n, left - n < chunk ? left - n : chunk);
        answer_chunk(self, batch, &trace.context, rays + begin, n, hits ? hits + begin : NULL,
                     hits ? NULL : occluders + begin, lanes, stream, denormals);
    }
    rt_embree_denormals_restore(denormals);
}

void rt_embree_answer_native(const RtEmbree *self, const RtScratch *scratch, const RtRay *rays, size_t count,
                             RtHit *hits, uint32_t *occluders) {
    RT_EMBREE_BY_QUERY(self->query, answer, self, scratch, rays, count, hits, occluders);
}
