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

RT_TEST(a_csg_tree_shows_intervals_in_words_and_as_json_and_says_how_many_there_are) {
    const char *ray = RT_SOURCE_DIR "/scenes/csg-lecture.yaml --ray -3,0,0,1,0,0 --accel brute";
    assert_said(trace(ray), 0, OUT ".txt", "csg result      difference 1                      2        2.4");
    assert_true(says(OUT ".txt", "  and                           3.6          4\n"));
    json_auto_t *path = path_of(ray);
    assert_int_equal(rows_of(path, "csg test"), count_of(path, "csg_tests"));
    size_t i;
    json_t *row, *intervals = NULL;
    json_array_foreach(json_object_get(path, "rows"), i, row) {
        if (strcmp(json_string_value(json_object_get(row, "event")), "csg result") == 0)
            intervals = json_object_get(row, "intervals");
    }
    assert_int_equal(json_array_size(intervals), 2);
    assert_true(json_number_value(json_array_get(json_array_get(intervals, 1), 1)) == 4);
}

RT_TEST(a_polygon_shows_its_projection_and_the_edges_that_are_crossed) {
    FILE *file = fopen(OUT ".yaml", "w");
    assert_non_null(file);
    fputs("objects:\n  - polygon: {vertices: [[0, 0, 4], [6, 0, 4], [6, 4, 2], [4, 4, 2], [4, 2, 3], [2, 2, "
          "3], "
          "[2, 4, 2], [0, 4, 2]]}\n",
          file);
    fclose(file);
    assert_int_equal(trace("'" OUT ".yaml' --ray 1,3,0,0,0,1 --accel brute"), 0);
    assert_true(says(OUT ".txt", "its plane at t = 2.5; projected to x, y: (1, 3), 3 edges crossed"));
    assert_int_equal(trace("'" OUT ".yaml' --ray 3,3,0,0,0,1 --accel brute"), 0);
    assert_true(says(OUT ".txt", "(3, 3), 2 edges crossed") && says(OUT ".txt", "it hits nothing"));
    assert_int_equal(trace("'" OUT ".yaml' --ray 9,3,0,0,0,1 --accel brute"), 0);
    assert_false(says(OUT ".txt", "crossed")); /* beside its box */
}

