/* SPDX-License-Identifier: Apache-2.0 */
/* accel/tree: orders along axes and by Morton codes, methods against their definitions, and the depth limit.
 */
#include "tree_testing.h"

#include "accel/tree/topdown.h"

static const RtTreeOptions methods[] = {
    {.method = RT_TREE_AGGLOMERATIVE},
    {.method = RT_TREE_PLOC, .bits = 21, .radius = 25},
    {.method = RT_TREE_INSERTION, .insertion = {.random = true, .permutations = 1, .seed = 1}},
    {.method = RT_TREE_MEDIAN},
    {.method = RT_TREE_BINNED, .spatial.bins = 16},
    {.method = RT_TREE_SWEEP},
    {.method = RT_TREE_LBVH, .bits = 21},
    {.method = RT_TREE_BINNED, .spatial.bins = 32, .reinsertion = 1, .batch = 0.5},
    {.method = RT_TREE_BINNED, .spatial.bins = 64},
};
enum { AGGLOMERATIVE, PLOC, INSERTION, MEDIANS, BINNED, SWEEP, LBVH, METHOD_COUNT, VARIANT_COUNT = 9 };

/* ---- orders ---- */

RT_TEST(an_axis_is_sorted_by_centres_and_ids) {
    static const float centers[] = {3, -1, 0, -1e30f, 3, -0.5f, 1e-40f, 1e30f, -1};
    static const uint32_t expected[] = {3, 1, 8, 5, 2, 6, 0, 4, 7};
    enum { COUNT = sizeof expected / sizeof expected[0] };
    RtBox boxes[COUNT];
    for (int axis = 0; axis < 3; axis++) {
        for (uint32_t i = 0; i < COUNT; i++) {
            boxes[i] = (RtBox){{0, 0, 0}, {0, 0, 0}};
            boxes[i].lo.at[axis] = boxes[i].hi.at[axis] = centers[i];
        }
        RT_ARENA(arena);
        const RtKeyed *order;
        assert_ok(rt_tree_order(&(RtGeometry){.boxes = boxes, .object_count = COUNT}, 0, axis, 1, &arena,
                                &order, error));
        for (uint32_t i = 0; i < COUNT; i++) assert_int_equal(order[i].id, expected[i]);
    }
}

/* Object i of 64 is in cell (i % 4, i / 4 % 4, i / 16) of 4 x 4 x 4. */
static void make_cells(RtBox *boxes) {
    for (uint32_t i = 0; i < 64; i++) {
        RtVec3 corner = {{(float)(i % 4), (float)(i / 4 % 4), (float)(i / 16)}};
        boxes[i] = (RtBox){corner, rt_add(corner, (RtVec3){{1, 1, 1}})};
    }
}

RT_TEST(morton_codes_interleave_the_cells_of_centres) {
    RtBox boxes[64];
    make_cells(boxes);
    const RtGeometry geometry = {.boxes = boxes, .object_count = 64};
    RT_ARENA(arena);
    const RtKeyed *order, *coarse; /* eight a cell, by id */
    assert_ok(rt_tree_order(&geometry, 2, 0, 1, &arena, &order, error));
    assert_ok(rt_tree_order(&geometry, 1, 0, 1, &arena, &coarse, error));
    for (uint32_t i = 0; i < 64; i++) {
        uint32_t id = order[i].id, code = 0;
        for (uint32_t bit = 0; bit < 6; bit++) code |= (id >> (bit % 3 * 2 + bit / 3) & 1) << bit;
        assert_int_equal(order[i].key, code);
        assert_int_equal(code, i);
    }
    for (uint32_t i = 1; i < 64; i++) {
        assert_int_equal(coarse[i].key, i / 8);
        if (i % 8) assert_true(coarse[i].id > coarse[i - 1].id);
    }
}

