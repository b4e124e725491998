/* SPDX-License-Identifier: Apache-2.0 */
/* Trees from the top: by binned SAH, or by medians.
 *
 * A group of references is split by bins of centres; one of few references by all positions between centres,
 * for which it is sorted once along each axis.
 *
 * The position of a node follows from numbers of references, so subtrees are built in parallel. While there
 * are fewer groups than threads, the top is built level by level: the references of all groups are divided
 * into chunks, which threads bin, and then partition into the other of two rows. From there on a group is
 * split in place, and one of its sides becomes a task. The side of a reference depends on the group alone
 * (topdown.h), so the tree does not depend on the number of threads. */
#include "accel/tree/topdown.h"

#include "core/base/memory.h"
#include "core/base/parallel.h"

#include <assert.h>
#include <stdatomic.h>
#include <stdlib.h>

/* ---- bins ---- */

enum { REFS_AHEAD = 32 }; /* prefetch distance, in references, of a sequential read */

typedef struct Bin {
    RtBox4 box;
    uint32_t number; /* of references; the box of an empty bin is empty */
} Bin;

typedef struct Bins {
    RtFloat4 lo, scale,
        last;         /* bin of a centre c: (c - lo) * scale, at most `last`; scale is 0 along an axis */
    uint32_t size[3]; /*   without extent. size: bins along each axis, 1..RT_MAX_BINS */
    Bin bins[3][RT_MAX_BINS];
} Bins;

typedef struct Split {
    double cost; /* INFINITY: no plane separates the centres */
    int axis;
    uint32_t bin, left; /* the bins before `bin` go left; `left` is their number of references */
} Split;

static inline void add_to_bin(Bin *bin, RtBox4 box, uint32_t number) {
    bin->box = rt_box4_union(bin->box, box);
    bin->number += number;
}

/* `count` equal, empty bins along each axis of the box of all centres. */
static void bins_init(Bins *self, uint32_t count, RtBox4 centers) {
    self->lo = centers.lo;
    self->last = rt_all4((float)(count - 1));
    for (int axis = 0; axis < 3; axis++) {
        float lo = centers.lo[axis], hi = centers.hi[axis], scale = (float)count / (hi - lo);
        self->scale[axis] = hi > lo && isfinite(scale) ? scale : 0;
        self->size[axis] = count;
        for (uint32_t i = 0; i < count; i++) self->bins[axis][i] = (Bin){rt_box4_empty(), 0};
    }
    self->lo[3] = self->scale[3] = 0;
}

static void bins_merge(Bins *self, const Bins *other) {
    for (int axis = 0; axis < 3; axis++) {
        for (uint32_t i = 0; i < self->size[axis]; i++)
            add_to_bin(&self->bins[axis][i], other->bins[axis][i].box, other->bins[axis][i].number);
    }
}

/* The bins of BATCH references are all computed before any is filled, so the addresses of the stores are
 * known early and loads of bins need not wait for them: a third less time. */
enum { BATCH = 16 };

static void add_batch(Bins *self, const RtTreeRef *refs, uint32_t count) {
    RtFloat4 lo = self->lo, scale = self->scale, last = self->last;
    RtInt4 bin[BATCH];
    for (uint32_t i = 0; i < count; i++) {
        __builtin_prefetch(refs + i + REFS_AHEAD);
        /* max(NaN, 0) is 0, for infinity times 0. */
        RtFloat4 at = rt_max((rt_box4_center(rt_box4_load(&refs[i].box)) - lo) * scale, rt_all4(0));
        bin[i] = rt_to_ints4(rt_min(at, last));
    }
    for (uint32_t i = 0; i < count; i++) {
        RtBox4 box = rt_box4_load(&refs[i].box);
        for (int axis = 0; axis < 3; axis++) add_to_bin(&self->bins[axis][(uint32_t)bin[i][axis]], box, 1);
    }
}

static void bins_add(Bins *self, const RtTreeRef *refs, uint32_t count) {
    for (; count > BATCH; refs += BATCH, count -= BATCH) add_batch(self, refs, BATCH);
    add_batch(self, refs, count);
}

