/* SPDX-License-Identifier: Apache-2.0 */
/* A subtree from the top, on one thread. It is a run of nodes: its root, the left subtree, the right one; so
 * of n references it takes 2 n - 1, and what is built next to it is not in its way. */
#ifndef RT_ACCEL_TREE_SUBTREE_H
#define RT_ACCEL_TREE_SUBTREE_H

#include "accel/tree/split.h"
#include "accel/tree/tree.h"

typedef struct RtSubtreeBuilder {
    RtTree *tree;
    int bins; /* along each axis, 2..RT_MAX_BINS, or 0: halves by number */
} RtSubtreeBuilder;

/* What is to be a subtree. */
typedef struct RtRefGroup {
    RtTreeRef *refs;      /* [count] borrowed; they change places */
    uint32_t count, node; /* its first node */
    int depth;
    RtBox4 centers; /* the box about all centres */
} RtRefGroup;

/* The sides of a group that was split: its first `left` references, and the others, with these centres. */
static inline void rt_group_sides(const RtRefGroup *group, uint32_t left, const RtBox4 centers[2],
                                  RtRefGroup sides[2]) {
    sides[0] = (RtRefGroup){group->refs, left, group->node + 1, group->depth + 1, centers[0]};
    sides[1] = (RtRefGroup){group->refs + left, group->count - left, group->node + 2 * left, group->depth + 1,
                            centers[1]};
}

/* Makes the nodes, and gives the box about all. */
RtBox4 rt_subtree_build(const RtSubtreeBuilder *b, RtRefGroup group);

/* Makes `node` the union of the subtree next to it, which has `left` references, and the one behind that,
 * which have these boxes; gives the box about both. */
RtBox4 rt_subtree_unite(const RtSubtreeBuilder *b, uint32_t node, uint32_t left, const RtBox4 box[2]);

#endif
