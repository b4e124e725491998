/* SPDX-License-Identifier: Apache-2.0 */
/* compare/compare.h: result directories, one of which is changed; and other programs. */
#include "experiment_testing.h"

#include "compare/compare.h"

static const char experiment_yaml[] =
    "name: small\nquestion: Which is cheaper?\nprediction: The hierarchy.\n"
    "scenes: [{scene: \"balls:size=1\", size: 8x8, depth: 2}, {scene: \"tetra:size=1\", size: 8x8, depth: "
    "2},\n"
    "  {scene: \"random:n=20\", size: 8x8, depth: 2}, {scene: \"gears:size=1\", size: 8x8, depth: 2}]\n"
    "accelerators: [{accel: bvh}, {accel: grid}, {accel: octree}, {accel: kd}]\nrays: [primary, random]\n"
    "limit: 100\nrounds: 6\nmilliseconds: 0\n";

enum { SCENES = 4, ACCELS = 4, KINDS = 2, ROUNDS = 6, MOST_PAIRS = 2, RUNS = 2 * MOST_PAIRS };

typedef struct Sides {
    RtExperiment *experiments; /* [RUNS] */
    RtResults results[RUNS];
    RtComparison comparison;
} Sides;

static RtCell *cell_at(const Sides *sides, uint32_t run, uint32_t scene, uint32_t candidate, uint32_t kind) {
    return rt_cell_at(&sides->results[run], scene, candidate, sides->experiments[run].kinds[kind]);
}

/* Multiplies the times of a cell. */
static void scale(RtCell *cell, double factor) {
    double *seconds = rt_cell_round_times(cell, RT_ROUND_SECONDS);
    for (uint32_t r = 0; r < cell->rounds; r++) seconds[r] *= factor;
    cell->seconds = rt_estimate(seconds, cell->rounds);
}

static void scale_accel(const Sides *sides, uint32_t run, uint32_t candidate, double factor) {
    for (uint32_t t = 0; t < SCENES; t++) {
        for (uint32_t k = 0; k < KINDS; k++) scale(cell_at(sides, run, t, candidate, k), factor);
    }
}

/* Times as runs have them: the machine is faster or slower by up to 5 % for a run; a structure is, by a long-
 * tailed figure (Student's t of two degrees of freedom, in units of 0.8 %), as long as its process lives; a
 * kind of rays by up to 1 %, and a round by up to 2 %. */
static void draw_times(const Sides *sides, uint32_t run, uint64_t seed) {
    RtRandom random = rt_random(seed, run);
    const double machine = rt_random_betweend(&random, 0.95, 1.05);
    for (uint32_t t = 0; t < SCENES; t++) {
        for (uint32_t c = 0; c < ACCELS; c++) {
            const double u = rt_random_betweend(&random, 1e-6, 1 - 1e-6);
            const double process = exp(0.008 * (2 * u - 1) / sqrt(2 * u * (1 - u)));
            for (uint32_t k = 0; k < KINDS; k++) {
                RtCell *cell = cell_at(sides, run, t, c, k);
                const double kind = rt_random_betweend(&random, 0.99, 1.01);
                for (uint32_t r = 0; r < ROUNDS; r++)
                    rt_cell_round_times(cell, RT_ROUND_SECONDS)[r] =
                        1e-7 * machine * process * kind * rt_random_betweend(&random, 1, 1.02);
                cell->seconds = rt_estimate(rt_cell_round_times(cell, RT_ROUND_SECONDS), ROUNDS);
            }
        }
    }
}

/* One run as both sides of all pairs, with times that are drawn. */
static Sides load_sides(const Place *place) {
    Path out = path_in(place, "out");
    write_in(place, "small.yaml", experiment_yaml);
    assert_ok(run_small(place, "out", false, (RtRunOptions){.start = RT_START_ANEW}, error));
    Sides sides = {.experiments = rt_alloc(RUNS, sizeof(RtExperiment))};
    assert_non_null(sides.experiments);
    for (uint32_t i = 0; i < RUNS; i++) {
        assert_ok(rt_results_load(out.text, &sides.experiments[i], &sides.results[i], error));
        draw_times(&sides, i, 1);
    }
    return sides;
}

static void clear_sides(Sides *sides) {
    rt_comparison_clear(&sides->comparison);
    for (int i = 0; i < RUNS; i++) rt_results_clear(&sides->results[i]);
    rt_free(sides->experiments);
}

static void compare_sides(Sides *sides, uint32_t pairs, double margin) {
    rt_comparison_clear(&sides->comparison);
    sides->comparison.margin = margin;
    assert_ok(rt_compare_results(sides->results, pairs, &sides->comparison, error));
}

static const RtComparedCell *compared(Sides *sides, const char *accel, const char *kind) {
    RtComparedCell *cell = rt_comparison_cell(&sides->comparison, "balls:size=1", accel, kind);
    assert_non_null(cell);
    return cell;
}