/* Improves *best by the splits between the bins of one axis, which hold `count` references in all. */
static void try_bins(const Bin *bins, uint32_t size, int axis, uint32_t count, Split *best) {
    RtBox4 right[RT_MAX_BINS], box = rt_box4_empty();
    for (uint32_t i = size; i-- > 1;) right[i] = box = rt_box4_union(box, bins[i].box);
    box = bins[0].box;
    uint32_t left = bins[0].number, least_left = 0, least_bin = 0;
    double least = best->cost;
    for (uint32_t i = 1; i < size; i++) {
        RtDouble2 costs = rt_box4_half_areas(box, right[i]) * (RtDouble2){left, count - left};
        double cost = costs[0] + costs[1];
        bool better = (cost < least) & (left > 0) & (left < count); /* unpredictable */
        least = better ? cost : least;
        least_bin = better ? i : least_bin;
        least_left = better ? left : least_left;
        box = rt_box4_union(box, bins[i].box);
        left += bins[i].number;
    }
    if (least_bin > 0) *best = (Split){least, axis, least_bin, least_left};
}

/* The cheapest split of all `count` references. Ties go to the lower axis, then to the lower bin. */
static Split bins_split(const Bins *self, uint32_t count) {
    Split best = {.cost = INFINITY};
    for (int axis = 0; axis < 3; axis++) try_bins(self->bins[axis], self->size[axis], axis, count, &best);
    return best;
}

/* Classifies centres by the side of a split. */
typedef struct Side {
    RtFloat4 lo, scale, least;
    unsigned mask;
} Side;

static inline Side bins_side(const Bins *self, const Split *split) {
    return (Side){self->lo, self->scale, rt_all4((float)split->bin), 1U << split->axis};
}

/* 1: right, 0: left. */
static inline uint32_t side_of(const Side *side, RtFloat4 center) {
    unsigned right = rt_le_bits(side->least, (center - side->lo) * side->scale);
    return (right & side->mask) != 0;
}

/* ---- small groups ---- */

/* At most RT_MAX_BINS references, sorted once along each axis. Every position between centres is tried, as if
 * each centre had a bin of its own; partitioning keeps the order. */
typedef struct SmallGroup {
    const RtTreeRef *refs;         /* borrowed, not moved */
    float at[3][RT_MAX_BINS];      /* the centre of each along an axis */
    uint8_t order[3][RT_MAX_BINS]; /* indices, in ascending order of centres along an axis */
} SmallGroup;

/* Sorts indices by `at`, then by index, by counting for each how many come before it: branchless, four at a
 * time; at[count..) up to a multiple of 4 may hold anything. */
static void sort_axis(const float *at, uint32_t count, uint8_t *order) {
    for (uint32_t i = 0; i < count; i += 4) {
        RtFloat4 self;
        RtInt4 before = {0, 0, 0, 0};
        memcpy(&self, at + i, sizeof self);
        for (uint32_t j = 0; j < i; j++) before -= rt_all4(at[j]) <= self;
        for (uint32_t j = i; j < count; j++) before -= rt_all4(at[j]) < self;
        for (uint32_t s = 0; s < 4 && i + s < count; s++) {
            uint32_t place = (uint32_t)before[s];
            for (uint32_t j = i; j < i + s; j++) place += at[j] == at[i + s];
            order[place] = (uint8_t)(i + s);
        }
    }
}

/* Sorts refs[0..count), 1..RT_MAX_BINS of them. */
static void small_group_init(SmallGroup *self, const RtTreeRef *refs, uint32_t count) {
    self->refs = refs;
    for (uint32_t i = 0; i < count; i++) {
        RtFloat4 center = rt_box4_center(rt_box4_load(&refs[i].box));
        for (int axis = 0; axis < 3; axis++) self->at[axis][i] = center[axis];
    }
    for (uint32_t i = count; i % 4 != 0; i++) {
        for (int axis = 0; axis < 3; axis++) self->at[axis][i] = 0;
    }
    for (int axis = 0; axis < 3; axis++) sort_axis(self->at[axis], count, self->order[axis]);
}

