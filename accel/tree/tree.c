/* SPDX-License-Identifier: Apache-2.0 */
/* Binary trees of references: orders of objects, the bound on their depth, leaves without
 * nodes, and reductions. */
#include "accel/tree/tree.h"

#include "core/base/parallel.h"

#include <assert.h>
#include <string.h>

RtStatus rt_tree_init(RtTree *tree, uint32_t most, RtError *error) {
    assert(most > 0 && most <= UINT32_MAX / 2);
    *tree = (RtTree){.capacity = 2 * most - 1};
    tree->nodes = rt_alloc_unset(tree->capacity, sizeof(RtTreeNode));
    if (tree->nodes) return RT_OK;
    return rt_fail_memory(error, "a tree of references", tree->capacity * sizeof(RtTreeNode));
}

void rt_tree_clear(RtTree *tree) {
    rt_free(tree->nodes);
    *tree = (RtTree){.nodes = NULL};
}

RtStatus rt_tree_init_leaves(RtTree *tree, const RtBox *boxes, uint32_t count, RtError *error) {
    RT_TRY(rt_tree_init(tree, count, error));
    tree->used = count;
    for (uint32_t i = 0; i < count; i++) rt_tree_set_leaf(tree, i, boxes[i], i);
    return RT_OK;
}

uint32_t rt_tree_take(RtTree *tree) {
    assert(tree->used < tree->capacity);
    return tree->used++;
}

void rt_tree_set_leaf(RtTree *tree, uint32_t node, RtBox box, uint32_t object) {
    tree->nodes[node] = (RtTreeNode){box, {RT_TREE_LEAF, object}};
}

void rt_tree_set_union(RtTree *tree, uint32_t node, uint32_t a, uint32_t b) {
    RtBox box = rt_box_union(tree->nodes[a].box, tree->nodes[b].box);
    tree->nodes[node] = (RtTreeNode){box, {a, b}};
}

uint32_t rt_tree_unite(RtTree *tree, uint32_t a, uint32_t b) {
    tree->root = rt_tree_take(tree);
    rt_tree_set_union(tree, tree->root, a, b);
    return tree->root;
}

double rt_tree_cost(const RtTree *tree) {
    double sum = 0;
    for (uint32_t i = 0; i < tree->used; i++) {
        if (!rt_tree_is_leaf(tree, i)) sum += rt_box_half_area(tree->nodes[i].box);
    }
    return sum;
}

/* ---- references ---- */

RtBox4 rt_refs_centers(const RtTreeRef *refs, uint32_t count) {
    RtBox4 centers = rt_box4_empty();
    for (uint32_t i = 0; i < count; i++)
        centers = rt_box4_add_point(centers, rt_box4_center(rt_box4_load(&refs[i].box)));
    return centers;
}

int rt_longest_axis(RtBox4 box) {
    return rt_major_axis((RtVec3){{box.hi[0] - box.lo[0], box.hi[1] - box.lo[1], box.hi[2] - box.lo[2]}});
}

static bool comes_before(const RtTreeRef *a, const RtTreeRef *b, int axis) {
    float x = rt_box_center(a->box).at[axis], y = rt_box_center(b->box).at[axis];
    return x < y || (x == y && a->id < b->id);
}

/* Quickselect (Hoare 1961): narrows the range that contains the boundary between the halves. */
uint32_t rt_split_median(RtTreeRef *refs, uint32_t count) {
    int axis = rt_longest_axis(rt_refs_centers(refs, count));
    uint32_t half = (count + 1) / 2, first = 0, last = count - 1;
    while (first < half && half <= last) {
        RtTreeRef pivot = refs[first + (last - first) / 2];
        uint32_t i = first, j = last;
        for (;; i++, j--) {
            while (comes_before(&refs[i], &pivot, axis)) i++;
            while (comes_before(&pivot, &refs[j], axis)) j--;
            if (i >= j) break;
            RtTreeRef kept = refs[i];
            refs[i] = refs[j];
            refs[j] = kept;
        }
        /* refs[..j] do not come after the pivot, refs[j + 1..] not before it. */
        if (half <= j)
            last = j;
        else
            first = j + 1;
    }
    return half;
}

/* ---- orders ---- */

/* Sorting boxes by their centres: along the Morton curve (Morton 1966) or along an axis. Radix sort, in
 * linear time; equal keys stay in the order of ids. */

enum { DIGIT_BITS = 8, DIGITS = 1 << DIGIT_BITS, CHUNK = 1 << 14 };

/* The chunks do not affect the order. */
typedef struct Sorter {
    const RtBox *boxes;
    RtBox centers; /* the box of all centres */
    uint32_t bits; /* of a Morton code along each axis; 0: sort along `axis` */
    int axis;
    RtKeyed *items, *out;
    uint32_t count, chunk_size, shift;
    uint32_t (*offsets)[DIGITS]; /* [chunks] the next position of the items of a chunk, by digit */
    RtBox *centers_of;           /* [chunks] */
} Sorter;

