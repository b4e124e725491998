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
#ifndef RT_BENCH_STATISTICS_H
#define RT_BENCH_STATISTICS_H

#include "bench/rounds.h"

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

/* Estimate of the ratios over[i] / under[i]: paired, so that a drift which slows both does not show. */
RtEstimate rt_estimate_ratio(const double *over, const double *under, uint32_t count);

/* The probability, 0..1, that the interval of `count` measurements holds the median; 1 <= count <=
 * RT_MAX_ROUNDS. */
double rt_interval_coverage(uint32_t count);

#endif
