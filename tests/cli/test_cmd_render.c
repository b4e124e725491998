/* SPDX-License-Identifier: Apache-2.0 */
/* raytally render, as a user runs it: what it writes, what it refuses, and the rays of the Standard
 * Procedural Databases. */
#include "command_testing.h"

#include "core/base/file.h"

#include <jansson.h>

#define OUT   RT_BINARY_DIR "/test_cmd_render"
#define STATS OUT ".json"
#define SMALL "balls:size=1 --size 8x8 "

/* Runs `raytally render ARGUMENTS`, output and messages to OUT.txt; gives the exit code. */
static int render(const char *arguments) {
    return raytally_to("> '" OUT ".txt' 2>&1", "render %s", arguments);
}

static void assert_says(const char *what) {
    const char *text = text_of(OUT ".txt");
    if (!strstr(text, what)) fail_msg("'%s' is not in: %s", what, text);
}

static json_int_t counter(const json_t *stats, const char *kind, const char *name) {
    return json_integer_value(json_object_get(json_object_get(json_object_get(stats, "kinds"), kind), name));
}

static json_t *stats_of(const char *arguments) {
    char all[1024];
    snprintf(all, sizeof all, "%s --stats " STATS, arguments);
    assert_int_equal(render(all), 0);
    json_t *stats = json_load_file(STATS, 0, NULL);
    assert_non_null(stats);
    unlink(STATS);
    return stats;
}

static void assert_close(const char *scene, const char *what, json_int_t got, double published,
                         double percent) {
    if (fabs((double)got - published) > percent / 100 * published)
        fail_msg("%s: %lld %s rays are not within %g %% of %.0f", scene, (long long)got, what, percent,
                 published);
}

/* Rays by kind at 512 x 512 pixels' corners and depth 5, as the README of SPD (Haines) gives them. Havran
 * 1999 publishes a little more for balls, 959244 and 179884; ours rise to his when secondary rays start so
 * close to the surface that they hit it again (an offset of 2^-24 of the point), and move by 0.01 %
 * at most for all offsets from 2^-21 to 2^-14. Of gears 3 % fewer rays are transmitted than published: here
 * total reflection makes one reflected ray and none that is transmitted. */
RT_TEST(the_databases_have_the_rays_that_spd_publishes) {
    static const struct {
        const char *scene;
        json_int_t objects;
        double hits, shadow, reflection, transmission;
        double percent; /* within which transmitted rays are */
    } cases[] = {
        {"balls", 7382, 263169, 954368, 175095, 0, 0},
        {"gears", 9345, 245086, 2246955, 304643, 207564, 4},
        {"mount", 8196, 173125, 412922, 354769, 354769, 1},
        {"rings", 8401, 263169, 1085002, 315236, 0, 0},
        {"teapot", 9264, 161120, 407656, 225248, 0, 0},
        {"tetra", 4096, 49788, 46112, 0, 0, 0},
        {"tree", 8191, 169836, 1097419, 0, 0, 0},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i += RT_SHARE(1, 4)) {
        const char *scene = cases[i].scene;
        char arguments[128];
        snprintf(arguments, sizeof arguments, "%s --size 512x512 --corners --depth 5", scene);
        json_auto_t *stats = stats_of(arguments);
        assert_int_equal(json_integer_value(json_object_get(stats, "objects")), cases[i].objects);
        assert_int_equal(counter(stats, "primary", "rays"), 513 * 513);
        assert_close(scene, "hit", counter(stats, "primary", "hits"), cases[i].hits, 1);
        assert_close(scene, "shadow", counter(stats, "shadow", "rays"), cases[i].shadow, 1);
        assert_close(scene, "reflected", counter(stats, "reflection", "rays"), cases[i].reflection, 1);
        assert_close(scene, "transmitted", counter(stats, "transmission", "rays"), cases[i].transmission,
                     cases[i].percent);
    }
}

RT_TEST(everything_is_written_at_once_and_the_image_depends_on_no_thread) {
    assert_int_equal(render("balls:size=2 --size 80x60 --threads 1 -o " OUT ".png --structure " OUT
                            ".structure.png --heatmap object_tests " OUT ".heat.png --heatmap steps " OUT
                            ".steps.png --stats " STATS),
                     0);
    assert_says("Wrote");
    assert_int_equal(render("balls:size=2 --size 80x60 --threads 2 --accel brute -o " OUT ".2.png"), 0);
    assert_int_equal(system("cmp -s '" OUT ".png' '" OUT ".2.png'"), 0);
    const char *const files[] = {OUT ".png",      OUT ".2.png",     OUT ".structure.png",
                                 OUT ".heat.png", OUT ".steps.png", STATS};
    for (size_t i = 0; i < sizeof files / sizeof files[0]; i++) {
        if (!rt_file_exists(files[i])) fail_msg("%s was not written", files[i]);
        unlink(files[i]);
    }
}

