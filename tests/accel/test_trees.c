/* SPDX-License-Identifier: Apache-2.0 */
/* accel/tree: methods against their definitions, and the depth limit. */
#include "tree_testing.h"

#include "accel/tree/neighbours.h"
#include "accel/tree/sah_split.h"

enum { METHOD_COUNT = 7 }; /* of make_tree */

/* ---- trees of boxes ---- */

static RtTree make_tree(const RtBox *boxes, uint32_t count, int method) {
    const RtInsertionOrder order = {.random = true, .permutations = 1, .seed = 1};
    RtTree tree;
    switch (method) {
    case 0: assert_ok(rt_tree_agglomerative(&tree, boxes, count, error)); break;
    case 1: assert_ok(rt_tree_ploc(&tree, boxes, count, 21, 25, 1, error)); break;
    case 2: assert_ok(rt_tree_insertion(&tree, boxes, count, &order, error)); break;
    case 3: assert_ok(rt_tree_topdown(&tree, boxes, count, 0, 1, error)); break;
    case 4: assert_ok(rt_tree_topdown(&tree, boxes, count, 16, 1, error)); break;
    case 5: assert_ok(rt_tree_sweep(&tree, boxes, count, error)); break;
    default: assert_ok(rt_tree_lbvh(&tree, boxes, count, 21, 1, error)); break;
    }
    return tree;
}

/* The distance of two nodes: half the area of the box of both (Walter 2008). */
static double distance_of(const RtTree *tree, uint32_t a, uint32_t b) {
    return rt_box_half_area(rt_box_union(tree->nodes[a].box, tree->nodes[b].box));
}

RT_TEST(the_nearest_neighbour_is_the_one_that_a_scan_finds) {
    enum { COUNT = 333 };
    OWNED_MEMORY RtBox *boxes = make_boxes(COUNT, 1);
    OWNED_TREE tree;
    RtNeighbours neighbours;
    bool gone[2 * COUNT] = {false};
    assert_ok(rt_tree_init_leaves(&tree, boxes, COUNT, error));
    assert_ok(rt_neighbours_init(&neighbours, &tree, error));
    RtRandom random = rt_random(2, 0);
    for (uint32_t left = COUNT; left > 1; left--) {
        uint32_t from, other;
        double distance, least = INFINITY;
        do from = rt_random_below(&random, tree.used);
        while (gone[from]);
        uint32_t nearest = rt_neighbours_nearest(&neighbours, from, &distance);
        for (other = 0; other < tree.used; other++) {
            if (gone[other] || other == from) continue;
            double d = distance_of(&tree, from, other);
            least = d < least ? d : least;
        }
        assert_true(distance == least);
        assert_true(distance == distance_of(&tree, from, nearest));
        /* A union with any cluster, near or far. */
        do other = rt_random_below(&random, tree.used);
        while (gone[other] || other == from);
        gone[from] = gone[other] = true;
        rt_neighbours_unite(&neighbours, from, other, rt_tree_unite(&tree, from, other));
    }
    double distance;
    assert_int_equal(rt_neighbours_nearest(&neighbours, tree.root, &distance), RT_NO_CLUSTER);
    rt_neighbours_clear(&neighbours);
}

/* The definition: merges the nearest pair of all clusters until one is left. */
static RtTree make_greedy_tree(const RtBox *boxes, uint32_t count) {
    RtTree tree;
    bool gone[1024] = {false};
    assert_ok(rt_tree_init_leaves(&tree, boxes, count, error));
    while (tree.used < 2 * count - 1) {
        uint32_t a = 0, b = 0;
        double least = INFINITY;
        for (uint32_t i = 0; i < tree.used; i++) {
            for (uint32_t j = i + 1; j < tree.used && !gone[i]; j++) {
                if (gone[j] || !(distance_of(&tree, i, j) < least)) continue;
                least = distance_of(&tree, i, j);
                a = i;
                b = j;
            }
        }
        gone[a] = gone[b] = true;
        rt_tree_unite(&tree, a, b);
    }
    return tree;
}

RT_TEST(agglomeration_unites_the_nearest_pair_of_all) {
    enum { COUNT = 150 };
    for (uint64_t seed = 1; seed <= 5; seed++) {
        OWNED_MEMORY RtBox *boxes = make_boxes(COUNT, seed);
        OWNED_TREE greedy = make_greedy_tree(boxes, COUNT), tree = make_tree(boxes, COUNT, 0);
        assert_tree(&tree);
        /* The same merges, in another order. */
        for (uint32_t i = COUNT; i < greedy.used; i++) {
            uint32_t j = COUNT;
            while (j < tree.used && memcmp(&tree.nodes[j].box, &greedy.nodes[i].box, sizeof(RtBox)) != 0) j++;
            assert_true(j < tree.used);
        }
    }
}

RT_TEST(clustering_beats_medians_and_more_neighbours_beat_fewer) {
    enum { COUNT = 3000 };
    for (uint64_t seed = 1; seed <= 3; seed++) {
        OWNED_MEMORY RtBox *boxes = make_boxes(COUNT, seed);
        double cost[METHOD_COUNT];
        for (int m = 0; m < METHOD_COUNT; m++) {
            OWNED_TREE tree = make_tree(boxes, COUNT, m);
            assert_tree(&tree);
            cost[m] = rt_tree_cost(&tree);
        }
        assert_true(cost[0] <= cost[1]); /* agglomerative, ploc */
        assert_true(cost[1] <= cost[3]); /* rubin-whitted */
        assert_true(cost[2] <= cost[3]); /* goldsmith-salmon */
        assert_true(cost[5] <= cost[4]); /* sweep, binned */
        assert_true(cost[4] <= cost[6]); /* lbvh */
    }
}

