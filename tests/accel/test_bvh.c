/* SPDX-License-Identifier: Apache-2.0 */
/* accel/bvh: invariants, each broken on purpose, and depth. */
#include "accel_testing.h"
#include "clock_testing.h"
#include "random_testing.h"

#include "accel/bvh/bvh.h"

RT_TEST(validate_names_each_invariant_that_is_broken) {
    OWNED_SCENE scene = make_row(16, 3), same = make_row(2, 0);
    OWNED_ACCEL RtAccel *accel = open_valid(&scene, "bvh:max_leaf_size=1");
    RtHierarchy *hierarchy = &((RtBvh *)accel)->hierarchy;
    RtNode *root = hierarchy->nodes;
    assert_broken_by(accel, root->box.hi.x, root->box.hi.x - 1, "bvh: node 0 does not contain its child");
    assert_broken_by(accel, root->first, 0, "children that are not there");
    assert_broken_by(accel, root->first, hierarchy->node_count - 1, "children that are not there");
    assert_broken_by(accel, root->count, 3, "node 0 has 3 children, not 2 to 2"); /* it is binary */
    for (uint32_t i = 0; i < hierarchy->node_count; i++) {
        if (!rt_node_is_leaf(&root[i])) continue;
        assert_broken_by(accel, root[i].box.lo.y, 0, "does not contain its object");
    }

    OWNED_ACCEL RtAccel *leaf = open_valid(&same, "bvh:max_leaf_size=2");
    hierarchy = &((RtBvh *)leaf)->hierarchy;
    assert_broken_by(leaf, hierarchy->ids[1], hierarchy->ids[0], "object 0 is in 2 leaves");
    assert_broken_by(leaf, hierarchy->ids[1], 7, "holds no object");
    assert_broken_by(leaf, hierarchy->nodes[0].first, 1, "holds no object");
    assert_broken_by(leaf, hierarchy->nodes[0].count, RT_NODE_LEAF | 1, "is in 0 leaves");
}

/* Every inner node gets a leaf and the next inner node as children. */
RT_TEST(validate_names_a_node_that_is_too_deep) {
    OWNED_SCENE scene = make_row(RT_TREE_MAX_DEPTH + 3, 0);
    OWNED_ACCEL RtBvh *bvh = open_valid(&scene, "bvh:max_leaf_size=1");
    RtNode *nodes = bvh->hierarchy.nodes;
    RtBox box = nodes[0].box;
    for (uint32_t i = 0; i + 1 < scene.geometry.object_count; i++) {
        nodes[2 * i] = (RtNode){.box = box, .first = 2 * i + 1, .count = 2};
        nodes[2 * i + 1] = (RtNode){.box = box, .first = i, .count = RT_NODE_LEAF | 1};
    }
    assert_broken(&bvh->base, "node 129 is too deep");
}

static const char *const builds[] = {"binned,bins=2", "sweep", "lbvh", "lbvh,bits=1", "ploc"};
enum { BUILD_COUNT = sizeof builds / sizeof builds[0] };

RT_TEST(coincident_objects_are_halved_within_the_depth_limit) {
    OWNED_SCENE scene = make_row(1000, 0);
    for (int b = 0; b < BUILD_COUNT; b++) {
        char spec[64];
        snprintf(spec, sizeof spec, "bvh:max_leaf_size=1,build=%s", builds[b]);
        RtDescription description = describe_spec(&scene, spec);
        assert_int_equal(description.leaves, 1000);
        assert_int_equal(description.depth, 10);
    }
}

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

RT_TEST(the_predicted_cost_of_two_disjoint_spheres_is_the_sum_by_hand) {
    OWNED_SCENE scene = make_row(2, 8);
    RtDescription description = describe_spec(&scene, "bvh:max_leaf_size=1,traversal_cost=0.5");
    /* Root 10 x 2 x 2: half area 44; each leaf 2 x 2 x 2: 12. 0.5 + 12 / 44 + 12 / 44. */
    assert_true(fabs(description.predicted_cost - (0.5 + 24.0 / 44.0)) < 1e-12);
    assert_int_equal(description.interior, 1);
    assert_int_equal(description.leaves, 2);
    assert_int_equal(description.references, 2);
    assert_int_equal(description.depth, 1);
}

RT_TEST(a_build_stays_on_its_threads_and_does_not_depend_on_them) {
    RtSpec spec;
    OWNED_ACCEL RtAccel *first = NULL;
    OWNED_SCENE scene = begin_scene();
    RtRandom random = rt_random(1, 1);
    for (int i = 0; i < 30000; i++)
        assert_ok(rt_scene_add_sphere(&scene, 0, rt_random_point(&random, 10), 0.1f, error));
    assert_ok(rt_scene_finish(&scene, error));
    assert_ok(rt_spec_parse("bvh:build=lbvh,reinsertion=3", &spec, error));
    for (int threads = 1; threads <= 3; threads++) {
        OWNED_ACCEL RtAccel *accel = NULL;
        Labour before = labour_so_far();
        assert_ok(rt_accel_build(&spec, &scene, threads, &accel, error));
        if (threads == 1) {
            Labour labour = labour_since(before);
            assert_true(labour.others < 0.05 * labour.own);
            first = accel;
            accel = NULL;
            continue;
        }
        const RtHierarchy *a = &((const RtBvh *)first)->hierarchy, *b = &((const RtBvh *)accel)->hierarchy;
        assert_int_equal(a->node_count, b->node_count);
        assert_memory_equal(a->nodes, b->nodes, a->node_count * sizeof(RtNode));
    }
}

RT_TESTS(bvh, NULL, NULL)
