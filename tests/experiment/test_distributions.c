/* SPDX-License-Identifier: Apache-2.0 */
/* Distributions in a result directory, and in bench. */
#include "csv_testing.h"
#include "experiment_testing.h"

static const char spread[] = "name: small\nquestion: How long is the tail?\nprediction: Long.\n"
                             "scenes:\n"
                             "  - {scene: \"random:n=50\", label: cloud, size: 16x16}\n"
                             "  - {scene: \"balls:size=2\", label: balls, size: 16x16}\n"
                             "accelerators:\n"
                             "  - {accel: bvh}\n"
                             "  - {accel: grid}\n"
                             "  - {accel: brute, ray_stride: 3}\n"
                             "rays: [primary, shadow]\nlimit: 200\ndistributions: yes\ncount_only: yes\n";

PLACES_WITH(spread)

static uint64_t integer_at(const Csv *csv, uint32_t row, const char *name) {
    return strtoull(csv_field(csv, row, csv_find(csv, name)), NULL, 10);
}

/* Three quantities over two kinds of rays of three accelerators, and two over leaves of two; on two scenes.
 */
PLACE_TEST(a_run_that_asks_for_distributions_has_them_in_tables_of_their_own) {
    Csv csv, bins;
    assert_runs(place, "run small.yaml --out out --threads 1");
    Path path = path_in(place, "out/distributions.csv"), histograms = path_in(place, "out/histograms.csv");
    read_csv(&csv, path.text);
    read_csv(&bins, histograms.text);
    assert_int_equal(csv.rows, 2 * (3 * 2 * 3 + 2 * 2));
    uint64_t rays = 0, within = 0;
    for (uint32_t row = 0; row < csv.rows; row++) {
        rays += integer_at(&csv, row, "count");
        assert_true(integer_at(&csv, row, "median") <= integer_at(&csv, row, "p99"));
        assert_true(integer_at(&csv, row, "p99") <= integer_at(&csv, row, "max"));
    }
    for (uint32_t row = 0; row < bins.rows; row++) within += integer_at(&bins, row, "values");
    assert_int_equal(rays, within);
    clear_csv(&csv);
    clear_csv(&bins);
    assert_in_file(place, "out/report.html", "Distributions of counts");
    if (access("/usr/bin/gnuplot", X_OK) != 0) RT_SKIP("gnuplot-nox");
    assert_in_file(place, "out/plots/histograms-cloud.svg", "</svg>");
    assert_in_file(place, "out/plots/histograms-balls.svg", "shadow rays");
}

PLACE_TEST(files_that_are_named_after_scenes_have_portable_names_of_their_own) {
    write_changed(place, "small.yaml", spread, "label: cloud, size: 16x16}",
                  "label: \"n:50|x\", size: 16x16}\n  - {scene: \"balls:size=1\", label: N-50-X, size: 8x8}");
    assert_runs(place, "run small.yaml --out out --threads 1");
    const char *const names[] = {"n-50-x", "N-50-X-2", "balls"};
    char *page = read_in(place, "out/report.html"), *image = page;
    for (int i = 0; i < 3; i++) {
        char name[64];
        snprintf(name, sizeof name, "out/images/%s.png", names[i]);
        assert_true(rt_file_exists(path_in(place, name).text));
        image = strstr(image + 1, "data:image/png");
        assert_non_null(image);
    }
    assert_null(strstr(image + 1, "data:image/png"));
    rt_free(page);
    if (access("/usr/bin/gnuplot", X_OK) != 0) RT_SKIP("gnuplot-nox");
    assert_in_file(place, "out/plots/histograms-N-50-X-2.svg", "</svg>");
    assert_in_file(place, "out/report.html",
                   "Object tests and steps of each ray, and sizes and depths of leaves",
                   "plots/histograms-N-50-X-2.pdf");
}

/* On one thread and on two, and counted without them before: the journal of a shard has all that is needed.
 */
