/* SPDX-License-Identifier: Apache-2.0 */
/* bench --callgrind: instructions per ray by valgrind, in a worker that is this program. */
#include "experiment_testing.h"

#include "measure/measure.h"

#include <sys/stat.h>

/* Valgrind cannot run a program that has sanitizers. */
static bool has_valgrind(void) {
    return !RT_SANITIZED && system("valgrind --version >/dev/null 2>&1") == 0;
}

PLACES_WITH(NULL)

#define RT_TEST_VALGRIND(name)                                                                               \
    static void name##_with(const Place *place);                                                             \
    PLACE_TEST(name) {                                                                                       \
        if (!has_valgrind()) RT_SKIP("valgrind, and no sanitizers");                                         \
        name##_with(place);                                                                                  \
    }                                                                                                        \
    static void name##_with(const Place *place)

/* "instructions" of what bench prints, a new reference. */
static json_t *instructions_of(const Place *place, const char *arguments) {
    char command[300];
    snprintf(command, sizeof command, "bench %s --count-only --threads 1 --json --callgrind=256", arguments);
    if (raytally(place, command) != 0) fail_msg("%s: %s", command, read_in(place, "message"));
    OWNED_MEMORY char *text = read_in(place, "output");
    json_t *document = json_loads(text, 0, NULL);
    json_t *rows = json_incref(json_object_get(document, "instructions"));
    json_decref(document);
    assert_non_null(rows);
    return rows;
}

static json_int_t integer_of(const json_t *rows, size_t i, const char *key) {
    return json_integer_value(json_object_get(json_array_get(rows, i), key));
}

static const char *text_of(const json_t *rows, size_t i, const char *key) {
    return json_string_value(json_object_get(json_array_get(rows, i), key));
}

RT_TEST_VALGRIND(instructions_are_the_same_figure_twice_whatever_the_environment) {
    const char *const arguments = "balls:size=2 --accel bvh --accel grid --accel cache+wide --accel ideal "
                                  "--rays primary,shadow --size 32x32";
    json_auto_t *one = instructions_of(place, arguments);
    assert_int_equal(setenv("RT_TEST_FILLER", "some text that moves the stack to another place", 1), 0);
    json_auto_t *two = instructions_of(place, arguments);
    unsetenv("RT_TEST_FILLER");
    assert_int_equal(json_array_size(one), 4 * 2);
    for (size_t i = 0; i < 8; i++) assert_true(integer_of(one, i, "instructions") > 0);
    assert_true(json_equal(one, two));
}

/* `count` rays, all alike, to NAME. */
static void write_alike(const Place *place, const char *name, uint64_t count) {
    OWNED(rt_rayset_clear) RtRaySet set;
    assert_ok(rt_rayset_init(&set, RT_RAY_DIFFUSE, count, error));
    for (uint64_t i = 0; i < count; i++)
        set.rays[i] =
            (RtRay){.org = {{3, 2, 1}}, .dir = {{-3, -2, -1}}, .tmax = INFINITY, .kind = RT_RAY_DIFFUSE};
    assert_ok(rt_rays_save(&set, path_in(place, name).text, error));
}

/* So neither the start of the program nor a build is in it, and every ray is. */
RT_TEST_VALGRIND(each_ray_more_costs_exactly_as_much_as_the_one_before) {
    const char *const specs[] = {"brute", "bvh", "octree"};
    for (int s = 0; s < 3; s++) {
        json_int_t sums[3];
        for (int i = 0; i < 3; i++) {
            char name[24], arguments[160];
            snprintf(name, sizeof name, "rays-%d.npy", i);
            write_alike(place, name, 32 * (uint64_t)(1 + i));
            snprintf(arguments, sizeof arguments, "random:n=50 --accel %s --rays-from %s --rays nearest",
                     specs[s], name);
            json_auto_t *rows = instructions_of(place, arguments);
            assert_int_equal(integer_of(rows, 0, "rays"), 32 * (1 + i));
            sums[i] = integer_of(rows, 0, "instructions");
        }
        assert_true(sums[0] < sums[1]);
        assert_int_equal(sums[2] - sums[1], sums[1] - sums[0]);
        assert_in_range(sums[0] - (sums[1] - sums[0]), 1, 1000); /* once a pass */
    }
}

