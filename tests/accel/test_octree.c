/* SPDX-License-Identifier: Apache-2.0 */
/* accel/octree: invariants, each broken on purpose, the cells of objects, and limits. */
#include "equivalence_testing.h"

#include "accel/octree/octree.h"

/* Spheres of radius 1/4 along the x axis. */
static RtScene make_spheres_at(const float *x, int count) {
    RtScene scene = begin_scene();
    for (int i = 0; i < count; i++)
        assert_ok(rt_scene_add_sphere(&scene, 0, rt_vec3(x[i], 0, 0), 0.25f, error));
    assert_ok(rt_scene_finish(&scene, error));
    return scene;
}

/* The planes of the root's split go halfway through the box, where all eight spheres touch one another's. */
RT_TEST(objects_go_into_every_leaf_they_touch) {
    OWNED_SCENE scene = make_lattice(2, 2, 2);
    RtDescription d = describe_spec(&scene, "octree:max_leaf_size=1,max_depth=1");
    assert_int_equal(d.interior, 1);
    assert_int_equal(d.leaves, 8);
    assert_int_equal(d.references, 64);
    assert_true(fabs(d.predicted_cost - 64.0 / 4.0) < 1e-6);
    d = describe_spec(&scene, "octree:max_depth=0");
    assert_int_equal(d.interior, 0);
    assert_int_equal(d.references, 8);
}

/* The mean of three spheres at 0, 1 and 9 is 10/3, where most of them are; the centre is 4.5. */
RT_TEST(a_split_by_cost_is_nearer_to_the_objects) {
    OWNED_SCENE apart = make_spheres_at((const float[]){0, 1, 9}, 3);
    OWNED_ACCEL RtOctree *centre = open_valid(&apart, "octree:max_leaf_size=1,split=centre");
    OWNED_ACCEL RtOctree *cost = open_valid(&apart, "octree:max_leaf_size=1,split=cost");
    assert_true(centre->nodes[0].split.x == 4.5f);
    assert_true(cost->nodes[0].split.x < 4.5f && cost->nodes[0].split.x >= 1);
    assert_ok(rt_accel_validate(&cost->base, error));
}

/* Thirty objects with the same box cannot be separated, so no depth is spent on them. */
RT_TEST(coincident_objects_stay_in_one_leaf) {
    OWNED_SCENE same = make_row(30, 0);
    assert_int_equal(describe_spec(&same, "octree:max_depth=20").leaves, 1);
    assert_int_equal(describe_spec(&same, "octree:max_depth=3,margin=0.1").depth, 3);
    assert_int_equal(describe_spec(&same, "octree:max_depth=2,cut_filled=on").leaves, 64);
}

/* Spheres at -2 and 2, with boxes up to 1.75 away from the plane between. */
RT_TEST(slack_grows_the_boxes_of_objects) {
    OWNED_SCENE apart = make_spheres_at((const float[]){-2, 2}, 2);
    assert_int_equal(describe_spec(&apart, "octree:max_leaf_size=1,max_depth=1").references, 8);
    assert_int_equal(describe_spec(&apart, "octree:max_leaf_size=1,max_depth=1,slack=1.74").references, 8);
    assert_int_equal(describe_spec(&apart, "octree:max_leaf_size=1,max_depth=1,slack=1.76").references, 16);
    OWNED_ACCEL RtOctree *tree = open_valid(&apart, "octree:max_leaf_size=1,max_depth=1,slack=1.76");
    assert_broken_by(&tree->base, tree->slack, 0, "which it does not touch");
}

/* The first leaf, from the root on, with `least` objects or more. */
static uint32_t find_leaf(const RtOctree *tree, uint32_t least) {
    uint32_t i = 0;
    while (rt_octree_is_inner(&tree->nodes[i]) || tree->nodes[i].count < least) i++;
    return i;
}

RT_TEST(validate_names_each_invariant_that_is_broken) {
    OWNED_SCENE scene = make_lattice(4, 4, 4);
    OWNED_ACCEL RtOctree *tree = open_valid(&scene, "octree:max_leaf_size=1,max_depth=3,margin=0.1");
    const RtAccel *accel = &tree->base;
    RtOctreeNode *root = &tree->nodes[0], *leaf = &tree->nodes[find_leaf(tree, 2)];
    assert_broken_by(accel, tree->boxes[0].hi.z, 1, "root does not contain");
    assert_broken_by(accel, root->first, tree->node_count - 7, "outside the nodes");
    assert_broken_by(accel, root->split.y, 100, "outside its cell");
    assert_broken_by(accel, root->count, root->count ^ 1, "not as empty as its parent says");
    assert_broken_by(accel, tree->nodes[1].parent, 9, "not a child of its parent");
    assert_broken_by(accel, tree->boxes[5].lo.x, tree->boxes[5].lo.x - 1, "not cut from its parent's");
    assert_broken_by(accel, tree->max_depth, 2, "deeper than 2");
    assert_broken_by(accel, tree->max_depth, 20, "could be divided");
    assert_broken_by(accel, leaf->first, tree->id_count - leaf->count + 1, "outside the lists");
    uint32_t *last = &tree->ids[leaf->first + leaf->count - 1];
    assert_broken_by(accel, *last, 63, "which it does not touch");
    assert_broken_by(accel, *last, 64, "not ascending ids");
    assert_true(leaf->count > 1);
    assert_broken_by(accel, tree->ids[leaf->first], tree->ids[leaf->first + 1], "not ascending ids");
    assert_broken_by(accel, leaf->count, leaf->count - 1, "leaves, but");
    assert_ok(rt_accel_validate(accel, error));
}

