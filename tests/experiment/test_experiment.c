/* SPDX-License-Identifier: Apache-2.0 */
/* experiments/: from a YAML to a result directory, whatever the number of threads, and whatever was
 * interrupted. */
#include "clock_testing.h"
#include "csv_testing.h"
#include "experiment_testing.h"

#include "core/text/json.h"
#include "report/report.h"
#include "results/result_tables.h"

static const char small_experiment[] =
    "name: small\nquestion: Which is cheaper?\nprediction: The hierarchy.\n"
    "scenes:\n"
    "  - {scene: \"balls:size=2\", size: 24x24, depth: 3}\n"
    "  - {scene: \"random:n=50\", label: cloud, size: 16x16, depth: 2}\n"
    "accelerators:\n"
    "  - {accel: brute, ray_stride: 7}\n"
    "  - {accel: bvh}\n"
    "  - {accel: \"grid:density=4\", label: grid}\n"
    "  - {accel: ideal}\n"
    "baseline: bvh\nlimit: 300\nrounds: 3\nmilliseconds: 1\n";

PLACES_WITH(small_experiment)

/* Runs the experiment into `directory`; the observer may stop it. */
static RtStatus run(const Place *place, const char *directory, RtStart start, int threads,
                    RtRunObserver observer, RtError *error) {
    const RtRunOptions how = {
        .start = start, .report = rt_run_report, .workload = {.threads = threads, .observer = observer}};
    return run_small(place, directory, false, how, error);
}

static const RtRunObserver nobody = {NULL, NULL, NULL};

/* Recording, building, counting, timing and drawing. */
PLACE_TEST(a_run_on_one_thread_starts_no_other) {
    write_changed(
        place, "small.yaml", small_experiment,
        "n=50\", label: cloud, size: 16x16, depth: 2}\naccelerators:\n  - {accel: brute, ray_stride: 7}",
        RT_SHARE("n=20000\", size: 192x192}\naccelerators:\n  - {accel: \"bvh:reinsertion=2\"}",
                 "n=5000\", size: 64x64}\naccelerators:\n  - {accel: \"bvh:reinsertion=2\"}"));
    Labour before = labour_so_far();
    assert_ok(run(place, "out", false, 1, nobody, error));
    Labour labour = labour_since(before);
    assert_true(labour.others < 0.05 * labour.own);
}

PLACE_TEST(the_work_of_a_build_is_in_the_journal) {
    OWNED_RESULTS results;
    write_changed(place, "small.yaml", small_experiment, "accel: ideal", "accel: item+bvh");
    assert_ok(run(place, "out", false, 1, nobody, error));
    assert_ok(rt_results_load(path_in(place, "out").text, place->experiment, &results, error));
    assert_int_equal(rt_build_at(&results, 0, 1)->structure.build.object_tests, 0);
    assert_true(rt_build_at(&results, 0, 3)->structure.build.object_tests > 0);
}

/* ---- the YAML ---- */

