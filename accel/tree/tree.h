/* SPDX-License-Identifier: Apache-2.0 */
/* Binary trees of references, and the ways to make them: what `bvh` and `clusters` are before they are laid
 * out for tracing (hierarchy.h).
 *
 * A reference is an object and a box about it, or about the part of it that lies somewhere; references are
 * the leaves, one each, and every other node is the union of two. A tree of n references is complete when it
 * has 2 n - 1 nodes and `root` is the one that has no parent. Nodes stand in any order: a method from the
 * bottom has the references first, one from the top each node before its children. */
#ifndef RT_ACCEL_TREE_TREE_H
#define RT_ACCEL_TREE_TREE_H

#include "core/base/status.h"
#include "core/shape/geometry.h"

#include <stdbool.h>
#include <stdint.h>

/* No leaf of a tree of limited depth is deeper than this; the stacks of traversals rest on it. */
enum { RT_TREE_MAX_DEPTH = 64 };

/* From this depth on methods from the top halve groups by number, which ends above RT_TREE_MAX_DEPTH with as
 * many as 2^30 references. */
enum { RT_TREE_MEDIAN_DEPTH = 34 };

#define RT_TREE_LEAF UINT32_MAX

typedef struct RtTreeNode {
    RtBox box;
    uint32_t child[2]; /* nodes; of a reference: RT_TREE_LEAF and the object's id */
} RtTreeNode;

typedef struct RtTree {
    RtTreeNode *nodes; /* [capacity] */
    uint32_t capacity, used;
    uint32_t root;
    bool divided; /* there are objects of several references, or of one that is not about the whole */
} RtTree;

/* An empty tree with room for `most` references, at least 1. */
RtStatus rt_tree_init(RtTree *tree, uint32_t most, RtError *error);
void rt_tree_clear(RtTree *tree);

/* A tree of `count` references and no union yet: node i is object i, in boxes[i]. Of one it is complete. */
RtStatus rt_tree_init_leaves(RtTree *tree, const RtBox *boxes, uint32_t count, RtError *error);

static inline bool rt_tree_is_leaf(const RtTree *tree, uint32_t node) {
    return tree->nodes[node].child[0] == RT_TREE_LEAF;
}

/* References of a complete tree. */
static inline uint32_t rt_tree_leaf_count(const RtTree *tree) {
    return (tree->used + 1) / 2;
}

/* Takes a node, which the caller fills, and gives its number. */
uint32_t rt_tree_take(RtTree *tree);

/* Makes a node a reference. */
void rt_tree_set_leaf(RtTree *tree, uint32_t node, RtBox box, uint32_t object);

/* Makes a node the union of a and b. */
void rt_tree_set_union(RtTree *tree, uint32_t node, uint32_t a, uint32_t b);

/* Adds the union of nodes a and b, makes it the root, and gives its number. */
uint32_t rt_tree_unite(RtTree *tree, uint32_t a, uint32_t b);

/* The distance of two nodes: half the area of the box about both (Walter 2008). */
static inline double rt_tree_distance(const RtTree *tree, uint32_t a, uint32_t b) {
    return rt_box_half_area(rt_box_union(tree->nodes[a].box, tree->nodes[b].box));
}

/* Sum of the half areas of all unions: the surface area heuristic up to constants. */
double rt_tree_cost(const RtTree *tree);

/* Where a leaf of a complete tree is deeper than RT_TREE_MAX_DEPTH, what hangs low and reaches so deep is
 * rebuilt by medians. */
RtStatus rt_tree_limit_depth(RtTree *tree, RtError *error);

/* ---- the methods ----
 *
 * Each makes a complete tree of `count` objects, at least 1, with these boxes: a function of its arguments
 * alone, of any depth. On failure nothing is left behind. */

/* Walter, Bala, Kulkarni & Pingali 2008: the two nearest nodes are united, until one is left. */
RtStatus rt_tree_agglomerative(RtTree *tree, const RtBox *boxes, uint32_t count, RtError *error);

/* Meister & Bittner 2018: in Morton order of centres (by `bits` bits an axis, order.h), nodes that are each
 * other's nearest among the `radius` before and after are united, in rounds. The same tree on any number of
 * `threads` (0 = all processors). */
RtStatus rt_tree_ploc(RtTree *tree, const RtBox *boxes, uint32_t count, uint32_t bits, uint32_t radius,
                      int threads, RtError *error);

/* Lauterbach et al. 2009: along the Morton curve, parted where the highest differing bit of codes changes.
 * The same tree on any number of `threads` (0 = all processors). */
RtStatus rt_tree_lbvh(RtTree *tree, const RtBox *boxes, uint32_t count, uint32_t bits, int threads,
                      RtError *error);

typedef struct RtInsertionOrder {
    bool random;           /* the first try, too, is a random permutation; else it is the order of ids */
    uint32_t permutations; /* tried; the cheapest tree is kept */
    uint64_t seed;
} RtInsertionOrder;

/* Goldsmith & Salmon 1987: objects are inserted one by one where the sum of areas grows least. */
RtStatus rt_tree_insertion(RtTree *tree, const RtBox *boxes, uint32_t count, const RtInsertionOrder *order,
                           RtError *error);

/* From the top: halves by number along the longest axis of centres (Rubin & Whitted 1980, whose hierarchies
 * were made by hand; bins = 0), or by the surface area heuristic in `bins` bins (Wald 2007). A subtree of n
 * references is a run of 2 n - 1 nodes: its root, the left subtree, the right one. The same tree on any
 * number of `threads` (0 = all processors). */
RtStatus rt_tree_topdown(RtTree *tree, const RtBox *boxes, uint32_t count, int bins, int threads,
                         RtError *error);

/* From the top by the surface area heuristic, all places between centres tried (MacDonald & Booth 1990). */
RtStatus rt_tree_sweep(RtTree *tree, const RtBox *boxes, uint32_t count, RtError *error);

/* How rt_tree_spatial cuts. */
typedef struct RtSpatial {
    int bins;         /* along each axis, 2..RT_MAX_BINS */
    double alpha;     /* planes are tried where groups overlap by more than this part of the root's area */
    double budget;    /* most references, per object; at least 1 */
    uint32_t leaf;    /* so few that would better be a leaf are not cut */
    double traversal; /* cost of an inner node, in object tests */
    uint64_t limit;   /* refused where tree and nodes may take more bytes */
} RtSpatial;

/* What rt_object_part (core/shape/overlap.h) needs in a scene with this box. */
static inline double rt_tree_part_margin(const RtBox *scene) {
    return 0x1p-40 * rt_box_largest_coordinate(*scene);
}

/* From the top, where a plane that cuts objects may part them: Stich, Friedrich & Dietrich 2009. The same
 * tree on any number of `threads` (0 = all processors). */
RtStatus rt_tree_spatial(RtTree *tree, const RtGeometry *geometry, const RtSpatial *how, int threads,
                         RtError *error);

/* ---- better trees ---- */

/* Bittner, Hapala & Havran 2013; Meister & Bittner 2018: moves subtrees of a complete tree to where the tree
 * costs least (rt_tree_cost), in at most so many rounds or until no move gains; the cost never rises, but
 * where the depth has to be limited first. The same tree on any number of `threads` (0 = all processors). On
 * failure *tree is still a complete tree of the same references. */
RtStatus rt_tree_reinsert(RtTree *tree, uint32_t rounds, int threads, RtError *error);

#endif
