/* SPDX-License-Identifier: Apache-2.0 */
/* Damaged meshes: each is refused with what is wrong and where, in time and memory that its size bounds. */
#include "scene_testing.h"

#include "core/base/clock.h"
#include "core/base/file.h"
#include "core/base/random.h"
#include "core/scene/load.h"
#include "core/scene/mesh.h"

#include <sys/stat.h>

/* The same file for all tests; `extension` is its format. */
static const char *path_of(const char *extension) {
    static char path[256];
    snprintf(path, sizeof path, RT_TEST_FOLDER "/mesh.%s", extension);
    return path;
}

static RtStatus load_bytes(const char *extension, const void *bytes, size_t size, RtScene *scene,
                           RtError *error) {
    return open_bytes(path_of(extension), bytes, size, scene, error);
}

typedef struct Damaged {
    const char *text, *place, *says; /* place: behind the path */
} Damaged;

static void assert_refused(const char *extension, const Damaged *cases, size_t count) {
    for (size_t i = 0; i < count; i++) {
        RtScene scene;
        char place[300];
        snprintf(place, sizeof place, "%s:%s ", path_of(extension), cases[i].place);
        assert_bad_input_at(load_bytes(extension, cases[i].text, strlen(cases[i].text), &scene, error), place,
                            cases[i].says);
    }
}

#define ASSERT_REFUSED(extension, cases) assert_refused(extension, cases, sizeof(cases) / sizeof(cases)[0])

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

