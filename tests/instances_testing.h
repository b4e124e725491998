/* SPDX-License-Identifier: Apache-2.0 */
/* Shared by tests of instances: matrices, and scenes of balls in parts. */
#ifndef RT_TESTS_INSTANCES_TESTING_H
#define RT_TESTS_INSTANCES_TESTING_H

#include "accel_testing.h"

static inline RtTransform scaled(double x, double y, double z) {
    return (RtTransform){{{x, 0, 0, 0}, {0, y, 0, 0}, {0, 0, z, 0}}};
}

static inline RtTransform moved(double x, double y, double z) {
    return (RtTransform){{{1, 0, 0, x}, {0, 1, 0, y}, {0, 0, 1, z}}};
}

static inline RtTransform sheared(double by) {
    return (RtTransform){{{1, by, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
}

static inline void add_ball(RtScene *scene, float x, float y, float z, float radius) {
    assert_ok(rt_scene_add_sphere(scene, 0, rt_vec3(x, y, z), radius, error));
}

/* The part is empty afterwards; its number. */
static inline uint32_t add_part(RtScene *scene, RtScene *part) {
    assert_ok(rt_scene_add_part(scene, part, error));
    assert_int_equal(part->geometry.object_count, 0);
    return scene->part_count - 1;
}

static inline void place(RtScene *to, const RtScene *of, uint32_t part, RtTransform at) {
    assert_ok(rt_scene_add_instance(to, of, part, &at, RT_OWN_MATERIALS, error));
}

/* A scene with one part, a unit ball about the origin; not finished. */
static inline RtScene begin_balls(void) {
    RtScene scene = begin_scene(), part = begin_scene();
    add_ball(&part, 0, 0, 0, 1);
    add_part(&scene, &part);
    return scene;
}

/* That scene with one instance. */
static inline RtScene one_ball(RtTransform at) {
    RtScene scene = begin_balls();
    place(&scene, &scene, 0, at);
    assert_ok(rt_scene_finish(&scene, error));
    return scene;
}

/* A part of a ball, a triangle and two of the part below; `levels` of them, and two instances of the last. */
static inline RtScene nested(uint32_t levels) {
    RtScene scene = begin_balls();
    for (uint32_t level = 1; level <= levels; level++) {
        RtScene part = begin_scene(), *to = level < levels ? &part : &scene;
        const RtVec3 v[3] = {{{0, 0, 1}}, {{1, 0, 1}}, {{0, 1, 1}}};
        add_ball(to, 0, 0, -1, 0.5f);
        assert_ok(rt_scene_add_triangle(to, 0, v, NULL, error));
        RtTransform at = rt_transform_identity();
        assert_ok(rt_transform_rotate(&at, rt_vec3(1, 2, 3), 20, error));
        assert_ok(rt_transform_translate(&at, rt_vec3(0.4f, 0.1f, 0), error));
        place(to, &scene, level - 1, at);
        place(to, &scene, level - 1, scaled(0.5, 0.9, 1.1));
        if (level < levels)
            add_part(&scene, &part);
        else
            rt_scene_clear(&part);
    }
    assert_ok(rt_scene_finish(&scene, error));
    return scene;
}

#endif
