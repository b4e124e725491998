/* SPDX-License-Identifier: Apache-2.0 */
/* Hierarchies of boxes as they are traced: one array of 32-byte nodes, the children of a node side by side,
 * and one array of object ids, of which a leaf owns a run.
 *
 * Invariants: a node's box contains the boxes of its children and objects; every object is in exactly one
 * leaf, or, where they are divided, in leaves whose boxes hold all of its surface, once in each; no leaf is
 * deeper than RT_TREE_MAX_DEPTH; the leaves come in the order of their ids, children as they stand, so that
 * the ids of a subtree are one run. Node 0 is the root; of no objects there is no node. */
#ifndef RT_ACCEL_TREE_HIERARCHY_H
#define RT_ACCEL_TREE_HIERARCHY_H

#include "accel/accel.h"
#include "accel/tree/tree.h"

enum { RT_NODE_MAX_WIDTH = 16 };

/* Marks the number of objects of a leaf; without it, the number of children of an inner node. */
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
    bool divided;          /* objects may be in several leaves; rays need be thick (accel/surface.h) */
} RtHierarchy;

static inline bool rt_node_is_leaf(const RtNode *node) {
    return (node->count & RT_NODE_LEAF) != 0;
}

/* Objects of a leaf, or children of an inner node. */
static inline uint32_t rt_node_fanout(const RtNode *node) {
    return node->count & ~RT_NODE_LEAF;
}

/* Fills nodes and ids of a hierarchy, whose other limits are set, from a complete tree, which is limited in
 * depth for it. References of a subtree share a leaf where that costs no more by the surface area heuristic;
 * nodes wider than pairs take in the largest of their children. The same on any number of `threads` (0 = all
 * processors). On failure nothing is left behind. */
RtStatus rt_hierarchy_lay_out(RtHierarchy *self, RtTree *tree, int threads, RtError *error);
void rt_hierarchy_clear(RtHierarchy *self);

/* For RtAccelOps. The predictions are those of boxes; the qualities, in object tests and leaves, are sampled
 * (quality.c), in some 0.1 s where there are a million objects. */
void rt_hierarchy_describe(const RtHierarchy *self, const RtGeometry *geometry, RtDescription *out);

/* quality.c, for describe: sets the qualities. */
void rt_hierarchy_measure(const RtHierarchy *self, const RtGeometry *geometry, RtDescription *out);

/* `extents`: of the nodes, by their index; or NULL. */
void rt_hierarchy_each_box(const RtHierarchy *self, const struct RtExtentSet *extents, RtBoxViewer viewer);
void rt_hierarchy_each_leaf(const RtHierarchy *self, RtLeafViewer viewer);

/* RT_OK, or RT_MISMATCH and the first broken invariant, told of `name`. */
RtStatus rt_hierarchy_validate(const RtHierarchy *self, const RtGeometry *geometry, const char *name,
                               RtError *error);

/* parts.c, for validate: whether the leaves that list an object hold its surface, for all objects. */
RtStatus rt_hierarchy_check_parts(const RtHierarchy *self, const RtGeometry *geometry, const char *name,
                                  RtError *error);

#endif
