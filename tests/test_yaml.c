/* The YAML scene format: what it reads, what it refuses and where, what it writes. */
#include "testing.h"

#include "base/memory.h"
#include "scene/append.h"
#include "scene/yaml.h"
#include "scenes/builtin.h"

#include <glob.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#define FOLDER RT_BINARY_DIR "/test_yaml.d"

/* ---- helpers ---- */

static void write_bytes(const char *path, const void *bytes, size_t count) {
    FILE *out = fopen(path, "wb");
    assert_non_null(out);
    assert_int_equal(fwrite(bytes, 1, count, out), count);
    assert_int_equal(fclose(out), 0);
}

static void write_text(const char *path, const char *text) {
    write_bytes(path, text, strlen(text));
}

/* Loads and finishes; on failure the scene is empty. */
static RtStatus load(const char *path, RtScene *scene, RtError *error) {
    rt_scene_init(scene);
    RtStatus status = rt_yaml_load(path, scene, error);
    if (status == RT_OK) status = rt_scene_finish(scene, error);
    if (status != RT_OK) rt_scene_clear(scene);
    return status;
}

static RtStatus load_text(const char *text, RtScene *scene, RtError *error) {
    write_text(FOLDER "/scene.yaml", text);
    return load(FOLDER "/scene.yaml", scene, error);
}

static int make_folder(void **state) {
    (void)state;
    mkdir(FOLDER, 0777);
    const char corner[] = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    write_text(FOLDER "/corner.obj", corner);
    write_text(FOLDER "/open.obj", /* a pyramid without its base */
               "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nf 1 2 5\nf 2 3 5\nf 3 4 5\nf 4 1 5\n");
    write_text(FOLDER "/bunny.obj", corner); /* what the documentation calls so */
    return 0;
}

/* One of everything. */
static const char everything[] =
    "camera: {from: [0, -10, 4], at: [0, 0, 1], up: [0, 0, 1], fov: 30, hither: 0.5, size: [320, 200]}\n"
    "background: [0.1, 0.2, 0.3]\n"
    "ambient: [0.5, 0.5, 0.5]\n"
    "lights:\n"
    "  - {position: [5, -5, 10]}\n"
    "  - {position: [-5, -5, 10], intensity: [0.5, 0.4, 0.3]}\n"
    "materials:\n"
    "  - {name: red, color: [1, 0, 0], specular: 0.5, shine: 20}\n"
    "  - name: \"gl\\u00e4s \\\"x\\\"\"\n"
    "    transmission: 0.9\n"
    "    ior: 1.5\n"
    "objects:\n"
    "  - sphere: {center: [0, 0, 1], radius: 1e-40, material: red}\n"
    "  - sphere: {center: [0.1, -0.0, 3.3333333], radius: .1}\n"
    "  - polygon: {vertices: [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], material: red}\n"
    "  - triangle: {vertices: [[0, 0, 0], [1, 0, 0], [1, 1, 0]]}\n"
    "  - triangle:\n"
    "      vertices: [[0, 0, 0], [1, 0, 0], [1, 1, 0]]\n"
    "      normals: [[1, 1, 1], [0.3, 0.2, 0.9], [7, 1, 1]]\n"
    "      material: \"gl\\u00e4s \\\"x\\\"\"\n"
    "  - cone: {base: [0, 0, 0], base_radius: 1, apex: [0, 0, 2], apex_radius: 0, material: red}\n"
    "  - cylinder: {base: [0, 0, 0], apex: [0, 0, 2], radius: 0.3}\n"
    "  - mesh: {path: corner.obj, transform: [{scale: 2}, {stretch: [1, 2, 3]}, {translate: [0, 0, 5]}]}\n"
    "  - builtin: {name: \"balls:size=1\", transform: [{rotate: {axis: [0, 0, 1], degrees: 90}}]}\n";

/* ---- reading ---- */

