/* SPDX-License-Identifier: Apache-2.0 */
/* The item buffer: what it answers, what it passes on, limits, and its invariant broken. And it is never
 * wrong where geometry is awkward: eyes inside objects and in their planes, objects that touch, rounding,
 * scenes tiny and huge. */
#include "item_testing.h"

#include "core/base/random.h"
#include "scenes/builtin.h"

#include <math.h>

/* ---- what is answered ---- */

static void check_answered(const RtScene *scene) {
    OWNED_FRAME frame = trace("item+bvh", scene, true);
    const RtTally *tally = &frame.tallies[RT_RAY_PRIMARY];
    assert_int_equal(tally->passed_on, 0);
    if (scene->geometry.csg_count == 0)
        assert_int_equal(tally->extent_tests, 0);       /* trees have boxes within */
    assert_int_equal(tally->object_tests, tally->hits); /* so each that hits makes one, and no other any */
}

RT_TEST(all_primary_rays_of_every_builtin_scene_are_answered) {
    for (size_t i = 0; rt_builtin_at(i); i += RT_SHARE(1, 5)) {
        OWNED_SCENE scene = open_scene(rt_builtin_at(i)->name);
        check_answered(&scene);
        assert_ok(rt_scene_sample(&scene, 0, 0, 1, true, error));
        check_answered(&scene);
    }
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

/* ---- awkward geometry ---- */

RT_TEST(polygons_through_the_plane_of_the_eye_are_drawn_right) {
    const RtVec3 floor[4] = {{{-50, -50, 0}}, {{50, -50, 0}}, {{50, 50, 0}}, {{-50, 50, 0}}};
    const RtVec3 wall[3] = {{{2, -30, -1}}, {{2, 30, -1}}, {{2, 5, 9}}};
    RtScene scene = begin_view();
    look(&scene, rt_vec3(0, 0, 1.5f), rt_vec3(0.2f, 4, 1));
    scene.camera.fov = 100;
    assert_ok(rt_scene_add_polygon(&scene, 0, floor, 4, error));
    assert_ok(rt_scene_add_triangle(&scene, 0, wall, NULL, error));
    assert_ok(rt_scene_add_sphere(&scene, 0, rt_vec3(0, -3, 1), 1, error)); /* behind */
    assert_ok(rt_scene_add_sphere(&scene, 0, rt_vec3(1, 5, 0.5f), 1, error));
    check_scene(&scene);
}

RT_TEST(objects_all_around_the_eye_are_drawn_right) {
    RtRandom random = rt_random(11, 0);
    for (int k = 0; k < 24; k++) {
        RtScene scene = begin_view();
        scene.camera.fov = k % 3 == 0 ? 170 : k % 3 == 1 ? 60 : 179.9999f;
        scene.camera.near = k % 4 == 0 ? 0.25f : 0;
        scene.camera.up = rt_vec3(0.1f, 0.3f, 1);
        RtVec3 eye = rt_narrow(rt_scaled(rt_random_direction(&random), k % 6 == 5 ? 1000 : 0.5));
        look(&scene, eye, rt_narrow(rt_addd(rt_widen(eye), rt_random_direction(&random))));
        for (int i = 0; i < 60; i++) {
            RtVec3 p[4];
            for (int j = 0; j < 4; j++)
                p[j] =
                    rt_narrow(rt_addd(rt_widen(eye), rt_scaled(rt_random_direction(&random), 0.1 * (i + 1))));
            if (i % 3 == 0) assert_ok(rt_scene_add_triangle(&scene, 0, p, NULL, error));
            if (i % 3 == 1) assert_ok(rt_scene_add_sphere(&scene, 0, p[0], 0.02f * (float)(i + 1), error));
            if (i % 6 == 2) assert_ok(rt_scene_add_cone(&scene, 0, p[0], 0.1f, p[1], 0.3f, error));
            if (i % 6 == 5) assert_ok(rt_scene_add_polygon(&scene, 0, p, 3, error));
        }
        check_scene(&scene);
    }
}

RT_TEST(an_eye_inside_a_sphere_sees_its_inside) {
    RtScene scene = begin_view();
    look(&scene, rt_vec3(0.5f, 0, 0), rt_vec3(-1, 0.25f, 0.5f));
    assert_ok(rt_scene_add_sphere(&scene, 0, rt_vec3(0, 0, 0), 2, error));
    assert_ok(rt_scene_add_sphere(&scene, 0, rt_vec3(-1, 0, 0), 0.5f, error));
    check_scene(&scene);
}

RT_TEST(an_eye_in_the_plane_of_a_polygon_or_at_its_corner_is_no_trouble) {
    const RtVec3 square[4] = {{{-1, -1, 0}}, {{1, -1, 0}}, {{1, 1, 0}}, {{-1, 1, 0}}};
    const RtVec3 eyes[] = {{{0, -4, 0}}, {{0, 0, 0}}, {{-1, -1, 0}}, {{0, -4, 1e-6f}}, {{0, 0, 1e-5f}}};
    for (size_t i = 0; i < sizeof eyes / sizeof eyes[0]; i++) {
        RtScene scene = begin_view();
        look(&scene, eyes[i], rt_vec3(0.125f, 0.25f, i == 4 ? -0.5f : 0));
        assert_ok(rt_scene_add_polygon(&scene, 0, square, 4, error));
        assert_ok(rt_scene_add_triangle(&scene, 0, square, NULL, error));
        assert_ok(rt_scene_add_sphere(&scene, 0, rt_vec3(0, 0, -1), 0.75f, error));
        check_scene(&scene);
    }
}

/* A floor seen so flat that a hit function knows t to a tenth, with a ball in it. */
RT_TEST(a_floor_seen_very_flat_and_a_ball_in_it_are_told_apart) {
    const RtVec3 floor[4] = {{{-50, -50, 0}}, {{50, -50, 0}}, {{50, 50, 0}}, {{-50, 50, 0}}};
    RtScene scene = begin_view();
    look(&scene, rt_vec3(0, 0, 0x1p-10f), rt_vec3(0, 8, 0x1p-10f));
    scene.camera.fov = 0.1f;
    assert_ok(rt_scene_add_polygon(&scene, 0, floor, 4, error));
    assert_ok(rt_scene_add_sphere(&scene, 0, rt_vec3(0, 10.4f, 0), 2, error));
    check_scene(&scene);
}

/* 5 x 5 samples of a picture 2 wide at distance 1: one every 0.4, the middle one on the axis. */
RT_TEST(an_object_smaller_than_a_sample_is_seen_on_one_and_not_between) {
    for (int on = 0; on < 2; on++) {
        float x = on ? 0 : 0.2f;
        const RtVec3 triangle[3] = {{{x - 1e-4f, 1, -1e-4f}}, {{x + 1e-4f, 1, -1e-4f}}, {{x, 1, 1e-4f}}};
        RtScene scene = begin_view();
        scene.camera.width = scene.camera.height = 5;
        scene.camera.fov = 90;
        look(&scene, rt_vec3(0, 0, 0), rt_vec3(0, 1, 0));
        assert_ok(rt_scene_add_triangle(&scene, 0, triangle, NULL, error));
        assert_ok(rt_scene_add_sphere(&scene, 0, rt_vec3(-0.8f + x, 2, 0), 1e-4f, error));
        assert_ok(rt_scene_finish(&scene, error));
        OWNED_FRAME frame = trace("item+brute", &scene, true);
        assert_int_equal(frame.tallies[RT_RAY_PRIMARY].passed_on, 0);
        assert_int_equal(frame.tallies[RT_RAY_PRIMARY].hits, on ? 2 : 0);
        assert_int_equal(frame.object[12], on ? 0 : RT_NO_OBJECT);
        assert_int_equal(frame.object[11], on ? 1 : RT_NO_OBJECT);
        check_finished(&scene);
    }
}

/* The same square several times, last ids in front by 0 to 4 ulps of its depth. */
RT_TEST(coincident_and_nearly_coplanar_polygons_are_told_apart) {
    for (int ulps = 0; ulps <= 4; ulps++) {
        RtScene scene = begin_view();
        look(&scene, rt_vec3(0.3f, -7, 0.2f), rt_vec3(0, 0, 0));
        float y = 1;
        for (int i = 0; i < 4; i++) {
            const RtVec3 square[4] = {{{-1, y, -1}}, {{1, y, -1}}, {{1, y, 1}}, {{-1, y, 1}}};
            if (i % 2) assert_ok(rt_scene_add_triangle(&scene, 0, square, NULL, error));
            assert_ok(rt_scene_add_polygon(&scene, 0, square, 4, error));
            for (int k = 0; k < ulps; k++) y = nextafterf(y, 0);
        }
        check_scene(&scene);
    }
}

RT_TEST(touching_and_coincident_spheres_are_told_apart) {
    RtScene scene = begin_view();
    look(&scene, rt_vec3(0, -8, 0), rt_vec3(0, 0, 0));
    for (int i = 0; i < 3; i++) {
        assert_ok(rt_scene_add_sphere(&scene, 0, rt_vec3(1, (float)i, 0), 1, error));
        assert_ok(rt_scene_add_sphere(&scene, 0, rt_vec3(-1, 0, 0), 1, error));
        assert_ok(rt_scene_add_sphere(&scene, 0, rt_vec3(1, (float)i - 0.5f, 0), 0.5f, error));
    }
    check_scene(&scene);
}

RT_TEST(the_near_plane_hides_what_is_before_it) {
    const RtVec3 pane[4] = {{{-3, 1, -3}}, {{3, 1, -3}}, {{3, 1, 3}}, {{-3, 1, 3}}};
    const float planes[] = {0.5f, 0x1.fffffep-1f, 1, 0x1.000002p+0f, 4.25f, 5, 100};
    for (size_t i = 0; i < sizeof planes / sizeof planes[0]; i++) {
        RtScene scene = begin_view();
        look(&scene, rt_vec3(0, 0, 0), rt_vec3(0, 1, 0));
        scene.camera.near = planes[i];
        assert_ok(rt_scene_add_polygon(&scene, 0, pane, 4, error));
        assert_ok(rt_scene_add_sphere(&scene, 0, rt_vec3(0, 5, 0), 1, error)); /* cut open at 4.25 */
        check_scene(&scene);
    }
}

/* A pentagram turns left at every corner; a notch turns right at one. */
RT_TEST(concave_polygons_are_drawn_right) {
    const RtVec3 notched[5] = {{{-2, 0, -2}}, {{2, 0, -2}}, {{2, 0, 2}}, {{0, 0, -1}}, {{-2, 0, 2}}};
    RtVec3 star[5];
    for (int i = 0; i < 5; i++) {
        double angle = 2 * i * 2 * 3.14159265358979 / 5;
        star[i] = rt_vec3((float)cos(angle), -1, (float)sin(angle));
    }
    for (int side = -1; side <= 1; side += 2) {
        RtScene scene = begin_view();
        look(&scene, rt_vec3(0.5f, 6 * (float)side, 0.25f), rt_vec3(0, 0, 0));
        assert_ok(rt_scene_add_polygon(&scene, 0, notched, 5, error));
        assert_ok(rt_scene_add_polygon(&scene, 0, star, 5, error));
        check_scene(&scene);
    }
}

/* A triangle that reaches far to both sides, with an upper edge a little below the rays of one row: its hit
 * function rounds as befits its size, and says of some of these rays that they hit. */
static void check_rounding(float reach, float below) {
    RtRandom random = rt_random(17, 0);
    uint32_t beyond = 0;
    for (uint32_t row = 0; row < 36; row++) {
        RtView view;
        RtScene scene = begin_view();
        look(&scene, rt_vec3(0, 0, 0), rt_vec3(0, 1, 0));
        scene.camera.fov = 150;
        assert_ok(rt_sampling_init(&scene.sampling, 48, 36, 1, false, error));
        assert_ok(rt_view_init(&view, &scene.camera, scene.sampling, error));
        float z = rt_view_ray(&view, 0, row).dir.z - below;
        float far = reach * (1 + rt_random_unit(&random));
        const RtVec3 triangle[3] = {{{-far, 1, z}}, {{far, 1, z}}, {{0, 1, z - 100}}};
        assert_ok(rt_scene_add_triangle(&scene, 0, triangle, NULL, error));
        assert_ok(rt_scene_finish(&scene, error));
        OWNED_FRAME frame = trace("brute", &scene, false);
        for (uint32_t i = row * 48; i < (row + 1) * 48; i++) beyond += frame.object[i] == 0;
        check_finished(&scene);
    }
    if (beyond <= 20) fail_msg("%u rays hit by rounding alone", beyond);
}

RT_TEST(what_is_hit_by_rounding_alone_is_drawn_as_hit) {
    check_rounding(3e4f, 2e-4f); /* placed by its box */
    check_rounding(60, 1e-6f);   /* by its vertices */
}

RT_TEST(scenes_far_off_tiny_or_huge_are_drawn_right) {
    const float sizes[] = {1e-30f, 1e-3f, 1, 1e15f}, places[] = {0, 0, 1e4f, 0};
    for (int k = 0; k < 4; k++) {
        RtRandom random = rt_random(3, (uint64_t)k);
        RtScene scene = begin_view();
        for (int i = 0; i < 80; i++) {
            RtVec3 p[3];
            for (int j = 0; j < 3; j++) {
                p[j] = rt_narrow(rt_scaled(rt_random_direction(&random), (double)sizes[k]));
                p[j] = rt_add(p[j], rt_vec3(places[k], places[k], places[k]));
            }
            if (i % 2)
                assert_ok(rt_scene_add_triangle(&scene, 0, p, NULL, error));
            else
                assert_ok(rt_scene_add_sphere(&scene, 0, p[0], sizes[k] / 8, error));
        }
        check_scene(&scene);
    }
}

/* 32 x 32 samples, of which a wall covers half, on each of four sides. Behind its edge, which is between two
 * rows or columns of blocks, is a row of small triangles. */
RT_TEST(small_triangles_that_are_half_hidden_are_drawn) {
    for (int side = 0; side < 4; side++) {
        const int axis = side & 1 ? 0 : 2;
        const float past = side & 2 ? 2 : -2;
        RtVec3 wall[4] = {{{-2, 1, -2}}, {{2, 1, -2}}, {{2, 1, 2}}, {{-2, 1, 2}}};
        RtScene scene = begin_view();
        scene.camera.width = scene.camera.height = 32;
        scene.camera.fov = 90;
        look(&scene, rt_vec3(0, 0, 0), rt_vec3(0, 1, 0));
        for (int i = 0; i < 4; i++) {
            if (wall[i].at[axis] == past) wall[i].at[axis] = 0;
        }
        const RtVec3 other[3] = {wall[0], wall[2], wall[3]};
        assert_ok(rt_scene_add_triangle(&scene, 0, wall, NULL, error));
        assert_ok(rt_scene_add_triangle(&scene, 0, other, NULL, error));
        for (int k = 0; k < 16; k++) {
            const float along = 1.25f * ((float)k - 7.5f), across[3] = {-1, -1, 1.5f},
                        beside[3] = {-0.5f, 0.5f, 0};
            RtVec3 v[3];
            for (int i = 0; i < 3; i++) {
                v[i] = rt_vec3(along + beside[i], 10, along + beside[i]);
                v[i].at[axis] = past < 0 ? across[i] : -across[i];
            }
            assert_ok(rt_scene_add_triangle(&scene, 0, v, NULL, error));
        }
        check_scene(&scene);
    }
}

RT_TESTS(item, NULL, assert_nothing_is_kept)
