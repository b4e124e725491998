/* SPDX-License-Identifier: Apache-2.0 */
/* Parallel locally-ordered clustering (Meister & Bittner 2018).
 *
 * Clusters form a row, in Morton order of the objects' centres. In each round every cluster finds its nearest
 * neighbour among the `radius` before and after it; two that chose each other are merged in the place of the
 * first. Ties go to the smaller exclusive or of the positions, which is symmetric and differs among the
 * neighbours of a cluster. So the nearest pair of a round is always mutual, every round makes progress, and
 * coincident objects pair up into a balanced tree.
 *
 * The row is divided into chunks. A chunk measures the pairs of its own clusters, and writes its part of the
 * next row behind those of the chunks before it. So merged nodes are numbered in the order of the row, on any
 * thread.
 *
 * Deviation: where distances increase along the row, the nearest of every cluster is the one before it, and
 * only one pair of a round is mutual. After PATIENCE rounds, which suffice for most scenes, a cluster is also
 * merged with its nearest neighbour if that one is free. So there are far fewer rounds than objects, and the
 * time is linear in the objects up to a logarithm. */
#include "accel/tree/tree.h"
#include "core/base/box4.h"
#include "core/base/parallel.h"

enum { PATIENCE = RT_TREE_MAX_DEPTH, CHUNK = 1 << 12 };

typedef struct Cluster {
    RtBox4 box;
    uint32_t node;
} Cluster;

/* The clusters that a chunk leaves, and its merges; later the sums over the chunks before it. */
typedef struct Remaining {
    uint32_t clusters, unions;
} Remaining;

typedef struct Rounds {
    RtTree *tree;
    Cluster *row, *next; /* [count] */
    double *distance;    /* [count] to the nearest */
    uint32_t *nearest;   /* [count] its position in the row */
    Remaining *left;     /* [chunks] */
    uint32_t count, radius;
    const RtKeyed *order; /* the input of the first round */
    const RtBox *boxes;   /* by object */
} Rounds;

static uint32_t chunk_begin(size_t chunk) {
    return (uint32_t)chunk * CHUNK;
}

static uint32_t chunk_end(const Rounds *r, size_t chunk) {
    uint32_t begin = chunk_begin(chunk);
    return r->count - begin < CHUNK ? r->count : begin + CHUNK;
}

static inline void offer(const Rounds *r, uint32_t from, uint32_t place, double distance) {
    double least = r->distance[from];
    if (distance > least || (distance == least && (from ^ place) > (from ^ r->nearest[from]))) return;
    r->distance[from] = distance;
    r->nearest[from] = place;
}

/* Measures cluster i against first..last, two at a time; updates i, or them, or both. Rarely is one nearer
 * than the nearest so far. */
static inline __attribute__((always_inline)) void measure(const Rounds *r, uint32_t i, uint32_t first,
                                                          uint32_t last, bool update_it, bool update_them) {
    RtBox4 own = r->row[i].box;
    for (uint32_t j = first; j <= last; j += 2) {
        uint32_t k = j < last ? j + 1 : j;
        RtDouble2 distances =
            rt_box4_half_areas(rt_box4_union(own, r->row[j].box), rt_box4_union(own, r->row[k].box));
        double its = update_it ? r->distance[i] : -1;
        RtDouble2 known = {its, its};
        if (update_them) known = rt_max(known, ((RtDouble2){r->distance[j], r->distance[k]}));
        if (!rt_le_bits(distances, known)) continue;
        if (update_it) offer(r, i, j, distances[0]);
        if (update_it) offer(r, i, k, distances[1]);
        if (update_them) offer(r, j, i, distances[0]);
        if (update_them) offer(r, k, i, distances[1]);
    }
}

static void find_nearest(void *context, size_t chunk) {
    const Rounds *r = context;
    uint32_t begin = chunk_begin(chunk), end = chunk_end(r, chunk);
    for (uint32_t i = begin; i < end; i++) {
        r->distance[i] = INFINITY;
        r->nearest[i] = UINT32_MAX;
    }
    /* Downward, so that near neighbours, where the nearest usually is, come first. */
    for (uint32_t i = end, lowest = begin > r->radius ? begin - r->radius : 0; i-- > lowest;) {
        uint32_t last = r->count - 1 - i > r->radius ? i + r->radius : r->count - 1;
        uint32_t last_here = last < end ? last : end - 1;
        if (i < begin) {
            measure(r, i, begin, last_here, false, true);
        } else {
            measure(r, i, i + 1, last_here, true, true);
            measure(r, i, end, last, true, false);
        }
    }
}

