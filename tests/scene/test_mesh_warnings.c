/* SPDX-License-Identifier: Apache-2.0 */
/* Meshes as other programs write them: what is odd but means one thing is read, and what was left out or
 * guessed is said once for each kind. */
#include "scene_testing.h"

#include "core/base/clock.h"
#include "core/scene/mesh.h"

typedef struct Odd {
    const char *extension, *text;
    uint32_t triangles;
    const char *warning; /* a part of the only one; NULL: there is none */
} Odd;

static const char *path_of(const char *extension) {
    static char path[256];
    snprintf(path, sizeof path, RT_BINARY_DIR "/test_mesh_warnings.%s", extension);
    return path;
}

static void assert_reads(const Odd *odd, size_t size) {
    RtScene scene;
    RtError failure;
    const RtStatus status = open_bytes(path_of(odd->extension), odd->text, size, &scene, &failure);
    if (status != RT_OK) fail_msg("%s: %s", odd->text, failure.message);
    if (scene.geometry.triangle_count != odd->triangles)
        fail_msg("%s: %u triangles, not %u", odd->text, scene.geometry.triangle_count, odd->triangles);
    const uint32_t count = scene.warnings.count;
    const char *said = count > 0 ? scene.warnings.list[0].message : "";
    if (count != (odd->warning != NULL) || (odd->warning && !strstr(said, odd->warning)))
        fail_msg("%s: %u warnings, the first: %s", odd->text, count, said);
    rt_scene_clear(&scene);
}

#define ASSERT_READS(cases)                                                                                  \
    for (size_t i = 0; i < sizeof(cases) / sizeof(cases)[0]; i++)                                            \
    assert_reads(&(cases)[i], strlen((cases)[i].text))

#define V3 "v 0 0 0\nv 1 0 0\nv 0 1 0\n"

RT_TEST(obj_of_other_programs_is_read) {
    static const Odd cases[] = {
        {"obj", V3 "f 1// 2// 3//\n", 1, NULL},
        {"obj", V3 "vt 0 0\nf 1/1/ 2/1/ 3/1/\n", 1, NULL},
        {"obj", V3 "vt 0 0\nf 1/ 2/ 3/\n", 1, NULL},
        {"obj", V3 "f 1 2\\\n3\n", 1, NULL},
        {"obj", V3 "f 1 \\\r\n2 \\\r\n3\r\n", 1, NULL},
        {"obj", "f 1 2 3\n" V3, 1, NULL},
        {"obj", "v 0 0 0\nf 1 2 3\nv 1 0 0\nv 0 1 0\nf -1 -2 -3\n", 2, NULL},
        {"obj", V3 "f 1 2 3", 1, "no line break"},
        {"obj", V3 "f 1 2 3\n\x1a", 1, "^Z"},
        {"obj", V3 "f 1//1 2//1 3//1\n", 1, "does not exist (normal 1)"},
        {"obj", V3 "f 1/0 2/0 3/0\n", 1, "does not exist (texture coordinate 0)"},
        {"obj", V3 "vn nan 0 0\nf 1//1 2//1 3//1\n", 1, "a normal is not finite"},
        {"obj", V3 "vt nan nan\nf 1/1 2/1 3/1\n", 1, NULL},
        {"obj", "v 0 0 0 2\nv 1 0 0 2\nv 0 1 0 1\nf 1 2 3\n", 1, "has a weight"},
        {"obj", V3 "f 1 2 3\nf 1 2\nf 1\n", 1, "face 1 (counted from 0) has 2 corners"},
        {"obj", V3 "cstype bezier\ncurv 0 1 1 2\nend\nf 1 2 3\n", 1, "curves"},
        {"obj", V3 "l 1 2\nf 1 2 3\n", 1, "points and lines"},
        {"obj", V3 "vendor_word 1 2\nf 1 2 3\n", 1, "'vendor_word'"},
        {"obj", V3 "vn 1.#QNAN -1.#IND 0\nf 1//1 2//1 3//1\n", 1, "a normal is not finite"},
        {"obj", V3 "mtllib C:\\\nf 1 2 3\n", 1, NULL},
        {"obj", V3 "f 1 \\\r2 \\\r3\r", 1, NULL},
        {"obj", V3 "v 1e39 0 0\nf 1 2 3\n", 1, "is not finite, or beyond float32"},
        {"obj", V3 "vn 0 0 1 7\nf 1//1 2//1 3//1\n", 1, "more than 3 numbers"},
    };
    ASSERT_READS(cases);
}

