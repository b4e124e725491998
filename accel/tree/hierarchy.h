/* SPDX-License-Identifier: Apache-2.0 */
/* Hierarchies of boxes in the form that is traced: an array of 32-byte nodes, in which the children of a node
 * are adjacent, and an array of object ids, in which each leaf owns a run.
 *
 * Invariants: a node's box contains the boxes of its children and objects. Every object is in exactly one
 * leaf; with split references, in leaves whose boxes together contain its surface, once in each. No leaf is
 * deeper than RT_TREE_MAX_DEPTH. Leaves are ordered like their runs of ids, so the ids of a subtree are one
 * run. Node 0 is the root; an empty scene has no node. */
#ifndef RT_ACCEL_TREE_HIERARCHY_H
#define RT_ACCEL_TREE_HIERARCHY_H

#include "accel/accel.h"
#include "accel/tree/tree.h"

enum { RT_NODE_MAX_WIDTH = 16 };

/* The flag of leaves in RtNode.count. */
#define RT_NODE_LEAF UINT32_C(0x80000000)

typedef struct RtNode {
    RtBox box;
    uint32_t first; /* inner: the first child, the others follow; leaf: the first of its ids */
    uint32_t count; /* 2..width children, or RT_NODE_LEAF | 1..leaf_limit objects */
} RtNode;

typedef struct RtHierarchy {
    RtNode *nodes; /* [node_count] */
    uint32_t *ids; /* [id_count], leaf by leaf */
    uint32_t node_count, id_count;
    uint32_t width;        /* most children of a node, 2..RT_NODE_MAX_WIDTH */
    uint32_t leaf_limit;   /* most objects of a leaf */
    double traversal_cost; /* of visiting an inner node, in object tests */
    bool split_refs;       /* objects may be in several leaves (accel/clipping.h) */
} RtHierarchy;

/* ---- building ---- */

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

/* Builds such a tree of all objects, if there are any, and lays it out: sets the nodes and ids of a hierarchy
 * whose other members are set. */
RtStatus rt_hierarchy_build(RtHierarchy *self, const RtGeometry *geometry, const RtTreeOptions *options,
                            int threads, RtError *error);

static inline bool rt_node_is_leaf(const RtNode *node) {
    return (node->count & RT_NODE_LEAF) != 0;
}

/* Number of objects of a leaf, or of children of an inner node. */
static inline uint32_t rt_node_fanout(const RtNode *node) {
    return node->count & ~RT_NODE_LEAF;
}

/* Lays out a complete tree: sets the nodes and ids of a hierarchy whose other members are set. Limits the
 * depth of the tree first if necessary. The references of a subtree share a leaf where that costs no more by
 * the surface area heuristic; where width > 2, the largest children are replaced by their own. The result
 * does not depend on the number of `threads` (0 = all processors). On failure nothing is left behind. */
RtStatus rt_hierarchy_lay_out(RtHierarchy *self, RtTree *tree, int threads, RtError *error);
void rt_hierarchy_clear(RtHierarchy *self);

/* For RtAccelOps. The predictions are those of boxes. The qualities are sampled (quality.c), in about 0.1 s
 * for a million objects. */
void rt_hierarchy_describe(const RtHierarchy *self, const RtGeometry *geometry, RtDescription *out);

/* quality.c, for rt_hierarchy_describe: sets the qualities. */
void rt_hierarchy_measure(const RtHierarchy *self, const RtGeometry *geometry, RtDescription *out);

/* `extents`: those of the nodes, by index, or NULL. */
void rt_hierarchy_each_box(const RtHierarchy *self, const struct RtExtentSet *extents, RtBoxViewer viewer);

/* RT_OK, or RT_MISMATCH with the first broken invariant, in a message that begins with `name`. */
RtStatus rt_hierarchy_validate(const RtHierarchy *self, const RtGeometry *geometry, const char *name,
                               RtError *error);

#endif
