/* SPDX-License-Identifier: Apache-2.0 */
/* Statistics of repeated measurements: the median and its interval.
 *
 * Times on a shared machine have a long tail to the right, so the median stands for them. Its interval is
 * that of order statistics (Thompson 1936, "On Confidence Ranges for the Median and Other Expectation
 * Distributions", Annals of Mathematical Statistics 7(3); David & Nagaraja 2003, "Order Statistics",
 * section 7.1): of n independent measurements, however they are distributed, the number below the median is
 * binomial (n, 1/2), so the k-th smallest and the k-th largest enclose the median with a probability that is
 * known exactly,
 *
 *     coverage(k) = 1 - 2 * P(Binomial(n, 1/2) < k).
 *
 * k is the largest for which that is at least 95 %. A percentile bootstrap, usual elsewhere, resamples the
 * same few values and promises 95 % without keeping it: 87.5 % of 7 rounds, a width of nothing for one.
 *
 * Fewer than RT_FULL_ROUNDS measurements have no such k. Then k = 1, the smallest and the largest, and
 * rt_interval_coverage says what that is worth: 93.75 % of 5, 75 % of 3, nothing of one. */
#ifndef RT_MEASURE_STATISTICS_H
#define RT_MEASURE_STATISTICS_H

#include "measure/rounds.h"

#include <stdbool.h>

#define RT_FULL_ROUNDS 6 /* from here on intervals cover 95 % at least */

typedef struct RtEstimate {
    double median, low, high; /* low..high: the interval of the median */
    double least;             /* the smallest measurement */
} RtEstimate;

/* Is `value` within the interval? Of the numbers as they are, however many digits of them are shown. */
bool rt_estimate_holds(const RtEstimate *estimate, double value);

/* How far its ends lie from the median, the farther one, as a part of the median. */
double rt_estimate_width(const RtEstimate *estimate);

/* The middle of values[0..count), 1 <= count <= RT_MAX_ROUNDS; the mean of the middle two if count is
 * even. */
double rt_median(const double *values, uint32_t count);

/* Estimate of values[0..count), 1 <= count <= RT_MAX_ROUNDS. */
RtEstimate rt_estimate(const double *values, uint32_t count);

/* The same with an interval that covers `coverage` (0..1) at least, if there are enough measurements: else it
 * is the smallest to the largest. */
RtEstimate rt_estimate_at(const double *values, uint32_t count, double coverage);

/* The fewest measurements whose interval of that coverage leaves one out on either side, so that a single
 * stray one decides nothing; RT_MAX_ROUNDS where these are not enough. */
uint32_t rt_rounds_for(double coverage);

/* Estimate of the ratio of what over[0..over_count) is about to what under[0..under_count) is, which were not
 * measured together: the median of all ratios of one to another (Hodges & Lehmann 1963, "Estimates of
 * Location Based on Rank Tests", Annals of Mathematical Statistics 34(2)), and the order statistics of them
 * that the test of Mann & Whitney 1947 leaves, exactly up to UNPAIRED_EXACT measurements of both together, by
 * its normal approximation beyond. Where too few for `coverage`: the smallest to the largest. Least is the
 * smallest ratio. RT_NO_MEMORY. */
RtStatus rt_estimate_unpaired(const double *over, uint32_t over_count, const double *under,
                              uint32_t under_count, double coverage, RtEstimate *estimate, RtError *error);

/* What each of `count` intervals has to cover for all of them to hold in 95 % of all cases, however they
 * depend on one another (Bonferroni's inequality; Dunn 1961, "Multiple Comparisons among Means", Journal of
 * the American Statistical Association 56(293)). */
double rt_coverage_of_each(uint32_t count);

/* Estimate of the ratios over[i] / under[i]: paired, so that a drift which slows both does not show. */
RtEstimate rt_estimate_ratio(const double *over, const double *under, uint32_t count);

/* The probability, 0..1, that the interval of `count` measurements holds the median; 1 <= count <=
 * RT_MAX_ROUNDS. */
double rt_interval_coverage(uint32_t count);

#endif