static void a_scene_is_what_its_file_says(void **state) {
    (void)state;
    RtScene s;
    assert_ok(load_text(everything, &s, error));
    const RtGeometry *g = &s.geometry;
    assert_true(s.camera.from.y == -10 && s.camera.fov == 30 && s.camera.hither == 0.5f);
    assert_int_equal(s.camera.width, 320);
    assert_true(s.background.z == 0.3f && s.ambient.x == 0.5f);
    assert_int_equal(s.light_count, 2);
    assert_true(s.lights[0].intensity.x == 1 && s.lights[1].intensity.y == 0.4f);
    assert_true(s.materials[0].specular == 0.5f && s.materials[0].diffuse == rt_default_material().diffuse);
    assert_string_equal(s.materials[1].name, "gl\xc3\xa4s \"x\"");
    assert_string_equal(s.materials[s.material_of[1]].name, "default");
    assert_true(g->spheres[1].center.z == 3.3333333f && signbit(g->spheres[1].center.y));
    assert_int_equal(g->polygons[0].count, 4);
    assert_int_equal(g->triangle_normals[0], RT_NO_NORMALS);
    assert_int_equal(g->triangle_normals[1], 0);
    assert_int_equal(g->cone_count, 2);
    assert_true(g->cones[1].base_radius == g->cones[1].apex_radius);
    assert_true(g->triangles[2].v[2].y == 4 && g->triangles[2].v[2].z == 5);
    rt_scene_clear(&s);
}

static void what_is_left_out_has_defaults(void **state) {
    (void)state;
    RtScene s;
    assert_ok(load_text("objects:\n  - sphere: {center: [1, 2, 3], radius: 1}\n", &s, error));
    assert_int_equal(s.light_count, 1);
    assert_int_equal(s.material_count, 1);
    assert_true(s.camera.at.x == 1 && s.camera.at.z == 3 && s.camera.fov == 45);
    rt_scene_clear(&s);
}

static void a_material_called_default_is_the_default(void **state) {
    (void)state;
    RtScene s;
    assert_ok(load_text("materials: [{name: default, color: [0, 1, 0]}]\n"
                        "objects: [sphere: {center: [1, 2, 3], radius: 1}]\n",
                        &s, error));
    assert_int_equal(s.material_count, 1);
    assert_true(s.materials[0].color.y == 1);
    rt_scene_clear(&s);
}

static void a_built_in_moved_and_moved_back_is_itself(void **state) {
    (void)state;
    RtScene plain, s;
    assert_ok(rt_builtin_open("balls:size=2", &plain, error));
    assert_ok(load_text("objects:\n"
                        "  - builtin:\n"
                        "      name: balls:size=2\n"
                        "      transform:\n"
                        "        - rotate: {axis: [0, 0, 1], degrees: 90}\n"
                        "        - {scale: 4}\n"
                        "        - {scale: 0.25}\n"
                        "        - rotate: {axis: [0, 0, -2], degrees: 90}\n",
                        &s, error));
    const RtGeometry *a = &plain.geometry, *b = &s.geometry;
    assert_int_equal(a->object_count, b->object_count);
    assert_memory_equal(a->objects, b->objects, a->object_count * sizeof *a->objects);
    assert_true(a->sphere_count > 0);
    for (uint32_t i = 0; i < a->sphere_count; i++) {
        assert_memory_equal(&a->spheres[i], &b->spheres[i], sizeof(RtSphere));
    }
    rt_scene_clear(&plain);
    rt_scene_clear(&s);
}

/* ---- refusing: line and phrase of what is said ---- */

#define SPHERE "objects:\n- sphere: {center: [0, 0, 0], radius: 1}\n"
#define SOLIDS                                                                                               \
    "solids:\n"                                                                                              \
    "- {name: a, sphere: {center: [0, 0, 0], radius: 1}}\n"                                                  \
    "- {name: h, half_space: {point: [0, 0, 0], normal: [0, 0, 1]}}\n"                                       \
    "# line 4\n"
#define JOIN_4(x)            x "|" x "|" x "|" x
#define TIMES_64(name, part) "- {name: " name ", formula: " JOIN_4(JOIN_4(JOIN_4(part))) "}\n"
#define CSG(formula)         "objects:\n- csg: {formula: " formula "}\n"

