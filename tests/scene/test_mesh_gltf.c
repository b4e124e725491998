/* SPDX-License-Identifier: Apache-2.0 */
/* glTF: what changes the shape at rest (accessors of all kinds, morph targets, skins, instances), what is odd
 * but read, what is warned of. test_mesh.c has nodes and modes, test_mesh_damage.c what is damaged. */
#include "scene_testing.h"

#include "core/base/clock.h"

#define NAME RT_BINARY_DIR "/test_mesh_gltf.gltf"
#define GLB  RT_BINARY_DIR "/test_mesh_gltf.glb"

/* An accessor, its view and its part of the buffer, all of the same index. */
typedef struct Numbers {
    int type;
    const char *shape;
    unsigned count;
    const void *data;
    size_t size;
    const char *accessor, *view; /* other members, each after a comma */
} Numbers;

#define NUMBERS(code, Type, form, many, ...)                                                                 \
    .type = code, .shape = form, .count = many, .data = (const Type[]){__VA_ARGS__},                         \
    .size = sizeof((const Type[]){__VA_ARGS__})
#define FLOATS(...) NUMBERS(5126, float, __VA_ARGS__)
#define BYTES(...)  NUMBERS(5121, uint8_t, __VA_ARGS__)
#define NORMALISED  .accessor = ",'normalized':true"
#define TRIANGLE    FLOATS("VEC3", 3, 0, 0, 0, 1, 0, 0, 0, 1, 0)

/* A mesh of one primitive whose positions are accessor 0; `more` continues its attributes. */
#define MESH(more) "'meshes':[{'primitives':[{'attributes':{'POSITION':0" more "}]}]"
#define SCENE      "'scenes':[{'nodes':[0]}],'nodes':"
#define ONE        SCENE "[{'mesh':0}]," MESH("}")

/* Writes a document of these members (' is ") and accessors, and its buffer beside it. */
static void write_document(const char *members, const Numbers *numbers, size_t count) {
    char text[8000], buffer[2000];
    size_t length = 0, size = 0, begins[16];
#define ADD(...) length += (size_t)snprintf(text + length, sizeof text - length, __VA_ARGS__)
    ADD("{'asset':{'version':'2.0'},%s,'accessors':[", members);
    for (size_t i = 0; i < count; i++) {
        const Numbers *n = &numbers[i];
        begins[i] = size;
        memcpy(buffer + size, n->data, n->size);
        size = (size + n->size + 3) / 4 * 4;
        ADD("%s{'bufferView':%zu,'componentType':%d,'count':%u,'type':'%s'%s}", i ? "," : "", i, n->type,
            n->count, n->shape, n->accessor ? n->accessor : "");
    }
    ADD("],'bufferViews':[");
    for (size_t i = 0; i < count; i++)
        ADD("%s{'buffer':0,'byteOffset':%zu,'byteLength':%zu%s}", i ? "," : "", begins[i], numbers[i].size,
            numbers[i].view ? numbers[i].view : "");
    ADD("],'buffers':[{'byteLength':%zu,'uri':'test_mesh_gltf.bin'}]}\n", size);
#undef ADD
    for (char *at = text; *at; at++) {
        if (*at == '\'') *at = '"';
    }
    write_text(NAME, text);
    write_bytes(RT_BINARY_DIR "/test_mesh_gltf.bin", buffer, size);
}

/* Opens it, with one warning that has these words, or with NULL none. */
static RtScene read_warned(const char *warning, const char *members, const Numbers *numbers, size_t count) {
    RtScene scene;
    RtError failure;
    write_document(members, numbers, count);
    if (rt_scene_open(NAME, &scene, &failure) != RT_OK) fail_msg("%s: %s", members, failure.message);
    const char *said = scene.warnings.count > 0 ? scene.warnings.list[0].message : "";
    if (scene.warnings.count != (warning != NULL) || !strstr(said, warning ? warning : ""))
        fail_msg("%s: %u warnings, the first: %s", members, scene.warnings.count, said);
    return scene;
}

static void assert_refused(const char *says, const char *members, const Numbers *numbers, size_t count) {
    RtScene scene;
    write_document(members, numbers, count);
    assert_bad_input(rt_scene_open(NAME, &scene, error), says);
}

