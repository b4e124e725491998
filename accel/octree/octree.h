/* SPDX-License-Identifier: Apache-2.0 */
/* The data of octree, shared by the files of this folder.
 *
 * Nodes are in one flat array, level by level: the root is node 0; the eight children of a node are adjacent,
 * after it. Bit a of a child's octant (its position among the eight) tells on which side of its parent's
 * `split` it lies along axis a (0 = lower). All lists of objects are in one array, `ids`, leaf after leaf.
 *
 * Invariants: the cells of children are the cell of their parent cut at its split, so neighbours share the
 * bits of a plane. A split lies strictly between the planes of its cell or, if float32 has no number in
 * between, on the upper one; then the upper children are flat and never contain an object (rt_octree_sides).
 * An object is in the list of every other leaf whose closed cell meets its box, grown by rt_octree_grown. No
 * leaf is deeper than max_depth, which bounds the stacks of traversals. */
#ifndef RT_ACCEL_OCTREE_OCTREE_H
#define RT_ACCEL_OCTREE_OCTREE_H

#include "accel/accel.h"

#define RT_OCTREE_PARAMS(X)                                                                                  \
    X(RT_OCTREE_MAX_LEAF_SIZE, "max_leaf_size", RT_INT("16", 1, 1e6, "2|1000000"),                           \
      "a cell with at most this many objects is not divided", "measured: within 8 % of the fastest")         \
    X(RT_OCTREE_MAX_DEPTH, "max_depth", RT_INT("-1", -1, RT_OCTREE_DEPTH_LIMIT, "0|4|6"),                    \
      "largest depth of a leaf, the root's being 0; -1: two levels deeper than a full tree with a leaf per " \
      "object",                                                                                              \
      "the best depths of Havran 1999: 5 to 7 for 8000 objects")                                             \
    X(RT_OCTREE_SPLIT, "split", RT_CHOICE("centre", "centre|cost"),                                          \
      "split planes: through the centre, or the cheapest of eleven per axis", "Glassner 1984")               \
    X(RT_OCTREE_MARGIN, RT_MARGIN_PARAM("the root"))                                                         \
    X(RT_OCTREE_SLACK, "slack", RT_FLOAT("0", 0, 1e6, "0.01|100"),                                           \
      "a cell also lists objects within this distance, in scene units",                                      \
      "0 suffices; Havran 1999 lists more")                                                                  \
    X(RT_OCTREE_FLAT, "flat", RT_FLOAT("0", 0, 1e6, "0.01"),                                                 \
      "thickness added on both sides of objects that are flat along an axis, in scene units",                \
      "0 suffices; Havran 1999 thickens them")                                                               \
    X(RT_OCTREE_CUT_FILLED, "cut_filled", RT_FLAG("off"),                                                    \
      "also divide cells that are filled by the boxes of all their objects",                                 \
      "off: it separates nothing; Havran 1999 does")                                                         \
    X(RT_OCTREE_MAILBOX, RT_MAILBOX_PARAM)                                                                   \
    X(RT_OCTREE_TRAVERSAL, "traversal", RT_CHOICE("parametric", "points|neighbours|parametric"),             \
      "the next leaf: searched from the root, from an ancestor, or kept on a stack",                         \
      "Havran 1999: fewest steps")

enum { RT_OCTREE_PARAMS(RT_PARAM_INDEX) RT_OCTREE_PARAM_COUNT };
extern const RtParam rt_octree_params[RT_OCTREE_PARAM_COUNT];

/* In the order of the choices of the parameters. */
enum { RT_OCTREE_CENTRE, RT_OCTREE_COST };
enum { RT_OCTREE_POINTS, RT_OCTREE_NEIGHBOURS, RT_OCTREE_PARAMETRIC };

enum { RT_OCTREE_DEPTH_LIMIT = 20 };

/* RtOctreeNode.count of an inner node; its low bits mark the children that are empty leaves. */
#define RT_OCTREE_INNER UINT32_C(0xffffff00)

/* Bytes of a node and its cell. */
#define RT_OCTREE_NODE_BYTES (sizeof(RtOctreeNode) + sizeof(RtBox))

typedef struct RtOctreeNode {
    RtVec3 split;    /* inner: the planes between its children */
    uint32_t first;  /* inner: the first of its children; leaf: the first of its ids */
    uint32_t count;  /* leaf: length of its list; inner: RT_OCTREE_INNER | empty children */
    uint32_t parent; /* 0 for the root */
} RtOctreeNode;

typedef struct RtOctree {
    RtAccel base;
    RtOctreeNode *nodes; /* [node_count], 0 if there is no object */
    RtBox *boxes;        /* [node_count] their cells */
    uint32_t *ids;       /* [id_count] */
    uint32_t node_count, id_count;
    uint32_t max_leaf_size, max_depth, split, traversal;
    bool cut_filled;
    double slack, flat; /* how objects' boxes are grown: rt_octree_grown */
} RtOctree;

static inline bool rt_octree_is_inner(const RtOctreeNode *node) {
    return node->count >= RT_OCTREE_INNER;
}

/* octree_build.c */
RtStatus rt_octree_build(RtAccel *accel, const RtBuild *what, RtError *error);
void rt_octree_destroy(RtAccel *accel);

/* Whether dividing the cell can separate its objects ids[0..count): float32 has a plane inside it and, unless
 * cut_filled is set, the box of some object does not fill it. */
bool rt_octree_divisible(const RtOctree *tree, const RtBox *boxes, const RtBox *cell, const uint32_t *ids,
                         uint32_t count);

/* The children on the lower or upper side along an axis, as bits. */
static inline uint32_t rt_octree_lower(int axis) {
    return axis == 0 ? 0x55 : axis == 1 ? 0x33 : 0x0f;
}

static inline uint32_t rt_octree_upper(int axis) {
    return 0xff ^ rt_octree_lower(axis);
}

/* The octant of a node other than the root among its siblings: groups of eight follow the root. */
static inline uint32_t rt_octree_octant(uint32_t index) {
    return (index - 1) & 7;
}

/* The box by which an object goes into cells: its own, extended by `slack` on all sides, and along an axis in
 * which it is flat also by `flat`. */
static inline RtBox rt_octree_grown(const RtOctree *tree, RtBox own) {
    if (tree->slack == 0 && tree->flat == 0) return own;
    for (int a = 0; a < 3; a++) {
        double grow = tree->slack + (own.lo.at[a] == own.hi.at[a] ? tree->flat : 0);
        own.lo.at[a] = rt_float_below((double)own.lo.at[a] - grow);
        own.hi.at[a] = rt_float_above((double)own.hi.at[a] + grow);
    }
    return own;
}

/* The children, as bits, that list an object with this box, which meets the cell. */
static inline uint32_t rt_octree_sides(const RtBox *cell, RtVec3 split, const RtBox *object) {
    uint32_t children = 0xff;
    for (int a = 0; a < 3; a++) {
        bool lower = object->lo.at[a] <= split.at[a];
        bool upper = object->hi.at[a] >= split.at[a] && split.at[a] < cell->hi.at[a];
        children &= (lower ? rt_octree_lower(a) : 0) | (upper ? rt_octree_upper(a) : 0);
    }
    return children;
}

/* The cell of the child at `octant` among eight. */
static inline RtBox rt_octree_child_box(RtBox cell, RtVec3 split, uint32_t octant) {
    for (int a = 0; a < 3; a++) {
        if (octant >> a & 1)
            cell.lo.at[a] = split.at[a];
        else
            cell.hi.at[a] = split.at[a];
    }
    return cell;
}

#endif
