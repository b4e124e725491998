/* SPDX-License-Identifier: Apache-2.0 */
/* Scenes far from the origin: with their offset subtracted while they are read, they are the same as those
 * written about the origin, but for roundings; and who does not ask for that is told. */
#include "recentre_testing.h"

#include "core/base/file.h"
#include "core/scene/load.h"
#include "scenes/builtin.h"

#define PATH(extension) RT_BINARY_DIR "/test_recentre." extension

static RtScene recentred(const char *path, RtVec3d offset) {
    RtScene scene;
    assert_ok(rt_scene_load(path, rt_builtin_open, &offset, &scene, error));
    return scene;
}

static double farthest(RtVec3 a, RtVec3 b) {
    double most = 0;
    for (int i = 0; i < 3; i++) most = fmax(most, fabs((double)a.at[i] - (double)b.at[i]));
    return most;
}

/* ---- meshes ---- */

typedef struct Mesh {
    const char *extension, *text;
} Mesh;

#define PLY                                                                                                  \
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty double x\nproperty double y\nproperty double z\n"
#define TRIANGLE "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"
#define GLTF(node)                                                                                           \
    "{\"asset\":{\"version\":\"2.0\"},\"scenes\":[{\"nodes\":[0]}],\"nodes\":[" node "],\"meshes\":"         \
    "[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}],\"accessors\":[{\"bufferView\":0,"               \
    "\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"}],\"bufferViews\":[{\"buffer\":0,"                 \
    "\"byteLength\":36}],\"buffers\":[{\"byteLength\":36,\"uri\":\"data:;base64," TRIANGLE "\"}]}\n"

static const Mesh meshes[] = {
    {"obj", "f 1 2 3\nv <0 0 0>\nv <0.001 0 0.002>\nv <0 0.1 0.3>\n"},
    {"off", "OFF\n3 1 0\n<0 0 0>\n<0.001 0 0.002>\n<0 0.1 0.3>\n3 0 1 2\n"},
    {"stl", "solid a\nfacet normal 0 0 1\nouter loop\nvertex <0 0 0>\nvertex <0.001 0 0.002>\n"
            "vertex <0 0.1 0.3>\nendloop\nendfacet\nendsolid\n"},
    {"ply", PLY "element face 1\nproperty list uchar int vertex_indices\nend_header\n<0 0 0>\n"
                "<0.001 0 0.002>\n<0 0.1 0.3>\n3 0 1 2\n"},
    {"gltf", GLTF("{\"children\":[1],\"scale\":[0.5,0.5,0.5]},{\"mesh\":0,\"translation\":[1,2,3.25]}")},
    {"gltf", GLTF("{\"children\":[1],\"translation\":[<0.001 0.002 0.003>]},"
                  "{\"mesh\":0,\"rotation\":[0,0,1,0]}")},
};

static double difference(const RtScene *a, const RtScene *b, RtVec3d offset) {
    double most = 0;
    assert_int_equal(a->geometry.triangle_count, b->geometry.triangle_count);
    for (uint32_t i = 0; i < a->geometry.triangle_count; i++) {
        for (int v = 0; v < 3; v++) {
            const RtVec3d moved = rt_subd(rt_widen(b->geometry.triangles[i].v[v]), offset);
            most = fmax(most, farthest(a->geometry.triangles[i].v[v], rt_narrow(moved)));
        }
    }
    return most;
}

RT_TEST(meshes_of_every_format_keep_what_float32_loses_far_away) {
    for (size_t i = 0; i < sizeof meshes / sizeof meshes[0]; i++) {
        char path[256];
        const bool placed = strchr(meshes[i].text, '<'); /* else there is nothing to be lost */
        snprintf(path, sizeof path, PATH("%s"), meshes[i].extension);
        const char *separator = strcmp(meshes[i].extension, "gltf") == 0 ? ", " : " ";
        write_moved(path, meshes[i].text, nowhere, separator);
        OWNED_SCENE near = open_scene(path);
        write_moved(path, meshes[i].text, far_away, separator);
        OWNED_SCENE far = open_scene(path), moved = recentred(path, placed ? far_away : nowhere);
        if (placed) assert_true(difference(&near, &far, far_away) > 0.01);
        assert_true(difference(&near, &moved, nowhere) < 1e-6);
    }
}

