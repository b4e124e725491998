/* SPDX-License-Identifier: Apache-2.0 */
/* Textures in files: YAML, images, texture coordinates of meshes, MTL. */
#include "yaml_testing.h"

#include "core/base/file.h"

#define FOLDER RT_TEST_FOLDER

static const uint8_t two[] = {255, 0, 0, 0, 0, 255};

/* The coordinates of triangle 0 are 2u, v = 0 0, 2 0, 0 1. */
static void assert_has_coordinates(const RtScene *scene) {
    assert_int_equal(scene->triangle_texture_count, 1);
    const RtTriangleTexture *texture = rt_scene_triangle_texture(scene, 0);
    assert_non_null(texture);
    static const RtUv expected[3] = {{0, 0}, {2, 0}, {0, 1}};
    assert_memory_equal(texture->at, expected, sizeof expected);
}

/* A mesh of this text in a scene that gives it a checker. */
static RtScene checkered_mesh(const char *name, const char *text) {
    char path[256], yaml[512];
    snprintf(path, sizeof path, FOLDER "/%s", name);
    write_text(path, text);
    snprintf(yaml, sizeof yaml,
             "materials: [{name: c, texture: {checker: 1}}]\nobjects: [mesh: {path: %s, material: c}]\n",
             name);
    return yaml_scene(yaml);
}

#define V3 "v 0 0 0\nv 1 0 0\nv 0 1 0\n"

RT_TEST(meshes_keep_their_texture_coordinates_under_a_textured_material) {
    static const char *const files[][2] = {
        {"uv.obj", V3 "vt 9 9\nvt 0 0\nvt 2 0\nvt 0 1\nf 1/2 2/3 3/4\n"},
        {"negative.obj", V3 "vt 0 0\nvt 2\nvt 0 1 7\nf 1/-3 2/-2 3/-1\n"},
        {"ahead.obj", "f 1/1 2/2 3/3\n" V3 "vt 0 0\nvt 2 0\nvt 0 1\n"},
        {"uv.ply",
         "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
         "property float s\nproperty float t\nproperty float u\nelement face 1\n"
         "property list uchar int vertex_indices\nend_header\n"
         "0 0 0 0 0 5\n1 0 0 2 0 5\n0 1 0 0 1 5\n3 0 1 2\n"},
        {"uv.gltf",
         "{\"asset\":{\"version\":\"2.0\"},\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"mesh\":0}],"
         "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0,\"TEXCOORD_0\":1}}]}],\"accessors\":["
         "{\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"},"
         "{\"bufferView\":1,\"componentType\":5126,\"count\":3,\"type\":\"VEC2\"}],\"bufferViews\":["
         "{\"buffer\":0,\"byteLength\":36},{\"buffer\":0,\"byteOffset\":36,\"byteLength\":24}],"
         "\"buffers\":[{\"byteLength\":60,\"uri\":\"uv.bin\"}]}\n"}};
    static const float data[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, /* v from above */ 0, 1, 2, 1, 0, 0};
    write_bytes(FOLDER "/uv.bin", data, sizeof data);
    for (size_t i = 0; i < sizeof files / sizeof files[0]; i++) {
        OWNED_SCENE scene = checkered_mesh(files[i][0], files[i][1]);
        assert_has_coordinates(&scene);
        assert_int_equal(scene.warnings.count, 0);
    }
}

RT_TEST(coordinates_that_are_missing_or_not_finite_are_none) {
    static const char *const faces[] = {"vt 0 0\nf 1/1 2/1 3\n", "vt 0 0\nvt nan 0\nf 1/1 2/1 3/2\n",
                                        "vt 0 0\nvt\nf 1/1 2/1 3/2\n"};
    for (size_t i = 0; i < sizeof faces / sizeof faces[0]; i++) {
        char text[256];
        snprintf(text, sizeof text, V3 "%s", faces[i]);
        OWNED_SCENE scene = checkered_mesh("bad.obj", text);
        assert_int_equal(scene.triangle_texture_count, 0);
        assert_int_equal(scene.warnings.count, i > 0);
    }
}

RT_TEST(without_a_texture_no_coordinates_are_kept) {
    write_text(FOLDER "/plain.obj", V3 "vt 0 0\nf 1/1 2/1 3/1\n");
    OWNED_SCENE with = open_scene(FOLDER "/plain.obj");
    write_text(FOLDER "/plain.obj", V3 "f 1 2 3\n");
    OWNED_SCENE without = open_scene(FOLDER "/plain.obj");
    assert_int_equal(with.triangle_texture_count, 0);
    assert_true(rt_scene_fingerprint(&with) == rt_scene_fingerprint(&without));
    assert_int_equal(rt_scene_bytes(&with), rt_scene_bytes(&without));
}

/* ---- MTL ---- */

static const char mtl[] = "newmtl plain\nKd 1 0 0\n\n"
                          "newmtl two  \n\tKd 0.5 0.25 1\r\n\tmap_Kd -s 1 1 1 images\\two.png \n"
                          "newmtl of words\nmap_Kd images/two words.png\n";

