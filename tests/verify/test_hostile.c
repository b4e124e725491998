/* SPDX-License-Identifier: Apache-2.0 */
/* Scenes at the limits of what readers accept, harder than any family (scenes/family.c): every exact
 * accelerator, at every value worth testing of its parameters, answers rays of every family like brute. Only
 * Embree's native mode may refuse a scene, whose own arithmetic it would overflow. It must survive the
 * others; it takes denormal numbers for 0. */
#include "equivalence_testing.h"

#include "verify/verify.h"

#include <float.h>

enum { RAYS = RT_SHARE(16, 4), SOME_SPECS = 3 }; /* of each family; of each accelerator */

#define LEAST 0x1p-149f

static void add_triangle(RtScene *scene, RtVec3 a, RtVec3 b, RtVec3 c) {
    assert_ok(rt_scene_add_triangle(scene, 0, (RtVec3[]){a, b, c}, NULL, error));
}

/* Checks the first `specs` specs of each accelerator's spread. */
static void assert_all_answer_like_brute(RtScene *scene, size_t specs) {
    OWNED_BENCH bench = {.scene = *scene};
    char spec[RT_MAX_SPEC_CHARS];
    assert_ok(rt_scene_finish(&bench.scene, error));
    assert_ok(rt_scene_sample(&bench.scene, 16, 16, 1, false, error));
    set_up_rays(&bench, 1, RAYS);
    for (size_t i = 0; i < bench.reference.count; i++) assert_true(rt_ray_is_valid(&bench.rays[i]));
    for (size_t i = 0; i < rt_accel_count(); i++) {
        for (size_t n = 0; n < specs && rt_spread_spec(rt_accel_at(i), n, spec); n++) {
            assert_true(conforms(&bench, spec, "mode=native overflows float32"));
        }
    }
}

/* Corners of a cube, numbered 0..7. */
static RtVec3 corner(uint32_t i, float size) {
    return rt_vec3(i & 1 ? size : -size, i & 2 ? size : -size, i & 4 ? size : -size);
}

RT_TEST(objects_at_the_largest_coordinates_are_hit_as_by_brute) {
    const float most = RT_MAX_COORDINATE;
    RtScene scene = begin_scene();
    for (uint32_t i = 0; i < 8; i++) {
        add_triangle(&scene, corner(i, most), corner(i ^ 1, most), corner(i ^ 6, most));
        assert_ok(rt_scene_add_sphere(&scene, 0, corner(i, most / 2), most / 2, error));
        assert_ok(rt_scene_add_sphere(&scene, 0, corner(i, most * 0.75f), most * 0x1p-20f, error));
        assert_ok(
            rt_scene_add_cone(&scene, 0, corner(i, most / 4), most / 8, corner(7 - i, most / 4), 0, error));
    }
    assert_all_answer_like_brute(&scene, SOME_SPECS);
}

RT_TEST(objects_of_denormal_size_are_hit_as_by_brute) {
    RtScene scene = begin_scene();
    for (uint32_t i = 0; i < 24; i++) {
        const float size = LEAST * (float)(1u << i);
        add_triangle(&scene, corner(i % 8, size), corner(i % 8 ^ 1, size), corner(i % 8 ^ 6, size));
        assert_ok(rt_scene_add_sphere(&scene, 0, corner(i % 8, size), size, error));
    }
    assert_all_answer_like_brute(&scene, SOME_SPECS);
}

RT_TEST(the_least_and_the_greatest_objects_in_one_scene_are_hit_as_by_brute) {
    RtScene scene = begin_scene();
    for (int power = -149; power < 58; power += 6) {
        const float size = ldexpf(1, power), next = ldexpf(1.5f, power);
        assert_ok(rt_scene_add_sphere(&scene, 0, rt_vec3(size, -next, 0), size, error));
        add_triangle(&scene, rt_vec3(size, 0, 0), rt_vec3(0, next, -0.0f), rt_vec3(0, 0, size));
    }
    assert_all_answer_like_brute(&scene, SIZE_MAX);
}

RT_TEST(triangles_of_no_size_are_never_hit_and_hide_no_other) {
    RtScene scene = begin_scene();
    for (uint32_t i = 0; i < 32; i++) {
        const RtVec3 point = rt_vec3((float)(i % 4), (float)(i / 4 % 4), (float)(i / 16));
        add_triangle(&scene, point, point, point);
        add_triangle(&scene, point, rt_vec3(4, 4, 4), rt_vec3(4, 4, 4));
    }
    add_triangle(&scene, rt_vec3(0, 0, 0), rt_vec3(4, 0, 0), rt_vec3(0, 4, 4));
    assert_all_answer_like_brute(&scene, SOME_SPECS);
}

RT_TEST(the_first_of_hundreds_of_coincident_objects_is_hit) {
    enum { COUNT = RT_SHARE(300, 50) };
    RtScene scene = begin_scene();
    for (uint32_t i = 0; i < COUNT; i++) {
        add_triangle(&scene, rt_vec3(0, 0, 0), rt_vec3(1, 0, 0.5f), rt_vec3(0, 1, 0));
        assert_ok(rt_scene_add_sphere(&scene, 0, rt_vec3(0, 0, 0), 1, error));
    }
    assert_all_answer_like_brute(&scene, 1);
}

RT_TESTS(hostile, NULL, assert_nothing_is_kept)