/* One bin for each distinct centre, in order along an axis; returns their number. */
static uint32_t fill_bins(const SmallGroup *self, int axis, uint32_t begin, uint32_t count, Bin *bins) {
    const uint8_t *order = self->order[axis] + begin;
    const float *at = self->at[axis];
    uint32_t size = 0;
    for (uint32_t i = 0; i < count; i++) {
        RtBox4 box = rt_box4_load(&self->refs[order[i]].box);
        if (i > 0 && at[order[i]] == at[order[i - 1]])
            add_to_bin(&bins[size - 1], box, 1);
        else
            bins[size++] = (Bin){box, 1};
    }
    return size;
}

/* Two references cost the same along all axes. */
static Split split_two(const SmallGroup *self, uint32_t begin) {
    uint32_t a = self->order[0][begin], b = self->order[0][begin + 1];
    RtDouble2 areas = rt_box4_half_areas(rt_box4_load(&self->refs[a].box), rt_box4_load(&self->refs[b].box));
    int axis = 0;
    while (axis < 3 && self->at[axis][a] == self->at[axis][b]) axis++;
    return (Split){axis < 3 ? areas[0] + areas[1] : INFINITY, axis, 1, 1};
}

/* The cheapest split of order[...][begin..begin + count), the same references along all axes. The left side
 * is the first `left` in the order of the split's axis. */
static Split small_group_split(const SmallGroup *self, uint32_t begin, uint32_t count) {
    Split best = {.cost = INFINITY};
    if (count == 2) return split_two(self, begin);
    for (int axis = 0; axis < 3; axis++) {
        Bin bins[RT_MAX_BINS];
        uint32_t size = fill_bins(self, axis, begin, count, bins);
        try_bins(bins, size, axis, count, &best);
    }
    return best;
}

static void small_group_partition(SmallGroup *self, uint32_t begin, uint32_t count, const Split *split) {
    uint64_t is_left = 0;
    if (count == 2) { /* each side is one reference: the first order suffices */
        memcpy(self->order[0] + begin, self->order[split->axis] + begin, 2);
        return;
    }
    for (uint32_t i = 0; i < split->left; i++) is_left |= UINT64_C(1) << self->order[split->axis][begin + i];
    for (int axis = 0; axis < 3; axis++) {
        uint8_t *order = self->order[axis] + begin, right[RT_MAX_BINS];
        uint32_t left = 0;
        for (uint32_t i = 0; i < count; i++) {
            uint8_t ref = order[i];
            right[i - left] = ref;
            order[left] = ref;
            left += (uint32_t)(is_left >> ref & 1);
        }
        memcpy(order + left, right, count - left);
    }
}

/* ---- whole groups ---- */

static uint32_t split_small(RtTreeRef *refs, uint32_t count, RtBox4 centers_of[2]) {
    RtTreeRef kept[RT_MAX_BINS];
    SmallGroup group;
    small_group_init(&group, refs, count);
    Split split = small_group_split(&group, 0, count);
    if (!(split.cost < INFINITY)) return 0;
    for (uint32_t i = 0; i < count; i++) kept[i] = refs[group.order[split.axis][i]];
    memcpy(refs, kept, count * sizeof(RtTreeRef));
    centers_of[0] = rt_refs_centers(refs, split.left);
    centers_of[1] = rt_refs_centers(refs + split.left, count - split.left);
    return split.left;
}

