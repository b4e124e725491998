/* SPDX-License-Identifier: Apache-2.0 */
/* Meshes: what is kept, where it is placed, how polygons are split. test_mesh_damage.c has what is rejected.
 */
#include "scene_testing.h"

#include "core/base/clock.h"
#include "core/base/file.h"
#include "core/scene/load.h"
#include "core/scene/mesh.h"

#define OBJ_NAME RT_BINARY_DIR "/test_mesh_scene.obj"
#define PLY_NAME RT_BINARY_DIR "/test_mesh_scene.ply"
#define BUNNY    "/usr/share/glmark2/models/bunny.obj"

RT_TEST(triangles_keep_the_order_of_the_file_and_have_no_normals_of_their_own) {
    OWNED_SCENE scene =
        scene_of(OBJ_NAME, "\xEF\xBB\xBFv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 1 1 0\n" /* a byte-order mark */
                           "f 1 2 3\nf 1 2 4\nf 1 1 1\nf 1 2 5 3\n");
    const RtGeometry *g = &scene.geometry;
    assert_int_equal(g->triangle_count, 5);
    assert_int_equal(g->vertex_normal_count, 0);
    assert_true(g->triangles[0].v[2].y == 1);
    assert_true(g->triangles[1].v[2].z == 1);
    assert_true(g->triangles[2].v[2].x == 0);
    assert_true(scene.camera.up.y == 1);
    assert_int_equal(scene.light_count, 1);
}

RT_TEST(a_mesh_goes_where_its_transform_puts_it) {
    RtTransform transform = rt_transform_identity();
    assert_ok(rt_transform_scale(&transform, rt_vec3(2, 2, 2), error));
    assert_ok(rt_transform_translate(&transform, rt_vec3(0, 0, 5), error));
    write_text(OBJ_NAME, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    OWNED_SCENE scene = begin_scene();
    assert_ok(rt_mesh_append(&scene, OBJ_NAME, 0, &transform, false, error));
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
    OWNED_SCENE scene = scene_of(RT_BINARY_DIR "/test_mesh_scene.gltf", two_nodes);
    assert_int_equal(scene.geometry.triangle_count, 2);
    RtBox box = scene.geometry.box;
    assert_true(box.lo.x == -1 && box.hi.x == 1 && box.lo.z == 0 && box.hi.z == 7);
    for (int i = 0; i < 2; i++) assert_true(rt_triangle_normal(&scene.geometry.triangles[i]).z == 1);
}

RT_TEST(a_mesh_that_is_saved_keeps_each_bit) {
    static const char *const names[] = {OBJ_NAME, PLY_NAME, RT_BINARY_DIR "/test_mesh.stl",
                                        RT_BINARY_DIR "/test_mesh.glb"};
    OWNED_SCENE scene = open_scene("random:n=300,shape=triangle");
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        assert_ok(rt_scene_save(&scene, names[i], error));
        OWNED_SCENE again = open_scene(names[i]);
        assert_int_equal(again.geometry.triangle_count, 300);
        assert_int_equal(again.geometry.vertex_normal_count, 0);
        assert_memory_equal(again.geometry.triangles, scene.geometry.triangles, 300 * sizeof(RtTriangle));
    }
}

/* `text` has a place for the number, which is the least x of a triangle; returns that. */
static float read_as(const char *path, const char *text, const char *number) {
    char whole[512];
    snprintf(whole, sizeof whole, text, number); /* NOLINT(clang-diagnostic-format-nonliteral) */
    OWNED_SCENE scene = scene_of(path, whole);
    return scene.geometry.box.lo.x;
}

