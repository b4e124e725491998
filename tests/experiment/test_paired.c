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

/* On ten of its thousand rays bvh takes three times as long as on all: the frame's are those that count. */
RT_TEST(a_thinned_set_stands_for_its_kind_as_it_was_measured) {
    const double base[ROUNDS] = {1, 1, 1, 1, 1, 1, 1}, few[ROUNDS] = {3, 3, 3, 3, 3, 3, 3},
                 slow[ROUNDS] = {60, 60, 60, 60, 60, 60, 60};
    set_rounds(0, RT_RAY_PRIMARY, base, NULL);
    set_rounds(0, RT_RAY_SHADOW, base, NULL);
    set_rounds(1, RT_RAY_PRIMARY, slow, few);
    set_rounds(1, RT_RAY_SHADOW, slow, base);
    rt_cell_at(&results, 0, 1, RT_RAY_PRIMARY)->tally.rays = 10;
    assert_float_equal(rt_results_time_ratio(&results, 0, 1, 0, RT_ALL_RAYS, 0.95).median, 60, 1e-9);
    assert_float_equal(rt_results_time_ratio(&results, 0, 1, 0, RT_RAY_PRIMARY, 0.95).median, 20, 1e-9);
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

/* ---- what tables find (tests/differences.sh measures the same) ---- */

enum { COPIES = 20, SCENES = 5, SEEDS = 40, MANY = 60 };

/* The time of a structure in a round: noise of up to 5 %, one time in ten three times as much, and slower. */
static double draw_ns(RtRandom *random) {
    const double noise = rt_random_betweend(random, 0, 0.05);
    return 100 * (1 + (rt_random_below(random, 10) == 0 ? 3 * noise : noise));
}

/* Gives candidates 0 (the baseline) and 1 times, `factor` times as long for the second. */
static RtEstimate draw_ratio(RtRandom *random, uint32_t rounds, double factor) {
    double drift = 1;
    for (uint32_t c = 0; c < 2; c++) {
        RtCell *cell = rt_cell_at(&results, 0, c, RT_RAY_PRIMARY);
        rt_free(cell->round_times);
        *cell = (RtCell){.counted = true, .timed = true, .rounds = rounds, .tally = {.rays = 1000}};
        assert_ok(rt_cell_make_round_times(cell, error));
    }
    RtCell *base = rt_cell_at(&results, 0, 0, RT_RAY_PRIMARY),
           *other = rt_cell_at(&results, 0, 1, RT_RAY_PRIMARY);
    for (uint32_t r = 0; r < rounds; r++) {
        drift *= rt_random_betweend(random, 0.97, 1.05); /* of the machine */
        const double ns = 1e-9 * drift * draw_ns(random);
        rt_cell_round_times(base, RT_ROUND_SECONDS)[r] = rt_cell_round_times(base, RT_ROUND_BASELINE)[r] = ns;
        rt_cell_round_times(other, RT_ROUND_BASELINE)[r] = ns;
        rt_cell_round_times(other, RT_ROUND_SECONDS)[r] = 1e-9 * factor * drift * draw_ns(random);
    }
    return rt_results_time_ratio(&results, 0, 1, 0, RT_RAY_PRIMARY, 0.95);
}

/* Twenty copies are ten pairs, whose draws are independent: the false differences are binomial. Neither so
 * many nor so few may have a chance below 1 %: intervals that are too wide are wrong, too. */
RT_TEST(copies_of_one_structure_differ_as_often_as_the_coverage_of_the_interval_says) {
    const uint32_t pairs = COPIES / 2 * SCENES * SEEDS, rounds[] = {6, 10, 30};
    for (int i = 0; i < 3; i++) {
        const double stated = 1 - rt_interval_coverage(rounds[i]);
        uint32_t differ = 0;
        for (uint64_t pair = 0; pair < pairs; pair++) {
            RtRandom random = rt_random(17, pair);
            const RtEstimate ratio = draw_ratio(&random, rounds[i], 1);
            differ += !rt_estimate_holds(&ratio, 1);
        }
        if (rt_binomial_tail(differ, pairs, stated) < 0.01 ||
            1 - rt_binomial_tail(differ + 1, pairs, stated) < 0.01)
            fail_msg("%u of %u pairs differ with %u rounds; %.4f are stated", differ, pairs, rounds[i],
                     stated);
    }
}

/* As a structure is that traces every 33rd ray twice. */
RT_TEST(three_percent_are_found_with_sixty_rounds_in_nine_of_ten_cells_and_never_as_faster) {
    uint32_t found = 0, wrong = 0, few = 0;
    for (uint64_t seed = 0; seed < 1000; seed++) {
        RtRandom random = rt_random(18, seed);
        const RtEstimate many = draw_ratio(&random, MANY, 1 + 1 / 33.0);
        found += many.low > 1;
        wrong += many.high < 1;
        few += draw_ratio(&random, 10, 1 + 1 / 33.0).low > 1;
    }
    if (found < 900 || wrong > 0 || few > 700)
        fail_msg("found in %u of 1000, %u of them with 10 rounds; wrong: %u", found, few, wrong);
}

RT_TESTS(paired, set_up, tear_down)
