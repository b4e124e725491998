/* SPDX-License-Identifier: Apache-2.0 */
/* Binary trees of references, and the methods that build them: the form of `bvh`, `clusters` and `wide`
 * before they are laid out for tracing (hierarchy.h, wide/layout.c). rt_tree_build, in hierarchy.c, chooses
 * among the methods.
 *
 * A reference is an object with its box, or with the box of a part of it (split references, Stich et al.
 * 2009). Each leaf is one reference; the box of every other node is the union of its children's. A complete
 * tree of n references has 2 n - 1 nodes, in any order; `root` has no parent. */
#ifndef RT_ACCEL_TREE_TREE_H
#define RT_ACCEL_TREE_TREE_H

#include "core/base/box4.h"
#include "core/base/memory.h"
#include "core/shape/geometry.h"

#include <stdbool.h>
#include <stdint.h>

/* The depth limit of trees that are traced; the stacks of traversals are this deep. */
enum { RT_TREE_MAX_DEPTH = 64 };

/* From this depth on top-down methods split at the median, so that 2^30 references stay within
 * RT_TREE_MAX_DEPTH. */
enum { RT_TREE_MEDIAN_DEPTH = 34 };

#define RT_TREE_LEAF UINT32_MAX

/* Where leaves have no nodes (rt_tree_drop_leaves), RT_TREE_OBJECT + id is the leaf of an object. */
#define RT_TREE_OBJECT (UINT32_C(1) << 31)

typedef struct RtTreeNode {
    RtBox box;
    uint32_t child[2]; /* nodes; of a leaf: RT_TREE_LEAF and the object's id */
} RtTreeNode;

typedef struct RtTree {
    RtTreeNode *nodes; /* [capacity] */
    uint32_t capacity, used;
    uint32_t root;
    bool split_refs;    /* some references are parts of objects */
    const RtBox *boxes; /* of the objects, borrowed, if leaves have no nodes; else NULL */
} RtTree;

/* An empty tree with room for `most` references, at least 1. */
RtStatus rt_tree_init(RtTree *tree, uint32_t most, RtError *error);
void rt_tree_clear(RtTree *tree);

/* A tree of `count` leaves without inner nodes: node i is object i with boxes[i]. It is complete if count is
 * 1. */
RtStatus rt_tree_init_leaves(RtTree *tree, const RtBox *boxes, uint32_t count, RtError *error);

/* Whether a node that the tree has is a leaf. */
static inline bool rt_tree_is_leaf(const RtTree *tree, uint32_t node) {
    return tree->nodes[node].child[0] == RT_TREE_LEAF;
}

/* The object of a leaf, and the box of the reference. */
typedef struct RtTreeLeaf {
    const RtBox *box;
    uint32_t object;
} RtTreeLeaf;

/* Whether `node`, which may be no node but a number of rt_tree_drop_leaves, is a leaf. If so, sets *leaf. */
static inline bool rt_tree_get_leaf(const RtTree *tree, uint32_t node, RtTreeLeaf *leaf) {
    if (node >= RT_TREE_OBJECT) {
        *leaf = (RtTreeLeaf){&tree->boxes[node - RT_TREE_OBJECT], node - RT_TREE_OBJECT};
        return true;
    }
    *leaf = (RtTreeLeaf){&tree->nodes[node].box, tree->nodes[node].child[1]};
    return rt_tree_is_leaf(tree, node);
}

/* The box of such a node. */
static inline RtBox rt_tree_box(const RtTree *tree, uint32_t node) {
    return node >= RT_TREE_OBJECT ? tree->boxes[node - RT_TREE_OBJECT] : tree->nodes[node].box;
}

/* References of a complete tree. */
static inline uint32_t rt_tree_leaf_count(const RtTree *tree) {
    return tree->boxes ? tree->used + 1 : (tree->used + 1) / 2;
}

/* Allocates a node; makes it a leaf; makes it the parent of a and b. */
uint32_t rt_tree_take(RtTree *tree);
void rt_tree_set_leaf(RtTree *tree, uint32_t node, RtBox box, uint32_t object);
void rt_tree_set_union(RtTree *tree, uint32_t node, uint32_t a, uint32_t b);

/* Adds a parent of nodes a and b, makes it the root, and returns it. */
uint32_t rt_tree_unite(RtTree *tree, uint32_t a, uint32_t b);

/* The sum of the half areas of all inner nodes: the surface area heuristic up to constants. */
double rt_tree_cost(const RtTree *tree);

/* Rebuilds by medians the subtrees with leaves deeper than RT_TREE_MAX_DEPTH, if there are any. */
RtStatus rt_tree_limit_depth(RtTree *tree, RtError *error);

/* Limits the depth of a complete tree, and removes the nodes of its leaves: half of its memory. boxes[..] are
 * those of the objects. Only rt_tree_reduce, rt_tree_get_leaf and rt_tree_box still work. Does not remove
 * split references, whose boxes are their own. On failure the leaves are still there. */
RtStatus rt_tree_drop_leaves(RtTree *tree, const RtBox *boxes, RtError *error);

/* ---- references ---- */

typedef struct RtTreeRef {
    _Alignas(32) RtBox box; /* aligned, so that no reference straddles a cache line */
    uint32_t id;
} RtTreeRef;