/* Ties, and numbers so near to them that a double in between would round twice; subnormal numbers. */
static const struct {
    const char *text;
    float value;
} hard_numbers[] = {{"-0.0000000000000001", -1e-16f},
                    {"-1e-16", -1e-16f},
                    {"-16777217", -16777216},
                    {"-16777217.00000000001", -16777218},
                    {"-1.000000059604644775390625", -1},
                    {"-1.0000000596046447753906250001", -0x1.000002p0f},
                    {"-1.0000001788139343261718749999", -0x1.000002p0f},
                    {"-0.100000001490116119384765625", -0.1f},
                    {"-1.8446744073709551617", -1.84467435f}, /* 2^64 + 1 */
                    {"-1234.56789e-2", -12.3456789f},
                    {"-37.83e-6", -3.783e-5f},
                    {"-1.17549435e-38", -0x1p-126f},
                    {"-1.4e-45", -0x1p-149f},
                    {"-7.006492321624086e-46", -0x1p-149f}};

RT_TEST(every_text_format_reads_the_float_nearest_to_a_number) {
    static const struct {
        const char *name, *text;
    } formats[] = {
        {"numbers.obj", "v %s 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"},
        {"numbers.ply", "ply\nformat ascii 1.0\nelement vertex 3\nproperty double x\nproperty float y\n"
                        "property float z\nelement face 1\nproperty list uchar int vertex_indices\n"
                        "end_header\n%s 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"},
        {"numbers.stl", "solid s\nfacet normal 0 0 1\nouter loop\nvertex %s 0 0\nvertex 1 0 0\n"
                        "vertex 0 1 0\nendloop\nendfacet\nendsolid s\n"},
        {"numbers.off", "OFF\n3 1 0\n%s 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"},
        {"numbers.nff", "p 3\n%s 0 0\n1 0 0\n0 1 0\n"},
        {"numbers.yaml", "objects:\n  - polygon: {vertices: [[%s, 0, 0], [1, 0, 0], [0, 1, 0]]}\n"}};
    for (size_t f = 0; f < sizeof formats / sizeof formats[0]; f++) {
        char path[512];
        snprintf(path, sizeof path, RT_BINARY_DIR "/test_mesh_%s", formats[f].name);
        for (size_t i = 0; i < sizeof hard_numbers / sizeof hard_numbers[0]; i++) {
            const float value = read_as(path, formats[f].text, hard_numbers[i].text);
            if (value != hard_numbers[i].value)
                fail_msg("%s: %s is read as %.9g", formats[f].name, hard_numbers[i].text, (double)value);
        }
        remove(path);
    }
}

RT_TEST(a_scene_with_other_shapes_is_not_written_as_a_mesh) {
#define REFUSED RT_BINARY_DIR "/test_mesh_refused.ply"
    OWNED_SCENE scene = open_scene("balls:size=1");
    assert_bad_input(rt_scene_save(&scene, REFUSED, error), "sphere: 10");
    assert_not_written(REFUSED);
}

/* ---- polygons ---- */

/* Twice the area of a triangle, negative if the plane z = 0 sees it from behind. */
static double area_of(const RtTriangle *triangle) {
    const RtVec3d a = rt_widen(triangle->v[0]);
    return rt_crossd(rt_subd(rt_widen(triangle->v[1]), a), rt_subd(rt_widen(triangle->v[2]), a)).z;
}

