/* SPDX-License-Identifier: Apache-2.0 */
/* Building a binary tree, or a hierarchy, as parameters say: by one of the methods of tree.h, and
 * reinsertion. */
#ifndef RT_ACCEL_TREE_TREE_BUILD_H
#define RT_ACCEL_TREE_TREE_BUILD_H

#include "accel/tree/hierarchy.h"

/* In the order of RT_TREE_METHODS, the choices of a parameter. */
#define RT_TREE_METHODS "binned|sweep|lbvh|ploc|spatial"
typedef enum RtTreeMethod {
    RT_TREE_BINNED,
    RT_TREE_SWEEP,
    RT_TREE_LBVH,
    RT_TREE_PLOC,
    RT_TREE_SPATIAL,
    RT_TREE_AGGLOMERATIVE, /* from here on not among RT_TREE_METHODS */
    RT_TREE_INSERTION,
    RT_TREE_MEDIAN
} RtTreeMethod;

typedef struct RtTreeOptions {
    RtTreeMethod method;
    uint32_t bits;     /* lbvh, ploc: of a Morton code along each axis */
    uint32_t radius;   /* ploc: neighbours searched on either side */
    RtSpatial spatial; /* spatial; its bins also apply to binned */
    RtInsertionOrder insertion;
    uint32_t reinsertion; /* most rounds */
    double batch;         /* of reinsertion: part of the nodes */
} RtTreeOptions;

/* Builds a complete tree of all objects, at least 1; the same on any number of `threads` (0 = all
 * processors). On failure nothing is left behind. */
RtStatus rt_tree_build(RtTree *tree, const RtGeometry *geometry, const RtTreeOptions *options, int threads,
                       RtError *error);

/* Builds such a tree of all objects, if there are any, and lays it out (rt_hierarchy_lay_out). */
RtStatus rt_hierarchy_build(RtHierarchy *self, const RtGeometry *geometry, const RtTreeOptions *options,
                            int threads, RtError *error);

#endif
