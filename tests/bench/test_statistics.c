/* SPDX-License-Identifier: Apache-2.0 */
/* experiments/statistics: the median, its interval, and ratios paired within a round. */
#include "testing.h"

#include "bench/statistics.h"

#include "base/random.h"

RT_TEST(the_median_is_the_middle_one_or_the_mean_of_the_middle_two) {
    const double odd[] = {9, 1, 5}, even[] = {4, 100, 1, 2}, one[] = {7};
    assert_true(rt_median(odd, 3) == 5);
    assert_true(rt_median(even, 4) == 3);
    assert_true(rt_median(one, 1) == 7);
    assert_true(odd[0] == 9); /* and its input stays as it was */
}

RT_TEST(equal_measurements_have_an_interval_of_no_width) {
    const double same[] = {3, 3, 3, 3, 3};
    RtEstimate e = rt_estimate(same, 5);
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

/* Both slow down together from round to round; only pairing shows that one is always twice the other. */
RT_TEST(ratios_are_paired_within_a_round) {
    double over[20], under[20];
    for (int i = 0; i < 20; i++) {
        under[i] = 1 + 10 * i;
        over[i] = 2 * under[i];
    }
    RtEstimate e = rt_estimate_ratio(over, under, 20);
    assert_true(e.median == 2 && e.low == 2 && e.high == 2);
}

RT_TESTS(statistics, NULL, NULL)