uint32_t rt_split_binned(RtTreeRef *refs, uint32_t count, int bins, RtBox4 centers, RtBox4 centers_of[2]) {
    const uint32_t own_bins = rt_bin_count(bins, count);
    if (count <= own_bins) return split_small(refs, count, centers_of);
    Bins b;
    bins_init(&b, own_bins, centers);
    bins_add(&b, refs, count);
    Split split = bins_split(&b, count);
    if (!(split.cost < INFINITY)) return 0;
    Side side = bins_side(&b, &split);
    uint32_t left = 0;
    RtBox4 sides[2] = {rt_box4_empty(), rt_box4_empty()};
    for (uint32_t i = 0; i < count; i++) {
        __builtin_prefetch(refs + i + REFS_AHEAD);
        /* refs[left..i) are right: swap the first of them with this one, whichever side this is on. */
        RtFloat4 center = rt_box4_center(rt_box4_load(&refs[i].box));
        RtTreeRef ref = refs[i];
        uint32_t right = side_of(&side, center);
        sides[right] = rt_box4_add_point(sides[right], center);
        refs[i] = refs[left];
        refs[left] = ref;
        left += 1 - right;
    }
    memcpy(centers_of, sides, sizeof sides);
    return left;
}

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
static RtBox4 build_small(const RtSubtreeBuilder *b, SmallGroup *small, uint32_t begin, uint32_t count,
                          uint32_t node, int depth) {
    if (count == 1) return set_leaf(b, node, &small->refs[small->order[0][begin]]);
    Split split = {.cost = INFINITY};
    if (depth < RT_TREE_MEDIAN_DEPTH) split = small_group_split(small, begin, count);
    if (!(split.cost < INFINITY)) {
        RtTreeRef refs[RT_MAX_BINS];
        for (uint32_t i = 0; i < count; i++) refs[i] = small->refs[small->order[0][begin + i]];
        RtRefGroup group = {refs, count, node, depth, rt_box4_empty()};
        return build_at_median(b, &group);
    }
    small_group_partition(small, begin, count, &split);
    RtBox4 box[2] = {
        build_small(b, small, begin, split.left, node + 1, depth + 1),
        build_small(b, small, begin + split.left, count - split.left, node + 2 * split.left, depth + 1)};
    return unite(b, node, split.left, box);
}

RtBox4 rt_subtree_build(const RtSubtreeBuilder *b, RtRefGroup group) {
    if (group.count == 1) return set_leaf(b, group.node, group.refs);
    if (b->bins == 0 || group.depth >= RT_TREE_MEDIAN_DEPTH) return build_at_median(b, &group);
    if (group.count <= rt_bin_count(b->bins, group.count)) {
        SmallGroup small;
        small_group_init(&small, group.refs, group.count);
        return build_small(b, &small, 0, group.count, group.node, group.depth);
    }
    RtBox4 centers[2];
    uint32_t left = rt_split_binned(group.refs, group.count, b->bins, group.centers, centers);
    return left > 0 ? build_sides(b, &group, left, centers) : build_at_median(b, &group);
}

/* ---- on all threads ---- */

enum {
    SHARES = 64,     /* a group is one task if it is at most this fraction of a thread's share ... */
    SMALL = 1 << 11, /* ... or has at most so many references */
    CHUNK = 1 << 13, /* references of a chunk of the top */
    LARGE = CHUNK,   /* fewer references in all are built on one thread */
};

static_assert(sizeof(RtTreeRef) <= sizeof(RtTreeNode), "references fit into the room of the nodes");

typedef struct TopNode {
    uint32_t node, left; /* references of the left child */
} TopNode;

typedef struct OpenGroup OpenGroup;

/* Some references of a group that is being split. */
typedef struct Chunk {
    OpenGroup *of;
    uint32_t first, count; /* refs[first..first + count) of the group's */
    uint32_t to[2];        /* where those of either side go in the group */
    RtBox4 centers[2];     /* of either side */
    Bins bins;
} Chunk;

struct OpenGroup {
    RtRefGroup group;
    Split split;
    Chunk *chunks, *end;
};

typedef struct Top {
    const RtSubtreeBuilder *b;
    const RtBox *boxes;
    RtTreeRef *rows[2]; /* [count] the references, alternating; the second is the memory of the nodes */
    uint32_t count, row;
    uint32_t top_limit;       /* larger groups belong to the top; at least share_limit */
    uint32_t share_limit;     /* larger groups are shared among threads */
    OpenGroup *groups, *next; /* of this level, and of the next */
    RtRefGroup *done;         /* below the top */
    Chunk *chunks;
    TopNode *nodes; /* parents before their children */
    uint32_t open, next_count, done_count, chunk_count;
    _Atomic uint32_t node_count;
} Top;

static void make_chunks(Top *top) {
    Chunk *next = top->chunks;
    for (OpenGroup *g = top->groups; g < top->groups + top->open; g++) {
        g->chunks = next;
        for (uint32_t first = 0; first < g->group.count; first += CHUNK, next++) {
            next->of = g;
            next->first = first;
            next->count = g->group.count - first < CHUNK ? g->group.count - first : CHUNK;
        }
        g->end = next;
    }
    top->chunk_count = (uint32_t)(next - top->chunks);
}

