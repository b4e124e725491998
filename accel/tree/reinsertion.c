/* SPDX-License-Identifier: Apache-2.0 */
/* Optimising trees by moving subtrees to where they cost less.
 *
 * Papers: Bittner, Hapala & Havran 2013, "Fast Insertion-Based Optimization of Bounding Volume Hierarchies"
 * (CGF 32(1); the move, the search by branch and bound); Meister & Bittner 2018, "Parallel Reinsertion for
 * Bounding Volume Hierarchy Optimization" (CGF 37(2); all nodes at once, each from its own position).
 *
 * A move removes node N and its parent P, puts N's sibling in P's place, and inserts P, with N, between some
 * node X and X's parent. Its gain is the decrease of the sum of areas of inner nodes. In a round every node
 * searches for its best X in the current tree, in parallel. Then the moves are made one by one, the largest
 * gain first, ties by node, each only if climbing from N and from X shows that it still gains in the tree
 * left by the moves before. So the cost never rises, moves never make a cycle, and the tree does not depend
 * on threads. This replaces the paper's locks, under which moves rely on the gain they had before the others.
 * Boxes are refitted at once, from both ends of the move.
 *
 * Or only the top of the tree is optimised, the nodes with the largest boxes, where most of the cost is: no
 * box is larger than its parent's. It is copied, so that nothing below it is read. The papers choose nodes by
 * another measure of inefficiency, or in a cycle. */
#include "accel/tree/tree.h"

#include "core/base/memory.h"
#include "core/base/parallel.h"

#include <math.h>
#include <stdlib.h>

#define NONE UINT32_MAX

/* Most nodes that a search visits, and that it keeps on its stack: branch and bound prunes nothing among
 * boxes nested in one another. The search ignores the others. */
enum { MAX_VISITS = 1024, MAX_KEPT = 96 };

/* Most nodes that a move climbs. Nested boxes cost least in a chain as deep as their number, which every move
 * would climb; deeper nodes stay where they are. */
enum { MAX_CLIMB = 512 };

/* Nodes per item of parallel work. */
enum { CHUNK = 1024 };

/* The least gain, as a fraction of the area that is moved: more than rounding errors. */
#define LEAST_GAIN 0x1p-30

typedef struct Move {
    double gain;
    uint32_t node, target;
} Move;

typedef struct Optimizer {
    RtTree *tree;
    uint32_t *parent; /* [used], NONE for the root */
    uint32_t *mark;   /* [used] the last move whose N was below this node */
    Move *moves;      /* [used] by node; then those with a gain */
    uint32_t marked;  /* moves tried in this round */
} Optimizer;

static double area_of(const Optimizer *o, uint32_t node) {
    return rt_box_half_area(o->tree->nodes[node].box);
}

static RtBox box_with(const Optimizer *o, uint32_t node, RtBox box) {
    return rt_box_union(o->tree->nodes[node].box, box);
}

static uint32_t sibling(const Optimizer *o, uint32_t node) {
    const uint32_t *child = o->tree->nodes[o->parent[node]].child;
    return child[0] == node ? child[1] : child[0];
}

/* ---- where a node would best be ---- */

typedef struct Search {
    const Optimizer *o;
    RtBox box;   /* of the node to move */
    double area; /* of that box */
    Move best;
    uint32_t visits;
} Search;

typedef struct Kept {
    uint32_t node;
    double left; /* the gain of the removal, minus the growth of the nodes above */
} Kept;

/* Searches `node` and its subtree; `itself` is false if `node` would be the old position. */
static void search_below(Search *s, uint32_t node, double gained, bool itself) {
    const RtTreeNode *nodes = s->o->tree->nodes;
    Kept stack[MAX_KEPT];
    uint32_t kept = 0;
    stack[kept++] = (Kept){node, gained};
    while (kept > 0 && s->visits < MAX_VISITS) {
        Kept at = stack[--kept];
        if (!(at.left - s->area > s->best.gain)) continue;
        s->visits++;
        double with = rt_box_half_area(box_with(s->o, at.node, s->box));
        if (at.left - with > s->best.gain && (itself || at.node != node)) {
            s->best.gain = at.left - with;
            s->best.target = at.node;
        }
        double left = at.left - (with - area_of(s->o, at.node));
        if (rt_tree_is_leaf(s->o->tree, at.node) || kept + 2 > MAX_KEPT) continue;
        if (!(left - s->area > s->best.gain)) continue;
        /* The child that grows less is searched first. */
        const uint32_t *child = nodes[at.node].child;
        double growth[2];
        for (int c = 0; c < 2; c++)
            growth[c] = rt_box_half_area(box_with(s->o, child[c], s->box)) - area_of(s->o, child[c]);
        int first = growth[1] < growth[0];
        stack[kept++] = (Kept){child[1 - first], left};
        stack[kept++] = (Kept){child[first], left};
    }
}

