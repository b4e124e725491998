/* SPDX-License-Identifier: Apache-2.0 */
/* The YAML scene format: rejected input, with its position; and whichever allocation fails, nothing leaks. */
#include "yaml_testing.h"

#include <sys/resource.h>
#include <sys/wait.h>

/* ---- bad input: its line, and a phrase of the message ---- */

#define SPHERE "objects:\n- sphere: {center: [0, 0, 0], radius: 1}\n"
#define SOLIDS                                                                                               \
    "solids:\n"                                                                                              \
    "- {name: a, sphere: {center: [0, 0, 0], radius: 1}}\n"                                                  \
    "- {name: h, half_space: {point: [0, 0, 0], normal: [0, 0, 1]}}\n"                                       \
    "# line 4\n"
#define PLACE                "ratio: 1, place: [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0]"
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
    {"# one\n# two\na: b\xff\n", 3, "UTF-8: invalid leading UTF-8 octet"},
    {"a: 1\n\x01: 2\n", 2, "control characters are not allowed"},
    {"%TAG !a! tag:a,2000:\n--- {}\n", 1, "%TAG is not supported"},
    {"a: 1\n...\r%TAG !a! tag:a,2000:\n--- {}\n", 2, "%TAG is not supported"},
    {"just words\n", 1, "the keys camera"},
    {"- a\n- b\n", 1, "found a list"},
    {SPHERE "---\n" SPHERE, 3, "second document"},
    {"{}\n", 1, "'objects' is missing"},
    {"light: 1\nformat: 2\n", 2, "reads formats 1..1: use the raytally that wrote it, or a newer one"},
    {"format: 0\n" SPHERE, 1, "expected a whole number 1.."},
    {"objects: []\n", 1, "at least 1"},
    {"objects:\n", 1, "expected a list of objects, found nothing"},
    {"objects: &a [*a]\n", 1, "aliases"},
    {"a: &a [x,x]\nb: &b [*a,*a]\n", 2, "b[0]: aliases (*name) are not supported"},
    /* keys */
    {"object:\n  - sphere: {}\n", 1, "did you mean 'objects'?"},
    {SPHERE "camera:\n  from: [1, 1, 1]\n  too: [0, 0, 0]\n", 5, "unknown key 'too'"},
    {"objects:\n- sphere: {center: [0, 0, 0],\n   radios: 1}\n", 3, "did you mean 'radius'?"},
    {"objects:\n- sphere:\n    radius: 1\n", 2, "'center' is missing"},
    {SPHERE SPHERE, 3, "'objects' is given twice"},
    {"objects:\n- ? [a]\n  : 1\n", 2, "plain word"},
    /* numbers */
    {"objects:\n- sphere:\n    center: [0, 0, 0]\n    radius: 0\n", 4, "radius above 0"},
    {"objects:\n- sphere:\n    radius: 1\n    center: [0,\n      nan, 0]\n", 5,
     "invalid value 'nan': expected a finite number"},
    {"objects:\n- sphere: {center: [0, 1, 0], radius: 1e39}\n", 2, "fits float32"},
    {"objects:\n- sphere: {center: [0, 1, 0], radius: 1m}\n", 2, "invalid value '1m'"},
    {"objects:\n- sphere: {center: [-1e400, 1, 0], radius: 1}\n", 2,
     "invalid value '-1e400': expected a finite number"},
    {SPHERE "camera: {size: [1e400, 1]}\n", 3, "a whole number 1..32768"},
    {"objects:\n- sphere: {center: [0, 1, 0], radius: }\n", 2, "expected a finite number"},
    {"objects:\n- sphere: {center: [0, 1, 0], radius: \"1\\02\"}\n", 2, "zero byte"},
    {"objects:\n- sphere: {center: [0, 1, 0], radius: [1]}\n", 2,
     "expected a number, as in 1.5, found a list"},
    {"objects:\n- sphere: {center: [0, 1], radius: 1}\n", 2, "the length of the list is 2"},
    {"objects:\n- sphere: {center: [0, 1, 2, 3], radius: 1}\n", 2, "more than 3"},
    {"objects:\n- sphere: {center: 7, radius: 1}\n", 2, "invalid value '7': expected a list of 3 numbers"},
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
     "64 characters: expected 1..63"},
    {SPHERE "materials:\n- {name: \"a\\nb\"}\n", 4, "control character"},
    {SPHERE "materials: {red: {color: [1, 0, 0]}}\n", 3, "expected a list of materials, found a mapping"},
    /* camera, lights, colours */
    {SPHERE "camera:\n  from: [1, 2, 3]\n", 3, "belong together"},
    {SPHERE "camera:\n  from: [1, 2, 3]\n  at: [1, 2, 3]\n", 5, "no direction"},
    {SPHERE "camera:\n  from: [0, 0, 3]\n  at: [0, 0, 0]\n  up: [0, 0, 1]\n", 6, "`up`"},
    {SPHERE "camera:\n  up: [0, 0, 0]\n", 4, "`up`"},
    {SPHERE "camera:\n  up: [0, 0, 1]\n  fov: 180\n", 5, "below 180"},
    {SPHERE "camera:\n  near: -1\n", 4, "at least 0"},
    {SPHERE "camera:\n  size: [0, 100]\n", 4, "1..32768"},
    {SPHERE "camera:\n  size: [-5, 100]\n", 4, "whole number"},
    {SPHERE "camera:\n  from: [1e18, 0, 0]\n  at: [0, 0, 0]\n", 4, "nearer"},
    {SPHERE "lights:\n- {position: [0, 0, 0]}\n- {position: [0, 0, 0], intensity: [-1, 0, 0]}\n", 5,
     "negative"},
    {SPHERE "lights:\n- {intensity: [1, 1, 1]}\n", 4, "'position' is missing"},
    {SPHERE "background: [0, -1, 0]\n", 3, "must not be negative"},
    {SPHERE "ambient: [a, b, c]\n", 3, "invalid value 'a'"},
    /* meshes, built-ins, transforms */
    {SPHERE "- mesh:\n    path: no-such.obj\n", 4, "no-such.obj"},
    {SPHERE "- mesh:\n    path: scene.yaml\n", 4,
     "no format '.yaml' can be read as a mesh. These can: .obj .ply"},
    {SPHERE "- mesh:\n    path: ../../../../../../../../dev/zero\n", 4,
     "no format '.' can be read as a mesh"},
    {SPHERE "- mesh:\n    path: /dev/zero.obj\n", 4, "No such file"},
    {SPHERE "- builtin:\n    name: scene.yaml\n", 4, "scene.yaml"}, /* scenes cannot include each other */
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
    {SOLIDS "- {name: c, standard: {kind: cone, " PLACE
            ", caps: [[0, 0, -1, 0], [0, 0, 1, 1.01]]}}\n" CSG("a"),
     5, "the caps are not those of the cone"},
    {SOLIDS "- {name: c, standard: {kind: cone, " PLACE
            ", caps: [[0, 0, -1, 0], [0x1.8p-40, 0, 1, 1]]}}\n" CSG("a"),
     5, "the caps are not those of the cone"},
    {SOLIDS "- {name: c, standard: {kind: cone, " PLACE ", caps: [[0, 0, -1, 0]]}}\n" CSG("a"), 5,
     "the caps are not those of the cone"},
    {SOLIDS "- {name: c, standard: {kind: sphere, " PLACE
            ", caps: [[0, 0, -1, 0], [0, 0, 1, 1]]}}\n" CSG("a"),
     5, "the caps are not those of the cone"},
    {SOLIDS "- {name: c, box: {lo: [0, 0, 0], hi: [1, 1, 0]}}\n" CSG("a"), 5, "lo < hi on each axis"},
    {SOLIDS "- {name: c, torus: {center: [0, 0, 0], major: 1, minor: 2}}\n" CSG("a"), 5, "minor < major"},
    {SOLIDS "- {name: c, half_space: {point: [0, 0, 0], normal: [0, 0, 0]}}\n" CSG("a"), 5,
     "the normal not 0"},
    {SOLIDS "- {name: c, polyhedron: {}}\n" CSG("a"), 5, "expected exactly one of vertices, planes, found 0"},
    {SOLIDS "- {name: c, polyhedron: {vertices: [[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]]}}\n" CSG("a"), 5,
     "in one plane"},
    {SOLIDS "- {name: c, polyhedron: {planes: [[1, 0, 0, 1e400]]}}\n" CSG("a"), 5, "invalid value '1e400'"},
    {SOLIDS "- {name: c, polyhedron: {planes: [[1, 0, nan, 1]]}}\n" CSG("a"), 5,
     "planes[0][2]: invalid value 'nan'"},
    {SOLIDS "- name: c\n  mesh:\n    path: corner.obj\n" CSG("a"), 7, "at least 4 triangles, this one has 1"},
    {SOLIDS "- name: c\n  mesh:\n    path: open.obj\n" CSG("a"), 7, "closed"},
    {SOLIDS CSG("x"), 6, "no solid 'x'"},
    {SOLIDS CSG("a |"), 6, "at character 4"},
    {SOLIDS CSG("''"), 6, "0 characters"},
    {SOLIDS CSG("h"), 6, "unbounded"},
    {SOLIDS CSG("a | h"), 6, "unbounded"},
    {SOLIDS CSG("a, extents: maybe"), 6, "invalid value 'maybe': expected on or off"},
    {SOLIDS CSG("a, material: blu"), 6, "no material 'blu'"},
    {"objects:\n- csg: {extents: on}\n", 2, "'formula' is missing"},
    {SOLIDS TIMES_64("c", "a") TIMES_64("d", "c") TIMES_64("e", "d") TIMES_64("f", "e") TIMES_64("g", "f")
         CSG("g"),
     9, "the limit is 16777216"},
};

