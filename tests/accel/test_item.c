/* SPDX-License-Identifier: Apache-2.0 */
/* The item buffer: what it answers, what it passes on, limits, and its invariant broken. */
#include "item_testing.h"

#include "scenes/builtin.h"

#include <math.h>

/* ---- what is answered ---- */

static void check_answered(const RtScene *scene) {
    OWNED_FRAME frame = trace("item+bvh", scene, true);
    const RtTally *tally = &frame.tallies[RT_RAY_PRIMARY];
    assert_int_equal(tally->passed_on, 0);
    assert_int_equal(tally->object_tests, tally->hits);
}

RT_TEST(all_primary_rays_of_every_builtin_scene_are_answered) {
    for (size_t i = 0; i < rt_builtin_count(); i += RT_SHARE(1, 5)) {
        OWNED_SCENE scene = open_scene(rt_builtin_at(i)->name);
        check_answered(&scene);
        assert_ok(rt_scene_sample(&scene, 0, 0, 1, true, error));
        check_answered(&scene);
    }
}

RT_TEST(a_ray_makes_at_most_one_object_test) {
    RtView view;
    OWNED_SCENE scene = open_scene("random:n=300,shape=mixed");
    assert_ok(rt_scene_sample(&scene, 64, 48, 1, false, error));
    assert_ok(rt_view_init(&view, &scene.camera, scene.sampling, error));
    OWNED_ACCEL RtAccel *accel = open_accel(&scene, "item+bvh");
    OWNED_QUERY query = open_query(accel);
    uint32_t nothing = 0, seen = 0;
    for (uint32_t i = 0; i < 64 * 48; i++) {
        RtTally tallies[RT_RAY_KIND_COUNT] = {{0}};
        const RtTally *tally = &tallies[RT_RAY_PRIMARY];
        RtRay ray = rt_view_ray(&view, i % 64, i / 64);
        RtHit hit;
        rt_nearest(&query, &ray, 1, &hit, tallies);
        assert_int_equal(tally->object_tests, hit.object != RT_NO_OBJECT);
        assert_int_equal(tally->extent_tests, 0);
        nothing += hit.object == RT_NO_OBJECT;
        seen += hit.object != RT_NO_OBJECT;
    }
    assert_true(nothing > 100 && seen > 100);
}

RT_TEST(every_way_to_sample_an_image_is_answered_like_brute) {
    const struct {
        uint32_t width, height, samples;
        bool corners;
    } ways[] = {{1, 1, 1, false},  {1, 1, 1, true},    {1, 40, 2, false},
                {40, 1, 3, false}, {17, 23, 4, false}, {33, 20, 1, true}};
    OWNED_SCENE scene = open_scene("random:n=100,shape=mixed");
    for (size_t i = 0; i < sizeof ways / sizeof ways[0]; i++) {
        assert_ok(
            rt_scene_sample(&scene, ways[i].width, ways[i].height, ways[i].samples, ways[i].corners, error));
        assert_drawn_right(&scene);
    }
}

RT_TEST(a_scene_without_objects_is_nothing_everywhere) {
    RtDescription d;
    RtAccel *accel;
    RtScene scene = begin_view();
    assert_ok(rt_scene_finish(&scene, error));
    assert_ok(rt_accel_open("item+brute", &scene, &accel, error));
    rt_accel_describe(accel, &d);
    assert_int_equal(d.leaves, 48 * 36);
    assert_int_equal(d.empty_leaves, 48 * 36);
    assert_int_equal(d.references, 0);
    rt_accel_destroy(accel);
    check_finished(&scene);
}

/* One ball: it is asked once for each sample that it may be in, and found where it is. */
RT_TEST(what_is_asked_while_building_is_tallied_apart) {
    static const char *const specs[] = {"item+brute", "cache+item+brute"};
    OWNED_SCENE scene = begin_view();
    assert_ok(rt_scene_add_sphere(&scene, 0, rt_vec3(0, 0, 0), 1, error));
    assert_ok(rt_scene_finish(&scene, error));
    for (int i = 0; i < 2; i++) {
        RtDescription d;
        OWNED_ACCEL RtAccel *accel = open_accel(&scene, specs[i]);
        rt_accel_describe(accel, &d);
        uint64_t named = d.references - 1; /* the other reference is brute's */
        assert_true(named > 0);
        assert_int_equal(d.build.object_hits, named);
        assert_true(d.build.object_tests >= d.build.object_hits && d.build.object_tests < 48 * 36);
        assert_int_equal(d.build.rays, 0);
    }
}

/* ---- what is passed on ---- */

