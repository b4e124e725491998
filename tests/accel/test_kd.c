/* SPDX-License-Identifier: Apache-2.0 */
/* accel/kd: splits computed by hand, invariants, each broken on purpose, and limits. */
#include "equivalence_testing.h"

#include "accel/kd/kd.h"

static void assert_split(const RtKd *kd, uint32_t node, uint32_t axis, float plane) {
    assert_false(rt_kd_is_leaf(&kd->nodes[node]));
    assert_int_equal(rt_kd_axis(&kd->nodes[node]), axis);
    assert_true(kd->nodes[node].split == plane);
}

static void assert_lists(const RtKd *kd, uint32_t node, uint32_t length, uint32_t first_id) {
    assert_true(rt_kd_is_leaf(&kd->nodes[node]));
    assert_int_equal(rt_kd_length(&kd->nodes[node]), length);
    if (length > 0) assert_int_equal(kd->ids[kd->nodes[node].first], first_id);
}

/* A horizontal square at height z. */
static void add_floor(RtScene *scene, float x, float y, float z, float size) {
    const RtVec3 v[4] = {{x, y, z}, {x + size, y, z}, {x + size, y + size, z}, {x, y + size, z}};
    assert_ok(rt_scene_add_polygon(scene, 0, v, 4, error));
}

/* Spheres with the boxes [0,1] and [3,4] x [0,1]^2 in [0,4] x [0,1]^2, of half areas 3, 3 and 9. Cutting at
 * x = 1 or 3 costs 0.3 * 9 + 3 + 7 for 18; what lies above 1, of half area 7, is then cut at 3 for
 * (0.3 * 7 + 3) * 0.8 instead of 7. */
RT_TEST(two_spheres_are_split_as_by_hand) {
    RtDescription d;
    OWNED_SCENE scene = begin_two_spheres();
    assert_ok(rt_scene_finish(&scene, error));
    RtKd *kd = open_valid(&scene, "kd:failures=0,traversal_cost=0.3,empty_bonus=0.2,max_leaf_size=0");
    assert_split(kd, 0, 0, 1);
    assert_lists(kd, 1, 1, 0);
    assert_split(kd, 2, 0, 3);
    assert_lists(kd, 3, 0, 0);
    assert_lists(kd, 4, 1, 1);
    rt_accel_describe(&kd->base, &d);
    rt_accel_destroy(&kd->base);
    assert_int_equal(d.interior, 2);
    assert_int_equal(d.leaves, 3);
    assert_int_equal(d.empty_leaves, 1);
    assert_int_equal(d.references, 2);
    assert_int_equal(d.depth, 2);
    assert_true(fabs(d.predicted_tests - 6.0 / 9) < 1e-12);
    assert_true(fabs(d.predicted_steps - (9 + 7 + 3 + 5 + 3) / 9.0) < 1e-12);
    assert_true(fabs(d.predicted_cost - (6 + 0.3 * 16) / 9) < 1e-12);

    assert_int_equal(describe_spec(&scene, "kd:traversal_cost=10,failures=0").leaves, 1);
    assert_int_equal(describe_spec(&scene, "kd:traversal_cost=10,failures=1").leaves, 2);
    assert_int_equal(describe_spec(&scene, "kd:max_depth=1").leaves, 2);
}

/* A floor in the lowest face of the scene gets a cell without width, so that rays that do not come down to it
 * leave it alone; one in the middle goes into one of the cells it parts. */