/* Whether it is printed, whatever the line breaks. */
static bool is_printed(const RtComparison *comparison, const char *words) {
    char *text;
    size_t size;
    FILE *out = open_memstream(&text, &size);
    rt_comparison_print(comparison, out);
    fclose(out);
    for (char *at = text; (at = strchr(at, '\n')) != NULL;) *at = ' ';
    bool found = strstr(text, words) != NULL;
    if (!found) print_message("%s\n", text);
    free(text);
    return found;
}

PLACES_WITH(NULL)

PLACE_TEST(a_run_does_not_differ_from_itself) {
    OWNED(clear_sides) Sides sides = load_sides(place);
    for (uint32_t t = 0; t < SCENES; t++) {
        for (uint32_t c = 0; c < ACCELS; c++) {
            for (uint32_t k = 0; k < KINDS; k++) {
                RtCell *one = cell_at(&sides, 0, t, c, k), *other = cell_at(&sides, 1, t, c, k);
                memcpy(other->round_times, one->round_times, ROUNDS * sizeof(double));
                other->seconds = one->seconds;
            }
        }
    }
    compare_sides(&sides, 1, 0);
    assert_int_equal(sides.comparison.count, SCENES * ACCELS * KINDS);
    assert_int_equal(rt_comparison_count(&sides.comparison, RT_CHANGE_BY_ACCEL), SCENES * ACCELS * KINDS);
    assert_int_equal(rt_comparison_count(&sides.comparison, RT_CHANGE_NONE), ACCELS);
    assert_int_equal(rt_comparison_changed(&sides.comparison), 0);
}

/* 5 %: one of twenty pairs of runs of one build. */
PLACE_TEST(of_runs_of_one_build_at_most_five_in_a_hundred_pairs_report_a_difference) {
    enum { TRIALS = 400 };
    OWNED(clear_sides) Sides sides = load_sides(place);
    for (uint32_t pairs = 1; pairs <= MOST_PAIRS; pairs++) {
        int reports = 0;
        for (uint64_t seed = 0; seed < TRIALS; seed++) {
            for (uint32_t i = 0; i < 2 * pairs; i++) draw_times(&sides, i, seed);
            compare_sides(&sides, pairs, 0);
            reports += rt_comparison_count(&sides.comparison, RT_CHANGE_NONE) < ACCELS;
        }
        if (reports > TRIALS / 20) fail_msg("%d of %d with %u pairs", reports, TRIALS, pairs);
    }
}

/* The same runs, one accelerator of which takes longer. */
PLACE_TEST(an_accelerator_that_is_ten_per_cent_slower_is_found_and_no_other_is_called_different) {
    enum { TRIALS = 200 };
    OWNED(clear_sides) Sides sides = load_sides(place);
    int found = 0, others = 0;
    for (uint64_t seed = 0; seed < TRIALS; seed++) {
        for (uint32_t i = 0; i < RUNS; i++) draw_times(&sides, i, seed);
        for (uint32_t i = 1; i < RUNS; i += 2) scale_accel(&sides, i, 1, 1.1);
        compare_sides(&sides, MOST_PAIRS, 0.02);
        found += sides.comparison.accels[1].change == RT_CHANGE_SLOWER;
        others += rt_comparison_count(&sides.comparison, RT_CHANGE_NONE) < ACCELS - 1;
    }
    if (found < TRIALS * 9 / 10 || others > TRIALS / 20)
        fail_msg("found in %d of %d, others in %d", found, TRIALS, others);
    assert_string_equal(sides.comparison.accels[1].accel, "grid");
}

PLACE_TEST(a_change_of_all_accelerators_is_printed_and_no_verdict) {
    OWNED(clear_sides) Sides sides = load_sides(place);
    for (uint32_t c = 0; c < ACCELS; c++) scale_accel(&sides, 1, c, 1.5);
    compare_sides(&sides, 1, 0.02);
    assert_int_equal(rt_comparison_count(&sides.comparison, RT_CHANGE_NONE), ACCELS);
    assert_true(sides.comparison.all_accels > 0.6 && sides.comparison.all_accels < 0.74);
    assert_true(is_printed(&sides.comparison, "The median accelerator: 0."));
}

