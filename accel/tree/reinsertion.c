/* SPDX-License-Identifier: Apache-2.0 */
/* Better trees by moving subtrees to where they cost less.
 *
 * Papers: Bittner, Hapala & Havran 2013, "Fast Insertion-Based Optimization of Bounding Volume Hierarchies"
 * (CGF 32(1); the move, the search by branch and bound); Meister & Bittner 2018, "Parallel Reinsertion for
 * Bounding Volume Hierarchy Optimization" (CGF 37(2); every node at once, from where it stands).
 *
 * A move takes node N from its parent P, puts N's sibling into P's place, and P, with N, between some node X
 * and X's parent. It gains what the areas of inner nodes lose in all. In a round every node looks for its
 * best X in the tree as it stands, on all threads. Then the moves are made one by one, those that gain most
 * first, equal ones by node: each only if it still gains in the tree as the moves before have left it, which
 * is told by going up from N and from X. So the cost never rises, moves never close a circle, and the tree
 * does not depend on threads. This stands for the paper's locks, under which moves go by what they gained
 * before the others. Boxes are refitted at once, from both ends of the move.
 *
 * Left out: cyclic choice of a part of the nodes. */
#include "accel/tree/tree.h"

#include "core/base/memory.h"
#include "core/base/parallel.h"

#include <assert.h>
#include <stdlib.h>

#define NONE UINT32_MAX

/* Nodes that a search looks at, and that it keeps for later, at most: boxes that all lie in one another leave
 * branch and bound nothing to go by. What is beyond is not looked at. */
enum { MAX_VISITS = 1024, MAX_KEPT = 96 };

/* Nodes that a move climbs, at most. Such boxes cost least in a chain as deep as they are many, along which
 * every move would climb: what stands lower stays where it is. */
enum { MAX_CLIMB = 512 };

/* Nodes per item of parallel work. */
enum { CHUNK = 1024 };

/* A gain must be more than rounding could make of none, as a part of the area that is moved. */
#define LEAST_GAIN 0x1p-30

typedef struct Move {
    double gain;
    uint32_t node, target;
} Move;

typedef struct Optimizer {
    RtTree *tree;
    uint32_t *parent; /* [used], NONE for the root */
    uint32_t *mark;   /* [used] number of the last move that had the node above its N */
    Move *moves;      /* [used] by node; then those that gain, in a row */
    uint32_t marked;  /* moves tried so far in this round */
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
    RtBox box;   /* of the node that is to move */
    double area; /* its */
    Move best;
    uint32_t visits;
} Search;

typedef struct Kept {
    uint32_t node;
    double left; /* what taking the node away gains, less what the nodes above this one have grown */
} Kept;

/* Offers `node` and what is below to the search; `itself` is false where the node would only come back to
 * where it is. */
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
        /* On top the child that would grow less. */
        const uint32_t *child = nodes[at.node].child;
        double growth[2];
        for (int c = 0; c < 2; c++) {
            growth[c] = rt_box_half_area(box_with(s->o, child[c], s->box)) - area_of(s->o, child[c]);
        }
        int first = growth[1] < growth[0];
        stack[kept++] = (Kept){child[1 - first], left};
        stack[kept++] = (Kept){child[first], left};
    }
}

/* Goes up from the node, and from each node passed down into what hangs on its other side. */
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
        /* Above all that is left of `above`: the union of both is what it was. */
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

/* Marks the nodes from `at` to the root with a stamp of their own; false if they are too many. */
static bool mark_path(Optimizer *o, uint32_t at) {
    uint32_t stamp = ++o->marked;
    for (uint32_t climbed = 0; at != NONE && climbed < MAX_CLIMB; at = o->parent[at], climbed++)
        o->mark[at] = stamp;
    return at == NONE;
}

/* Whether the move can be made and gains, in the tree as it is. */
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

static bool equal_boxes(RtBox a, RtBox b) {
    return rt_box_contains(a, b) && rt_box_contains(b, a);
}

/* Makes the boxes of `node` and above those of their children. */
static void refit(Optimizer *o, uint32_t node) {
    for (; node != NONE; node = o->parent[node]) {
        RtBox before = o->tree->nodes[node].box;
        const uint32_t *child = o->tree->nodes[node].child;
        rt_tree_set_union(o->tree, node, child[0], child[1]);
        if (equal_boxes(before, o->tree->nodes[node].box)) return;
    }
}

static void make_move(Optimizer *o, const Move *move) {
    uint32_t node = move->node, target = move->target;
    uint32_t p = o->parent[node], old = o->parent[p];
    replace_child(o, old, p, sibling(o, node));
    replace_child(o, o->parent[target], target, p);
    rt_tree_set_union(o->tree, p, target, node);
    o->parent[target] = p;
    /* What has grown first: then the nodes above both ends are seen not to change. */
    refit(o, o->parent[p]);
    refit(o, old);
}

static int by_gain(const void *a, const void *b) {
    const Move *x = a, *y = b;
    if (x->gain != y->gain) return x->gain > y->gain ? -1 : 1;
    return x->node < y->node ? -1 : x->node > y->node;
}

/* Gives the number of moves made. */
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

RtStatus rt_tree_reinsert(RtTree *tree, uint32_t rounds, int threads, RtError *error) {
    uint32_t used = tree->used, made = 1;
    if (rounds == 0) return RT_OK;
    RT_TRY(rt_tree_limit_depth(tree, error));
    Optimizer o = {tree, rt_alloc(used, sizeof(uint32_t)), rt_alloc(used, sizeof(uint32_t)),
                   rt_alloc(used, sizeof(Move)), 0};
    RtStatus status = RT_OK;
    if (!o.parent || !o.mark || !o.moves) {
        status = rt_fail_memory(error, "reinsertion", used * (2 * sizeof(uint32_t) + sizeof(Move)));
    } else {
        o.parent[tree->root] = NONE;
        for (uint32_t i = 0; i < used; i++) {
            const uint32_t *child = tree->nodes[i].child;
            if (!rt_tree_is_leaf(tree, i)) o.parent[child[0]] = o.parent[child[1]] = i;
        }
    }
    for (uint32_t i = 0; status == RT_OK && made > 0 && i < rounds; i++) {
        status = run_round(&o, threads, &made, error);
    }
    rt_free(o.parent);
    rt_free(o.mark);
    rt_free(o.moves);
    return status;
}
