/* SPDX-License-Identifier: Apache-2.0 */
/* measure/statistics.h: the median, its interval, and ratios paired within a round. */
#include "testing.h"

#include "measure/statistics.h"

#include "core/base/random.h"

RT_TEST(the_median_is_the_middle_one_or_the_mean_of_the_middle_two) {
    const double odd[] = {9, 1, 5}, even[] = {4, 100, 1, 2}, one[] = {7};
    assert_true(rt_median(odd, 3) == 5);
    assert_true(rt_median(even, 4) == 3);
    assert_true(rt_median(one, 1) == 7);
    assert_true(odd[0] == 9);                                             /* and its input stays as it was */
    const RtEstimate e = rt_estimate((const double[]){3, 3, 3, 3, 3}, 5); /* an interval of no width */
    assert_true(e.median == 3 && e.low == 3 && e.high == 3 && e.least == 3);
}

/* 1..count in a mixed order; 1009 is a prime above RT_MAX_ROUNDS. */
static void mix(double *values, uint32_t count) {
    for (uint32_t i = 0, next = 0; next < count; i++) {
        uint32_t value = i * 37 % 1009;
        if (value >= 1 && value <= count) values[next++] = value;
    }
}

/* Ranks as in the tables of the binomial distribution with p = 1/2. */
RT_TEST(the_interval_lies_at_the_ranks_that_the_binomial_distribution_says) {
    const struct {
        uint32_t count, low;
        double coverage;
    } cases[] = {{1, 1, 0},          {2, 1, 0.5},         {3, 1, 0.75},         {5, 1, 0.9375},
                 {6, 1, 0.96875},    {8, 1, 0.9921875},   {9, 2, 0.9609375},    {10, 2, 0.978515625},
                 {11, 2, 0.988281},  {12, 3, 0.961426},   {20, 6, 0.958611},    {30, 10, 0.957226},
                 {50, 18, 0.967161}, {100, 40, 0.964800}, {1000, 469, 0.953709}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        double values[RT_MAX_ROUNDS];
        uint32_t count = cases[i].count;
        mix(values, count);
        RtEstimate e = rt_estimate(values, count);
        assert_true(e.least == 1 && e.median == 0.5 * (count + 1));
        assert_true(e.low == cases[i].low && e.high == count + 1 - cases[i].low);
        assert_true(fabs(rt_interval_coverage(count) - cases[i].coverage) < 1e-6);
    }
}

RT_TEST(from_six_rounds_on_an_interval_covers_95_percent) {
    for (uint32_t count = 1; count <= RT_MAX_ROUNDS; count++) {
        double coverage = rt_interval_coverage(count);
        assert_true(coverage < 1 && (coverage >= 0.95) == (count >= RT_FULL_ROUNDS));
    }
}

/* Times have a long tail: 1 / (1 - u) for u uniform, with median 2. 4000 workloads have a standard error of
 * at most 0.8 %. */
RT_TEST(intervals_hold_the_true_median_as_often_as_they_say) {
    const uint32_t counts[] = {1, 3, 5, 6, 7, 10, 11, 30};
    for (size_t c = 0; c < sizeof counts / sizeof counts[0]; c++) {
        int inside = 0;
        for (uint64_t workload = 0; workload < 4000; workload++) {
            RtRandom random = rt_random(11, workload);
            double values[30];
            for (uint32_t i = 0; i < counts[c]; i++) values[i] = 1 / (1 - (double)rt_random_unit(&random));
            RtEstimate e = rt_estimate(values, counts[c]);
            inside += e.low <= 2 && 2 <= e.high;
        }
        assert_true(fabs(inside / 4000.0 - rt_interval_coverage(counts[c])) < 0.016);
    }
}

/* A factor round 1 with as much weight above as below: the noise of a round, or where a structure lies. */
static double draw_factor(RtRandom *random, double spread) {
    double sum = 0;
    for (int i = 0; i < 3; i++) sum += rt_random_betweend(random, -spread, spread);
    return rt_random_below(random, 10) == 0 ? 1 / (1 - fmin(3 * sum, 0.9)) : 1 / (1 - sum);
}

/* How many of 4000 comparisons of two structures that are alike have an interval without 1. `builds`: after
 * so many rounds each is built anew, and is a few percent faster or slower for where it lies then. */
