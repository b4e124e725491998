/* SPDX-License-Identifier: Apache-2.0 */
/* The kernels of `wide`, included once for each instruction set by a file that has named its table of them,
 * RT_WIDE_KERNELS.
 *
 * Rays are taken as packets of sixteen while they go the same way and that pays; all others are streams.
 * Which pays better is found out as it goes: a block of rays is traced in one way, the next in the other, and
 * by what their visits cost the way for the next ones is chosen. Counted kernels trace no packets: a count
 * belongs to one ray. */
#include "accel/wide/packet.h"
#include "accel/wide/stream.h"

/* The scratch memory of a query. */
typedef struct Scratch {
    Flight flights[RT_WIDE_MAX_IN_FLIGHT];
    Packet packet;
} Scratch;

static size_t scratch_bytes(const RtAccel *accel) {
    (void)accel;
    return sizeof(Scratch);
}

/* Traces rays[first..first + count) of a question, and gives the visits of nodes and leaves. */
typedef uint32_t Way(const Question *q, size_t first, size_t count);

/* As packets, where they go the same way; *together: so many did. The others by `stream`. Gives the visits of
 * packets. */
RT_KERNEL uint32_t trace_packets(const Question *q, size_t first, size_t count, size_t *together, bool any,
                                 Way *stream) {
    Packet *p = &((Scratch *)q->scratch->own)->packet;
    size_t end = first + count, streamed = first, packed = 0;
    p->visits = 0;
    for (size_t i = first; i + PACKET <= end; i += PACKET) {
        if (!take_off_together(p, q->tree, q->geometry, q->rays + i)) continue;
        if (streamed < i) stream(q, streamed, i - streamed);
        fly_together(q->self, q->tree, p, q->rays + i, any, q->scratch->room);
        for (size_t k = 0; k < PACKET; k++) {
            if (any)
                q->blockers[i + k] = p->best[k].object;
            else
                q->hits[i + k] = p->best[k];
        }
        streamed = i + PACKET;
        packed += PACKET;
    }
    if (streamed < end) stream(q, streamed, end - streamed);
    *together = packed;
    return p->visits;
}

/* The ways as functions of their own, so that each stands in the program once. */
#define DEFINE_WAYS(question, any)                                                                           \
    static __attribute__((noinline))                                                                         \
    uint32_t stream_##question##_timed(const Question *q, size_t first, size_t count) {                      \
        return trace_many(q, first, count, any, false);                                                      \
    }                                                                                                        \
    static __attribute__((noinline))                                                                         \
    uint32_t stream_##question##_counted(const Question *q, size_t first, size_t count) {                    \
        return trace_many(q, first, count, any, true);                                                       \
    }                                                                                                        \
    static __attribute__((noinline))                                                                         \
    uint32_t packets_##question##_timed(const Question *q, size_t first, size_t count, size_t *together) {   \
        return trace_packets(q, first, count, together, any, stream_##question##_timed);                     \
    }
DEFINE_WAYS(nearest, false)
DEFINE_WAYS(occluded, true)

/* Rays that are traced to compare the ways, and rays for which the better one is chosen. */
enum { TRIAL = 4 * PACKET, TERM = 64 * PACKET };

RT_KERNEL size_t at_most(size_t a, size_t b) {
    return a < b ? a : b;
}

RT_KERNEL void trace(const RtWide *self, const RtWideTree *tree, const RtScratch *scratch, const RtRay *rays,
                     size_t count, RtHit *hits, uint32_t *blockers, RtTally *tallies, bool any,
                     bool counted) {
    const Question q = {self, tree, &self->base.scene->geometry, scratch, rays, hits, blockers, tallies};
    Way *stream = any       ? counted ? stream_occluded_counted : stream_occluded_timed
                  : counted ? stream_nearest_counted
                            : stream_nearest_timed;
    if (self->in_flight == 1) {
        trace_singly(&q, 0, count, any, counted);
        return;
    }
    if (counted || !self->packets || tree->node_count == 0 || count < PACKET) {
        stream(&q, 0, count);
        return;
    }
    for (size_t i = 0; i < count;) {
        size_t together, trial = at_most(count - i, TRIAL);
        uint32_t packed = (any ? packets_occluded_timed : packets_nearest_timed)(&q, i, trial, &together),
                 streamed = 0;
        i += trial;
        if (together == TRIAL && count - i >= TRIAL) {
            streamed = stream(&q, i, TRIAL);
            i += TRIAL;
        }
        size_t term = at_most(count - i, TERM);
        if (packed < streamed)
            (any ? packets_occluded_timed : packets_nearest_timed)(&q, i, term, &together);
        else
            stream(&q, i, term);
        i += term;
    }
}

static void nearest_timed(const RtAccel *accel, const RtScratch *scratch, const RtRay *rays, size_t count,
                          RtHit *hits) {
    const RtWide *self = (const RtWide *)accel;
    trace(self, self->nearest, scratch, rays, count, hits, NULL, NULL, false, false);
}

static void nearest_counted(const RtAccel *accel, const RtScratch *scratch, const RtRay *rays, size_t count,
                            RtHit *hits, RtTally *tallies) {
    const RtWide *self = (const RtWide *)accel;
    trace(self, self->nearest, scratch, rays, count, hits, NULL, tallies, false, true);
}

static void occluded_timed(const RtAccel *accel, const RtScratch *scratch, const RtRay *rays, size_t count,
                           uint32_t *blockers) {
    const RtWide *self = (const RtWide *)accel;
    trace(self, self->occluded, scratch, rays, count, NULL, blockers, NULL, true, false);
}

static void occluded_counted(const RtAccel *accel, const RtScratch *scratch, const RtRay *rays, size_t count,
                             uint32_t *blockers, RtTally *tallies) {
    const RtWide *self = (const RtWide *)accel;
    trace(self, self->occluded, scratch, rays, count, NULL, blockers, tallies, true, true);
}

const RtWideKernels RT_WIDE_KERNELS = {nearest_timed, occluded_timed, nearest_counted, occluded_counted,
                                       scratch_bytes};
