/* SPDX-License-Identifier: Apache-2.0 */
/* accel/clusters: every kind of extent with every order and method is exact; the shape of nodes; invariants,
 * each broken on purpose. */
#include "equivalence_testing.h"

#include "accel/clusters/clusters.h"

static const char *const methods[] = {"agglomerative", "ploc", "goldsmith-salmon", "rubin-whitted", "sah"};
enum { METHOD_COUNT = sizeof methods / sizeof methods[0] };

/* Every kind with every order and method, on wide nodes and full leaves: several parameters at a time. */
RT_TEST(every_combination_answers_like_brute) {
    static const char *const shapes[] = {"width=2", "width=5,max_leaf_size=4", "width=16,max_leaf_size=32"};
    static const char *const kinds[] = {"box", "sphere", "obb", "slabs"};
    static const char *const families[] = {"mixed", "duplicates", "huge-beside-tiny", "mixed-far"};
    for (size_t f = 0; f < 4; f++) {
        OWNED_BENCH bench;
        set_up_family(&bench, scene_family(families[f]), 3, 64);
        for (size_t i = 0; i < 4 * 2 * 3 * METHOD_COUNT; i++) {
            char spec[RT_MAX_SPEC_CHARS];
            snprintf(spec, sizeof spec, "clusters:extent=%s,traversal_order=%s,%s,method=%s", kinds[i % 4],
                     i / 4 % 2 ? "fixed" : "nearest", shapes[i / 8 % 3], methods[i / 24]);
            assert_gives(&bench.reference, spec);
        }
    }
}

RT_TEST(widening_opens_the_largest_child_and_lowers_the_predicted_cost_by_its_visit) {
    OWNED_SCENE scene = make_row(6, 4);
    /* Medians: {0 1 2} and {3 4 5}, both of {a b} and {c}. Boxes of n spheres are 4 n - 2 long: half areas 92
     * for six, 44 for three, 28 for two, 12 for one. */
    static const struct {
        const char *spec;
        uint32_t interior;
        double cost;
    } rows[] = {
        {"clusters:method=rubin-whitted,width=2", 5, (92 + 2 * 44 + 2 * 28 + 6 * 12) / 92.0},
        {"clusters:method=rubin-whitted,width=3", 3, (92 + 44 + 28 + 6 * 12) / 92.0},
        {"clusters:method=rubin-whitted,width=4", 3, (92 + 2 * 28 + 6 * 12) / 92.0},
        {"clusters:method=rubin-whitted,width=16", 1, (92 + 6 * 12) / 92.0},
        {"clusters:method=rubin-whitted,width=16,extent=sphere", 1, (92 + 6 * 12) / 92.0},
    };
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        RtDescription description = describe_spec(&scene, rows[i].spec);
        assert_int_equal(description.interior, rows[i].interior);
        assert_int_equal(description.leaves, 6);
        assert_int_equal(description.references, 6);
        assert_true(fabs(description.predicted_cost - rows[i].cost) < 1e-12);
    }
}

RT_TEST(objects_share_a_leaf_where_that_costs_no_more) {
    OWNED_SCENE apart = make_row(2, 4), same = make_row(2, 0);
    OWNED_ACCEL RtClusters *two = open_valid(&apart, "clusters:max_leaf_size=2");
    assert_int_equal(two->hierarchy.node_count, 3); /* 28 * 2 > 28 + 2 * 12 */
    OWNED_ACCEL RtClusters *one = open_valid(&same, "clusters:max_leaf_size=2");
    assert_int_equal(one->hierarchy.node_count, 1);
}

RT_TEST(groups_of_spheres_get_tight_extents) {
    OWNED_SCENE scene = make_row(2, 4); /* a capsule 6 long, 2 thick */
    OWNED_ACCEL RtClusters *self = open_valid(&scene, "clusters:extent=sphere");
    assert_true(self->set.balls[0].radius >= 3 && self->set.balls[0].radius < 3.000001);
    rt_accel_destroy(&self->base);
    rt_scene_clear(&scene);

    scene = begin_scene();
    for (int i = 0; i < 8; i++)
        assert_ok(rt_scene_add_sphere(&scene, 0, rt_vec3(3 * (float)i, 4 * (float)i, 0), 1, error));
    assert_ok(rt_scene_finish(&scene, error));
    self = open_valid(&scene, "clusters:extent=obb");
    /* Along the diagonal: 37 x 2 x 2. */
    const double *half = self->set.oriented[0].half;
    assert_true(fabs(half[0] * half[1] * half[2] - 18.5) < 1e-6);
}

/* ---- broken on purpose ---- */

/* The first leaf in the array. */
static uint32_t some_leaf(const RtClusters *self) {
    uint32_t i = 0;
    while (!rt_node_is_leaf(&self->hierarchy.nodes[i])) i++;
    return i;
}

