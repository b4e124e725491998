/* SPDX-License-Identifier: Apache-2.0 */
/* accel/extents: counters by hand, what describe tells, and a broken extent found. */
#include "extents_testing.h"

#include "accel/extents/extents.h"

/* ---- counters by hand ---- */

/* Unit spheres at x = 0, 10 and 20. */
static RtScene three_spheres_in_a_row(void) {
    RtScene scene;
    begin_scene(&scene);
    for (int i = 0; i < 3; i++) {
        assert_ok(rt_scene_add_sphere(&scene, 0, rt_vec3(10.0f * (float)i, 0, 0), 1, error));
    }
    assert_ok(rt_scene_finish(&scene, error));
    return scene;
}

static RtTally count(const RtScene *scene, const char *spec, RtVec3 org, RtVec3 dir, bool any) {
    RtTally tallies[RT_RAY_KIND_COUNT] = {0};
    RtRay ray = {.org = org, .dir = dir, .tmin = 0, .tmax = INFINITY};
    RtAccel *accel;
    RtQuery query;
    RtHit hit;
    bool blocked;
    assert_ok(rt_accel_open(spec, scene, &accel, error));
    assert_ok(rt_query_init(&query, accel, error));
    if (any)
        rt_occluded(&query, &ray, 1, &blocked, tallies);
    else
        rt_nearest(&query, &ray, 1, &hit, tallies);
    rt_query_clear(&query);
    rt_accel_destroy(accel);
    return tallies[RT_RAY_PRIMARY];
}

RT_TEST(a_ray_along_three_spheres_tests_three_extents_and_the_objects_not_yet_beyond_its_hit) {
    RtScene scene = three_spheres_in_a_row();
    for (int s = 0; s < SPEC_COUNT; s++) {
        /* From the left the first is hit at once, and the others begin behind it. */
        RtTally left = count(&scene, specs[s], rt_vec3(-5, 0, 0), rt_vec3(1, 0, 0), false);
        assert_int_equal(left.rays, 1);
        assert_int_equal(left.hits, 1);
        assert_int_equal(left.extent_tests, 3);
        assert_int_equal(left.steps, 3);
        assert_int_equal(left.object_tests, 1);
        assert_int_equal(left.object_hits, 1);
        /* From the right every one is nearer than the last. */
        RtTally right = count(&scene, specs[s], rt_vec3(25, 0, 0), rt_vec3(-1, 0, 0), false);
        assert_int_equal(right.extent_tests, 3);
        assert_int_equal(right.object_tests, 3);
        assert_int_equal(right.object_hits, 3);
        /* Any hit will do: the first ends the search. */
        RtTally any = count(&scene, specs[s], rt_vec3(25, 0, 0), rt_vec3(-1, 0, 0), true);
        assert_int_equal(any.extent_tests, 1);
        assert_int_equal(any.object_tests, 1);
        /* From between the first two, to the right: the first is behind. */
        RtTally between = count(&scene, specs[s], rt_vec3(5, 0, 0), rt_vec3(1, 0, 0), false);
        assert_int_equal(between.extent_tests, 3);
        assert_int_equal(between.object_tests, 1);
    }
    rt_scene_clear(&scene);
}

RT_TEST(a_ray_by_the_corner_of_the_boxes_meets_the_boxes_only) {
    RtScene scene = three_spheres_in_a_row();
    RtVec3 org = rt_vec3(-5, 0.9f, 0.9f), dir = rt_vec3(1, 0, 0);
    static const uint64_t object_tests[SPEC_COUNT] = {3, 3, 0, 3, 3, 0, 0};
    for (int s = 0; s < SPEC_COUNT; s++) {
        RtTally tally = count(&scene, specs[s], org, dir, false);
        assert_int_equal(tally.hits, 0);
        assert_int_equal(tally.extent_tests, 3);
        assert_int_equal(tally.object_tests, object_tests[s]);
    }
    rt_scene_clear(&scene);
}

/* ---- describe and validate ---- */

