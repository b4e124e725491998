/* SPDX-License-Identifier: Apache-2.0 */
/* The overlays item and light over scenes with instances: pictures are those of brute, byte for byte, and
 * what a ray costs. */
#include "instances_testing.h"
#include "item_testing.h"

static const char *const specs[] = {"item+bvh", "item+wide/grid", "light:cells=20+bvh",
                                    "cache+light:cells=3,longest=2+item+grid/octree"};

/* Traces a finished scene, with its shadows, by brute and by all overlays. */
static void assert_seen_right(const RtScene *scene) {
    OWNED_FRAME right = trace("brute", scene, false);
    const size_t samples = (size_t)right.sampling.columns * right.sampling.rows;
    for (size_t i = 0; i < sizeof specs / sizeof specs[0]; i++) {
        OWNED_FRAME frame = trace(specs[i], scene, true);
        assert_memory_equal(frame.object, right.object, samples * sizeof *frame.object);
        assert_memory_equal(frame.depth, right.depth, samples * sizeof *frame.depth);
        assert_memory_equal(frame.color, right.color, samples * sizeof *frame.color);
        if (i != 2) assert_int_equal(frame.tallies[RT_RAY_PRIMARY].passed_on, 0);
    }
}

/* Adds a light, finishes the scene, and clears it afterwards. */
static void check_lit(RtScene *scene, RtVec3 light) {
    assert_ok(rt_scene_add_light(scene, light, rt_vec3(1, 1, 1), error));
    assert_ok(rt_scene_finish(scene, error));
    assert_ok(rt_scene_sample(scene, 48, 36, 1, false, error));
    assert_seen_right(scene);
    rt_scene_clear(scene);
}

/* A square in the plane z = 0, as a part, and below it a floor for shadows. */
static RtScene begin_square(void) {
    RtScene scene = begin_view(), part = begin_scene();
    const RtVec3 square[4] = {{{-1, -1, 0}}, {{1, -1, 0}}, {{1, 1, 0}}, {{-1, 1, 0}}},
                 floor[4] = {{{-4, -4, -2}}, {{4, -4, -2}}, {{4, 4, -2}}, {{-4, 4, -2}}};
    assert_ok(rt_scene_add_polygon(&part, 0, square, 4, error));
    add_part(&scene, &part);
    assert_ok(rt_scene_add_polygon(&scene, 0, floor, 4, error));
    return scene;
}

/* ---- answers ---- */

RT_TEST(scenes_of_both_families_look_as_by_brute) {
    static const char *const kinds[] = {"instanced", "instanced-far"};
    for (uint32_t seed = 1; seed <= RT_SHARE(10, 3); seed++) {
        for (int k = 0; k < 2; k++) {
            char spec[64];
            snprintf(spec, sizeof spec, "family:kind=%s,seed=%u", kinds[k], seed);
            OWNED_SCENE scene = open_scene(spec);
            assert_ok(rt_scene_sample(&scene, 48, 36, 1, false, error));
            assert_seen_right(&scene);
        }
    }
}

RT_TEST(nested_instances_are_seen_from_outside_and_from_within) {
    static const RtVec3 eyes[] = {{{6, 1, 2}}, {{0.2f, 0.1f, 0}}, {{0, 0, -1}}, {{0.9f, 0.05f, 0.01f}}};
    for (size_t i = 0; i < sizeof eyes / sizeof eyes[0]; i++) {
        RtScene scene = begin_balls();
        look(&scene, eyes[i], rt_vec3(0, 0.3f, 0.1f));
        for (uint32_t level = 1; level <= 4; level++) {
            RtScene part = begin_scene(), *to = level < 4 ? &part : &scene;
            add_ball(to, 0, 0, -1, 0.5f);
            place(to, &scene, level - 1, sheared(0.3)), place(to, &scene, level - 1, moved(1.5, 0.2, 0.5));
            if (to == &part)
                add_part(&scene, &part);
            else
                rt_scene_clear(&part);
        }
        check_lit(&scene, rt_vec3(0.3f, -0.2f, i % 2 ? 0.1f : 5));
    }
}

