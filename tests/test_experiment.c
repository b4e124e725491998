/* experiments/: from a YAML to a result directory, whatever the number of threads, and whatever was
 * interrupted. */
#include "testing.h"

#include "base/memory.h"
#include "experiments/journal.h"
#include "experiments/measure.h"
#include "experiments/run.h"
#include "experiments/tables.h"
#include "scene/load.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* ---- a folder for each test, with an experiment in it ---- */

static const char small_experiment[] = "name: small\n"
                                       "question: Which is cheaper?\n"
                                       "prediction: The hierarchy.\n"
                                       "scenes:\n"
                                       "  - {scene: \"balls:size=2\", size: 24x24, depth: 3}\n"
                                       "  - {scene: \"random:n=50\", label: cloud, size: 16x16, depth: 2}\n"
                                       "accelerators:\n"
                                       "  - {accel: brute, every: 7}\n"
                                       "  - {accel: bvh}\n"
                                       "  - {accel: \"grid:density=4\", label: grid}\n"
                                       "  - {accel: ideal}\n"
                                       "baseline: bvh\n"
                                       "limit: 300\n"
                                       "rounds: 3\n"
                                       "milliseconds: 1\n";

typedef struct Place {
    char folder[64], yaml[128];
    RtExperiment *experiment;
} Place;

static void write_yaml(Place *place, const char *text) {
    assert_ok(rt_file_write(place->yaml, text, strlen(text), error));
}

static int make_place(void **state) {
    static Place place;
    strcpy(place.folder, "/tmp/raytally-test-XXXXXX");
    if (!mkdtemp(place.folder)) return -1;
    snprintf(place.yaml, sizeof place.yaml, "%s/small.yaml", place.folder);
    place.experiment = rt_alloc(1, sizeof(RtExperiment));
    *state = &place;
    write_yaml(&place, small_experiment);
    return place.experiment ? 0 : -1;
}

static int remove_place(void **state) {
    Place *place = *state;
    char command[128];
    rt_free(place->experiment);
    snprintf(command, sizeof command, "rm -rf '%s'", place->folder);
    return system(command);
}

static char *read_in(const Place *place, const char *directory, const char *name) {
    char path[256], *text = NULL;
    size_t size;
    snprintf(path, sizeof path, "%s/%s/%s", place->folder, directory, name);
    assert_ok(rt_file_read(path, 1 << 24, &text, &size, error));
    return text;
}

/* Runs the experiment into `directory`; the observer may stop it. */
static RtStatus run(Place *place, const char *directory, bool resume, int threads, RtObserver observer,
                    RtError *error) {
    char path[256];
    RtResults results;
    snprintf(path, sizeof path, "%s/%s", place->folder, directory);
    RT_TRY(rt_experiment_load(place->experiment, place->yaml, false, error));
    RT_TRY(rt_results_init(&results, place->experiment, error));
    RtRunOptions options = {.directory = path,
                            .resume = resume,
                            .trial = {.threads = threads, .timing = 1, .observer = observer}};
    RtStatus status = rt_run(&results, &options, error);
    rt_results_clear(&results);
    return status;
}

static const RtObserver nobody = {NULL, NULL, NULL};

/* ---- the YAML ---- */