RT_TEST(polygons_of_any_form_become_triangles_that_cover_them) {
    const struct {
        const char *text;
        uint32_t triangles;
        double area; /* twice */
    } cases[] = {
        {"v 0 0 0\nv 2 0 0\nv 2 2 0\nv 0 2 0\nf 1 2 3 4\n", 2, 8},
        {"v 0 0 0\nv 4 0 0\nv 1 1 0\nv 0 4 0\nf 1 2 3 4\n", 2, 8}, /* an arrow, from each corner */
        {"v 0 0 0\nv 4 0 0\nv 1 1 0\nv 0 4 0\nf 2 3 4 1\n", 2, 8},
        {"v 0 0 0\nv 4 0 0\nv 1 1 0\nv 0 4 0\nf 3 4 1 2\n", 2, 8},
        {"v 0 0 0\nv 4 0 0\nv 1 1 0\nv 0 4 0\nf 4 3 2 1\n", 2, -8}, /* seen from behind */
        {"v 0 0 0\nv 3 0 0\nv 3 1 0\nv 2 1 0\nv 2 2 0\nv 3 2 0\nv 3 3 0\nv 0 3 0\nf 1 2 3 4 5 6 7 8\n", 6,
         16},
        {"v 0 0 0\nv 1 0 0\nv 2 0 0\nv 2 2 0\nv 0 2 0\nf 1 2 3 4 5\n", 3, 8}, /* a corner on an edge */
        {"v 0 0 0\nv 1 1 0\nv 2 2 0\nv 3 3 0\nf 1 2 3 4\n", 2, 0},            /* no area at all */
        {"v 0 0 0\nv 4 0 0\nv 4 4 0\nv 0 4 0\nv 1 1 0\nv 1 3 0\nv 3 3 0\nv 3 1 0\n"
         "f 1 2 3 4 1 5 6 7 8 5\n",
         8, 24}, /* a square with a hole, cut open */
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        OWNED_SCENE scene = scene_of(OBJ_NAME, cases[i].text);
        assert_int_equal(scene.geometry.triangle_count, cases[i].triangles);
        double area = 0;
        for (uint32_t t = 0; t < scene.geometry.triangle_count; t++) {
            const double part = area_of(&scene.geometry.triangles[t]);
            assert_true(part * cases[i].area >= 0);
            area += part;
        }
        assert_true(area == cases[i].area);
    }
}

/* ---- formats ---- */

RT_TEST(every_way_to_write_a_corner_of_obj_is_read) {
    static const char head[] = "v 0 0 0\nv 1 0 0 1\nv 0 1 0 .1 .2 .3\nvt 0 0\nvt 1 0\nvt 0 1\nvn 0 0 1\n";
    static const char *const faces[] = {
        "f 1 2 3\n",      "f 1/1 2/2 3/3\n",        "f 1//1 2//1 3//1\n",
        "f -3 -2 -1\n",   "f 1/1/1 2/2/1 3/3/1\n",  "f 1/-3/-1 2/2/1 -1/3/1\r\n",
        "f 1 2 \\\n 3\n", "\tf  1\t2  3 # a face\n"};
    for (size_t i = 0; i < sizeof faces / sizeof faces[0]; i++) {
        char text[256];
        snprintf(text, sizeof text, "# a comment\no name\n%sg a b c\nusemtl x\ns off\nl 1 2\n%s", head,
                 faces[i]);
        OWNED_SCENE scene = scene_of(OBJ_NAME, text);
        assert_int_equal(scene.geometry.triangle_count, 1);
        assert_true(scene.geometry.triangles[0].v[1].x == 1 && scene.geometry.triangles[0].v[2].y == 1);
        assert_int_equal(scene.geometry.vertex_normal_count,
                         strstr(faces[i], "//") || strstr(faces[i], "/1/") || strstr(faces[i], "/-3/"));
    }
}

RT_TEST(every_way_to_write_a_number_is_read) {
    static const char *const tens[] = {"10",     "+10.0",       "1e1", "1E+0000000001",
                                       "100e-1", "0000000010.", ".1e2"};
    for (size_t i = 0; i < sizeof tens / sizeof tens[0]; i++) {
        char text[256];
        snprintf(text, sizeof text, "v %s 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", tens[i]);
        OWNED_SCENE scene = scene_of(OBJ_NAME, text);
        assert_true(scene.geometry.triangles[0].v[0].x == 10);
    }
}

