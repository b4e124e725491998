/* SPDX-License-Identifier: Apache-2.0 */
/* The cells that a claim is about, with their values, and figures over several of them. */
#ifndef RT_CLAIMS_CLAIMS_POINTS_H
#define RT_CLAIMS_CLAIMS_POINTS_H

#include "claims/claims.h"

/* A cell, and the one it is compared with. */
typedef struct RtClaimPoint {
    RtClaimCell at, other; /* the same without a second side */
    bool found;            /* the second side has a cell */
    uint64_t rays;         /* measured: the fewest of both; UINT64_MAX if the claim is not of rays */
    double x;              /* of the parameter; of a correlation: the first measure, NAN if unknown */
    RtEstimate y;          /* the measure, or the ratio to `other`; NAN if unknown */
} RtClaimPoint;

/* Whether x and y are known. An infinite break-even is known. */
bool rt_claim_point_known(const RtClaimPoint *point);

/* What a claim is judged by. */
typedef struct RtClaimCase {
    const RtResults *results;
    const RtClaim *claim;
    double coverage; /* of each interval of a tracing time */
} RtClaimCase;

/* One measure of one cell over another of another. Times of one scene and kind of rays are paired; of others
 * the quotient of both estimates, with those of the intervals' ends. */
RtEstimate rt_claim_ratio(const RtClaimCase *of, RtClaimMeasure over, const RtClaimCell *a,
                          RtClaimMeasure under, const RtClaimCell *b);

/* Writes the cells of a claim to points[0..workload_count * candidate_count * RT_RAY_KIND_COUNT), kind by
 * kind; returns their number. NULL: only their number. */
uint32_t rt_claim_gather(const RtClaimCase *of, RtClaimPoint *points);

/* Whether anything that the claim could be about was measured in any of the cells. */
bool rt_claim_any_measured(const RtResults *results, const RtClaim *claim, const RtClaimPoint *points,
                           uint32_t count);

/* Moves the points that differ from points[0] only in the claim's parameter to the front and sorts them by
 * it; returns their number, >= 1. */
uint32_t rt_claim_line(const RtExperiment *experiment, const RtClaim *claim, RtClaimPoint *points,
                       uint32_t count);

/* Why an accelerator that the claim names refused a scene of it; NULL if none did. */
const char *rt_claim_refusal(const RtResults *results, const RtClaim *claim);

/* ---- figures ---- */

/* Means, exponents, correlations and crossovers are of logarithms, so values are above 0; otherwise the
 * figure is unknown. */

/* The geometric mean. Its interval is that of the ends, which it covers if all intervals of y do. */
RtEstimate rt_claim_mean(const RtClaimPoint *points, uint32_t count);

/* The least-squares slope of log y over log x. The interval covers the slopes of all values within the
 * intervals of y, and 95 % of the slopes of a line round which the points scatter: Student's t with count - 2
 * degrees of freedom (Draper & Smith 1998, "Applied Regression Analysis", section 1.4). Two points have no
 * scatter. *error is the standard error. NAN if any point is unknown: the others may have another slope. */
RtEstimate rt_claim_exponent(const RtClaimPoint *points, uint32_t count, double *error);

/* Pearson's correlation of log x and log y. The interval of 95 % is Fisher's (1921, "On the 'Probable Error'
 * of a Coefficient of Correlation", Metron 1), which takes the cells for independent draws from a bivariate
 * normal distribution: what other cells of this kind would show. -1 to 1 for fewer than four. */
RtEstimate rt_claim_correlation(const RtClaimPoint *points, uint32_t count);

/* Values of x for which the interval of y, the ratio of two curves, contains 1. Between the points, which are
 * sorted by x, all three curves of y (low, median, high) are straight in the logarithms. */
typedef struct RtCrossover {
    double low, high;  /* 0 and INFINITY: beyond the first or last point */
    int before, after; /* -1: y is below 1 on that side; 1: above; 0: unknown, beyond the points */
} RtCrossover;

/* Writes the first RT_MAX_CROSSOVERS of them in order and returns their number. Zero for unknown values. */
enum { RT_MAX_CROSSOVERS = 16 };
uint32_t rt_claim_crossovers(const RtClaimPoint *points, uint32_t count,
                             RtCrossover crossovers[RT_MAX_CROSSOVERS]);

/* The x within [crossover->low, crossover->high] above `after` where the median of y is next 1; NAN if there
 * is none. */
double rt_claim_median_crossover(const RtClaimPoint *points, uint32_t count, const RtCrossover *crossover,
                                 double after);

#endif
