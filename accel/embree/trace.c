/* SPDX-License-Identifier: Apache-2.0 */
/* The kernels: a stream of our rays goes to Embree in chunks, as single rays, packets of 8 or 16, or streams,
 * and comes back as hits. The loop is written once; mode, query and counting are constants where it is
 * inlined.
 *
 * Rays are valid (rt_ray_is_valid), so what Embree's assertions forbid cannot occur but for directions above
 * 1.8e18; those, and directions so short that Embree would take them for others, are brought to an ordinary
 * length by a power of two, which changes t by the same power and no bit of its mantissa. */
#include "accel/embree/embree.h"
#include "accel/kernel.h"

#include "base/memory.h"

#if defined(__x86_64__)
#include <xmmintrin.h>
#endif

typedef struct Batch {
    _Alignas(RT_CACHE_LINE) struct RTCRayHit packets[RT_EMBREE_STREAM_RAYS]; /* or as packets of 8 or 16 */
    int valid[RT_EMBREE_STREAM_RAYS];                                        /* -1 or 0, as Embree asks */
    RtEmbreeSearch searches[RT_EMBREE_STREAM_RAYS];
} Batch;

_Static_assert(sizeof(struct RTCRayHit16) <= RT_EMBREE_PACKET_RAYS * sizeof(struct RTCRayHit),
               "a packet takes no more room than its rays");

size_t rt_embree_scratch_bytes(const RtAccel *accel) {
    (void)accel;
    return sizeof(Batch);
}

/* ---- denormals: Embree's documentation asks for them to be off; our own arithmetic needs them ---- */

static inline unsigned denormals_off(void) {
#if defined(__x86_64__)
    unsigned before = _mm_getcsr();
    _mm_setcsr(before | 0x8040u); /* flush to zero, denormals are zero */
    return before;
#else
    return 0;
#endif
}

static inline void denormals_restore(unsigned before) {
#if defined(__x86_64__)
    _mm_setcsr(before);
#else
    (void)before;
#endif
}

/* ---- rays in ---- */

/* Components of dir below this Embree takes for +LEAST_DIR, and forgets to turn the sign of negative ones:
 * a stream may then lose hits. So they, and -0, go in as 0. */
#define LEAST_DIR 1e-18f

static double unusual_stretch(double most) {
    double stretch = 1;
    while (most * stretch < 0x1p-16) stretch *= 0x1p16;
    while (most * stretch > 0x1p16) stretch *= 0x1p-16;
    return stretch;
}

/* The power of two that brings the longest component of dir into [2^-16, 2^16]: nearly always 1. */
RT_KERNEL double stretch_of(RtVec3 dir) {
    float most = rt_maxf(fabsf(dir.x), rt_maxf(fabsf(dir.y), fabsf(dir.z)));
    return most >= 0x1p-16f && most <= 0x1p16f ? 1 : unusual_stretch((double)most);
}

RT_KERNEL RtEmbreeWord *word_of(Batch *batch, unsigned lanes, size_t i, size_t field) {
    RtEmbreeWord *packet = (RtEmbreeWord *)batch->packets + i / lanes * rt_embree_packet_words(lanes);
    return rt_embree_word(packet, lanes, field, i % lanes);
}

RT_KERNEL void put_ray(Batch *batch, unsigned lanes, size_t i, const RtRay *ray, double stretch, float tnear,
                       float tfar) {
    for (unsigned a = 0; a < 3; a++) {
        word_of(batch, lanes, i, RT_EMBREE_ORG + a)->f = ray->org.at[a];
        float dir = (float)((double)ray->dir.at[a] * stretch);
        word_of(batch, lanes, i, RT_EMBREE_DIR + a)->f = fabsf(dir) < LEAST_DIR ? 0 : dir;
    }
    word_of(batch, lanes, i, RT_EMBREE_TNEAR)->f = rt_minf(tnear, FLT_MAX) + 0.0f; /* -0 becomes 0 */
    word_of(batch, lanes, i, RT_EMBREE_TFAR)->f = tfar;
    word_of(batch, lanes, i, RT_EMBREE_TIME)->f = 0;
    word_of(batch, lanes, i, RT_EMBREE_MASK)->u = UINT32_MAX;
    word_of(batch, lanes, i, RT_EMBREE_ID)->u = (uint32_t)i;
    word_of(batch, lanes, i, RT_EMBREE_FLAGS)->u = 0;
    word_of(batch, lanes, i, RT_EMBREE_GEOMETRY)->u = RTC_INVALID_GEOMETRY_ID;
    word_of(batch, lanes, i, RT_EMBREE_INSTANCE)->u = RTC_INVALID_GEOMETRY_ID;
    batch->valid[i] = -1;
}

