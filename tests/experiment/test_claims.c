/* SPDX-License-Identifier: Apache-2.0 */
/* Claims, held against results that are made by hand. */
#include "claims_testing.h"

RT_TEST(a_claim_about_counts_is_exact_and_holds_for_every_cell_or_not_at_all) {
    set_all();
    holds("object_tests of bvh < 2.31", "2.30 (bvh on balls, primary rays)");
    is_false("object_tests of bvh < 2.3", "2.30 (bvh on balls, primary rays)");
    holds("object_tests of bvh <= 2.3", "");
    holds("object_tests of bvh on random < 2.3", "2.20 (bvh on random:n=100");
    is_false("object_tests of grid for shadow rays > 5", "3.30 (grid:density=4");
    holds("object_tests of grid at density=1 > 9", "10");
    holds("object_tests of bvh at n=1e3 >= 2.2", "2.20 (bvh on random:n=1000, primary rays)");
    holds("object_tests of grid at smallest density >= 10", "10");
    holds("ratio of object_tests of grid:density=1 to bvh at smallest n >= 5", "5.00");
}

RT_TEST(a_claim_about_times_is_undecided_where_an_interval_straddles) {
    set_all();
    holds("time of bvh on random:n=10 < 105", "102 [100, 104] (bvh");
    is_undecided("time of bvh on random:n=10 < 103", "102 [100, 104]");
    is_false("time of bvh on random:n=10 < 100", "102 [100, 104]");
    is_undecided("time of bvh on random:n=10 >= 103", "");
    is_false("time of bvh < 103", "on balls");
}

/* 100 / 215 to 104 / 200. Paired on one kind, it is what the rounds gave. */
RT_TEST(a_ratio_of_times_is_of_ends_or_paired) {
    set_all();
    holds("ratio of time of bvh to grid:density=1 on random:n=10 > 0.46", "0.49 [0.47, 0.52]");
    is_undecided("ratio of time of bvh to grid:density=1 on random:n=10 > 0.49", "");
    rt_cell_at(&results, 0, 1, RT_RAY_PRIMARY)->ratio = (RtEstimate){0.5, 0.49, 0.51, 0.4};
    holds("ratio of time of bvh to grid:density=1 on random:n=10 for primary rays > 0.485",
          "0.50 [0.49, 0.51]");
    holds("ratio of time of grid:density=1 to bvh on random:n=10 for primary rays > 1.95",
          "2.00 [1.96, 2.04]");
}

RT_TEST(a_trend_is_from_each_value_to_the_next) {
    set_all();
    holds("object_tests of grid falls with density", "10.0 at density=1, 3.30 at density=4");
    is_false("object_tests of grid rises with density", "10.0 at density=1, 5.00 at density=2");
    holds("object_tests of bvh rises with n", "2.00 at n=10, 2.20 at n=1000");
    is_false("object_tests of grid falls with n", "");
    holds("object_tests of grid never falls with n", "");
    holds("time of bvh rises with n", "102 [100, 104] at n=10, 408 [400, 416] at n=1000");
    is_undecided("time of grid falls with density", "");
    set(1, 2, 100, 200, 210);
    is_false("object_tests of grid falls with density", "10.0 at density=1, 10.0 at density=2");
    holds("object_tests of grid never rises with density", "");
}

RT_TEST(what_was_not_measured_decides_nothing) {
    set_all();
    *rt_cell_at(&results, 0, 0, RT_RAY_PRIMARY) = *rt_cell_at(&results, 0, 0, RT_RAY_SHADOW) = (RtCell){0};
    expect(RT_CLAIM_UNMEASURED, "object_tests of bvh on random:n=10 < 5", "nothing that this claim is about");
    expect(RT_CLAIM_UNMEASURED, "ratio of time of grid:density=1 to bvh on random:n=10 > 9", "");
    is_undecided("object_tests of bvh < 5", "2 of 8 values are unknown");
    is_false("object_tests of bvh > 5", "2 of 8 values are unknown");
}

RT_TEST(a_claim_about_build_times_is_undecided_within_their_interval) {
    *rt_build_at(&results, 0, 0) = (RtBuildResult){.known = true, .builds = 6, .seconds = {3, 2, 5, 2}};
    holds("build_time of bvh on random:n=10 < 5.5", "3 [2, 5]");
    is_undecided("build_time of bvh on random:n=10 < 4", "3 [2, 5]");
    is_false("build_time of bvh on random:n=10 < 1", "3 [2, 5]");
}

/* grid:density=1 needs 2 tests a ray of the one kind and 50 of the other, bvh 5 and 5. Without the dear kind
 * grid would seem to be ahead. */
