/* SPDX-License-Identifier: Apache-2.0 */
/* Shared by tests of shading and frames: small scenes with a camera, frames by brute, surfaces that rays
 * hit. */
#ifndef RT_TESTS_RENDER_TESTING_H
#define RT_TESTS_RENDER_TESTING_H

#include "accel_testing.h"

#include "render/frame.h"

#define assert_near(a, b, within) assert_true(fabs((double)(a) - (double)(b)) <= (within))

/* A scene with one material of index 0, a black background, and a camera on the z axis looking down. */
static inline RtScene start_scene(RtMaterial material) {
    RtScene scene;
    uint32_t index;
    rt_scene_init(&scene);
    assert_ok(rt_scene_add_material(&scene, &material, &index, error));
    scene.background = rt_vec3(0, 0, 0);
    scene.camera =
        (RtCamera){.from = {0, 0, 10}, .at = {0, 0, 0}, .up = {0, 1, 0}, .fov = 40, .width = 1, .height = 1};
    return scene;
}

static inline void add_square(RtScene *scene, float half, float z) {
    RtVec3 corners[4] = {{-half, -half, z}, {half, -half, z}, {half, half, z}, {-half, half, z}};
    assert_ok(rt_scene_add_polygon(scene, 0, corners, 4, error));
}

static inline RtFrameOptions options_for(RtScene *scene, uint32_t width, uint32_t height, bool corners) {
    assert_ok(rt_scene_sample(scene, width, height, 1, corners, error));
    return (RtFrameOptions){.depth = 5, .threads = 1};
}

static inline RtFrame trace(const RtScene *scene, const RtFrameOptions *options) {
    RtFrame frame;
    OWNED_ACCEL RtAccel *accel = open_accel(scene, "brute");
    assert_ok(rt_frame_trace(&frame, accel, options, error));
    return frame;
}

/* Mirrors, glass and matte, of every shape, over a floor, under two lights. */
static inline RtScene busy_scene(void) {
    RtScene scene = start_scene(rt_default_material());
    RtMaterial others[2] = {
        {.color = {1, 0.5f, 0.2f},
         .diffuse = 0.5f,
         .specular = 0.5f,
         .shine = 9,
         .reflection = 0.5f,
         .ior = 1},
        {.color = {1, 1, 1}, .diffuse = 0.1f, .reflection = 0.1f, .transmission = 0.9f, .ior = 1.5f}};
    uint32_t mirror, clear;
    assert_ok(rt_scene_add_material(&scene, &others[0], &mirror, error));
    assert_ok(rt_scene_add_material(&scene, &others[1], &clear, error));
    add_square(&scene, 6, -1);
    for (int i = 0; i < 5; i++) {
        float x = (float)i - 2;
        assert_ok(rt_scene_add_sphere(&scene, mirror, rt_vec3(x, x * x / 4, 0), 0.45f, error));
        assert_ok(rt_scene_add_sphere(&scene, clear, rt_vec3(x, -1 + x * x / 4, 1), 0.4f, error));
    }
    for (int i = 0; i < 3; i++) { /* panes over the left half: rays multiply */
        float z = 2 + (float)i;
        RtVec3 pane[4] = {{-6, -6, z}, {0, -6, z}, {0, 6, z}, {-6, 6, z}};
        assert_ok(rt_scene_add_polygon(&scene, clear, pane, 4, error));
    }
    RtVec3 corners[3] = {{-2, 2, 0}, {2, 2, 0}, {0, 2.5f, 2}},
           normals[3] = {{0, -1, 1}, {0, -1, 1}, {0, -1, 0}};
    assert_ok(rt_scene_add_triangle(&scene, mirror, corners, normals, error));
    assert_ok(rt_scene_add_cone(&scene, 0, rt_vec3(-2, -2, -1), 0.5f, rt_vec3(-2, -2, 1), 0.2f, error));
    assert_ok(rt_scene_add_light(&scene, rt_vec3(3, 4, 8), rt_vec3(0.6f, 0.6f, 0.6f), error));
    assert_ok(rt_scene_add_light(&scene, rt_vec3(-5, 0, 4), rt_vec3(0.5f, 0.4f, 0.4f), error));
    assert_ok(rt_scene_finish(&scene, error));
    return scene;
}

/* The surface that a ray towards the only object of `scene` meets. */
static inline RtSurface surface_of(const RtScene *scene, RtVec3 org, RtVec3 dir, float t) {
    RtRay ray = {.org = org, .dir = dir, .tmax = INFINITY};
    return rt_surface(scene, &ray, (RtHit){t, 0}, NULL);
}

#endif
