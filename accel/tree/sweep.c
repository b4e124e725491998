/* SPDX-License-Identifier: Apache-2.0 */
/* Trees from the top by the surface area heuristic, with every position between two neighbouring centres
 * tried along each axis (MacDonald & Booth 1990; the sweep of Wald, Boulos & Shirley 2007, "Ray Tracing
 * Deformable Scenes Using Dynamic Bounding Volume Hierarchies"). O(n log n) for balanced trees: the
 * references are sorted once per axis and then partitioned stably.
 *
 * There are three rows of the same references, each sorted along one axis. The references of a node are one
 * run, at the same position in all rows, so every pass reads memory sequentially. */
#include "accel/tree/tree.h"

typedef struct Sweep {
    RtTree *tree;
    RtTreeRef *rows[3];  /* [count] */
    RtTreeRef *spare;    /* [count] */
    double *right_costs; /* [count] half area x number of the references right of a position */
    uint64_t *right;     /* a bit per reference, by id: it goes to the right */
} Sweep;

typedef struct Split {
    double cost;
    uint32_t left; /* references on the left */
    int axis;
} Split;

static bool more_even(uint32_t left, uint32_t than, uint32_t count) {
    uint32_t a = left < count - left ? left : count - left, b = than < count - than ? than : count - than;
    return a > b;
}

/* Improves *best by the positions in row[0..count). Among positions of equal cost, as between coincident
 * boxes, the more balanced one wins. */
static void try_axis(const Sweep *s, const RtTreeRef *row, uint32_t count, int axis, Split *best) {
    RtBox box = RT_EMPTY_BOX;
    for (uint32_t i = count; i-- > 1;) {
        box = rt_box_union(box, row[i].box);
        s->right_costs[i] = rt_box_half_area(box) * (count - i);
    }
    box = RT_EMPTY_BOX;
    for (uint32_t i = 1; i < count; i++) {
        box = rt_box_union(box, row[i - 1].box);
        double cost = rt_box_half_area(box) * i + s->right_costs[i];
        if (cost > best->cost || (cost == best->cost && !more_even(i, best->left, count))) continue;
        *best = (Split){cost, i, axis};
    }
}

static Split find_split(const Sweep *s, uint32_t begin, uint32_t count, int depth) {
    if (depth < RT_TREE_MEDIAN_DEPTH) {
        Split best = {.cost = INFINITY};
        for (int axis = 0; axis < 3; axis++) try_axis(s, s->rows[axis] + begin, count, axis, &best);
        return best;
    }
    return (Split){0, count / 2, rt_longest_axis(rt_refs_centers(s->rows[0] + begin, count))};
}

/* Partitions stably, left side first. */
static void partition(const Sweep *s, RtTreeRef *row, uint32_t count) {
    uint32_t left = 0, right = 0;
    for (uint32_t i = 0; i < count; i++) {
        bool goes_right = s->right[row[i].id / 64] >> row[i].id % 64 & 1;
        *(goes_right ? &s->spare[right++] : &row[left++]) = row[i];
    }
    for (uint32_t i = 0; i < right; i++) row[left + i] = s->spare[i];
}

/* Partitions the references of a node in all rows; returns the number that go left. */
static uint32_t split_node(const Sweep *s, uint32_t begin, uint32_t count, int depth) {
    Split split = find_split(s, begin, count, depth);
    const RtTreeRef *row = s->rows[split.axis] + begin;
    for (uint32_t i = 0; i < count; i++) {
        uint64_t bit = UINT64_C(1) << row[i].id % 64, *word = &s->right[row[i].id / 64];
        *word = i < split.left ? *word & ~bit : *word | bit;
    }
    for (int axis = 0; axis < 3; axis++) {
        if (axis != split.axis) partition(s, s->rows[axis] + begin, count);
    }
    return split.left;
}

static uint32_t build(const Sweep *s, uint32_t begin, uint32_t count, int depth) {
    uint32_t node = rt_tree_take(s->tree);
    if (count == 1) {
        rt_tree_set_leaf(s->tree, node, s->rows[0][begin].box, s->rows[0][begin].id);
        return node;
    }
    uint32_t left = split_node(s, begin, count, depth);
    uint32_t first = build(s, begin, left, depth + 1);
    rt_tree_set_union(s->tree, node, first, build(s, begin + left, count - left, depth + 1));
    return node;
}

static RtStatus make_row(Sweep *s, const RtGeometry *geometry, int axis, RtArena *memory, RtError *error) {
    const uint32_t count = geometry->object_count;
    RT_ARENA(arena);
    const RtKeyed *order;
    RT_TRY(rt_tree_order(geometry, 0, axis, 1, &arena, &order, error));
    RtTreeRef *row = s->rows[axis] = rt_arena_alloc(memory, count, sizeof(RtTreeRef));
    RT_TRY(rt_arena_check(memory, "the rows of a sweep", error));
    for (uint32_t i = 0; i < count; i++) row[i] = (RtTreeRef){geometry->boxes[order[i].id], order[i].id};
    return RT_OK;
}

RtStatus rt_tree_sweep(RtTree *tree, const RtGeometry *geometry, const RtTreeOptions *options, int threads,
                       RtError *error) {
    const uint32_t count = geometry->object_count;
    RT_ARENA(arena);
    (void)options, (void)threads;
    RT_TRY(rt_tree_init(tree, count, error));
    Sweep s = {.tree = tree,
               .spare = rt_arena_alloc(&arena, count, sizeof(RtTreeRef)),
               .right_costs = rt_arena_alloc(&arena, count, sizeof(double)),
               .right = rt_arena_alloc(&arena, (size_t)count / 64 + 1, sizeof(uint64_t))};
    for (int axis = 0; axis < 3; axis++) RT_TRY(make_row(&s, geometry, axis, &arena, error));
    tree->root = build(&s, 0, count, 0);
    return RT_OK;
}
