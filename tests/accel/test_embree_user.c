/* SPDX-License-Identifier: Apache-2.0 */
/* accel/embree, mode=user: brute bit for bit, by every query, instruction set and quality, in scenes of every
 * size. Skipped without Embree. */
#include "embree_testing.h"

#ifdef RT_WITH_EMBREE
#include "accel/embree/embree.h"
#endif

RT_TEST(user_mode_is_brute_bit_for_bit_by_every_query) {
    static const char *const specs[] = {
        "embree:mode=user,query=1,robust=on",  "embree:mode=user,query=1,robust=off",
        "embree:mode=user,query=8,robust=off", "embree:mode=user,query=8,robust=on",
        "embree:mode=user,query=16,robust=on", "embree:mode=user,query=16,robust=off",
        "embree:mode=user,query=stream",       "embree:mode=user,query=stream,robust=on",
    };
    OWNED_SCENE scene = make_soup(60, 2, 10);
    OWNED_RAYS rays = make_rays(&scene, 100003, 10, 3);
    compare_with_brute(&scene, rays, specs, sizeof specs / sizeof specs[0]);
}

/* An instruction set that the machine lacks is refused; then there is nothing to compare. */
RT_TEST(user_mode_is_brute_by_every_isa_and_quality) {
    static const char *const isas[] = {"sse2", "sse4.2", "avx", "avx2", "avx512"};
    static const char *const qualities[] = {"low", "medium", "high"};
    static const char *const queries[] = {"1", "8", "16", "stream"};
    OWNED_SCENE scene = make_soup(40, 2, 1000);
    OWNED_RAYS rays = make_rays(&scene, 5000, 1000, 20);
    for (size_t i = 0; i < 60; i++) {
        char spec[RT_MAX_SPEC_CHARS];
        snprintf(spec, sizeof spec, "embree:mode=user,isa=%s,quality=%s,query=%s", isas[i % 5],
                 qualities[i / 5 % 3], queries[i / 15]);
        const char *const one[] = {spec};
        compare_with_brute(&scene, rays, one, 1);
    }
}

RT_TEST(user_mode_is_brute_in_scenes_of_every_size_and_from_far_away) {
    static const float sizes[] = {1e-12f, 1e-6f, 1e6f, 1e12f};
    static const char *const specs[] = {"embree:mode=user", "embree:mode=user,query=16"};
    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
        OWNED_SCENE scene = make_soup(40, 1, sizes[i]);
        OWNED_RAYS rays = make_rays(&scene, 4000, sizes[i], i % 2 ? 3 : 1e5f);
        compare_with_brute(&scene, rays, specs, 2);
    }
}

/* Every hit is traced again with an interval that is only its t, and from its point. */
RT_TEST(user_mode_finds_hits_at_the_very_ends_of_the_interval) {
    static const char *const specs[] = {"embree:mode=user", "embree:mode=user,query=8,robust=on",
                                        "embree:mode=user,query=16", "embree:mode=user,query=stream"};
    OWNED_SCENE scene = make_soup(60, 2, 10);
    OWNED_RAYS rays = make_rays(&scene, 10000, 10, 3);
    OWNED_ANSWERS hit = ask(&scene, "brute", rays, false);
    for (size_t i = 0; i < rays.count; i++) {
        RtRay *ray = &rays.rays[i];
        if (hit.hits[i].object == RT_NO_OBJECT) continue;
        if (i % 2) {
            ray->tmin = ray->tmax = hit.hits[i].t;
        } else {
            ray->org = rt_narrow(rt_ray_point(ray, hit.hits[i].t));
            ray->tmin = ray->tmax = 0;
        }
    }
    compare_with_brute(&scene, rays, specs, sizeof specs / sizeof specs[0]);
}

/* Directions so long that a step between two values of t is as large as an object, or as the scene. */
RT_TEST(user_mode_is_brute_where_t_is_denormal) {
    static const float sizes[] = {1e-9f, 1e-8f, 1e-7f};
    static const char *const specs[] = {"embree:mode=user", "embree:mode=user,query=16"};
    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
        OWNED_SCENE scene = make_soup(40, 1, sizes[i]);
        OWNED_RAYS rays = make_rays(&scene, 4000, sizes[i], 3);
        for (size_t k = 0; k < rays.count; k++) {
            RtRay *ray = &rays.rays[k];
            RtVec3d dir = rt_widen(ray->dir);
            ray->dir = rt_narrow(rt_scaled(dir, 0x1p126 / fabs(dir.at[rt_major_axis(ray->dir)])));
            ray->tmin = k % 3 ? 0 : 0x1p-149f;
            ray->tmax = INFINITY;
            assert_true(rt_ray_is_valid(ray));
        }
        compare_with_brute(&scene, rays, specs, 2);
    }
}

