/* SPDX-License-Identifier: Apache-2.0 */
/* What is found out about a tree from the bottom up, on all threads: a weight of each subtree, which is made
 * of those of its two sides. The top of the tree goes a few levels down; what hangs below it, the parts, is
 * weighed by one thread each, and the top by the caller's. */
#ifndef RT_ACCEL_TREE_FOLD_H
#define RT_ACCEL_TREE_FOLD_H

#include "accel/tree/tree.h"

enum { RT_FOLD_LEVELS = 9, RT_FOLD_MAX_PARTS = 1 << RT_FOLD_LEVELS };

/* How subtrees are weighed. A weight is `size` bytes. */
typedef struct RtFold {
    size_t size;
    /* To *weight that of the subtree of node `index`; false where a leaf hangs more than `levels` below. */
    bool (*weigh)(void *context, uint32_t index, uint32_t levels, void *weight);
    /* To *weight that of node `index`, an inner one, whose sides have these. */
    void (*unite)(void *context, uint32_t index, const void *const sides[2], void *weight);
    void *context;
} RtFold;

typedef struct RtFoldParts {
    uint32_t index[RT_FOLD_MAX_PARTS]; /* [count] their roots, from left to right */
    uint32_t count;
    char *weights; /* [count] of them, owned */
} RtFoldParts;

/* Whether a node so far below the root is of the top, and no root of a part. */
static inline bool rt_fold_is_top(const RtTree *tree, uint32_t index, uint32_t depth) {
    return depth < RT_FOLD_LEVELS && !rt_tree_is_leaf(tree, index);
}

/* To *whole the weight of a complete tree, which is limited in depth for it; to *parts those of its parts, to
 * be cleared by the caller, also on failure. */
RtStatus rt_tree_fold(RtTree *tree, const RtFold *fold, int threads, RtFoldParts *parts, void *whole,
                      RtError *error);
void rt_fold_parts_clear(RtFoldParts *parts);

#endif
