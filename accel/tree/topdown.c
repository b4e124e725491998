/* SPDX-License-Identifier: Apache-2.0 */
/* Trees from the top: medians, or the surface area heuristic in bins.
 *
 * Where the nodes of a subtree stand follows from its number of references, so subtrees are built by threads
 * that know nothing of each other (subtree.h). While there is no group for each thread the top is made level
 * by level: the references of all groups are dealt in chunks, which are binned, and then parted into the
 * other of two rows, by whichever thread comes first. From there on a group is split in its place, and one
 * side of it is left to who has nothing to do. Which references go to which side depends on them alone
 * (split.h), so the tree is that of one thread. */
#include "accel/tree/subtree.h"
#include "core/base/memory.h"
#include "core/base/parallel.h"

#include <assert.h>
#include <stdatomic.h>
#include <stdlib.h>

enum {
    SHARES = 64,       /* a group of no more than such a part of what one thread has to do is not shared */
    SMALL = 1 << 11,   /* nor one of no more references */
    CHUNK = 1 << 13,   /* references of a chunk of the top */
    LARGE = 4 * CHUNK, /* fewer in all are for one thread */
};

static_assert(sizeof(RtTreeRef) <= sizeof(RtTreeNode), "references fit into the room of the nodes");

typedef struct TopNode {
    uint32_t node, left; /* references of the left child */
} TopNode;

/* Some references of a group that is being split. */
typedef struct Chunk {
    uint32_t group, first, count; /* refs[first..first + count) of the group's */
    uint32_t to[2];               /* of the group's places, where those of either side go */
    RtBox4 centers[2];            /* of either side */
    RtBins bins;
} Chunk;

typedef struct Top {
    const RtSubtreeBuilder *b;
    const RtBox *boxes;
    RtTreeRef *rows[2]; /* [count] the references, in turns; the second are the nodes, before there are any */
    uint32_t count, row, chunk_size;
    uint32_t top_limit;               /* groups of no more are not of the top; at least share_limit */
    uint32_t share_limit;             /* nor shared */
    RtRefGroup *groups, *next, *done; /* of this level, of the next, and what is left to one thread each */
    RtSplit *splits;                  /* [open] of the groups of this level */
    Chunk *chunks;
    TopNode *nodes; /* parents before their children */
    uint32_t open, next_count, done_count, chunk_count;
    _Atomic uint32_t node_count;
} Top;

/* Deals the references of all open groups. */
static void deal(Top *top) {
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

static RtStatus make_refs(void *context, size_t item, int thread, RtError *error) {
    Top *top = context;
    Chunk *chunk = &top->chunks[item];
    RtTreeRef *refs = top->rows[top->row] + chunk->first;
    (void)thread;
    (void)error;
    for (uint32_t i = 0; i < chunk->count; i++)
        refs[i] = (RtTreeRef){top->boxes[chunk->first + i], chunk->first + i};
    chunk->centers[0] = rt_refs_centers(refs, chunk->count);
    return RT_OK;
}

static RtStatus fill_chunk(void *context, size_t item, int thread, RtError *error) {
    Top *top = context;
    Chunk *chunk = &top->chunks[item];
    const RtRefGroup *group = &top->groups[chunk->group];
    (void)thread;
    (void)error;
    rt_bins_init(&chunk->bins, (uint32_t)top->b->bins, group->centers);
    rt_bins_add(&chunk->bins, group->refs + chunk->first, chunk->count);
    return RT_OK;
}

/* Splits the groups by the bins of all their chunks, which learn where theirs go. */
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

static RtStatus part_chunk(void *context, size_t item, int thread, RtError *error) {
    Top *top = context;
    Chunk *chunk = &top->chunks[item];
    const RtRefGroup *group = &top->groups[chunk->group];
    const RtTreeRef *from = group->refs + chunk->first;
    RtTreeRef *into = top->rows[1 - top->row] + (group->refs - top->rows[top->row]);
    RtSide side = rt_bins_side(&chunk->bins, &top->splits[chunk->group]);
    uint32_t left = chunk->to[0], right = chunk->to[1];
    RtBox4 centers[2] = {rt_box4_empty(), rt_box4_empty()};
    (void)thread;
    (void)error;
    if (!(top->splits[chunk->group].cost < INFINITY)) return RT_OK;
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
    return RT_OK;
}

/* A group is open while it is of the top and can be split by bins. */
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

/* The sides of what was split are the groups of the next level. */
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
        RtTreeRef *refs = into + (group->refs - from);
        add_node(top, group->node, split->left);
        add_group(top, (RtRefGroup){refs, split->left, group->node + 1, group->depth + 1, centers[0]});
        add_group(top, (RtRefGroup){refs + split->left, group->count - split->left,
                                    group->node + 2 * split->left, group->depth + 1, centers[1]});
    }
    RtRefGroup *kept = top->groups;
    top->groups = top->next;
    top->next = kept;
    top->open = top->next_count;
    top->row = 1 - top->row;
}