static uint32_t chunk_begin(const Sorter *s, size_t chunk) {
    return (uint32_t)chunk * s->chunk_size;
}

static uint32_t chunk_end(const Sorter *s, size_t chunk) {
    uint32_t begin = chunk_begin(s, chunk);
    return s->count - begin < s->chunk_size ? s->count : begin + s->chunk_size;
}

static void find_centers(void *context, size_t chunk) {
    Sorter *s = context;
    RtBox centers = RT_EMPTY_BOX;
    for (uint32_t i = chunk_begin(s, chunk); i < chunk_end(s, chunk); i++)
        centers = rt_box_add_point(centers, rt_box_center(s->boxes[i]));
    s->centers_of[chunk] = centers;
}

static void count_digits(void *context, size_t chunk) {
    Sorter *s = context;
    uint32_t *offset = s->offsets[chunk];
    memset(offset, 0, sizeof *s->offsets);
    for (uint32_t i = chunk_begin(s, chunk); i < chunk_end(s, chunk); i++)
        offset[s->items[i].key >> s->shift & (DIGITS - 1)]++;
}

static void move_items(void *context, size_t chunk) {
    Sorter *s = context;
    uint32_t *offset = s->offsets[chunk];
    for (uint32_t i = chunk_begin(s, chunk); i < chunk_end(s, chunk); i++)
        s->out[offset[s->items[i].key >> s->shift & (DIGITS - 1)]++] = s->items[i];
}

/* Turns counts of digits into positions, digit by digit, then chunk by chunk. False if all items have the
 * same digit. */
static bool find_offsets(Sorter *s, size_t chunks) {
    for (uint32_t digit = 0, begin = 0; digit < DIGITS; digit++) {
        for (size_t c = 0; c < chunks; c++) {
            uint32_t number = s->offsets[c][digit];
            if (number == s->count && chunks == 1) return false;
            s->offsets[c][digit] = begin;
            begin += number;
        }
    }
    return true;
}

/* Sorts the items, whose keys have `bits` bits. */
static RtStatus sort(Sorter *s, uint32_t bits, size_t chunks, int threads, RtError *error) {
    for (s->shift = 0; s->shift < bits; s->shift += DIGIT_BITS) {
        RT_TRY(rt_parallel_each(chunks, threads, count_digits, s, error));
        if (!find_offsets(s, chunks)) continue;
        RT_TRY(rt_parallel_each(chunks, threads, move_items, s, error));
        RtKeyed *kept = s->items;
        s->items = s->out;
        s->out = kept;
    }
    return RT_OK;
}

/* Inserts two zeros after each of 21 bits. */
static uint64_t spread_bits(uint64_t x) {
    x = (x | x << 32) & UINT64_C(0x1f00000000ffff);
    x = (x | x << 16) & UINT64_C(0x1f0000ff0000ff);
    x = (x | x << 8) & UINT64_C(0x100f00f00f00f00f);
    x = (x | x << 4) & UINT64_C(0x10c30c30c30c30c3);
    return (x | x << 2) & UINT64_C(0x1249249249249249);
}

static uint64_t morton_code(RtVec3 center, const RtBox *centers, int cells) {
    uint64_t code = 0;
    for (int a = 0; a < 3; a++) {
        double size = (double)centers->hi.at[a] - (double)centers->lo.at[a];
        double at = (double)center.at[a] - (double)centers->lo.at[a];
        int cell = size > 0 ? (int)(at / size * cells) : 0;
        code |= spread_bits((uint64_t)(cell < cells ? cell : cells - 1)) << a;
    }
    return code;
}

/* Bits whose order as integers is that of the floats. */
static uint32_t ascending_bits(float x) {
    uint32_t bits;
    memcpy(&bits, &x, sizeof bits);
    return bits & UINT32_C(0x80000000) ? ~bits : bits | UINT32_C(0x80000000);
}

static void make_keys(void *context, size_t chunk) {
    Sorter *s = context;
    for (uint32_t i = chunk_begin(s, chunk); i < chunk_end(s, chunk); i++) {
        RtVec3 center = rt_box_center(s->boxes[i]);
        uint64_t key =
            s->bits > 0 ? morton_code(center, &s->centers, 1 << s->bits) : ascending_bits(center.at[s->axis]);
        s->items[i] = (RtKeyed){key, i};
    }
}