static const struct {
    const char *text;
    int line;
    const char *says;
} hostile[] = {
    /* not YAML, not a scene */
    {"", 1, "empty"},
    {"# nothing\n", 1, "empty"},
    {"objects: [", 2, "not YAML"},
    {"objects:\n\t- x\n", 2, "not YAML"},
    {"\x7f"
     "ELF\x02\x01\x01\x03",
     1, "UTF-8"},
    {"a: \xff\xfe\n", 1, "UTF-8"},
    {"just words\n", 1, "the keys camera"},
    {"- a\n- b\n", 1, "a list found"},
    {SPHERE "---\n" SPHERE, 3, "second document"},
    {"{}\n", 1, "'objects' is missing"},
    {"objects: []\n", 1, "at least 1"},
    {"objects:\n", 1, "nothing found where a list"},
    {"objects: &a [*a]\n", 1, "aliases"},
    {"a: &a [x,x]\nb: &b [*a,*a]\n", 1, "unknown key 'a'"},
    /* keys */
    {"object:\n  - sphere: {}\n", 1, "did you mean 'objects'?"},
    {SPHERE "camera:\n  from: [1, 1, 1]\n  too: [0, 0, 0]\n", 5, "unknown key 'too'"},
    {"objects:\n- sphere: {center: [0, 0, 0],\n   radios: 1}\n", 3, "did you mean 'radius'?"},
    {"objects:\n- sphere:\n    radius: 1\n", 2, "'center' is missing"},
    {SPHERE SPHERE, 3, "'objects' is given twice"},
    {"objects:\n- ? [a]\n  : 1\n", 2, "plain word"},
    /* numbers */
    {"objects:\n- sphere:\n    center: [0, 0, 0]\n    radius: 0\n", 4, "radius above 0"},
    {"objects:\n- sphere:\n    center: [0, 0, 0]\n    radius: -3\n", 4, "radius above 0"},
    {"objects:\n- sphere:\n    radius: 1\n    center: [0,\n      nan, 0]\n", 5,
     "'nan' is not a finite number"},
    {"objects:\n- sphere: {center: [0, .inf, 0], radius: 1}\n", 2, "'.inf' is not a finite number"},
    {"objects:\n- sphere: {center: [0, 1, 0], radius: 1e39}\n", 2, "fits float32"},
    {"objects:\n- sphere: {center: [0, 1, 0], radius: 1m}\n", 2, "'1m' is not"},
    {"objects:\n- sphere: {center: [0, 1, 0], radius: }\n", 2, "is not a finite number"},
    {"objects:\n- sphere: {center: [0, 1, 0], radius: \"1\\02\"}\n", 2, "zero byte"},
    {"objects:\n- sphere: {center: [0, 1, 0], radius: [1]}\n", 2, "a list found where a number"},
    {"objects:\n- sphere: {center: [0, 1], radius: 1}\n", 2, "has 2 entries"},
    {"objects:\n- sphere: {center: [0, 1, 2, 3], radius: 1}\n", 2, "more than 3"},
    {"objects:\n- sphere: {center: 7, radius: 1}\n", 2, "'7' found where a list of 3 numbers"},
    {"objects:\n- sphere: {center: [1e18, 0, 0], radius: 1}\n", 2, "scale the scene down"},
    /* objects */
    {"objects:\n- {}\n", 2, "0 of them"},
    {SPHERE "- sphere: {center: [0, 0, 0], radius: 1}\n  cone: {base: [0, 0, 0], apex: [0, 0, 1], "
            "base_radius: 1, apex_radius: 0}\n",
     3, "2 of them"},
    {"objects:\n- polygon: {vertices: [[0, 0, 0], [1, 0, 0]]}\n", 2, "at least 3"},
    {"objects:\n- polygon:\n    vertices: [[0, 0, 0], [1, 0, 0], [2, 0, 0]]\n", 3, "no area"},
    {"objects:\n- polygon: {vertices: [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 1]]}\n", 2, "not planar"},
    {"objects:\n- triangle: {vertices: [[0, 0, 0], [1, 0, 0], [1, 1, 0]],\n"
     "  normals: [[0, 0, 0], [0, 0, 1], [0, 0, 1]]}\n",
     2, "vertex normal 0"},
    {SPHERE "- cylinder: {base: [0, 0, 0], apex: [0, 0, 0], radius: 1}\n", 3, "objects[1].cylinder"},
    {SPHERE "- cone: {base: [0, 0, 0], apex: [0, 0, 1], base_radius: -1, apex_radius: 0}\n", 3,
     "objects[1].cone"},
    /* materials */
    {"objects:\n- sphere:\n    center: [0, 0, 0]\n    radius: 1\n    material: blu\n", 5,
     "no material 'blu'"},
    {SPHERE "materials:\n- {name: a}\n- {name: b}\n- {name: a}\n", 6, "two materials 'a'"},
    {SPHERE "materials:\n- {name: a, reflection: 2}\n", 4, "reflection is 2"},
    {SPHERE "materials:\n- {name: a, ior: 0}\n", 4, "ior is 0"},
    {SPHERE "materials:\n- {color: [1, 1, 1]}\n", 4, "'name' is missing"},
    {SPHERE "materials:\n- {name: ''}\n", 4, "0 characters"},
    {SPHERE "materials:\n- {name: aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa}\n", 4,
     "64 characters, must have 1..63"},
    {SPHERE "materials:\n- {name: \"a\\nb\"}\n", 4, "control character"},
    {SPHERE "materials: {red: {color: [1, 0, 0]}}\n", 3, "a mapping found where a list"},
    /* camera, lights, colours */
    {SPHERE "camera:\n  from: [1, 2, 3]\n", 3, "belong together"},
    {SPHERE "camera:\n  from: [1, 2, 3]\n  at: [1, 2, 3]\n", 5, "looks nowhere"},
    {SPHERE "camera:\n  from: [0, 0, 3]\n  at: [0, 0, 0]\n  up: [0, 0, 1]\n", 6, "`up`"},
    {SPHERE "camera:\n  up: [0, 0, 0]\n", 4, "`up`"},
    {SPHERE "camera:\n  up: [0, 0, 1]\n  fov: 180\n", 5, "below 180"},
    {SPHERE "camera:\n  hither: -1\n", 4, "at least 0"},
    {SPHERE "camera:\n  size: [0, 100]\n", 4, "1..32768"},
    {SPHERE "camera:\n  size: [1000000000, 100]\n", 4, "1..32768"},
    {SPHERE "camera:\n  size: [5000000000, 100]\n", 4, "whole number"},
    {SPHERE "camera:\n  size: [-5, 100]\n", 4, "whole number"},
    {SPHERE "camera:\n  size: [1.5, 100]\n", 4, "whole number"},
    {SPHERE "camera:\n  from: [1e18, 0, 0]\n  at: [0, 0, 0]\n", 4, "nearer"},
    {SPHERE "lights:\n- {position: [0, 0, 0]}\n- {position: [0, 0, 0], intensity: [-1, 0, 0]}\n", 5,
     "negative"},
    {SPHERE "lights:\n- {intensity: [1, 1, 1]}\n", 4, "'position' is missing"},
    {SPHERE "background: [0, -1, 0]\n", 3, "no negative"},
    {SPHERE "ambient: [a, b, c]\n", 3, "'a' is not"},
    /* meshes, built-ins, transforms */
    {SPHERE "- mesh:\n    path: no-such.obj\n", 4, "no-such.obj"},
    {SPHERE "- mesh:\n    path: scene.yaml\n", 4, "scene.yaml"},
    {SPHERE "- builtin:\n    name: bals\n", 4, "balls"},
    {SPHERE "- builtin: {name: \"balls:size=1000000000\"}\n", 3, "size"},
    {SPHERE "- builtin:\n    name: balls:size=1\n    transform:\n    - scale: 1\n    - stretch: [1, 1, 2]\n",
     5, "unevenly"},
    {SPHERE "- builtin:\n    name: balls:size=1\n    transform:\n    - scale: 1\n    - scale: 0\n", 7,
     "above 0"},
    {SPHERE "- builtin:\n    name: balls:size=1\n    transform:\n    - {scale: 1, translate: [0, 0, 0]}\n", 6,
     "2 of them"},
    {SPHERE "- mesh:\n    path: corner.obj\n    transform:\n    - rotate: {axis: [0, 0, 0], degrees: 1}\n", 6,
     "length 0"},
    {SPHERE "- mesh:\n    path: corner.obj\n    transform:\n    - scale: 1e30\n", 4, "corner.obj"},
    /* CSG */
    {SOLIDS "- {name: c, formula: c | a}\n" CSG("a"), 5, "cannot contain itself"},
    {SOLIDS "- {name: c, formula: d}\n- {name: d, formula: c}\n" CSG("a"), 5, "comes after this formula"},
    {SOLIDS "- {name: a, sphere: {center: [0, 0, 0], radius: 1}}\n" CSG("a"), 5, "two solids 'a'"},
    {SOLIDS "- {name: a b, sphere: {center: [0, 0, 0], radius: 1}}\n" CSG("a"), 5, "a name is a letter or _"},
    {SOLIDS "- {name: c}\n" CSG("a"), 5, "0 of them"},
    {SOLIDS "- {name: c, box: {lo: [0, 0, 0], hi: [1, 1, 0]}}\n" CSG("a"), 5, "lo < hi on each axis"},
    {SOLIDS "- {name: c, box: {lo: [1, 0, 0], hi: [0, 1, 1]}}\n" CSG("a"), 5, "lo < hi on each axis"},
    {SOLIDS "- {name: c, torus: {center: [0, 0, 0], major: 1, minor: 2}}\n" CSG("a"), 5, "minor < major"},
    {SOLIDS "- {name: c, half_space: {point: [0, 0, 0], normal: [0, 0, 0]}}\n" CSG("a"), 5,
     "the normal not 0"},
    {SOLIDS "- {name: c, polyhedron: {}}\n" CSG("a"), 5, "give one of the two"},
    {SOLIDS "- {name: c, polyhedron: {vertices: [[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]]}}\n" CSG("a"), 5,
     "in one plane"},
    {SOLIDS "- name: c\n  mesh:\n    path: corner.obj\n" CSG("a"), 7, "at least; this one has 1"},
    {SOLIDS "- name: c\n  mesh:\n    path: open.obj\n" CSG("a"), 7, "closed"},
    {SOLIDS CSG("x"), 6, "no solid 'x'"},
    {SOLIDS CSG("a |"), 6, "at character 4"},
    {SOLIDS CSG("a h"), 6, "(difference) or ')' should stand here"},
    {SOLIDS CSG("(a - h"), 6, "a ')' is missing"},
    {SOLIDS CSG("a - h)"), 6, "has no '(' before it"},
    {SOLIDS CSG("a - - h"), 6, "a name or '(' should stand here"},
    {SOLIDS CSG("''"), 6, "0 characters"},
    {SOLIDS CSG("h"), 6, "no end"},
    {SOLIDS CSG("a | h"), 6, "no end"},
    {SOLIDS CSG("h - a"), 6, "no end"},
    {SOLIDS CSG("a, extents: maybe"), 6, "on or off, not 'maybe'"},
    {SOLIDS CSG("a, extents: ''"), 6, "on or off, not ''"},
    {SOLIDS CSG("a, extents: true"), 6, "on or off, not 'true'"},
    {SOLIDS CSG("a, material: blu"), 6, "no material 'blu'"},
    {"objects:\n- csg: {extents: on}\n", 2, "'formula' is missing"},
    {SOLIDS TIMES_64("c", "a") TIMES_64("d", "c") TIMES_64("e", "d") TIMES_64("f", "e") TIMES_64("g", "f")
         CSG("g"),
     9, "at most 16777216"},
};