/* The bits of binary files are what they are, but no more is lost. */
RT_TEST(binary_meshes_are_moved_exactly) {
    static const char *const paths[] = {PATH("ply"), PATH("stl"), PATH("glb")};
    const RtVec3d by = {{500000, 5400000, 100}};
    write_moved(PATH("obj"), "v <0 0 0>\nv <1.5 0 0.25>\nv <0 -3 7>\nf 1 2 3\n", by, " ");
    OWNED_SCENE far = open_scene(PATH("obj"));
    for (size_t i = 0; i < 3; i++) {
        assert_ok(rt_scene_save(&far, paths[i], error));
        OWNED_SCENE moved = recentred(paths[i], by);
        assert_true(difference(&moved, &far, by) == 0);
    }
    static const char binary[] = "OFF BINARY\n\0\0\0\3\0\0\0\1\0\0\0\0"
                                 "\x4a\xa4\xcb\x80\0\0\0\0\0\0\0\0\x4a\xa4\xcb\x81\0\0\0\0\0\0\0\0"
                                 "\x4a\xa4\xcb\x80\x3f\x80\0\0\0\0\0\0\0\0\0\3\0\0\0\0\0\0\0\1\0\0\0\2\0\0\0";
    write_bytes(PATH("off"), binary, sizeof binary);
    OWNED_SCENE off = recentred(PATH("off"), rt_vec3d(5400000, 0, 0));
    assert_true(off.geometry.triangles[0].v[0].x == 0 && off.geometry.triangles[0].v[1].x == 0.5f);
}

/* ---- whole scenes ---- */

/* Everything but the transforms of what is itself far away. Of meshes in trees, only those that are not. */
static const char whole[] =
    "camera: {from: [<3 -14 9>], at: [<3 4 0>], size: [64, 64]}\n"
    "lights: [{position: [<5.5 -5 8>]}]\n"
    "solids:\n"
    "- {name: ball, sphere: {center: [<0 0 1.1>], radius: 1.2}}\n"
    "- {name: egg, ellipsoid: {center: [<0.3 0 1>], radii: [1, 0.8, 0.6]}}\n"
    "- {name: block, box: {lo: [<-0.9 -0.9 0>], hi: [<0.9 0.9 1.7>]}}\n"
    "- {name: below, half_space: {point: [<0 0 1.4>], normal: [0, 0, 1]}}\n"
    "- {name: bore, cylinder: {base: [<0 0 -1>], apex: [<0 0 5>], radius: 0.3}}\n"
    "- {name: tip, cone: {base: [<0 3 0>], base_radius: 1, apex: [<0 3 2>], apex_radius: 0}}\n"
    "- {name: ring, torus: {center: [<0 3 1>], major: 0.8, minor: 0.2}}\n"
    "- {name: hull, polyhedron: {vertices: [[<3 3 0>], [<4 3 0>], [<3 4 0>], [<3 3 1.5>]]}}\n"
    "- {name: facets, facets: {triangles: [[<5 3 0>, <5 4 0>, <6 3 0>], [<5 3 0>, <6 3 0>, <5 3 1.5>], "
    "[<6 3 0>, <5 4 0>, <5 3 1.5>], [<5 4 0>, <5 3 0>, <5 3 1.5>]]}}\n"
    "- {name: home, box: {lo: [-0.5, -0.5, -0.1], hi: [0.5, 0.5, 0.6]}}\n"
    "- {name: tilted, formula: home, transform: [{rotate: {axis: [1, 1, 0], degrees: 20}}]}\n"
    "- {name: wedge, polyhedron: {planes: [[-1, 0, 0, 0], [0, -1, 0, 0], [0, 0, -1, 0], [1, 1, 1, 1]]}}\n"
    "- {name: closed, mesh: {path: test_recentre.closed.obj}}\n"
    "objects:\n"
    "- csg: {formula: (ball & block & below) - bore | egg}\n"
    "- csg: {formula: tip | ring}\n"
    "- csg: {formula: hull | facets}\n"
    "- csg: {formula: tilted | wedge | closed, transform: [{translate: [<3 0.2 0.5>]}]}\n"
    "- sphere: {center: [<6 0 0.7>], radius: 0.6}\n"
    "- polygon: {vertices: [[<-9 -9 -0.2>], [<12 -9 -0.2>], [<12 9 -0.2>], [<-9 9 -0.2>]]}\n"
    "- triangle: {vertices: [[<-3 0 0>], [<-2 0 0>], [<-3 0.5 2>]], normals: [[0, -1, 0], [0, -1, 0], [1, "
    "-1, 0]]}\n"
    "- cone: {base: [<-4 3 0>], base_radius: 1, apex: [<-4 3 2>], apex_radius: 0.5}\n"
    "- cylinder: {base: [<-2 4 0>], apex: [<-2 4 2>], radius: 0.4}\n"
    "- mesh: {path: test_recentre.closed.obj, transform: [{scale: 2}, {translate: [<8 4 0>]}]}\n"
    "- builtin: {name: 'balls:size=1', transform: [{translate: [<9 -3 1>]}]}\n";