static double missing_share(uint32_t rounds, uint32_t builds, double coverage) {
    enum { RUNS = 4000 };
    uint32_t missing = 0;
    for (uint64_t run = 0; run < RUNS; run++) {
        RtRandom random = rt_random(5, run);
        double ratios[30], place = 1;
        for (uint32_t r = 0; r < rounds; r++) {
            if (r % builds == 0) place = draw_factor(&random, 0.05) / draw_factor(&random, 0.05);
            ratios[r] = place * draw_factor(&random, 0.05) / draw_factor(&random, 0.05);
        }
        const RtEstimate e = rt_estimate_covering(ratios, rounds, coverage);
        missing += !rt_estimate_holds(&e, 1);
    }
    return (double)missing / RUNS;
}

/* With one structure each for all rounds the intervals describe that pair, and not the kinds of structure. */
RT_TEST(intervals_of_equal_structures_miss_1_as_often_as_they_may_if_each_round_has_its_own) {
    assert_true(fabs(missing_share(10, 1, 0.95) - (1 - rt_interval_coverage(10))) < 0.008);
    assert_true(fabs(missing_share(7, 1, 0.95) - (1 - rt_interval_coverage(7))) < 0.008);
    assert_true(missing_share(10, 10, 0.95) > 0.15);
}

/* Where the smallest to the largest cover less than is asked for. */
RT_TEST(an_interval_of_few_measurements_covers_what_is_asked_for) {
    const uint32_t rounds[] = {2, 3, 5, 10};
    for (int i = 0; i < 4; i++) {
        for (double missing = 0.05; missing > 0.0004; missing /= 10)
            assert_true(missing_share(rounds[i], 1, 1 - missing) <= missing + 3 * sqrt(missing / 4000));
    }
    const double one = 3, seven[] = {1, 2, 3, 4, 5, 6, 7};
    const RtEstimate any = rt_estimate_covering(&one, 1, 0.95), usual = rt_estimate_covering(seven, 7, 0.95);
    assert_true(any.median == 3 && any.low == 0 && isinf(any.high));
    assert_true(usual.low == 1 && usual.high == 7 && usual.median == 4);
}

RT_TEST(the_chance_of_so_many_events_or_more_is_the_binomial_tail) {
    assert_true(rt_binomial_tail(0, 9, 0.3) == 1);
    assert_true(rt_binomial_tail(3, 9, 1) == 1);
    assert_true(rt_binomial_tail(1, 9, 0) == 0);
    assert_true(fabs(rt_binomial_tail(1, 2, 0.25) - 7.0 / 16) < 1e-15);
    assert_true(fabs(rt_binomial_tail(2, 3, 0.5) - 0.5) < 1e-15);
    assert_true(fabs(rt_binomial_tail(3, 3, 0.1) - 1e-3) < 1e-15);
}

/* Both slow down together from round to round; only pairing shows that one is always twice the other. */
RT_TEST(ratios_are_paired_within_a_round) {
    double over[20], under[20];
    for (int i = 0; i < 20; i++) {
        under[i] = 1 + 10 * i;
        over[i] = 2 * under[i];
    }
    RtEstimate e = rt_estimate_ratio(over, under, 20);
    assert_true(e.median == 2 && e.low == 2 && e.high == 2);
    under[3] = 0;
    assert_true(isnan(rt_estimate_ratio(over, under, 20).median));
}

/* Critical values of Mann and Whitney's U for two samples of 10, of 5, of 4 at 5 %: 23, 2, 0 (so the ends are
 * the 24th, third and first of the ratios), and none for two of 3. At 1 % for two of 10: 16. */
RT_TEST(unpaired_intervals_lie_at_the_ranks_that_the_tables_of_mann_and_whitney_say) {
    const struct {
        uint32_t count;
        double coverage;
        uint32_t low;
    } cases[] = {{10, 0.95, 24}, {5, 0.95, 3}, {4, 0.95, 1}, {3, 0.95, 1}, {10, 0.99, 17}, {40, 0.95, 596}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        double over[40], under[40], ratios[1600];
        uint32_t n = cases[i].count, below = 0;
        RtEstimate e;
        for (uint32_t k = 0; k < n; k++) { /* all ratios differ */
            over[k] = 1 + 0.013 * k + 1e-5 * k * k;
            under[k] = 1 + 0.0007 * k + 1e-7 * k * k;
        }
        for (uint32_t k = 0; k < n * n; k++) ratios[k] = over[k / n] / under[k % n];
        assert_ok(rt_estimate_unpaired(over, n, under, n, cases[i].coverage, &e, error));
        for (uint32_t k = 0; k < n * n; k++) below += ratios[k] <= e.low;
        assert_int_equal(below, cases[i].low);
        below = 0;
        for (uint32_t k = 0; k < n * n; k++) below += ratios[k] >= e.high;
        assert_int_equal(below, cases[i].low);
        assert_true(e.low <= e.median && e.median <= e.high);
    }
}