RT_TEST(polygons_in_a_plane_go_to_one_side_of_it) {
    OWNED_SCENE scene = begin_scene();
    add_floor(&scene, 0, 0, 0, 10);
    assert_ok(rt_scene_add_sphere(&scene, 0, rt_vec3(5, 5, 1.5f), 1, error));
    assert_ok(rt_scene_finish(&scene, error));
    OWNED_ACCEL RtKd *kd = open_valid(&scene, "kd:failures=0,traversal_cost=0.3");
    assert_split(kd, 0, 2, 0);
    assert_lists(kd, 1, 1, 0);
    assert_int_equal(kd->id_count, 2);
    rt_accel_destroy(&kd->base);
    rt_scene_clear(&scene);

    scene = begin_scene();
    for (int z = 0; z < 3; z++) add_floor(&scene, 0, 0, (float)z, 10);
    assert_ok(rt_scene_finish(&scene, error));
    kd = open_valid(&scene, "kd:traversal_cost=0");
    assert_int_equal(kd->id_count, 3);
    rt_accel_destroy(&kd->base);

    for (uint32_t nearer = 0; nearer < 2;
         nearer++) { /* into the smaller cell: the lower one, or the upper one */
        rt_scene_clear(&scene);
        scene = begin_scene();
        float middle = nearer == 0 ? 1 : 3;
        for (int z = 0; z < 3; z++) add_floor(&scene, 0, 0, z == 1 ? middle : (float)(2 * z), 10);
        assert_ok(rt_scene_finish(&scene, error));
        kd = open_valid(&scene, "kd:traversal_cost=0,max_depth=1,max_leaf_size=0");
        assert_split(kd, 0, 2, middle);
        assert_lists(kd, 1, 2 - nearer, 0);
        assert_lists(kd, 2, 1 + nearer, 2 - nearer);
        if (nearer == 0) rt_accel_destroy(&kd->base);
    }
}

/* Tiles of a floor and nothing else: cells are cut across it, never along it. */
RT_TEST(a_flat_scene_is_divided_within_its_plane) {
    OWNED_SCENE scene = begin_scene();
    for (int i = 0; i < 64; i++) add_floor(&scene, 2 * (float)(i % 8), (float)(i - i % 8) / 4, 5, 1);
    assert_ok(rt_scene_finish(&scene, error));
    OWNED_ACCEL RtKd *kd = open_valid(&scene, "kd:traversal_cost=0.3");
    assert_int_equal(kd->id_count, 64);
    for (uint32_t i = 0; i < kd->node_count; i++)
        assert_true(rt_kd_is_leaf(&kd->nodes[i]) ? rt_kd_length(&kd->nodes[i]) <= 1
                                                 : rt_kd_axis(&kd->nodes[i]) != 2);
}

/* Coincident objects cannot be separated: building stops whatever the parameters allow. */
RT_TEST(coincident_objects_stay_in_one_leaf) {
    OWNED_SCENE scene = make_row(30, 0);
    assert_int_equal(describe_spec(&scene, "kd:traversal_cost=0,failures=60,max_depth=60").leaves, 1);
    RtDescription d = describe_spec(&scene, "kd:traversal_cost=0,margin=0.5");
    assert_int_equal(d.references, 30);
    assert_int_equal(d.empty_leaves, 6); /* one at each face */
}

/* Ten parallel cylinders whose boxes overlap: only their surfaces can be separated. */
RT_TEST(slanted_objects_are_parted_by_their_surfaces) {
    OWNED_SCENE scene = begin_scene();
    for (int i = 0; i < 10; i++) {
        RtVec3 foot = rt_vec3(0, (float)i, 0), head = rt_vec3(10, (float)(i + 10), 0);
        assert_ok(rt_scene_add_cone(&scene, 0, foot, 0.1f, head, 0.1f, error));
    }
    assert_ok(rt_scene_finish(&scene, error));
    RtDescription box = describe_spec(&scene, "kd:max_depth=8");
    RtDescription exact = describe_spec(&scene, "kd:max_depth=8,overlap=exact");
    assert_true(exact.predicted_tests < 0.5 * box.predicted_tests);
}

static uint32_t find_leaf(const RtKd *kd, uint32_t least) {
    uint32_t i = 0;
    while (!rt_kd_is_leaf(&kd->nodes[i]) || rt_kd_length(&kd->nodes[i]) < least) i++;
    return i;
}