static void make_refs(void *context, size_t item) {
    Top *top = context;
    Chunk *chunk = &top->chunks[item];
    RtTreeRef *refs = chunk->of->group.refs + chunk->first;
    for (uint32_t i = 0; i < chunk->count; i++)
        refs[i] = (RtTreeRef){top->boxes[chunk->first + i], chunk->first + i};
    chunk->centers[0] = rt_refs_centers(refs, chunk->count);
}

static void fill_chunk(void *context, size_t item) {
    Top *top = context;
    Chunk *chunk = &top->chunks[item];
    const RtRefGroup *group = &chunk->of->group;
    bins_init(&chunk->bins, (uint32_t)top->b->bins, group->centers);
    bins_add(&chunk->bins, group->refs + chunk->first, chunk->count);
}

/* Splits a group by the bins of all its chunks, and computes where the references of each chunk go. */
static void choose_split(OpenGroup *g) {
    Bins all = g->chunks->bins;
    for (const Chunk *chunk = g->chunks + 1; chunk < g->end; chunk++) bins_merge(&all, &chunk->bins);
    const Split split = g->split = bins_split(&all, g->group.count);
    uint32_t to[2] = {0, split.left};
    for (Chunk *chunk = g->chunks; chunk < g->end; chunk++) {
        uint32_t left = 0;
        for (uint32_t i = 0; i < split.bin; i++) left += chunk->bins.bins[split.axis][i].number;
        memcpy(chunk->to, to, sizeof to);
        to[0] += left;
        to[1] += chunk->count - left;
    }
}

static void partition_chunk(void *context, size_t item) {
    Top *top = context;
    Chunk *chunk = &top->chunks[item];
    const RtRefGroup *group = &chunk->of->group;
    const RtTreeRef *from = group->refs + chunk->first;
    RtTreeRef *into = top->rows[1 - top->row] + (group->refs - top->rows[top->row]);
    Side side = bins_side(&chunk->bins, &chunk->of->split);
    uint32_t left = chunk->to[0], right = chunk->to[1];
    RtBox4 centers[2] = {rt_box4_empty(), rt_box4_empty()};
    if (!(chunk->of->split.cost < INFINITY)) return;
    for (uint32_t i = 0; i < chunk->count; i++) {
        __builtin_prefetch(from + i + REFS_AHEAD);
        RtFloat4 center = rt_box4_center(rt_box4_load(&from[i].box));
        uint32_t s = side_of(&side, center);
        centers[s] = rt_box4_add_point(centers[s], center);
        into[s ? right : left] = from[i];
        left += 1 - s;
        right += s;
    }
    memcpy(chunk->centers, centers, sizeof centers);
}

static void add_node(Top *top, uint32_t node, uint32_t left) {
    top->nodes[atomic_fetch_add(&top->node_count, 1)] = (TopNode){node, left};
}

/* The sides of a group that was split are groups of the next level while they belong to the top and are split
 * by bins. */
static void descend(Top *top, const OpenGroup *g) {
    RtBox4 centers[2] = {rt_box4_empty(), rt_box4_empty()};
    RtRefGroup sides[2], moved = g->group;
    if (!(g->split.cost < INFINITY)) {
        top->done[top->done_count++] = g->group;
        return;
    }
    for (const Chunk *chunk = g->chunks; chunk < g->end; chunk++) {
        for (int s = 0; s < 2; s++) centers[s] = rt_box4_union(centers[s], chunk->centers[s]);
    }
    moved.refs = top->rows[1 - top->row] + (moved.refs - top->rows[top->row]);
    get_sides(&moved, g->split.left, centers, sides);
    add_node(top, g->group.node, g->split.left);
    for (int s = 0; s < 2; s++) {
        if (sides[s].count > top->top_limit && sides[s].depth < RT_TREE_MEDIAN_DEPTH)
            top->next[top->next_count++].group = sides[s];
        else
            top->done[top->done_count++] = sides[s];
    }
}