RT_TEST(centres_that_are_equal_along_an_axis_are_in_its_first_cell) {
    for (int axis = 0; axis < 3; axis++) {
        RtBox boxes[64];
        make_cells(boxes);
        for (uint32_t i = 0; i < 64; i++) {
            boxes[i].lo.at[axis] = 5;
            boxes[i].hi.at[axis] = 6;
        }
        const RtGeometry geometry = {.boxes = boxes, .object_count = 64};
        RT_ARENA(arena);
        const RtKeyed *order;
        assert_ok(rt_tree_order(&geometry, 2, 0, 1, &arena, &order, error));
        for (uint32_t i = 0; i < 64; i++)
            assert_int_equal(order[i].key & UINT64_C(0x1249249249249249) << axis, 0);
    }
}

/* ---- methods ---- */

RT_TEST(lbvh_halves_space_along_one_axis_after_another) {
    RtBox boxes[64];
    make_cells(boxes);
    OWNED_TREE tree = build_tree(boxes, 64, methods[LBVH], 1);
    assert_int_equal(assert_tree(&tree), 6);
    uint32_t node = tree.root;
    for (int level = 0; level < 6; level++, node = tree.nodes[node].child[0]) { /* z, y, x, z, y, x */
        int axis = 2 - level % 3;
        RtVec3 size = rt_box_size(tree.nodes[node].box);
        const uint32_t *child = tree.nodes[node].child;
        for (int s = 0; s < 2; s++) {
            RtVec3 half = rt_box_size(tree.nodes[child[s]].box);
            for (int a = 0; a < 3; a++) assert_true(half.at[a] == (a == axis ? size.at[a] / 2 : size.at[a]));
        }
    }
}

/* The least cost of a split by a plane between centres along an axis, of which none are equal. */
static double least_split_cost(const RtBox *boxes, uint32_t count) {
    double least = INFINITY;
    for (int axis = 0; axis < 3; axis++) {
        for (uint32_t i = 0; i < count; i++) {
            RtBox sides[2] = {RT_EMPTY_BOX, RT_EMPTY_BOX};
            uint32_t counts[2] = {0, 0};
            for (uint32_t j = 0; j < count; j++) {
                int side = rt_box_center(boxes[j]).at[axis] >= rt_box_center(boxes[i]).at[axis];
                sides[side] = rt_box_union(sides[side], boxes[j]);
                counts[side]++;
            }
            double cost = rt_box_half_area(sides[0]) * counts[0] + rt_box_half_area(sides[1]) * counts[1];
            if (counts[0] > 0 && cost < least) least = cost;
        }
    }
    return least;
}

static uint32_t leaves_below(const RtTree *tree, uint32_t node) {
    if (rt_tree_is_leaf(tree, node)) return 1;
    const uint32_t *child = tree->nodes[node].child;
    return leaves_below(tree, child[0]) + leaves_below(tree, child[1]);
}

static double root_split_cost(const RtTree *tree) {
    const uint32_t *child = tree->nodes[tree->root].child;
    double cost = 0;
    for (int s = 0; s < 2; s++)
        cost += rt_box_half_area(tree->nodes[child[s]].box) * leaves_below(tree, child[s]);
    return cost;
}

RT_TEST(a_sweep_finds_the_cheapest_of_all_splits_and_so_do_as_many_bins_as_objects) {
    for (uint64_t seed = 1; seed <= 20; seed++) {
        for (uint32_t count = 16; count <= 200; count += 184) {
            OWNED_MEMORY RtBox *boxes = make_boxes(count, seed);
            OWNED_TREE binned = build_tree(boxes, count, methods[BINNED], 1);
            OWNED_TREE sweep = build_tree(boxes, count, methods[SWEEP], 1);
            double least = least_split_cost(boxes, count);
            assert_true(root_split_cost(&sweep) == least);
            assert_true(count == 16 ? root_split_cost(&binned) == least : root_split_cost(&binned) >= least);
        }
    }
}