PLACE_TEST(what_is_faster_slower_or_counts_otherwise_is_said) {
    OWNED(clear_sides) Sides sides = load_sides(place);
    scale_accel(&sides, 1, 0, 2);
    scale_accel(&sides, 1, 1, 0.5);
    cell_at(&sides, 1, 0, 0, 1)->tally.steps++;
    compare_sides(&sides, 1, 0.02);
    assert_int_equal(sides.comparison.accels[0].change, RT_CHANGE_SLOWER);
    assert_int_equal(sides.comparison.accels[1].change, RT_CHANGE_FASTER);
    assert_true(rt_estimate_holds(&sides.comparison.accels[0].ratio, 0.5));
    assert_int_equal(rt_comparison_changed(&sides.comparison), 1);
    assert_true(is_printed(&sides.comparison,
                           "1 faster, 1 slower, 2 with no difference found; counts changed in 1."));
    assert_true(is_printed(&sides.comparison, "balls:size=1 bvh random: steps "));
    compare_sides(&sides, 1, 1.5); /* 2.5 times is the margin */
    assert_int_equal(rt_comparison_count(&sides.comparison, RT_CHANGE_NONE), ACCELS);
}

/* 1 - 2 / C(12, 6) = 99.78 % for each; 32 of them miss by 6.93 % at most. 32 cells take 1 - 0.05 / 32 =
 * 99.84 %, and 1 - 2 / C(14, 7) is 99.94 %. */
PLACE_TEST(the_confidence_that_the_rounds_reach_is_said_and_how_many_it_takes) {
    OWNED(clear_sides) Sides sides = load_sides(place);
    compare_sides(&sides, 1, 0);
    assert_true(fabs(sides.comparison.together - (1 - 32 * 2 / 924.0)) < 1e-9);
    assert_true(is_printed(&sides.comparison,
                           "each holds with 99.78 %, all 32 together with 93.1 % confidence. "
                           "95 % together takes 7 rounds before and after."));
    compare_sides(&sides, 2, 0); /* 12 rounds each are enough */
    assert_true(fabs(sides.comparison.together - 0.95) < 1e-9);
    assert_true(is_printed(&sides.comparison, "all 32 together with 95 % confidence."));
    sides.comparison.coverage = rt_coverage_of_each(1064); /* as a large experiment needs */
    assert_true(is_printed(&sides.comparison, "each holds with 99.9953 %, all"));
}

PLACE_TEST(too_few_accelerators_or_scenes_have_no_verdict) {
    OWNED(clear_sides) Sides sides = load_sides(place);
    for (uint32_t t = 0; t < SCENES; t++) {
        for (uint32_t c = 0; c < ACCELS; c++) {
            for (uint32_t k = 0; k < KINDS && (t > 0 || c > 2); k++) {
                rt_free(cell_at(&sides, 0, t, c, k)->round_times);
                cell_at(&sides, 0, t, c, k)->round_times = NULL;
            }
        }
    }
    scale_accel(&sides, 1, 0, 10);
    compare_sides(&sides, 1, 0); /* one scene */
    assert_int_equal(rt_comparison_count(&sides.comparison, RT_CHANGE_NOT_JUDGED), 3);
    assert_true(is_printed(&sides.comparison, "Times are not judged: "));
    scale_accel(&sides, 3, 0, 10);
    compare_sides(&sides, 2, 0); /* two pairs of runs */
    assert_int_equal(sides.comparison.accels[0].groups, 1 + SCENES);
    assert_int_equal(sides.comparison.accels[0].change, RT_CHANGE_SLOWER);
}

PLACE_TEST(cells_that_do_not_compare_say_why) {
    OWNED(clear_sides) Sides sides = load_sides(place);
    sides.results[1].workloads[0].ray_fingerprints[RT_RAY_RANDOM]++;
    rt_free(cell_at(&sides, 1, 0, 0, 0)->round_times);
    cell_at(&sides, 1, 0, 0, 0)->round_times = NULL;
    strcpy(sides.experiments[1].candidates[1].label, "grid2");
    compare_sides(&sides, 1, 0);
    assert_int_equal(compared(&sides, "bvh", "primary")->change, RT_CHANGE_NOT_TIMED);
    assert_int_equal(compared(&sides, "bvh", "random")->change, RT_CHANGE_OTHER_RAYS);
    assert_int_equal(compared(&sides, "grid", "primary")->change, RT_CHANGE_ONLY_BEFORE);
    assert_int_equal(compared(&sides, "grid2", "primary")->change, RT_CHANGE_ONLY_AFTER);
}

RT_TEST(where_time_and_instructions_disagree_is_said_in_a_sentence_and_else_the_ratio_alone) {
    static const struct {
        RtChange change;
        double after; /* instructions, as a part of those before */
        const char *says;
    } cases[] = {{RT_CHANGE_FASTER, 1.0002, "balls bvh primary: instructions equal"},
                 {RT_CHANGE_SLOWER, 1, "balls bvh primary: instructions equal"},
                 {RT_CHANGE_FASTER, 1.008, "0.8 % more instructions although it measured faster"},
                 {RT_CHANGE_SLOWER, 0.97, "3 % fewer instructions although it measured slower"},
                 {RT_CHANGE_SLOWER, 1.03, NULL},
                 {RT_CHANGE_NONE, 1.03, NULL}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        OWNED(rt_comparison_clear) RtComparison comparison = {0};
        RtComparedCell *cell = rt_comparison_cell(&comparison, "balls", "bvh", "primary");
        assert_non_null(cell);
        cell->change = cases[i].change;
        cell->instructions[0] = 1000;
        cell->instructions[1] = 1000 * cases[i].after;
        assert_true(is_printed(&comparison, cases[i].says ? cases[i].says : "1.0300"));
        if (!cases[i].says) assert_false(is_printed(&comparison, "balls bvh primary:"));
    }
}

