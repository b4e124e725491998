/* SPDX-License-Identifier: Apache-2.0 */
/* Experiments that sweep parameters: rows, columns, and the plot that needs no script. */
#include "csv_testing.h"
#include "experiment_testing.h"

#include <unistd.h>

static const char swept[] = "name: small\n"
                            "question: Which density is best?\n"
                            "prediction: Four.\n"
                            "scenes:\n"
                            "  - {scene: \"random:n=20..200*10\", label: cloud, size: 12x12}\n"
                            "  - {scene: balls, size: 8x8}\n"
                            "accelerators:\n"
                            "  - {accel: bvh}\n"
                            "  - {accel: \"grid:density=1..16*2\", scenes: [cloud]}\n"
                            "  - {accel: \"bvh:build=sweep|lbvh\", label: other}\n"
                            "rays: [primary]\n"
                            "limit: 100\n"
                            "rounds: 2\n"
                            "milliseconds: 0\n";

PLACES_WITH(swept)

/* 2 clouds with 1 + 5 + 2 accelerators, and balls with 3. */
PLACE_TEST(each_value_is_a_row_and_each_parameter_a_column_at_the_end) {
    OWNED_CSV csv;
    assert_runs(place, "run small.yaml --out out --threads 1");
    Path path = path_in(place, "out/counts.csv");
    read_csv(&csv, path.text);
    assert_int_equal(csv.rows, 2 * 8 + 3);
    assert_string_equal(csv_name(&csv, csv.columns - 3), "scene.n");
    assert_string_equal(csv_name(&csv, csv.columns - 2), "accel.density");
    assert_string_equal(csv_name(&csv, csv.columns - 1), "accel.build");
    uint32_t n = csv.columns - 3, density = csv.columns - 2, build = csv.columns - 1, row = 8 + 5;
    assert_string_equal(csv_field(&csv, row, csv_find(&csv, "scene")), "cloud:n=200");
    assert_string_equal(csv_field(&csv, row, csv_find(&csv, "accel")), "grid:density=16");
    assert_string_equal(csv_field(&csv, row, n), "200");
    assert_string_equal(csv_field(&csv, row, density), "16");
    assert_string_equal(csv_field(&csv, row, build), "");
    assert_string_equal(csv_field(&csv, 18, n), "");
    assert_string_equal(csv_field(&csv, 18, build), "lbvh");
}

PLACE_TEST(without_scripts_a_plot_is_drawn_for_each_parameter_and_measure) {
    assert_runs(place, "run small.yaml --out out --threads 1");
    if (access("/usr/bin/gnuplot", X_OK) != 0) RT_SKIP("gnuplot-nox");
    const char *const drawn[] = {"out/plots/01-sweep-n-time.svg",
                                 "out/plots/02-sweep-n-object-tests.svg",
                                 "out/plots/03-sweep-n-steps.svg",
                                 "out/plots/04-sweep-density-time.svg",
                                 "out/plots/05-sweep-density-object-tests.svg",
                                 "out/plots/07-sweep-build-time.svg"};
    for (size_t i = 0; i < sizeof drawn / sizeof drawn[0]; i++) assert_in_file(place, drawn[i], "</svg>");
    assert_in_file(place, drawn[0], "grid:density=16");
    assert_in_file(place, drawn[0], "ns per ray");
    assert_in_file(place, drawn[0], "viewBox=\"0 0 480 ");
    assert_in_file(place, drawn[5], "lbvh");
    assert_in_file(place, drawn[5], "cloud:n=200");
    assert_in_file(place, drawn[5], "viewBox=\"0 0 960 ");
    assert_in_file(place, "out/report.html", "data:image/svg+xml");
    assert_false(rt_file_exists(path_in(place, "out/plots/sweeps.gp").text));
    assert_runs(place, "plot out --paper column");
    assert_in_file(place, drawn[5], "viewBox=\"0 0 480 ");
}

