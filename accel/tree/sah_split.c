/* SPDX-License-Identifier: Apache-2.0 */
#include "accel/tree/sah_split.h"

RtBox4 rt_refs_centers(const RtTreeRef *refs, uint32_t count) {
    RtBox4 centers = rt_box4_empty();
    for (uint32_t i = 0; i < count; i++)
        centers = rt_box4_add_point(centers, rt_box4_center(rt_box4_load(&refs[i].box)));
    return centers;
}

int rt_longest_axis(RtBox4 box) {
    return rt_major_axis((RtVec3){{box.hi[0] - box.lo[0], box.hi[1] - box.lo[1], box.hi[2] - box.lo[2]}});
}

/* ---- bins ---- */

static inline void add_to_bin(RtBin *bin, RtBox4 box, uint32_t number) {
    bin->box = rt_box4_union(bin->box, box);
    bin->number += number;
}

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
            add_to_bin(&self->bins[axis][i], other->bins[axis][i].box, other->bins[axis][i].number);
    }
}

/* The bins of BATCH references are all computed before any is filled, so the addresses of the stores are
 * known early and loads of bins need not wait for them: a third less time. */
enum { BATCH = 16 };

static void add_batch(RtBins *self, const RtTreeRef *refs, uint32_t count) {
    RtFloat4 lo = self->lo, scale = self->scale, last = self->last;
    RtInt4 bin[BATCH];
    for (uint32_t i = 0; i < count; i++) {
        __builtin_prefetch(refs + i + RT_REFS_AHEAD);
        /* max(NaN, 0) is 0, for infinity times 0. */
        RtFloat4 at = rt_max((rt_box4_center(rt_box4_load(&refs[i].box)) - lo) * scale, rt_all4(0));
        bin[i] = rt_to_ints4(rt_min(at, last));
    }
    for (uint32_t i = 0; i < count; i++) {
        RtBox4 box = rt_box4_load(&refs[i].box);
        for (int axis = 0; axis < 3; axis++) add_to_bin(&self->bins[axis][(uint32_t)bin[i][axis]], box, 1);
    }
}

void rt_bins_add(RtBins *self, const RtTreeRef *refs, uint32_t count) {
    for (; count > BATCH; refs += BATCH, count -= BATCH) add_batch(self, refs, BATCH);
    add_batch(self, refs, count);
}

