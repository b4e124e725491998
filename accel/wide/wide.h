/* SPDX-License-Identifier: Apache-2.0 */
/* The structure behind `wide`: a hierarchy of boxes eight children wide, laid out for vectors of eight
 * floats.
 *
 * Nodes and leaves lie in one arena, a node before what is below it. A node holds the boxes of its children
 * plane by plane, so one subtraction and one multiplication intersect a ray with one plane of all eight. A
 * leaf of triangles holds them in blocks of four, vertex by vertex and axis by axis; a leaf of one sphere
 * holds the sphere; any other leaf is a list of ids.
 *
 * Invariants: the box of a child contains the boxes of all references below it (of a split reference, its
 * part of the object). Children come first in a node; the lanes after them have an empty box, which no ray
 * meets. A leaf holds 1..RT_WIDE_MAX_LEAF objects, first in their blocks; the lanes after them hold no
 * triangle; only the last of two blocks has any. A scene with objects has a root, which is a node; its only
 * child may be a leaf. No leaf is deeper than RT_TREE_MAX_DEPTH. */
#ifndef RT_ACCEL_WIDE_WIDE_H
#define RT_ACCEL_WIDE_WIDE_H

#include "accel/isa.h"
#include "accel/tree/hierarchy.h"

enum {
    RT_WIDE = 8,                /* children of a node at most */
    RT_WIDE_BLOCK = 4,          /* triangles of a block at most */
    RT_WIDE_MAX_LEAF = 8,       /* objects of a leaf at most */
    RT_WIDE_MAX_IN_FLIGHT = 64, /* rays that are traced at once at most */
    RT_WIDE_STATE_BYTES = 4160, /* of the state of one (ray.h) */
    RT_WIDE_MAX_PACKETS = 16    /* packets that are traced at once at most */
};

/* A child: its place in the arena and, in the low bits, its kind and RT_WIDE_MORE. The root is the node at 0.
 */
typedef uint32_t RtWideRef;
typedef enum RtWideKind {
    RT_WIDE_NODE,
    RT_WIDE_TRIANGLES, /* a leaf of blocks */
    RT_WIDE_SPHERES,   /* a leaf of one sphere, or a list of spheres */
    RT_WIDE_OBJECTS    /* any other list */
} RtWideKind;

#define RT_WIDE_MORE 4U                           /* a leaf has two blocks, or several objects in a list */
#define RT_WIDE_TAGS 7U                           /* the low bits */
#define RT_WIDE_UNIT 32                           /* bytes; nodes and leaves begin at multiples of it */
#define RT_WIDE_DONE ((RtWideRef)RT_WIDE_OBJECTS) /* no child: the ray has finished; at 0 is the root */

/* Gathers index an arena by signed 32-bit numbers of floats. */
#define RT_WIDE_MAX_BYTES (UINT64_C(1) << 33)

/* The child that lies `units` units from the start of the arena. */
static inline RtWideRef rt_wide_ref(uint32_t units, RtWideKind kind, bool more) {
    return units * (RT_WIDE_TAGS + 1) | (more ? RT_WIDE_MORE : 0) | (uint32_t)kind;
}

static inline RtWideKind rt_wide_kind(RtWideRef ref) {
    return (RtWideKind)(ref & 3);
}

static inline bool rt_wide_has_more(RtWideRef ref) {
    return (ref & RT_WIDE_MORE) != 0;
}

/* The units before a node or a leaf: its number in messages and paths of rays. */
static inline uint32_t rt_wide_place(RtWideRef ref) {
    return ref / (RT_WIDE_TAGS + 1);
}

typedef struct RtWideNode {
    float plane[6][RT_WIDE]; /* lo x, hi x, lo y, hi y, lo z, hi z */
    RtWideRef child[RT_WIDE];
    uint32_t count; /* of children */
    uint32_t unused[7];
} RtWideNode;

typedef struct RtWideTriangles {
    float v[3][3]
           [RT_WIDE_BLOCK]; /* by vertex and axis; NaN in lanes without a triangle, which fails every test */
    uint32_t id[RT_WIDE_BLOCK]; /* RT_NO_OBJECT there */
} RtWideTriangles;

typedef struct RtWideSphere {
    RtSphere sphere;
    uint32_t id, unused[3];
} RtWideSphere;

typedef struct RtWideList {
    uint32_t id[RT_WIDE_MAX_LEAF]; /* RT_NO_OBJECT after the last */
} RtWideList;

_Static_assert(sizeof(RtWideNode) == 256, "a node is four cache lines");
_Static_assert(sizeof(RtWideTriangles) % RT_WIDE_UNIT == 0 && sizeof(RtWideList) % RT_WIDE_UNIT == 0 &&
                   sizeof(RtWideSphere) == sizeof(RtWideList),
               "a leaf ends at a multiple of the unit");

