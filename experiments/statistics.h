/* Statistics of repeated measurements: the median and its bootstrap interval.
 *
 * Times on a shared machine have a long tail to the right, so the median stands for them, and its 95 %
 * interval is found by resampling (Efron 1979, "Bootstrap Methods: Another Look at the Jackknife", Annals of
 * Statistics 7(1); the percentile interval). The resampling is drawn from a seed: equal input, equal output.
 */
#ifndef RT_EXPERIMENTS_STATISTICS_H
#define RT_EXPERIMENTS_STATISTICS_H

#include "experiments/rounds.h"

typedef struct RtEstimate {
    double median, low, high; /* low..high: the 95 % interval of the median */
    double least;             /* the smallest measurement */
} RtEstimate;

/* The middle of values[0..count), 1 <= count <= RT_MAX_ROUNDS; the mean of the middle two if count is even.
 */
double rt_median(const double *values, uint32_t count);

/* Estimate of values[0..count), 1 <= count <= RT_MAX_ROUNDS. */
RtEstimate rt_estimate(const double *values, uint32_t count, uint64_t seed);

/* Estimate of the ratios over[i] / under[i]: paired, so that a drift which slows both does not show. */
RtEstimate rt_estimate_ratio(const double *over, const double *under, uint32_t count, uint64_t seed);

#endif
