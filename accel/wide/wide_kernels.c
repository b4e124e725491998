/* SPDX-License-Identifier: Apache-2.0 */
/* The kernels of `wide`, compiled once for each instruction set (accel/isa.h).
 *
 * Rays are traced in packets while the rays of a packet share enough of their visits, else one by one in
 * streams. The sharing is estimated from the packets traced last, and packets are tried again from time to
 * time. Counted kernels trace no packets, because a count belongs to one ray. */
#include "accel/wide/packet_trace.h"

/* What is known of the rays of a kind. */
typedef struct RateEstimate {
    float sharing;  /* rays per visit of a node, a moving average; 0: no packets traced yet */
    bool alone;     /* packets did not pay */
    uint64_t retry; /* rays until packets are tried again */
    uint32_t pause; /* of the filter (RaySource) */
} RateEstimate;

/* The scratch memory of a query. */
typedef struct Scratch {
    RayState states[RT_WIDE_MAX_IN_FLIGHT];
    Packet packets[RT_WIDE_MAX_PACKETS];
    Sorter sorter;
    RaySource source;
    RateEstimate estimates[RT_RAY_KIND_COUNT];
} Scratch;

enum {
    WINDOW = 4096,      /* rays that are sorted together */
    RETRY = 256 * 1024, /* rays traced alone before packets are tried again */
};

/* Each is compiled once, not inlined into its callers. */
#define DEFINE_STREAMS(question, any)                                                                        \
    static __attribute__((noinline)) void stream_##question##_timed(const Query *q) {                        \
        trace_many(q, any, false);                                                                           \
    }                                                                                                        \
    static __attribute__((noinline)) void stream_##question##_counted(const Query *q) {                      \
        trace_many(q, any, true);                                                                            \
    }                                                                                                        \
    static __attribute__((noinline)) Shared packets_##question##_timed(const Query *q) {                     \
        Scratch *own = q->scratch->own;                                                                      \
        return trace_packets(q, own->packets, &own->sorter, WINDOW, any);                                    \
    }
DEFINE_STREAMS(nearest, false)
DEFINE_STREAMS(occluded, true)

/* Factors on the parameter `sharing`. Streams for any hit need no distances, so packets pay later. Without
 * AVX2 a gather loads word by word, so packets pay only for nearest hits of rays that share much. */
#if defined(__AVX2__)
#define WORTH_NEAREST 1.0f
#define WORTH_ANY     1.2f
#else
#define WORTH_NEAREST 1.6f
#define WORTH_ANY     13.0f
#endif

/* Traces packets while they pay; `count`: rays of the query. */
RT_KERNEL void trace_as_packets(const Query *q, RateEstimate *estimate, size_t count, bool any) {
    const float worth = q->self->sharing * (any ? WORTH_ANY : WORTH_NEAREST);
    if (estimate->alone && estimate->retry > count) {
        estimate->retry -= count;
        return;
    }
    /* Packets begin with an estimate that one poor window does not end. */
    if (estimate->alone || estimate->sharing == 0) estimate->sharing = 1.5f * worth;
    estimate->alone = false;
    while (!estimate->alone && more_rays(q)) {
        Shared shared = any ? packets_occluded_timed(q) : packets_nearest_timed(q);
        float sharing = (float)shared.rays / (float)(shared.visits + 1);
        estimate->sharing += 0.25f * (sharing - estimate->sharing);
        estimate->alone = estimate->sharing < worth;
        estimate->retry = RETRY;
    }
}

RT_KERNEL void trace(const RtAccel *accel, const RtScratch *scratch, const RtRay *rays, size_t count,
                     RtHit *hits, uint32_t *occluders, RtTally *tallies, bool any, bool counted) {
    const RtWide *self = (const RtWide *)accel;
    const RtWideTree *tree = any ? self->occluded : &self->trees[0];
    Scratch *own = scratch->own;
    const Query q = {self,    tree,        &accel->scene->geometry, scratch, rays, hits, occluders,
                     tallies, &own->source};
    if (self->in_flight == 1) {
        trace_one_by_one(&q, count, any, counted);
        return;
    }
    RateEstimate *estimate = &own->estimates[count > 0 ? rays[0].kind : 0];
    const bool filtered = !counted && tree->node_count > 0;
    own->source.next = own->source.taken = own->source.count = 0;
    own->source.end = count;
    own->source.pause = filtered ? &estimate->pause : NULL;
    if (filtered && self->packets > 0 && count >= PACKET) trace_as_packets(&q, estimate, count, any);
    if (any)
        (counted ? stream_occluded_counted : stream_occluded_timed)(&q);
    else
        (counted ? stream_nearest_counted : stream_nearest_timed)(&q);
}

RT_DEFINE_STREAM_KERNELS(trace)
RT_DEFINE_KERNEL_TABLE(wide, sizeof(Scratch));
