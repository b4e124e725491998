/* SPDX-License-Identifier: Apache-2.0 */
/* The data of kd, shared by the files of this folder.
 *
 * Nodes of 8 bytes in one flat array: the root is node 0; the two children of a node are adjacent, after it,
 * the lower one first. All lists of objects are in one array, `ids`.
 *
 * Invariants: the cells of children are the cell of their parent cut at its split, so neighbours share the
 * bits of a plane. A split lies in the closed cell of its node; on a face of it, it cuts off a flat cell for
 * objects in that plane. Every object has a part, a box, in each cell that lists it (rt_kd_part): it goes
 * into the lower child if its part begins below the split, into the upper one if it ends above, and into one
 * of the two if neither. Lists are ascending. No leaf is deeper than max_depth, which bounds the stack of a
 * traversal. */
#ifndef RT_ACCEL_KD_KD_H
#define RT_ACCEL_KD_KD_H

#include "accel/accel.h"
#include "accel/clipping.h"
#include "core/shape/overlap.h"

#include <stdatomic.h>

#define RT_KD_PARAMS(X)                                                                                      \
    X(RT_KD_TRAVERSAL_COST, "traversal_cost", RT_FLOAT("1", 0, 1000, "0|0.3|10"),                            \
      "cost of visiting an inner node, in object tests", "measured: 0.94 of the time of 0.3 in the mean")    \
    X(RT_KD_EMPTY_BONUS, "empty_bonus", RT_FLOAT("0.2", 0, 1, "0|0.5|1"),                                    \
      "cost reduction, as a fraction, of a split that cuts off empty space", "Wald & Havran 2006")           \
    X(RT_KD_MAX_LEAF_SIZE, "max_leaf_size", RT_INT("0", 0, 1e6, "1|2|1000000"),                              \
      "a cell with at most this many objects is not divided", "Wald & Havran 2006: the cost alone decides")  \
    X(RT_KD_MAX_DEPTH, "max_depth", RT_INT("-1", -1, RT_KD_DEPTH_LIMIT, "0|5|60"),                           \
      "largest depth of a leaf, the root's being 0; -1: 8 + 1.3 log2 of the number of objects",              \
      "Pharr & Humphreys 2004, Physically Based Rendering")                                                  \
    X(RT_KD_FAILURES, "failures", RT_INT("1", 0, RT_KD_DEPTH_LIMIT, "0|4"),                                  \
      "splits on the path to a leaf that need not reduce the expected cost",                                 \
      "Havran & Bittner 2002; measured: trades tests for steps")                                             \
    X(RT_KD_OVERLAP, "overlap", RT_CHOICE("box", "box|exact"),                                               \
      "the part of an object in a cell: its clipped box, or the box of its clipped surface",                 \
      "exact: Havran & Bittner 2002; Wald & Havran 2006")                                                    \
    X(RT_KD_MARGIN, RT_MARGIN_PARAM("the root"))                                                             \
    X(RT_KD_MAILBOX, RT_MAILBOX_PARAM)

enum { RT_KD_PARAMS(RT_PARAM_INDEX) RT_KD_PARAM_COUNT };
extern const RtParam rt_kd_params[RT_KD_PARAM_COUNT];

enum { RT_KD_DEPTH_LIMIT = 60 };

/* RtKdNode.link & 3 of a leaf; of an inner node it is the axis of the split. */
enum { RT_KD_LEAF = 3 };

typedef struct RtKdNode {
    union {
        float split;    /* inner: the plane between its children */
        uint32_t first; /* leaf: the first of its ids */
    };
    uint32_t link; /* inner: 4 * lower child + axis; leaf: 4 * length of its list + RT_KD_LEAF */
} RtKdNode;

typedef struct RtKd {
    RtAccel base;
    RtKdNode *nodes; /* [node_count], 0 if there is no object */
    uint32_t *ids;   /* [id_count] */
    uint32_t node_count, id_count;
    RtBox box; /* the cell of the root */
    double traversal_cost, empty_bonus;
    uint32_t max_leaf_size, max_depth, failures;
    bool surfaces; /* overlap=exact */
    RtClippedRays served;
} RtKd;

static inline bool rt_kd_is_leaf(const RtKdNode *node) {
    return (node->link & 3) == RT_KD_LEAF;
}

/* An inner node: the axis of its split, and its lower child. A leaf: the length of its list. */
static inline uint32_t rt_kd_axis(const RtKdNode *node) {
    return node->link & 3;
}

static inline uint32_t rt_kd_child(const RtKdNode *node) {
    return node->link >> 2;
}

static inline uint32_t rt_kd_length(const RtKdNode *node) {
    return node->link >> 2;
}

/* The lower (0) or upper (1) half of a cell that a plane divides. */
static inline RtBox rt_kd_half(RtBox cell, uint32_t axis, float split, uint32_t upper) {
    if (upper)
        cell.lo.at[axis] = split;
    else
        cell.hi.at[axis] = split;
    return cell;
}

/* The part, within `cell`, of an object that has a part on both sides of one of the cell's faces: its box cut
 * off there or, with overlap=exact, a box of its surface there; false if there is none. */