static void write_library(const char *text) {
    mkdir(FOLDER "/images", 0777);
    write_png(FOLDER "/images/two.png", 2, 1, two);
    write_png(FOLDER "/images/two words.png", 2, 1, two);
    write_text(FOLDER "/library.mtl", text);
}

RT_TEST(materials_of_obj_with_an_image_are_read_and_others_ignored) {
    write_library(mtl);
    OWNED_SCENE scene = scene_of(FOLDER "/mtl.obj",
                                 "mtllib library.mtl\n" V3 "vt 0 0\nvt 2 0\nvt 0 1\n"
                                 "usemtl plain\nf 1/1 2/2 3/3\nusemtl two\nf 1/1 2/2 3/3\nusemtl of words\n"
                                 "f 1/1 2/2 3/3\nusemtl nothing\nf 1 2 3\n");
    const RtMaterial *m = scene.materials;
    assert_int_equal(scene.material_count, 3);
    assert_int_equal(scene.warnings.count, 1);
    assert_non_null(strstr(scene.warnings.list[0].message, "options of map_Kd are ignored: -s 1 1 1"));
    static const uint32_t materials[] = {0, 1, 2, 0};
    assert_memory_equal(scene.material_of, materials, sizeof materials);
    assert_string_equal(m[1].name, "two");
    assert_true(m[1].color.x == 0.5f && m[1].color.y == 0.25f && m[1].diffuse == m[0].diffuse);
    assert_true(m[2].color.x == m[0].color.x);
    assert_memory_equal(m[1].texture.texels->rgb, two, sizeof two);
    assert_int_equal(scene.triangle_texture_count, 2);
    assert_null(rt_scene_triangle_texture(&scene, 0));
    assert_non_null(rt_scene_triangle_texture(&scene, 2));
}

RT_TEST(a_library_that_is_not_there_changes_nothing) {
    static const char *const lines[] = {"", "mtllib\n", "mtllib no.mtl\nusemtl two\n", "mtllib C:\\\n",
                                        "mtllib corner.obj\nusemtl two\n"};
    uint64_t first = 0;
    for (size_t i = 0; i < sizeof lines / sizeof lines[0]; i++) {
        char text[256];
        snprintf(text, sizeof text, "%s" V3 "f 1 2 3\n", lines[i]);
        OWNED_SCENE scene = scene_of(FOLDER "/mtl.obj", text);
        if (i == 0) first = rt_scene_fingerprint(&scene);
        assert_true(rt_scene_fingerprint(&scene) == first);
        assert_int_equal(scene.warnings.count, 0);
    }
}

RT_TEST(an_image_that_cannot_be_read_is_a_warning) {
    static const char *const images[] = {"no.png", "library.mtl", "images"};
    for (size_t i = 0; i < 3; i++) {
        char text[256];
        snprintf(text, sizeof text, "newmtl two\nmap_Kd %s\n", images[i]);
        write_library(text);
        OWNED_SCENE scene =
            scene_of(FOLDER "/mtl.obj", "mtllib library.mtl\nusemtl two\n" V3 "vt 0 0\nf 1/1 2/1 3/1\n");
        assert_int_equal(scene.material_count, 1);
        assert_int_equal(scene.warnings.count, 1);
        assert_non_null(strstr(scene.warnings.list[0].message, "is left out"));
    }
}

RT_TEST(whichever_allocation_fails_reading_a_library_is_out_of_memory) {
    write_library(mtl);
    write_text(FOLDER "/mtl.obj", "mtllib library.mtl\nusemtl two\n" V3 "vt 0 0\nf 1/1 2/1 3/1\n");
    assert_failed_allocations_are_reported(FOLDER "/mtl.obj");
}

/* ---- images ---- */

RT_TEST(materials_of_one_image_share_its_texels) {
    write_library("");
    OWNED_SCENE scene = yaml_scene("materials:\n"
                                   "  - {name: a, texture: {image: images/two.png}}\n"
                                   "  - {name: b, texture: {image: ./images/two.png, size: 3}}\n"
                                   "objects: [sphere: {center: [0, 0, 0], radius: 1, material: b}]\n");
    const RtTexture *a = &scene.materials[0].texture, *b = &scene.materials[1].texture;
    assert_ptr_equal(a->texels, b->texels);
    assert_int_equal(a->texels->users, 2);
    assert_true(a->size == 1 && b->size == 3);
}

static RtStatus load_image(const void *bytes, size_t count) {
    RtTexels *texels;
    write_bytes(FOLDER "/image.png", bytes, count);
    RtError error;
    const RtStatus status = rt_texels_load(FOLDER "/image.png", &texels, &error);
    if (status == RT_OK) rt_texels_release(texels);
    return status;
}

