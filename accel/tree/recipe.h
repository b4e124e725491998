/* SPDX-License-Identifier: Apache-2.0 */
/* How a binary tree is made from parameters: one of the methods of tree.h, and reinsertion. */
#ifndef RT_ACCEL_TREE_RECIPE_H
#define RT_ACCEL_TREE_RECIPE_H

#include "accel/tree/tree.h"

/* In the order of RT_TREE_METHODS, by which parameters name them. */
#define RT_TREE_METHODS "binned|sweep|lbvh|ploc|spatial"
typedef enum RtTreeMethod {
    RT_TREE_BINNED,
    RT_TREE_SWEEP,
    RT_TREE_LBVH,
    RT_TREE_PLOC,
    RT_TREE_SPATIAL
} RtTreeMethod;

typedef struct RtTreeRecipe {
    RtTreeMethod method;
    uint32_t bits;        /* lbvh, ploc: of a Morton code along each axis */
    uint32_t radius;      /* ploc: neighbours searched on either side */
    RtSpatial spatial;    /* spatial; its bins are those of binned, too */
    uint32_t reinsertion; /* rounds, at most */
} RtTreeRecipe;

/* Makes a complete tree of all objects, at least 1. The same on any number of `threads` (0 = all processors).
 * On failure nothing is left behind. */
RtStatus rt_tree_make(RtTree *tree, const RtGeometry *geometry, const RtTreeRecipe *recipe, int threads,
                      RtError *error);

#endif