/* Climbs from the node, and searches the sibling of every node on the way. */
static Move find_move(const Optimizer *o, uint32_t node) {
    Search s = {o, o->tree->nodes[node].box, area_of(o, node), {0, node, NONE}, 0};
    uint32_t at = o->parent[node];
    if (at == NONE) return s.best;
    double gained = area_of(o, at);
    s.best.gain = gained * LEAST_GAIN;
    uint32_t beside = sibling(o, node);
    RtBox rest = o->tree->nodes[beside].box; /* of `at` without the node */
    search_below(&s, beside, gained, false);
    for (uint32_t climbed = 0; o->parent[at] != NONE && s.visits < MAX_VISITS && climbed < MAX_CLIMB;
         at = o->parent[at], climbed++) {
        uint32_t above = o->parent[at];
        beside = sibling(o, at);
        search_below(&s, beside, gained, true);
        rest = box_with(o, beside, rest);
        double without = rt_box_half_area(rest);
        /* Insert above `above`: the union of both is the box it had. */
        if (gained - without > s.best.gain) {
            s.best.gain = gained - without;
            s.best.target = above;
        }
        gained += area_of(o, above) - without;
    }
    return s.best;
}

static void find_moves(void *context, size_t item) {
    const Optimizer *o = context;
    uint32_t from = (uint32_t)item * CHUNK, used = o->tree->used;
    for (uint32_t i = from; i < used && i - from < CHUNK; i++) o->moves[i] = find_move(o, i);
}

/* ---- the moves ---- */

/* Marks the nodes from `at` to the root with a new stamp; false if there are too many. */
static bool mark_path(Optimizer *o, uint32_t at) {
    uint32_t stamp = ++o->marked;
    for (uint32_t climbed = 0; at != NONE && climbed < MAX_CLIMB; at = o->parent[at], climbed++)
        o->mark[at] = stamp;
    return at == NONE;
}

/* Whether the move is valid and gains in the current tree. */
static bool still_gains(Optimizer *o, const Move *move) {
    uint32_t node = move->node, target = move->target, p = o->parent[node];
    if (p == NONE || target == p || target == sibling(o, node) || !mark_path(o, p)) return false;
    uint32_t stamp = o->marked, climbed = 0;
    RtBox box = o->tree->nodes[node].box;
    uint32_t common = target;
    double grown = 0;
    for (; o->mark[common] != stamp; common = o->parent[common]) {
        if (common == node || ++climbed > MAX_CLIMB) return false;
        double with = rt_box_half_area(box_with(o, common, box));
        grown += common == target ? with : with - area_of(o, common);
    }
    double gained = area_of(o, p);
    RtBox rest = o->tree->nodes[sibling(o, node)].box;
    for (uint32_t at = p; at != common; at = o->parent[at]) {
        uint32_t above = o->parent[at];
        if (above == common && common != target) break;
        rest = box_with(o, sibling(o, at), rest);
        double without = rt_box_half_area(rest);
        gained += area_of(o, above) - without;
        if (above == target) grown = area_of(o, above);
    }
    return gained - grown > gained * LEAST_GAIN;
}

static void replace_child(Optimizer *o, uint32_t parent, uint32_t from, uint32_t to) {
    o->parent[to] = parent;
    if (parent == NONE) {
        o->tree->root = to;
        return;
    }
    uint32_t *child = o->tree->nodes[parent].child;
    child[child[0] == from ? 0 : 1] = to;
}

static void refit(Optimizer *o, uint32_t node) {
    for (; node != NONE; node = o->parent[node]) {
        RtBox before = o->tree->nodes[node].box;
        const uint32_t *child = o->tree->nodes[node].child;
        rt_tree_set_union(o->tree, node, child[0], child[1]);
        if (rt_box_equals(before, o->tree->nodes[node].box)) return;
    }
}

static void make_move(Optimizer *o, const Move *move) {
    uint32_t node = move->node, target = move->target;
    uint32_t p = o->parent[node], old = o->parent[p];
    replace_child(o, old, p, sibling(o, node));
    replace_child(o, o->parent[target], target, p);
    rt_tree_set_union(o->tree, p, target, node);
    o->parent[target] = p;
    /* The insertion first: then common ancestors do not change twice. */
    refit(o, o->parent[p]);
    refit(o, old);
}

static int by_gain(const void *a, const void *b) {
    const Move *x = a, *y = b;
    if (x->gain != y->gain) return x->gain > y->gain ? -1 : 1;
    return x->node < y->node ? -1 : x->node > y->node;
}

