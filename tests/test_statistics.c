/* experiments/statistics: the median, its bootstrap interval, and ratios paired within a round. */
#include "testing.h"

#include "experiments/statistics.h"

#include "base/random.h"

static void the_median_is_the_middle_one_or_the_mean_of_the_middle_two(void **state) {
    (void)state;
    const double odd[] = {9, 1, 5}, even[] = {4, 100, 1, 2}, one[] = {7};
    assert_true(rt_median(odd, 3) == 5);
    assert_true(rt_median(even, 4) == 3);
    assert_true(rt_median(one, 1) == 7);
    assert_true(odd[0] == 9); /* and its input stays as it was */
}

static void equal_measurements_have_an_interval_of_no_width(void **state) {
    (void)state;
    const double same[] = {3, 3, 3, 3, 3};
    RtEstimate e = rt_estimate(same, 5, 1);
    assert_true(e.median == 3 && e.low == 3 && e.high == 3 && e.least == 3);
}

static void the_interval_is_the_same_for_the_same_seed_and_contains_the_median(void **state) {
    (void)state;
    double values[50];
    for (int i = 0; i < 50; i++) values[i] = (i * 37) % 50;
    RtEstimate a = rt_estimate(values, 50, 7), b = rt_estimate(values, 50, 7);
    assert_memory_equal(&a, &b, sizeof a);
    assert_true(a.low <= a.median && a.median <= a.high && a.low < a.high);
    assert_true(a.least == 0);
}

/* The ranks of the exact 95 % interval of the median of 50 values are 18 and 33 (binomial with p = 1/2). */
static void the_interval_agrees_with_the_binomial_one(void **state) {
    (void)state;
    double values[50];
    for (int i = 0; i < 50; i++) values[i] = (i * 37) % 50 + 1;
    RtEstimate e = rt_estimate(values, 50, 3);
    assert_true(e.low >= 17 && e.low <= 20);
    assert_true(e.high >= 31 && e.high <= 34);
}

static void about_95_in_100_intervals_hold_the_true_median(void **state) {
    (void)state;
    int inside = 0;
    for (uint64_t trial = 0; trial < 400; trial++) {
        RtRandom random = rt_random(11, trial);
        double values[30];
        for (int i = 0; i < 30; i++) values[i] = (double)rt_random_unit(&random);
        RtEstimate e = rt_estimate(values, 30, trial);
        inside += e.low <= 0.5 && 0.5 <= e.high;
    }
    assert_in_range(inside, 368, 396);
}

/* Both slow down together from round to round; only pairing shows that one is always twice the other. */
static void ratios_are_paired_within_a_round(void **state) {
    (void)state;
    double over[20], under[20];
    for (int i = 0; i < 20; i++) {
        under[i] = 1 + 10 * i;
        over[i] = 2 * under[i];
    }
    RtEstimate e = rt_estimate_ratio(over, under, 20, 5);
    assert_true(e.median == 2 && e.low == 2 && e.high == 2);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_median_is_the_middle_one_or_the_mean_of_the_middle_two),
        cmocka_unit_test(equal_measurements_have_an_interval_of_no_width),
        cmocka_unit_test(the_interval_is_the_same_for_the_same_seed_and_contains_the_median),
        cmocka_unit_test(the_interval_agrees_with_the_binomial_one),
        cmocka_unit_test(about_95_in_100_intervals_hold_the_true_median),
        cmocka_unit_test(ratios_are_paired_within_a_round),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
