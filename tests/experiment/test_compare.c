/* SPDX-License-Identifier: Apache-2.0 */
/* experiment/compare.h: two result directories, one of which is changed. */
#include "experiment_testing.h"

#include "experiment/compare.h"

static const char experiment_yaml[] = "name: small\n"
                                      "question: Which is cheaper?\n"
                                      "prediction: The hierarchy.\n"
                                      "scenes: [{scene: \"balls:size=1\", size: 8x8, depth: 2}]\n"
                                      "accelerators: [{accel: bvh}, {accel: grid}]\n"
                                      "rays: [primary, random]\n"
                                      "limit: 100\n"
                                      "rounds: 12\n"
                                      "milliseconds: 0\n";

typedef struct Sides {
    RtExperiment *experiments; /* [2] */
    RtResults results[2];
    RtComparison comparison;
} Sides;

/* The same run as both sides, with times that spread by a percent in an order that differs. */
static void load_sides(const Place *place, Sides *sides) {
    Path out = path_in(place, "out");
    write_in(place, "small.yaml", experiment_yaml);
    assert_ok(run_small(place, "out", false, (RtRunOptions){.start = RT_START_ANEW}, error));
    *sides = (Sides){.experiments = rt_alloc(2, sizeof(RtExperiment))};
    assert_non_null(sides->experiments);
    for (int i = 0; i < 2; i++) {
        assert_ok(rt_run_load(out.text, &sides->experiments[i], &sides->results[i], error));
        for (uint32_t c = 0; c < 2; c++) {
            for (uint32_t k = 0; k < 2; k++) {
                RtCell *cell = rt_cell_at(&sides->results[i], 0, c, sides->experiments[i].kinds[k]);
                assert_int_equal(cell->rounds, 12);
                double *seconds = rt_cell_round_times(cell, RT_ROUND_SECONDS);
                for (uint32_t r = 0; r < 12; r++)
                    seconds[r] = 1e-7 * (1 + 0.001 * (double)((5 * r + 3 * (uint32_t)i) % 12));
            }
        }
    }
}

static void clear_sides(Sides *sides) {
    rt_comparison_clear(&sides->comparison);
    for (int i = 0; i < 2; i++) rt_results_clear(&sides->results[i]);
    rt_free(sides->experiments);
}

static RtCell *after_cell(const Sides *sides, uint32_t candidate, RtRayKind kind) {
    return rt_cell_at(&sides->results[1], 0, candidate, kind);
}

static void scale(const Sides *sides, uint32_t candidate, RtRayKind kind, double factor) {
    RtCell *cell = after_cell(sides, candidate, kind);
    for (uint32_t r = 0; r < cell->rounds; r++) rt_cell_round_times(cell, RT_ROUND_SECONDS)[r] *= factor;
}

static const RtComparedCell *compared(Sides *sides, const char *accel, const char *kind) {
    RtComparedCell *cell = rt_comparison_cell(&sides->comparison, "balls:size=1", accel, kind);
    assert_non_null(cell);
    return cell;
}

#define RT_TEST_IN_PLACE(name) RT_TEST_WITH(name, make_place, remove_place)

RT_TEST_IN_PLACE(a_run_does_not_differ_from_itself) {
    Sides sides;
    load_sides(*state, &sides);
    assert_ok(rt_compare_results(&sides.results[0], &sides.results[1], &sides.comparison, error));
    assert_int_equal(sides.comparison.count, 4);
    assert_int_equal(rt_comparison_count(&sides.comparison, RT_CHANGE_NONE), 4);
    assert_int_equal(rt_comparison_changed(&sides.comparison), 0);
    clear_sides(&sides);
}

RT_TEST_IN_PLACE(what_is_faster_slower_or_counts_otherwise_is_said_of_the_cell) {
    Sides sides;
    load_sides(*state, &sides);
    scale(&sides, 0, RT_RAY_PRIMARY, 1.1);
    scale(&sides, 1, RT_RAY_PRIMARY, 0.9);
    scale(&sides, 1, RT_RAY_RANDOM, 1.03);
    scale(&sides, 0, RT_RAY_RANDOM, 0.97);
    after_cell(&sides, 0, RT_RAY_RANDOM)->tally.steps++;
    sides.comparison.margin = 0.05;
    assert_ok(rt_compare_results(&sides.results[0], &sides.results[1], &sides.comparison, error));
    assert_int_equal(compared(&sides, "bvh", "primary")->change, RT_CHANGE_SLOWER);
    assert_int_equal(compared(&sides, "grid", "primary")->change, RT_CHANGE_FASTER);
    assert_int_equal(compared(&sides, "grid", "random")->change, RT_CHANGE_NONE); /* within the margin */
    assert_int_equal(compared(&sides, "bvh", "random")->change, RT_CHANGE_NONE);
    const RtEstimate ratio = compared(&sides, "bvh", "primary")->ratio;
    assert_true(rt_estimate_holds(&ratio, 1 / 1.1) && rt_estimate_width(&ratio) < 0.012);
    assert_int_equal(rt_comparison_changed(&sides.comparison), 1);
    char *text;
    size_t size;
    FILE *out = open_memstream(&text, &size);
    rt_comparison_print(&sides.comparison, out);
    fclose(out);
    assert_non_null(strstr(text, "1 faster, 1 slower, 2 no difference; counts changed in 1."));
    assert_non_null(strstr(text, "balls:size=1 bvh random: steps "));
    free(text);
    clear_sides(&sides);
    load_sides(*state, &sides); /* without a margin 3 % are found, too */
    scale(&sides, 1, RT_RAY_RANDOM, 1.03);
    assert_ok(rt_compare_results(&sides.results[0], &sides.results[1], &sides.comparison, error));
    assert_int_equal(compared(&sides, "grid", "random")->change, RT_CHANGE_SLOWER);
    clear_sides(&sides);
}

