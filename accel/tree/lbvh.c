/* SPDX-License-Identifier: Apache-2.0 */
/* Trees along the Morton curve (Lauterbach, Garland, Sengupta, Luebke & Manocha 2009): references in Morton
 * order are split where the highest differing bit of their codes changes, which halves space along one axis
 * after another. Equal codes are halved by number.
 *
 * A subtree of n references is a run of 2 n - 1 nodes, so subtrees are built in parallel.
 *
 * Bisection finds the position of the change, as in Karras 2012, "Maximizing Parallelism in the Construction
 * of BVHs, Octrees, and k-d Trees". His numbering of nodes, which allows to make all nodes at once, is left
 * out. */
#include "accel/tree/tree.h"
#include "core/base/memory.h"
#include "core/base/parallel.h"

/* References row[begin..begin + count), and the first node of their subtree. */
typedef struct Group {
    uint32_t begin, count, node;
} Group;

typedef struct Builder {
    RtTree *tree;
    const RtBox *boxes; /* by id */
    const RtKeyed *row; /* in Morton order */
    RtBox *in_row;      /* boxes in the same order */
    uint32_t limit;     /* larger groups are shared among threads */
} Builder;

/* The number of row[0..count) that go left; count >= 2. */
static uint32_t find_split(const RtKeyed *row, uint32_t count) {
    uint64_t differing = row[0].key ^ row[count - 1].key;
    if (differing == 0) return count / 2;
    while (differing & (differing - 1)) differing &= differing - 1; /* only the highest bit is left */
    uint32_t first = 0, last = count - 1;                           /* the bit is 0 in `first`, 1 in `last` */
    while (last - first > 1) {
        uint32_t middle = first + (last - first) / 2;
        *(row[middle].key & differing ? &last : &first) = middle;
    }
    return last;
}

static void get_sides(const Builder *b, Group group, Group sides[2]) {
    uint32_t left = find_split(b->row + group.begin, group.count);
    sides[0] = (Group){group.begin, left, group.node + 1};
    sides[1] = (Group){group.begin + left, group.count - left, group.node + 2 * left};
}

/* The depth is at most the bits of a code plus the halvings of a number. */
static void build(const Builder *b, Group group) {
    if (group.count == 1) {
        rt_tree_set_leaf(b->tree, group.node, b->in_row[group.begin], b->row[group.begin].id);
        return;
    }
    Group sides[2];
    get_sides(b, group, sides);
    for (int s = 0; s < 2; s++) build(b, sides[s]);
    rt_tree_set_union(b->tree, group.node, sides[0].node, sides[1].node);
}

/* ---- on all threads ---- */

/* A group is built by one thread if it has at most this fraction of a thread's share; CHUNK references at
 * least. */
enum { SHARES = 8, CHUNK = 1 << 13 };

/* Halves a group while it is large; the right sides become tasks. */
static RtStatus build_group(void *context, RtTasks *tasks, const void *task, RtError *error) {
    const Builder *b = context;
    Group group = *(const Group *)task;
    while (group.count > b->limit) {
        Group sides[2];
        get_sides(b, group, sides);
        if (!rt_tasks_add(tasks, &sides[1])) return rt_fail_memory(error, "a subtree", sizeof(Group));
        group = sides[0];
    }
    for (uint32_t i = group.begin; i < group.begin + group.count; i++) b->in_row[i] = b->boxes[b->row[i].id];
    build(b, group);
    return RT_OK;
}

static void unite_top(const Builder *b, Group group) {
    if (group.count <= b->limit) return;
    Group sides[2];
    get_sides(b, group, sides);
    for (int s = 0; s < 2; s++) unite_top(b, sides[s]);
    rt_tree_set_union(b->tree, group.node, sides[0].node, sides[1].node);
}

RtStatus rt_tree_lbvh(RtTree *tree, const RtGeometry *geometry, const RtTreeOptions *options, int threads,
                      RtError *error) {
    const uint32_t count = geometry->object_count,
                   share = count / SHARES / (uint32_t)rt_thread_count(threads);
    const Group all = {0, count, 0};
    RT_ARENA(arena);
    Builder builder = {.tree = tree, .boxes = geometry->boxes, .limit = share > CHUNK ? share : CHUNK};
    RT_TRY(rt_tree_init(tree, count, error));
    RT_TRY(rt_tree_order(geometry, options->bits, 0, threads, &arena, &builder.row, error));
    builder.in_row = rt_arena_alloc_unset(&arena, count, sizeof(RtBox));
    RT_TRY(rt_arena_check(&arena, "a tree by Morton codes", error));
    tree->used = tree->capacity;
    RT_TRY(rt_parallel_tasks(&all, 1, sizeof all, threads, build_group, &builder, error));
    unite_top(&builder, all);
    return RT_OK;
}