RT_TEST(images_that_are_damaged_or_too_large_are_refused) {
    char *bytes;
    size_t size;
    RtTexels *texels;
    write_png(FOLDER "/image.png", 2, 1, two);
    assert_ok(rt_file_read(FOLDER "/image.png", 10000, &bytes, &size, error));
    assert_int_equal(load_image(bytes, size), RT_OK);
    for (size_t cut = 0; cut + 20 < size; cut++) /* behind the pixels are two checksums and an empty chunk */
        assert_int_equal(load_image(bytes, cut), RT_BAD_INPUT);
    /* sides of 2^16 */
    static const uint8_t large[] = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n', 0, 0, 0, 13, 'I', 'H', 'D',
                                    'R',  0,   1,   0,   0,    0,    1,    0,    0, 8, 2, 0,  0,   0};
    uint8_t header[sizeof large + 16] = {0};
    memcpy(header, large, sizeof large);
    memcpy(header + sizeof large, "\xe3\xe6\xa7\xb4\0\0\0\0IDAT", 12);
    write_bytes(FOLDER "/image.png", header, sizeof header);
    assert_bad_input(rt_texels_load(FOLDER "/image.png", &texels, error),
                     "65536 x 65536 pixels are too many");
    assert_bad_input(rt_texels_load(FOLDER "/scene.yaml", &texels, error), "expected a PNG image");
    rt_free(bytes);
}

RT_TEST(whichever_allocation_fails_loading_an_image_is_out_of_memory) {
    RtTexels *texels = NULL;
    write_png(FOLDER "/image.png", 2, 1, two);
    assert_fails_cleanly(rt_texels_load(FOLDER "/image.png", &texels, error), rt_texels_release(texels));
}

/* ---- scenes ---- */

static const char textured[] = "materials: [{name: a, texture: {image: images/two.png}}]\n"
                               "objects: [sphere: {center: [0, 0, 0], radius: 1, material: a}]\n";

RT_TEST(the_fingerprint_knows_the_texels) {
    static const uint8_t other[] = {255, 0, 1, 0, 0, 255};
    write_library("");
    OWNED_SCENE first = yaml_scene(textured), again = yaml_scene(textured);
    write_png(FOLDER "/images/two.png", 2, 1, other);
    OWNED_SCENE changed = yaml_scene(textured);
    write_png(FOLDER "/images/two.png", 1, 2, two);
    OWNED_SCENE upright = yaml_scene(textured);
    assert_true(rt_scene_fingerprint(&first) == rt_scene_fingerprint(&again));
    assert_true(rt_scene_fingerprint(&first) != rt_scene_fingerprint(&changed));
    assert_true(rt_scene_fingerprint(&first) != rt_scene_fingerprint(&upright));
}

RT_TEST(a_scene_appended_keeps_its_textures_and_a_subset_has_none) {
    OWNED_SCENE scene = checkered_mesh("uv.obj", V3 "vt 0 0\nvt 2 0\nvt 0 1\nf 1/1 2/2 3/3\n"), copy, part;
    rt_scene_init(&copy);
    assert_ok(rt_scene_append(&copy, &scene, NULL, error));
    assert_has_coordinates(&copy);
    const uint32_t id = 0;
    assert_ok(rt_scene_subset(&scene, &id, 1, &part, error));
    assert_int_equal(part.triangle_texture_count, 0);
    assert_int_equal(part.materials[0].texture.kind, RT_TEXTURE_NONE);
}

RT_TEST(recentring_takes_textures_along) {
    write_text(FOLDER "/far.yaml", "materials: [{name: a, texture: {checker: 2, origin: [1000, 0, 0]}},\n"
                                   "            {name: b, texture: {checker: 2}}]\n"
                                   "objects: [sphere: {center: [1001, 0, 0], radius: 1, material: a}]\n");
    RtVec3d offset = rt_vec3d(1000, 0, 0);
    OWNED_SCENE scene;
    assert_ok(rt_scene_load(FOLDER "/far.yaml", rt_builtin_open, &offset, &scene, error));
    assert_true(scene.materials[0].texture.origin.x == 0 && scene.materials[1].texture.origin.x == -1000);
}

RT_TEST(mistakes_in_textures_are_refused_at_their_place) {
    static const char *const mistakes[][2] = {
        {"{checker: 0}", "the size of the texture is 0"},
        {"{checker: 1, color: [-1, 0, 0]}", "a colour of the checker is -1"},
        {"{image: no.png}", "materials[0].texture.image"},
        {"{image: scene.yaml}", "expected a PNG image"},
        {"{image: images/two.png, color: [1, 0, 0]}", "unknown key 'color'"},
        {"{size: 1}", "checker"},
        {"wood", "texture"}};
    write_library("");
    for (size_t i = 0; i < sizeof mistakes / sizeof mistakes[0]; i++) {
        char text[512];
        RtScene scene;
        snprintf(text, sizeof text,
                 "materials: [{name: a, texture: %s}]\nobjects: [sphere: {center: [0, 0, 0], radius: 1}]\n",
                 mistakes[i][0]);
        assert_bad_input(load_text(text, &scene, error), mistakes[i][1]);
    }
}

RT_TESTS(textures, make_folder, assert_nothing_is_kept)
