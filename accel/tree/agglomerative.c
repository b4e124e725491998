/* SPDX-License-Identifier: Apache-2.0 */
/* Agglomerative clustering (Walter, Bala, Kulkarni & Pingali 2008): merges the two nearest clusters until one
 * is left.
 *
 * The box of a union and a third cluster is never smaller than that of either part and the third. So two
 * clusters that are each other's nearest can be merged at once: no other merge comes between them, and the
 * tree is the one that always merging the globally nearest pair would make (up to ties). Nearest-neighbour
 * chains find them: from a cluster to its nearest, to that one's nearest and so on, with strictly decreasing
 * distances; a merge leaves the rest of the chain valid, so each step is made once. Chains start at every
 * slot in turn, cyclically, which makes a balanced tree of coincident objects.
 *
 * Exact nearest neighbours in the changing set: every cluster has a slot. Slots are the leaves of a complete
 * binary tree in one array (children of i: 2i and 2i + 1), filled by medians. A union takes the slot of one
 * of its two parts; the other slot becomes empty. A node stores, over the clusters below it, the largest
 * lower corner, the smallest upper corner and the smallest size. The common box of a query and any of these
 * clusters is at least as large as that of the query and these bounds, so the search skips nodes that cannot
 * be nearer. It climbs from the slot of the query to the root and searches the other side of each node on the
 * way, the nearer child first. */
#include "accel/tree/tree.h"
#include "core/base/memory.h"

#define NO_CLUSTER UINT32_MAX

typedef struct Bound {
    RtVec3 lo, hi, size; /* of an empty node: -inf, +inf, +inf, so that it is infinitely far from any query */
} Bound;

typedef struct Neighbours {
    RtTree *tree;
    uint32_t capacity;    /* slots, a power of two */
    Bound *bounds;        /* [2 * capacity]; a slot's is at capacity + slot */
    uint32_t *cluster_at; /* [capacity] by slot, or NO_CLUSTER */
    uint32_t *slot_of;    /* [tree->capacity] by cluster */
} Neighbours;

static void set_slot(Neighbours *self, uint32_t slot, uint32_t cluster) {
    Bound *bound = &self->bounds[self->capacity + slot];
    self->cluster_at[slot] = cluster;
    *bound = (Bound){RT_EMPTY_BOX.hi, RT_EMPTY_BOX.lo, RT_EMPTY_BOX.lo};
    if (cluster == NO_CLUSTER) return;
    const RtBox *box = &self->tree->nodes[cluster].box;
    self->slot_of[cluster] = slot;
    bound->lo = box->lo;
    bound->hi = box->hi;
    for (int a = 0; a < 3; a++)
        bound->size.at[a] = rt_float_below((double)box->hi.at[a] - (double)box->lo.at[a]);
}

static void fit_node(Neighbours *self, uint32_t node) {
    const Bound *a = self->bounds + 2 * (size_t)node, *b = a + 1;
    Bound bound = {rt_vec_max(a->lo, b->lo), rt_vec_min(a->hi, b->hi), rt_vec_min(a->size, b->size)};
    self->bounds[node] = bound;
}

/* Fills slots[first..first + size) by medians; count <= size. */
static void fill_slots(Neighbours *self, RtTreeRef *refs, uint32_t count, uint32_t first, uint32_t size) {
    if (count == 0) return;
    if (count == 1) {
        set_slot(self, first, refs[0].id);
        return;
    }
    uint32_t left = rt_split_median(refs, count);
    fill_slots(self, refs, left, first, size / 2);
    fill_slots(self, refs + left, count - left, first + size / 2, size / 2);
}

/* Gives each reference of the tree, which has no inner nodes yet, a slot. */
static RtStatus init(Neighbours *self, RtTree *tree, RtArena *memory, RtError *error) {
    uint32_t count = tree->used, capacity = 1;
    while (capacity < count) capacity *= 2;
    *self = (Neighbours){.tree = tree,
                         .capacity = capacity,
                         .bounds = rt_arena_alloc(memory, 2 * (size_t)capacity, sizeof(Bound)),
                         .cluster_at = rt_arena_alloc(memory, capacity, sizeof(uint32_t)),
                         .slot_of = rt_arena_alloc(memory, 2 * (size_t)count - 1, sizeof(uint32_t))};
    RtTreeRef *refs = rt_arena_alloc(memory, count, sizeof(RtTreeRef));
    RT_TRY(rt_arena_check(memory, "the neighbours of clusters", error));
    for (uint32_t slot = 0; slot < capacity; slot++) set_slot(self, slot, NO_CLUSTER);
    for (uint32_t i = 0; i < count; i++) refs[i] = (RtTreeRef){tree->nodes[i].box, i};
    fill_slots(self, refs, count, 0, capacity);
    for (uint32_t node = capacity - 1; node > 0; node--) fit_node(self, node);
    rt_arena_free(memory, refs);
    return RT_OK;
}

