/* SPDX-License-Identifier: Apache-2.0 */
/* accel/tree/reinsertion.c: which subtrees move, the gain, and that nothing else changes. */
#include "tree_testing.h"

/* A binned tree, and bad ones: medians, and chains in the order of ids. */
enum { BINNED, MEDIANS, CHAIN, KINDS };

static RtTree make_tree(RtBox *boxes, uint32_t count, int kind) {
    const RtTreeOptions options = {.method = kind == BINNED ? RT_TREE_BINNED : RT_TREE_MEDIAN,
                                   .spatial.bins = 16};
    if (kind != CHAIN) return build_tree(boxes, count, options, 1);
    RtTree tree;
    assert_ok(rt_tree_init_leaves(&tree, boxes, count, error));
    for (uint32_t i = 1, top = 0; i < count; i++) top = rt_tree_unite(&tree, top, i);
    return tree;
}

static RtTree copy_of(const RtTree *tree) {
    RtTree copy = *tree;
    copy.nodes = rt_alloc(tree->used, sizeof(RtTreeNode));
    memcpy(copy.nodes, tree->nodes, tree->used * sizeof(RtTreeNode));
    return copy;
}

/* Each object is in one leaf, with the box it had. */
static void assert_same_references(const RtTree *tree, const RtBox *boxes) {
    uint32_t count = rt_tree_leaf_count(tree), *seen = rt_alloc(count, sizeof(uint32_t));
    assert_tree(tree);
    for (uint32_t i = 0; i < tree->used; i++) {
        if (!rt_tree_is_leaf(tree, i)) continue;
        uint32_t id = tree->nodes[i].child[1];
        assert_memory_equal(&tree->nodes[i].box, &boxes[id], sizeof(RtBox));
        assert_int_equal(seen[id]++, 0);
    }
    rt_free(seen);
}

/* Boxes of inner nodes are tight. */
static void assert_tight(const RtTree *tree) {
    for (uint32_t i = 0; i < tree->used; i++) {
        if (rt_tree_is_leaf(tree, i)) continue;
        const uint32_t *child = tree->nodes[i].child;
        RtBox both = rt_box_union(tree->nodes[child[0]].box, tree->nodes[child[1]].box);
        assert_memory_equal(&both, &tree->nodes[i].box, sizeof both);
    }
}

RT_TEST(pairs_that_were_parted_are_united) {
    /* Two cubes here and two far away, paired crosswise: areas of 3 * 1 + 1000 thin boxes. */
    const RtBox boxes[4] = {{{0, 0, 0}, {1, 1, 1}},
                            {{2, 0, 0}, {3, 1, 1}},
                            {{100, 0, 0}, {101, 1, 1}},
                            {{102, 0, 0}, {103, 1, 1}}};
    OWNED_TREE tree;
    assert_ok(rt_tree_init_leaves(&tree, boxes, 4, error));
    uint32_t a = rt_tree_unite(&tree, 0, 2), b = rt_tree_unite(&tree, 1, 3);
    rt_tree_unite(&tree, a, b);
    /* Half areas: 101 and 101 long, 203 each, and the root of 103: 207. */
    assert_true(rt_tree_cost(&tree) == 203 + 203 + 207);
    assert_ok(rt_tree_reinsert(&tree, 10, 1, 1, error));
    assert_true(rt_tree_cost(&tree) == 7 + 7 + 207); /* 3 x 1 x 1 twice */
    assert_same_references(&tree, boxes);
}

/* Pairs two cubes at the origin and two far away crosswise; returns the root. */
static uint32_t add_crosswise(RtTree *tree, uint32_t first) {
    uint32_t a = rt_tree_unite(tree, first, first + 2), b = rt_tree_unite(tree, first + 1, first + 3);
    return rt_tree_unite(tree, a, b);
}

