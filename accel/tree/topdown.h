/* SPDX-License-Identifier: Apache-2.0 */
/* Splitting a group of references in two, in place, and building a subtree from the top, on one thread: by
 * the surface area heuristic (SAH), evaluated in equal bins of centres along all three axes (Wald 2007, "On
 * fast Construction of SAH-based Bounding Volume Hierarchies"), or at the median. Boxes move together with
 * their ids, so a group is read sequentially.
 *
 * Which references go to which side depends on the references alone, not on their order, and not on how they
 * were distributed over bins that were merged: boxes are minima and maxima, counts are integers. The cost of
 * a split is the sum of half area x number of references over both sides. */
#ifndef RT_ACCEL_TREE_TOPDOWN_H
#define RT_ACCEL_TREE_TOPDOWN_H

#include "accel/tree/tree.h"

/* The bins for a group of `count` references, where large groups have `bins`. Small groups gain little from
 * many, and most of the time is theirs. */
static inline uint32_t rt_bin_count(int bins, uint32_t count) {
    return count < 1024 && bins > 16 ? 16 : (uint32_t)bins;
}

/* Moves the left side of the cheapest split in bins (rt_bin_count) to the front and returns its size; both
 * sides get some. `centers` is the box of the centres; those of the sides go to centers_of[2]. A group of at
 * most so many references is split as a small group. Returns 0 where no plane separates the centres. */
uint32_t rt_split_binned(RtTreeRef *refs, uint32_t count, int bins, RtBox4 centers, RtBox4 centers_of[2]);

/* Builds subtrees, each in a run of nodes: its root, the left subtree, the right one. A subtree of n
 * references takes 2 n - 1 nodes, so neighbouring subtrees are independent. */
typedef struct RtSubtreeBuilder {
    RtTree *tree;
    int bins; /* along each axis, 2..RT_MAX_BINS, or 0: split at the median */
} RtSubtreeBuilder;

/* The references of a subtree. */
typedef struct RtRefGroup {
    RtTreeRef *refs;      /* [count] borrowed; they are reordered */
    uint32_t count, node; /* the first node of the run */
    int depth;
    RtBox4 centers; /* the box of all centres */
} RtRefGroup;

/* Builds the nodes of a group and returns their box. */
RtBox4 rt_subtree_build(const RtSubtreeBuilder *b, RtRefGroup group);

#endif