static void assert_same_picture(const RtScene *a, const RtScene *b) {
    RtView views[2];
    const RtScene *const scenes[2] = {a, b};
    uint32_t hits = 0;
    assert_int_equal(a->geometry.object_count, b->geometry.object_count);
    assert_true(farthest(a->lights[0].position, b->lights[0].position) < 1e-5);
    assert_memory_equal(&a->lights[0].intensity, &b->lights[0].intensity, sizeof(RtVec3));
    assert_memory_equal(a->geometry.vertex_normals, b->geometry.vertex_normals, sizeof(RtVertexNormals));
    for (uint32_t i = 0; i < a->geometry.object_count; i++) {
        assert_true(farthest(a->geometry.boxes[i].lo, b->geometry.boxes[i].lo) < 1e-5);
        assert_true(farthest(a->geometry.boxes[i].hi, b->geometry.boxes[i].hi) < 1e-5);
    }
    for (int i = 0; i < 2; i++)
        assert_ok(rt_view_init(&views[i], &scenes[i]->camera, scenes[i]->sampling, error));
    for (uint32_t i = 0; i < 64 * 64; i++) {
        float t[2];
        uint32_t ids[2];
        for (int k = 0; k < 2; k++) {
            const RtRay ray = rt_view_ray(&views[k], i % 64, i / 64);
            ids[k] = first_hit(scenes[k], &ray, &t[k]);
        }
        assert_int_equal(ids[0], ids[1]);
        if (ids[0] == RT_NO_OBJECT) continue;
        assert_true(fabsf(t[0] - t[1]) < 1e-4f);
        hits++;
    }
    assert_in_range(hits, 1000, 64 * 64);
}

RT_TEST(a_scene_far_away_looks_as_if_it_were_written_about_the_origin) {
    write_text(PATH("closed.obj"),
               "v 0 0 0\nv 0.5 0 0\nv 0 0.5 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n");
    write_moved(PATH("yaml"), whole, nowhere, ", ");
    OWNED_SCENE near = open_scene(PATH("yaml"));
    write_moved(PATH("yaml"), whole, far_away, ", ");
    OWNED_SCENE moved = recentred(PATH("yaml"), far_away);
    assert_same_picture(&near, &moved);
}

RT_TEST(nff_far_away_looks_as_if_it_were_written_about_the_origin) {
    static const char text[] =
        "v\nfrom <3 -14 9>\nat <3 2 0>\nup 0 0 1\nangle 45\nhither 0\nresolution 64 64\n"
        "l <5.5 -5 8>\nf 1 1 1 1 0 0 0 0\ns <0 0 1.1> 1.2\nc <3 0 0> 1 <3 0 2.3> 0.5\n"
        "p 4\n<-9 -9 0>\n<12 -9 0>\n<12 9 0>\n<-9 9 0>\n"
        "pp 3\n<6 0 0> 0 0 1\n<7 0 0.1> 0 0 1\n<6 2 1.1> 0 0 1\n";
    write_moved(PATH("nff"), text, nowhere, " ");
    OWNED_SCENE near = open_scene(PATH("nff"));
    write_moved(PATH("nff"), text, far_away, " ");
    OWNED_SCENE moved = recentred(PATH("nff"), far_away);
    assert_same_picture(&near, &moved);
}

/* Rotated about the origin, so that what lies far away goes elsewhere; the translation brings it back. */
RT_TEST(a_mesh_far_away_keeps_its_digits_under_a_transform) {
    char text[512];
    const RtVec3d back =
        rt_vec3d(far_away.x + 2 * far_away.y, far_away.y - 2 * far_away.x, far_away.z - 2 * far_away.z);
    write_moved(PATH("part.obj"), meshes[0].text, far_away, " ");
    snprintf(
        text, sizeof text,
        "objects: [{mesh: {path: test_recentre.part.obj, transform: [{rotate: {axis: [0, 0, 1], degrees: "
        "90}}, {scale: 2}, {translate: [%.6f, %.6f, %.6f]}]}}]\n",
        back.x, back.y, back.z);
    write_text(PATH("yaml"), text);
    OWNED_SCENE moved = recentred(PATH("yaml"), far_away);
    const RtVec3 *v = moved.geometry.triangles[0].v;
    assert_true(farthest(v[0], rt_vec3(0, 0, 0)) < 1e-6);
    assert_true(farthest(v[1], rt_vec3(0, 0.002f, 0.004f)) < 1e-6);
    assert_true(farthest(v[2], rt_vec3(-0.2f, 0, 0.6f)) < 1e-6);
}

/* ---- the offset ---- */

