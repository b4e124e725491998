/* SPDX-License-Identifier: Apache-2.0 */
/* Claims, held against results that are made by hand. */
#include "testing.h"

#include "core/base/memory.h"
#include "experiment/claims.h"
#include "experiment/result_tables.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Scenes random:n=10, 100, 1000 and balls; accelerators bvh (the baseline), grid:density=1, 2, 4. */
static RtExperiment *e;
static RtResults results;

static int set_up(void **state) {
    (void)state;
    RtCandidate bvh = {.spec = "bvh", .ray_stride = 1},
                grid = {.spec = "grid:density=1..4*2", .ray_stride = 1};
    RtWorkload scene = {.depth = 1};
    char where[RT_MAX_LABEL];
    e = rt_alloc(1, sizeof *e);
    if (!e) return -1;
    rt_experiment_init(e);
    strcpy(e->name, "claims");
    e->kind_count = 2; /* primary, shadow */
    assert_ok(rt_experiment_add_scenes(e, &scene, "random:n=10..1000*10", "", error));
    assert_ok(rt_experiment_add_scenes(e, &scene, "balls", "", error));
    assert_ok(rt_experiment_add_accels(e, &bvh, error));
    assert_ok(rt_experiment_add_accels(e, &grid, error));
    assert_ok(rt_experiment_check(e, where, error));
    assert_ok(rt_results_init(&results, e, error));
    for (uint32_t t = 0; t < 4; t++) results.workloads[t].rays[0] = results.workloads[t].rays[1] = 10;
    return 0;
}

static int tear_down(void **state) {
    (void)state;
    rt_results_clear(&results);
    rt_free(e);
    return 0;
}

/* Both kinds of rays: `tests` in 10 rays, and nanoseconds from low to high, the median between them. */
static void set(uint32_t t, uint32_t c, uint64_t tests, double low, double high) {
    for (uint32_t k = 0; k < 2; k++) {
        RtCell *cell = rt_cell_at(&results, t, c, (RtRayKind)k);
        RtEstimate ns = {0.5e-9 * (low + high), 1e-9 * low, 1e-9 * high, 1e-9 * low};
        *cell = (RtCell){
            .counted = true, .timed = true, .tally = {.rays = 10, .object_tests = tests}, .seconds = ns};
    }
}

static void set_all(void) {
    for (uint32_t t = 0; t < 4; t++) {
        set(t, 0, 20 + t, 100 * pow(2, t), 104 * pow(2, t));
        for (uint32_t c = 1; c < 4; c++) set(t, c, 100 / c, 200, 210 + 5 * c);
    }
}

static void expect(RtClaimVerdict verdict, const char *claim, const char *figures) {
    RtClaimResult result;
    RtClaim parsed;
    assert_ok(rt_claim_parse(e, claim, &parsed, error));
    strcpy(e->claims[0], claim);
    e->claim_count = 1;
    rt_claim_judge(&results, 0, &result);
    if (result.verdict == verdict && strstr(result.figures, figures)) return;
    fail_msg("%s: %s, %s", claim, rt_claim_verdict_name(result.verdict), result.figures);
}

RT_TEST(a_claim_about_counts_is_exact_and_holds_for_every_cell_or_not_at_all) {
    set_all();
    expect(RT_CLAIM_HOLDS, "object_tests of bvh < 2.31", "2.30 (bvh on balls)");
    expect(RT_CLAIM_FALSE, "object_tests of bvh < 2.3", "2.30 (bvh on balls)");
    expect(RT_CLAIM_HOLDS, "object_tests of bvh <= 2.3", "");
    expect(RT_CLAIM_HOLDS, "object_tests of bvh on random < 2.3", "2.20 (bvh on random:n=100");
    expect(RT_CLAIM_FALSE, "object_tests of grid for shadow rays > 5", "3.30 (grid:density=4");
    expect(RT_CLAIM_HOLDS, "object_tests of grid at density=1 > 9", "10");
    expect(RT_CLAIM_HOLDS, "object_tests of grid at smallest density >= 10", "10");
    expect(RT_CLAIM_HOLDS, "ratio of object_tests of grid:density=1 to bvh at smallest n >= 5", "5.00");
}

