/* SPDX-License-Identifier: Apache-2.0 */
/* The kernels of `wide`, compiled once for each instruction set (accel/isa.h).
 *
 * Rays are traced in packets while the rays of a packet share enough of their visits, else one by one in
 * streams. The sharing is estimated from the packets traced last, and packets are tried again from time to
 * time. Counted kernels trace no packets, because a count belongs to one ray. */
#include "accel/wide/packet_trace.h"

/* The sharing of visits by rays of a kind. */
typedef struct RateEstimate {
    float sharing;  /* rays per visit of a node, a moving average; 0: no packets traced yet */
    bool alone;     /* packets did not pay */
    uint64_t trial; /* rays until packets are tried again */
} RateEstimate;

/* The scratch memory of a query. */
typedef struct Scratch {
    RayState states[RT_WIDE_MAX_IN_FLIGHT];
    Packet packets[RT_WIDE_MAX_PACKETS];
    Sorter sorter;
    RateEstimate estimates[RT_RAY_KIND_COUNT];
} Scratch;

/* Each is compiled once, not inlined into its callers. */
#define DEFINE_STREAMS(question, any)                                                                        \
    static __attribute__((noinline)) void stream_##question##_timed(const Query *q, size_t first,            \
                                                                    size_t count) {                          \
        trace_many(q, first, count, any, false);                                                             \
    }                                                                                                        \
    static __attribute__((noinline)) void stream_##question##_counted(const Query *q, size_t first,          \
                                                                      size_t count) {                        \
        trace_many(q, first, count, any, true);                                                              \
    }                                                                                                        \
    static __attribute__((noinline))                                                                         \
    Shared packets_##question##_timed(const Query *q, size_t first, size_t count) {                          \
        Scratch *own = q->scratch->own;                                                                      \
        return trace_packets(q, own->packets, &own->sorter, first, count, any);                              \
    }
DEFINE_STREAMS(nearest, false)
DEFINE_STREAMS(occluded, true)

enum {
    WINDOW = 4096,      /* rays that are sorted together */
    TRIAL = 256 * 1024, /* rays traced alone between two trials of packets */
};

/* Factors on the parameter `sharing`. Streams for any hit need no distances, so packets pay later. Without
 * AVX2 a gather loads word by word, so packets pay only for nearest hits of rays that share much. */
#if defined(__AVX2__)
#define WORTH_NEAREST 1.0f
#define WORTH_ANY     1.2f
#else
#define WORTH_NEAREST 1.6f
#define WORTH_ANY     13.0f
#endif

/* Traces packets while they pay; returns the number of rays traced. */
RT_KERNEL size_t trace_as_packets(const Query *q, size_t count, bool any) {
    RateEstimate *estimate = &((Scratch *)q->scratch->own)->estimates[q->rays[0].kind];
    const float worth = q->self->sharing * (any ? WORTH_ANY : WORTH_NEAREST);
    size_t i = 0;
    if (estimate->alone && estimate->trial > count) {
        estimate->trial -= count;
        return 0;
    }
    /* A trial starts with an estimate that one poor window does not end. */
    if (estimate->alone || estimate->sharing == 0) estimate->sharing = 1.5f * worth;
    estimate->alone = false;
    while (i < count && !estimate->alone) {
        size_t some = count - i < WINDOW ? count - i : WINDOW;
        Shared shared = any ? packets_occluded_timed(q, i, some) : packets_nearest_timed(q, i, some);
        float sharing = (float)shared.rays / (float)(shared.visits + 1);
        estimate->sharing += 0.25f * (sharing - estimate->sharing);
        estimate->alone = estimate->sharing < worth;
        estimate->trial = TRIAL;
        i += some;
    }
    return i;
}

RT_KERNEL void trace(const RtAccel *accel, const RtScratch *scratch, const RtRay *rays, size_t count,
                     RtHit *hits, uint32_t *occluders, RtTally *tallies, bool any, bool counted) {
    const RtWide *self = (const RtWide *)accel;
    const RtWideTree *tree = any ? self->occluded : self->nearest;
    const Query q = {self, tree, &accel->scene->geometry, scratch, rays, hits, occluders, tallies};
    size_t done = 0;
    if (self->in_flight == 1) {
        trace_one_by_one(&q, 0, count, any, counted);
        return;
    }
    if (!counted && self->packets > 0 && tree->node_count > 0 && count >= PACKET)
        done = trace_as_packets(&q, count, any);
    if (done == count) return;
    if (any)
        (counted ? stream_occluded_counted : stream_occluded_timed)(&q, done, count - done);
    else
        (counted ? stream_nearest_counted : stream_nearest_timed)(&q, done, count - done);
}

RT_DEFINE_STREAM_KERNELS(trace)
RT_DEFINE_KERNEL_TABLE(wide, sizeof(Scratch));
