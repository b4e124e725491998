/* experiments/: from a YAML to a result directory, whatever the number of threads, and whatever was
 * interrupted. */
#include "clock_testing.h"
#include "experiment_testing.h"

#include "experiments/json.h"
#include "experiments/run.h"
#include "experiments/tables.h"

#include <math.h>
#include <unistd.h>

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

static int make_small(void **state) {
    if (make_place(state) != 0) return -1;
    write_in(*state, "small.yaml", small_experiment);
    return 0;
}

/* Runs the experiment into `directory`; the observer may stop it. */
static RtStatus run(const Place *place, const char *directory, bool resume, int threads, RtObserver observer,
                    RtError *error) {
    RtResults results;
    Path path = path_in(place, directory);
    RT_TRY(load_small(place, false, error));
    RT_TRY(rt_results_init(&results, place->experiment, error));
    RtRunOptions options = {.directory = path.text,
                            .resume = resume,
                            .trial = {.threads = threads, .timing = 1, .observer = observer}};
    RtStatus status = rt_run(&results, &options, error);
    rt_results_clear(&results);
    return status;
}

static const RtObserver nobody = {NULL, NULL, NULL};

/* Recording, building, counting, timing and drawing. */
static void a_run_on_one_thread_starts_no_other(void **state) {
    const Place *place = *state;
    write_changed(place, "small.yaml", small_experiment,
                  "n=50\", label: cloud, size: 16x16, depth: 2}\naccelerators:\n  - {accel: brute, every: 7}",
                  "n=20000\", size: 192x192}\naccelerators:\n  - {accel: \"bvh:reinsertion=2\"}");
    Labour before = labour_so_far();
    assert_ok(run(place, "out", false, 1, nobody, error));
    Labour labour = labour_since(before);
    assert_true(labour.others < 0.05 * labour.own);
}

static void the_work_of_a_build_is_in_the_journal(void **state) {
    const Place *place = *state;
    RtResults results;
    write_changed(place, "small.yaml", small_experiment, "accel: ideal", "accel: item+bvh");
    assert_ok(run(place, "out", false, 1, nobody, error));
    assert_ok(rt_run_load(path_in(place, "out").text, place->experiment, &results, error));
    assert_int_equal(rt_build_at(&results, 0, 1)->shape.build.object_tests, 0);
    assert_true(rt_build_at(&results, 0, 3)->shape.build.object_tests > 0);
    rt_results_clear(&results);
}

/* ---- the YAML ---- */

static void a_bad_experiment_is_refused_with_its_line(void **state) {
    const Place *place = *state;
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
        write_changed(place, "small.yaml", small_experiment, cases[i].from, cases[i].to);
        RtError error = {RT_OK, ""};
        RtStatus status = load_small(place, false, &error);
        assert_refused(status, RT_BAD_INPUT, &error, cases[i].says);
        assert_non_null(strstr(error.message, "small.yaml"));
    }
}

static void the_command_refuses_a_bad_experiment_with_exit_code_2(void **state) {
    const Place *place = *state;
    write_in(place, "small.yaml", "name: small\nnothing: else\n");
    assert_int_equal(raytally(place, "run small.yaml"), 2);
    assert_in_file(place, "message", "small.yaml:2");
    assert_false(rt_file_exists(path_in(place, "results").text));
}

static void what_is_left_out_of_the_yaml_has_its_default(void **state) {
    const Place *place = *state;
    write_in(place, "small.yaml",
             "name: a\nquestion: b\nprediction: c\nscenes: [{scene: ../x/bunny.obj}]\n"
             "accelerators: [{accel: brute}]\n");
    assert_ok(load_small(place, false, error));
    const RtExperiment *e = place->experiment;
    assert_string_equal(e->trials[0].label, "bunny");
    assert_true(e->trials[0].file && e->trials[0].depth == 5 && e->trials[0].width == 0);
    assert_true(e->kind_count == RT_RAY_KIND_COUNT && e->limit == 100000 && e->rounds == 10 &&
                e->baseline == 0);
    assert_non_null(strstr(e->trials[0].path, "/../x/bunny.obj")); /* seen from the folder of the YAML */
}

/* ---- runs ---- */

