/* SPDX-License-Identifier: Apache-2.0 */
/* Statistics of repeated measurements, the median and its confidence interval; and distributions of counts.
 *
 * Times on a shared machine have a long tail to the right, so their median is used. Its interval is that of
 * order statistics (Thompson 1936, "On Confidence Ranges for the Median and Other Expectation
 * Distributions", Annals of Mathematical Statistics 7(3); David & Nagaraja 2003, "Order Statistics",
 * section 7.1): of n independent measurements, however they are distributed, the number below the median is
 * binomial (n, 1/2), so the k-th smallest and the k-th largest enclose the median with a probability that is
 * known exactly,
 *
 *     coverage(k) = 1 - 2 * P(Binomial(n, 1/2) < k).
 *
 * k is the largest for which that is at least 95 %. The usual percentile bootstrap resamples the same few
 * values and does not reach the 95 % it promises: 87.5 % for 7 rounds, and no width at all for one.
 *
 * Fewer than RT_FULL_ROUNDS measurements have no such k. Then k = 1, the smallest and the largest, and
 * rt_interval_coverage returns what that covers: 93.75 % for 5, 75 % for 3, nothing for one. */
#ifndef RT_MEASURE_STATISTICS_H
#define RT_MEASURE_STATISTICS_H

#include "core/base/status.h"
#include "core/base/tally.h"

#include <jansson.h>
#include <stdbool.h>
#include <stdint.h>

#define RT_MAX_ROUNDS  1000 /* most measurements of one runner */
#define RT_FULL_ROUNDS 6    /* the fewest measurements whose interval covers 95 % */

typedef struct RtEstimate {
    double median, low, high; /* low..high: the interval of the median */
    double least;             /* the smallest measurement */
} RtEstimate;

/* The estimate of what is known exactly; of NAN: of what is unknown. */
static inline RtEstimate rt_estimate_exactly(double value) {
    return (RtEstimate){value, value, value, value};
}

/* Whether `value` is within the interval, at full precision. */
bool rt_estimate_holds(const RtEstimate *estimate, double value);

/* The distance from the median to the farther end, as a part of the median. */
double rt_estimate_width(const RtEstimate *estimate);

/* The median of values[0..count), 1 <= count <= RT_MAX_ROUNDS; the mean of the middle two if count is even.
 */
double rt_median(const double *values, uint32_t count);

/* Estimate of values[0..count), 1 <= count <= RT_MAX_ROUNDS. */
RtEstimate rt_estimate(const double *values, uint32_t count);

/* The same with an interval that covers at least `coverage` (0..1), or the smallest to the largest if there
 * are too few measurements. */
RtEstimate rt_estimate_at(const double *values, uint32_t count, double coverage);

/* Estimate of values[0..count), all above 0, whose interval covers at least `coverage`, 0.95 or more, however
 * few there are: the order statistics if they suffice, else the smallest to the largest, widened to Student's
 * interval (rt_estimate_student). One measurement alone could be anything: 0 to INFINITY. */
RtEstimate rt_estimate_covering(const double *values, uint32_t count, double coverage);

/* The fewest measurements whose interval of that coverage discards one at each end, so that no single outlier
 * matters; at most RT_MAX_ROUNDS. */
uint32_t rt_rounds_for(double coverage);

/* Estimates the ratio of over[0..over_count) to under[0..under_count), which were not measured in pairs: the
 * median of all ratios of one to another (Hodges & Lehmann 1963, "Estimates of Location Based on Rank Tests",
 * Annals of Mathematical Statistics 34(2)). The interval are their order statistics by the test of Mann &
 * Whitney 1947: exact for up to UNPAIRED_EXACT measurements of both together, by its normal approximation
 * beyond; the smallest to the largest if there are too few for `coverage`. Least is the smallest ratio.
 * RT_NO_MEMORY. */
RtStatus rt_estimate_unpaired(const double *over, uint32_t over_count, const double *under,
                              uint32_t under_count, double coverage, RtEstimate *estimate, RtError *error);

/* The most that such an interval can cover: the one from the smallest to the largest ratio. 0.9978 for 6 and
 * 6. And the fewest measurements of each with which it covers as much; at most RT_MAX_ROUNDS. */
double rt_unpaired_coverage(uint32_t over_count, uint32_t under_count);
uint32_t rt_unpaired_rounds(double coverage);

/* Estimates the ratio that ratios[0..count), count >= 2, are independent measurements of: their geometric
 * mean (as `median`), with Student's interval of their logarithms. Their variances may differ: if each is
 * normal with a variance of its own, or has the long tails of a mixture of such, the interval covers at least
 * `coverage`, 0.95 or more (Bakirov & Szekely 2006, "Student's t-Test for Gaussian Scale Mixtures", Journal
 * of Mathematical Sciences 139(3); Ibragimov & Muller 2010, "t-Statistic Based Correlation and Heterogeneity
 * Robust Inference", Journal of Business & Economic Statistics 28(4)). */
