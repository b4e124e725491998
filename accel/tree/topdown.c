/* SPDX-License-Identifier: Apache-2.0 */
/* Trees from the top: by binned SAH, or by medians.
 *
 * The position of a node follows from numbers of references, so subtrees are built in parallel. While there
 * are fewer groups than threads, the top is built level by level: the references of all groups are divided
 * into chunks, which threads bin, and then partition into the other of two rows. From there on a group is
 * split in place, and one of its sides becomes a task. The side of a reference depends on the group alone
 * (sah_split.h), so the tree does not depend on the number of threads. */
#include "accel/tree/topdown.h"
#include "core/base/memory.h"
#include "core/base/parallel.h"

#include <assert.h>
#include <stdatomic.h>
#include <stdlib.h>

/* ---- on one thread ---- */

static RtBox4 set_leaf(const RtSubtreeBuilder *b, uint32_t node, const RtTreeRef *ref) {
    rt_tree_set_leaf(b->tree, node, ref->box, ref->id);
    return rt_box4_load(&ref->box);
}

/* Makes `node` the union of the subtree next to it, which has `left` references, and the one behind that;
 * box[2] are their boxes. Returns its box. */
static RtBox4 unite(const RtSubtreeBuilder *b, uint32_t node, uint32_t left, const RtBox4 box[2]) {
    RtTreeNode *at = &b->tree->nodes[node];
    RtBox4 both = rt_box4_union(box[0], box[1]);
    rt_box4_store(&at->box, both);
    at->child[0] = node + 1;
    at->child[1] = node + 2 * left;
    return both;
}

/* The sides of a group that was split: its first `left` references, and the others. */
static void get_sides(const RtRefGroup *group, uint32_t left, const RtBox4 centers[2], RtRefGroup sides[2]) {
    sides[0] = (RtRefGroup){group->refs, left, group->node + 1, group->depth + 1, centers[0]};
    sides[1] = (RtRefGroup){group->refs + left, group->count - left, group->node + 2 * left, group->depth + 1,
                            centers[1]};
}

static RtBox4 build_sides(const RtSubtreeBuilder *b, const RtRefGroup *group, uint32_t left,
                          const RtBox4 centers[2]) {
    RtRefGroup sides[2];
    RtBox4 box[2];
    get_sides(group, left, centers, sides);
    for (int s = 0; s < 2; s++) box[s] = rt_subtree_build(b, sides[s]);
    return unite(b, group->node, left, box);
}

static RtBox4 build_at_median(const RtSubtreeBuilder *b, const RtRefGroup *group) {
    uint32_t left = rt_split_median(group->refs, group->count);
    RtBox4 centers[2] = {rt_refs_centers(group->refs, left),
                         rt_refs_centers(group->refs + left, group->count - left)};
    return build_sides(b, group, left, centers);
}

/* The references at begin..begin + count of all three orders. */
static RtBox4 build_small(const RtSubtreeBuilder *b, RtSmallGroup *small, uint32_t begin, uint32_t count,
                          uint32_t node, int depth) {
    if (count == 1) return set_leaf(b, node, &small->refs[small->order[0][begin]]);
    RtSplit split = {.cost = INFINITY};
    if (depth < RT_TREE_MEDIAN_DEPTH) split = rt_small_group_split(small, begin, count);
    if (!(split.cost < INFINITY)) {
        RtTreeRef refs[RT_MAX_BINS];
        for (uint32_t i = 0; i < count; i++) refs[i] = small->refs[small->order[0][begin + i]];
        RtRefGroup group = {refs, count, node, depth, rt_box4_empty()};
        return build_at_median(b, &group);
    }
    rt_small_group_partition(small, begin, count, &split);
    RtBox4 box[2] = {
        build_small(b, small, begin, split.left, node + 1, depth + 1),
        build_small(b, small, begin + split.left, count - split.left, node + 2 * split.left, depth + 1)};
    return unite(b, node, split.left, box);
}

RtBox4 rt_subtree_build(const RtSubtreeBuilder *b, RtRefGroup group) {
    if (group.count == 1) return set_leaf(b, group.node, group.refs);
    if (b->bins == 0 || group.depth >= RT_TREE_MEDIAN_DEPTH) return build_at_median(b, &group);
    if (group.count <= rt_bin_count(b->bins, group.count)) {
        RtSmallGroup small;
        rt_small_group_init(&small, group.refs, group.count);
        return build_small(b, &small, 0, group.count, group.node, group.depth);
    }
    RtBox4 centers[2];
    uint32_t left = rt_split_binned(group.refs, group.count, b->bins, group.centers, centers);
    return left > 0 ? build_sides(b, &group, left, centers) : build_at_median(b, &group);
}

