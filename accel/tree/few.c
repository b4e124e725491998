/* SPDX-License-Identifier: Apache-2.0 */
#include "accel/tree/few.h"

/* The place of each in ascending order of `at`, equal ones by number: how many come before it. Without a
 * branch, four at a time; at[count..) up to a multiple of 4 may hold anything. */
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

void rt_few_init(RtFew *self, const RtTreeRef *refs, uint32_t count) {
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

/* A bin for each centre, in order along an axis; gives their number. */
static uint32_t fill_bins(const RtFew *self, int axis, uint32_t begin, uint32_t count, RtBin *bins) {
    const uint8_t *order = self->order[axis] + begin;
    const float *at = self->at[axis];
    uint32_t size = 0;
    for (uint32_t i = 0; i < count; i++) {
        RtBox4 box = rt_box4_load(&self->refs[order[i]].box);
        if (i > 0 && at[order[i]] == at[order[i - 1]])
            rt_bin_add(&bins[size - 1], box, 1);
        else
            bins[size++] = (RtBin){box, 1};
    }
    return size;
}

/* Two are parted at the same cost along all axes. */
static RtSplit split_two(const RtFew *self, uint32_t begin) {
    uint32_t a = self->order[0][begin], b = self->order[0][begin + 1];
    RtDouble2 areas = rt_box4_half_areas(rt_box4_load(&self->refs[a].box), rt_box4_load(&self->refs[b].box));
    int axis = 0;
    while (axis < 3 && self->at[axis][a] == self->at[axis][b]) axis++;
    return (RtSplit){axis < 3 ? areas[0] + areas[1] : INFINITY, axis, 1, 1};
}

RtSplit rt_few_split(const RtFew *self, uint32_t begin, uint32_t count) {
    RtSplit best = {.cost = INFINITY};
    if (count == 2) return split_two(self, begin);
    for (int axis = 0; axis < 3; axis++) {
        RtBin bins[RT_MAX_BINS];
        uint32_t size = fill_bins(self, axis, begin, count, bins);
        rt_bins_try(bins, size, axis, count, &best);
    }
    return best;
}

void rt_few_part(RtFew *self, uint32_t begin, uint32_t count, const RtSplit *split) {
    uint64_t is_left = 0;
    if (count == 2) { /* of one alone the first order will do */
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