RtEstimate rt_estimate_student(const double *ratios, uint32_t count, double coverage);

/* The t that Student's |t| of `freedom` >= 1 degrees of freedom exceeds with probability 1 - coverage. */
double rt_student_quantile(uint32_t freedom, double coverage);

/* The coverage of each of `count` intervals with which all of them hold in 95 % of all cases, even if they
 * depend on one another (Bonferroni's inequality; Dunn 1961, "Multiple Comparisons among Means", Journal of
 * the American Statistical Association 56(293)). */
double rt_coverage_of_each(uint32_t count);

/* Estimate of the ratios over[i] / under[i]: pairs, so that drift cancels. NaN if an under[i] is 0. */
RtEstimate rt_estimate_ratio(const double *over, const double *under, uint32_t count);

/* The probability, 0..1, that the interval of `count` measurements holds the median; 1 <= count <=
 * RT_MAX_ROUNDS. */
double rt_interval_coverage(uint32_t count);

/* The probability that `least` or more of `count` independent events happen, each with this chance, 0..1. */
double rt_binomial_tail(uint32_t least, uint32_t count, double chance);

/* ---- distributions of counts ---- */

/* Distributions of counts: object tests, extent tests and steps over the rays of a cell, sizes and depths
 * over the leaves of a structure. A mean hides the few rays that cost a hundred times as much, and the few
 * leaves that hold half of the objects.
 *
 * Percentiles are exact: of `count` sorted values, the one of rank ceil(part * count). Histograms have a bin
 * for each value below 16 and eight for every doubling beyond, so no bin is wider than an eighth of its lower
 * end. */

/* Quantities, each X(name, meaning): counters of RtTally with that name, over rays; and quantities of leaves.
 */
#define RT_RAY_QUANTITIES(X)                                                                                 \
    X(object_tests, "object tests of a ray")                                                                 \
    X(extent_tests, "extent tests of a ray")                                                                 \
    X(steps, "steps of a ray")
#define RT_LEAF_QUANTITIES(X)                                                                                \
    X(leaf_size, "objects in the list of a leaf, or voxel")                                                  \
    X(leaf_depth, "depth of a leaf, or voxel, the root being 0")

#define RT_QUANTITY_ENUM(name, meaning) RT_QUANTITY_##name,
typedef enum RtRayQuantity { RT_RAY_QUANTITIES(RT_QUANTITY_ENUM) RT_RAY_QUANTITY_COUNT } RtRayQuantity;
typedef enum RtLeafQuantity { RT_LEAF_QUANTITIES(RT_QUANTITY_ENUM) RT_LEAF_QUANTITY_COUNT } RtLeafQuantity;
#undef RT_QUANTITY_ENUM

/* "object_tests", ..., and after the quantities of rays, "leaf_size", ...: 0 <= i < RT_QUANTITY_COUNT. */
enum { RT_QUANTITY_COUNT = (int)RT_RAY_QUANTITY_COUNT + (int)RT_LEAF_QUANTITY_COUNT };
const char *rt_quantity_name(size_t i);

enum { RT_HISTOGRAM_BINS = 16 + 8 * 28 };

typedef struct RtDistribution {
    uint64_t count, sum;                   /* of the values */
    uint64_t median, p90, p99, p999, most; /* percentiles: 50 %, 90 %, 99 %, 99.9 %; the largest value */
    uint64_t bins[RT_HISTOGRAM_BINS];      /* number of values in each */
} RtDistribution;

/* The bin of a value < 2^32, and the least value of a bin; that of RT_HISTOGRAM_BINS is the end of the last
 * bin. */
uint32_t rt_histogram_bin(uint64_t value);
uint64_t rt_histogram_low(uint32_t bin);

/* Counts how often each value occurs. */
typedef struct RtOccurrences {
    uint64_t *of;           /* [end], owned */
    uint32_t end, capacity; /* all values are below `end` */
} RtOccurrences;

/* Adds a value. RT_NO_MEMORY: every value up to the largest takes eight bytes. RT_BROKEN if it is absurdly
 * large. */
RtStatus rt_occurrences_add(RtOccurrences *occurrences, uint64_t value, RtError *error);
void rt_occurrences_clear(RtOccurrences *occurrences);

/* All zero if there are no values. */
RtDistribution rt_distribution_of(const RtOccurrences *occurrences);

/* distributions[0..count) under their names, from rt_quantity_name(first), as a JSON object, a new reference,
 * and back; empty bins are omitted. False if one is missing. */
json_t *rt_distributions_json(const RtDistribution *distributions, size_t first, size_t count);
bool rt_distributions_take(RtDistribution *distributions, size_t first, size_t count, const json_t *object);

#endif
