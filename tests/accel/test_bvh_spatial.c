/* SPDX-License-Identifier: Apache-2.0 */
/* bvh:build=spatial: which objects are cut, that no part is lost, and rays that would reveal it. */
#include "slivers_testing.h"
#include "tree_testing.h"

#include "accel/bvh/bvh.h"

/* In the plane z = 0: a sliver (object 0) along the diagonal of [0,16]^2, and n equal triangles in each of
 * the two other corners. To cut the sliver at any x costs (n + 1) * 256 by the heuristic; whole, with one of
 * the corners, (n + 1) * 256 + n; a leaf of all, (2 * n + 1) * 256. */
static RtScene make_diagonal(int n) {
    RtScene scene = begin_scene();
    add_triangle(&scene, rt_vec3(0, 0, 0), rt_vec3(16, 16, 0), rt_vec3(16, 15.9f, 0));
    for (int i = 0; i < n; i++) {
        add_triangle(&scene, rt_vec3(0, 15, 0), rt_vec3(1, 15, 0), rt_vec3(0, 16, 0));
        add_triangle(&scene, rt_vec3(15, 0, 0), rt_vec3(16, 0, 0), rt_vec3(15, 1, 0));
    }
    assert_ok(rt_scene_finish(&scene, error));
    return scene;
}

RT_TEST(a_long_diagonal_triangle_is_in_two_leaves) {
    OWNED_SCENE scene = make_diagonal(4);
    OWNED_ACCEL RtBvh *bvh = open_valid(&scene, "bvh:build=spatial");
    assert_true(bvh->hierarchy.split_refs);
    assert_int_equal(bvh->hierarchy.id_count, 10);
    uint32_t leaves = 0;
    for (uint32_t i = 0; i < bvh->hierarchy.id_count; i++) leaves += bvh->hierarchy.ids[i] == 0;
    assert_int_equal(leaves, 2);
}

RT_TEST(few_objects_are_cut_where_a_leaf_of_them_costs_more) {
    OWNED_SCENE scene = make_diagonal(3);
    assert_int_equal(describe_spec(&scene, "bvh:build=spatial,max_leaf_size=8").references, 8);
    assert_int_equal(describe_spec(&scene, "bvh:build=spatial,max_leaf_size=8,traversal_cost=9").references,
                     7);
}

static RtTally count_ray(const RtScene *scene, const char *spec, const RtRay *ray) {
    OWNED_ACCEL RtAccel *bvh = open_valid(scene, spec);
    OWNED_QUERY query = open_query(bvh);
    RtHit hit;
    RtTally tallies[RT_RAY_KIND_COUNT] = {0};
    rt_nearest(&query, ray, 1, &hit, tallies);
    assert_int_equal(hit.object, RT_NO_OBJECT);
    return tallies[ray->kind];
}

/* A ray in the plane of the triangles, which it misses, along the diagonal: the root, both of its children,
 * and the two leaves with parts of the sliver, whose siblings in the corners it passes by. */
RT_TEST(a_part_that_was_tested_before_is_not_tested_again) {
    OWNED_SCENE scene = make_diagonal(4);
    const RtRay ray = {{-1, -1, 0}, 0, {1, 1, 0}, INFINITY, RT_RAY_RANDOM, 0};
    RtTally on = count_ray(&scene, "bvh:build=spatial", &ray);
    RtTally off = count_ray(&scene, "bvh:build=spatial,mailbox=off", &ray);
    RtTally by_hand = {.rays = 1, .extent_tests = 7, .steps = 5, .leaf_steps = 2, .object_tests = 2};
    assert_tally("mailbox=off", &off, &by_hand);
    by_hand.object_tests = by_hand.repeats_avoided = 1;
    assert_tally("mailbox=on", &on, &by_hand);
}

/* ---- scenes of slivers ---- */

