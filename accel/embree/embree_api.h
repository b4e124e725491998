/* SPDX-License-Identifier: Apache-2.0 */
/* One interface to Embree 3 and Embree 4; RT_WITH_EMBREE is the major version. Embree 4 no longer has streams
 * of single rays (RT_EMBREE_STREAMS is 0).
 *
 * In both, a packet of N rays is an array of 32-bit words: field f of lane i is word f * N + i. A single ray
 * is a packet of one. */
#ifndef RT_ACCEL_EMBREE_API_H
#define RT_ACCEL_EMBREE_API_H

#include <stdbool.h>
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

static inline void rt_embree_init_context(RtEmbreeContext *context, bool coherent) {
#if RT_WITH_EMBREE >= 4
    (void)coherent;
    rtcInitRayQueryContext(context);
#else
    rtcInitIntersectContext(context);
    if (coherent) context->flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
#endif
}

/* Traces one packet of 1, 8 or 16 lanes: nearest hits, or with `any` occlusion, where tfar becomes -inf for a
 * ray that hits anything. */
static inline void rt_embree_trace_packet(RTCScene scene, RtEmbreeContext *context, bool coherent,
                                          const int *valid, RtEmbreeWord *packet, unsigned lanes, bool any) {
#if RT_WITH_EMBREE >= 4
    struct RTCIntersectArguments nearest;
    struct RTCOccludedArguments occluded;
    rtcInitIntersectArguments(&nearest);
    rtcInitOccludedArguments(&occluded);
    nearest.context = occluded.context = context;
    if (coherent) nearest.flags = occluded.flags = RTC_RAY_QUERY_FLAG_COHERENT;
#define TRACE_RAY(trace, Type, arguments)    trace(scene, (struct Type *)packet, &arguments)
#define TRACE_PACKET(trace, Type, arguments) trace(valid, scene, (struct Type *)packet, &arguments)
#else
    (void)coherent;
#define TRACE_RAY(trace, Type, arguments)    trace(scene, context, (struct Type *)packet)
#define TRACE_PACKET(trace, Type, arguments) trace(valid, scene, context, (struct Type *)packet)
#endif
    if (any) {
        if (lanes == 1) TRACE_RAY(rtcOccluded1, RTCRay, occluded);
        if (lanes == 8) TRACE_PACKET(rtcOccluded8, RTCRay8, occluded);
        if (lanes == 16) TRACE_PACKET(rtcOccluded16, RTCRay16, occluded);
    } else {
        if (lanes == 1) TRACE_RAY(rtcIntersect1, RTCRayHit, nearest);
        if (lanes == 8) TRACE_PACKET(rtcIntersect8, RTCRayHit8, nearest);
        if (lanes == 16) TRACE_PACKET(rtcIntersect16, RTCRayHit16, nearest);
    }
#undef TRACE_RAY
#undef TRACE_PACKET
}

/* Traces a stream of `count` packets of one lane; never called if RT_EMBREE_STREAMS is 0. */
static inline void rt_embree_trace_stream(RTCScene scene, RtEmbreeContext *context, RtEmbreeWord *packets,
                                          unsigned count, bool any) {
#if RT_EMBREE_STREAMS
    if (any)
        rtcOccluded1M(scene, context, (struct RTCRay *)packets, count, sizeof(struct RTCRayHit));
    else
        rtcIntersect1M(scene, context, (struct RTCRayHit *)packets, count, sizeof(struct RTCRayHit));
#else
    (void)scene, (void)context, (void)packets, (void)count, (void)any;
#endif
}

#endif
