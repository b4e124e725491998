#include "experiments/statistics.h"

#include "base/random.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

enum { RESAMPLES = 2000 };

static int compare(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* The median of values that may be reordered. */
static double median_of(double *values, uint32_t count) {
    qsort(values, count, sizeof(double), compare);
    return 0.5 * (values[(count - 1) / 2] + values[count / 2]);
}

double rt_median(const double *values, uint32_t count) {
    double copy[RT_MAX_ROUNDS];
    assert(count >= 1 && count <= RT_MAX_ROUNDS);
    memcpy(copy, values, count * sizeof(double));
    return median_of(copy, count);
}

RtEstimate rt_estimate(const double *values, uint32_t count, uint64_t seed) {
    double medians[RESAMPLES], sample[RT_MAX_ROUNDS];
    assert(count >= 1 && count <= RT_MAX_ROUNDS);
    RtRandom random = rt_random(seed, 0);
    for (int i = 0; i < RESAMPLES; i++) {
        for (uint32_t k = 0; k < count; k++) {
            sample[k] = values[((uint64_t)rt_random_bits(&random) * count) >> 32];
        }
        medians[i] = median_of(sample, count);
    }
    qsort(medians, RESAMPLES, sizeof(double), compare);
    RtEstimate estimate = {.median = rt_median(values, count),
                           .low = medians[RESAMPLES * 25 / 1000],
                           .high = medians[RESAMPLES * 975 / 1000 - 1],
                           .least = values[0]};
    for (uint32_t i = 1; i < count; i++) {
        if (values[i] < estimate.least) estimate.least = values[i];
    }
    return estimate;
}

RtEstimate rt_estimate_ratio(const double *over, const double *under, uint32_t count, uint64_t seed) {
    double ratios[RT_MAX_ROUNDS];
    assert(count >= 1 && count <= RT_MAX_ROUNDS);
    for (uint32_t i = 0; i < count; i++) ratios[i] = over[i] / under[i];
    return rt_estimate(ratios, count, seed);
}
