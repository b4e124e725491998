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
    uint32_t count; /* 2..width children, or RT_NODE_LEAF | 1..max_leaf_size objects */
} RtNode;

typedef struct RtHierarchy {
    RtNode *nodes; /* [node_count] */
    uint32_t *ids; /* [id_count], leaf by leaf */
    uint32_t node_count, id_count;
    uint32_t width;         /* most children of a node, 2..RT_NODE_MAX_WIDTH */
    uint32_t max_leaf_size; /* most objects of a leaf */
    double traversal_cost;  /* of visiting an inner node, in object tests */
    bool split_refs;        /* objects may be in several leaves (accel/clipping.h) */
} RtHierarchy;

static inline bool rt_node_is_leaf(const RtNode *node) {
    return (node->count & RT_NODE_LEAF) != 0;
}

/* Number of objects of a leaf, or of children of an inner node. */
static inline uint32_t rt_node_fanout(const RtNode *node) {
    return node->count & ~RT_NODE_LEAF;
}

/* Builds a tree of all objects, if there are any, and lays it out: sets the nodes and ids of a hierarchy
 * whose other members are set, in `memory`. The depth of the tree is limited first if necessary. The
 * references of a subtree share a leaf where that costs no more by the surface area heuristic; where width >
 * 2, the largest children are replaced by their own. The result does not depend on the number of `threads` (0
 * = all processors). */
RtStatus rt_hierarchy_build(RtHierarchy *self, RtArena *memory, const RtGeometry *geometry,
                            const RtTreeOptions *options, int threads, RtError *error);

/* For RtAccelOps. The predictions are those of boxes. The qualities are sampled, in about 0.1 s for a million
 * objects. */
void rt_hierarchy_describe(const RtHierarchy *self, const RtGeometry *geometry, RtDescription *out);

/* `extents`: those of the nodes, by index, or NULL. */
void rt_hierarchy_each_box(const RtHierarchy *self, const struct RtExtentSet *extents, RtBoxViewer viewer);

/* RT_OK, or RT_MISMATCH with the first broken invariant, in a message that begins with `name`. */
RtStatus rt_hierarchy_validate(const RtHierarchy *self, const RtGeometry *geometry, const char *name,
                               RtError *error);

#endif