RT_TEST(the_budget_is_kept_and_used) {
    OWNED_SCENE scene = make_slivers(2000, 1, 1, 0);
    RtDescription description;
    double before = INFINITY;
    const struct {
        const char *spec;
        uint64_t least, most;
    } rows[] = {{"bvh:build=spatial,max_leaf_size=1,budget=1", 2000, 2000},
                {"bvh:build=spatial,max_leaf_size=1,budget=1.1", 2050, 2200},
                {"bvh:build=spatial,max_leaf_size=1,budget=3", 2500, 6000}};
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        OWNED_ACCEL RtBvh *bvh = open_valid(&scene, rows[i].spec);
        rt_accel_describe(&bvh->base, &description);
        assert_in_range(description.references, rows[i].least, rows[i].most);
        assert_true(description.predicted_cost < before);
        before = description.predicted_cost;
    }
}

/* Two heaps of equal slivers, one of twice as many: the nine parts more that the budget allows are shared
 * alike. */
RT_TEST(the_budget_is_shared_by_the_areas_of_both_sides) {
    OWNED_SCENE scene = begin_scene();
    for (int i = 0; i < 9; i++) {
        float x = (float)(i % 3) * 0.3f + (i < 6 ? 0 : 1000), y = (float)(i % 6 / 3) * 0.3f;
        add_triangle(&scene, rt_vec3(x, y, 0), rt_vec3(x + 16, y + 16, 0), rt_vec3(x + 16, y + 15.9f, 0));
    }
    assert_ok(rt_scene_finish(&scene, error));
    OWNED_ACCEL RtBvh *bvh = open_valid(&scene, "bvh:build=spatial,budget=2,alpha=0,max_leaf_size=1");
    assert_int_equal(bvh->hierarchy.id_count, 18);
    uint32_t left = 0;
    for (uint32_t i = 0; i < bvh->hierarchy.id_count; i++) left += bvh->hierarchy.ids[i] < 6;
    assert_int_equal(left, 12);
}

RT_TEST(without_budget_or_overlap_it_is_the_binned_tree) {
    OWNED_SCENE scene = make_slivers(500, 2, 1, 0);
    OWNED_ACCEL RtBvh *binned = open_valid(&scene, "bvh");
    const char *specs[] = {"bvh:build=spatial,budget=1", "bvh:build=spatial,alpha=1"};
    for (int i = 0; i < 2; i++) {
        OWNED_ACCEL RtBvh *bvh = open_valid(&scene, specs[i]);
        const RtHierarchy *a = &binned->hierarchy, *b = &bvh->hierarchy;
        assert_false(b->split_refs);
        assert_int_equal(a->node_count, b->node_count);
        assert_memory_equal(a->nodes, b->nodes, a->node_count * sizeof(RtNode));
        assert_memory_equal(a->ids, b->ids, a->id_count * sizeof(uint32_t));
    }
}

RT_TEST(validate_misses_a_part_of_a_split_object) {
    OWNED_SCENE scene = make_slivers(200, 3, 1, 0);
    OWNED_ACCEL RtBvh *bvh = open_valid(&scene, "bvh:build=spatial,max_leaf_size=4");
    RtHierarchy *hierarchy = &bvh->hierarchy;
    assert_true(hierarchy->split_refs);
    uint32_t tried = 0;
    for (uint32_t i = 0; i < hierarchy->node_count; i++) {
        RtNode *node = &hierarchy->nodes[i];
        if (!rt_node_is_leaf(node)) continue;
        int axis = (int)(i % 3);
        float *hi = &node->box.hi.at[axis];
        assert_broken_by(&bvh->base, *hi, *hi - 0.5f * (*hi - node->box.lo.at[axis]), "part of object");
        tried++;
        if (rt_node_fanout(node) < 2) continue;
        uint32_t *ids = hierarchy->ids + node->first;
        assert_broken_by(&bvh->base, ids[0], ids[1], "twice");
    }
    assert_true(tried > 50);
}

/* ---- hostile rays ---- */

enum { RAYS = RT_SHARE(300, 100) };

