/* SPDX-License-Identifier: Apache-2.0 */
/* What tests of the light buffer share: a screen under one light, and lights in awkward places. */
#ifndef RT_TESTS_LIGHT_TESTING_H
#define RT_TESTS_LIGHT_TESTING_H

#include "accel_testing.h"

#include "accel/light/light.h"
#include "core/base/random.h"

/* A screen, polygon 0, at z = 5 from -4 to 4, and a sphere of radius 1 above its middle, at z = 8; the light
 * at z = 10. */
static inline RtScene make_screen(void) {
    const RtVec3 square[4] = {{{-4, -4, 5}}, {{4, -4, 5}}, {{4, 4, 5}}, {{-4, 4, 5}}};
    RtScene scene = begin_scene();
    assert_ok(rt_scene_add_polygon(&scene, 0, square, 4, error));
    assert_ok(rt_scene_add_sphere(&scene, 0, rt_vec3(0, 0, 8), 1, error));
    assert_ok(rt_scene_add_sphere(&scene, 0, rt_vec3(0, 0, 0), 1, error)); /* in the dark */
    assert_ok(rt_scene_add_light(&scene, rt_vec3(0, 0, 10), rt_vec3(1, 1, 1), error));
    assert_ok(rt_scene_finish(&scene, error));
    return scene;
}

static inline RtVec3 random_point(RtRandom *random, float size) {
    RtVec3d d = rt_random_direction(random);
    return rt_narrow(rt_scaled(d, (double)(size * rt_random_unit(random))));
}

static inline RtVec3 moved(RtVec3 p, float by) {
    return rt_add(p, rt_vec3(by, by, by));
}

/* Some of each shape about (away, away, away), and lights inside a sphere and on it, in the plane of a
 * polygon and at its vertex, on an axis through a centre, close by and far off. */
static inline RtScene make_awkward(float away) {
    RtRandom random = rt_random(5, 0);
    RtScene scene = begin_scene();
    for (int i = 0; i < 40; i++) {
        RtVec3 a = moved(random_point(&random, 4), away), b = rt_add(a, random_point(&random, 1));
        RtVec3 triangle[3] = {a, b, rt_add(a, random_point(&random, 2))};
        assert_ok(rt_scene_add_triangle(&scene, 0, triangle, NULL, error));
        assert_ok(rt_scene_add_sphere(&scene, 0, moved(random_point(&random, 4), away), 0.3f, error));
        if (i % 4 == 0)
            assert_ok(rt_scene_add_cone(&scene, 0, a, 0.2f, rt_add(a, rt_vec3(0, 0.5f, 1)), 0.1f, error));
    }
    RtVec3 square[4] = {moved(rt_vec3(-5, -5, -4), away), moved(rt_vec3(5, -5, -4), away),
                        moved(rt_vec3(5, 5, -4), away), moved(rt_vec3(-5, 5, -4), away)};
    assert_ok(rt_scene_add_polygon(&scene, 0, square, 4, error));
    assert_ok(rt_scene_add_sphere(&scene, 0, moved(rt_vec3(0, 0, 0), away), 1, error));
    const RtVec3 places[] = {{{0.1f, 0, 0}}, {{0, 0, 1}}, {{2, 2, -4}},      {{-5, -5, -4}},
                             {{0, 0, 6}},    {{3, 3, 3}}, {{1e5f, 3, 2e4f}}, {{-9, 9, 9}}};
    for (size_t i = 0; i < sizeof places / sizeof places[0]; i++)
        assert_ok(rt_scene_add_light(&scene, moved(places[i], away), rt_vec3(1, 1, 1), error));
    assert_ok(rt_scene_finish(&scene, error));
    return scene;
}

#endif