static void bad_input_is_refused_with_its_line_and_a_remedy(void **state) {
    (void)state;
    int64_t live = rt_alloc_live();
    for (size_t i = 0; i < sizeof hostile / sizeof hostile[0]; i++) {
        RtScene scene;
        RtError error = {RT_OK, ""};
        if (load_text(hostile[i].text, &scene, &error) == RT_OK) fail_msg("accepted:\n%s", hostile[i].text);
        char place[512];
        snprintf(place, sizeof place, "%s/scene.yaml:%d:", FOLDER, hostile[i].line);
        if (strncmp(error.message, place, strlen(place)) != 0 || !strstr(error.message, hostile[i].says)) {
            fail_msg("expected line %d and '%s', got: %s", hostile[i].line, hostile[i].says, error.message);
        }
        assert_int_equal(rt_alloc_live(), live);
    }
}

static void the_column_is_that_of_the_value(void **state) {
    (void)state;
    RtScene scene;
    RtError error;
    assert_int_equal(load_text("objects:\n- sphere: {center: [0, 0, 0], radius: 0}\n", &scene, &error),
                     RT_BAD_INPUT);
    assert_non_null(strstr(error.message, "scene.yaml:2:39: objects[0].sphere.radius: "));
}

static void files_that_are_none_are_refused(void **state) {
    (void)state;
    RtScene scene;
    RtError error;
    assert_int_equal(load(FOLDER "/missing.yaml", &scene, &error), RT_BAD_INPUT);
    assert_non_null(strstr(error.message, "missing.yaml: cannot be opened"));
    assert_int_equal(load(FOLDER, &scene, &error), RT_BAD_INPUT);
    assert_non_null(strstr(error.message, "not a file"));
    assert_int_equal(load("/dev/zero", &scene, &error), RT_BAD_INPUT);
    char zeros[4096] = "";
    write_bytes(FOLDER "/zeros.yaml", zeros, sizeof zeros);
    assert_int_equal(load(FOLDER "/zeros.yaml", &scene, &error), RT_BAD_INPUT);
}