RT_TEST(rays_that_are_not_of_a_sample_are_passed_on) {
    RtView view;
    OWNED_SCENE scene = begin_view();
    assert_ok(rt_scene_add_sphere(&scene, 0, rt_vec3(0, 0, 0), 1, error));
    assert_ok(rt_scene_finish(&scene, error));
    assert_ok(rt_view_init(&view, &scene.camera, scene.sampling, error));
    OWNED_ACCEL RtAccel *accel = open_accel(&scene, "item+brute");
    OWNED_QUERY query = open_query(accel);
    enum { RAYS = 9 };
    RtRay own = rt_view_ray(&view, 24, 18), rays[RAYS];
    for (int i = 0; i < RAYS; i++) rays[i] = own;
    rays[1].source++;
    rays[2].source = 48 * 36;
    rays[3].source = UINT32_MAX;
    rays[4].org.x = nextafterf(rays[4].org.x, 0);
    rays[5].dir.y = nextafterf(rays[5].dir.y, 0);
    rays[6].tmax = 1e6f;
    rays[7].tmin = 1e-6f;
    rays[8].kind = RT_RAY_REFLECTION; /* none of its business */
    for (int i = 0; i < RAYS; i++) {
        RtTally tallies[RT_RAY_KIND_COUNT] = {{0}};
        RtHit hit;
        bool blocked;
        rt_nearest(&query, &rays[i], 1, &hit, tallies);
        assert_int_equal(hit.object, 0);
        assert_int_equal(tallies[rays[i].kind].passed_on, i > 0 && i < 8);
        assert_int_equal(tallies[rays[i].kind].rays, 1);
        /* Whether anything is in the way is not what samples are for. */
        rt_occluded(&query, &rays[i], 1, &blocked, tallies);
        assert_true(blocked);
        assert_int_equal(tallies[rays[i].kind].passed_on, i > 0 && i < 8);
        assert_int_equal(tallies[rays[i].kind].rays, 2);
    }
    /* In one stream, runs of other kinds among them. */
    RtTally tallies[RT_RAY_KIND_COUNT] = {{0}};
    RtHit hits[RAYS];
    rt_nearest(&query, rays, RAYS, hits, tallies);
    assert_int_equal(tallies[RT_RAY_PRIMARY].passed_on, 7);
    assert_int_equal(tallies[RT_RAY_PRIMARY].rays, 8);
    assert_int_equal(tallies[RT_RAY_REFLECTION].rays, 1);
}

RT_TEST(a_frame_of_another_sampling_is_passed_on_whole_and_right) {
    OWNED_FRAME frame;
    RtFrameOptions options = {.depth = 1, .threads = 1, .counted = true};
    OWNED_SCENE scene = begin_view();
    assert_ok(rt_scene_add_sphere(&scene, 0, rt_vec3(0, 0, 0), 1, error));
    assert_ok(rt_scene_finish(&scene, error));
    OWNED_ACCEL RtAccel *accel = open_accel(&scene, "item+brute");
    assert_ok(rt_scene_sample(&scene, 31, 19, 1, false, error));
    OWNED_FRAME right = trace("brute", &scene, false);
    assert_ok(rt_frame_trace(&frame, accel, &options, error));
    assert_int_equal(frame.tallies[RT_RAY_PRIMARY].passed_on, 31 * 19);
    assert_memory_equal(frame.depth, right.depth, sizeof(float) * 31 * 19);
}

/* ---- limits, and invariants broken ---- */

RT_TEST(too_many_samples_are_refused_with_a_number_that_fits) {
    const struct {
        uint32_t width, height, samples;
        const char *says;
    } sizes[] = {{32768, 32768, 1, "takes 4.0 GiB to build, more than 4 GiB: an image of 3275"},
                 {32768, 32768, 64, "an image of"},
                 {2048, 2048, 64, "15 samples along the side"}};
    OWNED_SCENE scene = begin_view();
    assert_ok(rt_scene_finish(&scene, error));
    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
        RtAccel *accel;
        assert_ok(rt_scene_sample(&scene, sizes[i].width, sizes[i].height, sizes[i].samples, false, error));
        assert_bad_input(rt_accel_open("item+brute", &scene, &accel, error), sizes[i].says);
    }
}

RT_TEST(each_way_to_break_the_invariant_is_named) {
    OWNED_SCENE scene = begin_view();
    look(&scene, rt_vec3(0, -8, 0), rt_vec3(0, 0, 0));
    assert_ok(rt_scene_add_sphere(&scene, 0, rt_vec3(0, 4, 0), 1, error));
    assert_ok(rt_scene_add_sphere(&scene, 0, rt_vec3(0, 0, 0), 1, error));
    assert_ok(
        rt_scene_add_sphere(&scene, 0, rt_vec3(0, 110, 0), 100, error)); /* behind both, in every sample */
    assert_ok(rt_scene_finish(&scene, error));
    OWNED_ACCEL RtAccel *accel = open_valid(&scene, "item+brute");
    uint32_t *first = ((RtItemBuffer *)accel)->samples, *middle = &first[18 * 48 + 24];
    assert_int_equal(*first, 2);
    assert_broken_by(accel, *first, RT_NO_OBJECT, "sample 0,0 names no object, but its ray hits object 2");
    assert_int_equal(*middle, 1);
    assert_broken_by(accel, *middle, 0, "names object 0, but its ray hits object 1");
    assert_broken_by(accel, *middle, RT_NO_OBJECT, "names no object, but its ray hits object 1");
    assert_broken_by(accel, *middle, 3, "names object 3, but its ray hits object 1");
    assert_ok(rt_accel_validate(accel, error));
}

RT_TESTS(item, NULL, assert_nothing_is_kept)