/* A node over two triangles, 0 1 2 and 0 2 3, with indices of one byte. */
#define ASSET "{\"asset\":{\"version\":\"2.0\"}"
#define GLTF                                                                                                 \
    ASSET ",\"scene\":0,\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"mesh\":0}],"                              \
          "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"indices\":1}]}],"                 \
          "\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":4,\"type\":\"VEC3\"},"          \
          "{\"bufferView\":1,\"componentType\":5121,\"count\":6,\"type\":\"SCALAR\"}],"                      \
          "\"bufferViews\":[{\"buffer\":0,\"byteLength\":48},{\"buffer\":1,\"byteLength\":6}],"              \
          "\"buffers\":[{\"byteLength\":48,\"uri\":\"data:application/octet-stream;base64,"                  \
          "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAACAPwAAgD8AAAA/AAAAAAAAgD8AAAAA\"},"                             \
          "{\"byteLength\":6,\"uri\":\"data:;base64,AAECAAID\"}]}"

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
    OWNED_SCENE square = scene_of(path_of("obj"), OBJ);
    for (size_t i = 0; i < FORMATS; i++) {
        OWNED_MEMORY char *bytes;
        if (i < TEXTS)
            write_text(path_of(extensions[i]), texts[i]);
        else
            assert_ok(rt_scene_save(&square, path_of(extensions[i]), error));
        assert_ok(rt_file_read(path_of(extensions[i]), MOST_BYTES, &bytes, &whole[i].size, error));
        memcpy(whole[i].bytes, bytes, whole[i].size);
        whole[i].extension = extensions[i];
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

RT_TEST(a_mesh_cut_anywhere_is_the_same_mesh_or_refused_or_warned_of) {
    OWNED_SCENE square = open_whole(&whole[0]);
    for (size_t i = 0; i < FORMATS; i++) {
        const struct Mesh *mesh = &whole[i];
        for (size_t size = 0; size < mesh->size; size++) {
            OWNED_SCENE part;
            RtError problem;
            const RtStatus status = load_bytes(mesh->extension, mesh->bytes, size, &part, &problem);
            if (status != RT_OK)
                assert_int_equal(status, RT_BAD_INPUT);
            else if (part.warnings.count == 0 && !is_cut_between_lines(mesh, size))
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
        for (int k = 0; k < 4; k++)
            changed.bytes[rt_random_bits(&random) % changed.size] = (char)rt_random_bits(&random);
        assert_read_or_refused(path_of(changed.extension), changed.bytes, changed.size);
    }
}

RT_TEST(line_ends_of_windows_do_not_matter) {
    OWNED_SCENE square = open_whole(&whole[0]);
    for (size_t i = 0; i < TEXTS; i++) {
        struct Mesh windows = {.extension = extensions[i]};
        windows.size = as_in_windows(texts[i], windows.bytes);
        OWNED_SCENE scene = open_whole(&windows);
        assert_same_triangles(&scene, &square);
    }
}

/* ---- what is damaged, and where ---- */

RT_TEST(a_damaged_obj_is_refused_with_its_line) {
    static const Damaged cases[] = {
        {"", "", "no triangle"},
        {"v 0 0 0\nv 1 0 0\n", "", "no triangle"},
        {"v 0 0 0\nv 1 0 0\nv 0 1 0\nl 1 2\n", "", "no triangle"},
        {"v 0 0 0\nv nan 0 0\nv 0 1 0\nf 1 2 3\n", "4:", "face 0 uses vertex 1, which is not finite"},
        {"v 0 0 0\nv 1e39 0 0\nv 0 1 0\nf 1 2 3\n", "4:", "face 0 uses vertex 1, which is not finite"},
        {"v 0 0 0\nv 0 0\nv 0 1 0\n", "2:", "expected the x y z of a vertex, found the end of the line"},
        {"v 0 0 0\nv 1e30 0 0\nv 0 1 0\nf 1 2 3\n", "4:", "exceeds"},
        {"v 0 0 0\nv 1 0 0\nf 1 2 9\n", "3:", "names vertex 9, but there are 2"},
        {"v 0 0 0\nv 1 0 0\nf 1 2 0\n", "3:", "names vertex 0"},
        {"v 0 0 0\nv 1 0 0\nf 1 2 -3\n", "3:", "names vertex -3"},
        {"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3 99999999999999999999\n", "4:", "expected an integer"},
        {"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1/// 2 3\n", "4:", "expected v, v/vt, v//vn or v/vt/vn"},
    };
    ASSERT_REFUSED("obj", cases);
}

RT_TEST(what_is_no_decimal_number_is_refused) {
    static const char *const words[] = {".",    "-",   "+-1", "e5", "1e",  "1e+",
                                        "1.5.", "0x1", "1,5", "1f", "--1", "1e5."};
    for (size_t i = 0; i < sizeof words / sizeof words[0]; i++) {
        RtScene scene;
        char text[32], found[32];
        snprintf(text, sizeof text, "v 0 0 %s\n", words[i]);
        snprintf(found, sizeof found, "found '%s'", words[i]);
        assert_bad_input(load_bytes("obj", text, strlen(text), &scene, error), found);
    }
}

RT_TEST(a_damaged_ply_is_refused_with_its_line) {
#define HEADER_OF(lines) "ply\nformat ascii 1.0\n" lines "end_header\n"
#define XYZ              "property float x\nproperty float y\nproperty float z\n"
#define VERTICES(kind)   "ply\nformat " kind " 1.0\nelement vertex 3\n" XYZ
    static const Damaged cases[] = {
        {"", "1:", "a PLY file begins with a line 'ply'"},
        {PLY_HEADER PLY_VERTICES "3 0 1 2\n", "14:", "ends after 1 of the 2 faces"},
        {PLY_HEADER "0 0 0\n", "10:", "ends after 1 of the 4 vertices"},
        {PLY_HEADER PLY_VERTICES "3 0 1 2\n3 0 2", "15:", "found the end of the file"},
        {PLY "3 0 2 3\n", "16:", "expected the end of the file, found '3'"},
        {PLY_HEADER "0 0\n1 0 0\n", "10:", "found the end of the line"},
        {PLY_HEADER "0 0 0 1 0 0\n", "10:", "ends after 1 of the 4 vertices"},
        {PLY_HEADER PLY_VERTICES "4 0 1 2 99999999\n", "14:", "names vertex 99999999, but there are 4"},
        {PLY_HEADER PLY_VERTICES "5 0 1 2 0 -1\n", "14:", "names vertex -1"},
        {PLY_HEADER PLY_VERTICES "-3 0 1 2\n", "14:", "a list has -3 numbers"},
        {HEADER_OF(
             "element vertex 3\n" XYZ
             "element face 1\nproperty list float int vertex_index\n") "0 0 0\n1 0 0\n0 1 0\n3.5 0 1 2\n",
         "13:", "a list has 3.5 numbers"},
        {PLY_HEADER "0 0 inf\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 3\n",
         "14:", "face 0 uses vertex 0, which is not finite"},
        {PLY_HEADER PLY_VERTICES "3 0 1 2 3\n", "14:", "behind as many indices as it says, found '3'"},
        {HEADER_OF("element vertex 1\nPROPERTY float q\n" XYZ), "4:", "expected property, element"},
        {HEADER_OF("element vertex 4000000000\n" XYZ), "7:", "ends after 0 of the 4000000000 vertices"},
        {HEADER_OF("element vertex -1\n" XYZ), "3:", "a count of at least 0"},
        {HEADER_OF("element none 999999999999\n"), "4:", "there must be one element 'vertex', not 0"},
        {HEADER_OF("element vertex 1\nproperty float x\n"), "5:", "lacks a property x, y or z"},
        {HEADER_OF("element vertex 1\n" XYZ "element face 1\n"), "8:", "lacks a list vertex_indices"},
        {HEADER_OF("element face 1\nproperty list uchar int vertex_index\n"),
         "5:", "must be one element 'vertex', not 0"},
        {HEADER_OF("property float x\n"), "3:", "without an element"},
        {HEADER_OF("element vertex 1\nproperty real x\n"), "4:", "expected a type"},
        {HEADER_OF("element vertex 1\nproperty float x\nproperty int x\n"), "5:", "twice"},
        {"ply\nend_header\n", "2:", "no line 'format'"},
        {"ply\nformat ascii 2.0\n", "2:", "version 1.0"},
        {"ply\nformat text 1.0\n", "2:", "expected ascii, binary_little_endian"},
        {"ply\nformat ascii 1.0\n", "2:", "expected end_header, found the end of the file"},
        {VERTICES("ascii") "end_header", "7:", "no line break behind end_header"},
        {VERTICES("binary_little_endian") "end_header", "7:", "no line break behind end_header"},
        {VERTICES("binary_big_endian") "end_header\r", "7:", "no line break behind end_header"},
    };
    ASSERT_REFUSED("ply", cases);
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
        {"", "", "no STL file"},
        {"solid\nfacet", "2:", "expected 'normal', found the end of the file"},
        {"solid\n" FACET("0 0 0", "1 0 0", "0 1 0"), "9:", "expected 'endsolid', found the end of the file"},
        {"solid\n" FACET("0 0 0", "1 0 0", "0 1") "endsolid\n", "6:", "found the end of the line"},
        {"solid\n" FACET("0 0 0", "1 0 0", "0 nan 0") "endsolid\n",
         "8:", "face 0 uses vertex 2, which is not finite"},
        {"solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nendloop\n",
         "6:", "expected 'vertex', found 'endloop'"},
        {"solid\nendsolid\n", "", "no triangle"},
        {STL "facet\n", "17:", "expected 'solid', found 'facet'"},
        {"a text of more than eighty-four bytes that is neither kind of STL, however long it may be, at all",
         "", "it does not begin with 'solid'"},
    };
    ASSERT_REFUSED("stl", cases);
}

RT_TEST(a_damaged_off_is_refused_with_its_line) {
    static const Damaged cases[] = {
        {"", "1:", "expected OFF, or it with ST, C and N before it, found the end of the file"},
        {"OFF\n4 2\n", "3:", "expected the numbers of vertices, faces and edges"},
        {"OFF\n4000000000 1 0\n0 0 0\n", "3:", "ends after 1 of the 4000000000 vertices"},
        {"OFF\n3 2 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", "6:", "ends after 1 of the 2 faces"},
        {"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n", "6:", "names vertex 3, but there are 3"},
        {"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n4 0 1 2\n", "6:", "found the end of the file"},
        {"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n3 0 1 2\n", "7:", "expected the end of the file"},
        {"OFF\n-3 1 0\n", "2:", "a count of at least 0"},
        {"OFF\n3 1 0\n0 0\n1 0 0\n0 1 0\n3 0 1 2\n", "6:", "ends after 0 of the 1 faces"},
    };
    ASSERT_REFUSED("off", cases);
}

RT_TEST(a_damaged_gltf_is_refused_with_what_is_wrong) {
    static const Damaged cases[] = {
        {"", "1:", "'[' or '{' expected"},
        {"{\"asset\":{\"version\":\"1.0\"}}", "", "expected glTF 2.0"},
        {ASSET "}", "", "expected scenes, or nodes"},
        {ASSET ",\"scene\":0}", "", "expected the index of one of the 0 scenes"},
        {ASSET ",\"nodes\":[]}", "", "no triangle"},
    };
    static const struct {
        const char *was, *is, *says;
    } changes[] = {
        {"AAECAAID", "AAECAAIE", "names vertex 4, but there are 4"},
        {"data:;base64,AAECAAID", "no%20file", RT_TEST_FOLDER "/no file: cannot be opened"},
        {"AAECAAID", "AAECAA", "buffers[1]: it declares 6 bytes, but has 4"},
        {"AAECAAID", "AAEC*AID", "buffers[1]: its base64 is damaged"},
        {"data:;base64,AAECAAID", "data:,AAECAAID", "buffers[1]: its data is not in base64"},
        {"data:;base64,AAECAAID", "http://x.org/a", "buffers[1]: its uri 'http://x.org/a' is not a file"},
        {",\"uri\":\"data:;base64,AAECAAID\"", "", "buffers[1]: expected uri"},
        {"{\"mesh\":0", "{\"mesh\":1", "nodes[0]: expected the index of one of the 1 meshes"},
        {"{\"mesh\":0", "{\"mesh\":0.5", "nodes[0]: expected the index of one of the 1 meshes"},
        {"{\"mesh\":0", "{\"children\":[0]", "scenes[0]: its nodes[0] is also below another node"},
        {"{\"mesh\":0}", "{\"children\":[1]},{\"children\":[1]}",
         "it is more than 256 levels deep, or below itself"},
        {"{\"mesh\":0", "{\"children\":[9]", "nodes[0]: expected the index of one of the 1 nodes"},
        {"{\"mesh\":0", "{\"matrix\":[1,2]", "a list of 16 numbers"},
        {"{\"mesh\":0", "{\"mesh\":0,\"scale\":[1e300,1,1]", "which is not finite"},
        {"\"indices\"", "\"mode\":7,\"indices\"", "expected mode"},
        {"\"indices\"", "\"mode\":1,\"indices\"", "no triangle"},
        {"\"VEC3\"", "\"VEC3\",\"sparse\":{}", "accessors[0]: expected count"},
        {"\"VEC3\"", "\"VEC3\",\"byteOffset\":1", "do not fit into the 48 bytes"},
        {"5121", "4294972417", "accessors[1]: expected componentType"}, /* 2^32 more */
        {"\"count\":6", "\"count\":9", "its 9 elements do not fit into the 6 bytes"},
        {"\"count\":6", "\"count\":4000000000", "do not fit"},
        {"\"count\":6", "\"count\":4611686018427387904", "expected count"},
        {"\"count\":6", "\"count\":5", "a primitive of triangles has 5 corners"},
        {"\"buffer\":1", "\"buffer\":1,\"byteOffset\":1",
         "bufferViews[1]: it ends at byte 7 of a buffer of 6 bytes"},
        {"\"buffer\":1", "\"buffer\":1,\"byteStride\":-1", "expected byteStride"},
        {"\"byteLength\":48,\"uri\"", "\"byteLength\":49,\"uri\"",
         "buffers[0]: it declares 49 bytes, but has 48"},
    };
    static const char gltf[] = GLTF;
    RtScene scene;
    ASSERT_REFUSED("gltf", cases);
    for (size_t i = 0; i < sizeof changes / sizeof changes[0]; i++) {
        char text[MOST_BYTES];
        const char *at = strstr(gltf, changes[i].was);
        assert_non_null(at);
        snprintf(text, sizeof text, "%.*s%s%s", (int)(at - gltf), gltf, changes[i].is,
                 at + strlen(changes[i].was));
        assert_bad_input(load_bytes("gltf", text, strlen(text), &scene, error), changes[i].says);
    }
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

/* Each of `nodes` places `nodes` primitives, of a triangle each, that share as many vertices; squeezed flat,
 * so that they become no instances. */
static RtStatus load_repeated(int nodes, RtScene *scene, RtError *problem) {
    static char text[100000];
    size_t size = (size_t)sprintf(text, "{\"asset\":{\"version\":\"2.0\"},\"meshes\":[{\"primitives\":[");
#define REPEAT(item)                                                                                         \
    for (int i = 0; i < nodes; i++) size += (size_t)sprintf(text + size, "%s" item, i ? "," : "", i)
    REPEAT("{\"attributes\":{\"POSITION\":0},\"indices\":1,\"extras\":%d}");
    size += (size_t)sprintf(text + size, "]}],\"nodes\":[");
    REPEAT("{\"mesh\":0,\"scale\":[0,1,1],\"extras\":%d}");
    size += (size_t)sprintf(text + size, "],\"scenes\":[{\"nodes\":[");
    REPEAT("%d");
    size += (size_t)sprintf(
        text + size,
        "]}],\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":%d,\"type\":\"VEC3\"},"
        "{\"bufferView\":0,\"componentType\":5121,\"count\":3,\"type\":\"SCALAR\"}],"
        "\"bufferViews\":[{\"buffer\":0,\"byteLength\":%d}],"
        "\"buffers\":[{\"byteLength\":%d,\"uri\":\"data:;base64,",
        nodes, 12 * nodes, 12 * nodes);
    memset(text + size, 'A', (size_t)(16 * nodes));
    size += (size_t)(16 * nodes);
    size += (size_t)sprintf(text + size, "\"}]}");
    return load_bytes("gltf", text, size, scene, problem);
}

RT_TEST(gltf_that_repeats_its_meshes_too_often_for_its_size_is_refused) {
    OWNED_SCENE few;
    RtScene many;
    assert_ok(load_repeated(100, &few, error));
    assert_int_equal(few.geometry.triangle_count, 100 * 100);
    assert_bad_input(load_repeated(400, &many, error), "its nodes place more than 1000 vertices and corners");
}

RT_TEST(the_sizes_that_a_binary_file_declares_must_be_its_own) {
    static const struct {
        size_t mesh, at; /* the byte that grows by 1; 0: the file grows */
        const char *says;
    } cases[] = {
        {GLB, 4, "this is glTF 3: only 2 can be read"},
        {GLB, 8, "bytes, but the file has"},
        {GLB, 12, "a chunk declares"}, /* the length of the JSON */
        {BINARY_STL, 80, "the header declares 3 triangles, which take 234 bytes, but the file has 184"},
        {BINARY_PLY, 51, "there is no triangle"}, /* the number of vertices */
        {GLB, 0, "declares"},
        {BINARY_STL, 0, "declares"},
        {BINARY_PLY, 0, "declares"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct Mesh changed = whole[cases[i].mesh];
        RtScene scene;
        if (cases[i].at)
            changed.bytes[cases[i].at]++;
        else
            changed.size += 13; /* fewer are a warning */
        assert_bad_input(load_bytes(changed.extension, changed.bytes, changed.size, &scene, error),
                         cases[i].says);
    }
}

RT_TEST(a_byte_of_zero_is_refused_in_text_with_its_place) {
    static const char *const names[] = {"obj", "off", "gltf", "nff"};
    for (size_t i = 0; i < 4; i++) {
        RtScene scene;
        char place[300];
        snprintf(place, sizeof place, "%s:2:3: ", path_of(names[i]));
        assert_bad_input_at(load_bytes(names[i], "OFF\nv \0 1", 9, &scene, error), place, "a byte of 0");
    }
}

/* They take no space on the disk. */
RT_TEST(a_gigabyte_of_zeros_is_refused_soon) {
    static const char *const names[] = {"obj", "off", "gltf", "ply", "stl", "glb", "nff", "yaml"};
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        const char *path = path_of(names[i]);
        RtScene scene;
        write_text(path, "");
        assert_int_equal(truncate(path, 1000000000), 0);
        const double start = rt_thread_seconds();
        assert_bad_input_at(rt_scene_open(path, &scene, error), path, "");
        assert_true(rt_thread_seconds() - start < RT_SHARE(1, 10));
        remove(path);
    }
}

RT_TEST(a_polygon_of_many_corners_is_read_soon) {
    enum { CORNERS = 99999 };
    static char text[60 * CORNERS];
    for (int concave = 0; concave < 2; concave++) {
        OWNED_SCENE scene;
        size_t size = 0;
        for (int i = 0; i < CORNERS; i++)
            size += (size_t)sprintf(text + size, "v %d %.1f 0\n", i, concave ? i % 2 : (double)i * i);
        size += (size_t)sprintf(text + size, "f");
        for (int i = 1; i <= CORNERS; i++) size += (size_t)sprintf(text + size, " %d", i);
        size += (size_t)sprintf(text + size, "\n");
        const double start = rt_wall_seconds();
        assert_ok(load_bytes("obj", text, size, &scene, error));
        assert_int_equal(scene.geometry.triangle_count, CORNERS - 2);
        assert_true(rt_wall_seconds() - start < RT_SHARE(2, 20));
    }
}

RT_TESTS(mesh_damage, make_meshes, assert_nothing_is_kept)
