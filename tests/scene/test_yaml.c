/* SPDX-License-Identifier: Apache-2.0 */
/* The YAML scene format: reading, including the examples in the documentation and the scenes of the
 * repository. */
#include "yaml_testing.h"

/* ---- what a file says ---- */

RT_TEST(a_scene_is_what_its_file_says) {
    OWNED_SCENE s = yaml_scene(everything);
    const RtGeometry *g = &s.geometry;
    assert_true(s.camera.from.y == -10 && s.camera.fov == 30 && s.camera.near == 0.5f);
    assert_int_equal(s.camera.width, 320);
    assert_true(s.background.z == 0.3f && s.ambient.x == 0.5f);
    assert_int_equal(s.light_count, 2);
    assert_true(s.lights[0].intensity.x == 1 && s.lights[1].intensity.y == 0.4f);
    assert_true(s.materials[0].specular == 0.5f && s.materials[0].diffuse == rt_default_material().diffuse);
    assert_string_equal(s.materials[1].name, "gl\xc3\xa4s \"x\"");
    assert_string_equal(s.materials[s.material_of[1]].name, "default");
    assert_true(g->spheres[1].center.z == 3.3333333f && signbit(g->spheres[1].center.y));
    assert_int_equal(g->polygons[0].count, 4);
    assert_int_equal(g->triangle_normals[0], RT_NO_NORMALS);
    assert_int_equal(g->triangle_normals[1], 0);
    assert_int_equal(g->cone_count, 2);
    assert_true(g->cones[1].base_radius == g->cones[1].apex_radius);
    assert_true(g->triangles[2].v[2].y == 4 && g->triangles[2].v[2].z == 5);
}

RT_TEST(what_is_left_out_has_defaults) {
    OWNED_SCENE s = yaml_scene("objects:\n  - sphere: {center: [1, 2, 3], radius: 1}\n");
    assert_int_equal(s.light_count, 1);
    assert_int_equal(s.material_count, 1);
    assert_true(s.camera.at.x == 1 && s.camera.at.z == 3 && s.camera.fov == 45);
}

RT_TEST(a_material_called_default_is_the_default) {
    OWNED_SCENE s = yaml_scene("materials: [{name: default, color: [0, 1, 0]}]\n"
                               "objects: [sphere: {center: [1, 2, 3], radius: 1}]\n");
    assert_int_equal(s.material_count, 1);
    assert_true(s.materials[0].color.y == 1);
}

RT_TEST(a_built_in_moved_and_moved_back_is_itself) {
    OWNED_SCENE plain, s;
    assert_ok(rt_builtin_open("tree:size=2", &plain, error));
    assert_ok(load_text("objects:\n"
                        "  - builtin:\n"
                        "      name: tree:size=2\n"
                        "      transform:\n"
                        "        - rotate: {axis: [0, 0, 1], degrees: 90}\n"
                        "        - {scale: 4}\n"
                        "        - {scale: 0.25}\n"
                        "        - rotate: {axis: [0, 0, -2], degrees: 90}\n",
                        &s, error));
    const RtGeometry *a = &plain.geometry, *b = &s.geometry;
    assert_int_equal(a->object_count, b->object_count);
    assert_memory_equal(a->objects, b->objects, a->object_count * sizeof *a->objects);
    assert_true(a->sphere_count > 0 && a->cone_count > 0);
    assert_memory_equal(a->spheres, b->spheres, a->sphere_count * sizeof *a->spheres);
    assert_memory_equal(a->cones, b->cones, a->cone_count * sizeof *a->cones);
}

/* ---- the documentation, and scenes that come along ---- */

RT_TEST(every_example_of_the_documentation_loads) {
    FILE *in = fopen("docs/scenes.md", "r");
    assert_non_null(in);
    char line[1024], text[8192] = "";
    bool inside = false;
    int count = 0;
    while (fgets(line, sizeof line, in)) {
        if (!inside && strcmp(line, "```yaml\n") == 0) {
            inside = true;
            text[0] = '\0';
        } else if (inside && strcmp(line, "```\n") == 0) {
            inside = false;
            count++;
            OWNED_SCENE scene;
            RtError error;
            if (load_text(text, &scene, &error) != RT_OK) fail_msg("%s\n%s", error.message, text);
        } else if (inside) {
            assert_true(strlen(text) + strlen(line) < sizeof text);
            strcat(text, line);
        }
    }
    fclose(in);
    assert_true(count >= 5);
}

RT_TEST(every_scene_that_comes_along_loads) {
    glob_t found;
    assert_int_equal(glob("scenes/*.yaml", 0, NULL, &found), 0);
    for (size_t i = 0; i < found.gl_pathc; i++) {
        OWNED_SCENE scene;
        assert_ok(load(found.gl_pathv[i], &scene, error));
    }
    assert_true(found.gl_pathc >= 3);
    globfree(&found);
}

RT_TESTS(yaml, make_folder, NULL)