RT_TEST(a_kind_of_rays_that_one_side_lacks_leaves_a_claim_about_all_kinds_undecided) {
    static const char ahead[] =
        "ratio of object_tests of grid:density=1 to bvh on random:n=10 for all rays < 1",
                      faster[] = "ratio of time of grid:density=1 to bvh on random:n=10 for all rays < 1";
    set(0, 0, 50, 100, 100);
    set(0, 1, 20, 50, 50);
    RtCell *dear = rt_cell_at(&results, 0, 1, RT_RAY_SHADOW), cell = *dear;
    cell.tally.object_tests = 50000;
    cell.seconds = (RtEstimate){1e-6, 1e-6, 1e-6, 1e-6};
    *dear = cell;
    is_false(ahead, "5.20");
    is_false(faster, "5.25");
    assert_int_equal(rt_standing(&results, 0, 0, RT_RAY_KIND_COUNT), RT_STANDING_BEST);
    *dear = (RtCell){.left_out = "it would take about 3 s, more than 1 s"};
    is_undecided(ahead, "no measurements of all kinds");
    is_undecided(faster, "no measurements of all kinds");
    holds("ratio of object_tests of grid:density=1 to bvh on random:n=10 for primary rays < 1", "0.40");
    assert_true(isnan(rt_results_cost(&results, 0, 1, RT_ALL_RAYS).seconds.median));
    assert_true(isnan(rt_results_break_even(&results, 0, 1).rays.median));
    assert_int_equal(rt_standing(&results, 0, 0, RT_RAY_KIND_COUNT), RT_STANDING_BEST);
    assert_int_equal(rt_standing(&results, 0, 1, RT_RAY_KIND_COUNT), RT_STANDING_BEHIND);
    assert_int_equal(rt_standing(&results, 0, 1, RT_RAY_PRIMARY), RT_STANDING_BEST);
}

/* As --only leaves it. */
RT_TEST(totals_of_a_kind_that_all_were_measured_on_compare_and_a_claim_waits_for_the_others) {
    set_all();
    for (uint32_t c = 0; c < 4; c++) *rt_cell_at(&results, 0, c, RT_RAY_SHADOW) = (RtCell){0};
    const RtCost total = rt_results_cost(&results, 0, 0, RT_ALL_RAYS);
    assert_true(total.object_tests == 2);
    assert_false(total.whole);
    is_undecided("object_tests of bvh on random:n=10 for all rays < 5", "no measurements of all kinds");
}

RT_TEST(a_quantity_without_a_bound_is_a_figure_and_no_claim) {
    set_all();
    shows("time of bvh on random:n=10", "102 [100, 104] ns (bvh on random:n=10, primary rays)");
    shows("object_tests of bvh on random for all rays",
          "2.00 (bvh on random:n=10); 2.10 (bvh on random:n=100); 2.20 (bvh on random:n=1000)");
    shows(
        "object_tests of grid",
        "3.30 (grid:density=4 on random:n=10, primary rays) to 10.0 (grid:density=1 on random:n=10, primary "
        "rays)");
    shows("ratio of time of bvh to grid:density=1 on random:n=10", "0.49 [0.47, 0.52]");
    shows("exponent of time of bvh in n", "0.301 [0.293, 0.310] over 3 values");
    rt_cell_at(&results, 0, 0, RT_RAY_PRIMARY)->timed = false;
    shows("time of bvh on random", "1 of 6 values are unknown");
    shows("time of bvh on random:n=10 for all rays", "no measurements of all kinds");
    strcpy(e->claims[0], "object_tests of bvh");
    strcpy(e->claims[1], "object_tests of bvh > 5");
    e->claim_count = 2;
    RtError why;
    assert_int_equal(rt_claims_check(&results, &why), RT_MISMATCH);
    assert_string_equal(why.message, "1 of 1 claims do not hold, the first: object_tests of bvh > 5");
    e->claim_count = 1;
    assert_ok(rt_claims_check(&results, error));
}

