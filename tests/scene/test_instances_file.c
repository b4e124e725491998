/* SPDX-License-Identifier: Apache-2.0 */
/* Parts and instances in scene files: what is read, refused, written, and copied. */
#include "yaml_testing.h"

#include "core/base/file.h"

#define BALL  "- {name: ball, objects: [sphere: {center: [0, 0, 0], radius: 1}]}\n"
#define PARTS "parts:\n" BALL

/* ---- refusals ---- */

static const struct {
    const char *text, *place, *says;
} refused[] = {
    {PARTS "instances:\n- {part: bal}\n", "4:10:", "there is no part 'bal': did you mean 'ball'?"},
    {PARTS "instances:\n- {part: x}\n", "4:10:", "there is no part 'x': add it to the list of parts"},
    {"parts:\n- {name: a, instances: [{part: a}]}\n", "2:32:", "'a' is not complete here"},
    {"parts:\n- {name: a, instances: [{part: ball}]}\n" BALL, "2:32:", "a part contains earlier parts only"},
    {PARTS BALL "instances: [{part: ball}]\n", "3:10:", "two parts 'ball'"},
    {"parts:\n- {name: a}\ninstances: [{part: a}]\n", "2:3:", "'objects' is missing: a scene and a part"},
    {"parts:\n- {name: a, objects: [], instances: []}\ninstances: [{part: a}]\n", "2:26:", "at least 1"},
    {PARTS "background: [0, 0, 0]\n", "1:1:", "'objects' is missing: a scene and a part"},
    {PARTS "instances: {part: ball}\n", "3:1:", "expected a list of instances, found a mapping"},
    {PARTS "instances:\n- {part: ball, transform: [], place: [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0]}\n",
     "4:31:", "give one"},
    {PARTS "instances:\n- {part: ball, place: [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]}\n",
     "4:16:", "the length of the list is 11"},
    {PARTS "instances:\n- {part: ball, place: [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0]}\n",
     "4:16:", "factors from inf to 1"},
    {PARTS "instances:\n- {part: ball, transform: [{stretch: [1e7, 1, 1]}]}\n", "4:16:", "from 1 to 1e+07"},
    {PARTS "instances:\n- {part: ball, scale: 2}\n", "4:16:", "unknown key 'scale'"},
    {PARTS "instances:\n- {part: ball, material: red}\n", "4:26:", "no material 'red'"},
};

RT_TEST(bad_parts_and_instances_are_refused_with_their_place) {
    for (size_t i = 0; i < sizeof refused / sizeof refused[0]; i++) {
        RtScene scene;
        char place[512];
        snprintf(place, sizeof place, "%s/scene.yaml:%s", RT_TEST_FOLDER, refused[i].place);
        assert_bad_input_at(load_text(refused[i].text, &scene, error), place, refused[i].says);
    }
}

RT_TEST(instances_nest_sixteen_deep_and_no_deeper) {
    for (int levels = RT_MAX_NESTING; levels <= RT_MAX_NESTING + 1; levels++) {
        char text[4096] = "parts:\n- {name: p0, objects: [sphere: {center: [0, 0, 0], radius: 1}]}\n";
        for (int i = 1; i < levels; i++)
            snprintf(text + strlen(text), 64, "- {name: p%d, instances: [{part: p%d}]}\n", i, i - 1);
        snprintf(text + strlen(text), 64, "instances: [{part: p%d}]\n", levels - 1);
        OWNED_SCENE scene = {0};
        if (levels == RT_MAX_NESTING)
            assert_ok(load_text(text, &scene, error));
        else
            assert_bad_input(load_text(text, &scene, error), "nested in more than 16 levels");
    }
}

/* ---- saving ---- */

