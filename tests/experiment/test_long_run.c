/* SPDX-License-Identifier: Apache-2.0 */
/* Runs that take long: a part of them, and what is left out. */
#include "experiment_testing.h"

static const char long_experiment[] = "name: small\nquestion: How long?\nprediction: A second.\n"
                                      "scenes:\n"
                                      "  - {scene: \"balls:size=2\", label: balls, size: 24x24}\n"
                                      "  - {scene: \"random:n=200|400\", label: cloud, size: 24x24}\n"
                                      "  - {scene: \"random:n=300,seed=2\", label: other, size: 24x24}\n"
                                      "accelerators:\n"
                                      "  - {accel: bvh}\n"
                                      "  - {accel: \"grid:density=1..16*2\"}\n"
                                      "  - {accel: brute, ray_stride: 10}\n"
                                      "rays: [primary, diffuse]\nlimit: 300\nrounds: 3\nmilliseconds: 3\n";

PLACES_WITH(long_experiment)

#define RESUME "run small.yaml --threads 1 --out out --resume"

PLACE_TEST(a_dry_run_lists_the_cells_and_touches_nothing) {
    assert_runs(place, "run small.yaml --out out --dry-run");
    assert_in_file(place, "output", "cloud:n=400              grid:density=16              diffuse\n",
                   "56 cells, 0 of them finished\n");
    assert_false(rt_file_exists(path_in(place, "out").text));
    assert_runs(place, "run small.yaml --out out --only cloud/grid/diffuse --dry-run");
    assert_in_file(place, "output", "12 cells"); /* bvh, the baseline, too */
}

PLACE_TEST(a_dry_run_of_a_changed_experiment_is_refused_as_the_run_is) {
    assert_runs(place, "run small.yaml --threads 1 --out out --only balls/bvh");
    OWNED_MEMORY char *journal = read_in(place, "out/cells.jsonl");
    write_changed(place, "small.yaml", long_experiment, "density=1..16*2", "density=1|4");
    assert_ends(place, "run small.yaml --out out --dry-run", 2, "another version of it ('small')");
    assert_ends(place, "run small.yaml --out out --force --dry-run", 0, "");
    assert_in_file(place, "output", "32 cells, 0 of them finished");
    assert_same_file(place, "out/cells.jsonl", journal);
}

PLACE_TEST(a_part_is_measured_and_then_the_rest) {
    assert_runs(place, "run small.yaml --threads 1 --out whole");
    assert_ends(place, "run small.yaml --threads 1 --out out --only cloud:n=400/brute/primary", 0,
                "a part was measured");
    assert_false(rt_file_exists(path_in(place, "out/manifest.json").text));
    OWNED_MEMORY char *counts = read_in(place, "out/counts.csv");
    assert_non_null(strstr(counts, "brute"));
    assert_null(strstr(counts, "grid"));
    assert_null(strstr(counts, "diffuse"));
    assert_int_equal(raytally(place, "run small.yaml --threads 1 --out out"), 2);
    assert_runs(place, RESUME);
    assert_equal_files(place, "whole/counts.csv", "out/counts.csv");
    assert_runs(place, RESUME " --dry-run");
    assert_in_file(place, "output", "56 cells, 56 of them finished\n");
    assert_int_equal(raytally(place, "run small.yaml --threads 1 --out out --only nowhere --resume"), 2);
}

PLACE_TEST(what_goes_beyond_a_limit_is_left_out_and_recorded) {
    write_changed(place, "small.yaml", long_experiment, "n=200|400\", label: cloud",
                  "n=20000\", label: cloud");
    write_changed(place, "limited.yaml", long_experiment, "limit: 300", "limits: {megabytes: 1}\nlimit: 300");
    char *text = read_in(place, "limited.yaml");
    write_changed(place, "small.yaml", text, "n=200|400\"", "n=200|30000\"");
    rt_free(text);
    /* bvh, the baseline, takes 2 MB of 30000 spheres. */
    assert_ends(place, "run small.yaml --threads 1 --out out", 0,
                "cloud:n=30000: without the baseline 'bvh' there are no ratios");
    text = read_in(place, "small.yaml");
    write_changed(place, "small.yaml", text, "rays: [", "baseline: brute\nrays: [");
    rt_free(text);
    text = read_in(place, "small.yaml");
    write_changed(place, "small.yaml", text, ", ray_stride: 10", "");
    rt_free(text);
    assert_runs(place, "run small.yaml --threads 1 --out out --force");
    assert_in_file(place, "output", "Refused: bvh on cloud:n=30000: it needs more than 1 MB of memory");
    assert_in_file(place, "out/cells.jsonl", "too_large");
    assert_in_file(place, "out/report.html", "it needs more than 1 MB of memory");
    assert_ends(place, "run small.yaml --threads 1 --out out --resume", 0, "nothing was left to measure");
    assert_in_file(place, "output", "Refused: bvh on cloud:n=30000");
    /* The option takes the place of the limit in the YAML. */
    assert_runs(place, "run small.yaml --threads 1 --out out --force --memory 1G");
    OWNED_MEMORY char *lines = read_in(place, "out/cells.jsonl");
    assert_non_null(strstr(lines, "\"scene\":\"cloud:n=30000\",\"accel\":\"bvh\",\"kind\":\"primary\""));
    assert_ends(place, "run small.yaml --threads 1 --out out --memory 1Q", 2, "as in 512M or 4G");
}

