/* SPDX-License-Identifier: Apache-2.0 */
/* accel/extents: counters by hand, what describe tells, and a broken extent found. */
#include "extents_testing.h"

#include "accel/extents/extents.h"

/* ---- counters by hand ---- */

static RtTally count(const RtScene *scene, const char *spec, RtVec3 org, RtVec3 dir, bool any) {
    RtTally tallies[RT_RAY_KIND_COUNT] = {0};
    RtRay ray = {.org = org, .dir = dir, .tmin = 0, .tmax = INFINITY};
    RtHit hit;
    bool blocked;
    OWNED_ACCEL RtAccel *accel = open_accel(scene, spec);
    OWNED_QUERY query = open_query(accel);
    if (any)
        rt_occluded(&query, &ray, 1, &blocked, tallies);
    else
        rt_nearest(&query, &ray, 1, &hit, tallies);
    return tallies[RT_RAY_PRIMARY];
}

RT_TEST(a_ray_along_three_spheres_tests_three_extents_and_the_objects_not_yet_beyond_its_hit) {
#define HITS(extents, tests)                                                                                 \
    {                                                                                                        \
        .rays = 1, .hits = 1, .extent_tests = (extents), .steps = (extents), .object_tests = (tests),        \
        .object_hits = (tests)                                                                               \
    }
    static const struct {
        float from, to; /* along x */
        bool any;
        RtTally by_hand;
    } rows[] = {{-5, 1, false, HITS(3, 1)},  /* the others begin behind the first hit */
                {25, -1, false, HITS(3, 3)}, /* every one is nearer than the last */
                {25, -1, true, HITS(1, 1)},  /* any hit will do: the first ends the search */
                {5, 1, false, HITS(3, 1)}};  /* from between the first two: the first is behind */
    OWNED_SCENE scene = make_row(3, 10);
    for (int s = 0; s < SPEC_COUNT; s++) {
        for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
            const RtTally tally =
                count(&scene, specs[s], rt_vec3(rows[i].from, 0, 0), rt_vec3(rows[i].to, 0, 0), rows[i].any);
            assert_tally(specs[s], &tally, &rows[i].by_hand);
        }
    }
}

RT_TEST(a_ray_by_the_corner_of_the_boxes_meets_the_boxes_only) {
    OWNED_SCENE scene = make_row(3, 10);
    RtVec3 org = rt_vec3(-5, 0.9f, 0.9f), dir = rt_vec3(1, 0, 0);
    static const uint64_t object_tests[SPEC_COUNT] = {3, 3, 0, 3, 3, 0, 0};
    for (int s = 0; s < SPEC_COUNT; s++) {
        RtTally tally = count(&scene, specs[s], org, dir, false);
        assert_int_equal(tally.hits, 0);
        assert_int_equal(tally.extent_tests, 3);
        assert_int_equal(tally.object_tests, object_tests[s]);
    }
}

/* ---- describe and validate ---- */

RT_TEST(describe_tells_references_bytes_and_expected_tests) {
    OWNED_SCENE scene = make_row(3, 10);
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
        RtDescription description;
        OWNED_ACCEL RtAccel *accel = open_accel(&scene, specs[s]);
        accel->ops->describe(accel, &description);
        assert_int_equal(description.references, 3);
        assert_int_equal(description.bytes, 3 * each[s]);
        if (isnan(expected[s]))
            assert_true(isnan(description.predicted_cost));
        else
            assert_true(fabs(description.predicted_cost - expected[s]) < 1e-9);
    }
}

static void count_box(void *context, const RtBoxView *view) {
    assert_true(view->depth == 0 && view->leaf);
    ++*(uint32_t *)context;
}

RT_TEST(each_box_gives_the_box_of_every_object) {
    OWNED_SCENE scene = make_row(3, 10);
    uint32_t boxes = 0;
    OWNED_ACCEL RtAccel *accel = open_accel(&scene, "extents");
    accel->ops->each_box(accel, (RtBoxViewer){count_box, &boxes});
    assert_int_equal(boxes, 3);
}

RT_TEST(validate_names_the_extent_that_is_too_small) {
    OWNED_SCENE scene = make_row(3, 10);
    OWNED_ACCEL RtExtents *sphere = open_valid(&scene, "extents:kind=sphere");
    OWNED_ACCEL RtExtents *obb = open_valid(&scene, "extents:kind=obb");
    OWNED_ACCEL RtExtents *slabs = open_valid(&scene, "extents:kind=slabs,slabs=5");
    OWNED_ACCEL RtAccel *box = open_valid(&scene, "extents:kind=box");
    double *radius = &sphere->set.balls[1].radius, *half = &obb->set.oriented[2].half[1];
    RtVec3d *axes = obb->set.oriented[0].axes;
    RtSlab *first = &slabs->set.slabs[0], *last = &slabs->set.slabs[5 + 4];
    assert_broken_by(&sphere->isa.base, *radius, *radius * (1 - 1e-6),
                     "the sphere 1 does not contain object 1 (sphere) along (1, 0, 0)");
    assert_broken_by(&obb->isa.base, *half, *half * (1 - 1e-6),
                     "the oriented box 2 does not contain object 2 (sphere)");
    assert_broken_by(&obb->isa.base, axes[1], axes[0], "the axes of the oriented box 0 are not orthonormal");
    assert_broken_by(&slabs->isa.base, last->hi, last->hi - 0.5f,
                     "the set of slabs 1 does not contain object 1 (sphere)");
    assert_broken_by(&slabs->isa.base, first->lo, NAN,
                     "the set of slabs 0 does not contain object 0 (sphere) along (-1, 0, 0)");
    assert_broken_by(box, scene.geometry.boxes[1].hi.y, 0.5f,
                     "the box 1 does not contain object 1 (sphere) along (0, 1, 0)");
}

RT_TESTS(extents, NULL, NULL)