RT_TEST(a_claim_about_times_is_undecided_where_an_interval_straddles) {
    set_all();
    expect(RT_CLAIM_HOLDS, "time of bvh on random:n=10 < 105", "102 [100, 104]");
    expect(RT_CLAIM_UNDECIDED, "time of bvh on random:n=10 < 103", "102 [100, 104]");
    expect(RT_CLAIM_FALSE, "time of bvh on random:n=10 < 100", "102 [100, 104]");
    expect(RT_CLAIM_UNDECIDED, "time of bvh on random:n=10 >= 103", "");
    expect(RT_CLAIM_FALSE, "time of bvh < 103", "on balls");
}

/* 100 / 215 to 104 / 200. Paired on one kind, it is what the rounds gave. */
RT_TEST(a_ratio_of_times_is_of_ends_or_paired) {
    set_all();
    expect(RT_CLAIM_HOLDS, "ratio of time of bvh to grid:density=1 on random:n=10 > 0.46",
           "0.492 [0.465, 0.520]");
    expect(RT_CLAIM_UNDECIDED, "ratio of time of bvh to grid:density=1 on random:n=10 > 0.49", "");
    rt_cell_at(&results, 0, 1, RT_RAY_PRIMARY)->ratio = (RtEstimate){0.5, 0.49, 0.51, 0.4};
    expect(RT_CLAIM_HOLDS, "ratio of time of bvh to grid:density=1 on random:n=10 for primary rays > 0.485",
           "0.500 [0.490, 0.510]");
    expect(RT_CLAIM_HOLDS, "ratio of time of grid:density=1 to bvh on random:n=10 for primary rays > 1.95",
           "2.00 [1.96, 2.04]");
}

/* Time doubles with each tenfold n: log 2 / log 10 = 0.30103; the interval is log 1.04 / log 100 to a side.
 */
RT_TEST(an_exponent_has_the_interval_that_the_times_leave_it) {
    set_all();
    expect(RT_CLAIM_HOLDS, "exponent of time of bvh in n < 0.32", "0.301 [0.293, 0.310] (bvh on random)");
    expect(RT_CLAIM_UNDECIDED, "exponent of time of bvh in n < 0.305", "");
    expect(RT_CLAIM_FALSE, "exponent of time of bvh in n < 0.29", "");
    expect(RT_CLAIM_HOLDS, "exponent of object_tests of grid in density < -0.7", "-0.");
}

RT_TEST(a_trend_is_from_each_value_to_the_next) {
    set_all();
    expect(RT_CLAIM_HOLDS, "object_tests of grid falls with density", "10.0 at density=1, 3.30 at density=4");
    expect(RT_CLAIM_FALSE, "object_tests of grid rises with density", "10.0 at density=1, 5.00 at density=2");
    expect(RT_CLAIM_HOLDS, "object_tests of bvh rises with n", "2.00 at n=10, 2.20 at n=1000");
    expect(RT_CLAIM_FALSE, "object_tests of grid falls with n", "");
    expect(RT_CLAIM_HOLDS, "object_tests of grid never falls with n", "");
    expect(RT_CLAIM_HOLDS, "time of bvh rises with n", "102 [100, 104] at n=10, 408 [400, 416] at n=1000");
    expect(RT_CLAIM_UNDECIDED, "time of grid falls with density", "");
    set(1, 2, 100, 200, 210);
    expect(RT_CLAIM_FALSE, "object_tests of grid falls with density", "10.0 at density=1, 10.0 at density=2");
    expect(RT_CLAIM_HOLDS, "object_tests of grid never rises with density", "");
}

RT_TEST(what_was_not_measured_decides_nothing) {
    set_all();
    *rt_cell_at(&results, 0, 0, RT_RAY_PRIMARY) = *rt_cell_at(&results, 0, 0, RT_RAY_SHADOW) = (RtCell){0};
    expect(RT_CLAIM_UNMEASURED, "object_tests of bvh on random:n=10 < 5", "nothing that this claim is about");
    expect(RT_CLAIM_UNMEASURED, "ratio of time of grid:density=1 to bvh on random:n=10 > 9", "");
    expect(RT_CLAIM_UNDECIDED, "object_tests of bvh < 5", "1 of 4 values are unknown");
    expect(RT_CLAIM_FALSE, "object_tests of bvh > 5", "1 of 4 values are unknown");
}

RT_TEST(a_claim_about_build_times_is_undecided_within_their_interval) {
    *rt_build_at(&results, 0, 0) = (RtBuildResult){.known = true, .builds = 6, .seconds = {3, 2, 5, 2}};
    expect(RT_CLAIM_HOLDS, "build_time of bvh on random:n=10 < 5.5", "3.00 [2.00, 5.00]");
    expect(RT_CLAIM_UNDECIDED, "build_time of bvh on random:n=10 < 4", "3.00 [2.00, 5.00]");
    expect(RT_CLAIM_FALSE, "build_time of bvh on random:n=10 < 1", "3.00 [2.00, 5.00]");
}