RT_TEST(user_mode_counts_tests_where_it_is_asked_to) {
    OWNED_SCENE scene = make_soup(60, 1, 10);
    OWNED_RAYS rays = make_rays(&scene, 100 * RT_RAY_KIND_COUNT, 10, 3);
    Answers brute = ask(&scene, "brute", rays, true), user = ask(&scene, "embree:mode=user", rays, true);
    for (size_t kind = 0; kind < RT_RAY_KIND_COUNT; kind++) {
        const RtTally *b = &brute.tallies[kind], *u = &user.tallies[kind];
        assert_int_equal(u->rays, 100);
        assert_int_equal(u->hits, b->hits);
        assert_true(u->object_tests >= u->object_hits && u->object_hits >= u->hits);
        assert_true(u->object_tests < b->object_tests);
    }
    forget(&brute);
    forget(&user);
}

#ifdef RT_WITH_EMBREE
/* A sphere of radius 1, at 0 and far off: twice the thickness of a ray from 8 away, which is four times the
 * size, and 2^-21 of the largest coordinate. With 15/16 of either this fails. */
RT_TEST(boxes_of_user_geometry_grow_by_their_bound) {
    for (int far = 0; far < 2; far++) {
        const float x = far ? 0x1p16f : 0;
        OWNED_SCENE scene = begin_scene();
        assert_ok(rt_scene_add_sphere(&scene, 0, rt_vec3(x, 0, 0), 1, error));
        scene.camera.from = rt_vec3(x, 0, 2);
        scene.camera.at = rt_vec3(x, 0, 0);
        assert_ok(rt_scene_finish(&scene, error));
        OWNED_ACCEL RtEmbree *embree = open_accel(&scene, "embree:mode=user");
        double thick = 0x1p-20 * 8, rounding = 0x1p-21 * ((double)x + 1), least = far ? 31.0 / 32 : 1;
        assert_true((double)embree->growth >= 2 * thick + least * rounding);
        assert_true((double)embree->growth <= 2 * thick + 33.0 / 32 * rounding);
        assert_true((double)embree->max_thickness > 31.0 / 32 * thick);
        assert_true((double)embree->max_thickness <= thick);
    }
}

/* What remains for a scene that is hardly more than a point. */
RT_TEST(boxes_of_user_geometry_grow_even_among_the_least_numbers) {
    OWNED_SCENE scene = begin_scene();
    assert_ok(rt_scene_add_sphere(&scene, 0, rt_vec3(0, 0, 0), 0x1p-130f, error));
    scene.camera.from = rt_vec3(0, 0, 0x1p-120f);
    scene.camera.at = rt_vec3(0, 0, 0);
    assert_ok(rt_scene_finish(&scene, error));
    OWNED_ACCEL RtEmbree *embree = open_accel(&scene, "embree:mode=user");
    assert_true((double)embree->growth >= 31.0 / 32 * 0x1p-100);
}

RT_TEST(the_first_error_that_embree_reports_is_told) {
    OWNED_SCENE_OF(scene, sphere, rt_vec3(0, 0, 0), 1);
    OWNED_ACCEL RtEmbree *embree = open_accel(&scene, "embree:mode=user");
    assert_ok(rt_embree_check(&embree->base, error));
    RTCScene empty = rtcNewScene(embree->device.device);
    rtcAttachGeometry(empty, NULL);
    assert_fails_with(rt_embree_check(&embree->base, error), RT_MISMATCH, "invalid argument");
    rtcReleaseScene(empty);
}

/* At 1.5, 2^-20 is 12 units in the last place. */
RT_TEST(searches_go_on_beyond_a_hit_by_their_bound) {
    assert_true((double)rt_embree_limit(1.5f, 1) == 1.5 + 12 * 0x1p-23);
    assert_true((double)rt_embree_limit(0, 1) == (double)FLT_MIN);
}
#endif

RT_TEST_GROUP(embree_user) {
    if (!embree_is_built_in()) return RT_TEST_SKIPPED;
    return RT_RUN_TESTS("embree_user", NULL, NULL);
}