#define COUNT_OF(list)                       (sizeof(list) / sizeof(list)[0])
#define READ(members, numbers)               read_warned(NULL, members, numbers, COUNT_OF(numbers))
#define READ_WARNED(words, members, numbers) read_warned(words, members, numbers, COUNT_OF(numbers))
#define REFUSED(words, members, numbers)     assert_refused(words, members, numbers, COUNT_OF(numbers))

static void assert_near(const RtVec3 *at, double x, double y, double z) {
    if (fabs((double)at->x - x) > 1e-6 || fabs((double)at->y - y) > 1e-6 || fabs((double)at->z - z) > 1e-6)
        fail_msg("(%g, %g, %g), not (%g, %g, %g)", (double)at->x, (double)at->y, (double)at->z, x, y, z);
}

#define ASSERT_CORNER(scene, i, corner, x, y, z)                                                             \
    assert_near(&(scene).geometry.triangles[i].v[corner], x, y, z)

/* ---- what is odd, or left out ---- */

RT_TEST(what_is_odd_but_means_one_thing_is_read) {
    static const char *const documents[] = {
        ONE ",'scene':0.0",
        ONE ",'extras':[1e300,99999999999999999999999,'\\u0000',null,{'a':{}}]",
        ONE ",'images':[{'uri':'lost.png'}],'extensionsUsed':['KHR_draco_mesh_compression','KHR_materials_"
            "unlit']",
        SCENE "[{'mesh':0,'camera':7,'light':'x','extensions':{'ACME_x':1}}]," MESH(",'COLOR_0':9,'_X':'y'}"),
        SCENE "[{'children':[1]},{'mesh':0}]," MESH("}"),
        SCENE "[{'mesh':0},{'mesh':5}],'meshes':[{'primitives':[{'attributes':{'POSITION':0},'mode':4.0}]}]",
        SCENE
        "[{'children':[1,2]},{'mesh':0},{'mesh':1}],'meshes':[{'primitives':[{'attributes':{'POSITION':0}}"
        "]},{'primitives':[]}]",
    };
    static const char *const extensions[] = {
        "KHR_texture_transform", "KHR_texture_basisu",    "EXT_texture_webp",
        "MSFT_texture_dds",      "KHR_materials_unlit",   "KHR_materials_variants",
        "KHR_lights_punctual",   "KHR_techniques_webgl",  "KHR_xmp_json_ld",
        "KHR_animation_pointer", "KHR_mesh_quantization", "EXT_mesh_gpu_instancing"};
    const Numbers numbers[] = {{TRIANGLE}};
    for (size_t i = 0; i < COUNT_OF(documents); i++) {
        OWNED_SCENE scene = READ(documents[i], numbers);
        assert_int_equal(scene.geometry.triangle_count, 1);
    }
    for (size_t i = 0; i < COUNT_OF(extensions); i++) {
        char members[400];
        snprintf(members, sizeof members, ONE ",'extensionsRequired':['%s']", extensions[i]);
        OWNED_SCENE scene = READ(members, numbers);
        assert_int_equal(scene.geometry.triangle_count, 1);
    }
}

RT_TEST(what_is_left_out_or_guessed_is_said) {
    static const struct {
        const char *members, *warning;
        uint32_t triangles;
    } cases[] = {
        {ONE ",'animations':[{}]", "animations are left out", 1},
        {ONE ",'extensionsUsed':['ACME_other']", "the extension 'ACME_other' is ignored", 1},
        {SCENE "[{'mesh':0}],'meshes':[{'primitives':[{'attributes':{'POSITION':0}},{'mode':1,'attributes':{"
               "'POSITION':0}}]}]",
         "points and lines are left out", 1},
        {SCENE "[{'mesh':0}],'meshes':[{'primitives':[{'attributes':{'POSITION':0}},{'attributes':{}}]}]",
         "primitives without positions are left out", 1},
        {"'scene':1,'scenes':[{'nodes':[0]},{'nodes':[1]}],'nodes':[{'mesh':0},{'children':[2,3]},{'mesh':0},"
         "{"
         "'mesh':0}]," MESH("}"),
         "several scenes: only one is read", 2},
        {"'nodes':[{'mesh':0},{'children':[0]},{'mesh':0}]," MESH("}"), "no scene: all its nodes are read",
         2},
        {SCENE "[{'children':[1,2]},{'children':[3]},{'children':[3]},{'mesh':0}]," MESH("}"),
         "nodes[3] has several parents: it is placed below each", 2},
    };
    const Numbers numbers[] = {{TRIANGLE}};
    for (size_t i = 0; i < COUNT_OF(cases); i++) {
        OWNED_SCENE scene = READ_WARNED(cases[i].warning, cases[i].members, numbers);
        assert_int_equal(scene.geometry.triangle_count, cases[i].triangles);
    }
}