#define XYZ  "property float x\nproperty float y\nproperty float z\n"
#define FACE "property list uchar int vertex_indices\n"

RT_TEST(ply_of_other_programs_is_read) {
    static const Odd cases[] = {
        {"ply",
         "ply\nformat ascii 1.0\nelement face 1\n" FACE "element vertex 3\n" XYZ "end_header\n"
         "3 0 1 2\n0 0 0\n1 0 0\n0 1 0\n",
         1, NULL},
        {"ply",
         "ply\nformat ascii 1.0\nelement vertex 3\n" XYZ "property uchar red\nelement face 1\n" FACE
         "end_header\n0 0 0 255.0\n1 0 0 1.0\n0 1 0 2\n3.0 0 1 2\n",
         1, NULL},
        {"ply",
         "ply\nformat ascii 1.0\nelement vertex 3\n" XYZ "property float s\nelement face 1\n" FACE
         "end_header\n0 0 0 nan\n1 0 0 -nan\n0 1 0 inf\n3 0 1 2\n",
         1, "no finite number"},
        {"ply",
         "ply\nformat ascii 1.0\nelement vertex 4\n" XYZ "element tristrips 1\n" FACE
         "end_header\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n8 0 1 2 3 -1 0 1 2\n",
         3, NULL},
        {"ply",
         "ply\nformat ascii 1.0\nelement vertex 3\n" XYZ "element face 2\n" FACE
         "end_header\n0 0 0\n1 0 0\n0 1 0\n0\n3 0 1 2\n",
         1, "has 0 corners"},
        {"ply",
         "ply\nformat ascii 1.0\nelement vertex 3\n" XYZ "element face 1\n" FACE
         "end_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2",
         1, "no line break"},
        {"ply",
         "ply\nformat ascii 1.0\nCreated by hand\nelement vertex 3\n" XYZ "element face 1\n" FACE
         "end_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
         1, "is not PLY's is left out: 'Created'"},
        {"ply",
         "ply\nformat ascii 1.0\nelement vertex 3\n" XYZ "element face 1\n" FACE
         "property uchar red\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2 255 9 9\n",
         1, "more numbers than the header declares"},
        {"ply",
         "ply\nformat ascii 1.0\nelement vertex 3\n" XYZ "element face 1\n" FACE
         "element edge 1\nproperty int v\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n1\n",
         1, "are left out: edge"},
        {"ply",
         "ply\nformat ascii 1.0\nelement vertex 4\n" XYZ "element face 1\n" FACE
         "end_header\n0 0 0\nnan nan nan\n1 0 0\n0 1 0\n3 0 2 3\n",
         1, "vertex 1 (counted from 0) is not finite"},
    };
    ASSERT_READS(cases);
}

/* The first number begins with a byte that would be LF. */
RT_TEST(a_binary_ply_may_end_the_lines_of_its_header_with_cr_alone) {
    static const char binary[] = "ply\rformat binary_little_endian 1.0\relement vertex 3\r"
                                 "property uchar x\rproperty uchar y\rproperty uchar z\relement face 1\r"
                                 "property list uchar uchar vertex_index\rend_header\r"
                                 "\n\0\0\1\0\0\0\1\0\3\0\1\2";
    assert_reads(&(Odd){"ply", binary, 1, NULL}, sizeof binary - 1);
}

#define FACET "facet normal nan 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n"

