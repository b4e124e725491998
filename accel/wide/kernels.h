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

/* Rays that are traced to compare the ways, and rays for which the better one is chosen. */
enum { TRIAL = 4 * PACKET, TERM = 64 * PACKET };

/* What is left of a stream, and what has been found out. */
typedef struct Course {
    const RtWide *self;
    const RtWideTree *tree;
    const RtScratch *scratch;
    const RtRay *rays;
    Answers to;
} Course;

RT_KERNEL uint64_t fly_as_stream(const Course *c, size_t first, size_t count) {
    if (count == 0) return 0;
    return trace_many(c->self, c->tree, c->scratch, c->rays + first, count, answers_from(c->to, first));
}

/* As packets, as far as they go the same way; gives the visits. *together: rays in packets. */
RT_KERNEL uint64_t fly_as_packets(const Course *c, size_t first, size_t count, size_t *together) {
    Packet *p = &((Scratch *)c->scratch->own)->packet;
    const RtGeometry *g = &c->self->base.scene->geometry;
    size_t end = first + count, streamed = first;
    *together = 0;
    p->visits = 0;
    uint64_t visits = 0;
    for (size_t i = first; i + PACKET <= end; i += PACKET) {
        if (!take_off_together(p, c->tree, g, c->rays + i)) continue;
        visits += fly_as_stream(c, streamed, i - streamed);
        fly_together(c->self, c->tree, p, c->rays + i, !c->to.hits, c->scratch->room);
        for (size_t k = 0; k < PACKET; k++) {
            if (c->to.hits)
                c->to.hits[i + k] = p->best[k];
            else
                c->to.blockers[i + k] = p->best[k].object;
        }
        streamed = i + PACKET;
        *together += PACKET;
    }
    return visits + p->visits + fly_as_stream(c, streamed, end - streamed);
}

RT_KERNEL void trace(const RtWide *self, const RtWideTree *tree, const RtScratch *scratch, const RtRay *rays,
                     size_t count, Answers to) {
    const Course c = {self, tree, scratch, rays, to};
    if (self->in_flight == 1) {
        trace_singly(self, tree, scratch, rays, count, to);
        return;
    }
    if (!self->packets || to.tallies || tree->node_count == 0 || count < PACKET) {
        fly_as_stream(&c, 0, count);
        return;
    }
    for (size_t i = 0; i < count;) {
        size_t together, left = count - i, trial = left < TRIAL ? left : TRIAL;
        uint64_t packed = fly_as_packets(&c, i, trial, &together), streamed = 0;
        i += trial;
        left -= trial;
        if (together == trial && left >= TRIAL) {
            streamed = fly_as_stream(&c, i, TRIAL);
            i += TRIAL;
            left -= TRIAL;
        }
        size_t term = left < TERM ? left : TERM;
        if (together == trial && packed < streamed)
            fly_as_packets(&c, i, term, &together);
        else
            fly_as_stream(&c, i, term);
        i += term;
    }
}

static void nearest_timed(const RtAccel *accel, const RtScratch *scratch, const RtRay *rays, size_t count,
                          RtHit *hits) {
    const RtWide *self = (const RtWide *)accel;
    trace(self, self->nearest, scratch, rays, count, (Answers){hits, NULL, NULL});
}

static void nearest_counted(const RtAccel *accel, const RtScratch *scratch, const RtRay *rays, size_t count,
                            RtHit *hits, RtTally *tallies) {
    const RtWide *self = (const RtWide *)accel;
    trace(self, self->nearest, scratch, rays, count, (Answers){hits, NULL, tallies});
}

static void occluded_timed(const RtAccel *accel, const RtScratch *scratch, const RtRay *rays, size_t count,
                           uint32_t *blockers) {
    const RtWide *self = (const RtWide *)accel;
    trace(self, self->occluded, scratch, rays, count, (Answers){NULL, blockers, NULL});
}

static void occluded_counted(const RtAccel *accel, const RtScratch *scratch, const RtRay *rays, size_t count,
                             uint32_t *blockers, RtTally *tallies) {
    const RtWide *self = (const RtWide *)accel;
    trace(self, self->occluded, scratch, rays, count, (Answers){NULL, blockers, tallies});
}

const RtWideKernels RT_WIDE_KERNELS = {nearest_timed, occluded_timed, nearest_counted, occluded_counted,
                                       scratch_bytes};