static void deep_nesting_is_refused_without_descending(void **state) {
    (void)state;
    enum { DEPTH = 100000 };
    static char text[DEPTH + 16] = "objects: ";
    memset(text + 9, '[', DEPTH);
    RtScene scene;
    RtError error;
    assert_int_equal(load_text(text, &scene, &error), RT_BAD_INPUT);
}

static void every_prefix_of_a_scene_is_read_or_refused(void **state) {
    (void)state;
    int64_t live = rt_alloc_live();
    for (size_t length = 0; length < sizeof everything; length += 7) {
        write_bytes(FOLDER "/scene.yaml", everything, length);
        RtScene scene;
        RtError error;
        if (load(FOLDER "/scene.yaml", &scene, &error) == RT_OK) rt_scene_clear(&scene);
        assert_int_equal(rt_alloc_live(), live);
    }
}

/* ---- memory ---- */

static void whichever_allocation_fails_nothing_is_left(void **state) {
    (void)state;
    write_text(FOLDER "/scene.yaml", everything);
    int64_t live = rt_alloc_live();
    RtStatus status = RT_NO_MEMORY;
    for (uint64_t n = 1; status == RT_NO_MEMORY; n++) {
        RtScene scene;
        RtError error;
        rt_alloc_fail_at(n);
        status = load(FOLDER "/scene.yaml", &scene, &error);
        rt_alloc_fail_at(0);
        if (status == RT_OK) rt_scene_clear(&scene);
        if (status != RT_OK && status != RT_NO_MEMORY) fail_msg("allocation %d: %s", (int)n, error.message);
        assert_int_equal(rt_alloc_live(), live);
        assert_true(n < 100000);
    }
    assert_int_equal(status, RT_OK);
}