RT_TEST(an_instance_behind_the_eye_or_around_it_is_drawn_like_any_object) {
    static const double sizes[] = {0.2, 1, 30};
    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
        RtScene scene = begin_balls();
        look(&scene, rt_vec3(0, -2, 0), rt_vec3(0, 0, 0));
        place(&scene, &scene, 0, scaled(sizes[i], sizes[i], sizes[i]));
        place(&scene, &scene, 0, moved(0.4, -2.5, 0)); /* the eye is on the side of its box */
        place(&scene, &scene, 0, moved(0, -9, 0));
        place(&scene, &scene, 0, moved(2, -2, 0.3));
        check_lit(&scene, rt_vec3(3, -2, 9));
    }
}

RT_TEST(instances_thin_as_a_rounding_and_edge_on_are_seen_where_brute_sees_them) {
    static const double thin[] = {1, 1e-3, 1e-6};
    for (size_t i = 0; i < sizeof thin / sizeof thin[0]; i++) {
        RtScene scene = begin_square();
        look(&scene, rt_vec3(0, -5, i % 2 ? 0 : 1e-4f), rt_vec3(0, 0, 0)); /* along the square, or nearly */
        place(&scene, &scene, 0, scaled(1, thin[i], 1));
        place(&scene, &scene, 0, scaled(thin[i], 1, 1));
        RtTransform turned = rt_transform_identity();
        assert_ok(rt_transform_rotate(&turned, rt_vec3(1, 2, 3), 33, error));
        place(&scene, &scene, 0, turned);
        check_lit(&scene, rt_vec3(0, 0, 4));
    }
}

RT_TEST(of_instances_that_coincide_overlays_name_the_first) {
    RtScene scene = begin_square();
    look(&scene, rt_vec3(1, -3, 4), rt_vec3(0, 0, 0));
    for (int i = 0; i < 3; i++) place(&scene, &scene, 0, rt_transform_identity());
    place(&scene, &scene, 0, scaled(2, 0.5, 1));
    check_lit(&scene, rt_vec3(0, 0, 0)); /* in their plane */
}

/* Far from the part's zero a moved ray is off by more than the box of the instance is thick. */
RT_TEST(hits_beyond_the_box_of_the_instance_are_drawn_within_it) {
    RtScene scene = begin_view(), part = begin_scene();
    const float far = 131072;
    RtVec3 v[4];
    for (int k = 0; k < 4; k++) v[k] = rt_vec3(far, k == 1 || k == 2 ? 1 : -1, k >= 2 ? 1 : -1);
    assert_ok(rt_scene_add_polygon(&part, 0, v, 4, error));
    add_part(&scene, &part);
    place(&scene, &scene, 0, moved(-(double)far, 0, 0));
    place(&scene, &scene, 0, moved(2 - (double)far, 1, 0.5));
    look(&scene, rt_vec3(-6.003f, 0.1f, 0.2f), rt_vec3(0, 0, 0));
    check_lit(&scene, rt_vec3(-6.005f, -2, 7));
}

/* ---- costs ---- */

RT_TEST(a_primary_ray_tests_the_object_it_hits_and_the_instances_around_it) {
    for (uint32_t levels = 1; levels <= 3; levels++) {
        RtScene scene = begin_balls();
        for (uint32_t level = 1; level < levels; level++) {
            RtScene part = begin_scene();
            for (int i = 0; i < 3; i++) place(&part, &scene, level - 1, moved(2.0 * i, 0, 0));
            add_part(&scene, &part);
        }
        place(&scene, &scene, levels - 1, rt_transform_identity());
        place(&scene, &scene, levels - 1, moved(0, 3, 0));
        assert_ok(rt_scene_finish(&scene, error));
        OWNED_FRAME frame = trace("item+bvh", &scene, true);
        const RtTally *tally = &frame.tallies[RT_RAY_PRIMARY];
        assert_true(tally->hits > 0);
        assert_int_equal(tally->steps, tally->rays);
        assert_int_equal(tally->object_tests, tally->hits * (levels + 1));
        assert_int_equal(tally->object_hits, tally->hits);
        assert_int_equal(tally->extent_tests, 0);
        rt_scene_clear(&scene);
    }
}

