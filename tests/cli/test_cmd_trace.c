/* SPDX-License-Identifier: Apache-2.0 */
/* raytally trace and explore, as a user runs them. */
#include "command_testing.h"

#include <jansson.h>

#define OUT RT_BINARY_DIR "/test_cmd_trace"

/* Runs `raytally trace ARGUMENTS`, output to OUT.txt, messages to OUT.err; gives the exit code. */
static int trace(const char *arguments) {
    return raytally_to("> '" OUT ".txt' 2> '" OUT ".err'", "trace %s", arguments);
}

static bool says(const char *path, const char *what) {
    return strstr(text_of(path), what) != NULL;
}

static json_t *path_of(const char *arguments) {
    char all[1024];
    snprintf(all, sizeof all, "%s --json", arguments);
    assert_int_equal(trace(all), 0);
    json_t *path = json_load_file(OUT ".txt", 0, NULL);
    assert_non_null(path);
    return path;
}

static json_int_t rows_of(const json_t *path, const char *event) {
    json_int_t count = 0;
    size_t i;
    json_t *row;
    json_array_foreach(json_object_get(path, "rows"), i, row) {
        const char *name = json_string_value(json_object_get(row, "event"));
        count += strncmp(name, event, strlen(event)) == 0;
    }
    return count;
}

static json_int_t count_of(const json_t *path, const char *counter) {
    return json_integer_value(json_object_get(json_object_get(path, "counts"), counter));
}

RT_TEST(rows_are_steps_extent_tests_and_object_tests_as_many_as_are_counted) {
    static const char *const specs[] = {"bvh",  "grid",     "octree",  "kd",
                                        "wide", "clusters", "extents", "brute"};
    for (size_t i = 0; i < sizeof specs / sizeof specs[0]; i++) {
        char arguments[256];
        snprintf(arguments, sizeof arguments, "balls:size=2 --size 64x64 --pixel 32,30 --accel %s", specs[i]);
        json_auto_t *path = path_of(arguments);
        assert_int_equal(rows_of(path, "step"), count_of(path, "steps"));
        assert_int_equal(rows_of(path, "step, "), count_of(path, "leaf_steps"));
        assert_int_equal(rows_of(path, "extent test"), count_of(path, "extent_tests"));
        assert_int_equal(rows_of(path, "object test"), count_of(path, "object_tests"));
        assert_true(count_of(path, "object_tests") > 0);
        assert_int_equal(count_of(path, "rays"), 1);
    }
}

RT_TEST(every_accelerator_says_the_same_of_where_a_ray_ends) {
    assert_int_equal(trace("balls:size=2 --size 64x64 --pixel 32,30 --accel brute"), 0);
    static char line[256];
    FILE *file = fopen(OUT ".txt", "r");
    assert_non_null(file);
    bool found = false;
    while (!found && fgets(line, sizeof line, file)) found = strncmp(line, "its nearest hit is", 18) == 0;
    fclose(file);
    assert_true(found);
    assert_said(trace("balls:size=2 --size 64x64 --pixel 32,30 --accel item+kd"), 0, OUT ".txt", line);
}

RT_TEST(a_shadow_ray_is_followed_through_overlays) {
    assert_said(trace("balls:size=2 --size 64x64 --pixel 32,50 --rays shadow --accel light:cells=16+bvh"), 0,
                OUT ".txt", "the shadow ray of pixel 32,50");
    assert_said(trace("balls:size=2 --size 64x64 --pixel 32,50 --rays shadow --accel cache+bvh"), 0,
                OUT ".txt", "passed on       by cache");
    assert_said(trace("balls:size=2 --size 64x64 --pixel 32,32 --rays reflection"), 0, OUT ".txt",
                "the reflection ray");
}