/* Improves *best by the splits between the bins of one axis, which hold `count` references in all. */
static void try_bins(const RtBin *bins, uint32_t size, int axis, uint32_t count, RtSplit *best) {
    RtBox4 right[RT_MAX_BINS], box = rt_box4_empty();
    for (uint32_t i = size; i-- > 1;) right[i] = box = rt_box4_union(box, bins[i].box);
    box = bins[0].box;
    uint32_t left = bins[0].number, least_left = 0, least_bin = 0;
    double least = best->cost;
    for (uint32_t i = 1; i < size; i++) {
        RtDouble2 costs = rt_box4_half_areas(box, right[i]) * (RtDouble2){left, count - left};
        double cost = costs[0] + costs[1];
        bool better = (cost < least) & (left > 0) & (left < count); /* unpredictable */
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
    for (int axis = 0; axis < 3; axis++) try_bins(self->bins[axis], self->size[axis], axis, count, &best);
    return best;
}

/* ---- small groups ---- */

/* Sorts indices by `at`, then by index, by counting for each how many come before it: branchless, four at a
 * time; at[count..) up to a multiple of 4 may hold anything. */
static void sort_axis(const float *at, uint32_t count, uint8_t *order) {
    for (uint32_t i = 0; i < count; i += 4) {
        RtFloat4 self;
        RtInt4 before = {0, 0, 0, 0};
        memcpy(&self, at + i, sizeof self);
        for (uint32_t j = 0; j < i; j++) before -= rt_all4(at[j]) <= self;
        for (uint32_t j = i; j < count; j++) before -= rt_all4(at[j]) < self;
        for (uint32_t s = 0; s < 4 && i + s < count; s++) {
            uint32_t place = (uint32_t)before[s];
            for (uint32_t j = i; j < i + s; j++) place += at[j] == at[i + s];
            order[place] = (uint8_t)(i + s);
        }
    }
}

void rt_small_group_init(RtSmallGroup *self, const RtTreeRef *refs, uint32_t count) {
    self->refs = refs;
    for (uint32_t i = 0; i < count; i++) {
        RtFloat4 center = rt_box4_center(rt_box4_load(&refs[i].box));
        for (int axis = 0; axis < 3; axis++) self->at[axis][i] = center[axis];
    }
    for (uint32_t i = count; i % 4 != 0; i++) {
        for (int axis = 0; axis < 3; axis++) self->at[axis][i] = 0;
    }
    for (int axis = 0; axis < 3; axis++) sort_axis(self->at[axis], count, self->order[axis]);
}

/* One bin for each distinct centre, in order along an axis; returns their number. */
static uint32_t fill_bins(const RtSmallGroup *self, int axis, uint32_t begin, uint32_t count, RtBin *bins) {
    const uint8_t *order = self->order[axis] + begin;
    const float *at = self->at[axis];
    uint32_t size = 0;
    for (uint32_t i = 0; i < count; i++) {
        RtBox4 box = rt_box4_load(&self->refs[order[i]].box);
        if (i > 0 && at[order[i]] == at[order[i - 1]])
            add_to_bin(&bins[size - 1], box, 1);
        else
            bins[size++] = (RtBin){box, 1};
    }
    return size;
}

/* Two references cost the same along all axes. */
static RtSplit split_two(const RtSmallGroup *self, uint32_t begin) {
    uint32_t a = self->order[0][begin], b = self->order[0][begin + 1];
    RtDouble2 areas = rt_box4_half_areas(rt_box4_load(&self->refs[a].box), rt_box4_load(&self->refs[b].box));
    int axis = 0;
    while (axis < 3 && self->at[axis][a] == self->at[axis][b]) axis++;
    return (RtSplit){axis < 3 ? areas[0] + areas[1] : INFINITY, axis, 1, 1};
}

RtSplit rt_small_group_split(const RtSmallGroup *self, uint32_t begin, uint32_t count) {
    RtSplit best = {.cost = INFINITY};
    if (count == 2) return split_two(self, begin);
    for (int axis = 0; axis < 3; axis++) {
        RtBin bins[RT_MAX_BINS];
        uint32_t size = fill_bins(self, axis, begin, count, bins);
        try_bins(bins, size, axis, count, &best);
    }
    return best;
}

void rt_small_group_partition(RtSmallGroup *self, uint32_t begin, uint32_t count, const RtSplit *split) {
    uint64_t is_left = 0;
    if (count == 2) { /* each side is one reference: the first order suffices */
        memcpy(self->order[0] + begin, self->order[split->axis] + begin, 2);
        return;
    }
    for (uint32_t i = 0; i < split->left; i++) is_left |= UINT64_C(1) << self->order[split->axis][begin + i];
    for (int axis = 0; axis < 3; axis++) {
        uint8_t *order = self->order[axis] + begin, right[RT_MAX_BINS];
        uint32_t left = 0;
        for (uint32_t i = 0; i < count; i++) {
            uint8_t ref = order[i];
            right[i - left] = ref;
            order[left] = ref;
            left += (uint32_t)(is_left >> ref & 1);
        }
        memcpy(order + left, right, count - left);
    }
}

/* ---- whole groups ---- */

static uint32_t split_small(RtTreeRef *refs, uint32_t count, RtBox4 centers_of[2]) {
    RtTreeRef kept[RT_MAX_BINS];
    RtSmallGroup group;
    rt_small_group_init(&group, refs, count);
    RtSplit split = rt_small_group_split(&group, 0, count);
    if (!(split.cost < INFINITY)) return 0;
    for (uint32_t i = 0; i < count; i++) kept[i] = refs[group.order[split.axis][i]];
    memcpy(refs, kept, count * sizeof(RtTreeRef));
    centers_of[0] = rt_refs_centers(refs, split.left);
    centers_of[1] = rt_refs_centers(refs + split.left, count - split.left);
    return split.left;
}

uint32_t rt_split_binned(RtTreeRef *refs, uint32_t count, int bins, RtBox4 centers, RtBox4 centers_of[2]) {
    const uint32_t own_bins = rt_bin_count(bins, count);
    if (count <= own_bins) return split_small(refs, count, centers_of);
    RtBins b;
    rt_bins_init(&b, own_bins, centers);
    rt_bins_add(&b, refs, count);
    RtSplit split = rt_bins_split(&b, count);
    if (!(split.cost < INFINITY)) return 0;
    RtSide side = rt_bins_side(&b, &split);
    uint32_t left = 0;
    RtBox4 sides[2] = {rt_box4_empty(), rt_box4_empty()};
    for (uint32_t i = 0; i < count; i++) {
        __builtin_prefetch(refs + i + RT_REFS_AHEAD);
        /* refs[left..i) are right: swap the first of them with this one, whichever side this is on. */
        RtFloat4 center = rt_box4_center(rt_box4_load(&refs[i].box));
        RtTreeRef ref = refs[i];
        uint32_t right = rt_side_of(&side, center);
        sides[right] = rt_box4_add_point(sides[right], center);
        refs[i] = refs[left];
        refs[left] = ref;
        left += 1 - right;
    }
    memcpy(centers_of, sides, sizeof sides);
    return left;
}

static bool comes_before(const RtTreeRef *a, const RtTreeRef *b, int axis) {
    float x = rt_box_center(a->box).at[axis], y = rt_box_center(b->box).at[axis];
    return x < y || (x == y && a->id < b->id);
}

/* Quickselect (Hoare 1961): narrows the range that contains the boundary between the halves. */
uint32_t rt_split_median(RtTreeRef *refs, uint32_t count) {
    int axis = rt_longest_axis(rt_refs_centers(refs, count));
    uint32_t half = (count + 1) / 2, first = 0, last = count - 1;
    while (first < half && half <= last) {
        RtTreeRef pivot = refs[first + (last - first) / 2];
        uint32_t i = first, j = last;
        for (;; i++, j--) {
            while (comes_before(&refs[i], &pivot, axis)) i++;
            while (comes_before(&pivot, &refs[j], axis)) j--;
            if (i >= j) break;
            RtTreeRef kept = refs[i];
            refs[i] = refs[j];
            refs[j] = kept;
        }
        /* refs[..j] do not come after the pivot, refs[j + 1..] not before it. */
        if (half <= j)
            last = j;
        else
            first = j + 1;
    }
    return half;
}
