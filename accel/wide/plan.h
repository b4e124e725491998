/* SPDX-License-Identifier: Apache-2.0 */
/* What becomes of a binary tree of references that is laid out eight wide: which subtrees are leaves, which
 * nodes are opened into their parents, and how much room each takes. */
#ifndef RT_ACCEL_WIDE_PLAN_H
#define RT_ACCEL_WIDE_PLAN_H

#include "accel/wide/wide.h"

enum {
    RT_WIDE_NODE_UNITS = sizeof(RtWideNode) / RT_WIDE_UNIT,
    RT_WIDE_BLOCK_UNITS = sizeof(RtWideTriangles) / RT_WIDE_UNIT
};

/* choice[k - 1]: how many of k subtrees the left child gets; RT_WIDE_FEWER: k - 1 will do; for k = 1
 * RT_WIDE_LEAF or what of eight the left child gets. */
enum { RT_WIDE_FEWER = 0, RT_WIDE_LEAF = 255 };

/* What became of an inner node of the binary tree. */
typedef struct RtWideChoice {
    uint8_t choice[RT_WIDE];
    uint32_t units; /* of the arena, if it is a child */
    float promise;  /* of asking it for any hit */
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

/* Plans for a complete tree, which is limited in depth for it, and stays the caller's. To be cleared by the
 * caller, also on failure. */
RtStatus rt_wide_plan_init(RtWidePlan *self, RtTree *tree, const RtGeometry *geometry,
                           const RtWideLayout *how, RtError *error);
void rt_wide_plan_clear(RtWidePlan *self);

/* A leaf of `count` objects of these shapes (bits 1 << RtShape): its tests, what it takes, and lanes that
 * stay empty. */
typedef struct RtWideLeafSize {
    uint32_t tests, units, empty;
} RtWideLeafSize;

RtWideLeafSize rt_wide_leaf_size(uint32_t count, uint32_t shapes);

static inline uint32_t rt_wide_shape_of(const RtWidePlan *self, uint32_t id) {
    return self->all_triangles ? RT_SHAPE_TRIANGLE : rt_ref_shape(self->geometry->objects[id]);
}

/* To ids[0..*count) the objects of a subtree, each once; *count is 0 before. */
void rt_wide_collect(const RtTree *tree, uint32_t index, uint32_t *ids, uint32_t *count);

static inline bool rt_wide_becomes_leaf(const RtWidePlan *self, uint32_t index) {
    return rt_tree_is_leaf(self->tree, index) || self->choices[index].choice[0] == RT_WIDE_LEAF;
}

/* The children of what becomes a node, and their number; of the root that is a leaf, itself. By ascending
 * promise, which is the chance that a random line through the box of a child meets one of its objects by what
 * finding that out costs: rays that are content with any hit are to ask the last one first. (Nah & Manocha
 * 2014, "SATO: Surface Area Traversal Order for Shadow Ray Tracing"; among things of which one is enough, the
 * order by chance over cost has the least expected cost.) */
uint32_t rt_wide_children_of(const RtWidePlan *self, uint32_t index, uint32_t children[RT_WIDE]);

#endif