/* ---- on all threads ---- */

enum {
    SHARES = 64,       /* a group is one task if it is at most this fraction of a thread's share ... */
    SMALL = 1 << 11,   /* ... or has at most so many references */
    CHUNK = 1 << 13,   /* references of a chunk of the top */
    LARGE = 4 * CHUNK, /* fewer references in all are built on one thread */
};

static_assert(sizeof(RtTreeRef) <= sizeof(RtTreeNode), "references fit into the room of the nodes");

typedef struct TopNode {
    uint32_t node, left; /* references of the left child */
} TopNode;

/* Some references of a group that is being split. */
typedef struct Chunk {
    uint32_t group, first, count; /* refs[first..first + count) of the group's */
    uint32_t to[2];               /* where those of either side go in the group */
    RtBox4 centers[2];            /* of either side */
    RtBins bins;
} Chunk;

typedef struct Top {
    const RtSubtreeBuilder *b;
    const RtBox *boxes;
    RtTreeRef *rows[2]; /* [count] the references, alternating; the second is the memory of the nodes */
    uint32_t count, row, chunk_size;
    uint32_t top_limit;               /* larger groups belong to the top; at least share_limit */
    uint32_t share_limit;             /* larger groups are shared among threads */
    RtRefGroup *groups, *next, *done; /* of this level, of the next, and those below the top */
    RtSplit *splits;                  /* [open] of the groups of this level */
    Chunk *chunks;
    TopNode *nodes; /* parents before their children */
    uint32_t open, next_count, done_count, chunk_count;
    _Atomic uint32_t node_count;
} Top;

/* Divides the references of all open groups into chunks. */
static void make_chunks(Top *top) {
    top->chunk_count = 0;
    for (uint32_t g = 0; g < top->open; g++) {
        for (uint32_t first = 0; first < top->groups[g].count; first += top->chunk_size) {
            uint32_t rest = top->groups[g].count - first;
            Chunk *chunk = &top->chunks[top->chunk_count++];
            chunk->group = g;
            chunk->first = first;
            chunk->count = rest < top->chunk_size ? rest : top->chunk_size;
        }
    }
}

static void make_refs(void *context, size_t item) {
    Top *top = context;
    Chunk *chunk = &top->chunks[item];
    RtTreeRef *refs = top->rows[top->row] + chunk->first;
    for (uint32_t i = 0; i < chunk->count; i++)
        refs[i] = (RtTreeRef){top->boxes[chunk->first + i], chunk->first + i};
    chunk->centers[0] = rt_refs_centers(refs, chunk->count);
}

static void fill_chunk(void *context, size_t item) {
    Top *top = context;
    Chunk *chunk = &top->chunks[item];
    const RtRefGroup *group = &top->groups[chunk->group];
    rt_bins_init(&chunk->bins, (uint32_t)top->b->bins, group->centers);
    rt_bins_add(&chunk->bins, group->refs + chunk->first, chunk->count);
}

/* Splits each group by the bins of all its chunks, and computes where the references of each chunk go. */
static void choose_splits(Top *top) {
    for (uint32_t c = 0, end; c < top->chunk_count; c = end) {
        uint32_t g = top->chunks[c].group;
        RtBins all = top->chunks[c].bins;
        for (end = c + 1; end < top->chunk_count && top->chunks[end].group == g; end++)
            rt_bins_merge(&all, &top->chunks[end].bins);
        RtSplit split = top->splits[g] = rt_bins_split(&all, top->groups[g].count);
        uint32_t to[2] = {0, split.left};
        for (; c < end; c++) {
            Chunk *chunk = &top->chunks[c];
            uint32_t left = 0;
            for (uint32_t i = 0; i < split.bin; i++) left += chunk->bins.bins[split.axis][i].number;
            for (int s = 0; s < 2; s++) chunk->to[s] = to[s];
            to[0] += left;
            to[1] += chunk->count - left;
        }
    }
}