RT_TEST_VALGRIND(an_instruction_set_that_valgrind_does_not_know_is_replaced_and_said) {
    json_auto_t *rows =
        instructions_of(place, "random:n=50 --accel wide --accel wide:isa=portable --rays primary --size "
                               "16x16");
    assert_null(strstr(text_of(rows, 0, "spec"), "isa=best"));
    assert_null(strstr(text_of(rows, 0, "spec"), "isa=avx512"));
    assert_non_null(strstr(text_of(rows, 1, "spec"), "isa=portable"));
}

/* Plugins are built in the worker's own process; one that breaks is not built there. */
RT_TEST_VALGRIND(instructions_of_a_plugin_are_counted_and_a_broken_one_is_named) {
    assert_int_equal(raytally(place, "bench random:n=50 --count-only --threads 1 --json --callgrind=64 "
                                     "--rays primary,shadow --size 16x16 --plugin " RT_BINARY_DIR
                                     "/plugins/bvh_copy.so --plugin " RT_BINARY_DIR
                                     "/plugins/faulty.so --accel bvh --accel bvh_copy --accel faulty-print "
                                     "--accel faulty-crash-nearest"),
                     1);
    OWNED_MEMORY char *text = read_in(place, "output");
    json_auto_t *document = json_loads(text, 0, NULL);
    const json_t *rows = json_object_get(document, "instructions");
    assert_int_equal(json_array_size(rows), 4 * 2);
    for (size_t i = 0; i < 6; i++) assert_true(integer_of(rows, i, "instructions") > 0);
    for (size_t i = 2; i < 4; i++) assert_string_equal(text_of(rows, i, "accel"), "bvh_copy");
    assert_non_null(strstr(text_of(rows, 6, "why"), "it crashed (Segmentation fault)"));
}

/* The worker gets at most so many rays, and no file stays behind. */
RT_TEST_VALGRIND(the_worker_gets_a_few_rays_and_leaves_nothing_behind) {
    glob_t found;
    assert_int_equal(setenv("TMPDIR", place->folder, 1), 0);
    json_t *rows = instructions_of(place, "random:n=50 --accel bvh --rays primary --size 64x64");
    unsetenv("TMPDIR");
    assert_true(integer_of(rows, 0, "rays") > 0 && integer_of(rows, 0, "rays") <= 256);
    json_decref(rows);
    assert_int_equal(glob(path_in(place, "raytally-callgrind*").text, 0, NULL, &found), GLOB_NOMATCH);
    globfree(&found);
}

static double figure_of(const json_t *row, const char *key) {
    return json_number_value(json_object_get(row, key));
}

/* raytally_slower traces a fiftieth of the rays twice. */
RT_TEST_VALGRIND(compare_shows_the_instructions_of_both_programs_and_their_ratio) {
    assert_runs(place, "compare balls:size=1 --accel grid --rays primary --size 32x32 --rounds 1 "
                       "--callgrind=512 --margin 1% --json --with " RT_BINARY_DIR "/raytally_slower");
    OWNED_MEMORY char *text = read_in(place, "output");
    json_auto_t *document = json_loads(text, 0, NULL);
    const json_t *row = json_array_get(json_object_get(document, "cells"), 0);
    const double before = figure_of(row, "instructions_before"), after = figure_of(row, "instructions_after");
    assert_true(before > 100 && after > 100);
    assert_in_range((int)(1000 * before / after), 1005, 1035);
    assert_true(fabs(figure_of(row, "instructions_ratio") - after / before) < 1e-6);
}

RT_TEST_VALGRIND(a_program_that_cannot_count_instructions_is_told_apart_in_plain_words) {
    write_in(place, "other", "#!/bin/sh\n[ \"$1\" = bench ] && exit 2\nexec '" RT_PROGRAM "' \"$@\"\n");
    assert_int_equal(chmod(path_in(place, "other").text, 0755), 0);
    assert_ends(place,
                "compare balls:size=1 --accel grid --rays primary --limit 100 --rounds 1 "
                "--callgrind --with ./other",
                2, "it must be a raytally whose `bench` has --callgrind");
}

/* Before anything is measured. */
PLACE_TEST(without_valgrind_there_is_a_message_that_says_how_to_get_it) {
    char command[512];
    snprintf(command, sizeof command,
             "cd '%s' && PATH=/nowhere '%s' bench balls --accel bvh --callgrind >output "
             "2>message",
             place->folder, RT_PROGRAM);
    int code = WEXITSTATUS(system(command));
    assert_int_equal(code, 2);
    assert_in_file(place, "message", "valgrind is not installed", "apt install valgrind");
    OWNED_MEMORY char *output = read_in(place, "output");
    assert_string_equal(output, "");
}

RT_TESTS(callgrind, NULL, NULL)
