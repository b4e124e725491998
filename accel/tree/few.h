/* SPDX-License-Identifier: Apache-2.0 */
/* The cheapest split of a few references, all places between their centres tried. They are sorted along the
 * three axes once; parts of parts keep the order. References with one centre are never told apart. */
#ifndef RT_ACCEL_TREE_FEW_H
#define RT_ACCEL_TREE_FEW_H

#include "accel/tree/bins.h"

typedef struct RtFew {
    const RtTreeRef *refs;         /* borrowed; they stay in their places */
    float at[3][RT_MAX_BINS];      /* the centre of each along an axis */
    uint8_t order[3][RT_MAX_BINS]; /* their numbers, in ascending order of centres along an axis */
} RtFew;

/* Sorts refs[0..count), 1..RT_MAX_BINS of them. */
void rt_few_init(RtFew *self, const RtTreeRef *refs, uint32_t count);

/* Of those at order[...][begin..begin + count), which are the same along all axes. Cost INFINITY where all
 * centres coincide. The left side is the first `left` in the order of the split's axis. */
RtSplit rt_few_split(const RtFew *self, uint32_t begin, uint32_t count);

/* Parts them: the left side comes first along all axes; along the first, where there are but two. */
void rt_few_part(RtFew *self, uint32_t begin, uint32_t count, const RtSplit *split);

#endif