/* Element order, unused elements and properties, types, and both orders of bytes. */
RT_TEST(ply_is_read_with_all_its_types) {
    static const char text[] =
        "ply\r\nformat ascii 1.0\r\ncomment # odd\r\nelement material 1\r\n"
        "property list int8 uint16 x\r\nelement vertex 3\r\nproperty double y\r\n"
        "property float32 x\r\nproperty uchar red\r\nproperty short z\r\nelement face 1\r\n"
        "property list uint8 int32 vertex_index\r\nproperty list uchar float uv\r\n"
        "end_header\r\n2 7 8\r\n0 0 255 -1\r\n0 1 255 -1\r\n1 0 255 -1\r\n"
        "3 0 1 2 2 .5 .5\r\n";
    static const char big[] = "ply\nformat binary_big_endian 1.0\nelement vertex 3\nproperty short x\n"
                              "property char y\nproperty int z\nelement face 1\n"
                              "property list ushort uint vertex_indices\nend_header\n"
                              "\0\0\0\xff\xff\xff\xff\0\1\0\xff\xff\xff\xff\0\0\1\xff\xff\xff\xff"
                              "\0\3\0\0\0\0\0\0\0\1\0\0\0\2";
    for (int i = 0; i < 2; i++) {
        write_bytes(PLY_NAME, i ? big : text, (i ? sizeof big : sizeof text) - 1);
        OWNED_SCENE scene = open_scene(PLY_NAME);
        assert_int_equal(scene.geometry.triangle_count, 1);
        const RtVec3 *v = scene.geometry.triangles[0].v;
        assert_true(v[0].z == -1 && v[1].x == 1 && v[1].y == 0 && v[2].x == 0 && v[2].y == 1);
    }
}

RT_TEST(vertex_normals_of_the_file_are_kept) {
    static const char *const texts[][2] = {
        {OBJ_NAME, "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 2\nvn 0 1 0\nvn 1 0 0\nf 1//1 2//2 3//3\n"},
        {PLY_NAME,
         "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
         "property float nx\nproperty float ny\nproperty float nz\nelement face 1\n"
         "property list uchar int vertex_indices\nend_header\n"
         "0 0 0 0 0 2\n1 0 0 0 1 0\n0 1 0 1 0 0\n3 0 1 2\n"},
        {RT_BINARY_DIR "/test_mesh.off",
         "NOFF\n3 1 0\n0 0 0 0 0 2\n1 0 0 0 1 0\n0 1 0 1 0 0\n3 0 1 2 255 0 0\n"},
    };
    for (int i = 0; i < 3; i++) {
        OWNED_SCENE scene = scene_of(texts[i][0], texts[i][1]);
        assert_int_equal(scene.geometry.vertex_normal_count, 1);
        const RtVec3 *n = scene.geometry.vertex_normals[0].n;
        assert_true(n[0].z == 1 && n[1].y == 1 && n[2].x == 1);
    }
}

/* Of the corners 0 1 2 0, the second triangle is 1 0 2 as a strip, and 0 2 0 as a fan. */
RT_TEST(strips_and_fans_of_gltf_keep_their_orientation) {
    static const char form[] =
        "{\"asset\":{\"version\":\"2.0\"},\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"mesh\":0}],"
        "\"meshes\":[{\"primitives\":[{\"mode\":%d,\"attributes\":{\"POSITION\":0},\"indices\":1}]}],"
        "\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"},"
        "{\"bufferView\":1,\"componentType\":5121,\"count\":4,\"type\":\"SCALAR\"}],\"bufferViews\":["
        "{\"buffer\":0,\"byteLength\":36},{\"buffer\":1,\"byteLength\":4}],\"buffers\":[{\"byteLength\":36,"
        "\"uri\":"
        "\"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA\"},"
        "{\"byteLength\":4,\"uri\":\"data:;base64,AAECAA==\"}]}";
    for (int mode = 5; mode <= 6; mode++) {
        char text[1024];
        snprintf(text, sizeof text, form, mode);
        OWNED_SCENE scene = scene_of(RT_BINARY_DIR "/test_mesh_scene.gltf", text);
        assert_int_equal(scene.geometry.triangle_count, 2);
        const RtVec3 *v = scene.geometry.triangles[1].v;
        assert_true(v[0].x == (mode == 5 ? 1 : 0) && v[1].y == (mode == 5 ? 0 : 1));
        assert_true(v[2].y == (mode == 5 ? 1 : 0));
    }
}

