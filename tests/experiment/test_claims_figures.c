/* SPDX-License-Identifier: Apache-2.0 */
/* Exponents, crossovers and correlations of results that are made by hand. */
#include "claims_testing.h"

static int set_up_primary(void **state) {
    const int result = set_up(state);
    e->kind_count = 1;
    return result;
}

static void set_objects(uint32_t t, double objects) {
    results.workloads[t].known = true;
    results.workloads[t].objects = (uint32_t)objects;
}

/* Time doubles with each tenfold n: log 2 / log 10 = 0.30103; the interval is log 1.04 / log 100 to a side.
 */
RT_TEST(an_exponent_has_the_interval_that_the_times_leave_it) {
    set_all();
    holds("exponent of time of bvh in n < 0.32", "0.301 [0.293, 0.310] over 3 values (bvh on random)");
    is_undecided("exponent of time of bvh in n < 0.305", "");
    is_false("exponent of time of bvh in n < 0.29", "");
}

/* Over 10 and 100 alone time would grow as n^0.301, over 10 and 1000 as n^1. */
RT_TEST(an_exponent_is_undecided_until_all_values_of_its_line_are_known) {
    set_all();
    for (uint32_t t = 0; t < 3; t++) set(t, 0, 20, 100 * pow(10, t), 100 * pow(10, t));
    is_false("exponent of time of bvh in n < 0.5", "1.00 over 3 values (bvh on random)");
    rt_cell_at(&results, 2, 0, RT_RAY_PRIMARY)->timed = false;
    is_undecided("exponent of time of bvh in n < 0.5", "1 of 3 values are unknown");
    is_undecided("exponent of time of bvh in n > 0.5", "1 of 3 values are unknown");
    rt_cell_at(&results, 1, 1, RT_RAY_PRIMARY)->counted = false;
    is_undecided("exponent of object_tests of grid in density < 0", "1 of 12 values");
    is_false("object_tests of grid rises with density on random:n=100", "1 of 3 values are unknown");
}

/* Logarithms of tests to base 10: 0, 2, 1, 3, over 1, 2, 3, 4: slope 0.8, residuals -0.3, 0.9, -0.9, 0.3,
 * standard error sqrt(1.8 / 2 / 5) = 0.424, and Student's t for two degrees of freedom is 4.303. */
RT_TEST(an_exponent_is_no_more_precise_than_the_scatter_round_the_line) {
    static const uint64_t tests[] = {10, 1000, 100, 10000};
    set_all();
    for (uint32_t t = 0; t < 4; t++) {
        set(t, 0, tests[t], 100, 100);
        set_objects(t, pow(10, t + 1));
    }
    is_undecided("exponent of object_tests of bvh in objects > 0.5",
                 "0.8 [-1.0, 2.6], standard error 0.424 over 4 values (bvh)");
    holds("exponent of object_tests of bvh in objects > -1.1", "");
    is_false("exponent of object_tests of bvh in objects > 2.7", "");
}

RT_TEST(the_number_of_objects_is_a_parameter_over_all_scenes) {
    set_all();
    for (uint32_t t = 0; t < 4; t++) set_objects(t, 10000 >> t); /* balls, t = 3, has the fewest */
    holds("exponent of time of bvh in objects < -0.9", "-1.00");
    holds("object_tests of bvh falls with objects", "2.30 at objects=1250, 2.00 at objects=10000 (bvh)");
    holds("exponent of time of bvh in objects on random < -0.9", "over 3 values");
    results.workloads[1].objects = 2500; /* as many as scene 2 */
    holds("object_tests of bvh falls with objects", "2.30 at objects=1250");
    for (uint32_t t = 1; t < 3; t++) {
        set(t, 0, 20, 100, 100);
        is_false("object_tests of bvh falls with objects",
                 "2.00 at objects=2500, 2.00 at objects=10000 (bvh)");
        set(t, 0, 20 + t, 100, 100);
    }
    set(2, 0, 24, 100, 100);
    is_false("object_tests of bvh falls with objects", "2.30 at objects=1250, 2.40 at objects=2500");
    results.workloads[3].known = false;
    is_undecided("exponent of time of bvh in objects < 5", "1 of 4 values are unknown");
}