RT_TEST(what_cannot_be_known_is_refused_with_what_to_do) {
    static const struct {
        const char *members, *says;
    } cases[] = {
        {ONE ",'extensionsRequired':['ACME_shape']", "'ACME_shape', which cannot be read: export it without"},
        {ONE ",'extensionsRequired':['KHR_draco_mesh_compression']",
         "compressed by KHR_draco_mesh_compression, which cannot be read: export it without compression"},
        {ONE ",'extensionsRequired':['EXT_meshopt_compression']", "compressed by EXT_meshopt_compression"},
        {ONE ",'extensionsRequired':[3]", "it requires the extension ''"},
        {"'scenes':[{'nodes':[0,1]}],'nodes':[{'children':[1]},{'mesh':0}]," MESH("}"),
         "scenes[0]: its nodes[1] is also below another node"},
        {MESH("}"), "expected scenes, or nodes that place its meshes"},
        {ONE ",'scene':1", "expected the index of one of the 1 scenes"},
        {SCENE "[{'mesh':0,'mesh':0}]," MESH("}"), "duplicate object key"},
    };
    const Numbers numbers[] = {{TRIANGLE}};
    for (size_t i = 0; i < COUNT_OF(cases); i++) REFUSED(cases[i].says, cases[i].members, numbers);
}

/* Each of 40 nodes has the next one below it twice: 2^40 places. */
RT_TEST(nodes_that_multiply_are_refused_soon) {
    char members[2000] = "'scenes':[{'nodes':[0]}],'nodes':[";
    const Numbers numbers[] = {{TRIANGLE}};
    for (int i = 1; i <= 40; i++)
        snprintf(members + strlen(members), sizeof members - strlen(members), "{'children':[%d,%d]},", i, i);
    strcat(members, "{}]," MESH("}"));
    REFUSED("its nodes place more than 1000", members, numbers);
}

/* Each of 10,000 instances, which have no data, is moved by as many targets. */
RT_TEST(targets_of_instances_are_refused_soon) {
    enum { TARGETS = 10000 };
    static char text[4 * TARGETS];
    RtScene scene;
    size_t size = (size_t)sprintf(
        text,
        "{\"asset\":{\"version\":\"2.0\"},\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"mesh\":0,\"extensions\":"
        "{\"EXT_mesh_gpu_instancing\":{\"attributes\":{\"SCALE\":0}}}}],\"accessors\":[{\"componentType\":"
        "5126,"
        "\"count\":%d,\"type\":\"VEC3\"},{\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"}],\"meshes\":"
        "[{\"primitives\":[{\"attributes\":{\"POSITION\":1},\"targets\":[{}",
        TARGETS);
    for (int i = 1; i < TARGETS; i++) size += (size_t)sprintf(text + size, ",{}");
    strcpy(text + size, "]}]}]}");
    write_text(NAME, text);
    const double start = rt_thread_seconds();
    assert_bad_input(rt_scene_open(NAME, &scene, error), "its nodes place more than 1000");
    assert_true(rt_thread_seconds() - start < 10);
}

/* ---- accessors ---- */

RT_TEST(indices_of_bytes_and_strides_are_read) {
    const Numbers numbers[] = {
        {FLOATS("VEC3", 3, 0, 0, 0, 7, 7, 1, 0, 0, 7, 7, 0, 1, 0), .view = ",'byteStride':20"},
        {BYTES("SCALAR", 3, 1, 2, 0)},
    };
    OWNED_SCENE scene = READ(SCENE "[{'mesh':0}]," MESH("},'indices':1"), numbers);
    ASSERT_CORNER(scene, 0, 0, 1, 0, 0);
    ASSERT_CORNER(scene, 0, 1, 0, 1, 0);
}

#define SPARSE                                                                                               \
    "'sparse':{'count':1,'indices':{'bufferView':1,'componentType':5121},'values':{'bufferView':2}}"

