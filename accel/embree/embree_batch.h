/* SPDX-License-Identifier: Apache-2.0 */
/* Batches of rays in Embree's layout, the scratch memory of a query, shared by native and user mode.
 *
 * Rays are valid (rt_ray_is_valid), so they satisfy Embree's assertions, except that a direction may exceed
 * 1.8e18. Such directions, and directions so short that Embree would change them, are scaled by a power of
 * two, which scales t by the inverse power and changes no bit of its mantissa. */
#ifndef RT_ACCEL_EMBREE_BATCH_H
#define RT_ACCEL_EMBREE_BATCH_H

#include "accel/embree/embree.h"
#include "accel/kernel.h"

#include "core/base/memory.h"

#if defined(__x86_64__)
#include <xmmintrin.h>
#endif

typedef struct RtEmbreeBatch {
    _Alignas(RT_CACHE_LINE) struct RTCRayHit packets[RT_EMBREE_STREAM_RAYS]; /* or packets of 8 or 16 */
    int valid[RT_EMBREE_STREAM_RAYS];                                        /* -1: active, 0: inactive */
    RtEmbreeSearch searches[RT_EMBREE_STREAM_RAYS];
} RtEmbreeBatch;

_Static_assert(sizeof(struct RTCRayHit16) <= RT_EMBREE_PACKET_RAYS * sizeof(struct RTCRayHit),
               "a packet takes no more room than its rays");

/* ---- denormals: Embree's documentation recommends to disable them; our own arithmetic needs them ---- */

static inline unsigned rt_embree_denormals_off(void) {
#if defined(__x86_64__)
    unsigned before = _mm_getcsr();
    _mm_setcsr(before | 0x8040u); /* flush to zero, denormals are zero */
    return before;
#else
    return 0;
#endif
}

static inline void rt_embree_denormals_restore(unsigned before) {
#if defined(__x86_64__)
    _mm_setcsr(before);
#else
    (void)before;
#endif
}

/* ---- rays in ---- */

/* Embree replaces smaller components of dir by +RT_EMBREE_LEAST_DIR, even negative ones, so a stream may lose
 * hits. Therefore they, and -0, are passed as 0. */
#define RT_EMBREE_LEAST_DIR 1e-18f

/* Bounds of the largest component of an ordinary direction. */
#define RT_EMBREE_SHORT 0x1p-16f
#define RT_EMBREE_LONG  0x1p16f

RT_KERNEL float rt_embree_longest(RtVec3 dir) {
    return rt_maxf(fabsf(dir.x), rt_maxf(fabsf(dir.y), fabsf(dir.z)));
}

RT_KERNEL bool rt_embree_is_ordinary(RtVec3 dir) {
    float longest = rt_embree_longest(dir);
    return longest >= RT_EMBREE_SHORT && longest <= RT_EMBREE_LONG;
}

/* The power of two that makes dir ordinary: nearly always 1. */
RT_KERNEL double rt_embree_stretch(RtVec3 dir) {
    double longest = (double)rt_embree_longest(dir), stretch = 1;
    while (longest * stretch < (double)RT_EMBREE_SHORT) stretch *= 0x1p16;
    while (longest * stretch > (double)RT_EMBREE_LONG) stretch *= 0x1p-16;
    return stretch;
}

RT_KERNEL RtEmbreeWord *rt_embree_at(RtEmbreeBatch *batch, unsigned lanes, size_t i, size_t field) {
    RtEmbreeWord *packet = (RtEmbreeWord *)batch->packets + i / lanes * rt_embree_packet_words(lanes);
    return rt_embree_word(packet, lanes, field, i % lanes);
}

/* The fields that are the same for all rays. */
RT_KERNEL void rt_embree_put_constants(RtEmbreeBatch *batch, unsigned lanes, size_t i) {
    rt_embree_at(batch, lanes, i, RT_EMBREE_TIME)->f = 0;
    rt_embree_at(batch, lanes, i, RT_EMBREE_MASK)->u = UINT32_MAX;
    rt_embree_at(batch, lanes, i, RT_EMBREE_ID)->u = (uint32_t)i;
    rt_embree_at(batch, lanes, i, RT_EMBREE_FLAGS)->u = 0;
    rt_embree_at(batch, lanes, i, RT_EMBREE_GEOMETRY)->u = RTC_INVALID_GEOMETRY_ID;
    rt_embree_at(batch, lanes, i, RT_EMBREE_INSTANCE)->u = RTC_INVALID_GEOMETRY_ID;
    batch->valid[i] = -1;
}

RT_KERNEL void rt_embree_put_ray(RtEmbreeBatch *batch, unsigned lanes, size_t i, const RtRay *ray,
                                 double stretch, float tnear, float tfar) {
    for (unsigned a = 0; a < 3; a++) {
        rt_embree_at(batch, lanes, i, RT_EMBREE_ORG + a)->f = ray->org.at[a];
        float dir = (float)((double)ray->dir.at[a] * stretch);
        rt_embree_at(batch, lanes, i, RT_EMBREE_DIR + a)->f = fabsf(dir) < RT_EMBREE_LEAST_DIR ? 0 : dir;
    }
    rt_embree_at(batch, lanes, i, RT_EMBREE_TNEAR)->f = rt_minf(tnear, FLT_MAX) + 0.0f; /* -0 becomes 0 */
    rt_embree_at(batch, lanes, i, RT_EMBREE_TFAR)->f = tfar;
}

/* ---- tracing ---- */

/* Primary and shadow rays come in tiles, so neighbours are coherent. */
RT_KERNEL bool rt_embree_is_coherent(const RtRay *ray) {
    return ray->kind == RT_RAY_PRIMARY || ray->kind == RT_RAY_SHADOW;
}

/* Traces the first `count` rays of the batch. */
RT_KERNEL void rt_embree_trace(const RtEmbree *self, RtEmbreeBatch *batch, RtEmbreeContext *context,
                               bool coherent, size_t count, bool any, unsigned lanes, bool stream) {
    RtEmbreeWord *words = (RtEmbreeWord *)batch->packets;
    if (stream) {
        rt_embree_trace_stream(self->scene, context, words, (unsigned)count, any);
        return;
    }
    for (size_t i = count; i % lanes != 0; i++) batch->valid[i] = 0;
    for (size_t i = 0; i < count; i += lanes, words += rt_embree_packet_words(lanes)) {
        const int *valid = &batch->valid[i];
        if (lanes == 1 && !*valid) continue;
        rt_embree_trace_packet(self->scene, context, coherent, valid, words, lanes, any);
    }
}

/* Calls the inlined function answer(..., lanes, stream) with constants for each kind of query. */
#define RT_EMBREE_BY_QUERY(query, answer, ...)                                                               \
    do {                                                                                                     \
        switch (query) {                                                                                     \
        case RT_EMBREE_ONE: answer(__VA_ARGS__, 1, false); break;                                            \
        case RT_EMBREE_EIGHT: answer(__VA_ARGS__, 8, false); break;                                          \
        case RT_EMBREE_SIXTEEN: answer(__VA_ARGS__, 16, false); break;                                       \
        case RT_EMBREE_STREAM: answer(__VA_ARGS__, 1, true); break;                                          \
        }                                                                                                    \
    } while (0)

#endif