typedef struct RtWideTree {
    char *arena;         /* [bytes] */
    uint64_t bytes;      /* 0 without objects */
    uint32_t node_count; /* 0 without objects */
    bool split_refs;     /* objects may be in several leaves (accel/clipping.h) */
    double cost;         /* expected, in visits of nodes, for a random line through the root's box */
} RtWideTree;

/* The first block, the sphere or the list of a leaf. */
static inline const void *rt_wide_leaf_at(const RtWideTree *tree, RtWideRef ref) {
    return tree->arena + (size_t)(ref & ~RT_WIDE_TAGS) * (RT_WIDE_UNIT / (RT_WIDE_TAGS + 1));
}

static inline const RtWideNode *rt_wide_node(const RtWideTree *tree, RtWideRef ref) {
    return (const RtWideNode *)(const void *)(tree->arena +
                                              (size_t)ref * (RT_WIDE_UNIT / (RT_WIDE_TAGS + 1)));
}

/* Whether a leaf is one sphere. */
static inline bool rt_wide_is_sphere(RtWideRef ref) {
    return rt_wide_kind(ref) == RT_WIDE_SPHERES && !rt_wide_has_more(ref);
}

/* Those of ids[0..most) that name objects, which come first. */
static inline uint32_t rt_wide_count_ids(const uint32_t *ids, uint32_t most) {
    uint32_t count = 0;
    for (uint32_t i = 0; i < most; i++) count += ids[i] != RT_NO_OBJECT;
    return count;
}

/* Triangles of a block. */
static inline uint32_t rt_wide_block_count(const RtWideTriangles *block) {
    return rt_wide_count_ids(block->id, RT_WIDE_BLOCK);
}

/* Objects of a leaf. */
static inline uint32_t rt_wide_count(const RtWideTree *tree, RtWideRef ref) {
    const RtWideTriangles *blocks = rt_wide_leaf_at(tree, ref);
    const RtWideList *list = rt_wide_leaf_at(tree, ref);
    if (rt_wide_is_sphere(ref)) return 1;
    if (rt_wide_kind(ref) != RT_WIDE_TRIANGLES) return rt_wide_count_ids(list->id, RT_WIDE_MAX_LEAF);
    return rt_wide_block_count(blocks) + (rt_wide_has_more(ref) ? rt_wide_block_count(blocks + 1) : 0);
}

/* Object `i` of a leaf. */
static inline uint32_t rt_wide_leaf_object(const RtWideTree *tree, RtWideRef ref, uint32_t i) {
    const void *at = rt_wide_leaf_at(tree, ref);
    const RtWideTriangles *blocks = at;
    if (rt_wide_kind(ref) == RT_WIDE_TRIANGLES) return blocks[i / RT_WIDE_BLOCK].id[i % RT_WIDE_BLOCK];
    return rt_wide_is_sphere(ref) ? ((const RtWideSphere *)at)->id : ((const RtWideList *)at)->id[i];
}

static inline RtBox rt_wide_child_box(const RtWideNode *node, uint32_t lane) {
    RtBox box;
    for (size_t a = 0; a < 3; a++) {
        box.lo.at[a] = node->plane[2 * a][lane];
        box.hi.at[a] = node->plane[2 * a + 1][lane];
    }
    return box;
}

/* The union of the boxes of a node's children. */
static inline RtBox rt_wide_children_box(const RtWideNode *node) {
    RtBox box = RT_EMPTY_BOX;
    for (uint32_t i = 0; i < node->count; i++) box = rt_box_union(box, rt_wide_child_box(node, i));
    return box;
}

/* How a tree is laid out. */
typedef struct RtWideLayout {
    uint32_t max_leaf_size; /* objects of a leaf at most */
    double block_cost;      /* of testing a block, or an object of a list, relative to visiting a node */
    bool huge_pages;
    int threads;
    uint64_t limit; /* bytes */
} RtWideLayout;

/* Lays out a complete tree, whose depth it limits, in a block of `memory`. */
RtStatus rt_wide_lay_out(RtWideTree *self, RtTree *tree, const RtGeometry *geometry, const RtWideLayout *how,
                         RtArena *memory, RtError *error);

/* RT_OK, or RT_MISMATCH with the first broken invariant. */
RtStatus rt_wide_validate(const RtWideTree *self, const RtGeometry *geometry, RtError *error);

/* ---- the accelerator ---- */

RT_DECLARE_KERNELS(wide);

typedef struct RtWide {
    RtAccel base;
    RtWideTree trees[2];        /* the second is for any-hit rays, if they have their own */
    const RtWideTree *occluded; /* the one for any-hit rays */
    uint32_t in_flight;         /* rays traced at once; 1: one after the other */
    uint32_t packets;           /* packets traced at once; 0: none */
    float sharing;              /* packets pay if at least so many rays share a visit of a node, on average */
    bool order, prefetch;
    bool fused; /* one ray's box tests may be fused (ray.h) */
} RtWide;

#endif