RT_TEST(sparse_accessors_replace_elements) {
    const Numbers numbers[] = {{FLOATS("VEC3", 3, 0, 0, 0, 1, 0, 0, 0, 1, 0), .accessor = "," SPARSE},
                               {BYTES("SCALAR", 1, 1)},
                               {FLOATS("VEC3", 1, 2, 3, 4)}};
    OWNED_SCENE scene = READ(ONE, numbers);
    ASSERT_CORNER(scene, 0, 1, 2, 3, 4);
    ASSERT_CORNER(scene, 0, 2, 0, 1, 0);
    const Numbers beyond[] = {numbers[0], {BYTES("SCALAR", 1, 3)}, numbers[2]};
    REFUSED("accessors[0]: it replaces element 3, but has 3", ONE, beyond);
    const Numbers many[] = {{TRIANGLE, .accessor = ",'sparse':{'count':4,'indices':{'bufferView':1,'"
                                                   "componentType':5121},'values':{'bufferView':2}}"},
                            {BYTES("SCALAR", 4, 0, 1, 2, 2)},
                            {FLOATS("VEC3", 4, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 1, 0)}};
    REFUSED("accessors[0]: it replaces more elements than it has", ONE, many);
}

static RtStatus open_without_data(const char *count, const char *more, RtScene *scene, RtError *error) {
    char text[1000];
    snprintf(text, sizeof text,
             "{'asset':{'version':'2.0'}," ONE
             ",'accessors':[{'componentType':5126,'count':%s,'type':'VEC3'%s"
             "}],'bufferViews':[{'buffer':0,'byteLength':4},{'buffer':0,'byteLength':1},{'buffer':0,"
             "'byteOffset':4,'byteLength':12}],'buffers':[{'byteLength':16,'uri':"
             "'data:text/plain;charset=x;base64,AgAAAAAAAEAAAEBAAACAQA=='}]}",
             count, more);
    for (char *at = text; *at; at++) {
        if (*at == '\'') *at = '"';
    }
    return open_bytes(NAME, text, strlen(text), scene, error);
}

RT_TEST(accessors_without_data_are_zero_but_not_where_their_data_is_compressed) {
    RtScene scene;
    assert_ok(open_without_data("3", "," SPARSE, &scene, error));
    ASSERT_CORNER(scene, 0, 1, 0, 0, 0);
    ASSERT_CORNER(scene, 0, 2, 2, 3, 4);
    rt_scene_clear(&scene);
    assert_ok(open_without_data("3", "", &scene, error));
    ASSERT_CORNER(scene, 0, 2, 0, 0, 0);
    rt_scene_clear(&scene);
    assert_ok(open_without_data("3", "," SPARSE "}],'extensionsUsed':['KHR_draco_mesh_compression'],'x':[{",
                                &scene, error));
    rt_scene_clear(&scene);
    assert_bad_input(open_without_data("3000000", "", &scene, error), "more elements, without data");
    assert_bad_input(open_without_data("3000", "", &scene, error),
                     "more elements, without data, than the file");
    assert_bad_input(
        open_without_data("3", "}],'extensionsUsed':['KHR_draco_mesh_compression'],'x':[{", &scene, error),
        "compressed by KHR_draco_mesh_compression");
}

/* A meshopt view names a fallback buffer, which the file has or not. */
RT_TEST(a_compressed_buffer_is_read_from_its_fallback) {
    static const char fallback[] =
        ",'extensions':{'EXT_meshopt_compression':{'buffer':0,'byteLength':9,'mode':"
        "'ATTRIBUTES','count':3,'byteStride':12}}";
    const Numbers numbers[] = {{TRIANGLE, .view = fallback}};
    OWNED_SCENE scene = READ(ONE ",'extensionsUsed':['EXT_meshopt_compression']", numbers);
    assert_int_equal(scene.geometry.triangle_count, 1);
}

