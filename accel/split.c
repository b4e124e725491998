#include "accel/split.h"

typedef struct Bin {
    RtBox box;
    uint32_t count;
} Bin;

static int bin_of(const RtBox *box, int axis, float lo, float scale, int bins) {
    int bin = (int)((rt_box_center(*box).at[axis] - lo) * scale);
    return bin < 0 ? 0 : bin >= bins ? bins - 1 : bin;
}

/* Improves `best` by the best split of ids[0..count) along `axis`, whose centres lie in [lo, hi]. */
static void try_axis(const RtBox *boxes, const uint32_t *ids, uint32_t count, int axis, float lo, float hi,
                     RtSplit *best) {
    Bin bins[RT_MAX_BINS];
    int bin_count = best->bins;
    float scale = (float)bin_count / (hi - lo);
    if (!(hi > lo) || !isfinite(scale)) return;
    for (int i = 0; i < bin_count; i++) bins[i] = (Bin){RT_EMPTY_BOX, 0};
    for (uint32_t i = 0; i < count; i++) {
        Bin *bin = &bins[bin_of(&boxes[ids[i]], axis, lo, scale, bin_count)];
        bin->box = rt_box_union(bin->box, boxes[ids[i]]);
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
        *best = (RtSplit){cost, axis, i, bin_count, lo, scale};
    }
}

static RtBox box_of_centers(const RtBox *boxes, const uint32_t *ids, uint32_t count) {
    RtBox centers = RT_EMPTY_BOX;
    for (uint32_t i = 0; i < count; i++) centers = rt_box_add_point(centers, rt_box_center(boxes[ids[i]]));
    return centers;
}

RtSplit rt_split_find(const RtBox *boxes, const uint32_t *ids, uint32_t count, int bins) {
    RtSplit best = {.cost = INFINITY, .bins = bins};
    RtBox centers = box_of_centers(boxes, ids, count);
    for (int axis = 0; axis < 3; axis++) {
        try_axis(boxes, ids, count, axis, centers.lo.at[axis], centers.hi.at[axis], &best);
    }
    return best;
}

uint32_t rt_split_partition(const RtSplit *split, const RtBox *boxes, uint32_t *ids, uint32_t count) {
    uint32_t left = 0;
    for (uint32_t i = 0; i < count; i++) {
        uint32_t id = ids[i];
        if (bin_of(&boxes[id], split->axis, split->lo, split->scale, split->bins) >= split->bin) continue;
        ids[i] = ids[left];
        ids[left++] = id;
    }
    return left;
}

static bool comes_before(const RtBox *boxes, int axis, uint32_t a, uint32_t b) {
    float x = rt_box_center(boxes[a]).at[axis], y = rt_box_center(boxes[b]).at[axis];
    return x < y || (x == y && a < b);
}

/* Quickselect (Hoare 1961): narrows the range that holds the border between the halves. */
uint32_t rt_split_median(const RtBox *boxes, uint32_t *ids, uint32_t count) {
    int axis = rt_major_axis(rt_box_size(box_of_centers(boxes, ids, count)));
    uint32_t half = (count + 1) / 2, first = 0, last = count - 1;
    while (first < half && half <= last) {
        uint32_t pivot = ids[first + (last - first) / 2], i = first, j = last;
        for (;; i++, j--) {
            while (comes_before(boxes, axis, ids[i], pivot)) i++;
            while (comes_before(boxes, axis, pivot, ids[j])) j--;
            if (i >= j) break;
            uint32_t kept = ids[i];
            ids[i] = ids[j];
            ids[j] = kept;
        }
        /* Up to j none comes after the pivot, from j + 1 on none before it. */
        if (half <= j)
            last = j;
        else
            first = j + 1;
    }
    return half;
}