RT_TEST(an_overlay_that_passes_on_every_ray_says_so_and_why) {
    const char *why = "light passes on every ray: ";
    assert_said(trace("balls:size=1 --size 64x64 --pixel 32,50 --accel light+bvh"), 0, OUT ".err", why);
    assert_said(
        raytally_to("2> '" OUT ".err'", "render balls:size=1 --size 8x8 --accel light+bvh -o '" OUT ".png'"),
        0, OUT ".err", why);
    assert_said(raytally_to("> '" OUT ".txt' 2> '" OUT ".err'",
                            "bench balls:size=1 --size 8x8 --accel light+bvh --count-only"),
                0, OUT ".err", why);
    assert_int_equal(trace("balls:size=1 --size 64x64 --pixel 32,50 --accel light:cells=8+bvh"), 0);
    assert_false(says(OUT ".err", why));
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

RT_TEST(rows_inside_an_instance_are_indented_and_name_the_part_and_ids_of_the_whole_scene) {
    static const char ray[] = "balls:size=2,instances=on --size 64x64 --pixel 32,32";
    assert_said(trace(ray), 0, OUT ".txt", "    entered           part ");
    assert_true(says(OUT ".txt", "instances_entered"));
    json_auto_t *path = path_of(ray);
    json_int_t levels = 0;
    size_t i;
    json_t *row;
    json_array_foreach(json_object_get(path, "rows"), i, row) {
        const json_int_t level = json_integer_value(json_object_get(row, "level"));
        if (level > levels) levels = level;
    }
    assert_int_equal(levels, 3);
    assert_int_equal(rows_of(path, "entered"), count_of(path, "instances_entered"));
    assert_said(trace("balls:size=2,instances=on --size 64x64 --pixel 32,32 --depth 3 --svg '" OUT ".svg'"),
                0, OUT ".txt", "sphere, balls");
    unlink(OUT ".svg");
}

RT_TEST(many_object_tests_that_miss_are_one_row_unless_each_is_asked_for) {
    assert_said(trace("balls:size=2 --size 64x64 --pixel 32,30 --accel brute"), 0, OUT ".txt", "all missed");
    assert_int_equal(trace("balls:size=2 --size 64x64 --pixel 32,30 --accel brute --rows 0"), 0);
    assert_false(says(OUT ".txt", "all missed"));
    assert_true(says(OUT ".txt", "object 91, "));
}

/* ---- a ray without a pixel ---- */

/* The numbers of a vector of a path, with a comma behind each. */
static void append_vector(char *text, const json_t *path, const char *name) {
    for (size_t a = 0; a < 3; a++)
        sprintf(text + strlen(text), "%.9g,",
                json_number_value(json_array_get(json_object_get(path, name), a)));
}

RT_TEST(a_given_ray_costs_and_hits_what_the_ray_of_its_pixel_does) {
    char arguments[512] = "balls:size=2 --ray ";
    json_auto_t *path = path_of("balls:size=2 --size 64x64 --pixel 32,30");
    append_vector(arguments, path, "org");
    append_vector(arguments, path, "dir");
    sprintf(arguments + strlen(arguments), "%.9g,%.9g", json_number_value(json_object_get(path, "tmin")),
            HUGE_VAL);
    json_auto_t *given = path_of(arguments);
    static const char *const same[] = {"org", "dir", "tmin", "tmax", "rows", "counts", "object", "t"};
    for (size_t i = 0; i < sizeof same / sizeof same[0]; i++)
        assert_true(json_equal(json_object_get(path, same[i]), json_object_get(given, same[i])));
    assert_true(json_is_null(json_object_get(given, "pixel")));
}

RT_TEST(a_row_of_a_file_of_rays_is_traced) {
    const char *file = RT_BINARY_DIR "/test_cmd_trace.npy";
    char arguments[512];
    assert_int_equal(
        raytally_to("> /dev/null", "rays balls:size=2 --rays diffuse --size 40x40 -o '%s'", file), 0);
    for (int row = 0; row < 2; row++) {
        snprintf(arguments, sizeof arguments, "balls:size=2 --ray '%s:%d' --accel grid", file, row);
        json_auto_t *path = path_of(arguments);
        const json_t *org = json_object_get(path, "org");
        float rays[2][8];
        FILE *in = fopen(file, "rb");
        assert_non_null(in);
        fseek(in, 128, SEEK_SET);
        assert_int_equal(fread(rays, sizeof rays, 1, in), 1);
        fclose(in);
        for (size_t a = 0; a < 3; a++)
            assert_true((float)json_number_value(json_array_get(org, a)) == rays[row][a]);
    }
    assert_said(trace(arguments), 0, OUT ".txt", "test_cmd_trace.npy:1\norg (");
    snprintf(arguments, sizeof arguments, "balls:size=2 --ray '%s:99999999'", file);
    assert_said(trace(arguments), 2, OUT ".err", "has no row '99999999': choose 0..");
}

/* Here the ray ends in front of the floor, here not. */
RT_TEST(a_given_ray_is_asked_for_any_hit_or_followed_with_its_tree) {
    assert_said(trace("balls:size=2 --ray 0,0,9,0,0,-1,0,1 --rays shadow"), 0, OUT ".txt",
                "nothing blocks it");
    assert_said(trace("balls:size=2 --ray 0,0,9,0,0,-1 --rays shadow --accel item+light+cache+bvh"), 0,
                OUT ".txt", "it is blocked by object");
    assert_said(trace("balls:size=2 --ray '0 0 9  0, 0, -1' --rays shadow"), 0, OUT ".txt",
                "it is blocked by");
    assert_said(trace("balls:size=2 --ray 0,0,9,0,0,-1 --depth 2"), 0, OUT ".txt",
                "the ray tree, 2 levels, of ray 0,0,9,0,0,-1");
    assert_true(says(OUT ".txt", "shadow to light 0"));
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
        {"balls --pixel 1,1 --ray 1,2,3,4,5,6", "one of --pixel X,Y and --ray"},
        {"balls --ray 1,2,3", "'1,2,3' is no ray: expected OX,OY,OZ,DX,DY,DZ or"},
        {"balls --ray 1,2,3,4,5,6,7", "is no ray"},
        {"balls --ray 1,2,3,4,5,6,7,8,9", "is no ray"},
        {"balls --ray 1,2,3,4,5,6,", "is no ray"},
        {"balls --ray 1,2,3,4,5,x", "is no ray"},
        {"balls --ray 1,2,3,4,5x6", "is no ray"},
        {"balls --ray 1,2,3,0,0,0", "not a valid ray: its direction is zero"},
        {"balls --ray 1,2,3,4,5,6,7,6", "not a valid ray: its tmax is less than its tmin"},
        {"balls --ray 1,2,3,4,5,6 --light 1", "leave out --light"},
        {"balls --ray 1,2,3,4,5,6 --rays reflection", "leave out --light, and --rays"},
        {"balls --ray nothing.npy:0", "nothing.npy: cannot be opened"},
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
    assert_true(says(OUT ".html", "{\"given\":false,"));
    assert_int_equal(raytally_to("> /dev/null", "%s --ray 0,0,9,0,0,-1", all), 0);
    assert_true(says(OUT ".html", "{\"given\":true,"));
    assert_true(says(OUT ".html", "{\"accel\":\"bvh\",") &&
                says(OUT ".html", "{\"accel\":\"grid:density=1\","));
    unlink(OUT ".html");
}

RT_TESTS(cmd_trace, NULL, NULL)
