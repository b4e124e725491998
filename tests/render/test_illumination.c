/* SPDX-License-Identifier: Apache-2.0 */
/* render/illumination.h: shading, and the rays that leave a surface, against results known by hand. */
#include "accel_testing.h"
#include "render_testing.h"

RT_TEST(a_point_is_shaded_by_the_sum_of_all_five_terms) {
    /* Looking down on a mirror floor. The light stands at 45 degrees: N.L = sqrt(1/2), and the mirrored light
     * makes 45 degrees with the viewer too, so (R.V)^2 = 1/2. Reflection and transmission see the
     * background. */
    OWNED_SCENE scene = start_scene((RtMaterial){.color = {0.5f, 1, 0},
                                                 .ambient = 0.1f,
                                                 .diffuse = 0.4f,
                                                 .specular = 0.3f,
                                                 .shine = 2,
                                                 .reflection = 0.25f,
                                                 .transmission = 0.125f,
                                                 .ior = 1});
    scene.ambient = rt_vec3(1, 0.5f, 1);
    scene.background = rt_vec3(0, 0, 0.8f);
    add_square(&scene, 1, 0);
    assert_ok(rt_scene_add_light(&scene, rt_vec3(5, 0, 5), rt_vec3(2, 1, 1), error));
    assert_ok(rt_scene_finish(&scene, error));
    RtFrameOptions options = options_for(&scene, 1, 1, false);
    OWNED_FRAME frame = trace(&scene, &options);
    double cosine = sqrt(0.5);
    assert_near(frame.color[0].x, 0.1 * 0.5 * 1 + 2 * (0.4 * cosine * 0.5 + 0.3 * 0.5), 1e-5);
    assert_near(frame.color[0].y, 0.1 * 1 * 0.5 + 1 * (0.4 * cosine * 1 + 0.3 * 0.5), 1e-5);
    assert_near(frame.color[0].z, 0.3 * 0.5 + 0.25 * 0.8 + 0.125 * 0.8, 1e-5);
    assert_int_equal(frame.object[0], 0);
    assert_near(frame.depth[0], 10, 1e-5);
}

RT_TEST(an_object_between_point_and_light_takes_the_light_away) {
    OWNED_SCENE scene = start_scene((RtMaterial){.color = {1, 1, 1}, .diffuse = 1, .ior = 1});
    add_square(&scene, 1, 0);
    assert_ok(rt_scene_add_sphere(&scene, 0, rt_vec3(2, 0, 2), 0.5f, error));
    assert_ok(rt_scene_add_light(&scene, rt_vec3(4, 0, 4), rt_vec3(1, 1, 1), error));
    assert_ok(rt_scene_finish(&scene, error));
    RtFrameOptions options = options_for(&scene, 1, 1, false);
    OWNED_FRAME dark = trace(&scene, &options);
    assert_true(dark.color[0].x == 0);
    /* An object behind the light takes nothing. */
    scene.lights[0].position = rt_vec3(1, 0, 1);
    OWNED_FRAME lit = trace(&scene, &options);
    assert_near(lit.color[0].x, sqrt(0.5), 1e-5);
}

RT_TEST(shadow_rays_go_to_lights_on_the_viewers_side_alone) {
    OWNED_SCENE scene = start_scene((RtMaterial){.color = {1, 1, 1}, .diffuse = 1, .ior = 1});
    add_square(&scene, 1, 0);
    assert_ok(rt_scene_add_light(&scene, rt_vec3(0, 0, 5), rt_vec3(1, 1, 1), error));
    assert_ok(rt_scene_add_light(&scene, rt_vec3(0, 0, -5), rt_vec3(1, 1, 1), error));
    assert_ok(rt_scene_add_light(&scene, rt_vec3(5, 0, 0), rt_vec3(1, 1, 1), error));
    assert_ok(rt_scene_finish(&scene, error));
    RtSurface above = surface_of(&scene, rt_vec3(0, 0, 10), rt_vec3(0, 0, -1), 10);
    RtSurface below = surface_of(&scene, rt_vec3(0, 0, -10), rt_vec3(0, 0, 1), 10);
    RtRay ray;
    RtVec3 light;
    assert_true(rt_shadow_ray(&scene, &above, 0, &ray, &light));
    assert_true(ray.kind == RT_RAY_SHADOW && ray.source == 0 && ray.tmax == 1 && ray.org.z > 0);
    assert_true(ray.org.z + ray.dir.z == 5);
    assert_false(rt_shadow_ray(&scene, &above, 1, &ray, &light));
    assert_false(rt_shadow_ray(&scene, &above, 2, &ray, &light)); /* grazing: N.L = 0 */
    assert_false(rt_shadow_ray(&scene, &below, 0, &ray, &light));
    assert_true(rt_shadow_ray(&scene, &below, 1, &ray, &light));
    assert_true(ray.org.z < 0);
}