/* A turn about z whose cosine is 0.28 and whose sine is 0.96; the name of the file has a blank. */
RT_TEST(steps_of_a_gltf_node_and_a_buffer_in_a_file_are_read) {
    static const char document[] =
        "{\"asset\":{\"version\":\"2.0\"},\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"children\":[1],"
        "\"translation\":[0,0,7]},{\"mesh\":0,\"scale\":[2,1,1],\"rotation\":[0,0,0.6,0.8],"
        "\"translation\":[0,0,1]}],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}],"
        "\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"}],"
        "\"bufferViews\":[{\"buffer\":0,\"byteLength\":36}],"
        "\"buffers\":[{\"byteLength\":36,\"uri\":\"test_mesh%20buffer.bin\"}]}";
    static const float triangle[3][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    write_bytes(RT_BINARY_DIR "/test_mesh buffer.bin", triangle, sizeof triangle);
    OWNED_SCENE scene = scene_of(RT_BINARY_DIR "/test_mesh_scene.gltf", document);
    const RtVec3 *v = scene.geometry.triangles[0].v;
    assert_true(v[0].z == 8 && fabsf(v[1].x - 0.56f) < 1e-6f && fabsf(v[1].y - 1.92f) < 1e-6f);
    assert_true(fabsf(v[2].x + 0.96f) < 1e-6f && fabsf(v[2].y - 0.28f) < 1e-6f);
}

RT_TEST(normals_come_back_from_ply_and_glb) {
    static const char *const names[] = {PLY_NAME, RT_BINARY_DIR "/test_mesh.glb"};
    OWNED_SCENE scene =
        scene_of(OBJ_NAME, "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nvn 1 0 0\nf 1//1 2//2 3//1\nf 1 3 2\n");
    for (size_t i = 0; i < 2; i++) {
        assert_ok(rt_scene_save(&scene, names[i], error));
        OWNED_SCENE again = open_scene(names[i]);
        assert_int_equal(again.geometry.vertex_normal_count, 2);
        assert_memory_equal(again.geometry.vertex_normals, scene.geometry.vertex_normals,
                            sizeof(RtVertexNormals));
        assert_true(again.geometry.vertex_normals[1].n[2].z == -1); /* of the triangle without its own */
    }
}

RT_TEST(a_text_stl_is_read_whatever_its_normals_say) {
    OWNED_SCENE scene =
        scene_of(RT_BINARY_DIR "/test_mesh.stl",
                 "solid a name # of words\nfacet normal nan nan nan\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n"
                 "vertex 0 1 0\nendloop\nendfacet\nendsolid a\nsolid\nfacet normal 0 0 -1\nouter loop\n"
                 "vertex 0 0 1\nvertex 1 0 1\nvertex 0 1 1\nendloop\nendfacet\nendsolid");
    assert_int_equal(scene.geometry.triangle_count, 2);
    assert_int_equal(scene.geometry.vertex_normal_count, 0);
    assert_true(rt_triangle_normal(&scene.geometry.triangles[1]).z == 1);
}

/* A strip of triangles; `blanks` end each line. If the faces of a PLY stand first, one more stands last. */
static RtScene strip_scene(bool ply, bool faces_first, int blanks) {
    enum { COUNT = 30000 };
    static const char *const lines[][2] = {{"v %d %d %d%*s\n", "f %d %d %d%*s\n"},
                                           {"%d %d %d%*s\n", "3 %d %d %d%*s\n"}};
    static const char *const elements[] = {
        "element vertex %d\nproperty float x\nproperty float y\nproperty float z\n",
        "element face %d\nproperty list uchar int vertex_indices\n"};
    const int order[2] = {faces_first, !faces_first}, counts[2] = {COUNT, COUNT - 2};
    const char *path = ply ? PLY_NAME : OBJ_NAME;
    FILE *out = fopen(path, "wb");
    assert_non_null(out);
    if (ply) fprintf(out, "ply\nformat ascii 1.0\n");
    for (int k = 0; ply && k < 2; k++) fprintf(out, elements[order[k]], counts[order[k]]);
    if (ply && faces_first) fprintf(out, "element tristrips 1\nproperty list int int vertex_indices\n");
    if (ply) fprintf(out, "end_header\n");
    for (int k = 0; k < 2; k++) {
        for (int i = 0; i < counts[order[k]]; i++) {
            const int first = i + !ply, corners[2][3] = {{i / 2, i % 2, 0}, {first, first + 1, first + 2}};
            const int *c = corners[order[k]];
            fprintf(out, lines[ply][order[k]], c[0], c[1], c[2], blanks, "");
        }
    }
    if (ply && faces_first) fprintf(out, "3 0 1 2\n");
    fclose(out);
    return open_scene(path);
}

