/* SPDX-License-Identifier: Apache-2.0 */
/* Times paired by round: over one kind of rays and over all, and what is the best. */
#include "claims_testing.h"
#include "results/results.h"

enum { ROUNDS = 7 };

/* The times of a cell in each round, and those of its baseline, bvh, in nanoseconds; bvh's own if NULL. */
static void set_rounds(uint32_t c, RtRayKind kind, const double ns[ROUNDS], const double *baseline) {
    RtCell *cell = rt_cell_at(&results, 0, c, kind);
    double ratios[ROUNDS];
    rt_free(cell->round_times); /* of an earlier test */
    *cell = (RtCell){.counted = true, .timed = true, .rounds = ROUNDS, .tally = {.rays = 1000}};
    assert_ok(rt_cell_make_round_times(cell, error));
    for (uint32_t r = 0; r < ROUNDS; r++) {
        rt_cell_round_times(cell, RT_ROUND_SECONDS)[r] = 1e-9 * ns[r];
        rt_cell_round_times(cell, RT_ROUND_BASELINE)[r] = 1e-9 * (baseline ? baseline : ns)[r];
        ratios[r] = (baseline ? baseline : ns)[r] / ns[r];
    }
    cell->seconds = rt_estimate(rt_cell_round_times(cell, RT_ROUND_SECONDS), ROUNDS);
    cell->ratio = rt_estimate(ratios, ROUNDS);
}

static const double drifting[ROUNDS] = {100, 120, 140, 160, 180, 200, 220};

static void set_times(uint32_t c, RtRayKind kind, double factor) {
    double ns[ROUNDS];
    for (uint32_t r = 0; r < ROUNDS; r++) ns[r] = factor * drifting[r];
    set_rounds(c, kind, ns, drifting);
}

/* A machine that slows down makes all intervals wide and no ratio uncertain. */
RT_TEST(what_is_slower_in_every_round_is_behind_however_wide_the_intervals_are) {
    set_rounds(0, RT_RAY_PRIMARY, drifting, NULL);
    set_times(1, RT_RAY_PRIMARY, 1.1);
    const double level[ROUNDS] = {101, 119, 141, 159, 181, 199, 221};
    set_rounds(2, RT_RAY_PRIMARY, level, drifting);
    assert_true(rt_cell_at(&results, 0, 1, RT_RAY_PRIMARY)->seconds.low <
                rt_cell_at(&results, 0, 0, RT_RAY_PRIMARY)->seconds.high);
    assert_int_equal(rt_standing(&results, 0, 0, RT_RAY_PRIMARY), RT_STANDING_BEST);
    assert_int_equal(rt_standing(&results, 0, 1, RT_RAY_PRIMARY), RT_STANDING_BEHIND);
    assert_int_equal(rt_standing(&results, 0, 2, RT_RAY_PRIMARY), RT_STANDING_LEVEL);
    assert_int_equal(rt_standing(&results, 0, 3, RT_RAY_PRIMARY), RT_STANDING_BEHIND); /* not timed */
    holds("ratio of time of grid:density=1 to grid:density=2 on random:n=10 for primary rays > 1.08",
          "1.10 [");
}

/* One kind is fast in the rounds in which the other is slow: their sum is the same in all. */
RT_TEST(all_rays_are_summed_within_a_round_and_weighted_by_their_sets) {
    const double one[ROUNDS] = {1, 3, 1, 3, 1, 3, 1}, two[ROUNDS] = {3, 1, 3, 1, 3, 1, 3},
                 base[ROUNDS] = {1, 1, 1, 1, 1, 1, 1};
    set_rounds(0, RT_RAY_PRIMARY, base, NULL);
    set_rounds(0, RT_RAY_SHADOW, base, NULL);
    set_rounds(1, RT_RAY_PRIMARY, one, base);
    set_rounds(1, RT_RAY_SHADOW, two, base);
    RtEstimate ratio = rt_results_time_ratio(&results, 0, 1, 0, RT_ALL_RAYS, 0.95);
    assert_true(fabs(ratio.low - 2) < 1e-9 && fabs(ratio.high - 2) < 1e-9);
    holds("ratio of time of grid:density=1 to bvh on random:n=10 for all rays > 1.99", "2.00");
    is_undecided("ratio of time of grid:density=1 to bvh on random:n=10 > 1.99", "rays");
    results.workloads[0].rays[RT_RAY_SHADOW] = 0;
    ratio = rt_results_time_ratio(&results, 0, 1, 0, RT_ALL_RAYS, 0.95);
    assert_true(ratio.low == 1 && ratio.high == 3);
    results.workloads[0].rays[RT_RAY_SHADOW] = 1000;
}

/* grid:density=1 and 2 were timed in different rounds, in which bvh took once and twice as long. */
RT_TEST(times_of_other_rounds_are_divided_by_the_baseline_of_their_own) {
    double slow[ROUNDS], slower[ROUNDS];
    for (uint32_t r = 0; r < ROUNDS; r++) {
        slow[r] = 2 * drifting[r];
        slower[r] = 3 * drifting[r];
    }
    set_times(1, RT_RAY_PRIMARY, 1.5);
    set_rounds(2, RT_RAY_PRIMARY, slower, slow);
    const RtEstimate ratio = rt_results_time_ratio(&results, 0, 2, 1, RT_RAY_PRIMARY, 0.95);
    assert_true(fabs(ratio.median - 1) < 1e-9 && fabs(ratio.low - 1) < 1e-9 && fabs(ratio.high - 1) < 1e-9);
}

/* By the interval of 95 % grid:density=1 is slower. */
RT_TEST(with_many_intervals_each_covers_more) {
    const double ns[ROUNDS] = {101, 122, 143, 164, 181, 201, 226};
    char list[2048];
    uint32_t count;
    set_rounds(0, RT_RAY_PRIMARY, drifting, NULL);
    set_rounds(1, RT_RAY_PRIMARY, ns, drifting);
    holds("ratio of time of grid:density=1 to bvh on random:n=10 for primary rays > 1", "");
    assert_true(rt_claims_coverage(&results, &count) == 0.95);
    assert_int_equal(count, 1);
    for (uint32_t i = 1; i < 20; i++)
        strcpy(e->claims[i], "time of all for primary rays > 0"); /* of 4 accelerators on 4 scenes each */
    e->claim_count = 20;
    assert_true(rt_claims_coverage(&results, &count) > 0.9998);
    assert_int_equal(count, 1 + 19 * 16);
    RtClaimResult result;
    rt_claim_judge(&results, 0, &result);
    assert_int_equal(result.verdict, RT_CLAIM_UNDECIDED);
    FILE *out = fmemopen(list, sizeof list, "w");
    e->claim_count = 2;
    rt_claims_print(&results, out);
    fclose(out);
    assert_non_null(
        strstr(list, "The 17 intervals of tracing times in these claims hold together with 95 % confidence"));
}

RT_TESTS(paired, set_up, tear_down)
