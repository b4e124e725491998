/* SPDX-License-Identifier: Apache-2.0 */
/* Building a subtree from the top, on one thread. It occupies a run of nodes: its root, the left subtree, the
 * right one. A subtree of n references takes 2 n - 1 nodes, so neighbouring subtrees are independent. */
#ifndef RT_ACCEL_TREE_TOPDOWN_H
#define RT_ACCEL_TREE_TOPDOWN_H

#include "accel/tree/sah_split.h"
#include "accel/tree/tree.h"

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