static inline bool rt_kd_part(const RtKd *kd, uint32_t id, const RtBox *cell, RtBox *out) {
    const RtGeometry *g = &kd->base.scene->geometry;
    if (kd->surfaces) return rt_object_part(g, id, cell, kd->served.margin, out);
    *out = rt_box_common(g->boxes[id], *cell);
    return true;
}

/* kd_build.c */
RtStatus rt_kd_build(RtAccel *accel, const RtBuild *what, RtError *error);

/* ---- while building ---- */

/* The plane at which the part of an object begins, ends, or lies flat, along an axis. Events are sorted by
 * (plane, what): ends before planars before starts, then by object. */
typedef struct RtKdEvent {
    float plane;   /* never -0 */
    uint32_t what; /* RT_KD_END, _PLANAR or _START, + the object */
} RtKdEvent;

#define RT_KD_END     UINT32_C(0)
#define RT_KD_PLANAR  (UINT32_C(1) << 30)
#define RT_KD_START   (UINT32_C(2) << 30)
#define RT_KD_OBJECTS (UINT32_C(1) << 30) /* there must be fewer objects */

static inline uint32_t rt_kd_event_object(RtKdEvent event) {
    return event.what & (RT_KD_OBJECTS - 1);
}

static inline uint32_t rt_kd_event_type(RtKdEvent event) {
    return event.what & ~(RT_KD_OBJECTS - 1);
}

typedef struct RtKdRun {
    uint32_t from, count;
} RtKdRun;

/* A cell to be divided or made a leaf. Starts on its lower face and ends on its upper one, or beyond, are not
 * among its events. */
typedef struct RtKdCell {
    uint32_t node, depth;
    uint32_t failures; /* splits above that did not reduce the expected cost */
    double share;      /* of the work, by objects; the share of the root is 1 */
    RtBox box;
    RtKdRun events[3]; /* of each axis's array */
    RtKdRun ids;       /* of the array of lists */
} RtKdCell;

typedef struct RtKdSplit {
    double cost; /* expected, times half the area of the cell */
    float plane;
    uint32_t axis;
    bool planar_upper; /* planar parts go into the upper cell */
} RtKdSplit;

/* A tree under construction, depth first. The lists of pending cells are on stacks, one of objects and one of
 * events per axis, in the order in which they are popped. */
typedef struct RtKdBuilder {
    RtKd *kd;
    struct RtKdMemory *memory; /* borrowed */
    RtKdEvent *events[3];
    uint32_t *ids;
    uint32_t event_capacity[3], id_capacity, node_capacity, leaf_id_capacity;
    uint8_t *sides; /* [object_count] of the objects of the current cell: kd_divide.c */
    RtKdCell pending[RT_KD_DEPTH_LIMIT + 2];
    uint32_t pending_count;
    /* Scratch: the parts of clipped objects, and their events. */
    uint32_t *cut_ids[2];
    RtBox *cut_parts[2];
    RtKdEvent *fresh;
    uint32_t cut_id_capacity[2], cut_part_capacity[2], fresh_capacity;
} RtKdBuilder;

/* The cells of a depth: their number, list entries and shares of the objects, and those of leaves. */
typedef struct RtKdLevel {
    uint64_t nodes, ids, leaf_ids;
    double share, leaf_share;
} RtKdLevel;

/* The memory of all subtrees that threads build at once: nodes and leaves so far, and waiting lists. */
typedef struct RtKdShared {
    uint64_t limit;
    _Atomic uint64_t bytes;
    atomic_bool exceeded; /* once; then all stop */
} RtKdShared;

static inline void rt_kd_hold(RtKdShared *shared, uint64_t bytes) {
    if (atomic_fetch_add(&shared->bytes, bytes) + bytes > shared->limit)
        atomic_store(&shared->exceeded, true);
}

/* The bytes so far of the tree, and of the same tree cut off at any depth. Once they exceed the limit, cells
 * are only counted, and max_depth is lowered repeatedly to where the tree seems to fit. */
typedef struct RtKdMemory {
    uint64_t limit, bytes;
    RtKdShared *shared; /* borrowed; NULL on one thread */
    double estimate;    /* bytes that the requested tree would take; 0 while it fits */
    RtKdLevel levels[RT_KD_DEPTH_LIMIT + 1];
} RtKdMemory;

/* Whether the tree is only counted, or useless, because it takes too much memory. */
static inline bool rt_kd_is_too_large(const RtKdMemory *memory) {
    return memory->estimate > 0 || (memory->shared && atomic_load(&memory->shared->exceeded));
}

/* kd_divide.c. Divides a cell, whose children go on top of the pending cells, or makes it a leaf. */
RtStatus rt_kd_divide(RtKdBuilder *b, const RtKdCell *cell, RtError *error);
void rt_kd_clear(RtKdBuilder *b);

/* Writes the sorted events of the parts of ids[0..count) in a cell along an axis to the front of out[0..4 *
 * count), and returns their number. */
uint32_t rt_kd_make_events(const uint32_t *ids, const RtBox *parts, uint32_t count, const RtBox *cell,
                           int axis, RtKdEvent *out);

#endif