/* grid:density=1 needs 2 tests a ray of the one kind and 50 of the other, bvh 5 and 5. Without the dear kind
 * grid would seem to be ahead. */
RT_TEST(a_kind_of_rays_that_one_side_lacks_leaves_a_claim_about_all_kinds_undecided) {
    static const char ahead[] = "ratio of object_tests of grid:density=1 to bvh on random:n=10 < 1",
                      faster[] = "ratio of time of grid:density=1 to bvh on random:n=10 < 1";
    set(0, 0, 50, 100, 100);
    set(0, 1, 20, 50, 50);
    RtCell *dear = rt_cell_at(&results, 0, 1, RT_RAY_SHADOW), cell = *dear;
    cell.tally.object_tests = 500;
    cell.seconds = (RtEstimate){1e-6, 1e-6, 1e-6, 1e-6};
    *dear = cell;
    expect(RT_CLAIM_FALSE, ahead, "5.20");
    expect(RT_CLAIM_FALSE, faster, "5.25");
    assert_int_equal(rt_standing(&results, 0, 0, RT_RAY_KIND_COUNT), RT_STANDING_BEST);
    *dear = (RtCell){.left_out = "it would take about 3 s, more than 1 s"};
    expect(RT_CLAIM_UNDECIDED, ahead, "no measurements of all kinds");
    expect(RT_CLAIM_UNDECIDED, faster, "no measurements of all kinds");
    expect(RT_CLAIM_HOLDS,
           "ratio of object_tests of grid:density=1 to bvh on random:n=10 for primary rays < 1", "0.40");
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
    expect(RT_CLAIM_UNDECIDED, "object_tests of bvh on random:n=10 < 5", "no measurements of all kinds");
}

/* Over 10 and 100 alone time would grow as n^0.301, over 10 and 1000 as n^1. */
RT_TEST(an_exponent_is_undecided_until_all_values_of_its_line_are_known) {
    set_all();
    set(2, 0, 20, 10000, 10000);
    expect(RT_CLAIM_FALSE, "exponent of time of bvh in n < 0.5", "0.996 [0.991, 1.00]");
    rt_cell_at(&results, 2, 0, RT_RAY_PRIMARY)->timed = false;
    expect(RT_CLAIM_UNDECIDED, "exponent of time of bvh in n < 0.5", "1 of 3 values are unknown");
    expect(RT_CLAIM_UNDECIDED, "exponent of time of bvh in n > 0.5", "1 of 3 values are unknown");
    rt_cell_at(&results, 1, 1, RT_RAY_PRIMARY)->counted = false;
    expect(RT_CLAIM_UNDECIDED, "exponent of object_tests of grid in density < 0", "1 of 12 values");
    expect(RT_CLAIM_FALSE, "exponent of object_tests of grid in density > 0", "1 of 12 values");
    expect(RT_CLAIM_FALSE, "object_tests of grid rises with density on random:n=100",
           "1 of 3 values are unknown");
}

RT_TEST(a_claim_that_is_none_is_refused_with_what_would_be_right) {
    const char *const cases[][2] = {
        {"grid is good", "'grid' is not a measure: choose one of time, object_tests"},
        {"object_test of grid < 5", "did you mean 'object_tests'?"},
        {"object_tests grid < 5", "found 'grid', expected 'of'"},
        {"object_tests of gird < 5", "'gird' is not the label of one of the accelerators"},
        {"object_tests of grid on ball < 5", "'ball' is not the label of one of the scenes"},
        {"object_tests of grid = 5", "found '=', expected one of < <= > >="},
        {"object_tests of grid <", "'' is not a number"},
        {"object_tests of grid < five", "'five' is not a number"},
        {"object_tests of grid < 5 always", "unexpected 'always' at its end"},
        {"object_tests of grid falls with size", "'size' is not a swept parameter"},
        {"object_tests of grid falls monotonically", "found 'monotonically', expected 'with'"},
        {"ratio of time of bvh to grid > 5", "'grid' names 3 accelerators: name one of them"},
        {"time of bvh at n=11 > 5", "'11' is not a value of 'n'"},
        {"time of bvh at n > 5", "write 'at largest PARAM'"},
        {"time of bvh for random rays > 5", "this experiment has no 'random' rays"},
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

RT_TESTS(claims, set_up, tear_down)