static void counts_are_the_same_bytes_on_one_thread_and_on_two(void **state) {
    const Place *place = *state;
    assert_ok(run(place, "one", false, 1, nobody, error));
    assert_ok(run(place, "two", false, 2, nobody, error));
    char *one = read_in(place, "one/counts.csv"), *two = read_in(place, "two/counts.csv");
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

static void cut_last_line(const Place *place, const char *name) {
    char *text = read_in(place, name);
    assert_int_equal(truncate(path_in(place, name).text, (off_t)strlen(text) - 9), 0);
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
    const Place *place = *state;
    assert_ok(run(place, "whole", false, 1, nobody, error));
    char *whole = read_in(place, "whole/counts.csv"), *lines = read_in(place, "whole/cells.jsonl");
    for (int events = 1; events < 60; events += 17) {
        Stopper stopper = {events};
        RtError stopped;
        RtObserver observer = {&stopper, stop_after, NULL};
        assert_int_equal(run(place, "parts", false, 1, observer, &stopped), RT_IO);
        cut_last_line(place, "parts/cells.jsonl");
        char *before = read_in(place, "parts/cells.jsonl");
        assert_ok(run(place, "parts", true, 1, nobody, error));
        char *after = read_in(place, "parts/cells.jsonl"), *counts = read_in(place, "parts/counts.csv");
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
    const Place *place = *state;
    assert_ok(run(place, "done", false, 1, nobody, error));
    char *counts = read_in(place, "done/counts.csv"), *times = read_in(place, "done/times.csv");
    Stopper stopper = {0}; /* the first event would stop it */
    RtObserver observer = {&stopper, stop_after, NULL};
    assert_ok(run(place, "done", true, 1, observer, error));
    char *counts_now = read_in(place, "done/counts.csv"), *times_now = read_in(place, "done/times.csv");
    assert_string_equal(counts, counts_now);
    assert_string_equal(times, times_now);
    rt_free(counts);
    rt_free(times);
    rt_free(counts_now);
    rt_free(times_now);
}

static void a_run_of_another_experiment_is_not_resumed(void **state) {
    const Place *place = *state;
    assert_ok(run(place, "mixed", false, 1, nobody, error));
    char text[2048];
    snprintf(text, sizeof text, "%sseed: 2\n", small_experiment);
    write_in(place, "small.yaml", text);
    RtError error;
    assert_int_equal(run(place, "mixed", true, 1, nobody, &error), RT_BAD_INPUT);
    assert_non_null(strstr(error.message, "another experiment"));
}

static void the_report_has_the_question_and_nothing_outside_itself(void **state) {
    const Place *place = *state;
    assert_ok(run(place, "page", false, 1, nobody, error));
    char *page = read_in(place, "page/report.html");
    assert_non_null(strstr(page, "Which is cheaper?"));
    assert_non_null(strstr(page, "data:image/png;base64,"));
    assert_null(strstr(page, "src=\"http"));
    assert_non_null(strstr(page, "</html>"));
    rt_free(page);
}

static void a_missing_scene_is_an_error_unless_it_is_optional(void **state) {
    const Place *place = *state;
    const char *missing[] = {"nowhere.obj", "nowhere.obj, optional: yes"};
    for (int optional = 0; optional < 2; optional++) {
        RtError error = {RT_OK, ""};
        write_changed(place, "small.yaml", small_experiment, "\"random:n=50\"", missing[optional]);
        RtStatus status = run(place, optional ? "skipped" : "refused", false, 1, nobody, &error);
        assert_int_equal(status, optional ? RT_OK : RT_BAD_INPUT);
        if (!optional) assert_non_null(strstr(error.message, "fetch.sh"));
    }
}

/* ---- tables ---- */

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

static bool text_holds_1(const char *low, const char *high) {
    return strtod(low, NULL) <= 1 && 1 <= strtod(high, NULL);
}

static void nine_digits(double end, char *out) {
    json_t *number = rt_json_ratio_end(end);
    out[json_dumpb(number, out, 31, JSON_ENCODE_ANY | JSON_REAL_PRECISION(9))] = '\0';
    json_decref(number);
}

static void an_interval_is_seen_not_to_hold_1_if_it_does_not(void **state) {
    (void)state;
    static const double ends[] = {0.5,         0.98,     0.9951, 0.9994, 0.9996, 1 - 1e-7, 1 - 0x1p-53, 1,
                                  1 + 0x1p-52, 1 + 1e-7, 1.0004, 1.0031, 1.0049, 1.02,     2.5};
    enum { ENDS = sizeof ends / sizeof ends[0] };
    for (int i = 0; i < ENDS; i++) {
        for (int k = i; k < ENDS; k++) {
            const RtEstimate e = {.low = ends[i], .high = ends[k], .median = 0.5 * (ends[i] + ends[k])};
            RtRatioText text;
            rt_format_ratio(&e, &text);
            assert_int_equal(text_holds_1(text.low, text.high), rt_estimate_holds(&e, 1));
            assert_true(strtod(text.low, NULL) <= strtod(text.median, NULL));
            assert_true(strtod(text.median, NULL) <= strtod(text.high, NULL));
            char low[32], high[32];
            nine_digits(e.low, low);
            nine_digits(e.high, high);
            assert_int_equal(text_holds_1(low, high), rt_estimate_holds(&e, 1));
        }
    }
    const RtEstimate usual = {1.0134, 1.0061, 1.0279, 1}, close = {1.0041, 1.0031, 1.0279, 1};
    RtRatioText text;
    rt_format_ratio(&usual, &text);
    assert_string_equal(text.low, "1.01");
    rt_format_ratio(&close, &text);
    assert_string_equal(text.low, "1.003");
    assert_string_equal(text.median, "1.004");
    assert_string_equal(text.high, "1.028");
}

/* The null run's interval begins just above 1: in every table, and in the verdict. */
static void the_verdict_on_null_runs_is_what_the_tables_show(void **state) {
    const Place *place = *state;
    RtResults results;
    char sentence[RT_MAX_SENTENCE];
    assert_ok(load_small(place, false, error));
    assert_ok(rt_results_init(&results, place->experiment, error));
    results.trials[0].known = true;
    RtCell *null = rt_cell_at(&results, 0, place->experiment->contender_count, RT_RAY_PRIMARY);
    null->timed = true;
    null->rounds = 10;
    null->ratio = (RtEstimate){.median = 1.000002, .low = 1.0000003, .high = 1.0004};
    rt_null_sentence(&results, sentence);
    assert_non_null(strstr(sentence, "0 of 1 intervals straddle 1"));
    FILE *file = fopen(path_in(place, "tables").text, "w");
    assert_non_null(file);
    rt_times_csv(&results, file);
    rt_print_cells(&results, file);
    fclose(file);
    assert_in_file(place, "tables", ",1,1.0000003,1.0004,");
    assert_in_file(place, "tables", " 1.0000020 [1.0000003, 1.0004000]");
    rt_results_clear(&results);
}

#define IN_PLACE(test) cmocka_unit_test_setup_teardown(test, make_small, remove_place)

int main(void) {
    const struct CMUnitTest tests[] = {
        IN_PLACE(a_bad_experiment_is_refused_with_its_line),
        IN_PLACE(the_command_refuses_a_bad_experiment_with_exit_code_2),
        IN_PLACE(a_run_on_one_thread_starts_no_other),
        IN_PLACE(the_work_of_a_build_is_in_the_journal),
        IN_PLACE(what_is_left_out_of_the_yaml_has_its_default),
        IN_PLACE(counts_are_the_same_bytes_on_one_thread_and_on_two),
        IN_PLACE(an_interrupted_run_resumes_and_loses_no_finished_cell),
        IN_PLACE(a_finished_run_that_is_resumed_measures_nothing_and_writes_the_same_tables),
        IN_PLACE(a_run_of_another_experiment_is_not_resumed),
        IN_PLACE(the_report_has_the_question_and_nothing_outside_itself),
        IN_PLACE(a_missing_scene_is_an_error_unless_it_is_optional),
        cmocka_unit_test(an_interval_is_seen_not_to_hold_1_if_it_does_not),
        IN_PLACE(the_verdict_on_null_runs_is_what_the_tables_show),
        cmocka_unit_test(figures_are_about_four_characters),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