static bool in_journal(const char *journal, const char *scene, const char *accel, const char *kind) {
    char cell[160];
    snprintf(cell, sizeof cell, "\"scene\":\"%s\",\"accel\":\"%s\",\"kind\":\"%s\"", scene, accel, kind);
    return strstr(journal, cell) != NULL;
}

/* bvh is the baseline. */
PLACE_TEST(several_parts_are_measured_together) {
    static const char *const scenes[] = {"balls", "cloud:n=200", "cloud:n=400"},
                             *const accels[] = {"bvh", "grid:density=1", "brute"},
                             *const kinds[] = {"primary", "diffuse"};
    const char *parts =
        "--only cloud:n=200/grid/primary --only cloud:n=200/brute/diffuse --only cloud:n=400/grid";
    char command[256];
    snprintf(command, sizeof command, "run small.yaml --threads 1 --out out %s", parts);
    assert_runs(place, command);
    OWNED_MEMORY char *journal = read_in(place, "out/cells.jsonl");
    for (int s = 0; s < 3; s++) {
        for (int a = 0; a < 3; a++) {
            for (int k = 0; k < 2; k++) {
                const bool asked = s == 0 ? false : a == 0 ? true : s == 1 ? k == (a == 2) : a == 1;
                assert_int_equal(in_journal(journal, scenes[s], accels[a], kinds[k]), asked);
            }
        }
    }
    snprintf(command, sizeof command, "run small.yaml --threads 1 --out out --resume --dry-run %s", parts);
    assert_runs(place, command);
    assert_in_file(place, "output", "20 cells, 20 of them finished\n");
    assert_ends(place, "run small.yaml --out out --only cloud --only nowhere --resume", 2,
                "'nowhere' is not the label");
}

PLACE_TEST(a_cell_that_would_take_too_long_is_not_begun) {
    write_changed(place, "small.yaml", long_experiment, "limit: 300", "limits: {seconds: 1e-6}\nlimit: 300");
    assert_ends(place, "run small.yaml --threads 1 --out out", 2, "the baseline 'bvh' is left out");
    write_changed(place, "small.yaml", long_experiment, "limit: 300", "limits: {seconds: 0}\nlimit: 300");
    assert_ends(place, "run small.yaml --threads 1 --out out --force", 2,
                "limits.seconds: invalid value '0': expected more than 0");
    write_changed(place, "small.yaml", long_experiment, "n=200|400\", label: cloud, size: 24x24",
                  "n=200|100000\", label: cloud, size: 100x100");
    char *text = read_in(place, "small.yaml");
    write_changed(place, "small.yaml", text, "limit: 300", "limits: {seconds: 0.5}\nlimit: 10000");
    rt_free(text);
    text = read_in(place, "small.yaml");
    write_changed(place, "small.yaml", text, ", ray_stride: 10", "");
    rt_free(text);
    if (raytally(place, "run small.yaml --threads 1 --out out --force") != 0)
        RT_SKIP("a machine on which bvh takes less than half a second"); /* the baseline */
    assert_in_file(place, "output", "Left out: brute on cloud:n=100000, primary rays: it would take about");
}

/* A refusal costs its own rows, which say why, and is reproduced; the baseline's costs the ratios, too. */
PLACE_TEST(a_refusal_costs_its_own_rows_which_say_why) {
    char obj[30000] = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    for (int i = 0; i < 3500; i++) strcat(obj, "f 1 2 3\n");
    write_in(place, "same.obj", obj);
    write_in(place, "small.yaml",
             "name: small\nquestion: Does it go on?\nprediction: Yes.\n"
             "scenes:\n  - {scene: same.obj, size: 16x16}\n"
             "accelerators:\n  - {accel: \"grid:density=30000\", label: grid}\n  - {accel: bvh}\n"
             "rays: [primary, random]\nlimit: 50\nrounds: 2\nmilliseconds: 0\nbaseline: grid\n"
             "expect:\n  - ratio of object_tests of grid to bvh < 1\n");
    assert_ends(place, "run small.yaml --threads 1 --out out", 0, "grid on same: refused: a grid of ");
    assert_in_file(place, "output", "Refused: grid on same: a grid of ",
                   "undecided        ratio of object_tests of grid to bvh < 1", "refused: a grid of");
    OWNED_MEMORY char *counts = read_in(place, "out/counts.csv");
    assert_non_null(strstr(counts, ",refused\n"));
    assert_non_null(strstr(counts, "would fit\"\n"));
    assert_non_null(strstr(counts, ",bvh,"));
    assert_runs(place, "reproduce out");
    assert_ends(place, "run small.yaml --threads 1 --out out --resume", 0, "nothing was left to measure");
    assert_runs(place, "compare out out");
    assert_runs(place, "report out");
    assert_in_file(place, "out/report.html", "Refused: grid on same");
    assert_ends(place, "bench same.obj --size 9x9 -a grid:density=30000 --count-only", 2,
                "every accelerator refuses the scene: a grid of ");
    assert_ends(place, "verify same.obj --rays 9 -a grid:density=30000", 2, "every accelerator refuses");
    assert_ends(place, "verify same.obj --rays 9 -a grid:density=30000 -a bvh", 0,
                "grid:density=30000 on same.obj: refused: a grid of ");
    assert_in_file(place, "output", "1 row refused");
    assert_ends(place,
                "render same.obj --size 9x9 -a grid:density=30000 -a bvh --heatmap steps x.png --check", 0,
                "grid:density=30000 is refused: a grid of ");
    assert_ends(place, "render same.obj --size 9x9 -a grid:density=30000 --check", 2, "a grid of ");
}

RT_TESTS(long_run, NULL, NULL)
