/* SPDX-License-Identifier: Apache-2.0 */
#include "bench/statistics.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double WANTED = 0.95;

static int compare(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double median_of(const double *sorted, uint32_t count) {
    return 0.5 * (sorted[(count - 1) / 2] + sorted[count / 2]);
}

static void sort(const double *values, uint32_t count, double *sorted) {
    assert(count >= 1 && count <= RT_MAX_ROUNDS);
    memcpy(sorted, values, count * sizeof(double));
    qsort(sorted, count, sizeof(double), compare);
}

double rt_median(const double *values, uint32_t count) {
    double sorted[RT_MAX_ROUNDS];
    sort(values, count, sorted);
    return median_of(sorted, count);
}

/* How many measurements lie outside the interval on either side, and with what probability it holds the
 * median. 2^-RT_MAX_ROUNDS is still a normal number. */
static uint32_t outside(uint32_t count, double *coverage) {
    assert(count >= 1 && count <= RT_MAX_ROUNDS);
    double probability = ldexp(1, -(int)count), below = probability;
    uint32_t out = 0;
    for (;; out++) {
        *coverage = 1 - 2 * below;
        probability *= (double)(count - out) / (double)(out + 1);
        below += probability;
        if (1 - 2 * below < WANTED) return out;
    }
}

double rt_interval_coverage(uint32_t count) {
    double coverage;
    outside(count, &coverage);
    return coverage;
}

RtEstimate rt_estimate(const double *values, uint32_t count) {
    double sorted[RT_MAX_ROUNDS], coverage;
    sort(values, count, sorted);
    uint32_t out = outside(count, &coverage);
    return (RtEstimate){.median = median_of(sorted, count),
                        .low = sorted[out],
                        .high = sorted[count - 1 - out],
                        .least = sorted[0]};
}

bool rt_estimate_holds(const RtEstimate *estimate, double value) {
    return estimate->low <= value && value <= estimate->high;
}

double rt_estimate_width(const RtEstimate *estimate) {
    return fmax(estimate->high - estimate->median, estimate->median - estimate->low) / estimate->median;
}

RtEstimate rt_estimate_ratio(const double *over, const double *under, uint32_t count) {
    double ratios[RT_MAX_ROUNDS];
    assert(count >= 1 && count <= RT_MAX_ROUNDS);
    for (uint32_t i = 0; i < count; i++) ratios[i] = over[i] / under[i];
    return rt_estimate(ratios, count);
}