/* Of normalised integers, the largest is 1, and the two least are both -1. */
RT_TEST(quantised_positions_are_read) {
    const Numbers int8[] = {{NUMBERS(5120, int8_t, "VEC3", 3, 0, 0, 0, 0, 127, 0, 0, 0, 0, -128, 0, 0),
                             NORMALISED, .view = ",'byteStride':4"}},
                  int16[] = {{NUMBERS(5122, int16_t, "VEC3", 3, 0, 0, 0, 32767, 0, 0, 0, -32767, 0),
                              NORMALISED}},
                  uint16[] = {{NUMBERS(5123, uint16_t, "VEC3", 3, 0, 0, 0, 65535, 0, 0, 0, 40000, 0)}},
                  whole[] = {{NUMBERS(5122, int16_t, "VEC3", 3, 0, 0, 0, -300, 0, 0, 0, 300, 0)}};
    OWNED_SCENE scene = READ(
        SCENE "[{'mesh':0,'scale':[2,2,2]}],'extensionsRequired':['KHR_mesh_quantization']," MESH("}"), int8);
    ASSERT_CORNER(scene, 0, 1, 2, 0, 0);
    ASSERT_CORNER(scene, 0, 2, 0, -2, 0);
    OWNED_SCENE shorts = READ(ONE, int16), unsigned_shorts = READ(ONE, uint16), integers = READ(ONE, whole);
    ASSERT_CORNER(shorts, 0, 1, 1, 0, 0);
    ASSERT_CORNER(shorts, 0, 2, 0, -1, 0);
    ASSERT_CORNER(unsigned_shorts, 0, 1, 65535, 0, 0);
    ASSERT_CORNER(unsigned_shorts, 0, 2, 0, 40000, 0);
    ASSERT_CORNER(integers, 0, 1, -300, 0, 0);
}

/* ---- nodes, morph targets, skins, instances ---- */

RT_TEST(a_node_is_moved_before_its_parent_scales_it) {
    const Numbers numbers[] = {{TRIANGLE}};
    OWNED_SCENE scene =
        READ(SCENE "[{'children':[1],'scale':[2,2,2]},{'mesh':0,'translation':[1,0,0]}]," MESH("}"), numbers);
    ASSERT_CORNER(scene, 0, 0, 2, 0, 0);
    ASSERT_CORNER(scene, 0, 1, 4, 0, 0);
}

/* The target moves each vertex by (1, 0, 0), and its normal from z to y. */
RT_TEST(morph_targets_have_the_weights_of_the_node_or_else_of_the_mesh) {
    const Numbers numbers[] = {{TRIANGLE},
                               {FLOATS("VEC3", 3, 1, 0, 0, 1, 0, 0, 1, 0, 0)},
                               {FLOATS("VEC3", 3, 0, 0, 1, 0, 0, 1, 0, 0, 1)},
                               {FLOATS("VEC3", 3, 0, 1, -1, 0, 1, -1, 0, 1, -1)}};
#define MORPH    ",'NORMAL':2},'targets':[{'POSITION':1,'NORMAL':3}]"
#define WEIGHTED "'meshes':[{'weights':[0.5],'primitives':[{'attributes':{'POSITION':0" MORPH "}]}]"
    OWNED_SCENE rest = READ(SCENE "[{'mesh':0}]," MESH(MORPH), numbers),
                mesh = READ(SCENE "[{'mesh':0}]," WEIGHTED, numbers),
                node = READ(SCENE "[{'mesh':0,'weights':[1]}]," WEIGHTED, numbers);
    REFUSED("meshes[0]: expected weights, numbers", SCENE "[{'mesh':0,'weights':['1']}]," WEIGHTED, numbers);
    ASSERT_CORNER(rest, 0, 1, 1, 0, 0);
    ASSERT_CORNER(mesh, 0, 1, 1.5, 0, 0);
    ASSERT_CORNER(node, 0, 1, 2, 0, 0);
    assert_near(&rest.geometry.vertex_normals[0].n[0], 0, 0, 1);
    assert_near(&mesh.geometry.vertex_normals[0].n[0], 0, sqrt(0.5), sqrt(0.5));
    assert_near(&node.geometry.vertex_normals[0].n[0], 0, 1, 0);
}

/* Node 1 is moved by z = 3, node 2 turned about x by 90 degrees; the node of the mesh, moved by x = 9, does
 * not count. Joint 0 is bound where z = 1. */
#define SKINNED(list, more)                                                                                  \
    "'scenes':[{'nodes':[0,2]}],'nodes':[{'mesh':0,'skin':0,'translation':[9,0,0],'children':[1]},{"         \
    "'translation':[-9,0,3]},{'rotation':[1,0,0,1]}],'skins':[{'joints':[" list "]" more "}],"