/* ---- writing ---- */

static void save_to(const RtScene *scene, const char *path) {
    FILE *out = fopen(path, "wb");
    assert_non_null(out);
    assert_ok(rt_yaml_save(scene, out, error));
    assert_int_equal(fclose(out), 0);
}

static void assert_survives(const RtScene *scene) {
    RtScene again;
    save_to(scene, FOLDER "/again.yaml");
    assert_ok(load(FOLDER "/again.yaml", &again, error));
    assert_true(rt_scene_fingerprint(&again) == rt_scene_fingerprint(scene));
    rt_scene_clear(&again);
}

static void a_scene_saved_and_loaded_keeps_every_bit(void **state) {
    (void)state;
    RtScene scene;
    assert_ok(load_text(everything, &scene, error));
    assert_survives(&scene);
    rt_scene_clear(&scene);
    for (size_t i = 0; i < rt_builtin_count(); i++) {
        assert_ok(rt_builtin_open(rt_builtin_at(i)->name, &scene, error));
        assert_survives(&scene);
        rt_scene_clear(&scene);
    }
}

/* Half-spaces are saved as polyhedra of one plane, slabs as polyhedra of two. */
static void solids_without_an_end_survive_saving(void **state) {
    (void)state;
    RtScene scene;
    assert_ok(load_text("solids:\n"
                        "  - {name: ball, sphere: {center: [1, 2, 3], radius: 1.1}}\n"
                        "  - {name: below, half_space: {point: [1, 2, 3], normal: [1, 2, 3]}}\n"
                        "  - {name: slab, polyhedron: {planes: [[0.3, 1, 0, 2.5], [-0.3, -1, 0, -1.7]]}}\n"
                        "objects:\n"
                        "  - csg: {formula: ball & below}\n"
                        "  - csg: {formula: ball & slab, transform: [{scale: 0.3}]}\n",
                        &scene, error));
    assert_survives(&scene);
    rt_scene_clear(&scene);
}

