/* SPDX-License-Identifier: Apache-2.0 */
#include "accel/tree/split.h"

#include "accel/tree/few.h"

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

/* Few references: each gets a bin of its own, as it were. */
static uint32_t split_few(RtTreeRef *refs, uint32_t count, RtBox4 centers_of[2]) {
    RtTreeRef kept[RT_MAX_BINS];
    RtFew few;
    rt_few_init(&few, refs, count);
    RtSplit split = rt_few_split(&few, 0, count);
    if (!(split.cost < INFINITY)) return 0;
    for (uint32_t i = 0; i < count; i++) kept[i] = refs[few.order[split.axis][i]];
    memcpy(refs, kept, count * sizeof(RtTreeRef));
    centers_of[0] = rt_refs_centers(refs, split.left);
    centers_of[1] = rt_refs_centers(refs + split.left, count - split.left);
    return split.left;
}

uint32_t rt_split_binned(RtTreeRef *refs, uint32_t count, int bins, RtBox4 centers, RtBox4 centers_of[2]) {
    if (count <= (uint32_t)bins) return split_few(refs, count, centers_of);
    RtBins b;
    rt_bins_init(&b, (uint32_t)bins, centers);
    rt_bins_add(&b, refs, count);
    RtSplit split = rt_bins_split(&b, count);
    if (!(split.cost < INFINITY)) return 0;
    RtSide side = rt_bins_side(&b, &split);
    uint32_t left = 0;
    RtBox4 sides[2] = {rt_box4_empty(), rt_box4_empty()};
    for (uint32_t i = 0; i < count; i++) {
        __builtin_prefetch(refs + i + RT_REFS_AHEAD);
        /* refs[left..i) are right: the first of them and this change places, whichever side this is on. */
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

/* ---- halves ---- */

static bool comes_before(const RtTreeRef *a, const RtTreeRef *b, int axis) {
    float x = rt_box_center(a->box).at[axis], y = rt_box_center(b->box).at[axis];
    return x < y || (x == y && a->id < b->id);
}

/* Quickselect (Hoare 1961): narrows the range that holds the border between the halves. */
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
        /* Up to j none comes after the pivot, from j + 1 on none before it. */
        if (half <= j)
            last = j;
        else
            first = j + 1;
    }
    return half;
}
