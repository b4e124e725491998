/* SPDX-License-Identifier: Apache-2.0 */
/* Shared by tests of the YAML scene format: a folder with meshes, a scene with every element, and loading
 * from a text. */
#ifndef RT_TESTS_YAML_TESTING_H
#define RT_TESTS_YAML_TESTING_H

#include "scene_testing.h"

#include "core/scene/load.h"
#include "scenes/builtin.h"

#include <sys/stat.h>

/* Loads and finishes; on failure the scene is empty. */
static inline RtStatus load(const char *path, RtScene *scene, RtError *error) {
    rt_scene_init(scene);
    RtStatus status = rt_yaml_load(path, rt_builtin_open, scene, error);
    if (status == RT_OK) status = rt_scene_finish(scene, error);
    if (status != RT_OK) rt_scene_clear(scene);
    return status;
}

static inline RtStatus load_text(const char *text, RtScene *scene, RtError *error) {
    write_text(RT_TEST_FOLDER "/scene.yaml", text);
    return load(RT_TEST_FOLDER "/scene.yaml", scene, error);
}

static inline RtScene yaml_scene(const char *text) {
    RtScene scene;
    assert_ok(load_text(text, &scene, error));
    return scene;
}

static inline int make_folder(void **state) {
    (void)state;
    mkdir(RT_TEST_FOLDER, 0777);
    const char corner[] = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    write_text(RT_TEST_FOLDER "/corner.obj", corner);
    write_text(RT_TEST_FOLDER "/open.obj", /* a pyramid without its base */
               "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nf 1 2 5\nf 2 3 5\nf 3 4 5\nf 4 1 5\n");
    write_text(RT_TEST_FOLDER "/bunny.obj", corner); /* what the documentation calls so */
    write_png(RT_TEST_FOLDER "/wood.png", 2, 1, "\x80\x40\x20\xff\xff\xff");
    return 0;
}

/* One of everything. */
static const char everything[] =
    "camera: {from: [0, -10, 4], at: [0, 0, 1], up: [0, 0, 1], fov: 30, near: 0.5, size: [320, 200]}\n"
    "background: [0.1, 0.2, 0.3]\n"
    "ambient: [0.5, 0.5, 0.5]\n"
    "lights:\n"
    "  - {position: [5, -5, 10]}\n"
    "  - {position: [-5, -5, 10], intensity: [0.5, 0.4, 0.3]}\n"
    "materials:\n"
    "  - {name: red, color: [1, 0, 0], specular: 0.5, shine: 20, texture: {image: wood.png, size: 2}}\n"
    "  - name: \"gl\\u00e4s \\\"x\\\"\"\n"
    "    transmission: 0.9\n"
    "    ior: 1.5\n"
    "    texture: {checker: 0.3, color: [0.1, 0.2, 0.3], origin: [0.1, 2, 3]}\n"
    "objects:\n"
    "  - sphere: {center: [0, 0, 1], radius: 1e-40, material: red}\n"
    "  - sphere: {center: [0.1, -0.0, 3.3333333], radius: .1}\n"
    "  - polygon: {vertices: [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], material: red}\n"
    "  - triangle: {vertices: [[0, 0, 0], [1, 0, 0], [1, 1, 0]]}\n"
    "  - triangle:\n"
    "      vertices: [[0, 0, 0], [1, 0, 0], [1, 1, 0]]\n"
    "      normals: [[1, 1, 1], [0.3, 0.2, 0.9], [7, 1, 1]]\n"
    "      uv: [[0, 0.1], [-1, 1e20], [0.3, 0.7]]\n"
    "      material: \"gl\\u00e4s \\\"x\\\"\"\n"
    "  - cone: {base: [0, 0, 0], base_radius: 1, apex: [0, 0, 2], apex_radius: 0, material: red}\n"
    "  - cylinder: {base: [0, 0, 0], apex: [0, 0, 2], radius: 0.3}\n"
    "  - mesh: {path: corner.obj, transform: [{scale: 2}, {stretch: [1, 2, 3]}, {translate: [0, 0, 5]}]}\n"
    "  - builtin: {name: \"balls:size=1\", transform: [{rotate: {axis: [0, 0, 1], degrees: 90}}]}\n";

#endif