RT_TEST(a_text_whose_memory_is_given_back_on_the_way_is_read_like_a_short_one) {
    for (int form = 0; form < 4; form++) {
        OWNED_SCENE scene = strip_scene(form & 1, form & 2, 300);
        OWNED_SCENE like = strip_scene(form & 1, form & 2, 0);
        assert_true(rt_scene_fingerprint(&scene) == rt_scene_fingerprint(&like));
    }
}

RT_TEST(a_text_takes_time_in_proportion_to_its_length_whatever_it_repeats) {
    enum { TIMES = 1 << 21 };
    static const char *const repeated[][2] = {{"# ", "x"},  {"", "#\n"}, {"o ", "x"},          {"o ", "x "},
                                              {"o ", "\\"}, {"", "\r"},  {"v 1 2 3 ", "\\\n"}, {"o", " "}};
    for (size_t i = 0; i < sizeof repeated / sizeof repeated[0]; i++) {
        FILE *out = fopen(OBJ_NAME, "wb");
        assert_non_null(out);
        fputs(repeated[i][0], out);
        for (int k = 0; k < TIMES; k++) fputs(repeated[i][1], out);
        fputs(" \nv 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\n", out);
        fclose(out);
        const double start = rt_thread_seconds();
        OWNED_SCENE scene = open_scene(OBJ_NAME);
        assert_true(rt_thread_seconds() - start < RT_SHARE(1, 10));
        assert_true(scene.geometry.triangles[0].v[1].x == 1);
    }
}

RT_TEST(every_failed_allocation_is_reported_and_leaves_nothing) {
    write_text(OBJ_NAME, "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nf 1//1 2//1 3//1\n");
    assert_failed_allocations_are_reported(OBJ_NAME);
    write_text(RT_BINARY_DIR "/test_mesh_scene.gltf", two_nodes);
    assert_failed_allocations_are_reported(RT_BINARY_DIR "/test_mesh_scene.gltf");
    OWNED_SCENE scene = open_scene(OBJ_NAME);
    assert_fails_cleanly(rt_scene_save(&scene, RT_BINARY_DIR "/test_mesh.ply", error), (void)0);
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

/* The reference results were counted over coordinates of exactly these bits. */
RT_TEST(the_meshes_of_the_reference_results_keep_their_coordinates) {
#define FETCHED(name) RT_SOURCE_DIR "/scenes/fetched/" name
    static const struct {
        const char *path;
        uint32_t triangles;
        uint64_t fingerprint;
    } meshes[] = {{BUNNY, 69666, UINT64_C(0xb27565264bb0051b)},
                  {FETCHED("dragon-11k.ply"), 11102, UINT64_C(0xbd05a7b72eb769bc)},
                  {FETCHED("dragon-48k.ply"), 47794, UINT64_C(0x4809219d82cf9138)},
                  {FETCHED("dragon-202k.ply"), 202520, UINT64_C(0x7ccfe2163d1c265f)},
                  {FETCHED("dragon-871k.ply"), 871414, UINT64_C(0x097785b69213daf4)}};
    for (size_t i = 0; i < sizeof meshes / sizeof meshes[0]; i++) {
        if (!rt_file_exists(meshes[i].path)) RT_SKIP("scenes/fetch.sh, for the meshes");
        OWNED_SCENE scene = open_scene(meshes[i].path);
        assert_int_equal(scene.geometry.triangle_count, meshes[i].triangles);
        assert_true(rt_scene_fingerprint(&scene) == meshes[i].fingerprint);
    }
}

RT_TESTS(mesh, NULL, NULL)
