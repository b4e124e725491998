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

typedef struct Split {
    double cost; /* sum over both sides of half area x number */
    int axis, bin, bins;
    float lo, scale; /* bin of a centre c: (c - lo) * scale */
} Split;

static int bin_of(const RtBox *box, int axis, float lo, float scale, int bins) {
    int bin = (int)((rt_box_center(*box).at[axis] - lo) * scale);
    return bin < 0 ? 0 : bin >= bins ? bins - 1 : bin;
}

/* Improves `best` by the best split of refs[0..count) along `axis`, whose centres lie in [lo, hi]. */
static void try_axis(const RtTreeRef *refs, uint32_t count, int axis, float lo, float hi, Split *best) {
    Bin bins[RT_MAX_BINS];
    int bin_count = best->bins;
    float scale = (float)bin_count / (hi - lo);
    if (!(hi > lo) || !isfinite(scale)) return;
    for (int i = 0; i < bin_count; i++) bins[i] = (Bin){RT_EMPTY_BOX, 0};
    for (uint32_t i = 0; i < count; i++) {
        Bin *bin = &bins[bin_of(&refs[i].box, axis, lo, scale, bin_count)];
        bin->box = rt_box_union(bin->box, refs[i].box);
        bin->count++;
    }
    /* Costs of all right sides in one sweep, then left sides against them. */
    double right_cost[RT_MAX_BINS];
    RtBox box = RT_EMPTY_BOX;
    uint32_t n = 0;
    for (int i = bin_count - 1; i > 0; i--) {
        box = rt_box_union(box, bins[i].box);
        n += bins[i].count;
        right_cost[i] = rt_box_half_area(box) * n;
    }
    box = RT_EMPTY_BOX;
    n = 0;
    for (int i = 1; i < bin_count; i++) {
        box = rt_box_union(box, bins[i - 1].box);
        n += bins[i - 1].count;
        double cost = rt_box_half_area(box) * n + right_cost[i];
        if (n == 0 || n == count || !(cost < best->cost)) continue;
        *best = (Split){cost, axis, i, bin_count, lo, scale};
    }
}

uint32_t rt_split_binned(RtTreeRef *refs, uint32_t count, int bins) {
    Split best = {.cost = INFINITY, .bins = bins};
    RtBox centers = rt_refs_centers(refs, count);
    for (int axis = 0; axis < 3; axis++) {
        try_axis(refs, count, axis, centers.lo.at[axis], centers.hi.at[axis], &best);
    }
    uint32_t left = 0;
    for (uint32_t i = 0; best.cost < INFINITY && i < count; i++) {
        RtTreeRef ref = refs[i];
        if (bin_of(&ref.box, best.axis, best.lo, best.scale, best.bins) >= best.bin) continue;
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
