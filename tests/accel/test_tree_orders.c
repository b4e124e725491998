/* SPDX-License-Identifier: Apache-2.0 */
/* accel/tree: orders along axes and by Morton codes, and the methods based on them: LBVH and sweep. */
#include "tree_testing.h"

#include "accel/tree/order.h"
#include "accel/tree/sah_split.h"

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
        OWNED_MEMORY RtKeyed *order = rt_order_axis(boxes, COUNT, axis, 1);
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
    OWNED_MEMORY RtKeyed *order = rt_order_morton(boxes, 64, 2, 1);
    for (uint32_t i = 0; i < 64; i++) {
        uint32_t id = order[i].id, code = 0;
        for (uint32_t bit = 0; bit < 6; bit++) code |= (id >> (bit % 3 * 2 + bit / 3) & 1) << bit;
        assert_int_equal(order[i].key, code);
        assert_int_equal(code, i);
    }
    OWNED_MEMORY RtKeyed *coarse = rt_order_morton(boxes, 64, 1, 1); /* eight a cell, by id */
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
        OWNED_MEMORY RtKeyed *order = rt_order_morton(boxes, 64, 2, 1);
        for (uint32_t i = 0; i < 64; i++)
            assert_int_equal(order[i].key & UINT64_C(0x1249249249249249) << axis, 0);
    }
}

RT_TEST(lbvh_halves_space_along_one_axis_after_another) {
    RtBox boxes[64];
    make_cells(boxes);
    OWNED_TREE tree;
    assert_ok(rt_tree_lbvh(&tree, boxes, 64, 21, 1, error));
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
            RtTree binned, sweep;
            assert_ok(rt_tree_topdown(&binned, boxes, count, 16, 1, error));
            assert_ok(rt_tree_sweep(&sweep, boxes, count, error));
            double least = least_split_cost(boxes, count);
            assert_true(root_split_cost(&sweep) == least);
            assert_true(count == 16 ? root_split_cost(&binned) == least : root_split_cost(&binned) >= least);
            rt_tree_clear(&binned);
            rt_tree_clear(&sweep);
        }
    }
}

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

static RtTree make_tree(const RtBox *boxes, uint32_t count, int method, int threads) {
    RtTree tree;
    switch (method) {
    case 0: assert_ok(rt_tree_ploc(&tree, boxes, count, 21, 25, threads, error)); break;
    case 1: assert_ok(rt_tree_lbvh(&tree, boxes, count, 21, threads, error)); break;
    default: assert_ok(rt_tree_topdown(&tree, boxes, count, 16 * (method - 2), threads, error)); break;
    }
    return tree;
}

static void assert_same_on_any_number_of_threads(const RtBox *boxes, uint32_t count) {
    enum { METHODS = 7 };
    for (int method = 0; method < METHODS; method++) {
        OWNED_TREE one = make_tree(boxes, count, method, 1);
        assert_tree(&one);
        for (int threads = 2; threads <= 5; threads++) {
            OWNED_TREE other = make_tree(boxes, count, method, threads);
            assert_int_equal(one.root, other.root);
            assert_memory_equal(one.nodes, other.nodes, one.used * sizeof(RtTreeNode));
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

RT_TEST(every_allocation_of_a_build_from_the_top_may_fail) {
    OWNED_MEMORY RtBox *boxes = make_boxes(100, 1);
    RtTree tree;
    for (int bins = 0; bins <= 16; bins += 16)
        assert_fails_cleanly(rt_tree_topdown(&tree, boxes, 100, bins, 1, error), rt_tree_clear(&tree));
}

RT_TEST(a_tree_is_the_same_bit_for_bit_on_any_number_of_threads) {
    enum { COUNT = 50000 };
    OWNED_MEMORY RtBox *boxes = make_hard_boxes(COUNT);
    assert_same_on_any_number_of_threads(boxes, COUNT);
    /* Most have the same centre: no bins split their group, which is larger than a thread's share. */
    for (uint32_t i = COUNT / 10; i < COUNT; i++) boxes[i] = boxes[0];
    assert_same_on_any_number_of_threads(boxes, COUNT);
}

RT_TESTS(tree_orders, NULL, NULL)