/* Sets *made to the number of moves. */
static RtStatus run_round(Optimizer *o, int threads, uint32_t *made, RtError *error) {
    uint32_t used = o->tree->used, found = 0;
    RT_TRY(rt_parallel_each((used + CHUNK - 1) / CHUNK, threads, find_moves, o, error));
    for (uint32_t i = 0; i < used; i++) {
        o->mark[i] = 0;
        if (o->moves[i].target != NONE) o->moves[found++] = o->moves[i];
    }
    qsort(o->moves, found, sizeof *o->moves, by_gain);
    o->marked = 0;
    *made = 0;
    for (uint32_t i = 0; i < found; i++) {
        if (!still_gains(o, &o->moves[i])) continue;
        make_move(o, &o->moves[i]);
        ++*made;
    }
    return RT_OK;
}

static RtStatus reinsert_all(RtTree *tree, uint32_t rounds, int threads, RtError *error) {
    uint32_t used = tree->used, made = 1;
    RT_TRY(rt_tree_limit_depth(tree, error));
    RT_ARENA(arena);
    Optimizer o = {tree, rt_arena_alloc(&arena, used, sizeof(uint32_t)),
                   rt_arena_alloc(&arena, used, sizeof(uint32_t)), rt_arena_alloc(&arena, used, sizeof(Move)),
                   0};
    RT_TRY(rt_arena_check(&arena, "reinsertion", error));
    o.parent[tree->root] = NONE;
    for (uint32_t i = 0; i < used; i++) {
        const uint32_t *child = tree->nodes[i].child;
        if (!rt_tree_is_leaf(tree, i)) o.parent[child[0]] = o.parent[child[1]] = i;
    }
    for (uint32_t i = 0; made > 0 && i < rounds; i++) RT_TRY(run_round(&o, threads, &made, error));
    return RT_OK;
}

/* ---- the top of a tree ---- */

/* Some nodes of a tree, from the root down, as a tree of its own. Each of its leaves is a subtree. */
typedef struct Top {
    RtTree tree;
    uint32_t *nodes; /* [tree.capacity] in the whole tree */
} Top;

/* Copies the nodes with an area of `least` or more, and their children. Sets *next to the largest area of a
 * leaf that is a subtree, or -1; false if there is not enough room. */
static bool copy_top(Top *top, const RtTree *whole, double least, double *next) {
    top->nodes[0] = whole->root;
    top->tree.used = 1;
    *next = -1;
    for (uint32_t i = 0; i < top->tree.used; i++) {
        const RtTreeNode *node = &whole->nodes[top->nodes[i]];
        const double area = rt_box_half_area(node->box);
        rt_tree_set_leaf(&top->tree, i, node->box, top->nodes[i]);
        if (rt_tree_is_leaf(whole, top->nodes[i])) continue;
        if (area < least) {
            *next = fmax(*next, area);
            continue;
        }
        if (top->tree.used + 2 > top->tree.capacity) return false;
        for (int c = 0; c < 2; c++) {
            const uint32_t child = rt_tree_take(&top->tree);
            top->tree.nodes[i].child[c] = child;
            top->nodes[child] = node->child[c];
        }
    }
    return true;
}

/* Fills the top nearly to its capacity. */
static void fill_top(Top *top, const RtTree *whole) {
    double least = rt_box_half_area(whole->nodes[whole->root].box), next, fits = INFINITY;
    while (copy_top(top, whole, least, &next)) {
        if (next < 0) return;
        fits = least;
        least = 0.75 * next;
    }
    copy_top(top, whole, fits, &next);
}

static uint32_t node_in_whole(const Top *top, uint32_t node) {
    return rt_tree_is_leaf(&top->tree, node) ? top->tree.nodes[node].child[1] : top->nodes[node];
}

static void put_back(const Top *top, RtTree *whole) {
    whole->root = node_in_whole(top, top->tree.root);
    for (uint32_t i = 0; i < top->tree.used; i++) {
        const RtTreeNode *node = &top->tree.nodes[i];
        if (rt_tree_is_leaf(&top->tree, i)) continue;
        whole->nodes[top->nodes[i]] =
            (RtTreeNode){node->box, {node_in_whole(top, node->child[0]), node_in_whole(top, node->child[1])}};
    }
}

RtStatus rt_tree_reinsert(RtTree *tree, uint32_t rounds, double batch, int threads, RtError *error) {
    const uint32_t leaves = (uint32_t)ceil(batch * rt_tree_leaf_count(tree));
    if (rounds == 0) return RT_OK;
    if (leaves == rt_tree_leaf_count(tree)) return reinsert_all(tree, rounds, threads, error);
    RT_ARENA(arena);
    const uint32_t most = 2 * leaves - 1;
    Top top = {.tree = {.nodes = rt_arena_alloc_unset(&arena, most, sizeof(RtTreeNode)), .capacity = most},
               .nodes = rt_arena_alloc_unset(&arena, most, sizeof(uint32_t))};
    RT_TRY(rt_arena_check(&arena, "reinsertion", error));
    fill_top(&top, tree);
    RT_TRY(reinsert_all(&top.tree, rounds, threads, error));
    put_back(&top, tree);
    return RT_OK;
}