/* Parts in a part, twice; trees and a mesh with an image in parts; every way to place an instance. */
static const char instanced[] =
    "materials:\n"
    "- {name: red, color: [0.9, 0.2, 0.1]}\n"
    "- {name: board, texture: {checker: 0.25, origin: [0.1, 0.2, 0.3]}}\n"
    "solids:\n"
    "- {name: block, box: {lo: [-0.3, -0.3, -0.3], hi: [0.3, 0.3, 0.3]}}\n"
    "- {name: ball, sphere: {center: [0, 0, 0], radius: 0.38, material: red}}\n"
    "parts:\n"
    "- name: it's a tree\n"
    "  objects:\n"
    "  - csg: {formula: block - ball}\n"
    "  - csg: {formula: ball, transform: [{translate: [0, 0, 1]}]}\n"
    "  - mesh: {path: painted.obj, transform: [{scale: 2}]}\n"
    "- name: pair\n"
    "  objects: [polygon: {vertices: [[-1, -1, 0], [1, -1, 0], [0, 1, 0]], material: board}]\n"
    "  instances:\n"
    "  - {part: it's a tree}\n"
    "  - {part: it's a tree, transform: [{rotate: {axis: [1, 2, 3], degrees: 40}}, {translate: [2, 0, 0]}], "
    "material: board}\n"
    "objects:\n"
    "- csg: {formula: block & ball}\n"
    "instances:\n"
    "- {part: pair, transform: [{stretch: [1, 2, 0.1]}, {translate: [0, 0, 0.1]}]}\n"
    "- {part: it's a tree, place: [0, -1, 0, 0.1, 1, 0, 0, 1e-17, 0, 0, 3, 12345.678901234567]}\n"
    "- {part: pair, material: red}\n";

static void write_painted_mesh(void) {
    write_text(RT_TEST_FOLDER "/painted.mtl", "newmtl wood\nmap_Kd wood.png\n");
    write_text(RT_TEST_FOLDER "/painted.obj",
               "mtllib painted.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nusemtl wood\n"
               "f 1/1 2/2 3/3\n");
}

RT_TEST(every_prefix_of_a_scene_of_instances_is_read_or_refused) {
    write_painted_mesh();
    for (size_t length = 0; length < sizeof instanced; length += RT_SHARE(1, 7))
        assert_read_or_refused(RT_TEST_FOLDER "/scene.yaml", instanced, length);
}

/* The caller frees it. */
static char *saved(const RtScene *scene) {
    RtMemoryFile file;
    assert_ok(rt_memory_file_open(&file, error));
    assert_ok(rt_yaml_save(scene, file.file, error));
    assert_ok(rt_memory_file_close(&file, "a scene", error));
    return file.data;
}

RT_TEST(parts_and_instances_survive_saving_bit_for_bit) {
    write_painted_mesh();
    OWNED_SCENE scene = yaml_scene(instanced);
    OWNED_MEMORY char *text = saved(&scene);
    OWNED_SCENE again = yaml_scene(text);
    OWNED_MEMORY char *text_again = saved(&again);
    assert_true(rt_scene_fingerprint(&again) == rt_scene_fingerprint(&scene));
    assert_string_equal(text, text_again);
    assert_int_equal(again.part_count, 2);
    assert_string_equal(again.parts[0]->name, "it's a tree");
    assert_int_equal(again.geometry.instance_count, 3);
    assert_memory_equal(again.geometry.instances[1].to_world.m, scene.geometry.instances[1].to_world.m,
                        sizeof(RtTransform));
}

RT_TEST(parts_without_a_name_are_numbered) {
    for (int long_name = 0; long_name < 2; long_name++) {
        OWNED_SCENE scene = begin_scene();
        for (int i = 0; i < 2; i++) {
            RtScene part = begin_scene();
            if (long_name) memset(part.name, 'a' + i, RT_MAX_NAME);
            assert_ok(rt_scene_add_sphere(&part, 0, rt_vec3(0, 0, 0), 1, error));
            assert_ok(rt_scene_add_part(&scene, &part, error));
        }
        const RtTransform still = rt_transform_identity();
        assert_ok(rt_scene_add_instance(&scene, &scene, 1, &still, RT_OWN_MATERIALS, error));
        assert_ok(rt_scene_finish(&scene, error));
        OWNED_MEMORY char *text = saved(&scene);
        OWNED_SCENE again = yaml_scene(text);
        assert_string_equal(again.parts[1]->name, "p1");
        assert_true(rt_scene_fingerprint(&again) == rt_scene_fingerprint(&scene));
    }
}