RT_TEST(heatmaps_of_several_accelerators_come_with_the_counts_of_each) {
    json_auto_t *both = stats_of(SMALL "--accel grid --accel kd --heatmap steps " OUT ".png");
    assert_says("grid: ");
    assert_says("kd: ");
    assert_says(" steps a ray.");
    json_auto_t *alone = stats_of(SMALL "--accel kd");
    json_t *compared = json_object_get(both, "compared");
    assert_int_equal(json_array_size(compared), 1);
    json_t *kd = json_array_get(compared, 0);
    assert_true(json_equal(json_object_get(kd, "kinds"), json_object_get(alone, "kinds")));
    assert_true(json_equal(json_object_get(kd, "structure"), json_object_get(alone, "structure")));
    assert_int_equal(json_array_size(json_object_get(alone, "compared")), 0);
    unlink(OUT ".png");
}

RT_TEST(a_structure_is_a_vector_drawing_by_its_name_and_the_same_bytes_every_time) {
    static const char *const how[] = {"", "--slice z --leaves"}, *const formats[] = {"svg", "pdf"};
    for (int i = 0; i < 4; i++) {
        char arguments[256], compare[600];
        for (int run = 0; run < 2; run++) {
            snprintf(arguments, sizeof arguments, SMALL "--accel bvh %s --structure " OUT ".%d.%s",
                     how[i / 2], run, formats[i % 2]);
            assert_int_equal(render(arguments), 0);
        }
        snprintf(compare, sizeof compare, "cmp '" OUT ".0.%s' '" OUT ".1.%s'", formats[i % 2],
                 formats[i % 2]);
        assert_int_equal(system(compare), 0);
        snprintf(compare, sizeof compare, OUT ".0.%s", formats[i % 2]);
        assert_memory_equal(text_of(compare), i % 2 ? "%PDF" : "<?xml", 4);
        unlink(compare);
        snprintf(compare, sizeof compare, OUT ".1.%s", formats[i % 2]);
        unlink(compare);
    }
}

RT_TEST(a_check_compares_every_ray_with_brute) {
    assert_said(render("balls:size=2 --size 64x64 --accel grid --check"), 0, OUT ".txt",
                "the hits of all 4096 primary rays equal brute's");
    assert_says("shadow rays equal brute's");
    assert_says("reflection rays equal brute's");
    assert_says("the frame equals brute's, bit for bit");
    assert_said(render("balls:size=2 --size 33x20 --corners --accel item+light+cache+octree --check"), 0,
                OUT ".txt", "the frame equals brute's, bit for bit");
}

RT_TEST(work_of_the_build_is_reported_apart_from_tracing) {
    static const char *const specs[] = {"brute", "item+brute"};
    for (int i = 0; i < 2; i++) {
        char arguments[128];
        snprintf(arguments, sizeof arguments, "balls:size=1 --size 32x32 --accel %s", specs[i]);
        json_auto_t *stats = stats_of(arguments);
        const json_t *build = json_object_get(json_object_get(stats, "structure"), "build");
        assert_true(json_is_object(build));
        assert_true((json_integer_value(json_object_get(build, "object_tests")) > 0) == (i == 1));
        assert_int_equal(counter(stats, "primary", "object_tests") < 32 * 32 * 2, i == 1);
    }
}

RT_TEST(a_picture_of_cells_alone_takes_no_image_of_the_scene) {
    const char *const layers[] = {"item", "light:cells=8"};
    for (int i = 0; i < 2; i++) {
        char arguments[512];
        snprintf(arguments, sizeof arguments, SMALL "--accel %s+bvh --structure " OUT ".png", layers[i]);
        assert_said(render(arguments), 0, OUT ".txt",
                    "8 x 8 pixels, not traced: the picture shows only cells");
        snprintf(arguments, sizeof arguments,
                 SMALL "--accel %s+bvh --structure " OUT ".with.png -o " OUT ".image.png", layers[i]);
        assert_said(render(arguments), 0, OUT ".txt", "64 primary");
        assert_int_equal(system("cmp '" OUT ".png' '" OUT ".with.png'"), 0);
    }
    assert_said(render(SMALL "--accel item+bvh --layer bvh --structure " OUT ".png"), 0, OUT ".txt",
                "drawn over an image by bvh");
    assert_int_equal(system("grep -q Mrays " OUT ".txt"), 256); /* of bvh, under the name of another */
    unlink(OUT ".png");
    unlink(OUT ".with.png");
    unlink(OUT ".image.png");
}

RT_TEST(options_of_structures_are_taken_by_the_layer_that_they_are_for) {
    assert_int_equal(render(SMALL "--accel light:cells=8+bvh --light 1 --pixel 4,6 --structure " OUT ".png"),
                     0);
    assert_int_equal(render(SMALL "--accel light:cells=8+bvh --layer bvh --level 0..9 --leaves --slice z "
                                  "--structure " OUT ".png"),
                     0);
    unlink(OUT ".png");
}