/* Embree's own kernels count nothing and name no occluder; skipped where it was not built in. */
RT_TEST(an_occluder_that_is_not_named_has_no_number) {
    const char *arguments = "balls:size=2 --size 64x64 --pixel 20,44 --rays shadow --accel embree";
    if (trace(arguments) == 2 && says(OUT ".err", "without Embree")) return;
    assert_said(trace(arguments), 0, OUT ".txt", "it is blocked\n");
    assert_true(says(OUT ".txt", "total: nothing is counted\n"));
    static const struct {
        const char *what;
        json_type object, blocked;
    } cases[] = {{"20,44 --rays shadow --accel embree", JSON_NULL, JSON_TRUE},
                 {"20,44 --rays shadow --accel bvh", JSON_INTEGER, JSON_TRUE},
                 {"20,40 --rays shadow --accel bvh", JSON_NULL, JSON_FALSE},
                 {"20,44 --accel bvh", JSON_INTEGER, JSON_NULL}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char all[128];
        snprintf(all, sizeof all, "balls:size=2 --size 64x64 --pixel %s", cases[i].what);
        json_auto_t *path = path_of(all);
        assert_int_equal(json_typeof(json_object_get(path, "object")), cases[i].object);
        assert_int_equal(json_typeof(json_object_get(path, "blocked")), cases[i].blocked);
    }
}

RT_TEST(many_object_tests_that_miss_are_one_row_unless_each_is_asked_for) {
    assert_said(trace("balls:size=2 --size 64x64 --pixel 32,30 --accel brute"), 0, OUT ".txt", "all missed");
    assert_int_equal(trace("balls:size=2 --size 64x64 --pixel 32,30 --accel brute --rows 0"), 0);
    assert_false(says(OUT ".txt", "all missed"));
    assert_true(says(OUT ".txt", "object 91, "));
}

/* ---- ray trees ---- */

#define LECTURE "'" RT_SOURCE_DIR "/scenes/lecture.yaml' --size 80x60"

/* The rays of a tree below and with `ray`; adds what each adds itself to sum[3]. */
static json_int_t walk(const json_t *ray, double sum[3]) {
    json_int_t count = 1;
    size_t i;
    json_t *child;
    json_array_foreach(json_object_get(ray, "rays"), i, child) count += walk(child, sum);
    const char *kind = json_string_value(json_object_get(ray, "kind"));
    const bool hits = strcmp(kind, "shadow") != 0 && json_is_integer(json_object_get(ray, "object"));
    const json_t *own = json_object_get(ray, "light");
    if (hits) own = json_object_get(json_object_get(ray, "terms"), "ambient");
    for (size_t a = 0; a < 3; a++) sum[a] += json_number_value(json_array_get(own, a));
    return count;
}

RT_TEST(a_tree_grows_by_one_level_with_depth_and_adds_up_to_the_color) {
    json_int_t before = 0;
    for (int depth = 1; depth <= 4; depth++) {
        char arguments[256];
        double sum[3] = {0};
        snprintf(arguments, sizeof arguments, LECTURE " --pixel 42,42 --depth %d",
                 depth); /* the glass ball */
        json_auto_t *tree = path_of(arguments);
        json_int_t count = walk(json_object_get(tree, "tree"), sum);
        assert_int_equal(json_integer_value(json_object_get(tree, "levels")), depth);
        assert_true(count > before);
        before = count;
        for (size_t a = 0; a < 3; a++) {
            double color = json_number_value(json_array_get(json_object_get(tree, "color"), a));
            assert_true(sum[a] > 0 && sum[a] - color < 1e-5 && color - sum[a] < 1e-5);
        }
    }
}

RT_TEST(a_tree_is_printed_with_each_ray_the_five_terms_and_sums) {
    assert_said(trace(LECTURE " --pixel 42,42 --depth 2 --accel grid"), 0, OUT ".txt",
                "the ray tree, 2 levels, of pixel 42,42 of 80 x 60");
    assert_true(says(OUT ".txt", "  shadow to light 0  ") && says(OUT ".txt", "sphere, glass"));
    assert_true(says(OUT ".txt", "ambient  diffuse  specular  reflected  transmitted   light"));
    assert_true(says(OUT ".txt", "would reflect or transmit, but the depth is reached"));
    assert_said(trace(LECTURE " --pixel 42,42 --depth 5 --rows 3"), 0, OUT ".txt",
                "more rays\n       --rows 0 prints each\n");
}

