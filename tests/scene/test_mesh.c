/* SPDX-License-Identifier: Apache-2.0 */
/* Meshes through Assimp: what is kept, where it is placed, what is rejected. */
#include "scene_testing.h"

#include "core/base/file.h"
#include "core/scene/load.h"
#include "core/scene/mesh.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

#define OBJ_NAME RT_BINARY_DIR "/test_mesh_scene.obj"
#define BUNNY    "/usr/share/glmark2/models/bunny.obj"

static RtStatus load_text(const char *path, const char *text, RtScene *scene, RtError *out) {
    assert_ok(rt_file_write(path, text, strlen(text), error));
    return rt_scene_open(path, scene, out);
}

RT_TEST(triangles_keep_the_order_of_the_file_and_have_no_normals_of_their_own) {
    OWNED_SCENE scene;
    assert_ok(load_text(OBJ_NAME,
                        "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 1 1 0\n"
                        "f 1 2 3\nf 1 2 4\nf 1 1 1\nf 1 2 5 3\n",
                        &scene, error));
    const RtGeometry *g = &scene.geometry;
    assert_int_equal(g->triangle_count, 5);
    assert_int_equal(g->vertex_normal_count, 0);
    assert_true(g->triangles[0].v[2].y == 1);
    assert_true(g->triangles[1].v[2].z == 1);
    assert_true(g->triangles[2].v[2].x == 0);
    assert_true(scene.camera.up.y == 1);
    assert_int_equal(scene.light_count, 1);
}

RT_TEST(vertex_normals_of_the_file_are_kept) {
    OWNED_SCENE scene;
    assert_ok(load_text(OBJ_NAME,
                        "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 2\nvn 0 1 0\nvn 1 0 0\nf 1//1 2//2 3//3\n", &scene,
                        error));
    assert_int_equal(scene.geometry.vertex_normal_count, 1);
    const RtVec3 *n = scene.geometry.vertex_normals[0].n;
    assert_true(n[0].z == 1 && n[1].y == 1 && n[2].x == 1);
}