RT_TEST(validate_names_each_invariant_that_is_broken) {
    OWNED_SCENE scene = make_lattice(4, 4, 4);
    OWNED_ACCEL RtKd *kd = open_valid(&scene, "kd:max_leaf_size=4,margin=0.1");
    const RtAccel *accel = &kd->base;
    RtKdNode *root = &kd->nodes[0], *leaf = &kd->nodes[find_leaf(kd, 2)];
    assert_broken_by(accel, kd->box.hi.z, 1, "root does not contain");
    assert_broken_by(accel, root->link, (kd->node_count - 1) << 2, "outside the nodes");
    assert_broken_by(accel, root->split, 100, "outside its cell");
    assert_broken_by(accel, kd->max_depth, 2, "deeper than 2");
    assert_broken_by(accel, leaf->first, kd->id_count - 1, "outside the lists");
    uint32_t *ids = kd->ids + leaf->first, *last = &ids[rt_kd_length(leaf) - 1];
    assert_broken_by(accel, ids[0], ids[1], "not ascending ids");
    assert_broken_by(accel, leaf->link, leaf->link - 4, "but the lists end");
    assert_true(*last != 63);
    assert_broken_by(accel, *last, 63, "not just those it has a part in");
    assert_broken_by(accel, *root, ((RtKdNode){.first = 0, .link = RT_KD_LEAF}), "has no parent");
    assert_ok(rt_accel_validate(accel, error));
}

RT_TEST(a_tree_beyond_the_limit_of_memory_is_refused_with_what_would_fit) {
    static const char *const scenes[] = {"balls", "random:n=3000,radius=2", "random:n=3000,shape=mixed"};
    static const char *const specs[] = {"traversal_cost=0,failures=60,max_depth=40", "",
                                        "traversal_cost=0,failures=60,overlap=exact,empty_bonus=1"};
    for (size_t i = 0; i < 9; i++) {
        const uint64_t limit = 1 << 15;
        RtValue values[RT_KD_PARAM_COUNT], *max_depth = &values[RT_KD_MAX_DEPTH];
        long depth;
        OWNED_SCENE scene = open_scene(scenes[i % 3]);
        assert_ok(rt_params_parse(rt_kd_params, RT_KD_PARAM_COUNT, specs[i / 3], "kd", values, error));
        assert_true(refused_bytes("kd", limit, &scene, values, &depth) > (double)limit);
        assert_true(depth >= 3);
        assert_true(fits_within("kd", limit, &scene, values, max_depth, depth));
        assert_false(fits_within("kd", limit, &scene, values, max_depth, depth + 6));
    }
}

/* Enough objects for cells to be deferred. */
RT_TEST(the_tree_is_the_same_bit_for_bit_on_any_number_of_threads) {
    const char *specs[] = {"kd", "kd:overlap=exact,max_leaf_size=4,failures=4"};
    OWNED_SCENE scene = open_scene("random:n=100000,shape=mixed,distribution=clustered");
    for (size_t i = 0; i < sizeof specs / sizeof specs[0]; i++) {
        RtAccel *one, *other;
        assert_ok(rt_accel_open_on(specs[i], &scene, 1, &one, error));
        for (int threads = 2; threads <= 3; threads++) {
            assert_ok(rt_accel_open_on(specs[i], &scene, threads, &other, error));
            const RtKd *a = (const RtKd *)one, *b = (const RtKd *)other;
            assert_int_equal(a->node_count, b->node_count);
            assert_int_equal(a->id_count, b->id_count);
            assert_memory_equal(a->nodes, b->nodes, a->node_count * sizeof(RtKdNode));
            assert_memory_equal(a->ids, b->ids, a->id_count * sizeof(uint32_t));
            rt_accel_destroy(other);
        }
        rt_accel_destroy(one);
    }
}

