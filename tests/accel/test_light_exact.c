/* SPDX-License-Identifier: Apache-2.0 */
/* The light buffer answers like brute where that is hard: lights in awkward places, rounding from far off,
 * rays along edges and corners of cells; and it is no worse for it. */
#include "light_testing.h"

/* Asks `spec` about the rays; fails where brute says otherwise. Gives what was counted. */
static RtTally check_like_brute(const char *spec, const RtScene *scene, const RtRay *rays, size_t count) {
    RtTally tallies[RT_RAY_KIND_COUNT] = {{0}}, of_brute[RT_RAY_KIND_COUNT] = {{0}};
    const char *specs[2] = {"brute", spec};
    bool *blocked[2];
    for (int i = 0; i < 2; i++) {
        blocked[i] = rt_alloc(count, sizeof(bool));
        assert_non_null(blocked[i]);
        OWNED_ACCEL RtAccel *accel = open_valid(scene, specs[i]);
        OWNED_QUERY query = open_query(accel);
        rt_occluded(&query, rays, count, blocked[i], i ? tallies : of_brute);
    }
    for (size_t k = 0; k < count; k++) {
        if (blocked[0][k] != blocked[1][k]) fail_msg("%s: ray %zu", spec, k);
    }
    rt_free(blocked[0]);
    rt_free(blocked[1]);
    return tallies[RT_RAY_SHADOW];
}

/* ---- lights in awkward places ---- */

enum { AWKWARD_RAYS = RT_SHARE(40000, 4000) };

/* Rays from anywhere, from vertices and poles, and from points just off the edges between cells. */
static void make_awkward_rays(const RtScene *scene, RtRay *rays, float away) {
    RtRandom random = rt_random(6, 0);
    for (size_t i = 0; i < AWKWARD_RAYS; i++) {
        uint32_t light = (uint32_t)i % scene->light_count, k = rt_random_bits(&random);
        RtVec3 from = moved(random_point(&random, 6), away);
        if (k % 4 == 0) from = scene->geometry.triangles[k / 4 % 40].v[k / 256 % 3];
        if (k % 4 == 1) {
            RtVec3 to = scene->lights[light].position;
            float depth = 5 * rt_random_unit(&random), u = (float)((int)(k / 4 % 17) - 8) / 8;
            from = rt_add(to, rt_vec3(u * depth, (k & 64 ? u : 0.3f) * depth, k & 128 ? depth : -depth));
        }
        rays[i] = shadow_ray(scene, from, light);
        if (!rt_ray_is_valid(&rays[i])) rays[i] = shadow_ray(scene, moved(rt_vec3(5, 5, 5), away), light);
    }
}

RT_TEST(lights_in_awkward_places_are_answered_like_brute) {
    static RtRay rays[AWKWARD_RAYS];
    const char *specs[] = {"light:cells=1+bvh", "light:cells=16+bvh", "light:cells=61+bvh",
                           "light:cells=16,full_occlusion=off+bvh", "cache+light+bvh"};
    const float places[] = {0, 1000};
    for (size_t p = 0; p < 2; p++) {
        OWNED_SCENE scene = make_awkward(places[p]);
        make_awkward_rays(&scene, rays, places[p]);
        for (size_t i = 0; i < sizeof specs / sizeof specs[0]; i++) {
            RtTally tally = check_like_brute(specs[i], &scene, rays, AWKWARD_RAYS);
            assert_int_equal(tally.rays, AWKWARD_RAYS);
            assert_true(tally.passed_on < AWKWARD_RAYS / 2 || strstr(specs[i], "cache"));
        }
    }
}

/* ---- rounding, partial occluders, edges, receivers ---- */

/* A triangle 1 below the light, its edges at u, w = +- size and by `in` inside borders of cells, and one
 * corner that its diagonal passes; specks 2000 off widen the domain. A vertex is seen from 1000 off with an
 * error of 2^-24 of that, which is 2^-14 of the distance to the light: rays that miss by less are said to
 * hit, from the cells beside. */
static void check_far_off(float size, float in, const char *spec) {
    enum { COUNT = RT_SHARE(100000, 10000) };
    static RtRay rays[COUNT];
    const RtVec3 light = {{0.1f, 0.2f, 0.3f}};
    const float a = size - in, b = -size + 3 * in;
    const RtVec3 corners[3] = {{{a, b, -1}}, {{b, a, -1}}, {{a, a, -1}}};
    OWNED_SCENE scene = begin_scene();
    RtVec3 triangle[3] = {rt_add(light, corners[0]), rt_add(light, corners[1]), rt_add(light, corners[2])};
    assert_ok(rt_scene_add_triangle(&scene, 0, triangle, NULL, error));
    for (int i = -1; i <= 1; i += 2)
        assert_ok(rt_scene_add_sphere(&scene, 0, moved(rt_vec3(0, 0, 0), 2000.0f * (float)i), 1, error));
    assert_ok(rt_scene_add_light(&scene, light, rt_vec3(1, 1, 1), error));
    assert_ok(rt_scene_finish(&scene, error));
    RtRandom random = rt_random(7, 0);
    for (size_t i = 0; i < COUNT; i++) {
        double depth = 500 + 1000 * (double)rt_random_unit(&random), at[2];
        for (int k = 0; k < 2; k++) {
            double off = (0x1p-15 + 2 * (double)in) * ((double)rt_random_unit(&random) - 0.5);
            at[k] = (double)size * ((double)(rt_random_below(&random, 3)) - 1) + off;
        }
        /* along a border */
        if (i % 2) at[i / 2 % 2] = (double)size * (2 * (double)rt_random_unit(&random) - 1);
        RtVec3d from = rt_vec3d(at[0] * depth, at[1] * depth, -depth);
        rays[i] = shadow_ray(&scene, rt_add(light, rt_narrow(from)), 0);
    }
    RtTally tally = check_like_brute(spec, &scene, rays, COUNT);
    assert_true(tally.object_tests > COUNT / 20 && tally.passed_on == 0);
}