RT_TEST(parts_share_the_materials_of_the_scene) {
    write_painted_mesh();
    OWNED_SCENE scene =
        yaml_scene(PARTS "- {name: two, objects: [mesh: {path: painted.obj}], instances: [{part: ball}]}\n"
                         "- {name: three, objects: [mesh: {path: painted.obj}]}\n"
                         "objects: [sphere: {center: [0, 0, 0], radius: 1}]\n"
                         "instances: [{part: two}, {part: three}]\n");
    assert_int_equal(scene.material_count, 2);
    assert_string_equal(scene.materials[0].name, "default");
    assert_string_equal(scene.materials[1].name, "wood");
    assert_int_equal(scene.parts[2]->material_of[0], 1);
    assert_int_equal(scene.material_of[0], 0);
}

/* ---- copies ---- */

RT_TEST(a_flattened_scene_is_that_of_copies_made_by_hand) {
    OWNED_SCENE scene =
                    yaml_scene("materials: [{name: red}, {name: blue, color: [0, 0, 1]}]\n"
                               "parts:\n"
                               "- name: a\n"
                               "  objects:\n"
                               "  - sphere: {center: [1, 0, 0], radius: 0.5, material: red}\n"
                               "  - triangle: {vertices: [[0, 0, 0], [1, 0, 0], [0, 1, 0]], material: blue}\n"
                               "- name: b\n"
                               "  objects: [sphere: {center: [0, 0, 3], radius: 1, material: red}]\n"
                               "  instances:\n"
                               "  - {part: a, transform: [{rotate: {axis: [0, 0, 1], degrees: 90}}]}\n"
                               "instances:\n"
                               "- {part: b, transform: [{scale: 2}, {translate: [0, 0, 1]}]}\n"
                               "- {part: a, place: [1, 0, 0, 5, 0, 1, 0, 6, 0, 0, 1, 7], material: blue}\n"),
                by_hand =
                    yaml_scene("materials: [{name: red}, {name: blue, color: [0, 0, 1]}, {name: default}]\n"
                               "objects:\n"
                               "- sphere: {center: [0, 0, 7], radius: 2, material: red}\n"
                               "- sphere: {center: [0, 2, 1], radius: 1, material: red}\n"
                               "- triangle: {vertices: [[0, 0, 1], [0, 2, 1], [-2, 0, 1]], material: blue}\n"
                               "- sphere: {center: [6, 6, 7], radius: 0.5, material: blue}\n"
                               "- triangle: {vertices: [[5, 6, 7], [6, 6, 7], [5, 7, 7]], material: blue}\n");
    RtScene flat;
    assert_ok(rt_scene_flatten(&scene, &flat, error));
    assert_memory_equal(flat.geometry.spheres, by_hand.geometry.spheres, 3 * sizeof(RtSphere));
    assert_memory_equal(flat.material_of, by_hand.material_of, 5 * sizeof(uint32_t));
    flat.camera = by_hand.camera; /* placed by boxes of parts and of objects */
    flat.lights[0] = by_hand.lights[0];
    assert_true(rt_scene_fingerprint(&flat) == rt_scene_fingerprint(&by_hand));
    rt_scene_clear(&flat);
}

#define MIRRORED(objects)                                                                                    \
    "parts: [{name: a, objects: [" objects "]}]\n"                                                           \
    "instances: [{part: a, place: [-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0]}]\n"