/* A level's groups are in the row of its turn; the nodes go where the second one is. */
static RtStatus move_back(void *context, size_t item, int thread, RtError *error) {
    Top *top = context;
    RtRefGroup *group = &top->done[item];
    size_t first = (size_t)(group->refs - top->rows[group->depth % 2 == 1 ? 0 : 1]);
    (void)thread;
    (void)error;
    if (group->depth % 2 == 1) return RT_OK;
    memcpy(top->rows[0] + first, group->refs, group->count * sizeof(RtTreeRef));
    group->refs = top->rows[0] + first;
    return RT_OK;
}

/* Splits a group while it is large, and leaves the right sides to others. */
static RtStatus build_group(void *context, RtTasks *tasks, const void *task, RtError *error) {
    Top *top = context;
    RtRefGroup group = *(const RtRefGroup *)task;
    (void)error;
    while (group.count > top->share_limit && group.depth < RT_TREE_MEDIAN_DEPTH) {
        RtBox4 centers[2];
        uint32_t left = rt_split_binned(group.refs, group.count, top->b->bins, group.centers, centers);
        if (left == 0) break;
        RtRefGroup sides[2];
        rt_group_sides(&group, left, centers, sides);
        if (!rt_tasks_add(tasks, &sides[1])) rt_subtree_build(top->b, sides[1]);
        add_node(top, group.node, left);
        group = sides[0];
    }
    rt_subtree_build(top->b, group);
    return RT_OK;
}

/* ---- all of it ---- */

static int larger_first(const void *a, const void *b) {
    const RtRefGroup *x = a, *y = b;
    if (x->count != y->count) return x->count > y->count ? -1 : 1;
    return x->node < y->node ? -1 : x->node > y->node;
}

/* Below comes first: subtrees are runs. */
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
        rt_subtree_unite(top->b, node, left, box);
    }
}

/* The references, and the group of them all. */
static RtStatus begin(Top *top, int threads, RtError *error) {
    top->groups[0] = (RtRefGroup){top->rows[top->row], top->count, 0, 0, rt_box4_empty()};
    top->open = 1;
    deal(top);
    RT_TRY(rt_parallel_for(top->chunk_count, threads, make_refs, top, error));
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
        deal(top);
        RT_TRY(rt_parallel_for(top->chunk_count, threads, fill_chunk, top, error));
        choose_splits(top);
        RT_TRY(rt_parallel_for(top->chunk_count, threads, part_chunk, top, error));
        descend(top);
    }
    RT_TRY(rt_parallel_for(top->done_count, threads, move_back, top, error));
    qsort(top->done, top->done_count, sizeof(RtRefGroup), larger_first);
    RT_TRY(
        rt_parallel_tasks(top->done, top->done_count, sizeof(RtRefGroup), threads, build_group, top, error));
    unite_top(top);
    return RT_OK;
}

/* Groups of one depth have no reference in common. So fewer than count / top_limit are open at a time, beside
 * the root, and fewer than count / share_limit of a depth are split, in the top or below it. Each split makes
 * one node and at most one group more that is done. */
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
    top.row = one ? 0 : 1; /* so that they are in the first row as a rule when the top is done */
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