RtStatus rt_tree_order(const RtGeometry *geometry, uint32_t bits, int axis, int threads, RtArena *memory,
                       const RtKeyed **order, RtError *error) {
    const uint32_t count = geometry->object_count, share = count / (uint32_t)rt_thread_count(threads) + 1;
    Sorter s = {
        .boxes = geometry->boxes, .centers = RT_EMPTY_BOX, .bits = bits, .axis = axis, .count = count};
    s.chunk_size = share > CHUNK ? share : CHUNK;
    const size_t chunks = count / s.chunk_size + 1;
    s.items = rt_arena_alloc_unset(memory, count, sizeof(RtKeyed));
    s.out = rt_arena_alloc_unset(memory, count, sizeof(RtKeyed));
    s.offsets = rt_arena_alloc(memory, chunks, sizeof *s.offsets);
    s.centers_of = rt_arena_alloc(memory, chunks, sizeof(RtBox));
    RT_TRY(rt_arena_check(memory, "an order of objects", error));
    RT_TRY(rt_parallel_each(chunks, threads, find_centers, &s, error));
    for (size_t c = 0; c < chunks; c++) s.centers = rt_box_union(s.centers, s.centers_of[c]);
    RT_TRY(rt_parallel_each(chunks, threads, make_keys, &s, error));
    RT_TRY(sort(&s, bits > 0 ? 3 * bits : 32, chunks, threads, error));
    rt_arena_free(memory, s.out);
    *order = s.items;
    return RT_OK;
}

/* ---- depth ---- */

/* Whether a leaf is more than `levels` below `node`. */
static bool reaches_below(const RtTree *tree, uint32_t node, uint32_t levels) {
    if (rt_tree_is_leaf(tree, node)) return false;
    if (levels == 0) return true;
    const uint32_t *child = tree->nodes[node].child;
    return reaches_below(tree, child[0], levels - 1) || reaches_below(tree, child[1], levels - 1);
}

/* The nodes of a subtree that is rebuilt. */
typedef struct Rebuild {
    RtTree *tree;
    RtTreeRef *leaves; /* [references] ids are nodes */
    uint32_t *unions;  /* [references] nodes */
    uint32_t leaf_count, union_count;
} Rebuild;

/* `top` is no leaf. */
static void collect(Rebuild *parts, uint32_t top) {
    const RtTree *tree = parts->tree;
    parts->leaf_count = 0;
    parts->union_count = 1;
    parts->unions[0] = top;
    for (uint32_t i = 0; i < parts->union_count; i++) {
        for (int s = 0; s < 2; s++) {
            uint32_t child = tree->nodes[parts->unions[i]].child[s];
            if (rt_tree_is_leaf(tree, child))
                parts->leaves[parts->leaf_count++] = (RtTreeRef){tree->nodes[child].box, child};
            else
                parts->unions[parts->union_count++] = child;
        }
    }
}

/* Rebuilds refs[0..count) by medians; returns the root. */
static uint32_t rebuild(Rebuild *parts, RtTreeRef *refs, uint32_t count) {
    if (count == 1) return refs[0].id;
    uint32_t left = rt_split_median(refs, count);
    uint32_t a = rebuild(parts, refs, left), b = rebuild(parts, refs + left, count - left);
    uint32_t node = parts->unions[--parts->union_count];
    rt_tree_set_union(parts->tree, node, a, b);
    return node;
}

/* Limits the subtree of `node`, which is at `depth`; returns its new root. */
static uint32_t limited(Rebuild *parts, uint32_t node, uint32_t depth) {
    RtTree *tree = parts->tree;
    if (rt_tree_is_leaf(tree, node)) return node;
    if (depth < RT_TREE_MEDIAN_DEPTH) {
        uint32_t *child = tree->nodes[node].child;
        for (int s = 0; s < 2; s++) child[s] = limited(parts, child[s], depth + 1);
        return node;
    }
    if (!reaches_below(tree, node, RT_TREE_MAX_DEPTH - RT_TREE_MEDIAN_DEPTH)) return node;
    collect(parts, node);
    return rebuild(parts, parts->leaves, parts->leaf_count);
}

RtStatus rt_tree_limit_depth(RtTree *tree, RtError *error) {
    if (!reaches_below(tree, tree->root, RT_TREE_MAX_DEPTH)) return RT_OK;
    RT_ARENA(arena);
    uint32_t count = rt_tree_leaf_count(tree);
    Rebuild parts = {.tree = tree,
                     .leaves = rt_arena_alloc(&arena, count, sizeof(RtTreeRef)),
                     .unions = rt_arena_alloc(&arena, count, sizeof(uint32_t))};
    RT_TRY(rt_arena_check(&arena, "limiting the depth of a tree", error));
    tree->root = limited(&parts, tree->root, 0);
    return RT_OK;
}

/* ---- without nodes for leaves ---- */