#define JOINTS ",'JOINTS_0':1,'WEIGHTS_0':2"
#define BINDING                                                                                              \
    {                                                                                                        \
        FLOATS("MAT4", 2, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, -1, 1, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1,  \
               0, 0, 0, 0, 1)                                                                                \
    }

RT_TEST(skins_are_in_the_pose_of_their_joints) {
    const Numbers numbers[] = {
        {TRIANGLE},
        {BYTES("VEC4", 3, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 99, 99)},
        {NUMBERS(5121, uint8_t, "VEC4", 3, 255, 0, 0, 0, 255, 0, 0, 0, 0, 255, 0, 0), NORMALISED},
        BINDING,
        {FLOATS("VEC3", 3, 0, 0, 1, 0, 0, 1, 0, 0, 1)}};
    OWNED_SCENE bound = READ(SKINNED("1,2", ",'inverseBindMatrices':3") MESH(JOINTS ",'NORMAL':4}"), numbers),
                unbound = READ(SKINNED("1,2", "") MESH(JOINTS "}"), numbers),
                plain = READ(SKINNED("1,2", "") MESH("}"), numbers);
    ASSERT_CORNER(bound, 0, 0, 0, 0, 2);
    ASSERT_CORNER(bound, 0, 1, 1, 0, 2);
    ASSERT_CORNER(bound, 0, 2, 0, 0, 1);
    assert_near(&bound.geometry.vertex_normals[0].n[0], 0, 0, 1);
    assert_near(&bound.geometry.vertex_normals[0].n[2], 0, -1, 0);
    ASSERT_CORNER(unbound, 0, 0, 0, 0, 3);
    ASSERT_CORNER(plain, 0, 0, 9, 0, 0); /* no joints: it moves with its node */
    REFUSED("skins[0]: it has 3 joints, but 2 matrices",
            SKINNED("1,2,2", ",'inverseBindMatrices':3") MESH("}"), numbers);
}

/* Mesh and joint are below a mirror. */
RT_TEST(a_mirrored_skin_keeps_the_outside_out) {
    const Numbers numbers[] = {{TRIANGLE},
                               {BYTES("VEC4", 3, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0)},
                               {FLOATS("VEC4", 3, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0)},
                               {FLOATS("VEC3", 3, 0, 0, 1, 0, 0, 1, 0, 0, 1)}};
    OWNED_SCENE scene = READ(SCENE "[{'scale':[-1,1,1],'children':[1,2]},{'mesh':0,'skin':0},{}],'skins':[{"
                                   "'joints':[2]}]," MESH(JOINTS ",'NORMAL':3}"),
                             numbers);
    assert_true(scene.geometry.box.lo.x == -1 && scene.geometry.box.hi.x == 0);
    assert_true(rt_triangle_normal(&scene.geometry.triangles[0]).z == 1);
    assert_near(&scene.geometry.vertex_normals[0].n[0], 0, 0, 1);
}

/* The first vertex is half of each joint, in two sets; the second has too little weight, the third none. */
RT_TEST(weights_of_all_sets_count_and_are_scaled_to_1_with_a_warning) {
    const Numbers numbers[] = {{TRIANGLE},
                               {BYTES("VEC4", 3, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0)},
                               {FLOATS("VEC4", 3, 0.25f, 0.25f, 0, 0, 0.5f, 0, 0, 0, 0, 0, 0, 0)},
                               {BYTES("VEC4", 3, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0)},
                               {FLOATS("VEC4", 3, 0.5f, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0)}};
    OWNED_SCENE scene = READ_WARNED("the joint weights of a vertex add up to 0.5",
                                    SKINNED("1,2", "") MESH(JOINTS ",'JOINTS_1':3,'WEIGHTS_1':4}"), numbers);
    ASSERT_CORNER(scene, 0, 0, 0, 0, 1.5);
    ASSERT_CORNER(scene, 0, 1, 1, 0, 3);
    ASSERT_CORNER(scene, 0, 2, 9, 1, 0); /* where its node is, without a skin */
    assert_int_equal(scene.warnings.list[0].times, 2);
}