RT_TEST(validate_names_each_invariant_of_the_tree_that_is_broken) {
    OWNED_SCENE scene = make_row(16, 4);
    OWNED_ACCEL RtClusters *self = open_valid(&scene, "clusters:width=4");
    const RtAccel *accel = &self->base;
    RtHierarchy *hierarchy = &self->hierarchy;
    RtNode *root = hierarchy->nodes, *leaf = &root[some_leaf(self)];
    assert_broken_by(accel, root->box.hi.x, root->box.hi.x - 1, "node 0 does not contain its child");
    assert_broken_by(accel, root->count, 5, "node 0 has 5 children, not 2 to 4");
    assert_broken_by(accel, root->count, 1, "node 0 has 1 children, not 2 to 4");
    assert_broken_by(accel, root->first, 0, "node 0 has children that are not there");
    assert_broken_by(accel, root->first, hierarchy->node_count - 1, "node 0 has children that are not there");
    assert_broken_by(accel, leaf->box.lo.y, 0, "does not contain its object");
    assert_broken_by(accel, leaf->count, RT_NODE_LEAF | 2, "has 2 objects, not 1 to 1");
    assert_broken_by(accel, leaf->count, RT_NODE_LEAF, "has 0 objects");
    assert_broken_by(accel, leaf->first, 16, "holds no object");
    assert_broken_by(accel, hierarchy->ids[leaf->first], 99, "holds no object");
}

RT_TEST(validate_names_what_is_in_the_tree_twice_or_not_at_all_or_too_deep) {
    enum { COUNT = 80 };
    OWNED_SCENE scene = make_row(2, 4), three = make_row(3, 4), row = make_row(COUNT, 4);
    for (uint32_t i = 0; i < 2; i++) scene.geometry.boxes[i] = scene.geometry.box;
    OWNED_ACCEL RtClusters *self = open_valid(&scene, "clusters");
    self->hierarchy.ids[1] = self->hierarchy.ids[0];
    assert_broken(&self->base, "in 2 leaves");
    self->hierarchy.node_count = 1;
    assert_broken(&self->base, "children that are not there");
    rt_accel_destroy(&self->base);

    self = open_valid(&three, "clusters:method=rubin-whitted,width=2,max_leaf_size=3");
    RtNode root = self->hierarchy.nodes[0];
    assert_int_equal(self->hierarchy.node_count, 5);
    assert_broken_by(&self->base, self->hierarchy.nodes[0], ((RtNode){root.box, 0, RT_NODE_LEAF | 3}),
                     "1 of 5 nodes are in the tree");
    RtNode two = self->hierarchy.nodes[1], one = self->hierarchy.nodes[2];
    self->hierarchy.nodes[1] = one;
    self->hierarchy.nodes[2] = two;
    assert_broken(&self->base, "the ids of leaf 1 begin at 2, not at 0");
    self->hierarchy.nodes[1] = two;
    assert_broken(&self->base, "has two parents");
    rt_accel_destroy(&self->base);

    /* A chain by hand: node 2 i has a leaf and the rest. */
    self = open_valid(&row, "clusters:width=2");
    for (uint32_t i = 0; i < COUNT; i++) {
        self->hierarchy.ids[i] = i;
        uint32_t leaf = i + 1 < COUNT ? 2 * i + 1 : 2 * i;
        if (i + 1 < COUNT) self->hierarchy.nodes[2 * i] = (RtNode){row.geometry.box, 2 * i + 1, 2};
        self->hierarchy.nodes[leaf] = (RtNode){row.geometry.boxes[i], i, RT_NODE_LEAF | 1};
    }
    assert_broken(&self->base, "too deep");
}

RT_TEST(validate_names_the_extent_that_does_not_hold_its_objects) {
    OWNED_SCENE scene = make_row(8, 4);
    OWNED_ACCEL RtClusters *spheres = open_valid(&scene, "clusters:extent=sphere");
    spheres->set.balls[0].radius *= 1 - 1e-4;
    assert_broken(&spheres->base, "clusters: the sphere 0 does not contain object");
    OWNED_ACCEL RtClusters *boxes = open_valid(&scene, "clusters:extent=obb");
    boxes->set.oriented[1].half[0] *= 0.99;
    assert_broken(&boxes->base, "clusters: the oriented box 1 does not contain object");
    OWNED_ACCEL RtClusters *slabs = open_valid(&scene, "clusters:extent=slabs,slabs=13");
    slabs->set.slabs[2 * 13 + 12].lo += 0.01f;
    assert_broken(&slabs->base, "clusters: the set of slabs 2 does not contain object");
}

RT_TESTS(clusters, NULL, NULL)