RT_TEST(a_batch_moves_the_subtrees_with_the_largest_boxes_alone) {
    RtBox boxes[8];
    for (int i = 0; i < 8; i++) {
        float size = i < 4 ? 1 : 0x1p-10f, x = i % 4 < 2 ? (float)(i % 4) * 2 : (float)(i % 4) * 2 + 96;
        boxes[i] = (RtBox){{x * size, 0, 200 * size}, {(x + 1) * size, size, 201 * size}};
    }
    OWNED_TREE tree;
    assert_ok(rt_tree_init_leaves(&tree, boxes, 8, error));
    uint32_t large = add_crosswise(&tree, 0), small = add_crosswise(&tree, 4);
    rt_tree_unite(&tree, large, small);
    const RtTree before = copy_of(&tree);
    assert_ok(rt_tree_reinsert(&tree, 10, 0.625, 1, error)); /* nine nodes: all but those below `small` */
    for (uint32_t i = small - 2; i <= small; i++)
        assert_memory_equal(&tree.nodes[i], &before.nodes[i], sizeof(RtTreeNode));
    assert_true(rt_tree_cost(&tree) < rt_tree_cost(&before) - 300);
    assert_same_references(&tree, boxes);
    double half = rt_tree_cost(&tree);
    assert_ok(rt_tree_reinsert(&tree, 10, 1, 1, error));
    assert_true(rt_tree_cost(&tree) < half);
    rt_free(before.nodes);
}

RT_TEST(a_round_never_costs_more_and_a_poor_tree_gets_good) {
    enum { COUNT = 2000 };
    for (uint64_t seed = 1; seed <= 3; seed++) {
        OWNED_MEMORY RtBox *boxes = make_boxes(COUNT, seed);
        double good = 0;
        for (int kind = 0; kind < KINDS; kind++) {
            OWNED_TREE tree = make_tree(boxes, COUNT, kind);
            assert_ok(rt_tree_limit_depth(&tree, error));
            double first = rt_tree_cost(&tree), before = first;
            if (kind == BINNED) good = first;
            for (int round = 0; round < 6; round++) {
                assert_ok(rt_tree_reinsert(&tree, 1, round % 2 ? 0.1 : 1, 0, error));
                double cost = rt_tree_cost(&tree);
                assert_true(cost <= before);
                assert_same_references(&tree, boxes);
                assert_tight(&tree);
                before = cost;
            }
            assert_true(before < first);
            assert_true(before <= good);
        }
    }
}

/* ---- against all moves there are ---- */

static uint32_t parent_of(const RtTree *tree, uint32_t node) {
    for (uint32_t i = 0; i < tree->used; i++) {
        if (rt_tree_is_leaf(tree, i)) continue;
        if (tree->nodes[i].child[0] == node || tree->nodes[i].child[1] == node) return i;
    }
    return UINT32_MAX;
}

static bool is_below(const RtTree *tree, uint32_t node, uint32_t top) {
    while (node != top && node != UINT32_MAX) node = parent_of(tree, node);
    return node == top;
}

static void put_instead(RtTree *tree, uint32_t parent, uint32_t from, uint32_t to) {
    if (parent == UINT32_MAX)
        tree->root = to;
    else
        tree->nodes[parent].child[tree->nodes[parent].child[0] == from ? 0 : 1] = to;
}

static RtBox refit(RtTree *tree, uint32_t node) {
    RtTreeNode *n = &tree->nodes[node];
    if (!rt_tree_is_leaf(tree, node))
        n->box = rt_box_union(refit(tree, n->child[0]), refit(tree, n->child[1]));
    return n->box;
}

/* The cost after moving `node` beside `target`. */
static double cost_after(const RtTree *tree, uint32_t node, uint32_t target) {
    OWNED_TREE copy = copy_of(tree);
    uint32_t p = parent_of(tree, node);
    uint32_t sibling = tree->nodes[p].child[tree->nodes[p].child[0] == node ? 1 : 0];
    put_instead(&copy, parent_of(tree, p), p, sibling);
    copy.nodes[p].child[0] = RT_TREE_LEAF; /* it has no children for now */
    put_instead(&copy, parent_of(&copy, target), target, p);
    copy.nodes[p].child[0] = target;
    copy.nodes[p].child[1] = node;
    refit(&copy, copy.root);
    return rt_tree_cost(&copy);
}