RT_TEST(joints_that_do_not_exist_are_refused) {
    const Numbers numbers[] = {{TRIANGLE},
                               {BYTES("VEC4", 3, 0, 0, 0, 0, 2, 0, 0, 0, 0, 0, 0, 0)},
                               {FLOATS("VEC4", 3, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0)}};
    REFUSED("meshes[0]: a vertex names joint 2, but its skin has 2", SKINNED("1,2", "") MESH(JOINTS "}"),
            numbers);
    REFUSED("skins[0]: its joint nodes[1] is not in the scene",
            SCENE "[{'mesh':0,'skin':0},{}],'skins':[{'joints':[1,1,1]}]," MESH(JOINTS "}"), numbers);
    REFUSED("skins[0]: expected the index of one of the 1 nodes",
            SCENE "[{'mesh':0,'skin':0}],'skins':[{'joints':[4]}]," MESH(JOINTS "}"), numbers);
}

#define INSTANCED(attributes)                                                                                \
    SCENE "[{'mesh':0,'translation':[0,0,1],'extensions':{'EXT_mesh_gpu_instancing':{'attributes':"          \
          "{" attributes "}}}}]," MESH("}")

/* A strip of 100 triangles, placed by two nodes, one of them mirrored, and by a third in two instances. */
static RtScene read_repeated(const char *path) {
    float strip[102 * 3] = {0};
    for (int i = 0; i < 102; i++) strip[3 * i] = (float)(i / 2), strip[3 * i + 1] = (float)(i % 2);
    const Numbers numbers[] = {
        {.type = 5126, .shape = "VEC3", .count = 102, .data = strip, .size = sizeof strip},
        {FLOATS("VEC3", 2, 0, 0, 5, 0, 0, 7)}};
    RtScene scene;
    write_document(
        "'scenes':[{'nodes':[0,1,2]}],'nodes':[{'mesh':0},{'mesh':0,'scale':[1,1,-1]},{'mesh':0,"
        "'scale':[2,2,2],'extensions':{'EXT_mesh_gpu_instancing':{'attributes':{'TRANSLATION':1}}}}],"
        "'meshes':[{'primitives':[{'attributes':{'POSITION':0},'mode':5}]}]",
        numbers, 2);
    assert_ok(rt_scene_open(path, &scene, error));
    return scene;
}

RT_TEST(a_large_mesh_that_is_placed_several_times_becomes_instances) {
    OWNED_SCENE scene = read_repeated(NAME);
    assert_int_equal(scene.part_count, 1);
    assert_int_equal(scene.parts[0]->geometry.triangle_count, 100);
    assert_int_equal(scene.geometry.instance_count, 4);
    assert_int_equal(scene.geometry.triangle_count, 0);
    assert_true(scene.geometry.instances[3].to_world.m[2][3] == 14);
    /* The same with copies: as an object of another scene. */
    static const char within[] = "objects: [mesh: {path: test_mesh_gltf.gltf}]\n";
    write_text(RT_BINARY_DIR "/test_mesh_gltf.yaml", within);
    OWNED_SCENE copies = read_repeated(RT_BINARY_DIR "/test_mesh_gltf.yaml"), flat;
    assert_int_equal(copies.geometry.triangle_count, 400);
    assert_ok(rt_scene_flatten(&scene, &flat, error));
    assert_int_equal(flat.geometry.triangle_count, 400);
    assert_memory_equal(flat.geometry.triangles, copies.geometry.triangles, 400 * sizeof(RtTriangle));
}

/* The second is moved by x = 5; turned by 90 degrees about z, in bytes whose square is a little less than 1;
 * and mirrored, so that its triangle keeps its front. */