static void assert_like_brute(const RtScene *scene, const char *spec, uint64_t seed) {
    OWNED_ACCEL RtBvh *bvh = open_valid(scene, spec);
    OWNED_ACCEL RtAccel *brute = open_accel(scene, "brute");
    OWNED_QUERY query = open_query(&bvh->base), truth = open_query(brute);
    RtRandom random = rt_random(seed, 1);
    for (int i = 0; i < RAYS; i++) {
        RtRay ray;
        RtHit hit, expected;
        bool blocked, is_blocked;
        const RtHierarchy *hierarchy = &bvh->hierarchy;
        const RtNode *node = &hierarchy->nodes[rt_random_below(&random, hierarchy->node_count)];
        aim_at_slivers(&random, scene, &node->box, &ray);
        rt_nearest(&query, &ray, 1, &hit, NULL);
        rt_nearest(&truth, &ray, 1, &expected, NULL);
        rt_occluded(&query, &ray, 1, &blocked, NULL);
        rt_occluded(&truth, &ray, 1, &is_blocked, NULL);
        assert_int_equal(hit.object, expected.object);
        assert_memory_equal(&hit.t, &expected.t, sizeof hit.t);
        assert_int_equal(blocked, is_blocked);
    }
}

RT_TEST(hostile_rays_hit_like_brute) {
    const char *specs[] = {"bvh:build=spatial",
                           "bvh:build=spatial,alpha=0,budget=16,max_leaf_size=1,traversal_cost=0",
                           "bvh:build=spatial,reinsertion=2,mailbox=off,budget=4"};
    const float scales[] = {1, 1, 1, 1e-20f, 1e16f, 0.01f}, offsets[] = {0, 1e6f, 1e5f, 0, 0, -3000};
    for (uint64_t round = 0; round < RT_SHARE(18, 6); round++) {
        OWNED_SCENE scene = make_slivers(160, round, scales[round % 6], offsets[round % 6]);
        for (int s = 0; s < 3; s++) assert_like_brute(&scene, specs[s], round);
    }
}

/* ---- limits ---- */

/* Enough objects for all threads to build the top, and for groups of more than SMALL references. */
RT_TEST(the_tree_is_the_same_bit_for_bit_on_any_number_of_threads) {
    const RtTreeOptions options = {.method = RT_TREE_SPATIAL,
                                   .spatial = {.bins = 16,
                                               .alpha = 1e-5,
                                               .budget = 1.5,
                                               .max_leaf_size = 8,
                                               .traversal = 1,
                                               .limit = UINT64_MAX}};
    OWNED_SCENE scene = make_slivers(12000, 7, 1, 0);
    OWNED_TREE one = {0};
    assert_ok(rt_tree_build(&one, &scene.geometry, &options, 1, error));
    assert_true(one.split_refs);
    assert_tree(&one);
    for (int threads = 2; threads <= 5; threads++) {
        OWNED_TREE other = {0};
        assert_ok(rt_tree_build(&other, &scene.geometry, &options, threads, error));
        assert_int_equal(one.used, other.used);
        assert_true(other.split_refs);
        assert_memory_equal(one.nodes, other.nodes, one.used * sizeof(RtTreeNode));
    }
}

RT_TEST(what_may_take_too_much_is_refused_with_what_would_fit) {
    OWNED_SCENE scene = make_slivers(1000, 5, 1, 0);
    RtTreeOptions options = {
        .method = RT_TREE_SPATIAL,
        .spatial = {
            .bins = 16, .alpha = 0, .budget = 4, .max_leaf_size = 8, .traversal = 1, .limit = 300000}};
    RtTree tree;
    RtError refusal;
    assert_int_equal(rt_tree_build(&tree, &scene.geometry, &options, 1, &refusal), RT_BAD_INPUT);
    const char *fits = strstr(refusal.message, "budget=");
    assert_non_null(fits);
    options.spatial.budget = atof(fits + strlen("budget="));
    assert_in_range((int64_t)options.spatial.budget, 1, 3);
    assert_ok(rt_tree_build(&tree, &scene.geometry, &options, 1, error));
    rt_tree_clear(&tree);
    options.spatial.limit = 1000;
    assert_bad_input(rt_tree_build(&tree, &scene.geometry, &options, 1, error), "another build");
}

RT_TEST(every_allocation_may_fail) {
    OWNED_SCENE scene = make_slivers(100, 6, 1, 0);
    assert_fails_cleanly(try_accel(&scene, "bvh:build=spatial,reinsertion=1", error), (void)0);
}

RT_TESTS(bvh_spatial, NULL, assert_nothing_is_kept)