PLACE_TEST(distributions_are_the_same_bytes_on_two_threads_in_parts_and_in_shards) {
    assert_runs(place, "run small.yaml --out one --threads 1");
    assert_runs(place, "run small.yaml --out two --threads 2");
    assert_runs(place, "run small.yaml --out parts --only cloud/grid");
    assert_runs(place, "run small.yaml --out parts --resume");
    assert_runs(place, "run small.yaml --out s1 --shard 1/2");
    assert_runs(place, "run small.yaml --out s2 --shard 2/2");
    assert_runs(place, "merge s1 s2 -o merged");
    const char *const others[] = {"two", "parts", "merged"};
    for (int i = 0; i < 3; i++) {
        char distributions[64], histograms[64];
        snprintf(distributions, sizeof distributions, "%s/distributions.csv", others[i]);
        snprintf(histograms, sizeof histograms, "%s/histograms.csv", others[i]);
        assert_equal_files(place, "one/distributions.csv", distributions);
        assert_equal_files(place, "one/histograms.csv", histograms);
    }
}

PLACE_TEST(reproduce_compares_distributions_byte_for_byte) {
    assert_runs(place, "run small.yaml --out out --threads 1");
    assert_runs(place, "reproduce out");
    assert_in_file(place, "output", "out/histograms.csv, byte for byte");
    write_in(place, "out/distributions.csv", "other\n");
    assert_ends(place, "reproduce out", 1, "out/distributions.csv:1: differs");
}

PLACE_TEST(reproduce_of_one_scene_compares_its_rows_alone) {
    assert_runs(place, "run small.yaml --out out --threads 1");
    OWNED_MEMORY char *counts = read_in(place, "out/counts.csv");
    write_changed(place, "out/counts.csv", counts, "\nballs,", "\nballs,changed");
    assert_runs(place, "reproduce out --only cloud");
    assert_in_file(place, "output", "Reproduced: cloud in out/counts.csv");
    assert_ends(place, "reproduce out --only balls", 1, "out/counts.csv:8: differs");
    assert_ends(place, "reproduce out --only scattered", 2,
                "'scattered' is not the label of one of the scenes");
}

PLACE_TEST(bench_shows_medians_percentiles_and_maxima) {
    const char *const command = "bench random:n=50 --accel grid --accel wide --rays primary --size 16x16 "
                                "--count-only --distribution";
    char json[256];
    assert_runs(place, command);
    assert_in_file(place, "output", "tests: 50 %  99 %  max  steps: 50 %  99 %  max", "leaf size: 50 %");
    snprintf(json, sizeof json, "%s --json", command);
    assert_runs(place, json);
    assert_in_file(place, "output", "\"p999\"", "\"histograms\"");
}

/* ---- frames, and what version 1.0 had ---- */

PLACE_TEST(hardware_counters_of_version_1_0_are_ignored_in_experiments_and_journals) {
    char command[512];
    write_changed(place, "small.yaml", spread, "count_only: yes", "count_only: yes\nhardware: yes");
    assert_runs(place, "run small.yaml --out out --threads 1");
    assert_in_file(place, "message", "small.yaml:15:11: hardware: ignored");
    OWNED_MEMORY char *counts = read_in(place, "out/counts.csv");
    snprintf(
        command, sizeof command,
        "sed -i '$ a "
        "{\"scene\":\"balls\",\"accel\":\"grid\",\"kind\":\"primary\",\"hardware\":{\"threads\":1}}' '%s'",
        path_in(place, "out/cells.jsonl").text);
    assert_int_equal(system(command), 0);
    assert_ends(place, "run small.yaml --out out --threads 1 --resume", 0, "nothing was left to measure");
    assert_same_file(place, "out/counts.csv", counts);
    assert_ends(place, "bench balls --accel bvh --hardware", 2,
                "--hardware is no longer there: run raytally");
}

static double real_at(const Csv *csv, uint32_t row, const char *name) {
    return strtod(csv_field(csv, row, csv_find(csv, name)), NULL);
}