RT_TEST(instances_of_a_mesh_become_copies) {
    const Numbers numbers[] = {{TRIANGLE},
                               {FLOATS("VEC3", 2, 0, 0, 0, 5, 0, 0)},
                               {NUMBERS(5120, int8_t, "VEC4", 2, 0, 0, 0, 127, 0, 0, 89, 89), NORMALISED},
                               {FLOATS("VEC3", 2, 1, 1, 1, 1, 1, -2)},
                               {FLOATS("VEC3", 3, 1, 1, 1, 1, 1, 1, 1, 1, 1)}};
    OWNED_SCENE scene =
        READ_WARNED("become copies", INSTANCED("'TRANSLATION':1,'ROTATION':2,'SCALE':3,'_ID':9"), numbers);
    assert_int_equal(scene.geometry.triangle_count, 2);
    ASSERT_CORNER(scene, 0, 1, 1, 0, 1);
    assert_true(rt_triangle_normal(&scene.geometry.triangles[0]).z == 1);
    ASSERT_CORNER(scene, 1, 2, 5, 0, 1);
    ASSERT_CORNER(scene, 1, 1, 5, 1, 1);
    ASSERT_CORNER(scene, 1, 0, 4, 0, 1);
    assert_true(rt_triangle_normal(&scene.geometry.triangles[1]).z == -1);
    OWNED_SCENE scaled = READ_WARNED("become copies", INSTANCED("'SCALE':4"), numbers);
    assert_int_equal(scaled.geometry.triangle_count, 3);
    REFUSED("nodes[0]: expected 2 elements of SCALE, found 3", INSTANCED("'TRANSLATION':1,'SCALE':4"),
            numbers);
    REFUSED("nodes[0]: expected a skin or instances, found both",
            INSTANCED("'TRANSLATION':1}}},'skin':0,'x':{'y':{'z':{") ",'skins':[{'joints':[0]}]", numbers);
}

RT_TEST(every_failed_allocation_of_a_skin_and_of_instances_is_reported) {
    const Numbers numbers[] = {{TRIANGLE},
                               {BYTES("VEC4", 3, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0)},
                               {FLOATS("VEC4", 3, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0)},
                               BINDING};
    write_document(SKINNED("1,2", ",'inverseBindMatrices':3") MESH(JOINTS "}"), numbers, COUNT_OF(numbers));
    assert_failed_allocations_are_reported(NAME);
    const Numbers moved[] = {
        {TRIANGLE, .accessor = "," SPARSE}, {BYTES("SCALAR", 1, 1)}, {FLOATS("VEC3", 1, 2, 3, 4)}};
    write_document(INSTANCED("'TRANSLATION':0"), moved, COUNT_OF(moved));
    assert_failed_allocations_are_reported(NAME);
}

/* ---- GLB ---- */

#define JSON_CHUNK                                                                                           \
    "{\"asset\":{\"version\":\"2.0\"},\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"mesh\":0}],\"meshes\":[{"   \
    "\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}],\"accessors\":[{\"bufferView\":0,"                 \
    "\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"}],\"bufferViews\":[{\"buffer\":0,\"byteLength\":"  \
    "36}],"                                                                                                  \
    "\"buffers\":[{\"byteLength\":36}]}"

/* Opens a GLB of four chunks, of which the second is unknown, and the last one too many, with as many bytes
 * behind it. */
static RtStatus open_glb(uint32_t behind, RtScene *scene, RtError *error) {
    static const float triangle[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    const uint32_t padded = (sizeof JSON_CHUNK + 3) / 4 * 4, other = 4, binary = sizeof triangle,
                   size = 12 + 8 + padded + 8 + other + 8 + binary + 8 + other, version = 2;
    char bytes[1000] = "glTF";
    size_t at = 4;
#define PUT(data, count) (memcpy(bytes + at, data, count), at += (count))
    PUT(&version, 4);
    PUT(&size, 4);
    PUT(&padded, 4);
    PUT("JSON" JSON_CHUNK, 4 + sizeof JSON_CHUNK); /* zeros follow */
    at = 12 + 8 + padded;
    PUT(&other, 4);
    PUT("ACMExxxx", 8);
    PUT(&binary, 4);
    PUT("BIN\0", 4);
    PUT(triangle, binary);
    PUT(&other, 4);
    PUT("BIN\0xxxx", 8);
#undef PUT
    assert_int_equal(at, size);
    return open_bytes(GLB, bytes, size + behind, scene, error);
}

RT_TEST(glb_may_have_other_chunks_zeros_for_blanks_and_a_few_bytes_more) {
    OWNED_SCENE exact, longer;
    RtScene damaged;
    assert_ok(open_glb(0, &exact, error));
    assert_int_equal(exact.geometry.triangle_count, 1);
    assert_int_equal(exact.warnings.count, 0);
    assert_ok(open_glb(4, &longer, error));
    assert_int_equal(longer.warnings.count, 1);
    assert_non_null(strstr(longer.warnings.list[0].message, "4 bytes more than its header declares"));
    assert_bad_input(open_glb(12, &damaged, error), "the file has 12 bytes more than its header declares");
}

RT_TESTS(mesh_gltf, NULL, NULL)