/* bvh is exactly as dear as n, grid:density=1 as `tests`. */
static void set_curves(uint64_t tests0, uint64_t tests1, uint64_t tests2) {
    const uint64_t tests[] = {tests0, tests1, tests2};
    set_all();
    for (uint32_t t = 0; t < 3; t++) {
        set(t, 0, (uint64_t)pow(10, t + 1), pow(10, t + 1), 1.21 * pow(10, t + 1));
        set(t, 1, tests[t], (double)tests[t], (double)tests[t]);
    }
}

#define CROSSOVER         "crossover of object_tests of bvh and grid:density=1 in n"
#define CROSSOVER_OF_TIME "crossover of time of bvh and grid:density=1 in n"

RT_TEST(curves_cross_where_they_are_equal_between_two_values) {
    set_curves(200, 200, 200);
    shows(CROSSOVER, "bvh is above grid:density=1 from n=200 (bvh on random)");
    holds(CROSSOVER " > 199", "n=200");
    is_false(CROSSOVER " < 199", "n=200");
    set_curves(100, 100, 100);
    holds(CROSSOVER " >= 100", "bvh is above grid:density=1 from n=100 (bvh");
    set_curves(200, 100, 200); /* equal at 100, but bvh is below before and above after: 10^2 */
    shows(CROSSOVER, "from n=100 (bvh");
    shows("crossover of object_tests of grid:density=1 and bvh in n",
          "grid:density=1 is below bvh from n=100");
}

/* The time of bvh is between n and 1.21 n. It reaches 200 between 200 / 1.21 and 200; its median, 1.105 n, at
 * 181. */
RT_TEST(a_crossover_has_the_interval_in_which_the_curves_may_be_equal) {
    set_curves(200, 200, 200);
    holds(CROSSOVER_OF_TIME " > 160", "from n=181 [165, 200] (bvh on random)");
    is_undecided(CROSSOVER_OF_TIME " > 170", "");
    is_false(CROSSOVER_OF_TIME " > 201", "");
}

RT_TEST(a_paired_ratio_decides_a_crossover_with_the_baseline) {
    set_curves(200, 200, 200);
    for (uint32_t t = 0; t < 3; t++) {
        const double ratio = pow(10, t) / 20; /* throughput of grid over that of bvh */
        rt_cell_at(&results, t, 1, RT_RAY_PRIMARY)->ratio = (RtEstimate){ratio, ratio, ratio, ratio};
    }
    shows(CROSSOVER_OF_TIME " for primary rays", "from n=200 (bvh on random)");
}

RT_TEST(curves_that_do_not_cross_where_they_were_measured_decide_nothing) {
    set_curves(2000, 2000, 2000);
    shows(CROSSOVER, "bvh is below grid:density=1 from n=10 to 1000 (bvh on random)");
    is_undecided(CROSSOVER " > 100", "is below"); /* they may beyond 1000, or below 10 */
    is_undecided(CROSSOVER " < 100", "is below");
}

RT_TEST(of_several_crossovers_all_are_given_and_judged) {
    set_curves(5, 200, 500);
    shows(CROSSOVER, "2 crossovers: bvh is below grid:density=1 from n=");
    shows(CROSSOVER, ", is above grid:density=1 from n=316 (bvh");
    holds(CROSSOVER " < 320", "");
    is_false(CROSSOVER " > 100", "");
}

/* At n=1000 the ratio is between 1000 / 1100 and 1.1: the curves may meet there, and need not. */
RT_TEST(curves_that_may_cross_leave_a_claim_undecided) {
    set_curves(1100, 1100, 1100);
    is_undecided(CROSSOVER_OF_TIME " > 500",
                 "bvh is below grid:density=1 and may cross it at n=995 [909, >1000] (bvh");
    set_curves(1150, 1150, 1150);
    is_undecided(CROSSOVER_OF_TIME " > 500", "at n=[950, >1000] (bvh");
    set_curves(11, 11, 11);
    is_undecided(CROSSOVER_OF_TIME " < 50", "bvh may cross grid:density=1 at n=[<10.0, 11.0] (bvh");
    set_curves(1000, 115, 100000); /* below on both sides of 100 */
    is_undecided(CROSSOVER_OF_TIME " > 50", "and may cross it at n=[");
}