RT_TEST(wrong_usage_exits_with_2_and_says_what_would_be_right) {
    const struct {
        const char *arguments, *says;
    } cases[] = {
        {"", "a SCENE is missing"},
        {"balls", "-o FILE.png"},
        {"balls tetra -o " OUT ".png", "one SCENE"},
        {"ball -o " OUT ".png", "mean 'balls'"},
        {"balls -o " OUT ".exr", "expected a file name that ends in .png"},
        {"balls -o " OUT ".png -o " OUT ".png", "give one file"},
        {"balls --accel bvhh -o " OUT ".png", "mean 'bvh'"},
        {"balls --size 0x5 -o " OUT ".png", "WIDTHxHEIGHT"},
        {"balls --size 32768x32768 -o " OUT ".png", "smaller image"},
        {"balls --size 2000x2000 --memory 1M -o " OUT ".png", "it needs more than 1 MB of memory (that of "},
        {"balls --corners --samples 2 -o " OUT ".png", "corners"},
        {"balls --samples 65 -o " OUT ".png", "1..64"},
        {"balls --depth 0 -o " OUT ".png", "1..64"},
        {"balls --threads 1000000000 -o " OUT ".png", "1..1024"},
        {"balls --heatmap steps", "FILE.png"},
        {"balls --heatmap-max 5 -o " OUT ".png", "--heatmap COUNTER FILE.png"},
        {"balls --heatmap-max 0 --heatmap steps " OUT ".png", "above 0"},
        {"balls --heatmap-scale cubic --heatmap steps " OUT ".png", "linear or log"},
        {"balls --heatmap-rays random --heatmap steps " OUT ".png", "expected primary"},
        {"balls --heatmap-difference --heatmap steps " OUT ".png", "--accel twice"},
        {"balls --accel bvh --accel kd -o " OUT ".png", "only --heatmap takes several accelerators"},
        {"balls --level 3 -o " OUT ".png", "--structure FILE.png"},
        {"balls --level 5..3 --structure " OUT ".png", "as in 3 or 2..5"},
        {"balls --level 4294967296 --structure " OUT ".png", "as in 3 or 2..5"},
        {"balls --level 0..4294967297 --structure " OUT ".png", "as in 3 or 2..5"},
        {"balls --level 2.. --structure " OUT ".png", "as in 3 or 2..5"},
        {"balls --level -1 --structure " OUT ".png", "as in 3 or 2..5"},
        {"balls --slice w --structure " OUT ".png", "as in z or z=0.5"},
        {"balls --slice z= --structure " OUT ".png", "as in z or z=0.5"},
        {"balls:size=1 --size 8x8 --level 40 --structure " OUT ".png", "none of the"},
        {"balls:size=1 --size 8x8 --layer grid --structure " OUT ".png", "no layer 'grid'"},
        {"balls:size=1 --size 8x8 --accel light:cells=8+bvh --light 3 --structure " OUT ".png", "no light 3"},
        {"balls:size=1 --size 8x8 --accel light:cells=8+bvh --pixel 8,0 --structure " OUT ".png",
         "choose 0..7,0..7"},
        {SMALL "--light 99 --structure " OUT ".png", "--light needs the cells around a light"},
        {SMALL "--pixel 4,4 --structure " OUT ".png", "--pixel needs the cells around a light"},
        {SMALL "--accel item+bvh --pixel 0,0 --structure " OUT ".png", "the picture shows item"},
        {SMALL "--accel item+bvh --slice z --structure " OUT ".png", "--slice needs a layer that has boxes"},
        {SMALL "--accel light:cells=8+bvh --level 2 --structure " OUT ".png", "the picture shows light"},
        {SMALL "--accel light:cells=8+bvh --leaves --structure " OUT ".png",
         "--leaves needs a layer that has boxes"},
        {SMALL "--accel light:cells=8+bvh --layer bvh --light 0 --structure " OUT ".png",
         "the picture shows bvh"},
        {"balls --heatmap step " OUT ".png", "mean 'steps'"},
        {"balls --heatmap steps " OUT ".png --heatmap steps " OUT ".2.png", "--heatmap steps: both"},
        {"balls --heatmap steps " OUT ".png --heatmap object_tests " OUT ".png", "written twice"},
        {"balls -o " OUT ".png --structure " OUT ".png", "written twice"},
        {"balls --structure " OUT ".png --structure " OUT ".2.png", "--structure: both"},
        {"balls --stats " OUT ".txt", ".json"},
        {"'no\xff.yaml' --stats " OUT ".json", "is not UTF-8"},
        {"balls --accel brute --structure " OUT ".png", "no picture of"},
        {"balls:size=1 --size 8x8 -o " OUT "/nowhere/a.png", "nowhere"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        assert_said(render(cases[i].arguments), 2, OUT ".txt", cases[i].says);
        assert_not_written(OUT ".png");
    }
}

RT_TESTS(cmd_render, NULL, NULL)