RT_TEST(rounding_far_off_is_within_the_margin) {
    check_far_off(0.25f, 0x1p-18f, "light:cells=8+brute");
    check_far_off(0.25f, 0x1.8p-16f, "light:cells=4096+brute");    /* a large triangle */
    check_far_off(0x1p-10f, 0x1.9p-17f, "light:cells=4096+brute"); /* a small one */
}

/* What a sphere over half of a cell does not hide is seen, without asking below. */
RT_TEST(a_partial_occluder_hides_nothing_beside_it) {
    enum { COUNT = RT_SHARE(20000, 4000) };
    static RtRay rays[COUNT];
    const char *specs[] = {"light:cells=1+brute", "light:cells=3+brute", "light:cells=16+brute",
                           "light:cells=61,longest=3+brute"};
    OWNED_SCENE scene = begin_scene();
    assert_ok(rt_scene_add_sphere(&scene, 0, rt_vec3(0.3f, 0.2f, 8), 1, error));
    assert_ok(rt_scene_add_cone(&scene, 0, rt_vec3(-2, -2, 6), 0.5f, rt_vec3(2, -2, 6), 0.5f, error));
    assert_ok(rt_scene_add_sphere(&scene, 0, rt_vec3(0, 0, -8), 8, error));
    assert_ok(rt_scene_add_light(&scene, rt_vec3(0, 0, 10), rt_vec3(1, 1, 1), error));
    assert_ok(rt_scene_finish(&scene, error));
    RtRandom random = rt_random(8, 0);
    for (size_t i = 0; i < COUNT; i++)
        rays[i] = shadow_ray(&scene, rt_add(random_point(&random, 4), rt_vec3(0, 0, 4)), 0);
    for (size_t i = 0; i < sizeof specs / sizeof specs[0]; i++) {
        RtTally tally = check_like_brute(specs[i], &scene, rays, COUNT);
        assert_int_equal(tally.passed_on, 0);
        assert_in_range(tally.hits, COUNT / 20, COUNT - COUNT / 20);
    }
}

/* Directions exactly along edges and corners of cells and of the cube, to three lights and to none. */
RT_TEST(directions_along_edges_and_corners_are_answered_like_brute) {
    enum { SIDE = 9, COUNT = 3 * SIDE * SIDE * SIDE };
    static RtRay rays[COUNT];
    const RtVec3 places[3] = {{{0, 0, 0}}, {{4, 4, 4}}, {{-1, 2, 0.5f}}};
    for (int lights = 3; lights >= 0; lights -= 3) {
        OWNED_SCENE scene = begin_scene();
        for (int i = 0; i < 27; i++) {
            RtVec3 at = rt_vec3((float)(i % 3 * 2 - 2), (float)(i / 3 % 3 * 2 - 2), (float)(i / 9 * 2 - 2));
            assert_ok(rt_scene_add_sphere(&scene, 0, at, 0.25f + 0.125f * (float)(i % 2), error));
        }
        assert_ok(rt_scene_add_sphere(&scene, 0, rt_vec3(0, 0, 3.75f), 0.25f, error));
        const RtVec3 square[4] = {{{-4, -4, -4}}, {{4, -4, -4}}, {{4, 4, -4}}, {{-4, 4, -4}}};
        assert_ok(rt_scene_add_polygon(&scene, 0, square, 4, error));
        for (int i = 0; i < lights; i++)
            assert_ok(rt_scene_add_light(&scene, places[i], rt_vec3(1, 1, 1), error));
        assert_ok(rt_scene_finish(&scene, error));
        size_t count = 0;
        for (int i = 0; i < COUNT; i++) {
            int k = i / 3;
            RtVec3 to = places[i % 3], from = rt_vec3((float)(k % SIDE - 4), (float)(k / SIDE % SIDE - 4),
                                                      (float)(k / SIDE / SIDE - 4));
            RtRay ray = {.org = from, .dir = rt_sub(to, from), .tmax = 1, .kind = RT_RAY_SHADOW};
            ray.source = (uint32_t)i % 3;
            if (rt_ray_is_valid(&ray)) rays[count++] = ray;
        }
        RtTally tally = check_like_brute("light:cells=1+brute", &scene, rays, count);
        assert_true(lights ? tally.passed_on == 0 : tally.passed_on == count);
        check_like_brute("light:cells=4+brute", &scene, rays, count);
        check_like_brute("light:cells=8+brute", &scene, rays, count);
        check_like_brute("light:cells=9+brute", &scene, rays, count);
    }
}

RT_TESTS(light_exact, NULL, assert_nothing_is_kept)