static void partition_chunk(void *context, size_t item) {
    Top *top = context;
    Chunk *chunk = &top->chunks[item];
    const RtRefGroup *group = &top->groups[chunk->group];
    const RtTreeRef *from = group->refs + chunk->first;
    RtTreeRef *into = top->rows[1 - top->row] + (group->refs - top->rows[top->row]);
    RtSide side = rt_bins_side(&chunk->bins, &top->splits[chunk->group]);
    uint32_t left = chunk->to[0], right = chunk->to[1];
    RtBox4 centers[2] = {rt_box4_empty(), rt_box4_empty()};
    if (!(top->splits[chunk->group].cost < INFINITY)) return;
    for (uint32_t i = 0; i < chunk->count; i++) {
        __builtin_prefetch(from + i + RT_REFS_AHEAD);
        RtFloat4 center = rt_box4_center(rt_box4_load(&from[i].box));
        uint32_t s = rt_side_of(&side, center);
        centers[s] = rt_box4_add_point(centers[s], center);
        into[s ? right : left] = from[i];
        left += 1 - s;
        right += s;
    }
    memcpy(chunk->centers, centers, sizeof centers);
}

/* A group is open while it belongs to the top and is split by bins. */
static void add_group(Top *top, RtRefGroup group) {
    bool large = group.count > top->top_limit && group.depth < RT_TREE_MEDIAN_DEPTH;
    if (large)
        top->next[top->next_count++] = group;
    else
        top->done[top->done_count++] = group;
}

static void add_node(Top *top, uint32_t node, uint32_t left) {
    top->nodes[atomic_fetch_add(&top->node_count, 1)] = (TopNode){node, left};
}

/* The sides of the split groups are the groups of the next level. */
static void descend(Top *top) {
    RtTreeRef *into = top->rows[1 - top->row], *from = top->rows[top->row];
    top->next_count = 0;
    for (uint32_t c = 0; c < top->chunk_count;) {
        uint32_t g = top->chunks[c].group;
        const RtRefGroup *group = &top->groups[g];
        const RtSplit *split = &top->splits[g];
        RtBox4 centers[2] = {rt_box4_empty(), rt_box4_empty()};
        for (; c < top->chunk_count && top->chunks[c].group == g; c++) {
            for (int s = 0; s < 2; s++) centers[s] = rt_box4_union(centers[s], top->chunks[c].centers[s]);
        }
        if (!(split->cost < INFINITY)) {
            top->done[top->done_count++] = *group;
            continue;
        }
        RtRefGroup sides[2], moved = *group;
        moved.refs = into + (group->refs - from);
        get_sides(&moved, split->left, centers, sides);
        add_node(top, group->node, split->left);
        for (int s = 0; s < 2; s++) add_group(top, sides[s]);
    }
    RtRefGroup *kept = top->groups;
    top->groups = top->next;
    top->next = kept;
    top->open = top->next_count;
    top->row = 1 - top->row;
}

/* Moves a group out of the second row, whose memory the nodes need; levels alternate between the rows. */
static void move_back(void *context, size_t item) {
    Top *top = context;
    RtRefGroup *group = &top->done[item];
    size_t first = (size_t)(group->refs - top->rows[group->depth % 2 == 1 ? 0 : 1]);
    if (group->depth % 2 == 1) return;
    memcpy(top->rows[0] + first, group->refs, group->count * sizeof(RtTreeRef));
    group->refs = top->rows[0] + first;
}

/* Splits a group while it is large; the right sides become tasks. */
static RtStatus build_group(void *context, RtTasks *tasks, const void *task, RtError *error) {
    Top *top = context;
    RtRefGroup group = *(const RtRefGroup *)task;
    (void)error;
    while (group.count > top->share_limit && group.depth < RT_TREE_MEDIAN_DEPTH) {
        RtBox4 centers[2];
        uint32_t left = rt_split_binned(group.refs, group.count, top->b->bins, group.centers, centers);
        if (left == 0) break;
        RtRefGroup sides[2];
        get_sides(&group, left, centers, sides);
        if (!rt_tasks_add(tasks, &sides[1])) rt_subtree_build(top->b, sides[1]);
        add_node(top, group.node, left);
        group = sides[0];
    }
    rt_subtree_build(top->b, group);
    return RT_OK;
}

static int larger_first(const void *a, const void *b) {
    const RtRefGroup *x = a, *y = b;
    if (x->count != y->count) return x->count > y->count ? -1 : 1;
    return x->node < y->node ? -1 : x->node > y->node;
}

/* Descendants first: they follow their ancestors in a run. */
static int lower_first(const void *a, const void *b) {
    const TopNode *x = a, *y = b;
    return x->node > y->node ? -1 : x->node < y->node;
}

