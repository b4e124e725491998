/* SPDX-License-Identifier: Apache-2.0 */
/* Insertion (Goldsmith & Salmon 1987): objects come one by one, and each is merged with the node that makes
 * the sum of all areas grow least. Branch and bound finds it: any position below a node costs at least the
 * growth of its ancestors plus the area of the object.
 *
 * The result depends on the order of insertion, so several permutations can be tried; the cheapest tree is
 * kept. The search goes no deeper than the depth limit of trees, which bounds the cost of an insertion in an
 * unlucky order. */
#include "accel/tree/tree.h"

#include "core/base/memory.h"
#include "core/base/random.h"

typedef struct Insertion {
    RtTree *tree;
    uint32_t *parent; /* [2 * count - 1] */
    uint32_t *order;  /* [count] permutation of the objects */
    uint32_t count;
} Insertion;

typedef struct Candidate {
    uint32_t node, depth;
    double inherited; /* growth of the areas of its ancestors */
} Candidate;

static double area_with(const RtTree *tree, uint32_t cluster, const RtBox *box) {
    return rt_box_half_area(rt_box_union(tree->nodes[cluster].box, *box));
}

static uint32_t find_sibling(const RtTree *tree, const RtBox *box) {
    Candidate stack[RT_TREE_MAX_DEPTH + 2];
    uint32_t stacked = 0, sibling = tree->root;
    double own = rt_box_half_area(*box), best = INFINITY;
    stack[stacked++] = (Candidate){tree->root, 0, 0};
    while (stacked > 0) {
        Candidate at = stack[--stacked];
        if (!(at.inherited + own < best)) continue;
        const RtTreeNode *node = &tree->nodes[at.node];
        double area = area_with(tree, at.node, box);
        if (at.inherited + area < best) {
            best = at.inherited + area;
            sibling = at.node;
        }
        if (rt_tree_is_leaf(tree, at.node) || at.depth == RT_TREE_MAX_DEPTH) continue;
        double inherited = at.inherited + area - rt_box_half_area(node->box);
        bool second = area_with(tree, node->child[1], box) < area_with(tree, node->child[0], box);
        stack[stacked++] = (Candidate){node->child[!second], at.depth + 1, inherited};
        stack[stacked++] = (Candidate){node->child[second], at.depth + 1, inherited};
    }
    return sibling;
}

static void insert(Insertion *insertion, uint32_t object) {
    RtTree *tree = insertion->tree;
    uint32_t *parent = insertion->parent, root = tree->root;
    const RtBox *box = &tree->nodes[object].box;
    uint32_t sibling = find_sibling(tree, box), above = parent[sibling];
    uint32_t united = rt_tree_unite(tree, sibling, object);
    parent[united] = above;
    parent[sibling] = parent[object] = united;
    if (sibling == root) return;
    tree->root = root;
    uint32_t *child = tree->nodes[above].child;
    child[child[1] == sibling] = united;
    for (uint32_t at = above;; at = parent[at]) {
        tree->nodes[at].box = rt_box_union(tree->nodes[at].box, *box);
        if (at == root) return;
    }
}

static void shuffle(uint32_t *order, uint32_t count, uint64_t seed, uint32_t stream) {
    RtRandom random = rt_random(seed, stream);
    for (uint32_t i = count; i > 1; i--) {
        uint32_t j = (uint32_t)((uint64_t)rt_random_bits(&random) * i >> 32), kept = order[i - 1];
        order[i - 1] = order[j];
        order[j] = kept;
    }
}

static void build_once(Insertion *insertion, const RtTreeOptions *options, uint32_t attempt) {
    RtTree *tree = insertion->tree;
    uint32_t count = insertion->count;
    for (uint32_t i = 0; i < count; i++) insertion->order[i] = i;
    if (options->insertion.random || attempt > 0)
        shuffle(insertion->order, count, options->insertion.seed, attempt);
    tree->used = count;
    tree->root = insertion->order[0];
    for (uint32_t i = 1; i < count; i++) insert(insertion, insertion->order[i]);
}

RtStatus rt_tree_insertion(RtTree *tree, const RtGeometry *geometry, const RtTreeOptions *options,
                           int threads, RtError *error) {
    const uint32_t count = geometry->object_count, attempts = options->insertion.permutations;
    RT_ARENA(arena);
    RtTree spare = {.nodes = NULL};
    (void)threads;
    RT_TRY(rt_tree_init_leaves(tree, geometry->boxes, count, error));
    Insertion insertion = {tree, rt_arena_alloc(&arena, tree->capacity, sizeof(uint32_t)),
                           rt_arena_alloc(&arena, count, sizeof(uint32_t)), count};
    RT_TRY(rt_arena_check(&arena, "a tree by insertion", error));
    if (attempts > 1) RT_TRY(rt_tree_init_leaves(&spare, geometry->boxes, count, error));
    build_once(&insertion, options, 0);
    double best = rt_tree_cost(tree);
    insertion.tree = &spare;
    for (uint32_t attempt = 1; attempt < attempts; attempt++) {
        build_once(&insertion, options, attempt);
        double cost = rt_tree_cost(&spare);
        if (!(cost < best)) continue;
        RtTree kept = *tree;
        *tree = spare;
        spare = kept;
        best = cost;
    }
    rt_tree_clear(&spare);
    return RT_OK;
}