RT_TEST(a_mesh_goes_where_its_transform_puts_it) {
    OWNED_SCENE scene;
    uint32_t material;
    RtMaterial standard = rt_default_material();
    RtTransform transform = rt_transform_identity();
    assert_ok(rt_transform_scale(&transform, rt_vec3(2, 2, 2), error));
    assert_ok(rt_transform_translate(&transform, rt_vec3(0, 0, 5), error));
    assert_ok(rt_file_write(OBJ_NAME, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", 32, error));
    rt_scene_init(&scene);
    assert_ok(rt_scene_add_material(&scene, &standard, &material, error));
    assert_ok(rt_mesh_append(&scene, OBJ_NAME, material, &transform, error));
    const RtVec3 *v = scene.geometry.triangles[0].v;
    assert_true(v[0].z == 5 && v[1].x == 2 && v[2].y == 2);
}

/* One triangle in an embedded buffer; two nodes use it, the second with a matrix that mirrors x and moves
 * z. */
static const char two_nodes[] =
    "{\"asset\":{\"version\":\"2.0\"},\"scene\":0,\"scenes\":[{\"nodes\":[0,1]}],"
    "\"nodes\":[{\"mesh\":0},{\"mesh\":0,\"matrix\":[-1,0,0,0,0,1,0,0,0,0,1,0,0,0,7,1]}],"
    "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}],"
    "\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\","
    "\"min\":[0,0,0],\"max\":[1,1,0]}],\"bufferViews\":[{\"buffer\":0,\"byteLength\":36}],"
    "\"buffers\":[{\"byteLength\":36,\"uri\":\"data:application/octet-stream;base64,"
    "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA\"}]}";

RT_TEST(the_matrices_of_nodes_are_applied_and_mirrors_keep_the_outside_out) {
    OWNED_SCENE scene;
    assert_ok(load_text(RT_BINARY_DIR "/test_mesh_scene.gltf", two_nodes, &scene, error));
    assert_int_equal(scene.geometry.triangle_count, 2);
    RtBox box = scene.geometry.box;
    assert_true(box.lo.x == -1 && box.hi.x == 1 && box.lo.z == 0 && box.hi.z == 7);
    for (int i = 0; i < 2; i++) assert_true(rt_triangle_normal(&scene.geometry.triangles[i]).z == 1);
}

RT_TEST(binary_formats_bring_triangles_back_bit_for_bit) {
    static const char *const names[] = {RT_BINARY_DIR "/test_mesh.ply", RT_BINARY_DIR "/test_mesh.stl",
                                        RT_BINARY_DIR "/test_mesh.glb"};
    OWNED_SCENE scene = open_scene("random:n=300,shape=triangle");
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        assert_ok(rt_scene_save(&scene, names[i], true, error));
        OWNED_SCENE again = open_scene(names[i]);
        assert_int_equal(again.geometry.triangle_count, 300);
        assert_memory_equal(again.geometry.triangles, scene.geometry.triangles, 300 * sizeof(RtTriangle));
    }
}

RT_TEST(obj_comes_back_within_the_rounding_of_its_reader) {
    OWNED_SCENE scene = open_scene("random:n=300,shape=triangle");
    assert_ok(rt_scene_save(&scene, OBJ_NAME, true, error));
    OWNED_SCENE again = open_scene(OBJ_NAME);
    assert_int_equal(again.geometry.triangle_count, 300);
    assert_int_equal(again.geometry.vertex_normal_count, 0);
    for (int i = 0; i < 300; i++) {
        for (int k = 0; k < 3; k++) {
            RtVec3 a = scene.geometry.triangles[i].v[k], b = again.geometry.triangles[i].v[k];
            for (int axis = 0; axis < 3; axis++) assert_true(fabsf(a.at[axis] - b.at[axis]) <= 2e-7f);
        }
    }
}

RT_TEST(a_scene_with_other_shapes_is_not_written_as_a_mesh) {
#define REFUSED RT_BINARY_DIR "/test_mesh_refused.ply"
    OWNED_SCENE scene = open_scene("balls:size=1");
    assert_bad_input(rt_scene_save(&scene, REFUSED, true, error), "sphere: 10");
    assert_not_written(REFUSED);
}

#define PLY(faces)                                                                                           \
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"        \
    "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n" faces

RT_TEST(bad_meshes_are_refused_with_what_is_wrong) {
    const struct {
        const char *path, *text, *says;
    } cases[] = {
        {OBJ_NAME, "", "Assimp cannot read"},
        {OBJ_NAME, "v 0 0 0\nv 1 0 0\n", ""},
        {OBJ_NAME, "v 0 0 0\nv nan 0 0\nv 0 1 0\nf 1 2 3\n", "vertex 1 of mesh"},
        {OBJ_NAME, "v 0 0 0\nv 1e30 0 0\nv 0 1 0\nf 1 2 3\n", "exceeds"},
        {OBJ_NAME, "v 0 0 0\nv 1 0 0\nv 0 1 0\nl 1 2\n", "no triangle"},
        {OBJ_NAME, "v 0 0 0\nv 1 0 0\nf 1 2 9\n", ""},
        {RT_BINARY_DIR "/test_mesh.glb", "glTF but not really", "Assimp cannot read"},
        {RT_BINARY_DIR "/test_mesh.stl", "solid\nfacet", ""},
        {RT_BINARY_DIR "/test_mesh.ply", PLY("0\n"), "has no vertices"},
        {RT_BINARY_DIR "/test_mesh.ply", PLY("4 0 1 2 99999999\n"), "names vertex 99999999 of 3"},
        {RT_BINARY_DIR "/test_mesh.ply", PLY("5 0 1 2 0 -1\n"), "names vertex 4294967295 of 3"},
        {RT_BINARY_DIR "/test_mesh.ply", "ply\nformat ascii 1.0\nelement vertex 4000000000\nend_header\n",
         ""},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        RtScene scene;
        assert_bad_input_at(load_text(cases[i].path, cases[i].text, &scene, error), cases[i].path,
                            cases[i].says);
    }
    RtScene scene = {0};
    assert_bad_input(rt_mesh_append(&scene, "no_such.obj", 0, NULL, error), "No such file");
}

RT_TEST(assimp_says_nothing_on_the_terminal) {
    FILE *both = tmpfile();
    assert_non_null(both);
    fflush(stdout);
    fflush(stderr);
    int out = dup(1), err = dup(2);
    dup2(fileno(both), 1);
    dup2(fileno(both), 2);
    RtScene scene;
    RtError problem;
    RtStatus good = load_text(OBJ_NAME, "mtllib none.mtl\nusemtl x\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n",
                              &scene, &problem);
    if (good == RT_OK) rt_scene_clear(&scene);
    RtStatus bad = load_text(OBJ_NAME, "nothing of the kind\n", &scene, &problem);
    fflush(stdout);
    fflush(stderr);
    dup2(out, 1);
    dup2(err, 2);
    close(out);
    close(err);
    fseek(both, 0, SEEK_END);
    assert_int_equal(ftell(both), 0);
    fclose(both);
    assert_int_equal(good, RT_OK);
    assert_int_equal(bad, RT_BAD_INPUT);
}

RT_TEST(every_failed_allocation_is_reported_and_leaves_nothing) {
    assert_ok(rt_file_write(OBJ_NAME, "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nf 1//1 2//1 3//1\n", 51, error));
    assert_failed_allocations_are_reported(OBJ_NAME);
    OWNED_SCENE scene = open_scene(OBJ_NAME);
    assert_fails_cleanly(rt_scene_save(&scene, RT_BINARY_DIR "/test_mesh.ply", true, error), (void)0);
    OWNED_SCENE again = open_scene(RT_BINARY_DIR "/test_mesh.ply");
    assert_int_equal(again.geometry.vertex_normal_count, 1);
}

RT_TEST(the_bunny_has_69666_triangles_all_with_area) {
    if (!rt_file_exists(BUNNY)) RT_SKIP(BUNNY " (glmark2-data)");
    OWNED_SCENE scene = open_scene(BUNNY);
    assert_int_equal(scene.geometry.triangle_count, 69666);
    for (uint32_t i = 0; i < 69666; i++)
        assert_true(rt_lengthd(rt_triangle_normal(&scene.geometry.triangles[i])) > 0);
}

RT_TESTS(mesh, NULL, NULL)
