/* SPDX-License-Identifier: Apache-2.0 */
/* References sorted into bins by their centres, and the cheapest split between bins by the surface area
 * heuristic: sum over both sides of half area x number.
 *
 * What is in a bin does not depend on the order in which references came, nor on how they were shared among
 * sets of bins that were merged: boxes are minima and maxima, numbers integers. */
#ifndef RT_ACCEL_TREE_BINS_H
#define RT_ACCEL_TREE_BINS_H

#include "core/base/box4.h"

enum {
    RT_MAX_BINS = 64,
    RT_REFS_AHEAD = 32 /* so far ahead references that are read in a row are fetched */
};

typedef struct RtTreeRef {
    _Alignas(32) RtBox box; /* so that none lies across two lines of the cache */
    uint32_t id;
} RtTreeRef;

typedef struct RtBin {
    RtBox4 box;
    uint32_t number; /* references; the box of none is empty */
} RtBin;

typedef struct RtBins {
    RtFloat4 lo, scale,
        last;         /* bin of a centre c: (c - lo) * scale, at most `last`; an axis that cannot be */
    uint32_t size[3]; /*   divided has scale 0. size: bins along each axis, 1..RT_MAX_BINS */
    RtBin bins[3][RT_MAX_BINS];
} RtBins;

typedef struct RtSplit {
    double cost;
    int axis;
    uint32_t bin, left; /* bins before `bin` are left; they hold so many */
} RtSplit;

/* `count` equal bins along each axis, between the outermost centres; all empty. */
void rt_bins_init(RtBins *self, uint32_t count, RtBox4 centers);

/* Of the same bins. */
void rt_bins_merge(RtBins *self, const RtBins *other);

void rt_bins_add(RtBins *self, const RtTreeRef *refs, uint32_t count);

static inline void rt_bin_add(RtBin *bin, RtBox4 box, uint32_t number) {
    bin->box = rt_box4_union(bin->box, box);
    bin->number += number;
}

/* The cheapest split of all `count` references; of equal ones that of the lower axis, and of the lower bin.
 * Cost INFINITY where no plane between bins parts them. */
RtSplit rt_bins_split(const RtBins *self, uint32_t count);

/* Improves *best by the splits between the bins of one axis, which hold `count` references in all. */
void rt_bins_try(const RtBin *bins, uint32_t size, int axis, uint32_t count, RtSplit *best);

/* What tells the sides of a split apart. */
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

#endif