RT_TEST(bad_input_is_refused_with_its_line_and_a_remedy) {
    int64_t live = rt_alloc_live();
    for (size_t i = 0; i < sizeof hostile / sizeof hostile[0]; i++) {
        RtScene scene;
        char place[512];
        snprintf(place, sizeof place, "%s/scene.yaml:%d:", RT_TEST_FOLDER, hostile[i].line);
        assert_bad_input_at(load_text(hostile[i].text, &scene, error), place, hostile[i].says);
        assert_int_equal(rt_alloc_live(), live);
    }
}

RT_TEST(files_that_are_none_are_refused) {
    RtScene scene;
    assert_bad_input(load(RT_TEST_FOLDER "/missing.yaml", &scene, error), "missing.yaml: cannot be opened");
    assert_bad_input(load(RT_TEST_FOLDER, &scene, error), "not a file");
    assert_bad_input(load("/dev/zero", &scene, error), "/dev/zero");
    write_bytes(RT_TEST_FOLDER "/zero.yaml", "objects:\n- \0", 12);
    assert_bad_input(load(RT_TEST_FOLDER "/zero.yaml", &scene, error), "zero.yaml:2:3: there is a byte of 0");
}

RT_TEST(deep_nesting_is_refused_without_descending) {
    static const char *const levels[] = {"[", "- ", "{a: ", "? ", "[{a: ", "!t [", "[? "};
    enum { DEPTH = 100000 };
    static char text[DEPTH * 8];
    for (size_t i = 0; i < sizeof levels / sizeof levels[0]; i++) {
        size_t length = strlen(levels[i]);
        for (size_t k = 0; k < DEPTH; k++) memcpy(text + k * length, levels[i], length + 1);
        RtScene scene;
        assert_bad_input_at(load_text(text, &scene, error), RT_TEST_FOLDER "/scene.yaml:1:",
                            strchr(levels[i], '?') ? "plain word" : "more than 32 deep");
    }
}