RT_TEST_IN_PLACE(cells_that_do_not_compare_say_why) {
    Sides sides;
    load_sides(*state, &sides);
    sides.results[1].workloads[0].ray_fingerprints[RT_RAY_RANDOM]++;
    rt_free(after_cell(&sides, 0, RT_RAY_PRIMARY)->round_times);
    after_cell(&sides, 0, RT_RAY_PRIMARY)->round_times = NULL;
    strcpy(sides.experiments[1].candidates[1].label, "grid2");
    assert_ok(rt_compare_results(&sides.results[0], &sides.results[1], &sides.comparison, error));
    assert_int_equal(compared(&sides, "bvh", "primary")->change, RT_CHANGE_NOT_TIMED);
    assert_int_equal(compared(&sides, "bvh", "random")->change, RT_CHANGE_OTHER_RAYS);
    assert_int_equal(compared(&sides, "grid", "primary")->change, RT_CHANGE_ONLY_BEFORE);
    assert_int_equal(compared(&sides, "grid2", "primary")->change, RT_CHANGE_ONLY_AFTER);
    assert_int_equal(sides.comparison.timed, 0);
    clear_sides(&sides);
}

RT_TEST_IN_PLACE(strict_makes_something_slower_an_exit_code) {
    const Place *place = *state;
    write_in(place, "small.yaml", experiment_yaml);
    assert_int_equal(raytally(place, "run small.yaml --out a"), 0);
    char command[256];
    snprintf(command, sizeof command, "cp -r '%s/a' '%s/b'", place->folder, place->folder);
    assert_int_equal(system(command), 0);
    assert_int_equal(raytally(place, "compare a b --strict"), 0);
    assert_in_file(place, "output", "4 no difference; counts changed in 0.");
    /* Times of 1e-7 s a ray become ten times longer by their exponents. */
    char *journal = read_in(place, "b/cells.jsonl");
    for (char *at = journal; (at = strstr(at, "e-")) != NULL; at += 2) at[2] = (char)(at[2] - (at[2] > '0'));
    write_in(place, "b/cells.jsonl", journal);
    rt_free(journal);
    assert_int_equal(raytally(place, "compare a b --strict --json"), 1);
    assert_in_file(place, "output", "\"time\": \"slower\"");
    assert_int_equal(raytally(place, "compare a b"), 0);
    assert_int_equal(raytally(place, "compare b a --strict"), 0);
}

/* Writes the program `other` beside the experiment: runs `before`, then raytally with `arguments`. */
static void write_other(const Place *place, const char *before, const char *arguments) {
    char script[1024];
    snprintf(script, sizeof script, "#!/bin/bash\ncd '%s' || exit\n%s\nexec '%s' %s\n", place->folder, before,
             RT_PROGRAM, arguments);
    write_in(place, "other", script);
    snprintf(script, sizeof script, "chmod +x '%s/other'", place->folder);
    assert_int_equal(system(script), 0);
}

RT_TEST_IN_PLACE(a_program_that_crashes_while_it_is_compared_is_reported_with_its_signal) {
    const Place *place = *state;
    write_other(place, "echo '{\"worker\": 1, \"build\": \"none\"}'; kill -SEGV $$", "");
    assert_int_equal(
        raytally(place, "compare balls:size=1 --accel bvh --rays random --limit 100 --with ./other"), 2);
    assert_in_file(place, "message", "./other cannot be compared: it crashed (Segmentation fault)");
}

/* The other program has another accelerator in the place of the grid in the second round, as one has none
 * whose limit of time it goes beyond. */
RT_TEST_IN_PLACE(what_was_not_timed_in_every_round_is_not_compared) {
    const Place *place = *state;
    write_other(place, "echo >>runs\n[ \"$(wc -l <runs)\" != 2 ] || set -- \"${@/grid/octree}\"", "\"$@\"");
    assert_int_equal(raytally(place,
                              "compare balls:size=1 --accel bvh --accel grid --rays random --limit 100 "
                              "--rounds 3 --with ./other"),
                     0);
    assert_in_file(place, "output", "not timed");
    assert_in_file(place, "output", "only before");
}

/* The advice is correct: the commands that it names have the options that it names. */
RT_TEST_IN_PLACE(programs_that_record_other_rays_are_told_how_to_compare_all_the_same) {
    const Place *place = *state;
    write_other(place, "", "\"$@\" --seed 7");
    assert_int_equal(
        raytally(place, "compare balls:size=1 --accel bvh --rays random --limit 100 --with ./other"), 2);
    assert_in_file(place, "message", "do not record the same rays");
    assert_in_file(
        place, "message",
        "with `raytally rays`, and measure each program on that file: `raytally bench --rays-from");
    assert_int_equal(raytally(place, "rays balls:size=1 --rays random --limit 100 -o rays.npy"), 0);
    assert_int_equal(
        raytally(place, "bench balls:size=1 --accel bvh --rays nearest --rays-from rays.npy --count-only"),
        0);
}

RT_TESTS(compare, NULL, NULL)