/* Times of a common median 1, after a change by a fifth: 2000 workloads, exactly and nearly. */
RT_TEST(unpaired_intervals_hold_the_true_ratio_as_often_as_they_say) {
    const uint32_t counts[][2] = {{10, 10}, {6, 17}, {40, 35}};
    for (size_t c = 0; c < 3; c++) {
        int inside = 0;
        for (uint64_t workload = 0; workload < 2000; workload++) {
            RtRandom random = rt_random(12, workload);
            double over[40], under[40];
            RtEstimate e;
            for (uint32_t i = 0; i < counts[c][0]; i++)
                over[i] = 1.2 / (1 - 0.5 * (double)rt_random_unit(&random));
            for (uint32_t i = 0; i < counts[c][1]; i++)
                under[i] = 1 / (1 - 0.5 * (double)rt_random_unit(&random));
            assert_ok(rt_estimate_unpaired(over, counts[c][0], under, counts[c][1], 0.95, &e, error));
            inside += rt_estimate_holds(&e, 1.2);
        }
        assert_true(inside >= 1880 && inside <= 1950);
    }
}

/* 2 / C(12, 6) is 0.22 %; 168 cells take 1 - 0.05 / 168. */
RT_TEST(so_many_cells_ask_for_so_many_rounds_and_unpaired_ones_cover_at_most_so_much) {
    assert_true(rt_coverage_of_each(0) == 0.95 && rt_coverage_of_each(1) == 0.95);
    assert_true(fabs(rt_coverage_of_each(10) - 0.995) < 1e-12);
    assert_int_equal(rt_rounds_for(0.95), 9);
    assert_int_equal(rt_rounds_for(rt_coverage_of_each(10)), 13);
    assert_int_equal(rt_rounds_for(rt_coverage_of_each(100)), 17);
    assert_true(fabs(rt_unpaired_coverage(6, 6) - (1 - 2 / 924.0)) < 1e-12);
    assert_true(fabs(rt_unpaired_coverage(2, 3) - 0.8) < 1e-12);
    assert_true(rt_unpaired_coverage(1, 1) == 0);
    assert_int_equal(rt_unpaired_rounds(0.95), 4);
    assert_int_equal(rt_unpaired_rounds(rt_coverage_of_each(168)), 8);
}

/* Two-sided critical values of Student's t: 5 % of 1, 2 and 9 degrees of freedom, 1 % of 29, 0.1 % of 999. */
RT_TEST(intervals_of_means_are_as_wide_as_the_tables_of_student_say) {
    const struct {
        uint32_t count;
        double coverage, t;
    } cases[] = {{2, 0.95, 12.7062},
                 {3, 0.95, 4.30265},
                 {10, 0.95, 2.26216},
                 {30, 0.99, 2.75639},
                 {1000, 0.999, 3.30031}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        double ratios[1000], squares = 0;
        const uint32_t n = cases[i].count;
        for (uint32_t k = 0; k < n; k++) { /* logarithms whose mean is 0.1 */
            const double deviation = 1e-3 * (2.0 * k - (n - 1.0)) / n;
            ratios[k] = exp(0.1 + deviation);
            squares += deviation * deviation;
        }
        const RtEstimate e = rt_estimate_student(ratios, n, cases[i].coverage);
        const double half = cases[i].t * sqrt(squares / (n - 1) / n);
        assert_true(fabs(log(e.median) - 0.1) < 1e-12);
        const double above = log(e.high) - 0.1, below = 0.1 - log(e.low);
        if (fabs(above - half) > 1e-5 * half || fabs(below - half) > 1e-5 * half)
            fail_msg("%u: %g %g in place of %g", n, above, below, half);
        assert_true(e.least == ratios[0]);
    }
}

RT_TESTS(statistics, NULL, NULL)
