/* SPDX-License-Identifier: Apache-2.0 */
/* Shared by tests of shading and frames: small scenes with a camera, frames by brute, surfaces that rays
 * hit. */
#ifndef RT_TESTS_RENDER_TESTING_H
#define RT_TESTS_RENDER_TESTING_H

#include "testing.h"

#include "render/frame.h"
#include "render/illumination.h"

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
    RtAccel *accel;
    assert_ok(rt_accel_open("brute", scene, &accel, error));
    assert_ok(rt_frame_trace(&frame, accel, options, error));
    rt_accel_destroy(accel);
    return frame;
}

/* The surface that a ray towards the only object of `scene` meets. */
static inline RtSurface surface_of(const RtScene *scene, RtVec3 org, RtVec3 dir, float t) {
    RtRay ray = {.org = org, .dir = dir, .tmax = INFINITY};
    return rt_surface(scene, &ray, (RtHit){t, 0}, NULL);
}

#endif