RT_TEST(stl_and_off_of_other_programs_are_read) {
    static const Odd cases[] = {
        {"stl",
         "SOLID A\nFACET NORMAL 0 0 1\nOUTER LOOP\nVERTEX 0 0 0\nVERTEX 1 0 0\nVERTEX 0 1 0\nENDLOOP\n"
         "ENDFACET\nENDSOLID\n",
         1, NULL},
        {"stl", "  solid a\n" FACET "endloop\nendfacet\nendsolid a\n", 1, NULL},
        {"stl", "\xEF\xBB\xBFsolid a\n" FACET "endloop\nendfacet\nendsolid a\n", 1, NULL},
        {"stl", "solid a\n" FACET "end loop\nend facet\nend solid a\n", 1, NULL},
        {"off", "OFF3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", 1, NULL},
        {"off", "3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", 1, NULL},
        {"off", "STOFF\n3 1 0\n0 0 0 0 0\n1 0 0 0 1\n0 1 0 1 1\n3 0 1 2\n", 1, NULL},
        {"off",
         "STCNOFF\n3 1 0\n0 0 0 0 0 1 1 1 1 1 0 0\n1 0 0 0 0 1 1 1 1 1 0 0\n"
         "0 1 0 0 0 1 1 1 1 1 0 0\n3 0 1 2\n",
         1, NULL},
        {"off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2", 1, "no line break"},
        {"off", "OFF\n3 1 0\n0 0\n0\n1 0 0 9\n0 1 0\n3 0\n1 2\n", 1, "goes on in the next line"},
    };
    ASSERT_READS(cases);
    static const char binary[] = "OFF BINARY\n\0\0\0\3\0\0\0\1\0\0\0\0"
                                 "\0\0\0\0\0\0\0\0\0\0\0\0\x3f\x80\0\0\0\0\0\0\0\0\0\0"
                                 "\0\0\0\0\x3f\x80\0\0\0\0\0\0\0\0\0\3\0\0\0\0\0\0\0\1\0\0\0\2\0\0\0\0!";
    assert_reads(&(Odd){"off", binary, 1, NULL}, sizeof binary - 2);
    assert_reads(&(Odd){"off", binary, 1, "1 bytes more"}, sizeof binary - 1);
}