static bool is_mutual(const uint32_t *nearest, uint32_t i) {
    return nearest[nearest[i]] == i;
}

/* Pairs clusters whose nearest neighbour is still free. */
static void pair_more(uint32_t *nearest, uint32_t count) {
    for (uint32_t i = 0; i < count; i++) {
        uint32_t other = nearest[i];
        if (!is_mutual(nearest, i) && !is_mutual(nearest, other)) nearest[other] = i;
    }
}

static void count_left(void *context, size_t chunk) {
    const Rounds *r = context;
    Remaining left = {0, 0};
    for (uint32_t i = chunk_begin(chunk); i < chunk_end(r, chunk); i++) {
        bool mutual = is_mutual(r->nearest, i), first = r->nearest[i] > i;
        left.clusters += !mutual || first;
        left.unions += mutual && first;
    }
    r->left[chunk] = left;
}

static void unite_pairs(void *context, size_t chunk) {
    const Rounds *r = context;
    Cluster *to = r->next + r->left[chunk].clusters;
    uint32_t node = r->tree->used + r->left[chunk].unions;
    for (uint32_t i = chunk_begin(chunk); i < chunk_end(r, chunk); i++) {
        uint32_t other = r->nearest[i];
        bool mutual = is_mutual(r->nearest, i);
        if (mutual && other < i) continue;
        *to = r->row[i];
        if (mutual) {
            rt_tree_set_union(r->tree, node, r->row[i].node, r->row[other].node);
            *to = (Cluster){rt_box4_load(&r->tree->nodes[node].box), node};
            node++;
        }
        to++;
    }
}

static RtStatus run_round(Rounds *r, uint32_t round, int threads, RtError *error) {
    size_t chunks = (r->count + CHUNK - 1) / CHUNK;
    RT_TRY(rt_parallel_each(chunks, threads, find_nearest, r, error));
    if (round >= PATIENCE) pair_more(r->nearest, r->count);
    RT_TRY(rt_parallel_each(chunks, threads, count_left, r, error));
    Remaining sum = {0, 0};
    for (size_t c = 0; c < chunks; c++) {
        Remaining left = r->left[c];
        r->left[c] = sum;
        sum = (Remaining){sum.clusters + left.clusters, sum.unions + left.unions};
    }
    RT_TRY(rt_parallel_each(chunks, threads, unite_pairs, r, error));
    Cluster *kept = r->row;
    r->row = r->next;
    r->next = kept;
    r->count = sum.clusters;
    r->tree->used += sum.unions;
    r->tree->root = r->tree->used - 1;
    return RT_OK;
}

/* Neighbours in the row are neighbours in memory where possible. */
static void set_leaves(void *context, size_t chunk) {
    const Rounds *r = context;
    for (uint32_t i = chunk_begin(chunk); i < chunk_end(r, chunk); i++) {
        uint32_t id = r->order[i].id;
        rt_tree_set_leaf(r->tree, i, r->boxes[id], id);
        r->row[i] = (Cluster){rt_box4_load(&r->boxes[id]), i};
    }
}

RtStatus rt_tree_ploc(RtTree *tree, const RtGeometry *geometry, const RtTreeOptions *options, int threads,
                      RtError *error) {
    const uint32_t count = geometry->object_count;
    RT_ARENA(arena);
    RT_TRY(rt_tree_init(tree, count, error));
    Rounds r = {.tree = tree,
                .row = rt_arena_alloc_unset(&arena, count, sizeof(Cluster)),
                .next = rt_arena_alloc_unset(&arena, count, sizeof(Cluster)),
                .distance = rt_arena_alloc_unset(&arena, count, sizeof(double)),
                .nearest = rt_arena_alloc_unset(&arena, count, sizeof(uint32_t)),
                .left = rt_arena_alloc(&arena, (size_t)count / CHUNK + 1, sizeof(Remaining)),
                .count = count,
                .radius = options->radius,
                .boxes = geometry->boxes};
    RT_TRY(rt_tree_order(geometry, options->bits, 0, threads, &arena, &r.order, error));
    RT_TRY(rt_parallel_each((count + CHUNK - 1) / CHUNK, threads, set_leaves, &r, error));
    tree->used = count;
    for (uint32_t round = 0; r.count > 1; round++) RT_TRY(run_round(&r, round, threads, error));
    return RT_OK;
}