/* The distance of two nodes: half the area of the box of both (Walter 2008). */
static double distance_of(const RtTree *tree, uint32_t a, uint32_t b) {
    return rt_box_half_area(rt_box_union(tree->nodes[a].box, tree->nodes[b].box));
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
        OWNED_TREE greedy = make_greedy_tree(boxes, COUNT),
                   tree = build_tree(boxes, COUNT, methods[AGGLOMERATIVE], 1);
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
            OWNED_TREE tree = build_tree(boxes, COUNT, methods[m], 1);
            assert_tree(&tree);
            cost[m] = rt_tree_cost(&tree);
        }
        assert_true(cost[AGGLOMERATIVE] <= cost[PLOC] && cost[PLOC] <= cost[MEDIANS]);
        assert_true(cost[INSERTION] <= cost[MEDIANS]);
        assert_true(cost[SWEEP] <= cost[BINNED] && cost[BINNED] <= cost[LBVH]);
    }
}

RT_TEST(more_orders_of_insertion_never_cost_more) {
    enum { COUNT = 500 };
    OWNED_MEMORY RtBox *boxes = make_boxes(COUNT, 4);
    double before = INFINITY, first = 0;
    for (uint32_t tries = 1; tries <= 8; tries++) {
        const RtTreeOptions options = {.method = RT_TREE_INSERTION, .insertion = {true, tries, 7}};
        OWNED_TREE tree = build_tree(boxes, COUNT, options, 1);
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
    const RtTreeOptions options = {.method = RT_TREE_INSERTION, .insertion = {false, 1, 0}};
    OWNED_TREE tree = build_tree(boxes, 5, options, 1);
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

RT_TEST(a_centre_between_two_bins_is_on_the_side_of_the_upper_one) {
    enum { COUNT = 257 };
    RtTreeRef refs[COUNT];
    for (uint32_t i = 0; i < COUNT; i++) {
        RtVec3 corner = rt_vec3((float)i, 0, 0);
        refs[i] = (RtTreeRef){.box = {corner, rt_add(corner, rt_vec3(1, 1, 1))}, .id = i};
    }
    RtBox4 centers[2];
    assert_int_equal(rt_split_binned(refs, COUNT, 16, rt_refs_centers(refs, COUNT), centers), 128);
    for (uint32_t i = 0; i < COUNT; i++) assert_int_equal(refs[i].id < 128, i < 128);
    assert_int_equal(rt_bin_count(32, 1023), 16);
    assert_int_equal(rt_bin_count(32, 1024), 32);
}

/* ---- depth ---- */

RT_TEST(coincident_objects_stay_within_the_depth_limit) {
    enum { COUNT = 1000 };
    OWNED_MEMORY RtBox *boxes = rt_alloc(COUNT, sizeof(RtBox));
    for (int i = 0; i < COUNT; i++) boxes[i] = (RtBox){{0, 0, 0}, {1, 1, 1}};
    for (int m = 0; m < METHOD_COUNT; m++) {
        OWNED_TREE tree = build_tree(boxes, COUNT, methods[m], 1);
        uint32_t before = assert_tree(&tree);
        if (m == INSERTION) assert_true(before > RT_TREE_MAX_DEPTH); /* otherwise the test proves less */
        if (m != INSERTION) assert_in_range(before, 10, 12);
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
        OWNED_TREE tree = build_tree(boxes, COUNT, methods[m], 1);
        uint32_t before = assert_tree(&tree);
        if (m <= PLOC) assert_true(before > RT_TREE_MAX_DEPTH);
        if (m == PLOC) assert_in_range(before, RT_TREE_MAX_DEPTH, 80); /* beyond its PATIENCE */
        assert_ok(rt_tree_limit_depth(&tree, error));
        assert_true(assert_tree(&tree) <= RT_TREE_MAX_DEPTH);
    }
}

static const char *const builds[] = {"binned,bins=2", "sweep", "lbvh", "lbvh,bits=1", "ploc"};
enum { BUILD_COUNT = sizeof builds / sizeof builds[0] };

/* Spheres at distances that grow by powers of 2: each split cuts off only the last few, the worst case for
 * depth. */
RT_TEST(a_chain_of_growing_distances_stays_within_the_depth_limit) {
    OWNED_SCENE scene = begin_scene();
    float x = 1e-17f;
    for (int i = 0; i < 110; i++, x *= 2) {
        for (int copy = 0; copy < 40; copy++)
            assert_ok(rt_scene_add_sphere(&scene, 0, rt_vec3(x, 0, 0), x / 8, error));
    }
    assert_ok(rt_scene_finish(&scene, error));
    for (int b = 0; b < BUILD_COUNT; b++) {
        char spec[64];
        snprintf(spec, sizeof spec, "bvh:max_leaf_size=1,build=%s", builds[b]);
        RtDescription description = describe_spec(&scene, spec);
        if (b < 2 || b == 4) assert_true(description.depth > 34); /* otherwise the test proves nothing */
        assert_true(description.depth <= RT_TREE_MAX_DEPTH);
        if (b == 1) assert_int_equal(description.depth, 43); /* 34, and 350 spheres that are halved */
    }
}

/* ---- threads and memory ---- */

/* Hard boxes: a distant group, coincident boxes, zeros of either sign. */
static RtBox *make_hard_boxes(uint32_t count) {
    RtBox *boxes = make_boxes(count, 3);
    for (uint32_t i = 0; i < count; i += 7) boxes[i] = boxes[i % 3];
    for (uint32_t i = 1; i < count; i += 7) {
        boxes[i].lo.at[i % 3] = i % 2 ? -0.0f : 0.0f;
        boxes[i].hi.at[i % 3] = i % 4 < 2 ? -0.0f : 0.0f;
    }
    for (uint32_t i = 2; i < count; i += 70) boxes[i].lo.x = boxes[i].hi.x = 1e15f * (float)i;
    return boxes;
}

static void assert_same_on_any_number_of_threads(RtBox *boxes, uint32_t count) {
    for (int m = 0; m < VARIANT_COUNT; m++) {
        if (m == AGGLOMERATIVE || m == INSERTION || m == SWEEP) continue; /* on one thread */
        OWNED_TREE one = build_tree(boxes, count, methods[m], 1);
        assert_tree(&one);
        for (int threads = 2; threads <= 5; threads++) {
            OWNED_TREE other = build_tree(boxes, count, methods[m], threads);
            assert_int_equal(one.root, other.root);
            assert_memory_equal(one.nodes, other.nodes, one.used * sizeof(RtTreeNode));
        }
    }
}

RT_TEST(a_tree_is_the_same_bit_for_bit_on_any_number_of_threads) {
    enum { COUNT = 50000 };
    OWNED_MEMORY RtBox *boxes = make_hard_boxes(COUNT);
    assert_same_on_any_number_of_threads(boxes, COUNT);
    /* Most have the same centre: no bins split their group, which is larger than a thread's share. */
    for (uint32_t i = COUNT / 10; i < COUNT; i++) boxes[i] = boxes[0];
    assert_same_on_any_number_of_threads(boxes, COUNT);
}

RT_TEST(every_allocation_of_a_build_may_fail) {
    OWNED_MEMORY RtBox *boxes = make_boxes(100, 1);
    const RtGeometry geometry = {.boxes = boxes, .object_count = 100};
    RtTree tree;
    for (int m = 0; m < METHOD_COUNT; m++) {
        RtTreeOptions options = methods[m];
        options.reinsertion = 2;
        options.batch = m % 2 ? 0.5 : 1;
        assert_fails_cleanly(rt_tree_build(&tree, &geometry, &options, 1, error), rt_tree_clear(&tree));
    }
}

RT_TESTS(trees, NULL, NULL)
