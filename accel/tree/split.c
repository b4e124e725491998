/* SPDX-License-Identifier: Apache-2.0 */
#include "accel/tree/split.h"

#include "base/memory.h"

RtTreeRef *rt_refs_new(const RtBox *boxes, uint32_t count) {
    RtTreeRef *refs = rt_alloc(count, sizeof(RtTreeRef));
    for (uint32_t i = 0; refs && i < count; i++) refs[i] = (RtTreeRef){boxes[i], i};
    return refs;
}

RtBox rt_refs_centers(const RtTreeRef *refs, uint32_t count) {
    RtBox centers = RT_EMPTY_BOX;
    for (uint32_t i = 0; i < count; i++) centers = rt_box_add_point(centers, rt_box_center(refs[i].box));
    return centers;
}

/* ---- bins ---- */

typedef struct Bin {
    RtBox box;
    uint32_t count;
} Bin;

/* Equal bins along each axis, between the outermost centres. */
typedef struct Bins {
    int count;
    float lo[3], scale[3]; /* bin of a centre c: (c - lo) * scale; scale 0: the axis cannot be divided */
    Bin bins[3][RT_MAX_BINS];
} Bins;

typedef struct Split {
    double cost; /* sum over both sides of half area x number */
    int axis, bin;
} Split;

static int bin_of(const Bins *b, RtVec3 center, int axis) {
    if (!(b->scale[axis] > 0)) return 0;
    int bin = (int)((center.at[axis] - b->lo[axis]) * b->scale[axis]);
    return bin < 0 ? 0 : bin >= b->count ? b->count - 1 : bin;
}

static void fill_bins(Bins *b, const RtTreeRef *refs, uint32_t count) {
    RtBox centers = rt_refs_centers(refs, count);
    for (int axis = 0; axis < 3; axis++) {
        float lo = centers.lo.at[axis], hi = centers.hi.at[axis], scale = (float)b->count / (hi - lo);
        b->lo[axis] = lo;
        b->scale[axis] = hi > lo && isfinite(scale) ? scale : 0;
        for (int i = 0; i < b->count; i++) b->bins[axis][i] = (Bin){RT_EMPTY_BOX, 0};
    }
    for (uint32_t i = 0; i < count; i++) {
        RtVec3 center = rt_box_center(refs[i].box);
        for (int axis = 0; axis < 3; axis++) {
            Bin *bin = &b->bins[axis][bin_of(b, center, axis)];
            bin->box = rt_box_union(bin->box, refs[i].box);
            bin->count++;
        }
    }
}

/* Improves `best` by the best split of `count` references between the bins of an axis. */
static void try_axis(const Bins *b, int axis, uint32_t count, Split *best) {
    const Bin *bins = b->bins[axis];
    /* Costs of all right sides in one sweep, then left sides against them. */
    double right_cost[RT_MAX_BINS];
    RtBox box = RT_EMPTY_BOX;
    uint32_t n = 0;
    for (int i = b->count - 1; i > 0; i--) {
        box = rt_box_union(box, bins[i].box);
        n += bins[i].count;
        right_cost[i] = rt_box_half_area(box) * n;
    }
    box = RT_EMPTY_BOX;
    n = 0;
    for (int i = 1; i < b->count; i++) {
        box = rt_box_union(box, bins[i - 1].box);
        n += bins[i - 1].count;
        double cost = rt_box_half_area(box) * n + right_cost[i];
        if (n == 0 || n == count || !(cost < best->cost)) continue;
        *best = (Split){cost, axis, i};
    }
}

/* A centre along an axis. */
typedef struct Mark {
    float at;
    uint32_t ref;
} Mark;

/* marks[0..count): the centres of refs along `axis`, in ascending order. */
static void mark_axis(const RtTreeRef *refs, uint32_t count, int axis, Mark *marks) {
    for (uint32_t i = 0; i < count; i++) {
        Mark mark = {rt_box_center(refs[i].box).at[axis], i};
        uint32_t place = i;
        for (; place > 0 && marks[place - 1].at > mark.at; place--) marks[place] = marks[place - 1];
        marks[place] = mark;
    }
}

/* Few references: each gets a bin of its own, as it were. */
static uint32_t split_few(RtTreeRef *refs, uint32_t count) {
    Mark marks[RT_MAX_BINS] = {{0, 0}};
    RtTreeRef kept[RT_MAX_BINS];
    double right_cost[RT_MAX_BINS], least = INFINITY;
    uint32_t left = 0;
    for (int axis = 0; axis < 3; axis++) {
        mark_axis(refs, count, axis, marks);
        RtBox box = RT_EMPTY_BOX;
        for (uint32_t i = count - 1; i > 0; i--) {
            box = rt_box_union(box, refs[marks[i].ref].box);
            right_cost[i] = rt_box_half_area(box) * (count - i);
        }
        box = RT_EMPTY_BOX;
        bool better = false;
        for (uint32_t i = 1; i < count; i++) {
            box = rt_box_union(box, refs[marks[i - 1].ref].box);
            double cost = rt_box_half_area(box) * i + right_cost[i];
            if (marks[i - 1].at == marks[i].at || !(cost < least)) continue;
            least = cost;
            left = i;
            better = true;
        }
        for (uint32_t i = 0; better && i < count; i++) kept[i] = refs[marks[i].ref];
    }
    for (uint32_t i = 0; left > 0 && i < count; i++) refs[i] = kept[i];
    return left;
}

uint32_t rt_split_binned(RtTreeRef *refs, uint32_t count, int bins) {
    if (count <= (uint32_t)bins) return split_few(refs, count);
    Bins b;
    b.count = bins;
    Split best = {.cost = INFINITY};
    fill_bins(&b, refs, count);
    for (int axis = 0; axis < 3; axis++) try_axis(&b, axis, count, &best);
    uint32_t left = 0;
    for (uint32_t i = 0; best.cost < INFINITY && i < count; i++) {
        RtTreeRef ref = refs[i];
        if (bin_of(&b, rt_box_center(ref.box), best.axis) >= best.bin) continue;
        refs[i] = refs[left];
        refs[left++] = ref;
    }
    return left;
}

/* ---- halves ---- */

static bool comes_before(const RtTreeRef *a, const RtTreeRef *b, int axis) {
    float x = rt_box_center(a->box).at[axis], y = rt_box_center(b->box).at[axis];
    return x < y || (x == y && a->id < b->id);
}

/* Quickselect (Hoare 1961): narrows the range that holds the border between the halves. */
uint32_t rt_split_median(RtTreeRef *refs, uint32_t count) {
    int axis = rt_major_axis(rt_box_size(rt_refs_centers(refs, count)));
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