/* `head`, then `part` for `bytes` bytes, then `tail`. */
static RtStatus parse_much(const char *head, const char *part, size_t bytes, const char *tail,
                           RtError *error) {
    size_t length = strlen(head), step = strlen(part);
    OWNED_MEMORY char *text = rt_alloc(length + bytes + step + strlen(tail) + 1, 1);
    assert_non_null(text);
    memcpy(text, head, length);
    for (size_t end = length + bytes; length < end; length += step) memcpy(text + length, part, step);
    strcpy(text + length, tail);
    OWNED_SCENE scene;
    rt_scene_init(&scene);
    return rt_yaml_load_text("much", text, rt_builtin_open, &scene, error);
}

/* Most of these would take hours where time grows with the square of the text. */
RT_TEST(much_of_anything_is_refused_with_its_place_and_soon) {
    enum { MB = 1000000 };
    static const struct {
        const char *head, *part, *tail, *place, *says;
        size_t bytes;
    } cases[] = {
        {"objects:\n- sphere: {center: [0, 0, 0], radius: ", "1", "}\n", "much:2:39:", "'11111", 10 * MB},
        {"objects:\n- sphere: {center: [0, 0, 0], radius: '", "x", "'}\n", "much:2:39:", "'xxxxx", 10 * MB},
        {"materials:\n- name: ", "x", "\nobjects: []\n", "much:2:9:", "expected 1..63", 10 * MB},
        {"objects:\n- csg: {formula: ", "(", "}\n", "much:2:18:", "character 10000001", 10 * MB},
        {"'", "x", "': 1\n", "much:1:", "not YAML", MB},
        {"? ", "x", "\n: 1\n", "much:1:3:", "unknown key 'xxxxx", 10 * MB},
        {"", "a: 1\n", "", "much:1:1:", "unknown key 'a'", 4 * MB},
        {"objects:\n", "- &a1 x\n", "- *a1\n", "much:", "aliases", 4 * MB},
        {"a: &a [x, x]\nb: &b [*a", ", *a", "]\n", "much:2:8:", "b[0]: aliases", 4 * MB},
        {"", "%TAG !a! tag:a,2000:\n", "--- {}\n", "much:1:1:", "%TAG", 4 * MB},
        {"objects: [", ",", "", "much:1:11:", "not YAML", MB},
        {"objects: [", "[], ", "]", "much:1:11:", "objects[0]: expected the keys sphere", 4 * MB},
        {"objects:\n", "\t", "", "much:2:", "not YAML", MB},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        int64_t live = rt_alloc_live();
        assert_bad_input_at(parse_much(cases[i].head, cases[i].part, cases[i].bytes, cases[i].tail, error),
                            cases[i].place, cases[i].says);
        assert_int_equal(rt_alloc_live(), live);
    }
}

