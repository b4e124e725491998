/* SPDX-License-Identifier: Apache-2.0 */
/* Embree 3 and Embree 4 under one set of names: the only file that knows which of them it is. RT_WITH_EMBREE
 * is the major version. Embree 4 has no streams of single rays any more (RT_EMBREE_STREAMS is 0).
 *
 * A packet of N rays is an array of 32-bit words in both: field f of lane i is word f * N + i, and a single
 * ray is a packet of one. */
#ifndef RT_ACCEL_EMBREE_API_H
#define RT_ACCEL_EMBREE_API_H

#include <stdint.h>

#if RT_WITH_EMBREE >= 4
#include <embree4/rtcore.h>
#define RT_EMBREE_STREAMS 0
typedef struct RTCRayQueryContext RtEmbreeContext;
#else
#include <embree3/rtcore.h>
#define RT_EMBREE_STREAMS 1
typedef struct RTCIntersectContext RtEmbreeContext;
#endif

typedef union RtEmbreeWord {
    float f;
    uint32_t u;
} RtEmbreeWord;

/* The fields of a packet, in the order of RTCRayN and RTCHitN. */
enum {
    RT_EMBREE_ORG, /* x, y, z */
    RT_EMBREE_TNEAR = 3,
    RT_EMBREE_DIR, /* x, y, z */
    RT_EMBREE_TIME = 7,
    RT_EMBREE_TFAR,
    RT_EMBREE_MASK,
    RT_EMBREE_ID,
    RT_EMBREE_FLAGS,
    RT_EMBREE_NG, /* x, y, z */
    RT_EMBREE_U = 15,
    RT_EMBREE_V,
    RT_EMBREE_PRIMITIVE,
    RT_EMBREE_GEOMETRY,
    RT_EMBREE_INSTANCE
};

/* A field of one lane. */
static inline RtEmbreeWord *rt_embree_word(RtEmbreeWord *packet, size_t lanes, size_t field, size_t lane) {
    return &packet[field * lanes + lane];
}

/* Words from one packet of rays and hits to the next. */
static inline size_t rt_embree_packet_words(unsigned lanes) {
    size_t bytes = lanes == 1   ? sizeof(struct RTCRayHit)
                   : lanes == 8 ? sizeof(struct RTCRayHit8)
                                : sizeof(struct RTCRayHit16);
    return bytes / sizeof(RtEmbreeWord);
}

#if RT_WITH_EMBREE >= 4

static inline void rt_embree_init_context(RtEmbreeContext *context, bool coherent) {
    (void)coherent;
    rtcInitRayQueryContext(context);
}

/* Nearest hits of one packet of 1, 8 or 16 lanes. */
static inline void rt_embree_intersect(RTCScene scene, RtEmbreeContext *context, bool coherent,
                                       const int *valid, RtEmbreeWord *packet, unsigned lanes) {
    struct RTCIntersectArguments arguments;
    rtcInitIntersectArguments(&arguments);
    arguments.context = context;
    if (coherent) arguments.flags = RTC_RAY_QUERY_FLAG_COHERENT;
    if (lanes == 1) rtcIntersect1(scene, (struct RTCRayHit *)packet, &arguments);
    if (lanes == 8) rtcIntersect8(valid, scene, (struct RTCRayHit8 *)packet, &arguments);
    if (lanes == 16) rtcIntersect16(valid, scene, (struct RTCRayHit16 *)packet, &arguments);
}

/* The same for occlusion: tfar becomes -inf where anything is hit. */
static inline void rt_embree_occluded(RTCScene scene, RtEmbreeContext *context, bool coherent,
                                      const int *valid, RtEmbreeWord *packet, unsigned lanes) {
    struct RTCOccludedArguments arguments;
    rtcInitOccludedArguments(&arguments);
    arguments.context = context;
    if (coherent) arguments.flags = RTC_RAY_QUERY_FLAG_COHERENT;
    if (lanes == 1) rtcOccluded1(scene, (struct RTCRay *)packet, &arguments);
    if (lanes == 8) rtcOccluded8(valid, scene, (struct RTCRay8 *)packet, &arguments);
    if (lanes == 16) rtcOccluded16(valid, scene, (struct RTCRay16 *)packet, &arguments);
}

#else

static inline void rt_embree_init_context(RtEmbreeContext *context, bool coherent) {
    rtcInitIntersectContext(context);
    if (coherent) context->flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
}

/* Nearest hits of one packet of 1, 8 or 16 lanes. */
static inline void rt_embree_intersect(RTCScene scene, RtEmbreeContext *context, bool coherent,
                                       const int *valid, RtEmbreeWord *packet, unsigned lanes) {
    (void)coherent;
    if (lanes == 1) rtcIntersect1(scene, context, (struct RTCRayHit *)packet);
    if (lanes == 8) rtcIntersect8(valid, scene, context, (struct RTCRayHit8 *)packet);
    if (lanes == 16) rtcIntersect16(valid, scene, context, (struct RTCRayHit16 *)packet);
}

/* The same for occlusion: tfar becomes -inf where anything is hit. */
static inline void rt_embree_occluded(RTCScene scene, RtEmbreeContext *context, bool coherent,
                                      const int *valid, RtEmbreeWord *packet, unsigned lanes) {
    (void)coherent;
    if (lanes == 1) rtcOccluded1(scene, context, (struct RTCRay *)packet);
    if (lanes == 8) rtcOccluded8(valid, scene, context, (struct RTCRay8 *)packet);
    if (lanes == 16) rtcOccluded16(valid, scene, context, (struct RTCRay16 *)packet);
}

#endif

/* Streams of `count` packets of one lane; never called where RT_EMBREE_STREAMS is 0. */
static inline void rt_embree_intersect_stream(RTCScene scene, RtEmbreeContext *context, RtEmbreeWord *packets,
                                              unsigned count) {
#if RT_EMBREE_STREAMS
    rtcIntersect1M(scene, context, (struct RTCRayHit *)packets, count, sizeof(struct RTCRayHit));
#else
    (void)scene, (void)context, (void)packets, (void)count;
#endif
}

static inline void rt_embree_occluded_stream(RTCScene scene, RtEmbreeContext *context, RtEmbreeWord *packets,
                                             unsigned count) {
#if RT_EMBREE_STREAMS
    rtcOccluded1M(scene, context, (struct RTCRay *)packets, count, sizeof(struct RTCRayHit));
#else
    (void)scene, (void)context, (void)packets, (void)count;
#endif
}

#endif