RT_TEST(mirrored_copies_keep_the_outside_out) {
    OWNED_SCENE scene = yaml_scene(
                    MIRRORED("{triangle: {vertices: [[0, 0, 0], [1, 0, 0], [0, 1, 0]]}}, "
                             "{polygon: {vertices: [[0, 0, 1], [1, 0, 1], [2, 1, 1], [0, 1, 1]]}}")),
                by_hand =
                    yaml_scene("objects:\n"
                               "- triangle: {vertices: [[0, 1, 0], [-1, 0, 0], [0, 0, 0]]}\n"
                               "- polygon: {vertices: [[0, 1, 1], [-2, 1, 1], [-1, 0, 1], [0, 0, 1]]}\n"),
                of_solids =
                    yaml_scene("solids: [{name: s, sphere: {center: [0, 0, 0], radius: 1}}]\n" MIRRORED(
                        "csg: {formula: s}"));
    RtScene flat;
    const RtRay ray = {.org = {{-0.25f, 0.25f, 9}}, .dir = {{0, 0, -1}}, .tmax = INFINITY};
    assert_ok(rt_scene_flatten(&scene, &flat, error));
    flat.camera = by_hand.camera;
    flat.lights[0] = by_hand.lights[0];
    assert_true(rt_scene_fingerprint(&flat) == rt_scene_fingerprint(&by_hand));
    for (uint32_t id = 0; id < 2; id++) {
        RtPlace at;
        rt_scene_place(&scene, id, &ray, &at);
        const RtVec3d n = rt_object_normals(&at.scene->geometry, at.object, &at.ray, 9, NULL).geometric,
                      outside = rt_transform_normald(&at.to_world, n);
        assert_true(outside.z > 0 && rt_object_normals(&flat.geometry, id, &ray, 9, NULL).geometric.z > 0);
    }
    rt_scene_clear(&flat);
    assert_bad_input(rt_scene_flatten(&of_solids, &flat, error), "no mirrored copies");
}

/* The material of the object, as rays that hit it see it. */
static const RtMaterial *material_at(const RtScene *scene, uint32_t id) {
    const RtRay ray = {.dir = {{0, 0, 1}}, .tmax = INFINITY};
    RtPlace place;
    rt_scene_place(scene, id, &ray, &place);
    return place.material ? place.material : &scene->materials[place.scene->material_of[place.object]];
}

RT_TEST(a_painted_instance_hides_the_materials_within) {
    OWNED_SCENE scene = yaml_scene(
        "materials: [{name: red}, {name: green}, {name: blue}]\n"
        "solids: [{name: s, sphere: {center: [0, 0, 0], radius: 1, material: red}}]\n"
        "parts:\n"
        "- {name: a, objects: [sphere: {center: [0, 0, 0], radius: 1, material: red}, csg: {formula: s}]}\n"
        "- {name: b, instances: [{part: a}, {part: a, material: green}]}\n"
        "instances: [{part: b}, {part: b, material: blue}]\n");
    static const char *const names[] = {"red", "red", "green", "green", "blue", "blue", "blue", "blue"};
    RtScene flat;
    assert_ok(rt_scene_flatten(&scene, &flat, error));
    assert_int_equal(rt_geometry_id_count(&scene.geometry), 8);
    assert_int_equal(flat.geometry.object_count, 8);
    for (uint32_t id = 0; id < 8; id++) {
        assert_string_equal(material_at(&scene, id)->name, names[id]);
        assert_string_equal(material_at(&flat, id)->name, names[id]);
    }
    for (uint32_t i = 0; i < 4; i++)
        assert_string_equal(flat.materials[flat.geometry.forest.set.solids[i].material].name, names[2 * i]);
    rt_scene_clear(&flat);
}

RT_TEST(formats_without_instances_get_copies) {
    OWNED_SCENE scene =
        yaml_scene("parts:\n"
                   "- {name: a, objects: [triangle: {vertices: [[0, 0, 0], [1, 0, 0], [0, 1, 0]]}]}\n"
                   "instances: [{part: a}, {part: a, transform: [{translate: [0, 0, 2]}]}]\n");
    static const char *const paths[] = {RT_TEST_FOLDER "/copies.obj", RT_TEST_FOLDER "/copies.ply",
                                        RT_TEST_FOLDER "/copies.stl"};
    for (size_t i = 0; i < 3; i++) {
        assert_ok(rt_scene_save(&scene, paths[i], error));
        OWNED_SCENE flat = open_scene(paths[i]);
        assert_int_equal(flat.geometry.triangle_count, 2);
        assert_true(flat.geometry.triangles[1].v[1].x == 1 && flat.geometry.triangles[1].v[1].z == 2);
    }
}