RT_TEST(more_orders_of_insertion_never_cost_more) {
    enum { COUNT = 500 };
    OWNED_MEMORY RtBox *boxes = make_boxes(COUNT, 4);
    double before = INFINITY, first = 0;
    for (uint32_t tries = 1; tries <= 8; tries++) {
        const RtInsertionOrder order = {.random = true, .permutations = tries, .seed = 7};
        OWNED_TREE tree;
        assert_ok(rt_tree_insertion(&tree, boxes, COUNT, &order, error));
        assert_tree(&tree);
        double cost = rt_tree_cost(&tree);
        assert_true(cost <= before);
        if (tries == 1) first = cost;
        before = cost;
    }
    assert_true(before < first);
}

RT_TEST(an_object_is_inserted_where_areas_grow_least) {
    /* Two pairs far apart; the fifth, beside the second, makes the pair of 2 and 3 grow or unites with 3. */
    RtBox boxes[5] = {{{0, 0, 0}, {1, 1, 1}},
                      {{2, 0, 0}, {3, 1, 1}},
                      {{100, 0, 0}, {101, 1, 1}},
                      {{102, 0, 0}, {103, 1, 1}},
                      {{103.5f, 0, 0}, {104, 1, 1}}};
    const RtInsertionOrder order = {.random = false, .permutations = 1};
    OWNED_TREE tree;
    assert_ok(rt_tree_insertion(&tree, boxes, 5, &order, error));
    assert_int_equal(assert_tree(&tree), 3);
    const uint32_t *child = tree.nodes[8].child; /* the last union */
    assert_int_equal(child[0], 3);
    assert_int_equal(child[1], 4);
}

RT_TEST(medians_put_the_lesser_half_in_front) {
    RtRandom random = rt_random(9, 0);
    for (uint32_t count = 1; count <= 64; count++) {
        RtTreeRef refs[64];
        for (uint32_t i = 0; i < count; i++) {
            float x = (float)(rt_random_below(&random, count / 2 + 1)); /* many are equal */
            refs[i] = (RtTreeRef){{{x, 0, 0}, {x + 1, 1, 1}}, i};
        }
        uint32_t half = rt_split_median(refs, count);
        assert_int_equal(half, (count + 1) / 2);
        for (uint32_t i = 0; i < half; i++) {
            for (uint32_t j = half; j < count; j++) {
                float x = refs[i].box.lo.x, y = refs[j].box.lo.x;
                assert_true(x < y || (x == y && refs[i].id < refs[j].id));
            }
        }
    }
}

/* ---- depth ---- */

RT_TEST(coincident_objects_stay_within_the_depth_limit) {
    enum { COUNT = 1000 };
    OWNED_MEMORY RtBox *boxes = rt_alloc(COUNT, sizeof(RtBox));
    for (int i = 0; i < COUNT; i++) boxes[i] = (RtBox){{0, 0, 0}, {1, 1, 1}};
    for (int m = 0; m < METHOD_COUNT; m++) {
        OWNED_TREE tree = make_tree(boxes, COUNT, m);
        uint32_t before = assert_tree(&tree);
        if (m == 2) assert_true(before > RT_TREE_MAX_DEPTH); /* otherwise the test proves less */
        if (m != 2) assert_in_range(before, 10, 12);
        assert_ok(rt_tree_limit_depth(&tree, error));
        assert_true(assert_tree(&tree) <= RT_TREE_MAX_DEPTH);
    }
}

/* Boxes at distances that grow by powers of 2, each so large that all smaller ones are nearer to one another:
 * every bottom-up method makes a chain. */
RT_TEST(a_chain_of_growing_distances_is_cut_by_medians) {
    enum { COUNT = 110 };
    RtBox boxes[COUNT];
    float x = 1e-17f;
    for (int i = 0; i < COUNT; i++, x *= 2) boxes[i] = (RtBox){{x, 0, 0}, {x * 1.25f, x / 8, x / 8}};
    for (int m = 0; m < METHOD_COUNT; m++) {
        OWNED_TREE tree = make_tree(boxes, COUNT, m);
        uint32_t before = assert_tree(&tree);
        if (m < 2) assert_true(before > RT_TREE_MAX_DEPTH);
        if (m == 1) assert_in_range(before, RT_TREE_MAX_DEPTH, 80); /* beyond its PATIENCE */
        assert_ok(rt_tree_limit_depth(&tree, error));
        assert_true(assert_tree(&tree) <= RT_TREE_MAX_DEPTH);
    }
}

RT_TEST(what_is_shallow_enough_is_left_as_it_is) {
    OWNED_MEMORY RtBox *boxes = make_boxes(500, 1);
    OWNED_TREE tree = make_tree(boxes, 500, 0);
    RtTreeNode before[999];
    memcpy(before, tree.nodes, sizeof before);
    assert_ok(rt_tree_limit_depth(&tree, error));
    assert_memory_equal(before, tree.nodes, sizeof before);
}

RT_TESTS(trees, NULL, NULL)