/* The box of all centres, and its longest axis. */
RtBox4 rt_refs_centers(const RtTreeRef *refs, uint32_t count);
int rt_longest_axis(RtBox4 box);

/* Moves the lower half of refs[0..count) to the front and returns its size, (count + 1) / 2: by centres along
 * the longest axis of the box of all centres, equal ones by id; count >= 1. */
uint32_t rt_split_median(RtTreeRef *refs, uint32_t count);

/* ---- building ---- */

enum { RT_MAX_MORTON_BITS = 21, RT_MAX_BINS = 64 };

/* In the order of RT_TREE_METHODS, the choices of a parameter. The papers: the files of the methods. */
#define RT_TREE_METHODS "binned|sweep|lbvh|ploc|spatial"
typedef enum RtTreeMethod {
    RT_TREE_BINNED,        /* top-down by the surface area heuristic, in bins (topdown.c) */
    RT_TREE_SWEEP,         /* the same, all positions between centres tried */
    RT_TREE_LBVH,          /* splits of the Morton order where the highest differing bit changes */
    RT_TREE_PLOC,          /* unites mutual nearest neighbours in Morton order, in rounds */
    RT_TREE_SPATIAL,       /* top-down, by object splits and spatial splits */
    RT_TREE_AGGLOMERATIVE, /* unites the two nearest; from here on not among RT_TREE_METHODS */
    RT_TREE_INSERTION,     /* one by one where the sum of areas grows least */
    RT_TREE_MEDIAN,        /* top-down, at the median of centres along the longest axis (topdown.c) */
    RT_TREE_METHOD_COUNT
} RtTreeMethod;

typedef struct RtTreeOptions {
    RtTreeMethod method;
    uint32_t bits;   /* lbvh, ploc: of a Morton code along each axis, 1..RT_MAX_MORTON_BITS */
    uint32_t radius; /* ploc: neighbours searched on either side */
    struct {
        int bins;      /* also binned: along each axis, 2..RT_MAX_BINS */
        double alpha;  /* spatial splits are tried where the sides overlap by more than this part of the
                          root's area */
        double budget; /* most references per object; at least 1 */
        uint32_t max_leaf_size; /* a group of at most so many references is not cut if a leaf is cheaper */
        double traversal;       /* cost of an inner node, in object tests */
        uint64_t limit;         /* most bytes of the tree and its layout */
    } spatial;
    struct {
        bool random;           /* the first attempt is a random permutation, too, not the order of ids */
        uint32_t permutations; /* attempts; the cheapest tree is kept */
        uint64_t seed;
    } insertion;
    uint32_t reinsertion; /* most rounds */
    double batch;         /* of reinsertion: part of the nodes */
} RtTreeOptions;

/* Builds a complete tree of all objects, at least 1, by a method, and improves it by reinsertion. The tree
 * depends on the objects and the options alone, not on the number of `threads` (0 = all processors); its
 * depth is not limited. On failure nothing is left behind. */
RtStatus rt_tree_build(RtTree *tree, const RtGeometry *geometry, const RtTreeOptions *options, int threads,
                       RtError *error);

/* The methods, for rt_tree_build, which clears the tree if they fail. */
typedef RtStatus RtTreeBuild(RtTree *tree, const RtGeometry *geometry, const RtTreeOptions *options,
                             int threads, RtError *error);
RtTreeBuild rt_tree_topdown, rt_tree_sweep, rt_tree_lbvh, rt_tree_ploc, rt_tree_spatial,
    rt_tree_agglomerative, rt_tree_insertion;

/* The margin of rt_object_part (core/shape/overlap.h) in a scene with this box. */
static inline double rt_tree_part_margin(const RtBox *scene) {
    return 0x1p-40 * rt_box_largest_coordinate(*scene);
}

/* Bittner, Hapala & Havran 2013; Meister & Bittner 2018: moves subtrees of a complete tree to where its cost
 * (rt_tree_cost) is least, until no move gains, in at most so many rounds. It moves this part of the nodes
 * (0 < batch <= 1), those with the largest boxes. The cost never rises, except where the depth has to
 * be limited first. */
RtStatus rt_tree_reinsert(RtTree *tree, uint32_t rounds, double batch, int threads, RtError *error);

/* ---- orders ---- */

typedef struct RtKeyed {
    uint64_t key;
    uint32_t id;
} RtKeyed;

/* Allocates in `memory`, and sets *order to, all objects in ascending order of keys, equal ones by id. It
 * does not depend on the number of `threads` (0 = all processors). If `bits` is 0, the key increases with the
 * centre of the box along `axis`. Otherwise, 1..RT_MAX_MORTON_BITS, it is a Morton code: the box of all
 * centres is divided into 2^bits cells along each axis; the key interleaves the coordinates of the centre's
 * cell, x in the lowest bit, then y, then z. */
RtStatus rt_tree_order(const RtGeometry *geometry, uint32_t bits, int axis, int threads, RtArena *memory,
                       const RtKeyed **order, RtError *error);

/* ---- reductions ---- */

enum { RT_REDUCTION_LEVELS = 9, RT_REDUCTION_MAX_PARTS = 1 << RT_REDUCTION_LEVELS };

/* In parallel: a value for each subtree, computed bottom-up from those of its two children. The top of the
 * tree is a few levels deep. The subtrees below it, the parts, are reduced in parallel, then the top by the
 * calling thread. */
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