RT_KERNEL void put_native(Batch *batch, unsigned lanes, size_t i, const RtRay *ray) {
    double stretch = stretch_of(ray->dir), shrink = 1 / stretch;
    put_ray(batch, lanes, i, ray, stretch, (float)((double)ray->tmin * shrink),
            (float)((double)ray->tmax * shrink));
}

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
RT_KERNEL void put_search(const RtEmbree *self, Batch *batch, unsigned lanes, size_t i, const RtRay *ray,
                          RtCrossing *room, bool any, RtTally *tally) {
    const RtGeometry *geometry = &self->base.scene->geometry;
    double stretch = stretch_of(ray->dir);
    RtEmbreeSearch *search = &batch->searches[i];
    rt_hit_ray(&search->ray, geometry, ray, room);
    search->shrink = 1 / stretch;
    search->best = RT_MISS;
    search->tally = tally;
    float tnear = (float)((double)ray->tmin * search->shrink * (1 - 0x1p-20));
    put_ray(batch, lanes, i, ray, stretch, tnear, rt_embree_limit(ray->tmax, search->shrink));
    if (may_ask(self, ray, search->shrink)) return;
    if (tally) {
        test_all_counted(geometry, search, any);
    } else {
        test_all_timed(geometry, search, any);
    }
    batch->valid[i] = 0;
    word_of(batch, lanes, i, RT_EMBREE_TFAR)->f = -INFINITY;
}

/* ---- through Embree ---- */

RT_KERNEL void trace_chunk(const RtEmbree *self, Batch *batch, RtEmbreeContext *context, bool coherent,
                           size_t count, bool any, unsigned lanes, bool stream) {
    RtEmbreeWord *words = (RtEmbreeWord *)batch->packets;
    if (stream) {
        if (any) {
            rt_embree_occluded_stream(self->scene, context, words, (unsigned)count);
        } else {
            rt_embree_intersect_stream(self->scene, context, words, (unsigned)count);
        }
        return;
    }
    for (size_t i = count; i % lanes != 0; i++) batch->valid[i] = 0;
    for (size_t i = 0; i < count; i += lanes, words += rt_embree_packet_words(lanes)) {
        const int *valid = &batch->valid[i];
        if (lanes == 1 && !*valid) continue;
        if (any) {
            rt_embree_occluded(self->scene, context, coherent, valid, words, lanes);
        } else {
            rt_embree_intersect(self->scene, context, coherent, valid, words, lanes);
        }
    }
}

/* ---- hits out ---- */

/* A hit at infinity, where Embree's products overflow, is none. */
RT_KERNEL RtHit native_hit(const RtEmbree *self, Batch *batch, unsigned lanes, size_t i, const RtRay *ray) {
    uint32_t slot = word_of(batch, lanes, i, RT_EMBREE_GEOMETRY)->u;
    if (slot == RTC_INVALID_GEOMETRY_ID) return RT_MISS;
    double t = (double)word_of(batch, lanes, i, RT_EMBREE_TFAR)->f * stretch_of(ray->dir);
    if (!(t <= (double)FLT_MAX)) return RT_MISS;
    return (RtHit){(float)t, self->slots[slot].ids[word_of(batch, lanes, i, RT_EMBREE_PRIMITIVE)->u]};
}

/* ---- the kernels ---- */