RT_TEST(a_possible_crossover_makes_a_claim_undecided_that_holds_for_the_certain_one) {
    set_curves(5, 200, 1100);
    is_undecided(
        CROSSOVER_OF_TIME " < 100",
        "bvh is below grid:density=1 from n=37.3 [31.6, 43.4], may cross grid:density=1 at n=983 [693, "
        ">1000]");
    holds(CROSSOVER_OF_TIME " > 10", "bvh is below grid:density=1 from n=");
    is_false(CROSSOVER_OF_TIME " > 100", "");
}

/* At n=100 grid has no tests, so the ratio is infinite there: no line of logarithms leads to it. */
RT_TEST(a_crossover_next_to_a_count_of_0_is_not_denied) {
    set_curves(20, 0, 0);
    for (uint32_t t = 0; t < 3; t++) rt_build_at(&results, t, 1)->counts = true;
    is_undecided(CROSSOVER " > 5", "bvh may cross grid:density=1 from n=10 to 1000");
    set_curves(5, 0, 0);
    is_undecided(CROSSOVER " > 5", "bvh is above grid:density=1 from n=10 to 1000");
    shows("ratio of object_tests of bvh to grid:density=1 on random:n=100", "inf (bvh");
    for (uint32_t t = 0; t < 3; t++) rt_build_at(&results, t, 1)->counts = false;
}

/* Where logarithms are equal only but for rounding. */
RT_TEST(equal_values_have_no_exponent_and_no_correlation) {
    set_all();
    for (uint32_t objects = 3; objects < 100; objects++) {
        for (uint32_t t = 0; t < 4; t++) {
            set_objects(t, objects);
            set(t, 0, 7 + t, 3.7, 3.7);
            for (uint32_t c = 1; c < 4; c++) set(t, c, t == 0 ? 7 + c : objects, 3.7, 3.7);
        }
        shows("exponent of object_tests of bvh in objects on random", "unknown over 3 values");
        shows("correlation of object_tests and time of grid on random:n=10", "unknown over 3 values");
        shows("correlation of object_tests and time of grid on random:n=100", "unknown over 3 values");
    }
}

RT_TEST(the_exponent_of_equal_values_is_exactly_0) {
    set_all();
    for (uint32_t t = 0; t < 3; t++) set(t, 0, 7, 3.7, 3.7);
    holds("exponent of time of bvh in n >= 0", "0 over 3 values");
    holds("exponent of object_tests of bvh in n <= 0", "0 over 3 values");
}

RT_TEST(the_smallest_and_the_largest_of_many_figures_are_of_those_that_are_known) {
    const char *const claim = "exponent of object_tests of all in n";
    RtCandidate more = {.spec = "octree", .ray_stride = 1};
    rt_results_clear(&results);
    assert_ok(rt_experiment_add_accels(e, &more, error));
    assert_ok(rt_results_init(&results, e, error));
    for (uint32_t c = 0; c < 5; c++) {
        for (uint32_t t = 0; t < 3; t++) set(t, c, (uint64_t)pow(10, c * t), 1, 1); /* slopes 0 to 4 */
    }
    for (uint32_t t = 0; t < 3; t++) results.workloads[t].rays[0] = 1000;
    set(1, 2, 0, 1, 1); /* that of slope 2 is unknown */
    shows(claim, "0 over 3 values (bvh on random) to 4.00 over 3 values (octree on random)");
    set(1, 2, 10000, 1, 1);
    set(1, 4, 0, 1, 1);
    shows(claim, "0 over 3 values (bvh on random) to 3.00 over 3 values");
    tear_down(NULL);
    set_up_primary(NULL);
}