/* A little more than halfway between two float32: rounded to double first, the number would go down. */
#define HALFWAY "1.0000000596046447754"
RT_TEST(numbers_without_an_offset_are_rounded_once) {
    const float expected = strtof(HALFWAY, NULL);
    assert_true(expected > 1);
    write_text(PATH("obj"), "v " HALFWAY " 7 0\nv 0 8 0\nv 0 7 1\nf 1 2 3\n");
    write_text(PATH("nff"), "s " HALFWAY " 7 0 1\n");
    write_text(PATH("yaml"), "objects: [{sphere: {center: [" HALFWAY ", 7, 0], radius: 1}}]\n");
    OWNED_SCENE obj = recentred(PATH("obj"), nowhere), nff = recentred(PATH("nff"), nowhere),
                yaml = recentred(PATH("yaml"), rt_vec3d(0, 7, 0)), same = open_scene(PATH("nff"));
    assert_true(obj.geometry.triangles[0].v[0].x == expected && obj.geometry.triangles[0].v[0].y == 7);
    assert_true(yaml.geometry.spheres[0].center.x == expected && yaml.geometry.spheres[0].center.y == 0);
    assert_true(nff.geometry.spheres[0].center.x == expected);
    assert_true(rt_scene_fingerprint(&nff) == rt_scene_fingerprint(&same));
}

/* The longest side, 10.1, is divided into eighths of the next power of two. */
RT_TEST(the_centre_of_a_scene_is_rounded_to_few_bits) {
    RtVec3d offset = {{NAN, 0, 0}};
    RtScene scene;
    write_moved(PATH("obj"), "v <0 0 0>\nv <10.1 0 0>\nv <0 6 0.3>\nf 1 2 3\n", far_away, " ");
    assert_ok(rt_scene_load(PATH("obj"), rt_builtin_open, &offset, &scene, error));
    assert_true(offset.x == 500006 && offset.y == 5400004 && offset.z == 100);
    assert_int_equal(scene.warnings.count, 0);
    assert_true(farthest(scene.geometry.triangles[0].v[1], rt_vec3(4.223f, -3.544f, 0.789f)) < 1e-6);
    rt_scene_clear(&scene);
}

RT_TEST(every_failed_allocation_is_reported_and_leaves_nothing) {
    RtScene scene;
    RtVec3d offset = far_away;
    write_moved(PATH("yaml"), whole, far_away, ", ");
    assert_fails_cleanly(rt_scene_load(PATH("yaml"), rt_builtin_open, &offset, &scene, error),
                         rt_scene_clear(&scene));
    write_moved(PATH("obj"), meshes[0].text, far_away, " ");
    assert_fails_cleanly(
        (offset.x = NAN, rt_scene_load(PATH("obj"), rt_builtin_open, &offset, &scene, error)),
        rt_scene_clear(&scene));
}

/* ---- the warning ---- */

static uint32_t warnings_of(const char *extension, const char *text, RtVec3d by) {
    char path[256];
    snprintf(path, sizeof path, PATH("%s"), extension);
    write_moved(path, text, by, strcmp(extension, "yaml") == 0 ? ", " : " ");
    OWNED_SCENE scene = open_scene(path);
    const uint32_t count = scene.warnings.count;
    if (count > 0) assert_non_null(strstr(scene.warnings.list[0].message, "`raytally convert --recentre`"));
    return count;
}

RT_TEST(small_objects_far_away_are_warned_of) {
    assert_int_equal(warnings_of("obj", "v <0 0 0>\nv <9 0 0>\nv <0 9 0>\nf 1 2 3\n", far_away), 1);
    assert_int_equal(warnings_of("nff", "s <0 0 0> 9\ns <0 99 0> 9\ns <99 0 0> 999\n", far_away), 1);
    assert_int_equal(warnings_of("yaml", "objects: [{sphere: {center: [<0 0 0>], radius: 9}}]\n", far_away),
                     1);
}

/* Near the origin, or as large as they are far away, or so wide a scene that no offset would help. */
RT_TEST(scenes_that_would_not_gain_are_not_warned_of) {
    static const char tiny[] = "v <0 0 0>\nv <1e-3 0 0>\nv <0 1e-3 0>\nf 1 2 3\n";
    assert_int_equal(warnings_of("obj", tiny, nowhere), 0);
    assert_int_equal(warnings_of("obj", tiny, rt_vec3d(5, 5, 5)), 0);
    assert_int_equal(warnings_of("obj", "v <0 0 0>\nv <900 0 0>\nv <0 900 0>\nf 1 2 3\n", far_away), 0);
    assert_int_equal(warnings_of("nff", "s <0 0 0> 9\ns <800000 0 0> 9\ns <0 0 99> 9\n", far_away), 0);
    assert_int_equal(warnings_of("nff", "s <0 0 0> 9\ns <0 999 0> 999\n", far_away), 0);
}

RT_TESTS(recentre, NULL, assert_nothing_is_kept)