RT_TEST(ideal_tests_one_object_for_each_ray_of_a_tree_that_hits) {
    assert_said(trace(LECTURE " --pixel 35,44 --depth 4 --accel ideal"), 0, OUT ".txt",
                "total: 15 rays in 4 levels, 10 object_tests, 0 extent_tests");
}

RT_TEST(a_path_or_a_tree_is_drawn_in_the_format_that_the_name_says) {
    const char *scene = "balls:size=2 --size 64x64 --pixel 32,30";
    assert_int_equal(raytally_to("> /dev/null", "trace %s --svg " OUT ".svg", scene), 0);
    assert_true(says(OUT ".svg", "<svg"));
    assert_int_equal(raytally_to("> /dev/null", "trace %s --depth 3 --svg " OUT ".pdf", scene), 0);
    assert_true(says(OUT ".pdf", "%PDF"));
    unlink(OUT ".svg");
    unlink(OUT ".pdf");
}

RT_TEST(wrong_usage_exits_with_2_and_says_what_would_be_right) {
    const struct {
        const char *arguments, *says;
    } cases[] = {
        {"", "a SCENE is missing"},
        {"balls", "--pixel X,Y"},
        {"balls --pixel 3", "as in 256,200"},
        {"balls --pixel -1,2", "as in 256,200"},
        {"balls --pixel 4294967300,1", "as in 256,200"},
        {"balls --pixel 1,4294967296", "as in 256,200"},
        {"balls --pixel 18446744073709551620,1", "as in 256,200"},
        {"balls --pixel ' 1,1'", "as in 256,200"},
        {"balls --pixel 1,1,", "as in 256,200"},
        {"balls --pixel 512,0", "choose 0..511,0..511"},
        {"balls --pixel 0,0 --accel bvhh", "mean 'bvh'"},
        {"balls --pixel 0,0 --rays random", "expected primary"},
        {"balls --pixel 0,0 --svg a.gif", ".svg or .pdf"},
        {"'no\xff.yaml' --pixel 0,0 --json", "is not UTF-8"},
        {"balls --pixel 0,0 --svg a.svg --svg b.svg", "give one file"},
        {"balls --pixel 0,0 tetra", "one SCENE"},
        {"balls --pixel 256,256 --rays shadow --light 3", "there is no light 3"},
        {"tetra --pixel 0,0 --rays shadow", "hits nothing"},
        {"tetra --pixel 256,256 --rays transmission", "transmission"},
        {"balls --pixel 0,0 --depth 0", "1..64"},
        {"balls --pixel 0,0 --depth 65", "1..64"},
        {"balls --pixel 0,0 --depth 2 --rays shadow", "leave out --rays"},
        {"balls --pixel 0,0 --depth 2 --light 1", "leave out --rays"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++)
        assert_said(trace(cases[i].arguments), 2, OUT ".err", cases[i].says);
}

/* tests/check_pages.sh tests what the page does, in a browser. */
RT_TEST(a_page_to_explore_holds_the_rays_and_names_the_accelerators) {
    const char *const all =
        "explore balls:size=1 --size 8x6 --accel bvh --accel grid:density=1 -o '" OUT ".html'";
    const int code = raytally_to("> '" OUT ".txt' 2> '" OUT ".err'", "%s", all);
    if (code == 2 && says(OUT ".err", "npm")) RT_SKIP("npm, and a network once");
    assert_int_equal(code, 0);
    assert_true(says(OUT ".txt", "with the rays of all pixels"));
    assert_true(says(OUT ".html", "{\"accel\":\"bvh\",") &&
                says(OUT ".html", "{\"accel\":\"grid:density=1\","));
    unlink(OUT ".html");
}

RT_TESTS(cmd_trace, NULL, NULL)