RT_TEST(an_unknown_value_between_others_may_hide_a_crossover_and_one_at_the_end_shortens_the_range) {
    set_curves(20, 20, 20);
    *rt_cell_at(&results, 2, 1, RT_RAY_PRIMARY) = (RtCell){0};
    holds(CROSSOVER " > 15", "n=20.0 (bvh on random); 1 of 3 values are unknown");
    set_curves(20, 20, 20);
    *rt_cell_at(&results, 1, 1, RT_RAY_PRIMARY) = (RtCell){0};
    is_undecided(CROSSOVER " > 15", "n=20.0 (bvh on random); 1 of 3 values are unknown");
    is_false(CROSSOVER " > 25", "");
}

/* Of a parameter of accelerators the other has a single value. */
RT_TEST(a_curve_over_a_parameter_of_one_accelerator_crosses_the_value_of_the_other) {
    set_all();
    for (uint32_t c = 1; c < 4; c++) set(0, c, 10u << (2 * c), 1, 1); /* 4, 16, 64 at density 1, 2, 4 */
    set(0, 0, 80, 1, 1);
    shows("crossover of object_tests of grid and bvh in density on random:n=10",
          "grid is above bvh from density=1.41 (grid on random:n=10)");
    shows("crossover of object_tests of bvh and grid:density=2 in n on random", "from");
    shows("crossover of object_tests of grid and grid in density on random:n=10", /* equal */
          "grid may cross grid at density=1.00 and 2.00 and 4.00 [<1.00, >4.00] (grid on random:n=10)");
}

/* Logarithms to base 10: 0, 1, 2, 3 and 0, 2, 1, 3, so r = 0.8; artanh 0.8 -+ 1.96 / sqrt(4 - 3). */
RT_TEST(a_correlation_is_of_logarithms_and_has_fishers_interval) {
    static const double ns[] = {1, 100, 10, 1000};
    set_all();
    for (uint32_t c = 0; c < 4; c++) set(0, c, (uint64_t)pow(10, c + 1), ns[c], ns[c]);
    shows("correlation of object_tests and time of all on random:n=10",
          "0.800 [-0.697, 0.996] over 4 values (random:n=10)");
    is_undecided("correlation of object_tests and time of all on random:n=10 > 0.5", "");
    holds("correlation of object_tests and time of all on random:n=10 > -0.7", "");
    is_undecided("correlation of object_tests and time of grid on random:n=10 > 0.3",
                 "[-1.0, 1.0] over 3 values");
    for (uint32_t c = 0; c < 4; c++) rt_build_at(&results, 0, c)->counts = true;
    is_undecided("correlation of object_tests and extent_tests of all on random:n=10 < 2",
                 "unknown"); /* all 0 */
}

/* Over both scenes r would be 0.6, which is that of the means. */
RT_TEST(a_correlation_is_within_each_scene_and_a_claim_holds_for_each) {
    set_all();
    for (uint32_t c = 0; c < 4; c++) {
        set(0, c, (uint64_t)pow(10, c), pow(10, 3 - c), pow(10, 3 - c));
        set(1, c, (uint64_t)pow(10, c + 4), pow(10, c + 4), pow(10, c + 4));
    }
    is_false("correlation of object_tests and time of all > 0.9", "-1.00 over 4 values (random:n=10)");
    shows("correlation of object_tests and time of all on random:n=100",
          "1.00 [1.00, 1.00] over 4 values (random:n=100)");
    shows("correlation of object_tests and time of bvh", "fewer than two values");
}

RT_TEST(a_correlation_of_all_leaves_out_structures_without_the_measure) {
    set_all();
    for (uint32_t c = 0; c < 4; c++) {
        RtBuildResult *build = rt_build_at(&results, 0, c);
        *build = (RtBuildResult){.known = true, .counts = true};
        build->structure.predicted_cost = c < 2 ? 100 * pow(2, 3 * c) : NAN;
    }
    set(0, 1, 10, 800, 800); /* each time as predicted */
    shows("correlation of predicted_cost and time of all on random:n=10", "over 2 values (random:n=10)");
    shows("correlation of predicted_cost and time of grid on random:n=10", "2 of 3 values are unknown");
}

RT_TESTS(claims_figures, set_up_primary, tear_down)
