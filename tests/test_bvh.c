/* accel/bvh.c from the inside: its invariants, broken on purpose, and its depth. */
#include "accel_testing.h"

#include "accel/bvh.c"

#include <string.h>

/* `count` unit spheres in a row along x, `apart` from centre to centre. */
static void make_row(RtScene *scene, uint32_t count, float apart) {
    uint32_t material;
    RtMaterial grey = rt_default_material();
    rt_scene_init(scene);
    assert_ok(rt_scene_add_material(scene, &grey, &material, error));
    for (uint32_t i = 0; i < count; i++) {
        assert_ok(rt_scene_add_sphere(scene, material, rt_vec3(apart * (float)i, 0, 0), 1, error));
    }
    assert_ok(rt_scene_finish(scene, error));
}

static Bvh *make_bvh(const RtScene *scene, const char *params_text) {
    RtValue values[PARAM_COUNT];
    RtAccel *accel = NULL;
    assert_ok(rt_params_parse(params, PARAM_COUNT, params_text, "bvh", values, error));
    assert_ok(build(scene, values, &accel, error));
    return (Bvh *)accel;
}

static void validate_names_each_invariant_that_is_broken(void **state) {
    (void)state;
    RtScene scene;
    make_row(&scene, 16, 3);
    Bvh *bvh = make_bvh(&scene, "leaf=1");
    assert_ok(validate(&bvh->base, error));

    Node root = bvh->nodes[0];
    bvh->nodes[0].box.hi.x -= 1;
    assert_broken(&bvh->base, "does not contain its child");
    bvh->nodes[0].first = 0;
    assert_broken(&bvh->base, "children that are not there");
    bvh->nodes[0].first = bvh->node_count - 1;
    assert_broken(&bvh->base, "children that are not there");
    bvh->nodes[0] = root;

    for (uint32_t i = 0; i < bvh->node_count; i++) {
        if (bvh->nodes[i].count == 0) continue;
        Node leaf = bvh->nodes[i];
        bvh->nodes[i].box.lo.y = 0;
        assert_broken(&bvh->base, "does not contain its object");
        bvh->nodes[i] = leaf;
    }

    destroy(&bvh->base);
    rt_scene_clear(&scene);

    make_row(&scene, 2, 0);
    Bvh *pair = make_bvh(&scene, "leaf=2");
    pair->ids[1] = pair->ids[0];
    assert_broken(&pair->base, "object 0 is in a leaf twice");
    pair->ids[1] = 7;
    assert_broken(&pair->base, "holds no object");
    pair->ids[1] = 1 - pair->ids[0];
    pair->nodes[0].first = 1;
    assert_broken(&pair->base, "holds no object");
    pair->nodes[0].first = 0;
    pair->nodes[0].count = 1;
    assert_broken(&pair->base, "is in no leaf");
    destroy(&pair->base);
    rt_scene_clear(&scene);
}

/* Every inner node gets a leaf and the next inner node as children. */
static void validate_names_a_node_that_is_too_deep(void **state) {
    (void)state;
    RtScene scene;
    make_row(&scene, MAX_DEPTH + 2, 0);
    Bvh *bvh = make_bvh(&scene, "leaf=1");
    RtBox box = bvh->nodes[0].box;
    for (uint32_t i = 0; i + 1 < scene.geometry.object_count; i++) {
        bvh->nodes[2 * i] = (Node){.box = box, .first = 2 * i + 1};
        bvh->nodes[2 * i + 1] = (Node){.box = box, .first = i, .count = 1};
    }
    assert_broken(&bvh->base, "node 127 is too deep");
    destroy(&bvh->base);
    rt_scene_clear(&scene);
}

static void coincident_objects_are_halved_within_the_depth_limit(void **state) {
    (void)state;
    RtScene scene;
    make_row(&scene, 1000, 0);
    Bvh *bvh = make_bvh(&scene, "leaf=1");
    RtDescription description;
    describe(&bvh->base, &description);
    assert_ok(validate(&bvh->base, error));
    assert_int_equal(description.leaves, 1000);
    assert_int_equal(description.depth, 10);
    destroy(&bvh->base);
    rt_scene_clear(&scene);
}

/* Spheres at distances that grow by powers of 2: a split always cuts off the last few, the worst case in
 * depth. */
static void a_chain_of_growing_distances_stays_within_the_depth_limit(void **state) {
    (void)state;
    RtScene scene;
    uint32_t material;
    RtMaterial grey = rt_default_material();
    rt_scene_init(&scene);
    assert_ok(rt_scene_add_material(&scene, &grey, &material, error));
    float x = 1e-17f;
    for (int i = 0; i < 110; i++, x *= 2) {
        for (int copy = 0; copy < 40; copy++) {
            assert_ok(rt_scene_add_sphere(&scene, material, rt_vec3(x, 0, 0), x / 8, error));
        }
    }
    assert_ok(rt_scene_finish(&scene, error));
    Bvh *bvh = make_bvh(&scene, "leaf=1,bins=2");
    assert_ok(validate(&bvh->base, error));
    RtDescription description;
    describe(&bvh->base, &description);
    assert_true(description.depth > HALVE_DEPTH); /* or the test would show nothing */
    assert_true(description.depth < MAX_DEPTH);
    destroy(&bvh->base);
    rt_scene_clear(&scene);
}

static void the_predicted_cost_of_two_disjoint_spheres_is_the_sum_by_hand(void **state) {
    (void)state;
    RtScene scene;
    make_row(&scene, 2, 8);
    Bvh *bvh = make_bvh(&scene, "leaf=1,traversal=0.5");
    RtDescription description;
    describe(&bvh->base, &description);
    /* Root 10 x 2 x 2: half area 44; each leaf 2 x 2 x 2: 12. 0.5 + 12 / 44 + 12 / 44. */
    assert_true(fabs(description.predicted_cost - (0.5 + 24.0 / 44.0)) < 1e-12);
    assert_int_equal(description.interior, 1);
    assert_int_equal(description.leaves, 2);
    assert_int_equal(description.references, 2);
    assert_int_equal(description.depth, 1);
    destroy(&bvh->base);
    rt_scene_clear(&scene);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(validate_names_each_invariant_that_is_broken),
        cmocka_unit_test(validate_names_a_node_that_is_too_deep),
        cmocka_unit_test(coincident_objects_are_halved_within_the_depth_limit),
        cmocka_unit_test(a_chain_of_growing_distances_stays_within_the_depth_limit),
        cmocka_unit_test(the_predicted_cost_of_two_disjoint_spheres_is_the_sum_by_hand),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