RT_TEST(line_ends_of_windows_do_not_matter) {
    char text[2 * sizeof everything] = "";
    as_in_windows(everything, text);
    OWNED_SCENE scene = yaml_scene(everything), windows = yaml_scene(text);
    assert_true(rt_scene_fingerprint(&scene) == rt_scene_fingerprint(&windows));
}

RT_TEST(every_prefix_of_a_scene_is_read_or_refused) {
    for (size_t length = 0; length < sizeof everything; length += RT_SHARE(1, 7))
        assert_read_or_refused(RT_TEST_FOLDER "/scene.yaml", everything, length);
}

/* ---- memory ---- */

RT_TEST(whichever_allocation_fails_nothing_is_left) {
    write_text(RT_TEST_FOLDER "/scene.yaml", everything);
    RtScene scene;
    assert_fails_cleanly(load(RT_TEST_FOLDER "/scene.yaml", &scene, error), rt_scene_clear(&scene));
}

/* libyaml's own allocations fail where the address space ends: in a child, which is given little more than it
 * has. Sanitizers need all of it. */
RT_TEST(too_little_memory_for_libyaml_is_out_of_memory) {
    if (RT_SANITIZED) RT_SKIP("a build without sanitizers");
    enum { LENGTH = 100000000 };
    OWNED_MEMORY char *text = rt_alloc(LENGTH + 2, 1);
    assert_non_null(text);
    memset(text, 'x', LENGTH);
    pid_t child = fork();
    if (child == 0) {
        unsigned long pages = 0;
        FILE *in = fopen("/proc/self/statm", "r");
        if (!in || fscanf(in, "%lu", &pages) != 1) _exit(1);
        rlim_t most = (rlim_t)pages * (rlim_t)sysconf(_SC_PAGESIZE) + LENGTH / 2;
        setrlimit(RLIMIT_AS, &(struct rlimit){most, most});
        RtScene scene;
        RtError error = {RT_OK, ""};
        _exit(rt_yaml_load_text("much", text, NULL, &scene, &error) == RT_NO_MEMORY &&
                      strstr(error.message, "parsing YAML")
                  ? 0
                  : 1);
    }
    int result = 1;
    assert_true(child > 0 && waitpid(child, &result, 0) == child);
    assert_int_equal(result, 0);
}

RT_TESTS(yaml_refusals, make_folder, NULL)