static void a_bad_experiment_is_refused_with_its_line(void **state) {
    Place *place = *state;
    const struct {
        const char *from, *to, *says;
    } cases[] = {
        {"limit: 300", "limt: 300", ":13:"},           {"limit: 300", "limit: 0x", ":13:"},
        {"rounds: 3", "rounds: 1000000", ":14:"},      {"rounds: 3", "rays: [primary, sideways]", ":14:"},
        {"baseline: bvh", "baseline: octree", ":12:"}, {"baseline: bvh", "baseline: brute", ":12:"},
        {"accel: bvh", "accel: bhv", ":9:"},           {"density=4", "density=-4", ":10:"},
        {"label: grid", "label: bvh", ":10:"},         {"label: grid", "label: \"a b\"", ":10:"},
        {"label: grid", "label: \"null\"", ":10:"},    {"24x24", "24x0", ":5:"},
        {"depth: 3", "depth: 1000000000", ":5:"},      {"label: cloud", "label: \"balls:size=2\"", ":6:"},
        {"depth: 2}", "optional: perhaps}", ":6:"},    {"question: Which is cheaper?\n", "", "question"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char text[2048];
        const char *at = strstr(small_experiment, cases[i].from);
        assert_non_null(at);
        snprintf(text, sizeof text, "%.*s%s%s", (int)(at - small_experiment), small_experiment, cases[i].to,
                 at + strlen(cases[i].from));
        write_yaml(place, text);
        RtError error = {RT_OK, ""};
        if (rt_experiment_load(place->experiment, place->yaml, false, &error) == RT_OK) {
            fail_msg("'%s' was taken", cases[i].to);
        }
        if (!strstr(error.message, cases[i].says) || !strstr(error.message, "small.yaml")) {
            fail_msg("'%s' gave: %s", cases[i].to, error.message);
        }
    }
}

static void the_command_refuses_a_bad_experiment_with_exit_code_2(void **state) {
    Place *place = *state;
    char command[512];
    write_yaml(place, "name: small\nnothing: else\n");
    snprintf(command, sizeof command, "cd '%s' && '%s' run small.yaml 2>message", place->folder, RT_PROGRAM);
    assert_int_equal(WEXITSTATUS(system(command)), 2);
    char *message = read_in(place, ".", "message");
    assert_non_null(strstr(message, "small.yaml:2"));
    rt_free(message);
    snprintf(command, sizeof command, "%s/results", place->folder);
    assert_false(rt_file_exists(command));
}

static void what_is_left_out_of_the_yaml_has_its_default(void **state) {
    Place *place = *state;
    write_yaml(place, "name: a\nquestion: b\nprediction: c\nscenes: [{scene: ../x/bunny.obj}]\n"
                      "accelerators: [{accel: brute}]\n");
    assert_ok(rt_experiment_load(place->experiment, place->yaml, false, error));
    const RtExperiment *e = place->experiment;
    assert_string_equal(e->trials[0].label, "bunny");
    assert_true(e->trials[0].file && e->trials[0].depth == 5 && e->trials[0].width == 0);
    assert_true(e->kind_count == RT_RAY_KIND_COUNT && e->limit == 100000 && e->rounds == 10 &&
                e->baseline == 0);
    assert_non_null(strstr(e->trials[0].path, "/../x/bunny.obj")); /* seen from the folder of the YAML */
}

/* ---- runs ---- */

static void counts_are_the_same_bytes_on_one_thread_and_on_two(void **state) {
    Place *place = *state;
    assert_ok(run(place, "one", false, 1, nobody, error));
    assert_ok(run(place, "two", false, 2, nobody, error));
    char *one = read_in(place, "one", "counts.csv"), *two = read_in(place, "two", "counts.csv");
    assert_string_equal(one, two);
    assert_non_null(strstr(one, ",brute,brute,7,"));
    assert_non_null(strstr(one, "\"grid:")); /* every effective parameter, quoted for its commas */
    rt_free(one);
    rt_free(two);
}

typedef struct Stopper {
    int left;
} Stopper;

static RtStatus stop_after(void *context, const RtResults *results, const RtEvent *event, RtError *error) {
    (void)results, (void)event;
    Stopper *stopper = context;
    return stopper->left-- > 0 ? RT_OK : rt_fail(error, RT_IO, "stopped");
}

static void cut_last_line(const Place *place, const char *directory) {
    char path[256];
    char *text = read_in(place, directory, "cells.jsonl");
    snprintf(path, sizeof path, "%s/%s/cells.jsonl", place->folder, directory);
    assert_int_equal(truncate(path, (off_t)strlen(text) - 9), 0);
    rt_free(text);
}

/* Every line of `before` but its last, which was cut, must still be there as it was. */
static void assert_kept(const char *before, const char *after) {
    size_t length = strlen(before);
    while (length > 0 && before[length - 1] != '\n') length--;
    assert_true(length > 0);
    assert_memory_equal(before, after, length);
}

static int count_of(const char *text, const char *part) {
    int count = 0;
    while ((text = strstr(text, part))) {
        count++;
        text += strlen(part);
    }
    return count;
}

/* Nothing is lost, nothing is counted twice, and another resumption finds all done. */
static void an_interrupted_run_resumes_and_loses_no_finished_cell(void **state) {
    Place *place = *state;
    assert_ok(run(place, "whole", false, 1, nobody, error));
    char *whole = read_in(place, "whole", "counts.csv"), *lines = read_in(place, "whole", "cells.jsonl");
    for (int events = 1; events < 60; events += 17) {
        Stopper stopper = {events};
        RtError stopped;
        RtObserver observer = {&stopper, stop_after, NULL};
        assert_int_equal(run(place, "parts", false, 1, observer, &stopped), RT_IO);
        cut_last_line(place, "parts");
        char *before = read_in(place, "parts", "cells.jsonl");
        assert_ok(run(place, "parts", true, 1, nobody, error));
        char *after = read_in(place, "parts", "cells.jsonl"), *counts = read_in(place, "parts", "counts.csv");
        assert_kept(before, after);
        assert_string_equal(counts, whole);
        assert_int_equal(count_of(after, "\"counted\":"), count_of(lines, "\"counted\":"));
        stopper = (Stopper){0};
        assert_ok(run(place, "parts", true, 1, observer, error));
        rt_free(before);
        rt_free(after);
        rt_free(counts);
    }
    rt_free(whole);
    rt_free(lines);
}

static void a_finished_run_that_is_resumed_measures_nothing_and_writes_the_same_tables(void **state) {
    Place *place = *state;
    assert_ok(run(place, "done", false, 1, nobody, error));
    char *counts = read_in(place, "done", "counts.csv"), *times = read_in(place, "done", "times.csv");
    Stopper stopper = {0}; /* the first event would stop it */
    RtObserver observer = {&stopper, stop_after, NULL};
    assert_ok(run(place, "done", true, 1, observer, error));
    char *counts_now = read_in(place, "done", "counts.csv"), *times_now = read_in(place, "done", "times.csv");
    assert_string_equal(counts, counts_now);
    assert_string_equal(times, times_now);
    rt_free(counts);
    rt_free(times);
    rt_free(counts_now);
    rt_free(times_now);
}

static void a_run_of_another_experiment_is_not_resumed(void **state) {
    Place *place = *state;
    assert_ok(run(place, "mixed", false, 1, nobody, error));
    char text[2048];
    snprintf(text, sizeof text, "%sseed: 2\n", small_experiment);
    write_yaml(place, text);
    RtError error;
    assert_int_equal(run(place, "mixed", true, 1, nobody, &error), RT_BAD_INPUT);
    assert_non_null(strstr(error.message, "another experiment"));
}

static void the_report_has_the_question_and_nothing_outside_itself(void **state) {
    Place *place = *state;
    assert_ok(run(place, "page", false, 1, nobody, error));
    char *page = read_in(place, "page", "report.html");
    assert_non_null(strstr(page, "Which is cheaper?"));
    assert_non_null(strstr(page, "data:image/png;base64,"));
    assert_null(strstr(page, "src=\"http"));
    assert_non_null(strstr(page, "</html>"));
    rt_free(page);
}

static void a_missing_scene_is_an_error_unless_it_is_optional(void **state) {
    Place *place = *state;
    char text[2048];
    const char *at = strstr(small_experiment, "\"random:n=50\"");
    const char *missing[] = {"nowhere.obj", "nowhere.obj, optional: yes"};
    for (int optional = 0; optional < 2; optional++) {
        RtError error = {RT_OK, ""};
        snprintf(text, sizeof text, "%.*s%s%s", (int)(at - small_experiment), small_experiment,
                 missing[optional], at + strlen("\"random:n=50\""));
        write_yaml(place, text);
        RtStatus status = run(place, optional ? "skipped" : "refused", false, 1, nobody, &error);
        assert_int_equal(status, optional ? RT_OK : RT_BAD_INPUT);
        if (!optional) assert_non_null(strstr(error.message, "fetch.sh"));
    }
}

/* ---- counting and timing ---- */

/* The spheres of balls:size=1 are 10, and one polygon; brute tests each for every ray. */
static void a_count_is_the_sum_over_threads_and_finds_wrong_answers(void **state) {
    (void)state;
    RtScene scene;
    RtAccel *accel;
    RtRaySet sets[RT_RAY_KIND_COUNT];
    RtRecording recording = {.depth = 1, .seed = 1, .random = 10000, .threads = 1};
    RtCount count;
    assert_ok(rt_scene_open("balls:size=1", &scene, error));
    assert_ok(rt_scene_sample(&scene, 8, 8, 1, false, error));
    assert_ok(rt_accel_open("brute", &scene, &accel, error));
    assert_ok(rt_rayset_record(sets, accel, &recording, error));
    const RtRaySet *set = &sets[RT_RAY_RANDOM];
    RtHit *expected = rt_alloc(set->count, sizeof(RtHit));
    assert_ok(rt_measure_answers(accel, set, 2, expected, error));
    for (int threads = 1; threads <= 3; threads++) {
        assert_ok(rt_measure_count(accel, set, expected, threads, &count, error));
        assert_int_equal(count.tally.rays, 10000);
        assert_int_equal(count.tally.object_tests, 10000u * scene.geometry.object_count);
        assert_int_equal(count.differ, 0);
    }
    expected[42].object ^= 1;
    expected[4242].t += 1;
    assert_ok(rt_measure_count(accel, set, expected, 2, &count, error));
    assert_int_equal(count.differ, expected[4242].object == RT_NO_OBJECT ? 1 : 2);
    assert_int_equal(count.first, 42);
    rt_free(expected);
    for (int k = 0; k < RT_RAY_KIND_COUNT; k++) rt_rayset_clear(&sets[k]);
    rt_accel_destroy(accel);
    rt_scene_clear(&scene);
}

/* Times `spec` on every 16th primary ray of a cloud against `baseline` on all, and gives the cell. In a frame
 * 16 wide those are the rays of the leftmost column, which pass by everything. */
static RtCell time_thinned(Place *place, const char *baseline, const char *spec) {
    RtExperiment *e = place->experiment;
    RtTrialOptions options = {.threads = 1, .timing = 1};
    RtResults results;
    char where[RT_MAX_LABEL];
    rt_experiment_init(e);
    strcpy(e->name, "thinned");
    e->milliseconds = 1;
    e->kind_count = 1;
    e->trial_count = 1;
    e->trials[0].depth = 1;
    e->trials[0].width = e->trials[0].height = 16;
    e->contender_count = 2;
    e->contenders[0] = (RtContender){.label = "all", .every = 1};
    e->contenders[1] = (RtContender){.label = "some", .every = 16};
    strcpy(e->contenders[0].spec, baseline);
    strcpy(e->contenders[1].spec, spec);
    assert_ok(rt_trial_set_scene(&e->trials[0], "random:n=300", "", error));
    assert_ok(rt_experiment_check(e, where, error));
    assert_ok(rt_results_init(&results, e, error));
    assert_ok(rt_trial_run(&results, 0, &options, error));
    RtCell cell = *rt_cell_at(&results, 0, 1, RT_RAY_PRIMARY);
    assert_true(fabs(rt_results_total(&results, 0, 1).ratio / cell.ratio.median - 1) < 1e-9);
    rt_results_clear(&results);
    return cell;
}

/* The hierarchy needs 1 extent test for each of these rays and 10 for one of all: on all rays the ratio would
 * be 4 and more. */
static void a_thinned_contender_is_compared_with_the_baseline_on_its_own_rays(void **state) {
    RtCell cell = time_thinned(*state, "bvh", "bvh");
    assert_int_equal(cell.tally.rays, 16);
    assert_int_equal(cell.tally.extent_tests, 16);
    assert_true(0.5 < cell.ratio.median && cell.ratio.median < 2);
}

/* ideal knows rays by their addresses; a ray that it does not know costs it 300 tests. */
static void a_baseline_that_learns_knows_the_rays_of_thinned_contenders(void **state) {
    RtCell cell = time_thinned(*state, "ideal", "ideal");
    assert_int_equal(cell.tally.object_tests, cell.tally.hits);
    assert_true(0.2 < cell.ratio.median && cell.ratio.median < 5);
}

static void figures_are_about_four_characters(void **state) {
    (void)state;
    const struct {
        double value;
        const char *text;
    } cases[] = {{0, "0"},        {0.00341, "0.0034"}, {0.341, "0.341"},  {1.239, "1.24"},
                 {12.39, "12.4"}, {123.9, "124"},      {69666, "69666"},  {0.00012, "1.2e-04"},
                 {NAN, "-"},      {9.999, "10.0"},     {1.5e8, "1.5e+08"}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char text[16];
        rt_format_figure(cases[i].value, text);
        assert_string_equal(text, cases[i].text);
    }
}

#define IN_PLACE(test) cmocka_unit_test_setup_teardown(test, make_place, remove_place)

int main(void) {
    const struct CMUnitTest tests[] = {
        IN_PLACE(a_bad_experiment_is_refused_with_its_line),
        IN_PLACE(the_command_refuses_a_bad_experiment_with_exit_code_2),
        IN_PLACE(what_is_left_out_of_the_yaml_has_its_default),
        IN_PLACE(counts_are_the_same_bytes_on_one_thread_and_on_two),
        IN_PLACE(an_interrupted_run_resumes_and_loses_no_finished_cell),
        IN_PLACE(a_finished_run_that_is_resumed_measures_nothing_and_writes_the_same_tables),
        IN_PLACE(a_run_of_another_experiment_is_not_resumed),
        IN_PLACE(the_report_has_the_question_and_nothing_outside_itself),
        IN_PLACE(a_missing_scene_is_an_error_unless_it_is_optional),
        cmocka_unit_test(a_count_is_the_sum_over_threads_and_finds_wrong_answers),
        IN_PLACE(a_thinned_contender_is_compared_with_the_baseline_on_its_own_rays),
        IN_PLACE(a_baseline_that_learns_knows_the_rays_of_thinned_contenders),
        cmocka_unit_test(figures_are_about_four_characters),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
