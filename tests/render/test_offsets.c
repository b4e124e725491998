/* SPDX-License-Identifier: Apache-2.0 */
/* render/illumination.h: secondary rays start far enough off their surface to miss it and its box, and no
 * farther. */
#include "accel_testing.h"
#include "render_testing.h"

/* Counts of a frame that sees one object of size `s`, moved to `away`, under a light beside the camera. */
static RtTally shadow_tally_of_one_object(int shape, float s, float away) {
    OWNED_SCENE scene = start_scene((RtMaterial){.color = {1, 1, 1}, .diffuse = 1, .ior = 1});
    RtVec3 to = {away, away, away};
    RtVec3 corners[3] = {{-30 * s, -20 * s, s}, {30 * s, -20 * s, -s}, {0, 40 * s, 0}};
    RtVec3 floor[4] = {
        {-40 * s, -40 * s, 0}, {40 * s, -40 * s, 0}, {40 * s, 40 * s, 0}, {-40 * s, 40 * s, 0}};
    for (int i = 0; i < 3; i++) corners[i] = rt_add(corners[i], to);
    for (int i = 0; i < 4; i++) floor[i] = rt_add(floor[i], to);
    if (shape == 0) assert_ok(rt_scene_add_sphere(&scene, 0, rt_add(rt_vec3(s, s, s), to), 3 * s, error));
    if (shape == 1) assert_ok(rt_scene_add_triangle(&scene, 0, corners, NULL, error));
    if (shape == 2) assert_ok(rt_scene_add_polygon(&scene, 0, corners, 3, error));
    if (shape == 3) assert_ok(rt_scene_add_polygon(&scene, 0, floor, 4, error));
    scene.camera.from = rt_add(rt_vec3(0.1f * s, -20 * s, 5 * s), to);
    scene.camera.at = rt_add(scene.camera.at, to);
    assert_ok(rt_scene_add_light(&scene, rt_add(rt_vec3(0, -25 * s, 5 * s), to), rt_vec3(1, 1, 1), error));
    assert_ok(rt_scene_finish(&scene, error));
    RtFrameOptions options = options_for(&scene, 64, 64, false);
    options.counted = true;
    OWNED_FRAME frame = trace(&scene, &options);
    RtTally tally = frame.tallies[RT_RAY_SHADOW];
    return tally;
}

/* Whatever is seen and faces the light is lit, of any size, near zero or far from it. */
RT_TEST(nothing_shadows_itself) {
    for (int scale = -20; scale <= 20; scale += 10) {
        for (int shape = 0; shape < 4; shape++) {
            for (int far = 0; far < 3; far++) {
                float s = ldexpf(1, scale), away = far == 0 ? 0 : far == 1 ? 1e3f * s : 1e5f * s;
                RtTally tally = shadow_tally_of_one_object(shape, s, away);
                assert_true(tally.rays > 400);
                assert_int_equal(tally.hits, 0);
            }
        }
    }
}

/* A floor's box is flat, and box tests take it for thicker than it is; a shadow ray must start above that. */
RT_TEST(a_shadow_ray_off_a_floor_leaves_the_box_of_the_floor_behind) {
    for (int half = 1; half < 100000; half *= 7) {
        float size = (float)half;
        OWNED_SCENE scene = start_scene((RtMaterial){.color = {1, 1, 1}, .diffuse = 1, .ior = 1});
        add_square(&scene, size, 0.3f);
        assert_ok(rt_scene_add_light(&scene, rt_vec3(0, 0, 3 * size), rt_vec3(1, 1, 1), error));
        assert_ok(rt_scene_finish(&scene, error));
        for (int i = 0; i < 100; i++) {
            RtVec3 org = {0.019f * size * (float)(i - 50), 0.013f * size * (float)(50 - i), 2};
            RtSurface surface = surface_of(&scene, org, rt_vec3(0, 0, -1), 2 - 0.3f);
            RtRay ray;
            RtVec3 light;
            float enter;
            assert_true(rt_shadow_ray(&scene, &surface, 0, &ray, &light));
            RtPreparedRay prepared = rt_ray_prepare(&ray, &scene.geometry.box);
            assert_false(rt_box_hit(&scene.geometry.boxes[0], &prepared, 1, &enter));
        }
    }
}

/* So does one off a small facet of a larger scene, whose thickness is what a structure tests boxes with. */
RT_TEST(a_shadow_ray_off_a_facet_leaves_its_box_behind_in_a_larger_scene) {
    RtVec3 facet[3] = {{10, 10, 1}, {10.1f, 10, 1}, {10, 10.1f, 1}}, light;
    RtRay ray;
    float enter;
    OWNED_SCENE scene = start_scene((RtMaterial){.color = {1, 1, 1}, .diffuse = 1, .ior = 1});
    assert_ok(rt_scene_add_polygon(&scene, 0, facet, 3, error));
    add_square(&scene, 12, 0);
    assert_ok(rt_scene_add_light(&scene, rt_vec3(0, 0, 40), rt_vec3(1, 1, 1), error));
    assert_ok(rt_scene_finish(&scene, error));
    RtSurface surface = surface_of(&scene, rt_vec3(10.02f, 10.03f, 2), rt_vec3(0, 0, -1), 1);
    assert_true(rt_shadow_ray(&scene, &surface, 0, &ray, &light));
    RtPreparedRay prepared = rt_ray_prepare(&ray, &scene.geometry.box);
    assert_false(rt_box_hit(&scene.geometry.boxes[0], &prepared, 1, &enter));
}

RT_TEST(offsets_stay_fine_far_from_zero) {
    OWNED_SCENE scene = start_scene((RtMaterial){.color = {1, 1, 1}, .diffuse = 1, .ior = 1});
    assert_ok(rt_scene_add_sphere(&scene, 0, rt_vec3(1e5f, 0, 0), 1, error));
    assert_ok(rt_scene_finish(&scene, error));
    RtSurface surface = surface_of(&scene, rt_vec3(1e5f, 0, 10), rt_vec3(0, 0, -1), 9);
    assert_true(surface.offset > 0.0078 && surface.offset < 0.05); /* an ulp of 1e5 is 0.0078 */
}

RT_TESTS(offsets, NULL, NULL)