static void parse(const char *parameters, RtValue *values) {
    assert_ok(rt_params_parse(rt_octree_params, RT_OCTREE_PARAM_COUNT, parameters, "octree", values, error));
}

RT_TEST(an_octree_beyond_the_limit_of_memory_is_refused_with_what_would_fit) {
    OWNED_SCENE scene = make_lattice(2, 2, 2);
    RtValue values[RT_OCTREE_PARAM_COUNT];
    long depth;
    const uint64_t limit = 1 << 16;
    parse("max_leaf_size=1,max_depth=20,margin=0.01", values);
    assert_true(refused_bytes("octree", limit, &scene, values, &depth) > (double)limit);

    assert_true(fits_within("octree", limit, &scene, values, &values[RT_OCTREE_MAX_DEPTH], depth));
    assert_false(fits_within("octree", limit, &scene, values, &values[RT_OCTREE_MAX_DEPTH], depth + 1));
}

/* Counting bytes while building stops at the limit, and cannot predict so much more. */
RT_TEST(far_too_deep_an_octree_is_refused_by_an_estimate) {
    static const char *const scenes[] = {"balls", "tetra", "random:n=20000,radius=1",
                                         "random:n=5000,distribution=stadium"};
    static const char *const specs[] = {"max_leaf_size=1,max_depth=20",
                                        "max_leaf_size=1,max_depth=20,split=cost",
                                        "max_depth=20,max_leaf_size=3,margin=0.01"};
    for (size_t i = 0; i < sizeof scenes / sizeof scenes[0]; i++) {
        OWNED_SCENE scene = open_scene(scenes[i]);
        for (size_t k = 0; k < sizeof specs / sizeof specs[0]; k++) {
            const uint64_t limit = UINT64_C(1) << 23;
            RtValue values[RT_OCTREE_PARAM_COUNT];
            long depth;
            parse(specs[k], values);
            assert_true(refused_bytes("octree", limit, &scene, values, &depth) > 1000.0 * (double)limit);
            assert_true(depth >= 4);
            assert_true(fits_within("octree", limit, &scene, values, &values[RT_OCTREE_MAX_DEPTH], depth));
            assert_false(
                fits_within("octree", limit, &scene, values, &values[RT_OCTREE_MAX_DEPTH], depth + 2));
        }
    }
}

RT_TEST(the_estimate_is_near_what_a_build_takes) {
    static const char *const specs[] = {"max_leaf_size=1,max_depth=9",
                                        "max_leaf_size=1,max_depth=8,split=cost",
                                        "max_depth=9,max_leaf_size=3"};
    OWNED_SCENE scene = open_scene("balls");
    for (size_t i = 0; i < sizeof specs / sizeof specs[0]; i++) {
        RtValue values[RT_OCTREE_PARAM_COUNT];
        RtAccel *accel;
        RtDescription description;
        long depth;
        parse(specs[i], values);
        double estimate = refused_bytes("octree", 1 << 20, &scene, values, &depth);
        assert_ok(build_within("octree", 1 << 28, &scene, values, &accel, error));
        rt_accel_describe(accel, &description);
        rt_accel_destroy(accel);
        double ratio = estimate / (double)description.bytes;
        if (!(ratio > 0.75 && ratio < 1.33)) fail_msg("%s: %g of what is taken", specs[i], ratio);
    }
}

/* Combinations that the spread of the conformance test does not contain. */
RT_TEST(every_traversal_answers_like_brute_in_every_structure) {
    static const char *const traversals[] = {"points", "neighbours", "parametric"};
    static const char *const settings[] = {"max_leaf_size=1,split=cost,mailbox=off",
                                           "margin=0.3,max_leaf_size=3", "max_depth=0",
                                           "max_leaf_size=1,max_depth=6,mailbox=off"};
    for (size_t s = 0; s < rt_family_count(); s++) {
        OWNED_BENCH bench;
        set_up_family(&bench, s, 7, RT_SHARE(32, 16));
        for (size_t i = 0; i < 12; i++) {
            char spec[RT_MAX_SPEC_CHARS];
            snprintf(spec, sizeof spec, "octree:traversal=%s,%s", traversals[i % 3], settings[i / 3]);
            assert_true(conforms(&bench, spec, "instances in instances need mailbox=on"));
        }
    }
}

RT_TESTS(octree, NULL, NULL)
