/* SPDX-License-Identifier: Apache-2.0 */
/* The YAML scene format: saving and loading restores every bit. */
#include "yaml_testing.h"

#include "core/base/file.h"

static RtScene saved_and_loaded(const RtScene *scene) {
    static const char *const path = RT_TEST_FOLDER "/again.yaml";
    RtScene again;
    assert_ok(rt_scene_save(scene, path, error));
    assert_ok(load(path, &again, error));
    return again;
}

static void assert_survives(const RtScene *scene) {
    OWNED_SCENE again = saved_and_loaded(scene);
    assert_true(rt_scene_fingerprint(&again) == rt_scene_fingerprint(scene));
}

/* What a large built-in has in a file of a hundred megabytes it has in a small one, too. */
static const char *spec_of(const char *name) {
    if (strcmp(name, "forest") == 0) return "forest:n=20";
    if (strcmp(name, "thicket") == 0) return "thicket:n=4";
    return strcmp(name, "hall") == 0 ? "hall:size=1" : name;
}

RT_TEST(a_scene_saved_and_loaded_keeps_every_bit) {
    OWNED_SCENE all = yaml_scene(everything);
    assert_survives(&all);
    for (size_t i = 0; rt_builtin_at(i); i++) {
        OWNED_SCENE scene = open_scene(spec_of(rt_builtin_at(i)->name));
        assert_survives(&scene);
    }
}

RT_TEST(a_saved_scene_names_its_format_first) {
    OWNED_SCENE scene = yaml_scene(everything);
    RtMemoryFile file;
    assert_ok(rt_memory_file_open(&file, error));
    assert_ok(rt_yaml_save(&scene, file.file, error));
    assert_ok(rt_memory_file_close(&file, "a scene", error));
    assert_memory_equal(file.data, "format: 1\n", 10);
    rt_free(file.data);
}

RT_TEST(solids_survive_saving) {
    static const char *const texts[] = {
        /* half-spaces become polyhedra of one plane, slabs of two */
        "solids:\n"
        "  - {name: ball, sphere: {center: [1, 2, 3], radius: 1.1}}\n"
        "  - {name: below, half_space: {point: [1, 2, 3], normal: [1, 2, 3]}}\n"
        "  - {name: slab, polyhedron: {planes: [[0.3, 1, 0, 2.5], [-0.3, -1, 0, -1.7]]}}\n"
        "objects:\n"
        "  - csg: {formula: ball & below}\n"
        "  - csg: {formula: ball & slab, transform: [{scale: 0.3}]}\n",
        /* facets */
        "solids:\n"
        "  - {name: ball, sphere: {center: [0, 0, 0], radius: 0.9}}\n"
        "  - name: corner\n"
        "    facets:\n"
        "      triangles:\n"
        "        - [0.1, 0, 0, 0, 1.1, 0, 1.3, 0, 0]\n"
        "        - [0.1, 0, 0, 1.3, 0, 0, 0, 0, 0.7]\n"
        "        - [0.1, 0, 0, 0, 0, 0.7, 0, 1.1, 0]\n"
        "        - [1.3, 0, 0, 0, 1.1, 0, 0, 0, 0.7]\n"
        "objects:\n"
        "  - csg: {formula: ball & corner}\n"
        "  - csg: {formula: ball - corner, transform: [{scale: 0.3}]}\n",
        /* moving the caps rounds otherwise than moving the cone and computing them again */
        "solids:\n"
        "  - {name: a, cone: {base: [1, 0, 0.1], base_radius: 0.26, apex: [0, 0, 0.34], apex_radius: 0.18}}\n"
        "  - {name: b, cone: {base: [1, 2, 3], base_radius: 1, apex: [0, 0, 0.34], apex_radius: 0}}\n"
        "objects:\n"
        "  - csg: {formula: a | b, transform: [{translate: [3.5, 0.5, 0]}]}\n"
        "  - csg: {formula: a - b, transform: [{rotate: {axis: [1, 2, 3], degrees: 20}}]}\n"
        "  - csg: {formula: a, transform: [{translate: [-2.5, 1.5, 1e6]}]}\n"};
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++) {
        OWNED_SCENE scene = yaml_scene(texts[i]);
        assert_survives(&scene);
    }
}

RT_TEST(vertex_normals_survive_saving_bit_for_bit) {
    OWNED_SCENE scene = begin_scene();
    for (int i = 1; i < 500; i++) {
        float a = (float)i, b = a * a;
        RtVec3 v[3] = {{0, 0, 0}, {a, 0, 1}, {0, b, 2}};
        RtVec3 n[3] = {{a, b, 1}, {1, -a, b / 7}, {b, a / 3, -a}};
        assert_ok(rt_scene_add_triangle(&scene, 0, v, n, error));
    }
    assert_ok(rt_scene_finish(&scene, error));
    assert_survives(&scene);
}

static RtScene scene_of_names(const char *const *names, uint32_t count) {
    RtScene scene;
    rt_scene_init(&scene);
    for (uint32_t i = 0; i < count; i++) {
        RtMaterial material = rt_default_material();
        uint32_t index;
        snprintf(material.name, sizeof material.name, "%s", names[i]);
        material.ambient = (float)i;
        assert_ok(rt_scene_add_material(&scene, &material, &index, error));
        assert_ok(rt_scene_add_sphere(&scene, index, rt_vec3((float)i, 0, 0), 1, error));
    }
    assert_ok(rt_scene_finish(&scene, error));
    return scene;
}

RT_TEST(names_of_any_printable_text_survive_saving) {
    static const char *const names[] = {"it's", "''", "a: b # c",    "- [x]", "\"",
                                        "\\n",  " ",  "gl\xc3\xa4s", "*a"};
    enum { COUNT = sizeof names / sizeof names[0] };
    OWNED_SCENE scene = scene_of_names(names, COUNT), again = saved_and_loaded(&scene);
    for (uint32_t i = 0; i < COUNT; i++) assert_string_equal(again.materials[i].name, names[i]);
}

RT_TEST(names_that_cannot_be_written_are_replaced_by_numbers) {
    static const char *const pairs[][2] = {
        {"a", "a"}, {"a", ""}, {"a", "b\n"}, {"a", "\xff"}, {"a", "b\xc2\x85\x20"}};
    for (size_t i = 0; i < sizeof pairs / sizeof pairs[0]; i++) {
        OWNED_SCENE scene = scene_of_names(pairs[i], 2);
        assert_survives(&scene);
    }
}

RT_TEST(whichever_allocation_fails_saving_is_out_of_memory) {
    OWNED_SCENE scene = yaml_scene(everything);
    FILE *out = fopen("/dev/null", "wb");
    assert_non_null(out);
    assert_fails_cleanly(rt_yaml_save(&scene, out, error), fclose(out));
}

RT_TEST(a_full_disk_is_reported) {
    FILE *out = fopen("/dev/full", "wb");
    if (!out) RT_SKIP("/dev/full");
    setvbuf(out, NULL, _IONBF, 0);
    OWNED_SCENE scene = yaml_scene(everything);
    assert_fails_with(rt_yaml_save(&scene, out, error), RT_IO, "");
    fclose(out);
}

RT_TESTS(yaml_save, make_folder, NULL)