/* Primary and shadow rays come in tiles, so neighbours go the same way. */
RT_KERNEL bool is_coherent(const RtRay *ray) {
    return ray->kind == RT_RAY_PRIMARY || ray->kind == RT_RAY_SHADOW;
}

/* Nearest hits to `hits`, or where that is NULL blockers to `blockers`. */
RT_KERNEL void answer(const RtEmbree *self, const RtScratch *scratch, const RtRay *rays, size_t count,
                      RtHit *hits, uint32_t *blockers, RtTally *tallies, bool user, unsigned lanes,
                      bool stream) {
    const size_t chunk = stream ? RT_EMBREE_STREAM_RAYS : RT_EMBREE_PACKET_RAYS;
    const bool any = !hits;
    Batch *batch = scratch->own;
    for (size_t begin = 0; begin < count; begin += chunk) {
        const RtRay *ray = rays + begin;
        size_t n = count - begin < chunk ? count - begin : chunk;
        for (size_t i = 0; i < n; i++) {
            if (user) {
                RtTally *tally = tallies ? &tallies[ray[i].kind] : NULL;
                put_search(self, batch, lanes, i, &ray[i], scratch->room, any, tally);
            } else {
                put_native(batch, lanes, i, &ray[i]);
            }
        }
        RtEmbreeTrace trace;
        bool coherent = is_coherent(ray);
        rt_embree_trace_init(&trace, coherent, tallies != NULL, batch->searches, scratch->room);
        unsigned before = user ? 0 : denormals_off();
        trace_chunk(self, batch, &trace.context, coherent, n, any, lanes, stream);
        if (!user) denormals_restore(before);
        for (size_t i = 0; i < n; i++) {
            RtHit hit = user ? batch->searches[i].best : RT_MISS;
            if (!user && !any) hit = native_hit(self, batch, lanes, i, &ray[i]);
            if (!user && any && word_of(batch, lanes, i, RT_EMBREE_TFAR)->f < 0) {
                hit.object = RT_UNNAMED_OBJECT;
            }
            if (any) {
                blockers[begin + i] = hit.object;
            } else {
                hits[begin + i] = hit;
            }
            if (tallies) {
                RT_COUNT(&tallies[ray[i].kind], rays, 1);
                RT_COUNT(&tallies[ray[i].kind], hits, hit.object != RT_NO_OBJECT);
            }
        }
    }
}

RT_KERNEL void answer_mode(const RtEmbree *self, const RtScratch *scratch, const RtRay *rays, size_t count,
                           RtHit *hits, uint32_t *blockers, RtTally *tallies, bool user) {
    switch (self->query) {
    case RT_EMBREE_ONE: answer(self, scratch, rays, count, hits, blockers, tallies, user, 1, false); break;
    case RT_EMBREE_EIGHT: answer(self, scratch, rays, count, hits, blockers, tallies, user, 8, false); break;
    case RT_EMBREE_SIXTEEN:
        answer(self, scratch, rays, count, hits, blockers, tallies, user, 16, false);
        break;
    case RT_EMBREE_STREAM: answer(self, scratch, rays, count, hits, blockers, tallies, user, 1, true); break;
    }
}

RT_KERNEL void answer_all(const RtAccel *accel, const RtScratch *scratch, const RtRay *rays, size_t count,
                          RtHit *hits, uint32_t *blockers, RtTally *tallies) {
    const RtEmbree *self = (const RtEmbree *)accel;
    if (self->user) {
        answer_mode(self, scratch, rays, count, hits, blockers, tallies, true);
    } else {
        answer_mode(self, scratch, rays, count, hits, blockers, tallies, false);
    }
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
                              uint32_t *blockers) {
    answer_all(accel, scratch, rays, count, NULL, blockers, NULL);
}

void rt_embree_occluded_counted(const RtAccel *accel, const RtScratch *scratch, const RtRay *rays,
                                size_t count, uint32_t *blockers, RtTally *tallies) {
    answer_all(accel, scratch, rays, count, NULL, blockers, tallies);
}