RtStatus rt_tree_drop_leaves(RtTree *tree, const RtBox *boxes, RtError *error) {
    const uint32_t inner = rt_tree_leaf_count(tree) - 1;
    uint32_t next = 0;
    RT_TRY(rt_tree_limit_depth(tree, error));
    if (tree->split_refs) return RT_OK;
    RT_ARENA(arena);
    uint32_t *moved =
        rt_arena_alloc_unset(&arena, tree->used, sizeof *moved); /* the new number of each node */
    RT_TRY(rt_arena_check(&arena, "the inner nodes of a tree", error));
    RtTreeNode *nodes = rt_alloc_unset(inner, sizeof *nodes);
    if (!nodes) return rt_fail_memory(error, "the inner nodes of a tree", inner * sizeof *nodes);
    for (uint32_t i = 0; i < tree->used; i++)
        moved[i] = rt_tree_is_leaf(tree, i) ? RT_TREE_OBJECT + tree->nodes[i].child[1] : next++;
    for (uint32_t i = 0; i < tree->used; i++) {
        const RtTreeNode *node = &tree->nodes[i];
        if (moved[i] >= RT_TREE_OBJECT) continue;
        nodes[moved[i]] = (RtTreeNode){node->box, {moved[node->child[0]], moved[node->child[1]]}};
    }
    rt_free(tree->nodes);
    *tree = (RtTree){nodes, inner, inner, moved[tree->root], false, boxes};
    return RT_OK;
}

/* ---- reductions ---- */

/* The top is reduced in the order of a depth-first walk, in which the parts are numbered: two values of each
 * level are pending at a time. */
enum { PENDING = 2 * RT_REDUCTION_LEVELS };

typedef struct Job {
    const RtTree *tree;
    const RtReduction *reduction;
    RtReducedParts *parts;
    uint8_t depth[RT_REDUCTION_MAX_PARTS]; /* of each part */
    bool too_deep[RT_REDUCTION_MAX_PARTS]; /* it reaches below RT_TREE_MAX_DEPTH */
    char *pending;                         /* [PENDING] values */
    uint32_t next;                         /* part */
} Job;

static void list_parts(Job *job, uint32_t index, uint32_t depth) {
    if (!rt_reduction_is_top(job->tree, index, depth)) {
        job->depth[job->parts->count] = (uint8_t)depth;
        job->parts->index[job->parts->count++] = index;
        return;
    }
    const uint32_t *child = job->tree->nodes[index].child;
    for (int s = 0; s < 2; s++) list_parts(job, child[s], depth + 1);
}

static void reduce_part(void *context, size_t item) {
    Job *job = context;
    job->too_deep[item] = !job->reduction->reduce(job->reduction->context, job->parts->index[item],
                                                  RT_TREE_MAX_DEPTH - (uint32_t)job->depth[item],
                                                  job->parts->values + item * job->reduction->size);
}

/* Takes the values of the parts in order. */
static void reduce_top(Job *job, uint32_t index, uint32_t depth, void *value) {
    size_t size = job->reduction->size;
    if (!rt_reduction_is_top(job->tree, index, depth)) {
        memcpy(value, job->parts->values + job->next++ * size, size);
        return;
    }
    const uint32_t *child = job->tree->nodes[index].child;
    char *values[2] = {job->pending + (size_t)2 * depth * size,
                       job->pending + ((size_t)2 * depth + 1) * size};
    for (int s = 0; s < 2; s++) reduce_top(job, child[s], depth + 1, values[s]);
    job->reduction->combine(job->reduction->context, index, (const void *const[2]){values[0], values[1]},
                            value);
}

static RtStatus reduce_parts(Job *job, int threads, bool *too_deep, RtError *error) {
    job->parts->count = 0;
    list_parts(job, job->tree->root, 0);
    RT_TRY(rt_parallel_each(job->parts->count, threads, reduce_part, job, error));
    *too_deep = false;
    for (uint32_t i = 0; i < job->parts->count; i++) *too_deep |= job->too_deep[i];
    return RT_OK;
}

RtStatus rt_tree_reduce(RtTree *tree, const RtReduction *reduction, RtArena *memory, int threads,
                        RtReducedParts *parts, void *whole, RtError *error) {
    parts->values = rt_arena_alloc(memory, RT_REDUCTION_MAX_PARTS + PENDING, reduction->size);
    RT_TRY(rt_arena_check(memory, "a reduction over a tree", error));
    Job job = {.tree = tree,
               .reduction = reduction,
               .parts = parts,
               .pending = parts->values + RT_REDUCTION_MAX_PARTS * reduction->size};
    bool too_deep;
    RT_TRY(reduce_parts(&job, threads, &too_deep, error));
    if (too_deep) {
        RT_TRY(rt_tree_limit_depth(tree, error));
        RT_TRY(reduce_parts(&job, threads, &too_deep, error));
    }
    reduce_top(&job, tree->root, 0, whole);
    return RT_OK;
}