RT_TEST(a_shadow_ray_tests_the_instances_of_its_cell) {
    OWNED_SCENE scene = begin_view();
    RtScene part = begin_scene();
    add_ball(&part, 0, 0, 0, 1), add_ball(&part, 0, 0, -2, 1);
    add_part(&scene, &part);
    for (int i = 0; i < 3; i++) place(&scene, &scene, 0, moved(30 * i, 0, 0));
    assert_ok(rt_scene_add_light(&scene, rt_vec3(30, 0, 3), rt_vec3(1, 1, 1), error));
    assert_ok(rt_scene_finish(&scene, error));
    OWNED_ACCEL RtAccel *accel = open_valid(&scene, "light:cells=64+brute");
    OWNED_QUERY query = open_query(accel);
    RtTally tallies[RT_RAY_KIND_COUNT] = {{0}};
    const RtRay ray = shadow_ray(&scene, rt_vec3(30.3f, 0.1f, -3), 0);
    uint32_t occluder;
    rt_trace_stream(accel, query.scratch, &ray, 1, NULL, &occluder, tallies);
    assert_int_equal(occluder, 2); /* the second's first ball */
    assert_tally(
        "light", &tallies[RT_RAY_SHADOW],
        &(RtTally){
            .rays = 1, .hits = 1, .steps = 1, .object_tests = 2, .object_hits = 1, .instances_entered = 1});
}

RT_TEST(the_shadow_of_an_instance_reaches_to_the_corners_of_its_box) {
    enum { EDGE = 40 };
    OWNED_SCENE scene = begin_square();
    place(&scene, &scene, 0, moved(0, 0, 1));
    assert_ok(rt_scene_add_light(&scene, rt_vec3(0, 0, 4), rt_vec3(1, 1, 1), error));
    assert_ok(rt_scene_finish(&scene, error));
    OWNED_ACCEL RtAccel *accel = open_valid(&scene, "light:cells=256+brute");
    OWNED_QUERY query = open_query(accel);
    for (int i = 0; i < EDGE * EDGE; i++) { /* from above a floor that is twice as far away as the square */
        const float x = ((float)(i % EDGE) + 0.5f) / 8 - 2.5f, y = ((float)(i / EDGE) + 0.5f) / 8 - 2.5f;
        const RtRay ray = shadow_ray(&scene, rt_vec3(x, y, -1.99f), 0);
        RtTally tallies[RT_RAY_KIND_COUNT] = {{0}};
        bool blocked;
        rt_occluded(&query, &ray, 1, &blocked, tallies);
        assert_int_equal(blocked, fmaxf(fabsf(x), fabsf(y)) < 2);
        assert_int_equal(tallies[RT_RAY_SHADOW].passed_on, 0);
    }
}

/* The square stands upright and faces the light; in its part it would be turned away. */
RT_TEST(light_looks_for_surfaces_that_face_the_light_in_instances_too) {
    OWNED_SCENE scene = begin_square();
    RtTransform upright = rt_transform_identity();
    assert_ok(rt_transform_rotate(&upright, rt_vec3(1, 0, 0), 90, error));
    place(&scene, &scene, 0, upright);
    look(&scene, rt_vec3(0, -3, 3), rt_vec3(0, 0, 0));
    assert_ok(rt_scene_add_light(&scene, rt_vec3(0, -3, -5), rt_vec3(1, 1, 1), error));
    assert_ok(rt_scene_finish(&scene, error));
    OWNED_ACCEL RtAccel *accel = open_accel(&scene, "light+bvh");
    assert_string_equal(accel->idle, "shadow rays cost little in the layer below");
}

RT_TESTS(instances_overlays, NULL, assert_nothing_is_kept)
