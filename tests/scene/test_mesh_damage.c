/* SPDX-License-Identifier: Apache-2.0 */
/* Damaged meshes: each is refused with what is wrong and where, in time and memory that its size bounds. */
#include "scene_testing.h"

#include "core/base/clock.h"
#include "core/base/file.h"
#include "core/base/random.h"
#include "core/scene/load.h"
#include "core/scene/mesh.h"

#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* The same file for all tests; `extension` is its format. */
static const char *path_of(const char *extension) {
    static char path[256];
    snprintf(path, sizeof path, RT_TEST_FOLDER "/mesh.%s", extension);
    return path;
}

/* Without the waits for the disk of rt_file_write, and of closing a file that was emptied. */
static void write_mesh(const char *extension, const void *bytes, size_t size) {
    remove(path_of(extension));
    FILE *file = fopen(path_of(extension), "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(bytes, 1, size, file), size);
    assert_int_equal(fclose(file), 0);
}

static RtStatus load_bytes(const char *extension, const void *bytes, size_t size, RtScene *scene,
                           RtError *error) {
    write_mesh(extension, bytes, size);
    return rt_scene_open(path_of(extension), scene, error);
}

typedef struct Damaged {
    const char *extension, *text, *place, *says; /* place: behind the path */
} Damaged;

static void assert_refused(const Damaged *cases, size_t count) {
    for (size_t i = 0; i < count; i++) {
        RtScene scene;
        char place[300];
        snprintf(place, sizeof place, "%s:%s ", path_of(cases[i].extension), cases[i].place);
        assert_bad_input_at(
            load_bytes(cases[i].extension, cases[i].text, strlen(cases[i].text), &scene, error), place,
            cases[i].says);
    }
}

#define ASSERT_REFUSED(cases) assert_refused(cases, sizeof(cases) / sizeof(cases)[0])

/* ---- one mesh in every format: two triangles of a square, with a normal at each vertex where possible ----
 */

#define OBJ "v 0 0 0\nv 1 0 0\nv 1 1 0.5\nv 0 1 0\nvn 0 0 1\nf 1//1 2//1 3//1\nf 1//1 3//1 4//1\n"
#define OFF "OFF\n4 2 0\n0 0 0\n1 0 0\n1 1 0.5\n0 1 0\n3 0 1 2\n3 0 2 3\n"
#define PLY_HEADER                                                                                           \
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"        \
    "element face 2\nproperty list uchar int vertex_indices\nend_header\n"
#define PLY_VERTICES "0 0 0\n1 0 0\n1 1 0.5\n0 1 0\n"
#define PLY          PLY_HEADER PLY_VERTICES "3 0 1 2\n3 0 2 3\n"
#define FACET(a, b, c)                                                                                       \
    "facet normal 0 0 1\nouter loop\nvertex " a "\nvertex " b "\nvertex " c "\nendloop\nendfacet\n"
#define STL                                                                                                  \
    "solid square\n" FACET("0 0 0", "1 0 0", "1 1 0.5") FACET("0 0 0", "1 1 0.5", "0 1 0") "endsolid\n"

/* A node over two triangles with indices of one byte; the parts in between differ in the tests. */
#define GLTF_PARTS(node, mesh, accessor0, count1, view1, buffer0, indices)                                   \
    "{\"asset\":{\"version\":\"2.0\"},\"scene\":0,\"scenes\":[{\"nodes\":[0]}],\"nodes\":[" node "],"        \
    "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"indices\":1" mesh "}]}],"               \
    "\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":4,\"type\":\"VEC3\"" accessor0 "},"   \
    "{\"bufferView\":1,\"componentType\":5121,\"count\":" count1 ",\"type\":\"SCALAR\"}],"                   \
    "\"bufferViews\":[{\"buffer\":0,\"byteLength\":48},{\"buffer\":1" view1 ",\"byteLength\":6}],"           \
    "\"buffers\":[{\"byteLength\":" buffer0 ",\"uri\":\"data:application/octet-stream;base64,"               \
    "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAACAPwAAgD8AAAA/AAAAAAAAgD8AAAAA\"},"                                   \
    "{\"byteLength\":6,\"uri\":\"data:;base64," indices "\"}]}"
#define NODE   "{\"mesh\":0}"
#define SQUARE "AAECAAID" /* 0 1 2 0 2 3 */
#define GLTF   GLTF_PARTS(NODE, "", "", "6", "", "48", SQUARE)

enum { TEXTS = 5, GLB = 5, BINARY_PLY, BINARY_STL, FORMATS, MOST_BYTES = 2000 };

static const char *const extensions[FORMATS] = {"obj", "off", "ply", "stl", "gltf", "glb", "ply", "stl"};
static const char *const texts[TEXTS] = {OBJ, OFF, PLY, STL, GLTF};

static struct Mesh {
    const char *extension;
    size_t size;
    char bytes[MOST_BYTES];
} whole[FORMATS];

/* The binary files are those that raytally writes. */
static int make_meshes(void **state) {
    (void)state;
    mkdir(RT_TEST_FOLDER, 0777);
    write_mesh("obj", OBJ, strlen(OBJ));
    OWNED_SCENE square = open_scene(path_of("obj"));
    for (size_t i = 0; i < FORMATS; i++) {
        char *bytes;
        if (i < TEXTS)
            write_mesh(extensions[i], texts[i], strlen(texts[i]));
        else
            assert_ok(rt_scene_save(&square, path_of(extensions[i]), true, error));
        assert_ok(rt_file_read(path_of(extensions[i]), MOST_BYTES, &bytes, &whole[i].size, error));
        memcpy(whole[i].bytes, bytes, whole[i].size);
        whole[i].extension = extensions[i];
        rt_free(bytes);
    }
    return 0;
}

static RtScene open_whole(const struct Mesh *mesh) {
    RtScene scene;
    assert_ok(load_bytes(mesh->extension, mesh->bytes, mesh->size, &scene, error));
    return scene;
}

static void assert_same_triangles(const RtScene *a, const RtScene *b) {
    assert_int_equal(a->geometry.triangle_count, 2);
    assert_memory_equal(a->geometry.triangles, b->geometry.triangles, 2 * sizeof(RtTriangle));
}

RT_TEST(the_square_is_the_same_in_every_format) {
    OWNED_SCENE first = open_whole(&whole[0]);
    for (size_t i = 1; i < FORMATS; i++) {
        OWNED_SCENE scene = open_whole(&whole[i]);
        assert_same_triangles(&scene, &first);
    }
}

/* An OBJ file has no end mark: cut between two lines, it is a valid file of fewer lines. */
static bool is_cut_between_lines(const struct Mesh *mesh, size_t size) {
    return strcmp(mesh->extension, "obj") == 0 && size > 0 && mesh->bytes[size - 1] == '\n';
}

RT_TEST(a_mesh_cut_anywhere_is_the_same_mesh_or_refused) {
    OWNED_SCENE square = open_whole(&whole[0]);
    for (size_t i = 0; i < FORMATS; i++) {
        const struct Mesh *mesh = &whole[i];
        for (size_t size = 0; size < mesh->size; size++) {
            OWNED_SCENE part;
            RtError problem;
            const RtStatus status = load_bytes(mesh->extension, mesh->bytes, size, &part, &problem);
            if (status != RT_OK)
                assert_int_equal(status, RT_BAD_INPUT);
            else if (!is_cut_between_lines(mesh, size))
                assert_same_triangles(&part, &square);
        }
    }
}

/* OBJ and glTF declare no number of triangles that a changed byte could contradict. */
RT_TEST(a_mesh_with_a_byte_changed_keeps_its_triangles_or_is_refused) {
    static const char values[] = {0, '\n', ' ', '1', '9', '-', 'f', '#', '/', '"', (char)0x80, (char)0xff};
    for (size_t i = 0; i < FORMATS; i++) {
        const bool counted = strcmp(whole[i].extension, "obj") != 0 && whole[i].extension[0] != 'g';
        struct Mesh changed = whole[i];
        for (size_t at = 0; at < changed.size; at++) {
            OWNED_SCENE scene;
            RtError problem;
            changed.bytes[at] = values[at * 7 % sizeof values];
            const RtStatus status =
                load_bytes(changed.extension, changed.bytes, changed.size, &scene, &problem);
            changed.bytes[at] = whole[i].bytes[at];
            if (status != RT_OK)
                assert_int_equal(status, RT_BAD_INPUT);
            else if (counted)
                assert_int_equal(scene.geometry.triangle_count, 2);
        }
    }
}

RT_TEST(a_mesh_with_any_bytes_changed_is_read_or_refused) {
    for (uint64_t run = 0; run < RT_SHARE(8000, 800); run++) {
        struct Mesh changed = whole[run % FORMATS];
        RtRandom random = rt_random(3, run);
        OWNED_SCENE scene;
        RtError problem;
        for (int k = 0; k < 4; k++)
            changed.bytes[rt_random_bits(&random) % changed.size] = (char)rt_random_bits(&random);
        const RtStatus status = load_bytes(changed.extension, changed.bytes, changed.size, &scene, &problem);
        assert_true(status == RT_OK || status == RT_BAD_INPUT);
    }
}

RT_TEST(line_ends_of_windows_do_not_matter) {
    OWNED_SCENE square = open_whole(&whole[0]);
    for (size_t i = 0; i < TEXTS; i++) {
        struct Mesh windows = {.extension = extensions[i]};
        for (const char *c = texts[i]; *c; c++) {
            if (*c == '\n') windows.bytes[windows.size++] = '\r';
            windows.bytes[windows.size++] = *c;
        }
        OWNED_SCENE scene = open_whole(&windows);
        assert_same_triangles(&scene, &square);
    }
}

/* ---- what is damaged, and where ---- */

RT_TEST(a_damaged_obj_is_refused_with_its_line) {
    static const Damaged cases[] = {
        {"obj", "", "", "no triangle"},
        {"obj", "v 0 0 0\nv 1 0 0\n", "", "no triangle"},
        {"obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nl 1 2\n", "", "no triangle"},
        {"obj", "v 0 0 0\nv nan 0 0\n", "2:", "expected a finite number that fits float32, found 'nan'"},
        {"obj", "v 0 0 0\nv 1e39 0 0\n", "2:", "found '1e39'"},
        {"obj", "v 0 0 0\nv 0x1 0 0\n", "2:", "found '0x1'"},
        {"obj", "v 0 0 0\nv . 0 0\n", "2:", "found '.'"},
        {"obj", "v 0 0 0\nv 1e 0 0\n", "2:", "found '1e'"},
        {"obj", "v 0 0 0\nv 0 0\nv 0 1 0\n",
         "2:", "expected the x y z of a vertex, found the end of the line"},
        {"obj", "v 0 0 0 v 1 0 0\n", "1:", "found 'v'"},
        {"obj", "v 0 0 0 2\n", "1:", "a weight of 2"},
        {"obj", "vn 0 0 1 1\n", "1:", "a normal has 3 numbers"},
        {"obj", "v 0 0 0\nv 1e30 0 0\nv 0 1 0\nf 1 2 3\n", "4:", "exceeds"},
        {"obj", "v 0 0 0\nv 1 0 0\nf 1 2 9\n", "3:", "names vertex 9, but there are 2 so far"},
        {"obj", "v 0 0 0\nv 1 0 0\nf 1 2 0\n", "3:", "names vertex 0"},
        {"obj", "v 0 0 0\nv 1 0 0\nf 1 2 -3\n", "3:", "names vertex -3"},
        {"obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3 99999999999999999999\n", "4:", "expected an integer"},
        {"obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1//1 2 3\n", "4:", "names normal 1, but there are 0"},
        {"obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1/1 2 3\n", "4:", "names texture coordinate 1"},
        {"obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1/ 2 3\n", "4:", "expected v, v/vt, v//vn or v/vt/vn"},
        {"obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1/// 2 3\n", "4:", "expected v, v/vt, v//vn or v/vt/vn"},
        {"obj", "v 0 0 0\nv 1 0 0\nf 1 2\n", "3:", "has 2 vertices: a polygon has at least 3"},
        {"obj", "v 0 0 0\nsurf 0 1 0 1\n", "2:", "expected a statement of a polygon mesh"},
        {"obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3", "4:", "the last line has no line break"},
    };
    ASSERT_REFUSED(cases);
}

RT_TEST(a_damaged_ply_is_refused_with_its_line) {
#define HEADER_OF(lines) "ply\nformat ascii 1.0\n" lines "end_header\n"
#define XYZ              "property float x\nproperty float y\nproperty float z\n"
    static const Damaged cases[] = {
        {"ply", "", "1:", "a PLY file begins with a line 'ply'"},
        {"ply", PLY_HEADER PLY_VERTICES "3 0 1 2\n", "14:", "ends after 1 of the 2 faces"},
        {"ply", PLY_HEADER "0 0 0\n", "10:", "ends after 1 of the 4 vertices"},
        {"ply", PLY_HEADER PLY_VERTICES "3 0 1 2\n3 0 2", "15:", "found the end of the file"},
        {"ply", PLY_HEADER PLY_VERTICES "3 0 1 2\n3 0 2 3", "15:", "no line break"},
        {"ply", PLY "3 0 2 3\n", "16:", "expected the end of the file, found '3'"},
        {"ply", PLY_HEADER "0 0\n1 0 0\n", "10:", "found the end of the line"},
        {"ply", PLY_HEADER "0 0 0 1\n", "10:", "expected the end of the line, found '1'"},
        {"ply", PLY_HEADER PLY_VERTICES "4 0 1 2 99999999\n",
         "14:", "names vertex 99999999, but there are 4"},
        {"ply", PLY_HEADER PLY_VERTICES "5 0 1 2 0 -1\n", "14:", "names vertex -1"},
        {"ply", PLY_HEADER PLY_VERTICES "0\n", "14:", "has 0 vertices"},
        {"ply", PLY_HEADER PLY_VERTICES "-3 0 1 2\n", "14:", "a list has -3 numbers"},
        {"ply",
         HEADER_OF(
             "element vertex 3\n" XYZ
             "element face 1\nproperty list float int vertex_index\n") "0 0 0\n1 0 0\n0 1 0\n3.5 0 1 2\n",
         "13:", "a list has 3.5 numbers"},
        {"ply", PLY_HEADER "0 0 inf\n", "10:", "expected a finite number"},
        {"ply", HEADER_OF("element vertex 4000000000\n" XYZ),
         "7:", "ends after 0 of the 4000000000 vertices"},
        {"ply", HEADER_OF("element vertex -1\n" XYZ), "3:", "a count of at least 0"},
        {"ply", HEADER_OF("element none 999999999999\n"), "", "no triangle"},
        {"ply", HEADER_OF("element vertex 1\nproperty float x\n"), "5:", "lacks a property x, y or z"},
        {"ply", HEADER_OF("element vertex 1\n" XYZ "element face 1\n"), "8:", "lacks a list vertex_indices"},
        {"ply", HEADER_OF("element face 1\nproperty list uchar int vertex_index\n"),
         "5:", "must come before"},
        {"ply", HEADER_OF("property float x\n"), "3:", "without an element"},
        {"ply", HEADER_OF("element vertex 1\nproperty real x\n"), "4:", "expected a type"},
        {"ply", HEADER_OF("element vertex 1\nproperty float x\nproperty int x\n"), "5:", "twice"},
        {"ply", HEADER_OF("elements vertex 1\n"), "3:", "expected format, element, property"},
        {"ply", "ply\nend_header\n", "2:", "no line 'format'"},
        {"ply", "ply\nformat ascii 2.0\n", "2:", "version 1.0"},
        {"ply", "ply\nformat text 1.0\n", "2:", "expected ascii, binary_little_endian"},
        {"ply", "ply\nformat ascii 1.0\n", "2:", "expected end_header, found the end of the file"},
    };
    ASSERT_REFUSED(cases);
}

RT_TEST(a_ply_without_a_line_break_behind_its_header_is_refused) {
    static const Damaged cases[] = {
        {"ply", "ply\nformat ascii 1.0\nelement vertex 3\n" XYZ "end_header",
         "7:", "no line break behind end_header"},
        {"ply", "ply\nformat binary_little_endian 1.0\nelement vertex 3\n" XYZ "end_header",
         "7:", "no line break behind end_header"},
        {"ply", "ply\nformat binary_big_endian 1.0\nelement vertex 3\n" XYZ "end_header\r",
         "7:", "no line break behind end_header"},
    };
    ASSERT_REFUSED(cases);
}

RT_TEST(a_ply_of_many_elements_or_properties_is_refused) {
    static char text[100000];
    static const char *const lines[] = {"element e 0\n", "property int p\n"};
    static const char *const says[] = {"more than 16 kinds of elements", "more than 256 properties"};
    for (int i = 0; i < 2; i++) {
        RtScene scene;
        strcpy(text, "ply\nformat ascii 1.0\nelement vertex 0\n");
        for (int k = 0; k < 1000; k++) strcat(text, lines[i]);
        assert_bad_input(load_bytes("ply", text, strlen(text), &scene, error), says[i]);
    }
}

RT_TEST(a_damaged_stl_is_refused) {
    static const Damaged cases[] = {
        {"stl", "", "", "no STL file"},
        {"stl", "solid\nfacet", "2:", "expected 'normal', found the end of the file"},
        {"stl", "solid\n" FACET("0 0 0", "1 0 0", "0 1 0"),
         "9:", "expected 'endsolid', found the end of the file"},
        {"stl", "solid\n" FACET("0 0 0", "1 0 0", "0 1") "endsolid\n", "6:", "found the end of the line"},
        {"stl", "solid\n" FACET("0 0 0", "1 0 0", "0 nan 0") "endsolid\n", "6:", "found 'nan'"},
        {"stl", "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nendloop\n",
         "6:", "expected 'vertex', found 'endloop'"},
        {"stl", "solid\nendsolid\n", "", "no triangle"},
        {"stl", STL "facet\n", "17:", "expected 'solid', found 'facet'"},
        {"stl",
         "a text of more than eighty-four bytes that is neither kind of STL, however long it may be, at all",
         "", "the header declares"},
    };
    ASSERT_REFUSED(cases);
}

RT_TEST(a_damaged_off_is_refused_with_its_line) {
    static const Damaged cases[] = {
        {"off", "", "1:", "expected OFF, COFF, NOFF or CNOFF, found the end of the file"},
        {"off", "OFF\n4 2\n", "3:", "expected the numbers of vertices, faces and edges"},
        {"off", "OFF\n4000000000 1 0\n0 0 0\n", "3:", "ends after 1 of the 4000000000 vertices"},
        {"off", "OFF\n3 2 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", "6:", "ends after 1 of the 2 faces"},
        {"off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n", "6:", "names vertex 3, but there are 3"},
        {"off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n4 0 1 2\n", "6:", "found the end of the file"},
        {"off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n3 0 1 2\n", "7:", "expected the end of the file"},
        {"off", "OFF\n-3 1 0\n", "2:", "a count of at least 0"},
        {"off", "OFF\n3 1 0\n0 0\n1 0 0\n", "3:", "found the end of the line"},
    };
    ASSERT_REFUSED(cases);
}

RT_TEST(a_damaged_gltf_is_refused_with_what_is_wrong) {
    static const Damaged cases[] = {
        {"gltf", "", "1:", "'[' or '{' expected"},
        {"gltf", "{\"asset\":{\"version\":\"1.0\"}}", "", "expected glTF 2.0"},
        {"gltf", "{\"asset\":{\"version\":\"2.0\"}}", "", "the file names scenes[0], but there are 0"},
        {"gltf", "{\"asset\":{\"version\":\"2.0\"},\"extensionsRequired\":[\"KHR_draco_mesh_compression\"]}",
         "", "requires the extension 'KHR_draco_mesh_compression'"},
        {"gltf", GLTF_PARTS(NODE, "", "", "6", "", "48", "AAECAAIE"), "", "names vertex 4, but there are 4"},
        {"gltf", GLTF_PARTS("{\"mesh\":1}", "", "", "6", "", "48", SQUARE), "", "a node names meshes[1]"},
        {"gltf", GLTF_PARTS("{\"children\":[0]}", "", "", "6", "", "48", SQUARE), "",
         "nodes[0]: it is named twice"},
        {"gltf", GLTF_PARTS("{\"children\":[9]}", "", "", "6", "", "48", SQUARE), "",
         "a node names nodes[9]"},
        {"gltf", GLTF_PARTS("{\"matrix\":[1,2]}", "", "", "6", "", "48", SQUARE), "", "a list of 16 numbers"},
        {"gltf", GLTF_PARTS("{\"mesh\":0,\"scale\":[1e300,1,1]}", "", "", "6", "", "48", SQUARE), "",
         "not a finite"},
        {"gltf", GLTF_PARTS(NODE, "", ",\"sparse\":{}", "6", "", "48", SQUARE), "",
         "accessors[0]: it is sparse"},
        {"gltf", GLTF_PARTS(NODE, "", ",\"byteOffset\":1", "6", "", "48", SQUARE), "",
         "do not fit into the 48 bytes"},
        {"gltf", GLTF_PARTS(NODE, "", "", "9", "", "48", SQUARE), "",
         "its 9 elements do not fit into the 6 bytes"},
        {"gltf", GLTF_PARTS(NODE, "", "", "4000000000", "", "48", SQUARE), "", "do not fit"},
        {"gltf", GLTF_PARTS(NODE, "", "", "4611686018427387904", "", "48", SQUARE), "", "expected count"},
        {"gltf", GLTF_PARTS(NODE, "", "", "5", "", "48", SQUARE), "",
         "a primitive of triangles has 5 corners"},
        {"gltf", GLTF_PARTS(NODE, ",\"mode\":7", "", "6", "", "48", SQUARE), "", "expected mode"},
        {"gltf", GLTF_PARTS(NODE, ",\"mode\":1", "", "6", "", "48", SQUARE), "", "no triangle"},
        {"gltf", GLTF_PARTS(NODE, "", "", "6", ",\"byteOffset\":1", "48", SQUARE), "",
         "bufferViews[1]: it ends at byte 7 of a buffer of 6 bytes"},
        {"gltf", GLTF_PARTS(NODE, "", "", "6", ",\"byteStride\":-1", "48", SQUARE), "",
         "expected byteStride"},
        {"gltf", GLTF_PARTS(NODE, "", "", "6", "", "49", SQUARE), "",
         "buffers[0]: it declares 49 bytes, but has 48"},
        {"gltf", GLTF_PARTS(NODE, "", "", "6", "", "48", "AAECAA"), "",
         "buffers[1]: it declares 6 bytes, but has 4"},
        {"gltf", GLTF_PARTS(NODE, "", "", "6", "", "48", "AAEC*AID"), "",
         "buffers[1]: its base64 is damaged"},
        {"gltf",
         "{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"byteLength\":1,\"uri\":\"http://x.org/a\"}]}", "",
         "'http://x.org/a' is not a file"},
        {"gltf", "{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"byteLength\":1}]}", "", "expected uri"},
    };
    ASSERT_REFUSED(cases);
    RtScene scene;
    static const char missing[] =
        "{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"byteLength\":1,\"uri\":\"no%20file\"}]}";
    assert_bad_input_at(load_bytes("gltf", missing, strlen(missing), &scene, error),
                        RT_TEST_FOLDER "/no file: ", "No such file");
}

/* Deeper than the stack, if it followed them. */
RT_TEST(deeply_nested_gltf_is_refused) {
    enum { NODES = 100000 };
    static char text[40 * NODES];
    RtScene scene;
    size_t size =
        (size_t)sprintf(text, "{\"asset\":{\"version\":\"2.0\"},\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{}");
    for (int i = 1; i < NODES; i++) size += (size_t)sprintf(text + size - 2, "{\"children\":[%d]},{}", i) - 2;
    strcpy(text + size, "]}");
    assert_bad_input(load_bytes("gltf", text, size + 2, &scene, error),
                     "nodes[256]: it is more than 256 levels deep");
    memset(text, '[', sizeof text);
    assert_bad_input(load_bytes("gltf", text, sizeof text, &scene, error), "maximum parsing depth reached");
}

RT_TEST(the_sizes_that_a_binary_file_declares_must_be_its_own) {
    static const struct {
        size_t mesh, at; /* the byte that grows by 1 */
        const char *says;
    } cases[] = {
        {GLB, 4, "this is glTF 3: only 2 can be read"},
        {GLB, 8, "bytes, but the file has"},
        {GLB, 12, "expected a chunk BIN"}, /* the length of the JSON */
        {BINARY_STL, 80, "the header declares 3 triangles, which take 234 bytes, but the file has 184"},
        {BINARY_PLY, 51, "face 0 (counted from 0) has 0 vertices"}, /* the number of vertices */
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct Mesh changed = whole[cases[i].mesh];
        RtScene scene;
        changed.bytes[cases[i].at]++;
        assert_bad_input(load_bytes(changed.extension, changed.bytes, changed.size, &scene, error),
                         cases[i].says);
    }
}

RT_TEST(bytes_behind_the_end_of_a_binary_file_are_refused) {
    static const size_t meshes[] = {GLB, BINARY_PLY, BINARY_STL};
    for (size_t i = 0; i < 3; i++) {
        struct Mesh longer = whole[meshes[i]];
        RtScene scene;
        longer.size++;
        assert_bad_input(load_bytes(longer.extension, longer.bytes, longer.size, &scene, error), "declares");
    }
}

RT_TEST(a_byte_of_zero_is_refused_in_text_with_its_place) {
    static const char *const names[] = {"obj", "off", "gltf", "nff"};
    for (size_t i = 0; i < 4; i++) {
        RtScene scene;
        char place[300];
        snprintf(place, sizeof place, "%s:2:3: ", path_of(names[i]));
        assert_bad_input_at(load_bytes(names[i], "# x\nv \0", 7, &scene, error), place, "a byte of 0");
    }
}

/* They take no space on the disk. */
RT_TEST(a_gigabyte_of_zeros_is_refused_soon) {
    static const char *const names[] = {"obj", "off", "gltf", "ply", "stl", "glb", "nff", "yaml"};
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        const char *path = path_of(names[i]);
        RtScene scene;
        write_mesh(names[i], "", 0);
        assert_int_equal(truncate(path, 1000000000), 0);
        const double start = rt_thread_seconds();
        assert_bad_input_at(rt_scene_open(path, &scene, error), path, "");
        assert_true(rt_thread_seconds() - start < RT_SHARE(1, 10));
        remove(path);
    }
}

RT_TEST(a_polygon_of_many_corners_is_read_or_refused_soon) {
    enum { CORNERS = 99999 };
    static char text[60 * CORNERS];
    for (int concave = 0; concave < 2; concave++) {
        RtScene scene;
        RtError problem;
        size_t size = 0;
        for (int i = 0; i < CORNERS; i++)
            size += (size_t)sprintf(text + size, "v %d %.1f 0\n", i, concave ? i % 2 : (double)i * i);
        size += (size_t)sprintf(text + size, "f");
        for (int i = 1; i <= CORNERS; i++) size += (size_t)sprintf(text + size, " %d", i);
        size += (size_t)sprintf(text + size, "\n");
        const double start = rt_wall_seconds();
        const RtStatus status = load_bytes("obj", text, size, &scene, &problem);
        assert_int_equal(status, concave ? RT_BAD_INPUT : RT_OK);
        if (concave) assert_non_null(strstr(problem.message, "more than 1000: split it"));
        assert_true(rt_wall_seconds() - start < RT_SHARE(2, 20));
        rt_scene_clear(&scene);
    }
}

RT_TESTS(mesh_damage, make_meshes, assert_nothing_is_kept)