RT_TEST(where_it_ends_no_move_there_is_would_gain) {
    enum { COUNT = 14 };
    for (uint64_t seed = 1; seed <= 8; seed++) {
        OWNED_MEMORY RtBox *boxes = make_boxes(COUNT, seed);
        OWNED_TREE tree = make_tree(boxes, COUNT, seed % 2 ? CHAIN : MEDIANS);
        assert_ok(rt_tree_reinsert(&tree, 1000, 1, 0, error));
        double cost = rt_tree_cost(&tree);
        for (uint32_t node = 0; node < tree.used; node++) {
            uint32_t p = parent_of(&tree, node);
            for (uint32_t target = 0; target < tree.used && p != UINT32_MAX; target++) {
                if (is_below(&tree, target, node) || target == p) continue;
                assert_true(cost_after(&tree, node, target) > cost * (1 - 1e-9));
            }
        }
    }
}

/* ---- degenerate ---- */

RT_TEST(what_cannot_gain_stays_as_it_is) {
    enum { COUNT = 300 };
    OWNED_MEMORY RtBox *boxes = rt_alloc(COUNT, sizeof(RtBox)); /* all at one point, then all the unit cube */
    for (int pass = 0; pass < 2; pass++) {
        for (uint32_t count = 1; count <= COUNT; count = count < 3 ? count + 1 : count * 10) {
            OWNED_TREE tree = make_tree(boxes, count, MEDIANS), before = copy_of(&tree);
            assert_ok(rt_tree_reinsert(&tree, 5, 1, 0, error));
            assert_memory_equal(tree.nodes, before.nodes, tree.used * sizeof(RtTreeNode));
        }
        for (int i = 0; i < COUNT; i++) boxes[i] = (RtBox){{0, 0, 0}, {1, 1, 1}};
    }
}

/* Boxes about one point: each holds all the smaller ones, and bounds do not prune. A chain would be the best
 * tree; moves along it would take the square of their number. */
RT_TEST(nested_boxes_take_no_time_to_speak_of) {
    enum { COUNT = 20000 };
    OWNED_MEMORY RtBox *boxes = rt_alloc(COUNT, sizeof(RtBox));
    for (int step = 1; step <= 7919; step += 7918) { /* in order, and mixed */
        for (int i = 0; i < COUNT; i++) {
            float r = (float)(i + 1);
            boxes[(i * step) % COUNT] = (RtBox){{-r, -r, -r}, {r, r, r}};
        }
        OWNED_TREE tree = make_tree(boxes, COUNT, MEDIANS);
        double before = rt_tree_cost(&tree);
        assert_ok(rt_tree_reinsert(&tree, 4, 1, 0, error));
        assert_true(rt_tree_cost(&tree) <= before);
        assert_same_references(&tree, boxes);
        uint32_t depth = assert_tree(&tree);
        if (depth > COUNT / 4) fail_msg("the tree is %u deep", depth);
    }
}

RT_TEST(a_tree_that_is_too_deep_is_limited_first) {
    enum { COUNT = 1000 };
    OWNED_MEMORY RtBox *boxes = make_boxes(COUNT, 3);
    OWNED_TREE tree = make_tree(boxes, COUNT, CHAIN);
    assert_int_equal(assert_tree(&tree), COUNT - 1);
    assert_ok(rt_tree_reinsert(&tree, 1, 1, 0, error));
    assert_true(assert_tree(&tree) < 2 * RT_TREE_MAX_DEPTH);
}

RT_TESTS(reinsertion, NULL, NULL)