RT_TEST(structures_and_csg_trees_have_measures_of_their_own) {
    set_all();
    rt_cell_at(&results, 0, 1, RT_RAY_PRIMARY)->tally.csg_tests = 7000;
    rt_build_at(&results, 0, 1)->counts = true;
    shows("csg_tests of grid:density=1 on random:n=10 for all rays", "3.50");
    for (uint32_t c = 0; c < 4; c++) {
        RtBuildResult *build = rt_build_at(&results, 0, c);
        const double seconds = c == 3 ? 0.5 : 1 + c;
        *build = (RtBuildResult){.known = true, .builds = 6, .seconds = {seconds, seconds, seconds, seconds}};
        build->structure.predicted_cost = c == 0 ? NAN : 12;
        for (uint32_t k = 0; k < 2; k++) {
            RtCell *cell = rt_cell_at(&results, 0, c, (RtRayKind)k);
            cell->wall = (RtEstimate){1e-3, 1e-3, 1e-3, 1e-3};
            const double ratio = c == 1 ? 2 : 0.5;
            cell->ratio = (RtEstimate){ratio, ratio, ratio, ratio};
        }
    }
    holds("predicted_cost of grid:density=1 on random:n=10 >= 12", "12.0");
    is_undecided("predicted_cost of bvh on random:n=10 < 5", "no such value");
    holds("break_even of grid:density=1 on random:n=10 < 1001", "1000");
    is_false("break_even of grid:density=2 on random:n=10 < 1e9", "never");
    is_false("break_even of grid:density=4 on random:n=10 < 1e9", "never"); /* ahead only before */
    rt_cell_at(&results, 0, 3, RT_RAY_PRIMARY)->ratio = (RtEstimate){1.1, 0.9, 1.2, 0.9};
    rt_cell_at(&results, 0, 3, RT_RAY_SHADOW)->ratio = (RtEstimate){1.1, 0.9, 1.2, 0.9};
    is_undecided("break_even of grid:density=4 on random:n=10 < 1e9",
                 "0 [0, inf]"); /* ahead of any number, or only of few */
    shows("break_even of bvh on random:n=10", "no such value");
    for (uint32_t k = 0; k < 2; k++)
        rt_cell_at(&results, 0, 3, (RtRayKind)k)->ratio = (RtEstimate){0.95, 0.9, 1.5, 0.9};
    is_undecided("break_even of grid:density=4 on random:n=10 < 1e9", "inf [0, inf]");
}

/* The fastest of the grids is another one for each kind of rays. */
RT_TEST(a_best_of_stands_for_the_setting_that_is_chosen_for_each_kind_of_rays) {
    static const char ratio[] = "ratio of time of bvh to grid:best on random:n=10";
    static const char both[] = "ratio of time of bvh to grid:best on random:n=10 for all rays > 1.9";
    char claim[RT_MAX_CLAIM];
    rt_results_clear(&results);
    const uint32_t best = e->candidate_count++;
    e->candidates[best] = (RtCandidate){
        .label = "grid:best", .stem = "grid:best", .ray_stride = 1, .members = {1, 2, 3}, .member_count = 3};
    start_results();
    set_all();
    e->baseline = best;
    set(0, 0, 20, 100, 100);
    for (uint32_t c = 0; c < 4; c++) {
        rt_cell_at(&results, 0, c, RT_RAY_PRIMARY)->baseline = 2;
        rt_cell_at(&results, 0, c, RT_RAY_SHADOW)->baseline = 3;
    }
    *rt_cell_at(&results, 0, best, RT_RAY_PRIMARY) = (RtCell){.chosen = true, .choice = 2};
    *rt_cell_at(&results, 0, best, RT_RAY_SHADOW) = (RtCell){.chosen = true, .choice = 3};
    rt_cell_at(&results, 0, 2, RT_RAY_PRIMARY)->seconds = (RtEstimate){40e-9, 40e-9, 40e-9, 40e-9};
    rt_cell_at(&results, 0, 3, RT_RAY_SHADOW)->seconds = (RtEstimate){60e-9, 60e-9, 60e-9, 60e-9};
    rt_cell_at(&results, 0, 0, RT_RAY_PRIMARY)->ratio = (RtEstimate){0.4, 0.39, 0.41, 0.3};
    holds(both, "2.00 (bvh on random:n=10)");
    is_false(strcat(strcpy(claim, ratio), " > 1.9"),
             "1.67 (bvh on random:n=10, shadow rays); holds for primary rays; does not hold for shadow rays");
    shows(strcat(strcpy(claim, ratio), " for primary rays"), "2.50 [2.44, 2.56]");
    shows("time of grid:best on random:n=10 for all rays", "50.0 ns (grid:best on random:n=10)");
    shows("object_tests of grid:best on random:n=10 for all rays", "4.15 (grid:best");
    RtClaim parsed;
    assert_bad_input(rt_claim_parse(e, "bytes of grid:best < 9", &parsed, error),
                     "each with its own bytes: name one");
    assert_bad_input(rt_claim_parse(e, "correlation of bytes and time of grid:best", &parsed, error),
                     "its own bytes");
    e->baseline = 0;
    rt_results_clear(&results);
    e->candidate_count--;
    start_results();
}