/* brute, with a stride, is too slow for frames. Resumed, the second time without a table. */
PLACE_TEST(a_run_that_renders_has_the_time_of_a_frame_and_the_part_of_queries_for_each_accelerator) {
    Csv csv;
    Path path = path_in(place, "out/render.csv");
    write_changed(place, "small.yaml", spread, "distributions: yes\ncount_only: yes",
                  "render: yes\nrounds: 6\nmilliseconds: 0\nexpect:\n"
                  "  - query_share of bvh < 1\n  - render_time of grid < 3600");
    assert_runs(place, "run small.yaml --out out --threads 1 --strict");
    assert_in_file(place, "output", "% in queries", "holds            query_share of bvh < 1");
    OWNED_MEMORY char *first = read_in(place, "out/render.csv");
    assert_int_equal(remove(path.text), 0);
    assert_runs(place, "run small.yaml --out out --threads 1 --resume");
    assert_same_file(place, "out/render.csv", first);
    read_csv(&csv, path.text);
    assert_int_equal(csv.rows, 2 * 2);
    for (uint32_t row = 0; row < csv.rows; row++) {
        assert_int_equal(integer_at(&csv, row, "render_rounds"), 6);
        assert_true(real_at(&csv, row, "render_ms_low") > 0);
        assert_true(real_at(&csv, row, "query_share_low") > 0 && real_at(&csv, row, "query_share_high") < 1);
        assert_true(real_at(&csv, row, "query_share_low") <= real_at(&csv, row, "query_share"));
    }
    clear_csv(&csv);
    char command[320];
    snprintf(command, sizeof command, "sed -i /rendered/d '%s'", path_in(place, "out/cells.jsonl").text);
    assert_int_equal(system(command), 0);
    assert_runs(place, "run small.yaml --out out --threads 1 --resume --dry-run");
    assert_in_file(place, "output", " of them finished");
}

PLACE_TEST(counting_again_renders_no_frame) {
    const RtWorkloadOptions counting = {.threads = 1, .timing = 1, .count_only = true};
    OWNED_RESULTS results;
    write_changed(place, "small.yaml", spread, "distributions: yes\ncount_only: yes", "render: yes");
    assert_ok(load_small(place, false, error));
    assert_ok(rt_results_init(&results, place->experiment, error));
    assert_ok(rt_workloads_run(&results, &counting, error));
    for (RtCellCursor at = {0}; rt_results_next(&results, &at);) {
        assert_true(at.cell->counted);
        assert_false(rt_build_at(&results, at.workload, at.candidate)->render.known);
    }
}

/* The journal of a run whose limit has left out a cell of grid: without its counts, times and frame. */
PLACE_TEST(what_is_too_slow_for_the_rays_is_not_rendered) {
    write_in(place, "small.yaml",
             "name: small\nquestion: a\nprediction: b\nscenes: [{scene: balls:size=1, size: 8x8}]\n"
             "accelerators: [{accel: bvh}, {accel: grid}]\nrays: [primary]\nrender: yes\nrounds: 2\n"
             "milliseconds: 0\n");
    assert_runs(place, "run small.yaml --out out --threads 1");
    assert_in_file(place, "out/render.csv", ",grid,");
    OWNED_MEMORY char *journal = read_in(place, "out/cells.jsonl"),
                      *left = rt_alloc(strlen(journal) + 200, 1);
    for (const char *line = journal, *end; (end = strchr(line, '\n')) != NULL; line = end + 1) {
        const size_t length = (size_t)(end + 1 - line);
        if (!memmem(line, length, "\"grid\"", 6) || memmem(line, length, "\"built\"", 7))
            strncat(left, line, length);
    }
    strcat(left, "{\"scene\":\"balls:size=1\",\"accel\":\"grid\",\"kind\":\"primary\",\"too_long\":\"3 s\","
                 "\"broken\":false}\n");
    write_in(place, "out/cells.jsonl", left);
    assert_ends(place, "run small.yaml --out out --threads 1 --resume", 0, "nothing was left to measure");
    assert_in_file(place, "output", "Left out: grid on balls:size=1, primary rays: 3 s");
    assert_not_in_file(place, "out/render.csv", ",grid,");
}

PLACE_TEST(rendering_where_nothing_is_timed_is_refused) {
    write_changed(place, "small.yaml", spread, "distributions: yes", "render: yes");
    assert_bad_input(load_small(place, false, error), ":13:9: render: rendering is timed");
}

RT_TESTS(distributions, NULL, NULL)