static RtStatus split_level(Top *top, int threads, RtError *error) {
    make_chunks(top);
    RT_TRY(rt_parallel_each(top->chunk_count, threads, fill_chunk, top, error));
    for (uint32_t g = 0; g < top->open; g++) choose_split(&top->groups[g]);
    RT_TRY(rt_parallel_each(top->chunk_count, threads, partition_chunk, top, error));
    top->next_count = 0;
    for (uint32_t g = 0; g < top->open; g++) descend(top, &top->groups[g]);
    OpenGroup *kept = top->groups;
    top->groups = top->next;
    top->next = kept;
    top->open = top->next_count;
    top->row = 1 - top->row;
    return RT_OK;
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

/* Groups of one depth are disjoint. So fewer than count / top_limit are open at a time, beside the root, and
 * fewer than count / share_limit of a depth are split, in the top or below it. Each split makes one node and
 * at most one more group below the top. */
static void allocate(Top *top, RtArena *arena) {
    size_t open = top->count / top->top_limit + 1;
    size_t nodes = (size_t)(top->count / top->share_limit + 1) * RT_TREE_MEDIAN_DEPTH;
    top->rows[0] = rt_arena_alloc_unset(arena, top->count, sizeof(RtTreeRef));
    top->groups = rt_arena_alloc(arena, open, sizeof(OpenGroup));
    top->next = rt_arena_alloc(arena, open, sizeof(OpenGroup));
    top->done = rt_arena_alloc(arena, nodes + 1, sizeof(RtRefGroup));
    top->chunks = rt_arena_alloc_unset(arena, open + top->count / CHUNK + 1, sizeof(Chunk));
    top->nodes = rt_arena_alloc(arena, nodes, sizeof(TopNode));
}

static RtStatus build_on_several(const RtSubtreeBuilder *b, const RtGeometry *geometry, int threads,
                                 RtError *error) {
    const uint32_t count = geometry->object_count, workers = (uint32_t)rt_thread_count(threads);
    const uint32_t share = count / (SHARES * workers), even = count / workers + count / workers / 2;
    RT_ARENA(arena);
    Top top = {.b = b, .boxes = geometry->boxes, .count = count, .open = 1};
    top.share_limit = share > SMALL ? share : SMALL;
    top.top_limit = even > top.share_limit ? even : top.share_limit;
    allocate(&top, &arena);
    RT_TRY(rt_arena_check(&arena, "a tree from the top", error));
    top.rows[1] = (RtTreeRef *)b->tree->nodes;
    top.row = 1; /* so that the groups usually end up in the first row */
    RtRefGroup *root = &top.groups[0].group;
    *root = (RtRefGroup){top.rows[1], count, 0, 0, rt_box4_empty()};
    make_chunks(&top);
    RT_TRY(rt_parallel_each(top.chunk_count, threads, make_refs, &top, error));
    for (uint32_t c = 0; c < top.chunk_count; c++)
        root->centers = rt_box4_union(root->centers, top.chunks[c].centers[0]);
    while (top.open > 0) RT_TRY(split_level(&top, threads, error));
    RT_TRY(rt_parallel_each(top.done_count, threads, move_back, &top, error));
    qsort(top.done, top.done_count, sizeof(RtRefGroup), larger_first);
    RT_TRY(
        rt_parallel_tasks(top.done, top.done_count, sizeof(RtRefGroup), threads, build_group, &top, error));
    unite_top(&top);
    return RT_OK;
}

RtStatus rt_tree_topdown(RtTree *tree, const RtGeometry *geometry, const RtTreeOptions *options, int threads,
                         RtError *error) {
    const uint32_t count = geometry->object_count;
    const RtSubtreeBuilder b = {tree, options->method == RT_TREE_MEDIAN ? 0 : options->spatial.bins};
    RT_TRY(rt_tree_init(tree, count, error));
    tree->used = tree->capacity;
    if (rt_thread_count(threads) > 1 && b.bins > 0 && count >= LARGE)
        return build_on_several(&b, geometry, threads, error);
    RT_ARENA(arena);
    RtTreeRef *refs = rt_arena_alloc_unset(&arena, count, sizeof(RtTreeRef));
    RT_TRY(rt_arena_check(&arena, "a tree from the top", error));
    for (uint32_t i = 0; i < count; i++) refs[i] = (RtTreeRef){geometry->boxes[i], i};
    rt_subtree_build(&b, (RtRefGroup){refs, count, 0, 0, rt_refs_centers(refs, count)});
    return RT_OK;
}
