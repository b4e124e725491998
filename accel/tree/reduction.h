/* SPDX-License-Identifier: Apache-2.0 */
/* A parallel reduction over a tree: a value for each subtree, computed bottom-up from those of its two
 * children. The top of the tree is a few levels deep. The subtrees below it, the parts, are reduced in
 * parallel, then the top by the calling thread. */
#ifndef RT_ACCEL_TREE_REDUCTION_H
#define RT_ACCEL_TREE_REDUCTION_H

#include "accel/tree/tree.h"
#include "core/base/memory.h"

enum { RT_REDUCTION_LEVELS = 9, RT_REDUCTION_MAX_PARTS = 1 << RT_REDUCTION_LEVELS };

typedef struct RtReduction {
    size_t size; /* of a value, in bytes */
    /* Computes the value of the subtree of node `index`; false if a leaf is more than `levels` below it. */
    bool (*reduce)(void *context, uint32_t index, uint32_t levels, void *value);
    /* Computes the value of inner node `index` from those of its children. */
    void (*combine)(void *context, uint32_t index, const void *const children[2], void *value);
    void *context;
} RtReduction;

typedef struct RtReducedParts {
    uint32_t index[RT_REDUCTION_MAX_PARTS]; /* [count] their roots, from left to right */
    uint32_t count;
    char *values; /* [count] */
} RtReducedParts;

/* Whether a node at this depth belongs to the top, and is not the root of a part. */
static inline bool rt_reduction_is_top(const RtTree *tree, uint32_t index, uint32_t depth) {
    RtTreeLeaf leaf;
    return depth < RT_REDUCTION_LEVELS && !rt_tree_get_leaf(tree, index, &leaf);
}

/* Computes the value of a complete tree, whose depth is limited first if necessary (rt_tree_limit_depth), and
 * those of its parts, in `memory`. */
RtStatus rt_tree_reduce(RtTree *tree, const RtReduction *reduction, RtArena *memory, int threads,
                        RtReducedParts *parts, void *whole, RtError *error);

#endif