RT_TEST(what_cannot_be_read_says_what_to_do) {
    static const struct {
        const char *extension, *text, *says;
    } cases[] = {
        {"obj", "\xFF\xFEv", "UTF-16"},
        {"ply", "version https://git-lfs.github.com/spec/v1\noid sha256:0\n", "git lfs pull"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        RtScene scene;
        assert_bad_input(
            open_bytes(path_of(cases[i].extension), cases[i].text, strlen(cases[i].text), &scene, error),
            cases[i].says);
    }
}

/* ---- polygons ---- */

RT_TEST(polygons_that_cross_themselves_become_fans_with_a_warning) {
    static const Odd cases[] = {
        {"obj", "v 0 0 0\nv 2 2 0\nv 2 0 0\nv 0 3 0\nf 1 2 3 4\n", 2,
         "face 0 (counted from 0) crosses itself"},
        {"obj", "v 0 0 0\nv 2 2 0\nv 2 0 0\nv 0 2 0\nf 1 2 3 4\n", 2,
         "face 0 (counted from 0) crosses itself"},
    };
    ASSERT_READS(cases);
}

static double area_of(const RtScene *scene) {
    double area = 0;
    for (uint32_t i = 0; i < scene->geometry.triangle_count; i++) {
        const RtVec3 *v = scene->geometry.triangles[i].v;
        area += rt_lengthd(rt_area_vector(rt_widen(v[0]), rt_widen(v[1]), rt_widen(v[2]))) / 2;
    }
    return area;
}

/* Each from each of its corners. */
RT_TEST(polygons_that_touch_themselves_or_have_spikes_or_repeat_corners_keep_their_area) {
    static const struct {
        const char *corners[8];
        double area;
    } cases[] = {
        {{"0 0", "1 1", "2 0", "2 2", "1 1", "0 2"}, 2},
        {{"1 2", "3 1", "2 0", "3 1", "1 1"}, 1},
        {{"0 0", "2 0", "2 2", "1 2", "1 4", "1 2", "0 2"}, 4},
        {{"0 0", "2 0", "2 2", "1 2", "1 1", "1 2", "0 2"}, 4},
        {{"0 0", "3 0", "1 1", "1 1", "0 3"}, 3},
        {{"0 0", "4 0", "4 4", "0 4", "0 0", "1 2", "2 1", "0 0"}, 14.5},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        size_t count = 0;
        while (count < 8 && cases[i].corners[count]) count++;
        for (size_t first = 0; first < count; first++) {
            char text[400] = "";
            for (size_t k = 0; k < count; k++)
                sprintf(text + strlen(text), "v %s 0\n", cases[i].corners[(first + k) % count]);
            strcat(text, "f");
            for (size_t k = 1; k <= count; k++) sprintf(text + strlen(text), " %zu", k);
            strcat(text, "\n");
            OWNED_SCENE scene = scene_of(path_of("obj"), text);
            if (fabs(area_of(&scene) - cases[i].area) > 1e-6 || scene.warnings.count > 0)
                fail_msg("%s: area %g, not %g; %u warnings", text, area_of(&scene), cases[i].area,
                         scene.warnings.count);
            assert_int_equal(scene.geometry.triangle_count, count - 2);
        }
    }
}

/* The corners that are not convex lie close together, far from the others. */
RT_TEST(a_star_of_many_corners_is_divided_in_no_time) {
    enum { CORNERS = 20000 };
    FILE *out = fopen(path_of("obj"), "w");
    assert_non_null(out);
    for (int i = 0; i < CORNERS; i++) {
        const double angle = 6.283185307179586 * i / CORNERS, radius = i % 2 ? 1 : 0.01;
        fprintf(out, "v %.9g %.9g 0\n", radius * cos(angle), radius * sin(angle));
    }
    fprintf(out, "f");
    for (int i = 1; i <= CORNERS; i++) fprintf(out, " %d", i);
    fprintf(out, "\n");
    assert_int_equal(fclose(out), 0);
    const double start = rt_thread_seconds();
    OWNED_SCENE scene = open_scene(path_of("obj"));
    assert_true(rt_thread_seconds() - start < 5);
    assert_int_equal(scene.warnings.count, 0);
    assert_int_equal(scene.geometry.triangle_count, CORNERS - 2);
}

/* A strip that winds about the origin: its inner border, then its outer one backwards. */
RT_TEST(a_spiral_of_many_corners_is_divided_in_no_time) {
    enum { HALF = 20000 };
    FILE *out = fopen(path_of("obj"), "w");
    double expected = 0;
    assert_non_null(out);
    for (int i = 0; i < 2 * HALF; i++) {
        const int k = i < HALF ? i : 2 * HALF - 1 - i;
        const double angle = 0.05 * k, radius = 1 + angle + (i < HALF ? 2 : 0);
        fprintf(out, "v %.6f %.6f 0\n", radius * cos(angle), radius * sin(angle));
    }
    fprintf(out, "f");
    for (int i = 1; i <= 2 * HALF; i++) fprintf(out, " %d", i);
    fprintf(out, "\n");
    assert_int_equal(fclose(out), 0);
    const double start = rt_thread_seconds();
    OWNED_SCENE scene = open_scene(path_of("obj"));
    assert_true(rt_thread_seconds() - start < 5);
    assert_int_equal(scene.geometry.triangle_count, 2 * HALF - 2);
    assert_int_equal(scene.warnings.count, 0);
    for (int k = 0; k + 1 < HALF; k++) { /* of the quadrilaterals between the borders */
        const double a = 1 + 0.05 * k, b = 1 + 0.05 * (k + 1), turn = sin(0.05) / 2;
        expected += turn * ((a + 2) * (b + 2) - a * b);
    }
    assert_true(fabs(area_of(&scene) / expected - 1) < 1e-3);
}

RT_TEST(warnings_of_a_kind_are_counted_and_copied_into_a_scene_that_names_the_file) {
    write_text(path_of("obj"), V3 "f 1 2 3\nf 1 2\nf 2 3\nf 1 3\n");
    OWNED_SCENE scene =
        scene_of(RT_BINARY_DIR "/test_mesh_warnings.yaml",
                 "materials: [{name: m}]\nobjects: [{mesh: {path: test_mesh_warnings.obj, material: m}}]\n");
    char text[RT_WARNING_TEXT];
    assert_int_equal(scene.warnings.count, 1);
    assert_non_null(strstr(rt_warning_text(&scene.warnings.list[0], text), "(and 2 more like it)"));
    assert_non_null(strstr(text, "test_mesh_warnings.obj:5: "));
}

RT_TESTS(mesh_warnings, NULL, NULL)