static void vertex_normals_survive_saving_bit_for_bit(void **state) {
    (void)state;
    RtScene scene;
    rt_scene_init(&scene);
    RtMaterial material = rt_default_material();
    uint32_t index;
    assert_ok(rt_scene_add_material(&scene, &material, &index, error));
    for (int i = 1; i < 500; i++) {
        float a = (float)i, b = a * a;
        RtVec3 v[3] = {{0, 0, 0}, {a, 0, 1}, {0, b, 2}};
        RtVec3 n[3] = {{a, b, 1}, {1, -a, b / 7}, {b, a / 3, -a}};
        assert_ok(rt_scene_add_triangle(&scene, index, v, n, error));
    }
    assert_ok(rt_scene_finish(&scene, error));
    assert_survives(&scene);
    rt_scene_clear(&scene);
}

static void names_that_cannot_be_written_are_replaced_by_numbers(void **state) {
    (void)state;
    static const char *const pairs[][2] = {{"a", "a"}, {"a", ""}, {"a", "b\n"}, {"a", "\xff"}};
    for (size_t i = 0; i < sizeof pairs / sizeof pairs[0]; i++) {
        RtScene scene;
        rt_scene_init(&scene);
        for (uint32_t k = 0; k < 2; k++) {
            RtMaterial material = rt_default_material();
            uint32_t index;
            snprintf(material.name, sizeof material.name, "%s", pairs[i][k]);
            material.ambient = (float)k;
            assert_ok(rt_scene_add_material(&scene, &material, &index, error));
            assert_ok(rt_scene_add_sphere(&scene, index, rt_vec3((float)k, 0, 0), 1, error));
        }
        assert_ok(rt_scene_finish(&scene, error));
        assert_survives(&scene);
        rt_scene_clear(&scene);
    }
}

static void a_full_disk_is_reported(void **state) {
    (void)state;
    FILE *out = fopen("/dev/full", "wb");
    if (!out) skip();
    setvbuf(out, NULL, _IONBF, 0);
    RtScene scene;
    RtError error = {RT_OK, ""};
    assert_int_equal(load_text(everything, &scene, &error), RT_OK);
    assert_int_equal(rt_yaml_save(&scene, out, &error), RT_IO);
    rt_scene_clear(&scene);
    fclose(out);
}

/* ---- the documentation ---- */