/* Replaces a and b by `united`, their union. */
static void unite(Neighbours *self, uint32_t a, uint32_t b, uint32_t united) {
    uint32_t slots[2] = {self->slot_of[a], self->slot_of[b]};
    set_slot(self, slots[0], united);
    set_slot(self, slots[1], NO_CLUSTER);
    for (int s = 0; s < 2; s++) {
        for (uint32_t node = (self->capacity + slots[s]) / 2; node > 0; node /= 2) fit_node(self, node);
    }
}

/* A lower bound on the distance of the clusters below `node` from one with box `box`. Rounding is monotone,
 * so it also bounds computed distances. */
static double least_distance(const Neighbours *self, uint32_t node, const RtBox *box) {
    const Bound *bound = &self->bounds[node];
    double size[3];
    for (int a = 0; a < 3; a++) {
        double least = (double)bound->size.at[a];
        size[a] =
            (double)rt_maxf(box->hi.at[a], bound->hi.at[a]) - (double)rt_minf(box->lo.at[a], bound->lo.at[a]);
        size[a] = size[a] > least ? size[a] : least;
    }
    return size[0] * (size[1] + size[2]) + size[1] * size[2];
}

typedef struct Candidate {
    uint32_t node;
    double least;
} Candidate;

/* Improves *best and *distance by the clusters below `top`, for one with box `box`. */
static void search_below(const Neighbours *self, uint32_t top, const RtBox *box, uint32_t *best,
                         double *distance) {
    Candidate stack[34];
    uint32_t stacked = 0;
    stack[stacked++] = (Candidate){top, least_distance(self, top, box)};
    while (stacked > 0) {
        Candidate at = stack[--stacked];
        if (!(at.least < *distance)) continue;
        if (at.node >= self->capacity) {
            *best = self->cluster_at[at.node - self->capacity];
            *distance = rt_box_half_area(rt_box_union(*box, self->tree->nodes[*best].box));
            continue;
        }
        Candidate left = {2 * at.node, least_distance(self, 2 * at.node, box)};
        Candidate right = {2 * at.node + 1, least_distance(self, 2 * at.node + 1, box)};
        bool right_first = right.least < left.least;
        stack[stacked++] = right_first ? left : right;
        stack[stacked++] = right_first ? right : left;
    }
}

/* The cluster nearest to `cluster`, and its *distance. Ties go to the slot in the smallest common subtree.
 * NO_CLUSTER and INFINITY if there is no other. */
static uint32_t find_nearest(const Neighbours *self, uint32_t cluster, double *distance) {
    const RtBox *box = &self->tree->nodes[cluster].box;
    uint32_t best = NO_CLUSTER;
    *distance = INFINITY;
    for (uint32_t node = self->capacity + self->slot_of[cluster]; node > 1; node /= 2)
        search_below(self, node ^ 1, box, &best, distance);
    return best;
}

/* ---- chains ---- */

typedef struct Link {
    uint32_t cluster;
    double distance; /* from the link before */
} Link;

static uint32_t next_start(const Neighbours *neighbours, uint32_t *slot) {
    uint32_t cluster;
    do {
        cluster = neighbours->cluster_at[*slot];
        *slot = *slot + 1 < neighbours->capacity ? *slot + 1 : 0;
    } while (cluster == NO_CLUSTER);
    return cluster;
}

static void unite_all(Neighbours *neighbours, Link *chain) {
    RtTree *tree = neighbours->tree;
    uint32_t length = 0, slot = 0;
    for (uint32_t left = tree->used; left > 1;) {
        if (length == 0) chain[length++] = (Link){next_start(neighbours, &slot), INFINITY};
        double distance;
        const Link *last = &chain[length - 1];
        uint32_t nearest = find_nearest(neighbours, last->cluster, &distance);
        if (distance < last->distance) {
            chain[length++] = (Link){nearest, distance};
            continue;
        }
        uint32_t before = chain[length - 2].cluster;
        unite(neighbours, before, last->cluster, rt_tree_unite(tree, before, last->cluster));
        length -= 2;
        left--;
    }
}

RtStatus rt_tree_agglomerative(RtTree *tree, const RtGeometry *geometry, const RtTreeOptions *options,
                               int threads, RtError *error) {
    RT_ARENA(arena);
    Neighbours neighbours;
    (void)options, (void)threads;
    RT_TRY(rt_tree_init_leaves(tree, geometry->boxes, geometry->object_count, error));
    RT_TRY(init(&neighbours, tree, &arena, error));
    Link *chain = rt_arena_alloc(&arena, (size_t)tree->used + 1, sizeof(Link));
    RT_TRY(rt_arena_check(&arena, "a chain of clusters", error));
    unite_all(&neighbours, chain);
    return RT_OK;
}