/* Each pair of runs has the same rays, but the pairs have not. */
PLACE_TEST(results_of_other_rays_are_not_said_to_count_the_same) {
    write_in(place, "small.yaml", experiment_yaml);
    assert_runs(place, "run small.yaml --out a");
    assert_runs(place, "run small.yaml --out b");
    write_changed(place, "small.yaml", experiment_yaml, "name: small", "name: small\nseed: 7");
    assert_runs(place, "run small.yaml --out c");
    assert_runs(place, "run small.yaml --out d");
    assert_runs(place, "compare a b c d");
    assert_in_file(place, "output", "other rays", "not the same in all results, so ");
}

PLACE_TEST(strict_makes_something_slower_an_exit_code) {
    write_in(place, "small.yaml", experiment_yaml);
    assert_runs(place, "run small.yaml --out a");
    char command[256];
    snprintf(command, sizeof command, "cp -r '%s/a' '%s/b'", place->folder, place->folder);
    assert_int_equal(system(command), 0);
    assert_runs(place, "compare a b --strict");
    assert_in_file(place, "output", "0 faster, 0 slower, 4 with no difference found; counts changed in 0.");
    /* Times of 1e-7 s a ray become ten times longer by their exponents: those of the grid. */
    OWNED_MEMORY char *journal = read_in(place, "b/cells.jsonl");
    for (char *line = journal, *end; (end = strchr(line, '\n')) != NULL; line = end + 1) {
        *end = '\0';
        bool grid = strstr(line, "\"grid\"") != NULL;
        for (char *at = line; grid && (at = strstr(at, "e-")) != NULL; at += 2)
            at[2] = (char)(at[2] - (at[2] > '0'));
        *end = '\n';
    }
    write_in(place, "b/cells.jsonl", journal);
    assert_int_equal(raytally(place, "compare a b --strict --json"), 1);
    assert_in_file(place, "output", "\"time\": \"slower\"");
    assert_runs(place, "compare a b");
    assert_runs(place, "compare b a --strict");
    assert_ends(place, "compare a b a/ b", 2, "a/ is given twice as BEFORE");
    assert_runs(place, "compare a b b a");
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

PLACE_TEST(a_program_that_crashes_while_it_is_compared_is_reported_with_its_signal) {
    write_other(place, "echo '{\"worker\": 1, \"build\": \"none\"}'; kill -SEGV $$", "");
    assert_ends(place, "compare balls:size=1 --accel bvh --rays random --limit 100 --with ./other", 2,
                "./other cannot be compared: it crashed (Segmentation fault)");
}

/* A cell has room for the times of RT_MAX_ROUNDS rounds, one each. The second of the two cells is asked for
 * as the first. */
PLACE_TEST(a_program_that_lists_a_cell_twice_is_refused) {
    write_other(place, "exec 3<&0",
                "\"$@\" < <(sed -u 's/^time 1 /time 0 /' <&3) > "
                ">(sed -u 's/\"cells\":\\[\\(.*\\)\\]}$/\"cells\":[\\1,\\1]}/')");
    assert_ends(place, "compare balls:size=1 --accel bvh --rays random --limit 100 --with ./other", 2,
                "./other cannot be compared: it lists bvh on balls:size=1 twice");
}

/* The other program has another accelerator in the place of the grid in the second round, as one has none
 * whose limit of time it goes beyond. */
PLACE_TEST(what_was_not_timed_in_every_round_is_not_compared) {
    write_other(place, "echo >>runs\n[ \"$(wc -l <runs)\" != 2 ] || set -- \"${@/grid/octree}\"", "\"$@\"");
    assert_runs(place, "compare balls:size=1 --accel bvh --accel grid --rays random --limit 100 "
                       "--rounds 3 --with ./other");
    assert_in_file(place, "output", "not timed", "only before");
}

PLACE_TEST(programs_that_record_other_rays_are_told_how_to_compare_all_the_same) {
    write_other(place, "", "\"$@\" --seed 7");
    assert_ends(place, "compare balls:size=1 --accel bvh --rays random --limit 100 --with ./other", 2,
                "do not record the same rays");
    assert_in_file(place, "message", "`raytally bench --rays-from");
}

RT_TESTS(compare, NULL, NULL)
