/* SPDX-License-Identifier: Apache-2.0 */
/* The structure behind `wide`: a hierarchy of boxes of width 8, laid out for vectors of eight floats.
 *
 * A node holds the boxes of its children plane by plane, so that one subtraction and one multiplication take
 * a ray to one plane of all eight. Leaves hold what they need to be tested by: triangles in blocks of four,
 * vertex by vertex and axis by axis; spheres in blocks of four; anything else as a list of ids.
 *
 * Invariants: the box of a child contains the boxes of all below it (of divided objects, of the parts that
 * are below it); children come first, lanes without one after them, with an empty box that no ray meets; a
 * leaf holds 1..RT_WIDE_MAX_LEAF objects; in a block the lanes without an object come last and repeat the
 * last one. Node 0 is the root; a scene without objects has no node. No leaf is deeper than
 * RT_TREE_MAX_DEPTH. */
#ifndef RT_ACCEL_WIDE_WIDE_H
#define RT_ACCEL_WIDE_WIDE_H

#include "accel/accel.h"
#include "accel/tree/tree.h"

enum {
    RT_WIDE = 8,                       /* children of a node at most */
    RT_WIDE_BLOCK = 4,                 /* objects of a block at most */
    RT_WIDE_MAX_LEAF = 16,             /* objects of a leaf at most */
    RT_WIDE_MAX_IN_FLIGHT = 64,        /* rays that are traced at once at most */
    RT_WIDE_STACK = RT_TREE_MAX_DEPTH * (RT_WIDE - 1) + 2 * RT_WIDE /* each level leaves seven, and a vector's slack */
};

/* A child: what it is in the two highest bits, then, of leaves, its number of objects less one in four, then
 * the index of a node, of the first block, or of the first id. */
typedef uint32_t RtWideRef;
typedef enum RtWideKind { RT_WIDE_NODE, RT_WIDE_TRIANGLES, RT_WIDE_SPHERES, RT_WIDE_LIST } RtWideKind;
#define RT_WIDE_INDEX_BITS 26
#define RT_WIDE_MAX_INDEX  (UINT32_C(1) << RT_WIDE_INDEX_BITS)

static inline RtWideRef rt_wide_leaf(RtWideKind kind, uint32_t first, uint32_t count) {
    return (uint32_t)kind << 30 | (count - 1) << RT_WIDE_INDEX_BITS | first;
}

static inline RtWideKind rt_wide_kind(RtWideRef ref) {
    return (RtWideKind)(ref >> 30);
}

static inline uint32_t rt_wide_index(RtWideRef ref) {
    return ref & (RT_WIDE_MAX_INDEX - 1);
}

/* Objects of a leaf. */
static inline uint32_t rt_wide_count(RtWideRef ref) {
    return (ref >> RT_WIDE_INDEX_BITS & 15) + 1;
}

/* No node and no leaf: under all that waits on a stack. */
#define RT_WIDE_DONE UINT32_MAX

typedef struct RtWideNode {
    float plane[6][RT_WIDE]; /* lo x, hi x, lo y, hi y, lo z, hi z */
    RtWideRef child[RT_WIDE];
    uint32_t count; /* of children, 2..8; 1 only of a root that is one leaf */
    uint32_t unused[7];
} RtWideNode;

_Static_assert(sizeof(RtWideNode) == 256, "a node is four cache lines");

typedef struct RtWideTriangles {
    float v[3][3][RT_WIDE_BLOCK]; /* by vertex and axis */
    uint32_t id[RT_WIDE_BLOCK];
} RtWideTriangles;

typedef struct RtWideSpheres {
    float center[3][RT_WIDE_BLOCK];
    float radius[RT_WIDE_BLOCK];
    uint32_t id[RT_WIDE_BLOCK];
} RtWideSpheres;

/* One hierarchy. */
typedef struct RtWideTree {
    RtWideNode *nodes;
    RtWideTriangles *triangles;
    RtWideSpheres *spheres;
    uint32_t *ids;
    uint32_t node_count, triangle_count, sphere_count, id_count; /* of blocks, where there are blocks */
    uint32_t leaf_count, reference_count, depth;
    bool divided; /* objects may be in several leaves; rays need be thick (accel/surface.h) */
    double cost;  /* expected, in visits of nodes, of a line through the root's box */
} RtWideTree;

/* The kernels for one instruction set. */
typedef struct RtWideKernels {
    RtNearestKernel *nearest;
    RtOccludedKernel *occluded;
    RtNearestCounted *nearest_counted;
    RtOccludedCounted *occluded_counted;
} RtWideKernels;

extern const RtWideKernels rt_wide_portable, rt_wide_avx2, rt_wide_avx512;

typedef struct RtWide {
    RtAccel base;
    RtWideTree trees[2];              /* the second only where occlusion has one of its own */
    const RtWideTree *nearest, *occluded;
    const RtWideKernels *kernels;
    uint32_t in_flight; /* rays traced at once; 1: one after the other */
    bool order, prefetch, packets;
} RtWide;

/* How a tree is laid out. */
typedef struct RtWideLayout {
    uint32_t leaf_limit;  /* objects of a leaf */
    double block_cost;    /* of testing a block, or an object of a list, in visits of nodes */
    int threads;
    uint64_t limit; /* bytes */
} RtWideLayout;

/* Lays out a complete tree, which is limited in depth for it. On failure nothing is left behind. */
RtStatus rt_wide_lay_out(RtWideTree *self, RtTree *tree, const RtGeometry *geometry, const RtWideLayout *how,
                         RtError *error);
void rt_wide_clear(RtWideTree *self);
uint64_t rt_wide_bytes(const RtWideTree *self);

size_t rt_wide_scratch_bytes(const RtAccel *accel);

#endif
