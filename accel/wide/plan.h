/* SPDX-License-Identifier: Apache-2.0 */
/* Plans how a binary tree of references becomes eight wide: which subtrees become leaves, which nodes merge
 * into their parents, and how much space each takes. */
#ifndef RT_ACCEL_WIDE_PLAN_H
#define RT_ACCEL_WIDE_PLAN_H

#include "accel/wide/wide.h"

enum {
    RT_WIDE_NODE_UNITS = sizeof(RtWideNode) / RT_WIDE_UNIT,
    RT_WIDE_BLOCK_UNITS = sizeof(RtWideTriangles) / RT_WIDE_UNIT
};

/* choice[k - 1]: how many of k subtrees the left child gets, or RT_WIDE_FEWER if k - 1 cost no more. For k =
 * 1: RT_WIDE_LEAF, or how many of eight the left child gets. */
enum { RT_WIDE_FEWER = 0, RT_WIDE_LEAF = 255 };

/* The choices for an inner node of the binary tree. */
typedef struct RtWideChoice {
    uint8_t choice[RT_WIDE];
    uint32_t units; /* of the arena, if it is a child */
    float priority; /* for any-hit rays */
} RtWideChoice;

typedef struct RtWidePlan {
    const RtTree *tree;
    const RtGeometry *geometry;
    const RtWideLayout *how;
    double scale;          /* of areas in costs */
    bool all_triangles;    /* object i is triangle i */
    RtWideChoice *choices; /* [tree->used] of inner nodes, owned */
    uint32_t units;        /* of the whole arena */
} RtWidePlan;

/* Plans for a complete tree, which is borrowed and whose depth it limits. The caller clears the plan, also on
 * failure. */
RtStatus rt_wide_plan_init(RtWidePlan *self, RtTree *tree, const RtGeometry *geometry,
                           const RtWideLayout *how, RtError *error);
void rt_wide_plan_clear(RtWidePlan *self);

/* A leaf of `count` objects of these shapes (bits 1 << RtShape): its kind, its tests, its units of the arena,
 * and its empty lanes. */
typedef struct RtWideLeafSize {
    RtWideKind kind;
    uint32_t tests, units, empty;
} RtWideLeafSize;

RtWideLeafSize rt_wide_leaf_size(uint32_t count, uint32_t shapes);

static inline uint32_t rt_wide_shape_of(const RtWidePlan *self, uint32_t id) {
    return self->all_triangles ? RT_SHAPE_TRIANGLE : rt_ref_shape(self->geometry->objects[id]);
}

/* Writes the objects of a subtree, each once, to ids[0..*count). *count must be 0. */
void rt_wide_collect(const RtTree *tree, uint32_t index, uint32_t *ids, uint32_t *count);

static inline bool rt_wide_becomes_leaf(const RtWidePlan *self, uint32_t index) {
    RtTreeLeaf leaf;
    return rt_tree_get_leaf(self->tree, index, &leaf) || self->choices[index].choice[0] == RT_WIDE_LEAF;
}

/* Writes the children of a subtree that becomes a node, and returns their number. A root that is a leaf is
 * its own only child. Children are sorted by ascending priority: the probability that a random line through a
 * child's box hits an object, divided by the expected cost. Any-hit rays visit the last child first, which
 * minimises the expected cost. (Nah & Manocha 2014, "SATO: Surface Area Traversal Order for Shadow Ray
 * Tracing".) */
uint32_t rt_wide_children_of(const RtWidePlan *self, uint32_t index, uint32_t children[RT_WIDE]);

#endif