RT_TEST(a_claim_that_is_none_is_refused_with_what_would_be_right) {
    const char *const cases[][2] = {
        {"grids are good", "'grids' is not a measure: choose one of time, object_tests"},
        {"grid is good", "found 'good', expected 'fastest'"},
        {"grid is fastest", "'grid' names 3 accelerators: name one of them"},
        {"bvh has least time of grid", "unexpected 'of' at its end"},
        {"bvh has least rays", "rays does not rank accelerators"},
        {"bvh has most steps", "found 'most', expected 'least'"},
        {"rays of bvh for primary rays", "rays is the same for all accelerators: leave 'of bvh' out"},
        {"count of time of bvh", "'count of' is followed by a claim, not by a figure"},
        {"geometric mean of exponent of time of bvh in n", "a geometric mean is of values or of ratios"},
        {"geometric mean time of bvh", "found 'time', expected 'of'"},
        {"geometric mean of time of bvh falls with n", "found 'falls', expected"},
        {"time of bvh as fast", "'fast' is not a format: choose one of times, percent"},
        {"time of bvh as MB", "'as MB' does not fit time"},
        {"steps of bvh as plain ms", "'as ms' does not fit steps"},
        {"time of bvh as us > 5", "unexpected '>' at its end"},
        {"ratio of time of bvh on balls to bvh on random", "the second side of the ratio is 3 cells"},
        {"ratio of time of bvh on balls to bvh", "both sides of the ratio are the same cells"},
        {"ratio of time of bvh at n=10 to bvh at n=11", "'11' is not a value of n"},
        {"ratio of objects on balls to bvh", "'bvh' is not a measure"},
        {"object_test of grid < 5", "did you mean 'object_tests'?"},
        {"object_tests grid < 5", "found 'grid', expected 'of'"},
        {"object_tests of gird < 5", "'gird' is not the label of one of the accelerators: did you mean "
                                     "'grid'? choose one of bvh, grid, grid:d"},
        {"object_tests of grid on ball < 5", "'ball' is not the label of one of the scenes: did you mean "
                                             "'balls'? choose one of random, balls, random:n=10,"},
        {"object_tests of grid = 5", "found '=', expected `falls with`, `rises with` or one of < <= > >="},
        {"object_tests of grid <", "'' is not a number"},
        {"object_tests of grid < five", "'five' is not a number"},
        {"object_tests of grid < 5 always", "unexpected 'always' at its end"},
        {"object_tests of grid falls with size", "'size' is not a swept parameter"},
        {"object_tests of grid falls monotonically", "found 'monotonically', expected 'with'"},
        {"ratio of time of bvh to grid > 5", "'grid' names 3 accelerators: name one of them"},
        {"time of bvh at n=11 > 5",
         "'11' is not a value of n: did you mean '10'? choose one of 10, 100, 1000;"},
        {"time of bvh at m=11 > 5", "'m' is not a swept parameter: choose one of n, density;"},
        {"exponent of time of bvh in m > 5",
         "'m' is not a swept parameter: choose one of objects, n, density;"},
        {"time of bvh at largest objects > 5", "'objects' is not a swept parameter"},
        {"crossover of time of bvh and grid in n", "'grid' names 3 accelerators: name one of them"},
        {"correlation of time of bvh", "found 'of', expected 'and'"},
        {"correlation of time of bvh", "'correlation of predicted_cost and time of bvh > 0.9'"},
        {"crossover of time of bvh", "'crossover of time of octree and grid in n > 1e4'"},
        {"time of bvh sometimes", "'exponent of time of bvh in n < 0.5'"},
        {"ratio of time of bvh to all > 5", "'all' is not the label of one of the accelerators"},
        {"time of bvh at n > 5", "write 'at largest PARAM'"},
        {"time of bvh for random rays > 5", "this experiment has no 'random' rays"},
        {"time of bvh for primary rays for shadow rays > 5", "it names two kinds of rays"},
        {"time of bvh on balls on random > 5", "it names two scenes"},
        {"bytes of bvh for primary rays > 5", "bytes does not depend on the kind of rays"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        RtClaim claim;
        assert_bad_input(rt_claim_parse(e, cases[i][0], &claim, error), cases[i][1]);
    }
    RtClaim claim;
    e->count_only = true;
    assert_int_equal(rt_claim_parse(e, "time of bvh < 5", &claim, NULL), RT_BAD_INPUT);
    e->count_only = false;
}

RT_TEST(few_rays_leave_a_claim_undecided_and_the_verdict_names_their_number) {
    set_all();
    rt_cell_at(&results, 0, 1, RT_RAY_SHADOW)->tally.rays = 999;
    is_undecided("object_tests of grid:density=1 on random:n=10 > 1",
                 "shadow rays), but of 999 rays, and fewer than 1000 decide nothing; holds for primary rays; "
                 "undecided "
                 "for shadow rays");
    is_undecided("ratio of time of bvh to grid:density=1 on random:n=10 for shadow rays < 1",
                 "but of 999 rays");
    holds("object_tests of grid:density=1 on random:n=10 for primary rays > 1", "10.0 (grid");
    holds("object_tests of grid:density=1 on random:n=10 for all rays > 1", "10.0 (grid");
}

RT_TESTS(claims, set_up, tear_down)