static void every_example_of_the_documentation_loads(void **state) {
    (void)state;
    FILE *in = fopen("docs/scenes.md", "r");
    assert_non_null(in);
    char line[1024], text[8192] = "";
    bool inside = false;
    int count = 0;
    while (fgets(line, sizeof line, in)) {
        if (!inside && strcmp(line, "```yaml\n") == 0) {
            inside = true;
            text[0] = '\0';
        } else if (inside && strcmp(line, "```\n") == 0) {
            inside = false;
            count++;
            RtScene scene;
            RtError error;
            if (load_text(text, &scene, &error) != RT_OK) fail_msg("%s\n%s", error.message, text);
            rt_scene_clear(&scene);
        } else if (inside) {
            assert_true(strlen(text) + strlen(line) < sizeof text);
            strcat(text, line);
        }
    }
    fclose(in);
    assert_true(count >= 5);
}

static void every_scene_that_comes_along_loads(void **state) {
    (void)state;
    glob_t found;
    assert_int_equal(glob("scenes/*.yaml", 0, NULL, &found), 0);
    for (size_t i = 0; i < found.gl_pathc; i++) {
        RtScene scene;
        assert_ok(load(found.gl_pathv[i], &scene, error));
        rt_scene_clear(&scene);
    }
    assert_true(found.gl_pathc >= 3);
    globfree(&found);
}

/* ---- raytally convert ---- */

static int convert(const char *arguments) {
    char command[1024];
    snprintf(command, sizeof command, "%s convert %s 2>/dev/null", RT_PROGRAM, arguments);
    int result = system(command);
    return WIFEXITED(result) ? WEXITSTATUS(result) : -1;
}

static void convert_keeps_the_scene_and_the_files_that_are_there(void **state) {
    (void)state;
    remove(FOLDER "/balls.yaml");
    assert_int_equal(convert("balls:size=1 " FOLDER "/balls.yaml"), 0);
    RtScene made, read;
    assert_ok(rt_builtin_open("balls:size=1", &made, error));
    assert_ok(load(FOLDER "/balls.yaml", &read, error));
    assert_true(rt_scene_fingerprint(&made) == rt_scene_fingerprint(&read));
    rt_scene_clear(&made);
    rt_scene_clear(&read);
    assert_int_equal(convert("balls:size=2 " FOLDER "/balls.yaml"), 2);
    assert_int_equal(convert("balls:size=2 " FOLDER "/balls.yaml --force"), 0);
}

static void convert_refuses_and_leaves_nothing_behind(void **state) {
    (void)state;
    remove(FOLDER "/out.ply");
    assert_int_equal(convert("balls:size=1"), 2);
    assert_int_equal(convert("nothing " FOLDER "/out.yaml"), 2);
    assert_int_equal(convert("balls:size=1 " FOLDER "/out.ply"), 2); /* spheres are no triangles */
    assert_int_equal(access(FOLDER "/out.ply", F_OK), -1);
    assert_int_equal(access(FOLDER "/out.ply.tmp", F_OK), -1);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_scene_is_what_its_file_says),
        cmocka_unit_test(what_is_left_out_has_defaults),
        cmocka_unit_test(a_material_called_default_is_the_default),
        cmocka_unit_test(a_built_in_moved_and_moved_back_is_itself),
        cmocka_unit_test(bad_input_is_refused_with_its_line_and_a_remedy),
        cmocka_unit_test(the_column_is_that_of_the_value),
        cmocka_unit_test(files_that_are_none_are_refused),
        cmocka_unit_test(deep_nesting_is_refused_without_descending),
        cmocka_unit_test(every_prefix_of_a_scene_is_read_or_refused),
        cmocka_unit_test(whichever_allocation_fails_nothing_is_left),
        cmocka_unit_test(a_scene_saved_and_loaded_keeps_every_bit),
        cmocka_unit_test(solids_without_an_end_survive_saving),
        cmocka_unit_test(vertex_normals_survive_saving_bit_for_bit),
        cmocka_unit_test(names_that_cannot_be_written_are_replaced_by_numbers),
        cmocka_unit_test(a_full_disk_is_reported),
        cmocka_unit_test(every_example_of_the_documentation_loads),
        cmocka_unit_test(every_scene_that_comes_along_loads),
        cmocka_unit_test(convert_keeps_the_scene_and_the_files_that_are_there),
        cmocka_unit_test(convert_refuses_and_leaves_nothing_behind),
    };
    return cmocka_run_group_tests(tests, make_folder, NULL);
}