static void glass(RtScene *scene, float reflection) {
    *scene = start_scene((RtMaterial){.transmission = 0.5f, .reflection = reflection, .ior = 1.5f});
    add_square(scene, 10, 0);
    assert_ok(rt_scene_finish(scene, error));
}

RT_TEST(a_ray_into_glass_bends_by_snells_law_and_back_out) {
    OWNED_SCENE scene;
    glass(&scene, 0.25f);
    RtRay rays[RT_MAX_SPAWN];
    float factors[RT_MAX_SPAWN];
    /* sin 30 / sin x = 1.5: sin x = 1/3. */
    RtVec3 into = rt_vec3(0.5f, 0, -(float)sqrt(0.75));
    RtSurface surface = surface_of(&scene, rt_scale(into, -4), into, 4);
    assert_int_equal(rt_spawn_rays(&surface, rays, factors), 2);
    assert_int_equal(rays[0].kind, RT_RAY_REFLECTION);
    assert_near(rays[0].dir.x, 0.5, 1e-6);
    assert_near(rays[0].dir.z, sqrt(0.75), 1e-6);
    assert_true(rays[0].org.z > 0 && factors[0] == 0.25f);
    assert_int_equal(rays[1].kind, RT_RAY_TRANSMISSION);
    assert_near(rays[1].dir.x, 1.0 / 3, 1e-6);
    assert_near(rays[1].dir.z, -sqrt(8.0 / 9), 1e-6);
    assert_true(rays[1].org.z < 0 && factors[1] == 0.5f);

    /* The way back, from behind the normal. */
    RtVec3 out = rt_vec3(1.0f / 3, 0, (float)sqrt(8.0 / 9));
    surface = surface_of(&scene, rt_scale(out, -4), out, 4);
    assert_int_equal(rt_spawn_rays(&surface, rays, factors), 2);
    assert_near(rays[1].dir.x, 0.5, 1e-6);
    assert_near(rays[1].dir.z, sqrt(0.75), 1e-6);
}

RT_TEST(total_internal_reflection_is_one_reflection_ray_with_both_factors) {
    /* The critical angle of 1.5 has the sine 2/3. */
    for (int with_mirror = 0; with_mirror < 2; with_mirror++) {
        OWNED_SCENE scene;
        glass(&scene, with_mirror ? 0.25f : 0);
        RtRay rays[RT_MAX_SPAWN];
        float factors[RT_MAX_SPAWN];
        for (int steep = 0; steep < 2; steep++) {
            float sine = steep ? 0.66f : 0.67f;
            RtVec3 out = rt_vec3(sine, 0, (float)sqrt(1 - (double)sine * (double)sine));
            RtSurface surface = surface_of(&scene, rt_scale(out, -4), out, 4);
            uint32_t count = rt_spawn_rays(&surface, rays, factors);
            if (steep) {
                assert_int_equal(count, 1 + with_mirror);
                continue;
            }
            assert_int_equal(count, 1);
            assert_int_equal(rays[0].kind, RT_RAY_REFLECTION);
            assert_true(factors[0] == (with_mirror ? 0.75f : 0.5f));
            assert_true(rays[0].org.z < 0 && rays[0].dir.z < 0);
        }
    }
}

RT_TESTS(illumination, NULL, NULL)
