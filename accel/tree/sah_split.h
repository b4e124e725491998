/* SPDX-License-Identifier: Apache-2.0 */
/* Splitting a group of references in two, in place: by the surface area heuristic (SAH), evaluated in equal
 * bins of centres along all three axes (Wald 2007, "On fast Construction of SAH-based Bounding Volume
 * Hierarchies"), or at the median. Boxes move together with their ids, so a group is read sequentially.
 *
 * Which references go to which side depends on the references alone, not on their order, and not on how they
 * were distributed over bins that were merged: boxes are minima and maxima, counts are integers. The cost of
 * a split is the sum of half area x number of references over both sides. */
#ifndef RT_ACCEL_TREE_SAH_SPLIT_H
#define RT_ACCEL_TREE_SAH_SPLIT_H

#include "core/base/box4.h"

enum {
    RT_MAX_BINS = 64,
    RT_REFS_AHEAD = 32 /* prefetch distance, in references, of a sequential read */
};

typedef struct RtTreeRef {
    _Alignas(32) RtBox box; /* aligned, so that no reference straddles a cache line */
    uint32_t id;
} RtTreeRef;

typedef struct RtBin {
    RtBox4 box;
    uint32_t number; /* of references; the box of an empty bin is empty */
} RtBin;

typedef struct RtBins {
    RtFloat4 lo, scale,
        last;         /* bin of a centre c: (c - lo) * scale, at most `last`; scale is 0 along an axis */
    uint32_t size[3]; /*   without extent. size: bins along each axis, 1..RT_MAX_BINS */
    RtBin bins[3][RT_MAX_BINS];
} RtBins;

typedef struct RtSplit {
    double cost; /* INFINITY: no plane separates the centres */
    int axis;
    uint32_t bin, left; /* the bins before `bin` go left; `left` is their number of references */
} RtSplit;

/* The box of all centres, and its longest axis. */
RtBox4 rt_refs_centers(const RtTreeRef *refs, uint32_t count);
int rt_longest_axis(RtBox4 box);

/* ---- bins ---- */

/* `count` equal, empty bins along each axis of the box of all centres. */
void rt_bins_init(RtBins *self, uint32_t count, RtBox4 centers);
void rt_bins_add(RtBins *self, const RtTreeRef *refs, uint32_t count);

/* Adds the references of `other`, which has the same bins. */
void rt_bins_merge(RtBins *self, const RtBins *other);

/* The cheapest split of all `count` references. Ties go to the lower axis, then to the lower bin. */
RtSplit rt_bins_split(const RtBins *self, uint32_t count);

/* Classifies centres by the side of a split. */
typedef struct RtSide {
    RtFloat4 lo, scale, least;
    unsigned mask;
} RtSide;

static inline RtSide rt_bins_side(const RtBins *self, const RtSplit *split) {
    return (RtSide){self->lo, self->scale, rt_all4((float)split->bin), 1U << split->axis};
}

/* 1: right, 0: left. */
static inline uint32_t rt_side_of(const RtSide *side, RtFloat4 center) {
    unsigned right = rt_le_bits(side->least, (center - side->lo) * side->scale);
    return (right & side->mask) != 0;
}

/* ---- small groups ---- */

/* At most RT_MAX_BINS references, sorted once along each axis. Every position between centres is tried, as if
 * each centre had a bin of its own; partitioning keeps the order. */
typedef struct RtSmallGroup {
    const RtTreeRef *refs;         /* borrowed, not moved */
    float at[3][RT_MAX_BINS];      /* the centre of each along an axis */
    uint8_t order[3][RT_MAX_BINS]; /* indices, in ascending order of centres along an axis */
} RtSmallGroup;

/* Sorts refs[0..count), 1..RT_MAX_BINS of them. */
void rt_small_group_init(RtSmallGroup *self, const RtTreeRef *refs, uint32_t count);

/* The cheapest split of order[...][begin..begin + count), the same references along all axes. The left side
 * is the first `left` in the order of the split's axis. */
RtSplit rt_small_group_split(const RtSmallGroup *self, uint32_t begin, uint32_t count);

/* Moves the left side to the front of all three orders; of the first order alone where count is 2. */
void rt_small_group_partition(RtSmallGroup *self, uint32_t begin, uint32_t count, const RtSplit *split);

/* ---- whole groups ---- */

/* The bins for a group of `count` references, where large groups have `bins`. Small groups gain little from
 * many, and most of the time is theirs. */
static inline uint32_t rt_bin_count(int bins, uint32_t count) {
    return count < 1024 && bins > 16 ? 16 : (uint32_t)bins;
}

/* Moves the left side of the cheapest split in bins (rt_bin_count) to the front and returns its size; both
 * sides get some. `centers` is the box of the centres; those of the sides go to centers_of[2]. A group of at
 * most so many references is split as a small group. Returns 0 where no plane separates the centres. */
uint32_t rt_split_binned(RtTreeRef *refs, uint32_t count, int bins, RtBox4 centers, RtBox4 centers_of[2]);

/* Moves the lower half of refs[0..count) to the front and returns its size, (count + 1) / 2: by centres along
 * the longest axis of the box of all centres, equal ones by id; count >= 1. */
uint32_t rt_split_median(RtTreeRef *refs, uint32_t count);

#endif