PLACE_TEST(a_bad_experiment_is_refused_with_its_line) {
    const struct {
        const char *from, *to, *says;
    } cases[] = {
        {"limit: 300", "limt: 300", ":13:"},
        {"limit: 300", "limit: 0x", ":13:"},
        {"rounds: 3", "rounds: 1000000", ":14:"},
        {"rounds: 3", "rays: [primary, sideways]", ":14:"},
        {"baseline: bvh", "baseline: octree", ":12:"},
        {"baseline: bvh", "baseline: brute", ":12:"},
        {"baseline: bvh", "baseline: brute:best", ":12:11: baseline: 'brute:best' is neither a spec"},
        {"accel: bvh", "accel: bhv", ":9:"},
        {"density=4", "density=-4", ":10:"},
        {"label: grid", "label: bvh", ":10:"},
        {"label: grid", "label: \"a b\"", ":10:"},
        {"label: grid", "label: \"bvh (again)\"", ":10:"},
        {"24x24", "24x0", ":5:"},
        {"depth: 3", "depth: 1000000000", ":5:"},
        {"label: cloud", "label: \"balls:size=2\"", ":6:"},
        {"depth: 2}", "optional: perhaps}", ":6:"},
        {"question: Which is cheaper?\n", "", "question"},
        {"question: Which is cheaper?\n", "format: 2\n", "reads formats 1..1"},
        {"rounds: 3", "limit: 5", "given twice"},
        {"ray_stride: 7", "scenes: [nowhere]", ":8:29: accelerators[0].scenes[0]: 'nowhere'"},
        {"rounds: 3", "count_only: maybe", "invalid value 'maybe': expected yes or no or true or false"},
        {"rounds: 3", "rays: [primary, primary]", "rays[1]: primary rays are given twice"},
        {"rounds: 3", "quick: {size: 8}", "WIDTHxHEIGHT"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        write_changed(place, "small.yaml", small_experiment, cases[i].from, cases[i].to);
        assert_bad_input(load_small(place, false, error), cases[i].says);
        assert_bad_input(load_small(place, false, error), "small.yaml");
    }
}

PLACE_TEST(a_zero_is_taken_where_it_means_something_and_refused_with_the_range_elsewhere) {
    write_changed(place, "small.yaml", small_experiment, "rounds: 3", "seed: 0");
    assert_ok(load_small(place, false, error));
    assert_true(place->experiment->seed == 0);
    write_changed(place, "small.yaml", small_experiment, "milliseconds: 1", "milliseconds: 0");
    assert_ok(load_small(place, false, error));
    assert_true(place->experiment->milliseconds == 0);
    const struct {
        const char *from, *to, *says;
    } cases[] = {
        {"limit: 300", "limit: 0", ":13:8: limit: invalid value '0': expected a whole number 1..100000000"},
        {"rounds: 3", "rounds: 0", ":14:9: rounds: invalid value '0': expected a whole number 1..1000"},
        {"rounds: 3", "coherent_run: 0",
         ":14:15: coherent_run: invalid value '0': expected a whole number 1.."},
        {"depth: 3", "depth: 0", "scenes[0].depth: invalid value '0': expected a whole number 1..64"},
        {"ray_stride: 7", "ray_stride: 0",
         "accelerators[0].ray_stride: invalid value '0': expected a whole number 1.."},
        {"rounds: 3", "quick: {rounds: 0}", "quick.rounds: invalid value '0'"},
        {"rounds: 3", "quick: {depth: 0}", "quick.depth: invalid value '0'"},
        {"rounds: 3", "quick: {limit: 0}", "quick.limit: invalid value '0'"},
        {"rounds: 3", "quick: {milliseconds: 60001}", "quick.milliseconds: invalid value '60001'"},
        {"rounds: 3", "seed: -1", "seed: invalid value '-1': expected a whole number 0.."},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        write_changed(place, "small.yaml", small_experiment, cases[i].from, cases[i].to);
        for (int quick = 0; quick < 2; quick++)
            assert_bad_input(load_small(place, quick, error), cases[i].says);
    }
}

PLACE_TEST(quick_overrides_only_where_it_is_asked_for) {
    write_changed(place, "small.yaml", small_experiment, "rounds: 3",
                  "rounds: 3\nquick: {limit: 7, rounds: 2, milliseconds: 9, depth: 1, size: 8x4}");
    const RtExperiment *e = place->experiment;
    assert_ok(load_small(place, false, error));
    assert_true(e->limit == 300 && e->rounds == 3 && e->milliseconds == 1 && e->workloads[1].depth == 2);
    assert_ok(load_small(place, true, error));
    assert_true(e->limit == 7 && e->rounds == 2 && e->milliseconds == 9 && e->quick);
    assert_true(e->workloads[1].depth == 1 && e->workloads[1].width == 8 && e->workloads[1].height == 4);
}

PLACE_TEST(whichever_allocation_fails_loading_is_out_of_memory) {
    assert_fails_cleanly(load_small(place, false, error), (void)0);
}

PLACE_TEST(what_is_left_out_of_the_yaml_has_its_default) {
    write_in(place, "small.yaml",
             "name: a\nquestion: b\nprediction: c\nscenes: [{scene: ../x/bunny.obj}]\n"
             "accelerators: [{accel: brute}]\n");
    assert_ok(load_small(place, false, error));
    const RtExperiment *e = place->experiment;
    assert_string_equal(e->workloads[0].label, "bunny");
    assert_true(e->workloads[0].file && e->workloads[0].depth == 5 && e->workloads[0].width == 0);
    assert_true(e->kind_count == RT_RAY_OCCLUSION && e->limit == 100000 && e->rounds == 10 &&
                e->baseline == 0);
    assert_non_null(strstr(e->workloads[0].path, "/../x/bunny.obj")); /* seen from the folder of the YAML */
}

/* ---- runs ---- */

PLACE_TEST(counts_are_the_same_bytes_on_one_thread_and_on_two) {
    assert_ok(run(place, "one", RT_START_FRESH, 1, nobody, error));
    assert_ok(run(place, "two", RT_START_FRESH, 2, nobody, error));
    OWNED_MEMORY char *one = read_in(place, "one/counts.csv");
    assert_same_file(place, "two/counts.csv", one);
    assert_non_null(strstr(one, ",brute,brute:lanes=16,7,"));
    assert_non_null(strstr(one, "\"grid:")); /* every effective parameter, quoted for its commas */
}

static RtStatus stop_after(void *context, const RtResults *results, const RtEvent *event, RtError *error) {
    (void)results, (void)event;
    int *left = context;
    return (*left)-- > 0 ? RT_OK : rt_fail(error, RT_IO, "stopped");
}

static void cut_last_line(const Place *place, const char *name) {
    OWNED_MEMORY char *text = read_in(place, name);
    assert_int_equal(truncate(path_in(place, name).text, (off_t)strlen(text) - 9), 0);
}

/* Every line of `before` but its last, which was cut, must still be there as it was. */
static void assert_kept(const char *before, const char *after) {
    size_t length = strlen(before);
    while (length > 0 && before[length - 1] != '\n') length--;
    assert_true(length > 0);
    assert_memory_equal(before, after, length);
}

/* Nothing is lost, nothing is counted twice, and another resumption finds all done. */
PLACE_TEST(an_interrupted_run_resumes_and_loses_no_finished_cell) {
    assert_ok(run(place, "whole", RT_START_FRESH, 1, nobody, error));
    OWNED_MEMORY char *whole = read_in(place, "whole/counts.csv"),
                      *lines = read_in(place, "whole/cells.jsonl");
    for (int events = 1; events < 60; events += 29) {
        int left = events;
        RtError stopped;
        RtRunObserver observer = {&left, stop_after, NULL};
        assert_int_equal(run(place, "parts", RT_START_ANEW, 1, observer, &stopped), RT_IO);
        cut_last_line(place, "parts/cells.jsonl");
        OWNED_MEMORY char *before = read_in(place, "parts/cells.jsonl");
        assert_ok(run(place, "parts", RT_START_RESUME, 1, nobody, error));
        OWNED_MEMORY char *after = read_in(place, "parts/cells.jsonl"),
                          *counts = read_in(place, "parts/counts.csv");
        assert_kept(before, after);
        assert_string_equal(counts, whole);
        assert_int_equal(count_of(after, "\"counted\":"), count_of(lines, "\"counted\":"));
        left = 0;
        assert_ok(run(place, "parts", RT_START_RESUME, 1, observer, error));
    }
}

/* A line of its journal was lost; the run that measures it anew stops behind it. */
PLACE_TEST(a_run_that_goes_on_measuring_is_not_finished_until_it_is) {
    RtError stopped;
    int left = 0;
    RtRunObserver observer = {&left, stop_after, NULL};
    assert_ok(run(place, "parts", RT_START_FRESH, 1, nobody, error));
    cut_last_line(place, "parts/cells.jsonl");
    assert_true(rt_file_exists(path_in(place, "parts/manifest.json").text));
    assert_int_equal(run(place, "parts", RT_START_RESUME, 1, observer, &stopped), RT_IO);
    assert_false(rt_file_exists(path_in(place, "parts/manifest.json").text));
    assert_ok(run(place, "parts", RT_START_RESUME, 1, nobody, error));
    assert_true(rt_file_exists(path_in(place, "parts/manifest.json").text));
}

PLACE_TEST(a_finished_run_that_is_resumed_measures_nothing_and_writes_the_same_tables) {
    assert_ok(run(place, "done", RT_START_FRESH, 1, nobody, error));
    OWNED_MEMORY char *counts = read_in(place, "done/counts.csv"), *times = read_in(place, "done/times.csv");
    OWNED_MEMORY char *rounds = read_in(place, "done/rounds.csv");
    int left = 0; /* the first event would stop it */
    RtRunObserver observer = {&left, stop_after, NULL};
    assert_ok(run(place, "done", RT_START_RESUME, 1, observer, error));
    assert_same_file(place, "done/counts.csv", counts);
    assert_same_file(place, "done/times.csv", times);
    assert_same_file(place, "done/rounds.csv", rounds);
}

static double real_at(const Csv *csv, uint32_t row, const char *name) {
    uint32_t column = csv_find(csv, name);
    assert_true(column < csv->columns);
    return strtod(csv_field(csv, row, column), NULL);
}

static bool is_same_row(const Csv *one, uint32_t row, const Csv *other, uint32_t other_row) {
    const char *const names[] = {"scene", "kind", "accel", "baseline"};
    for (int i = 0; i < 4; i++) {
        const char *text = csv_field(one, row, csv_find(one, names[i]));
        if (strcmp(text, csv_field(other, other_row, csv_find(other, names[i]))) != 0) return false;
    }
    return true;
}

/* Whoever has them can compute them again: medians and ratios, of thinned candidates, too. */
PLACE_TEST(the_times_are_made_of_those_of_the_rounds) {
    Csv times, rounds;
    Path times_path = path_in(place, "out/times.csv"), rounds_path = path_in(place, "out/rounds.csv");
    assert_ok(run(place, "out", RT_START_FRESH, 1, nobody, error));
    read_csv(&times, times_path.text);
    read_csv(&rounds, rounds_path.text);
    assert_int_equal(rounds.rows, 3 * times.rows);
    for (uint32_t i = 0; i < times.rows; i++) {
        double ns[3], wall[3], ratio[3];
        for (uint32_t r = 0; r < 3; r++) {
            uint32_t row = 3 * i + r;
            assert_true(is_same_row(&times, i, &rounds, row));
            assert_true(real_at(&rounds, row, "round") == r + 1);
            ns[r] = real_at(&rounds, row, "round_ns");
            wall[r] = real_at(&rounds, row, "round_wall_ns");
            ratio[r] = real_at(&rounds, row, "round_baseline_ns") / ns[r];
        }
        assert_true(rt_median(ns, 3) == real_at(&times, i, "ns"));
        assert_true(rt_median(wall, 3) == real_at(&times, i, "wall_ns"));
        assert_true(fabs(rt_median(ratio, 3) / real_at(&times, i, "ratio") - 1) < 1e-4);
    }
    clear_csv(&times);
    clear_csv(&rounds);
}

PLACE_TEST(a_missing_scene_is_an_error_unless_it_is_optional) {
    write_changed(place, "small.yaml", small_experiment, "\"random:n=50\"", "nowhere.obj");
    assert_bad_input(run(place, "refused", RT_START_FRESH, 1, nobody, error), "fetch.sh");
    write_changed(place, "small.yaml", small_experiment, "\"random:n=50\"", "nowhere.obj, optional: yes");
    assert_ok(run(place, "skipped", RT_START_FRESH, 1, nobody, error));
}

PLACE_TEST(an_accelerator_of_a_missing_plugin_is_an_error_unless_it_is_optional) {
    const struct {
        const char *accel, *directory, *said;
    } tried[] = {{"\"nobodys:depth=3\"", "unknown", "no accelerator 'nobodys'"},
                 {"\"nobodys:depth=3\", optional: yes", "optional", NULL},
                 {"\"grid:depht=3\", optional: yes", "misspelt", "depht"}};
    for (int i = 0; i < 3; i++) {
        RtError error = {RT_OK, ""};
        write_changed(place, "small.yaml", small_experiment, "ideal", tried[i].accel);
        RtStatus status = run(place, tried[i].directory, RT_START_FRESH, 1, nobody, &error);
        assert_int_equal(status, tried[i].said ? RT_BAD_INPUT : RT_OK);
        if (tried[i].said) assert_non_null(strstr(error.message, tried[i].said));
    }
    OWNED_MEMORY char *counts = read_in(place, "optional/counts.csv");
    assert_null(strstr(counts, "nobodys"));
    assert_non_null(strstr(counts, "grid"));
}

/* ---- tables ---- */

/* The null run's interval begins just above 1: in every table, and in the verdict. */
PLACE_TEST(the_verdict_on_null_runs_is_what_the_tables_show) {
    OWNED_RESULTS results;
    char sentence[RT_MAX_SENTENCE];
    assert_ok(load_small(place, false, error));
    assert_ok(rt_results_init(&results, place->experiment, error));
    results.workloads[0].known = true;
    RtCell *null = rt_cell_at(&results, 0, place->experiment->candidate_count, RT_RAY_PRIMARY);
    null->timed = true;
    null->rounds = 5;
    null->ratio = (RtEstimate){.median = 1.000002, .low = 1.0000003, .high = 1.0004};
    place->experiment->rounds = 7; /* as --until found too few */
    rt_null_sentence(&results, sentence);
    assert_non_null(
        strstr(sentence, "0 of 1 interval includes 1; each misses it by chance in 6.25 % of all"));
    null->rounds = 10;
    rt_null_sentence(&results, sentence);
    assert_non_null(strstr(sentence, "0 of 1 interval includes 1: the machine was busy"));
    FILE *file = fopen(path_in(place, "tables").text, "w");
    assert_non_null(file);
    RtResultRow row = {.results = &results};
    RtTable times = rt_result_table(RT_TIMES, &row);
    rt_table_csv(&times, file);
    rt_print_results(&results, RT_CELLS, file);
    fclose(file);
    assert_in_file(place, "tables", ",1,1.0000003,1.0004,", " 1.0000020 [1.0000003, 1.0004000]");
}

RT_TESTS(experiment, NULL, NULL)