static void unite_top(Top *top) {
    const RtTreeNode *nodes = top->b->tree->nodes;
    qsort(top->nodes, top->node_count, sizeof(TopNode), lower_first);
    for (uint32_t i = 0; i < top->node_count; i++) {
        uint32_t node = top->nodes[i].node, left = top->nodes[i].left;
        RtBox4 box[2] = {rt_box4_load(&nodes[node + 1].box), rt_box4_load(&nodes[node + 2 * left].box)};
        unite(top->b, node, left, box);
    }
}

/* Makes the references, and the group of them all. */
static RtStatus begin(Top *top, int threads, RtError *error) {
    top->groups[0] = (RtRefGroup){top->rows[top->row], top->count, 0, 0, rt_box4_empty()};
    top->open = 1;
    make_chunks(top);
    RT_TRY(rt_parallel_each(top->chunk_count, threads, make_refs, top, error));
    for (uint32_t c = 0; c < top->chunk_count; c++)
        top->groups[0].centers = rt_box4_union(top->groups[0].centers, top->chunks[c].centers[0]);
    return RT_OK;
}

static RtStatus build_on_one(Top *top, RtError *error) {
    RT_TRY(begin(top, 1, error));
    rt_subtree_build(top->b, top->groups[0]);
    return RT_OK;
}

static RtStatus build_on_several(Top *top, int threads, RtError *error) {
    RT_TRY(begin(top, threads, error));
    while (top->open > 0) {
        make_chunks(top);
        RT_TRY(rt_parallel_each(top->chunk_count, threads, fill_chunk, top, error));
        choose_splits(top);
        RT_TRY(rt_parallel_each(top->chunk_count, threads, partition_chunk, top, error));
        descend(top);
    }
    RT_TRY(rt_parallel_each(top->done_count, threads, move_back, top, error));
    qsort(top->done, top->done_count, sizeof(RtRefGroup), larger_first);
    RT_TRY(
        rt_parallel_tasks(top->done, top->done_count, sizeof(RtRefGroup), threads, build_group, top, error));
    unite_top(top);
    return RT_OK;
}

/* Groups of one depth are disjoint. So fewer than count / top_limit are open at a time, beside the root, and
 * fewer than count / share_limit of a depth are split, in the top or below it. Each split makes one node and
 * at most one more group below the top. */
static bool allocate(Top *top) {
    size_t open = top->count / top->top_limit + 1;
    size_t nodes = (size_t)(top->count / top->share_limit + 1) * RT_TREE_MEDIAN_DEPTH;
    top->rows[0] = rt_alloc_unset(top->count, sizeof(RtTreeRef));
    top->groups = rt_alloc(open, sizeof(RtRefGroup));
    top->next = rt_alloc(open, sizeof(RtRefGroup));
    top->done = rt_alloc(nodes + 1, sizeof(RtRefGroup));
    top->splits = rt_alloc(open, sizeof(RtSplit));
    top->chunks = rt_alloc_unset(open + top->count / top->chunk_size + 1, sizeof(Chunk));
    top->nodes = rt_alloc(nodes, sizeof(TopNode));
    return top->rows[0] && top->groups && top->next && top->done && top->splits && top->chunks && top->nodes;
}

static void clear(Top *top) {
    rt_free(top->rows[0]);
    rt_free(top->groups);
    rt_free(top->next);
    rt_free(top->done);
    rt_free(top->splits);
    rt_free(top->chunks);
    rt_free(top->nodes);
}

RtStatus rt_tree_topdown(RtTree *tree, const RtBox *boxes, uint32_t count, int bins, int threads,
                         RtError *error) {
    RT_TRY(rt_tree_init(tree, count, error));
    uint32_t workers = (uint32_t)rt_thread_count(threads), share = count / (SHARES * workers);
    bool one = workers == 1 || bins == 0 || count < LARGE;
    RtSubtreeBuilder builder = {tree, bins};
    Top top = {.b = &builder, .boxes = boxes, .count = count};
    top.share_limit = one ? count : share > SMALL ? share : SMALL;
    top.top_limit = count / workers + count / workers / 2;
    if (top.top_limit < top.share_limit) top.top_limit = top.share_limit;
    top.chunk_size = one ? count : CHUNK;
    top.row = one ? 0 : 1; /* so that the groups usually end up in the first row */
    bool enough = allocate(&top);
    top.rows[1] = (RtTreeRef *)tree->nodes;
    tree->used = tree->capacity;
    RtStatus status = !enough ? rt_fail_memory(error, "a tree from the top", count * sizeof(RtTreeRef))
                      : one   ? build_on_one(&top, error)
                              : build_on_several(&top, threads, error);
    clear(&top);
    if (status != RT_OK) rt_tree_clear(tree);
    return status;
}
