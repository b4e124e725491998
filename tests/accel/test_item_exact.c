/* SPDX-License-Identifier: Apache-2.0 */
/* The item buffer is never wrong where geometry is awkward: eyes inside objects and in their planes, objects
 * that touch, rounding, scenes tiny and huge. */
#include "item_testing.h"

#include "core/base/random.h"

#include <math.h>

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

RT_TESTS(item_exact, NULL, assert_nothing_is_kept)