RT_TEST(describe_tells_references_bytes_and_expected_tests) {
    RtScene scene = three_spheres_in_a_row();
    /* The scene's box is 22 x 2 x 2, of half area 92; a sphere's box has 12, a sphere 2 pi. */
    static const double expected[SPEC_COUNT] = {
        36.0 / 92, 36.0 / 92, 6 * 3.14159265358979 / 92, 36.0 / 92, NAN, NAN, NAN};
    static const size_t each[SPEC_COUNT] = {0,
                                            0,
                                            sizeof(RtBall),
                                            sizeof(RtOrientedBox),
                                            3 * sizeof(RtSlab),
                                            7 * sizeof(RtSlab),
                                            13 * sizeof(RtSlab)};
    for (int s = 0; s < SPEC_COUNT; s++) {
        RtAccel *accel;
        RtDescription description;
        assert_ok(rt_accel_open(specs[s], &scene, &accel, error));
        accel->ops->describe(accel, &description);
        assert_int_equal(description.references, 3);
        assert_int_equal(description.bytes, 3 * each[s]);
        if (isnan(expected[s]))
            assert_true(isnan(description.predicted_cost));
        else
            assert_true(fabs(description.predicted_cost - expected[s]) < 1e-9);
        rt_accel_destroy(accel);
    }
    rt_scene_clear(&scene);
}

static void count_box(void *context, const RtBoxView *view) {
    assert_int_equal(view->depth, 0);
    assert_true(view->leaf);
    ++*(uint32_t *)context;
}

RT_TEST(each_box_gives_the_box_of_every_object) {
    RtScene scene = three_spheres_in_a_row();
    RtAccel *accel;
    uint32_t boxes = 0;
    assert_ok(rt_accel_open("extents", &scene, &accel, error));
    accel->ops->each_box(accel, (RtBoxViewer){count_box, &boxes});
    assert_int_equal(boxes, 3);
    rt_accel_destroy(accel);
    rt_scene_clear(&scene);
}

static RtExtents *open_extents(const RtScene *scene, const char *spec) {
    RtAccel *accel;
    assert_ok(rt_accel_open(spec, scene, &accel, error));
    assert_ok(accel->ops->validate(accel, error));
    return (RtExtents *)accel;
}

RT_TEST(validate_names_the_extent_that_is_too_small) {
    RtScene scene = three_spheres_in_a_row();
    RtExtents *extents = open_extents(&scene, "extents:kind=sphere");
    extents->set.balls[1].radius *= 1 - 1e-6;
    assert_broken(&extents->isa.base, "the sphere 1 does not contain object 1 (sphere) along (1, 0, 0)");
    rt_accel_destroy(&extents->isa.base);

    extents = open_extents(&scene, "extents:kind=obb");
    extents->set.oriented[2].half[1] *= 1 - 1e-6;
    assert_broken(&extents->isa.base, "the oriented box 2 does not contain object 2 (sphere)");
    rt_accel_destroy(&extents->isa.base);

    extents = open_extents(&scene, "extents:kind=obb");
    extents->set.oriented[0].axes[1] = extents->set.oriented[0].axes[0];
    assert_broken(&extents->isa.base, "the axes of the oriented box 0 are not orthonormal");
    rt_accel_destroy(&extents->isa.base);

    extents = open_extents(&scene, "extents:kind=slabs,slabs=5");
    extents->set.slabs[5 + 4].hi -= 0.5f;
    assert_broken(&extents->isa.base, "the set of slabs 1 does not contain object 1 (sphere)");
    rt_accel_destroy(&extents->isa.base);

    extents = open_extents(&scene, "extents:kind=slabs,slabs=3");
    extents->set.slabs[0].lo = NAN;
    assert_broken(&extents->isa.base,
                  "the set of slabs 0 does not contain object 0 (sphere) along (-1, 0, 0)");
    rt_accel_destroy(&extents->isa.base);

    extents = open_extents(&scene, "extents:kind=box");
    scene.geometry.boxes[1].hi.y = 0.5f;
    assert_broken(&extents->isa.base, "the box 1 does not contain object 1 (sphere) along (0, 1, 0)");
    rt_accel_destroy(&extents->isa.base);
    rt_scene_clear(&scene);
}

RT_TESTS(extents, NULL, NULL)