RT_TEST(several_threads_refuse_what_one_refuses_and_leave_nothing_behind) {
    RtValue values[RT_KD_PARAM_COUNT];
    const RtAccelOps *ops;
    assert_ok(rt_accel_find("kd", &ops, error));
    OWNED_SCENE scene = open_scene("random:n=70000");
    assert_ok(rt_params_parse(rt_kd_params, RT_KD_PARAM_COUNT, "", "kd", values, error));
    int64_t live = rt_alloc_live();
    /* Exceeded in the top, in a subtree, only by the sum. */
    for (uint64_t limit = 1 << 12; limit <= 1 << 20; limit *= 16) {
        RtError refusals[2];
        for (int t = 0; t < 2; t++) {
            RtAccel *accel = NULL;
            RtBuild what = {&scene, values, t + 1, limit, NULL};
            assert_int_equal(rt_accel_build_layer(ops, &what, NULL, &accel, &refusals[t]), RT_BAD_INPUT);
            assert_int_equal(rt_alloc_live(), live);
        }
        assert_string_equal(refusals[0].message, refusals[1].message);
    }
    for (uint64_t n = 1; n < 400; n += 1 + n / 8) {
        RtAccel *accel = NULL;
        RtError failure = {RT_OK, ""};
        rt_alloc_fail_at(n);
        RtStatus status = rt_accel_open_on("kd", &scene, 2, &accel, &failure);
        rt_alloc_fail_at(0);
        assert_true(status == RT_NO_MEMORY || status == RT_OK);
        if (status == RT_OK) rt_accel_destroy(accel);
        assert_int_equal(rt_alloc_live(), live);
    }
}

/* Triangles that share a corner are in most cells near it, whose waiting lists take more than the tree. */
RT_TEST(objects_in_many_cells_are_refused_alike_on_any_number_of_threads_with_little_memory) {
    enum { OBJECTS = 66000 }; /* on two threads cells are shared */
    const uint64_t limit = 8 << 20;
    RtValue values[RT_KD_PARAM_COUNT];
    RtError refusals[3];
    const RtAccelOps *ops;
    assert_ok(rt_accel_find("kd", &ops, error));
    assert_ok(rt_params_parse(rt_kd_params, RT_KD_PARAM_COUNT, "", "kd", values, error));
    OWNED_SCENE scene = begin_scene();
    for (int i = 1; i <= OBJECTS; i++) {
        const RtVec3 v[3] = {{0, 0, 0}, {(float)i, 0, 0}, {0, (float)i, 0}};
        assert_ok(rt_scene_add_polygon(&scene, 0, v, 3, error));
    }
    assert_ok(rt_scene_finish(&scene, error));
    for (int t = 0; t < 3; t++) {
        RtAccel *accel = NULL;
        const RtBuild what = {&scene, values, t + 1, limit, NULL};
        rt_memory_limit(5 * limit + 600 * OBJECTS);
        const RtStatus status = rt_accel_build_layer(ops, &what, NULL, &accel, &refusals[t]);
        assert_int_equal(rt_memory_unlimit(status, &refusals[t]), RT_BAD_INPUT);
        assert_string_equal(refusals[t].message, refusals[0].message);
    }
}

/* Combinations of parameters, which the spread of the conformance test does not vary together. */
RT_TEST(every_structure_answers_like_brute) {
    static const char *const specs[] = {"kd:overlap=exact,traversal_cost=0,failures=4",
                                        "kd:overlap=exact,max_leaf_size=3,margin=0.3,mailbox=off",
                                        "kd:traversal_cost=0,failures=9,empty_bonus=1",
                                        "kd:overlap=exact,max_depth=4,failures=60"};
    for (size_t s = 0; s < rt_family_count(); s++) {
        OWNED_BENCH bench;
        set_up_family(&bench, s, 7, 32);
        for (size_t i = 0; i < sizeof specs / sizeof specs[0]; i++)
            assert_true(conforms(&bench, specs[i], "instances in instances need mailbox=on"));
    }
}

RT_TESTS(kd, NULL, assert_nothing_is_kept)
