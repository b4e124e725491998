/* SPDX-License-Identifier: Apache-2.0 */
/* Totals over kinds of rays: each weighs as much as its whole set, whatever the limit. */
#include "experiment_testing.h"

static const char small_experiment[] =
    "name: small\nquestion: What does a frame cost?\nprediction: The same whatever is measured of it.\n"
    "scenes: [{scene: \"gears:size=1\", size: 64x64, depth: 3}]\n"
    "accelerators: [{accel: brute, group: all}, {accel: grid, group: all}, "
    "{accel: bvh, group: all}]\n"
    "count_only: yes\ncoherent_run: 1\nframe: {without: brute, among: all}\nlimit: 100000\n"
    "quick: {limit: 4000}\n";

PLACES_WITH(small_experiment)

static void load_results(const Place *place, const char *directory, RtResults *results) {
    assert_ok(rt_results_load(path_in(place, directory).text, place->experiment, results, error));
}

PLACE_TEST(the_same_frame_with_a_lower_limit_has_nearly_the_same_totals) {
    OWNED_RESULTS part = {0};
    double whole[2][3];
    RtKinds frame = 0;
    for (int k = 0; k < RT_RAY_KIND_COUNT; k++) frame |= rt_ray_kind_is_of_frame((RtRayKind)k) ? 1u << k : 0;
    assert_ok(run_small(place, "all", false, (RtRunOptions){0}, error));
    {
        OWNED_RESULTS all = {0};
        load_results(place, "all", &all);
        assert_true(all.workloads[0].rays[RT_RAY_SHADOW] > 2 * all.workloads[0].rays[RT_RAY_PRIMARY]);
        for (uint32_t c = 0; c < 3; c++) {
            whole[0][c] = rt_results_total(&all, 0, c, frame).object_tests;
            whole[1][c] = rt_results_cost(&all, 0, c, RT_ALL_RAYS).object_tests;
        }
    }
    assert_ok(run_small(place, "part", true, (RtRunOptions){0}, error));
    load_results(place, "part", &part);
    assert_true(part.workloads[0].rays[RT_RAY_SHADOW] <= 4000);
    for (uint32_t c = 0; c < 3; c++) {
        const double own = rt_results_total(&part, 0, c, frame).object_tests,
                     mean = rt_results_cost(&part, 0, c, RT_ALL_RAYS).object_tests;
        assert_true(fabs(own / whole[0][c] - 1) < 0.03);
        assert_true(fabs(mean / whole[1][c] - 1) < 0.03);
    }
}

/* ---- a journal made by hand ---- */

/* 10 of 1000 primary rays, 20 of 7000 shadow rays, and 5 reflection rays. */
static const struct {
    RtRayKind kind;
    uint64_t rays, whole, tests;
} sets[] = {{RT_RAY_PRIMARY, 10, 1000, 30}, {RT_RAY_SHADOW, 20, 7000, 180}, {RT_RAY_REFLECTION, 5, 5, 25}};
enum { SETS = sizeof sets / sizeof sets[0] };

static void put_set(FILE *out, const char *whole, RtRayKind kind) {
    unsigned long long rays = 0, all = 0;
    for (int i = 0; i < SETS; i++) {
        if (sets[i].kind != kind) continue;
        rays = sets[i].rays;
        all = sets[i].whole;
    }
    fprintf(out, "%s\"%s\":{\"rays\":%llu,\"%s\":%llu,\"hash\":\"0000000000000001\"}", kind ? "," : "",
            rt_ray_kind_name(kind), rays, whole, all);
}

/* Replaces what the run in out/ counted; `whole` names the member with the sizes of whole sets. */
static void write_journal(const Place *place, const char *whole) {
    FILE *out = fopen(path_in(place, "out/cells.jsonl").text, "a");
    assert_non_null(out);
    fputs("{\"scene\":\"gears:size=1\",\"workload\":{\"objects\":9,\"width\":64,\"height\":64,"
          "\"hash\":\"0000000000000001\",\"sets\":{",
          out);
    for (int k = 0; k < RT_RAY_KIND_COUNT; k++) put_set(out, whole, (RtRayKind)k);
    fputs("}}}\n", out);
    for (int i = 0; i < SETS; i++) {
#define ZERO(name, meaning) "\"" #name "\":0,"
        fprintf(
            out,
            "{\"scene\":\"gears:size=1\",\"accel\":\"bvh\",\"kind\":\"%s\",\"counted\":{" RT_TALLY_COUNTERS(
                ZERO) "\"differ\":0,\"rays\":%d,\"object_tests\":%d}}\n",
            rt_ray_kind_name(sets[i].kind), (int)sets[i].rays, (int)sets[i].tests);
#undef ZERO
    }
    assert_int_equal(fclose(out), 0);
}

static RtCost total_of(const RtResults *results) {
    return rt_results_total(results, 0, 2, rt_experiment_kinds(results->experiment));
}

PLACE_TEST(a_total_weighs_each_kind_by_its_whole_set_to_the_digit) {
    OWNED_RESULTS results = {0};
    assert_ok(run_small(place, "out", true, (RtRunOptions){0}, error));
    write_journal(place, "whole_rays");
    load_results(place, "out", &results);
    const RtCost total = total_of(&results);
    assert_true(total.whole && total.rays == 35 && total.weight == 8005);
    assert_true(total.object_tests == 1000 * 3 + 7000 * 9 + 5 * 5);
    assert_true(rt_results_cost(&results, 0, 2, RT_ALL_RAYS).object_tests == (3000 + 63000 + 25) / 8005.0);
    assert_runs(place, "report out");
    assert_in_file(place, "out/report.html", "all kinds of rays together, of 8005 rays, 35 measured",
                   "1000 primary, 7000 shadow and 5 secondary rays; of 8005 rays");
    assert_in_file(place, "out/tables.md", "all kinds of rays, of 8005 rays, 35 measured.");
    assert_in_file(place, "out/tables.tex", "all kinds of rays, of 8005 rays, 35 measured.");
}

PLACE_TEST(a_result_without_the_sizes_of_whole_sets_says_of_the_measured_part) {
    OWNED_RESULTS results = {0};
    assert_ok(run_small(place, "out", true, (RtRunOptions){0}, error));
    write_journal(place, "as_in_1.0");
    load_results(place, "out", &results);
    const RtCost total = total_of(&results);
    assert_true(total.weight == 35 && total.object_tests == 30 + 180 + 25);
    assert_runs(place, "report out");
    assert_in_file(place, "out/report.html", "all kinds of rays together, of the measured part");
    assert_in_file(place, "out/tables.md", "all kinds of rays, of the measured part.");
}

PLACE_TEST(whole_sets_are_in_the_manifest_and_in_the_names_for_plots_but_not_in_counts_csv) {
    write_in(place, "x.gp", "set print '../sets'\nprint sets\n");
    write_changed(place, "small.yaml", small_experiment, "quick:", "plots: [x.gp]\nquick:");
    assert_runs(place, "run small.yaml --quick --out out");
    assert_in_file(place, "out/manifest.json", "\"whole_rays\": 4096");
    assert_not_in_file(place, "out/counts.csv", "whole");
    if (access("/usr/bin/gnuplot", X_OK) != 0) RT_SKIP("gnuplot-nox");
    assert_in_file(place, "sets", "gears:size=1/primary=4096 ");
}

RT_TESTS(totals, NULL, NULL)