/* Lines by line as src/report/plot.c says; a legend and shades in the order of the sweep need it. */
PLACE_TEST(the_data_of_a_plot_has_a_block_per_scene_and_in_it_a_line_per_accelerator) {
    unsigned color, before = 0;
    int marker;
    double x;
    char value[8];
    assert_runs(place, "run small.yaml --out out --threads 1");
    OWNED_MEMORY char *density = read_in(place, "out/plots/sweep-density.tsv");
    const char *grid = strstr(density, "cloud:n=20\tgrid\t"), *flat = strstr(density, "cloud:n=20\tbvh\t");
    assert_true(flat == density && grid);
    assert_int_equal(sscanf(flat, "cloud:n=20\tbvh\t%u\t%d\t%lf\t%7s", &color, &marker, &x, value), 4);
    assert_true(marker == 0 && x == 1);
    for (int k = 0; k < 5; k++, grid = strchr(grid, '\n') + 1) {
        assert_int_equal(sscanf(grid, "cloud:n=20\tgrid\t%u\t%d\t%lf\t%7s", &color, &marker, &x, value), 4);
        assert_true(marker > 0 && x == 1 << k && strtod(value, NULL) == x);
    }
    assert_int_equal(*grid, '\n');
    OWNED_MEMORY char *n = read_in(place, "out/plots/sweep-n.tsv");
    for (int k = 0; k < 5; k++) {
        char line[64];
        snprintf(line, sizeof line, "cloud\tgrid:density=%d\t", 1 << k);
        const char *at = strstr(n, line);
        assert_non_null(at);
        assert_int_equal(sscanf(at + strlen(line), "%u", &color), 1);
        assert_true((color >> 8 & 255) > before); /* from dark to light */
        before = color >> 8 & 255;
    }
    OWNED_MEMORY char *build = read_in(place, "out/plots/sweep-build.tsv");
    assert_non_null(strstr(build, "\t1\tlbvh\t"));
    assert_non_null(strstr(build, "\n\n\nballs\tbvh\t"));
}

PLACE_TEST(a_bad_sweep_is_refused_with_its_line) {
    const struct {
        const char *from, *to, *says;
    } cases[] = {
        {"1..16*2", "1..16", ":9:13: accelerators[1].accel: '1..16' is not a range"},
        {"1..16*2", "1|-4", ":9:"},
        {"1..16*2", "1..16*2|1..16+0.01", "more than 256 values"},
        {"grid:density", "grid:densty", "did you mean 'density'?"},
        {"20..200*10", "1..64+1", ":5:13: scenes[0].scene: there are more than 32 scenes"},
        {"limit: 100", "baseline: other", ":12:"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        write_changed(place, "small.yaml", swept, cases[i].from, cases[i].to);
        assert_bad_input(load_small(place, false, error), cases[i].says);
    }
}

/* Specs of kept results are not parsed, for the accelerators may be missing; gnuplot runs what stands in
 * backquotes in the variables that it gets. */
PLACE_TEST(a_swept_value_that_gnuplot_would_run_is_refused_also_in_results_that_are_read) {
    json_t *manifest = json_object();
    write_changed(place, "small.yaml", swept, "grid:density=1..16*2",
                  "grid:mailbox=on,resolution=auto,empty_steps_stay=on,rule=woo|`harm`");
    assert_bad_input(
        rt_experiment_load(place->experiment, path_in(place, "small.yaml").text, false, manifest, error),
        "rule=`harm`' cannot name");
    json_decref(manifest);
}

PLACE_TEST(bench_takes_sweeps_of_scenes_and_accelerators) {
    assert_int_equal(raytally(place, "bench 'random:n=10|20' --accel bvh --accel 'grid:density=1..4*2' "
                                     "--ray-stride 3 --rays primary --size 8x8 --count-only --csv rows.csv"),
                     0);
    Csv csv;
    Path path = path_in(place, "rows.csv");
    read_csv(&csv, path.text);
    assert_int_equal(csv.rows, 2 * 4);
    for (uint32_t row = 1; row < 4; row++)
        assert_string_equal(csv_field(&csv, row, csv_find(&csv, "ray_stride")), "3");
    assert_string_equal(csv_field(&csv, 7, csv.columns - 2), "20");
    assert_string_equal(csv_field(&csv, 7, csv.columns - 1), "4");
    clear_csv(&csv);
    assert_int_equal(raytally(place, "bench 'random:n=10|20' --accel bvh --rays primary --count-only --json"),
                     0);
    assert_in_file(place, "output", "random:n=10");
    assert_in_file(place, "output", "random:n=20");
    assert_ends(place, "bench balls --accel 'grid:density=1..4'", 2, "is not a range");
}

RT_TESTS(sweep_plot, NULL, NULL)