RT_TEST(a_mesh_in_a_part_is_moved_by_its_own_transform) {
    OWNED_SCENE scene =
        yaml_scene("parts:\n"
                   "- name: a\n"
                   "  objects: [mesh: {path: corner.obj, transform: [{translate: [0, 0, 5]}]}]\n"
                   "instances: [{part: a, transform: [{translate: [0, 7, 0]}]}]\n");
    const RtVec3 corner = scene.parts[0]->geometry.triangles[0].v[2];
    assert_true(corner.x == 0 && corner.y == 1 && corner.z == 5);
    assert_true(scene.geometry.box.lo.y <= 7 && scene.geometry.box.hi.y >= 8 && scene.geometry.box.lo.y > 6);
}

/* ---- --recentre ---- */

RT_TEST(recentring_moves_instances_but_not_parts) {
    static const char text[] =
        "materials: [{name: board, texture: {checker: 0.25, origin: [0.1, 0.2, 0.3]}}]\n"
        "solids: [{name: s, box: {lo: [-1, -1, -1], hi: [1, 1, 1], material: board}}]\n"
        "parts:\n"
        "- name: a\n"
        "  objects: [sphere: {center: [0.1, 0, 0], radius: 1, material: board}, csg: {formula: s}]\n"
        "- {name: b, instances: [{part: a, transform: [{translate: [1, 2, 3]}]}]}\n"
        "objects: [sphere: {center: [500000, 0, 0], radius: 1, material: board}]\n"
        "instances:\n"
        "- {part: b, transform: [{translate: [500000.123, 0, 0]}]}\n"
        "- {part: a, place: [1, 0, 0, 500000.123, 0, 1, 0, 0, 0, 0, 1, 0]}\n";
    RtVec3d offset = {{500000, 0, 0}};
    OWNED_SCENE far = yaml_scene(text), near;
    assert_ok(rt_scene_load(RT_TEST_FOLDER "/scene.yaml", rt_builtin_open, &offset, &near, error));
    for (uint32_t i = 0; i < 2; i++) {
        const RtTransform *m = &near.geometry.instances[i].to_world;
        assert_true(fabs(m->m[0][3] - 0.123) < 1e-9 && m->m[1][3] == 0);
    }
    const RtScene *a = near.parts[0], *b = near.parts[1];
    assert_true(a->geometry.spheres[0].center.x == 0.1f);
    assert_memory_equal(&a->geometry.boxes[1], &far.parts[0]->geometry.boxes[1], sizeof(RtBox));
    assert_true(b->geometry.instances[0].to_world.m[0][3] == 1);
    assert_true(near.materials[near.material_of[0]].texture.origin.x == -499999.9f);
    assert_true(near.materials[a->material_of[0]].texture.origin.x == 0.1f);
    assert_int_equal(a->geometry.forest.set.solids[0].material, a->material_of[0]);
}

/* ---- memory ---- */

RT_TEST(whichever_allocation_fails_no_part_is_left) {
    write_painted_mesh();
    write_text(RT_TEST_FOLDER "/scene.yaml", instanced);
    RtScene scene;
    FILE *out = fopen("/dev/null", "wb");
    assert_non_null(out);
    assert_fails_cleanly(load(RT_TEST_FOLDER "/scene.yaml", &scene, error), rt_scene_clear(&scene));
    OWNED_SCENE good = yaml_scene(instanced);
    assert_fails_cleanly(rt_scene_flatten(&good, &scene, error), rt_scene_clear(&scene));
    assert_fails_cleanly(rt_yaml_save(&good, out, error), fclose(out));
}

RT_TESTS(instances_file, make_folder, NULL)
