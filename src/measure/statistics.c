/* SPDX-License-Identifier: Apache-2.0 */
#include "measure/statistics.h"

#include "core/base/elementary.h"
#include "core/base/memory.h"

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
static uint32_t outside(uint32_t count, double wanted, double *coverage) {
    assert(count >= 1 && count <= RT_MAX_ROUNDS);
    double probability = ldexp(1, -(int)count), below = probability;
    uint32_t out = 0;
    for (;; out++) {
        *coverage = 1 - 2 * below;
        probability *= (double)(count - out) / (double)(out + 1);
        below += probability;
        if (1 - 2 * below < wanted) return out;
    }
}

double rt_interval_coverage(uint32_t count) {
    double coverage;
    outside(count, WANTED, &coverage);
    return coverage;
}

double rt_binomial_tail(uint32_t least, uint32_t count, double chance) {
    double exactly = 1, tail = 1; /* k of them; more than k - 1 */
    if (chance >= 1) return 1;
    for (uint32_t i = 0; i < count; i++) exactly *= 1 - chance;
    for (uint32_t k = 0; k < least; k++) {
        tail -= exactly;
        exactly *= (double)(count - k) / (k + 1) * chance / (1 - chance);
    }
    return tail;
}

RtEstimate rt_estimate(const double *values, uint32_t count) {
    return rt_estimate_at(values, count, WANTED);
}

RtEstimate rt_estimate_at(const double *values, uint32_t count, double coverage) {
    double sorted[RT_MAX_ROUNDS], covered;
    sort(values, count, sorted);
    uint32_t out = outside(count, coverage, &covered);
    return (RtEstimate){.median = median_of(sorted, count),
                        .low = sorted[out],
                        .high = sorted[count - 1 - out],
                        .least = sorted[0]};
}

uint32_t rt_rounds_for(double coverage) {
    double covered;
    uint32_t count = 1;
    while (count < RT_MAX_ROUNDS && outside(count, coverage, &covered) == 0) count++;
    return count;
}

double rt_coverage_of_each(uint32_t count) {
    return 1 - (1 - WANTED) / (count > 1 ? count : 1);
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
    for (uint32_t i = 0; i < count; i++) {
        if (under[i] == 0) return rt_estimate_exactly((double)NAN);
        ratios[i] = over[i] / under[i];
    }
    return rt_estimate(ratios, count);
}

/* ---- unpaired ---- */

/* The normal distribution is accurate enough for more measurements of both together. */
enum { UNPAIRED_EXACT = 60, STEPS = 300 };

/* How many of the smallest of n * m pairs lie below the interval: the largest k with P(U < k) <= tail, where
 * U, the number of pairs in which one of m is less than one of n, has its distribution if both are alike. The
 * number of orders with U = u is built up one element of m after the other (the Gaussian binomial
 * coefficients). */
static uint64_t outside_exactly(uint32_t n, uint32_t m, double tail) {
    double orders[UNPAIRED_EXACT * UNPAIRED_EXACT / 4 + 1] = {1}, all = 0, below = 0;
    const uint32_t pairs = n * m;
    for (uint32_t j = 1; j <= m; j++) {
        for (uint32_t u = pairs; u >= n + j; u--) orders[u] -= orders[u - n - j];
        for (uint32_t u = j; u <= pairs; u++) orders[u] += orders[u - j];
    }
    for (uint32_t u = 0; u <= pairs; u++) all += orders[u];
    for (uint32_t u = 0; u <= pairs; u++) {
        below += orders[u];
        if (below > tail * all) return u;
    }
    return pairs;
}

/* The integral of a density from `from` over 2 * STEPS steps, by Simpson's rule. */
static double integral(double (*density)(double x, uint32_t freedom), uint32_t freedom, double from,
                       double step) {
    double sum = 0;
    for (int i = 0; i <= 2 * STEPS; i++) {
        const double weight = i == 0 || i == 2 * STEPS ? 1 : i % 2 ? 4 : 2;
        sum += weight * density(from + i * step, freedom);
    }
    return sum * step / 3;
}

/* Up to a constant. */
static double normal_density(double x, uint32_t freedom) {
    (void)freedom;
    return rt_power(2.7182818284590452, -0.5 * x * x);
}

/* How much of the normal distribution lies above z >= 0. */
static double normal_tail(double z) {
    const double root = 2.5066282746310002; /* sqrt(2 pi), the area under e^(-x^2 / 2) */
    return integral(normal_density, 0, z, 12.0 / (2 * STEPS)) / root;
}

/* By the normal approximation, z by the bisection of its tail. */
static uint64_t outside_nearly(double n, double m, double tail) {
    double lo = 0, hi = 40;
    for (int i = 0; i < 60; i++) {
        double z = 0.5 * (lo + hi);
        if (normal_tail(z) > tail)
            lo = z;
        else
            hi = z;
    }
    double k = floor(0.5 * n * m - hi * sqrt(n * m * (n + m + 1) / 12));
    return k > 0 ? (uint64_t)k : 0;
}

RtStatus rt_estimate_unpaired(const double *over, uint32_t over_count, const double *under,
                              uint32_t under_count, double coverage, RtEstimate *estimate, RtError *error) {
    assert(over_count >= 1 && under_count >= 1);
    RT_ARENA(arena);
    size_t count = (size_t)over_count * under_count, used = 0;
    double *ratios = rt_arena_alloc(&arena, count, sizeof(double)), tail = 0.5 * (1 - coverage);
    RT_TRY(rt_arena_check(&arena, "ratios", error));
    for (uint32_t i = 0; i < over_count; i++) {
        for (uint32_t k = 0; k < under_count; k++) ratios[used++] = over[i] / under[k];
    }
    qsort(ratios, count, sizeof(double), compare);
    uint64_t out = over_count + under_count <= UNPAIRED_EXACT ? outside_exactly(over_count, under_count, tail)
                                                              : outside_nearly(over_count, under_count, tail);
    if (out > 0) out--; /* the interval begins at the out-th smallest ratio, whose index is out - 1 */
    *estimate = (RtEstimate){.median = 0.5 * (ratios[(count - 1) / 2] + ratios[count / 2]),
                             .low = ratios[out],
                             .high = ratios[count - 1 - out],
                             .least = ratios[0]};
    return RT_OK;
}

double rt_unpaired_coverage(uint32_t over_count, uint32_t under_count) {
    double orders = 1;
    for (uint32_t i = 1; i <= under_count; i++) orders *= (double)(over_count + i) / i;
    return fmax(0, 1 - 2 / orders);
}

uint32_t rt_unpaired_rounds(double coverage) {
    uint32_t count = 1;
    while (count < RT_MAX_ROUNDS && rt_unpaired_coverage(count, count) < coverage) count++;
    return count;
}

/* ---- Student's t ---- */

/* Student's density of t = sqrt(freedom) 2 w / (1 - w^2), times dt / dw, up to a constant: it has no tail. */
static double student_density(double w, uint32_t freedom) {
    double density = 1 / (1 + w * w), power = (1 - w * w) / (1 + w * w);
    for (uint32_t n = freedom - 1; n > 0; n /= 2, power *= power) {
        if (n % 2) density *= power;
    }
    return density;
}

/* The integral from w to 1. */
static double student_tail(double w, uint32_t freedom) {
    return integral(student_density, freedom, w, (1 - w) / (2 * STEPS));
}

/* By bisection of w. The last quantile is kept, because tables ask for the same one for each cell. */
double rt_student_quantile(uint32_t freedom, double coverage) {
    static _Thread_local struct {
        uint32_t freedom;
        double coverage, quantile;
    } last;
    if (freedom == last.freedom && coverage == last.coverage) return last.quantile;
    const double wanted = (1 - coverage) * student_tail(0, freedom);
    double lo = 0, hi = 1;
    for (int i = 0; i < 50; i++) {
        double w = 0.5 * (lo + hi);
        if (student_tail(w, freedom) > wanted)
            lo = w;
        else
            hi = w;
    }
    last.freedom = freedom;
    last.coverage = coverage;
    last.quantile = sqrt(freedom) * 2 * lo / (1 - lo * lo);
    return last.quantile;
}

RtEstimate rt_estimate_student(const double *ratios, uint32_t count, double coverage) {
    const double e = 2.7182818284590452;
    double sum = 0, squares = 0, least = ratios[0];
    assert(count >= 2);
    for (uint32_t i = 0; i < count; i++) {
        sum += rt_log(ratios[i]);
        least = fmin(least, ratios[i]);
    }
    const double mean = sum / count;
    for (uint32_t i = 0; i < count; i++) squares += (rt_log(ratios[i]) - mean) * (rt_log(ratios[i]) - mean);
    const double half = rt_student_quantile(count - 1, coverage) * sqrt(squares / (count - 1) / count);
    return (RtEstimate){.median = rt_power(e, mean),
                        .low = rt_power(e, mean - half),
                        .high = rt_power(e, mean + half),
                        .least = least};
}

RtEstimate rt_estimate_covering(const double *values, uint32_t count, double coverage) {
    double covered;
    RtEstimate estimate = rt_estimate_at(values, count, coverage);
    outside(count, coverage, &covered);
    if (covered >= coverage) return estimate;
    if (count == 1) return (RtEstimate){estimate.median, 0, (double)INFINITY, estimate.least};
    const RtEstimate student = rt_estimate_student(values, count, coverage);
    estimate.low = fmin(estimate.low, student.low);
    estimate.high = fmax(estimate.high, student.high);
    return estimate;
}

/* ---- distributions of counts ---- */

const char *rt_quantity_name(size_t i) {
#define NAME(name, meaning) #name,
    static const char *const names[] = {RT_RAY_QUANTITIES(NAME) RT_LEAF_QUANTITIES(NAME)};
#undef NAME
    assert(i < RT_QUANTITY_COUNT);
    return names[i];
}

enum { PLAIN = 16, AN_OCTAVE = 8, PLAIN_BITS = 4, OCTAVE_BITS = 3 };

uint32_t rt_histogram_bin(uint64_t value) {
    assert(value <= UINT32_MAX);
    if (value < PLAIN) return (uint32_t)value;
    uint32_t bits = 63 - (uint32_t)__builtin_clzll(value);
    uint32_t eighth = (uint32_t)(value >> (bits - OCTAVE_BITS)) - AN_OCTAVE;
    return PLAIN + (bits - PLAIN_BITS) * AN_OCTAVE + eighth;
}

uint64_t rt_histogram_low(uint32_t bin) {
    if (bin < PLAIN) return bin;
    uint32_t octave = (bin - PLAIN) / AN_OCTAVE, eighth = (bin - PLAIN) % AN_OCTAVE;
    return (uint64_t)(AN_OCTAVE + eighth) << (octave + PLAIN_BITS - OCTAVE_BITS);
}

RtStatus rt_occurrences_add(RtOccurrences *occurrences, uint64_t value, RtError *error) {
    const uint64_t most = UINT64_C(1) << 27; /* a gigabyte of numbers */
    if (value >= most)
        return rt_fail(error, RT_BROKEN, "a count of %llu for one ray is too large for a distribution",
                       (unsigned long long)value);
    if (value >= occurrences->end) {
        uint32_t end = (uint32_t)value + 1;
        RT_TRY(rt_reserve(&occurrences->of, &occurrences->capacity, end, sizeof(uint64_t), error));
        memset(occurrences->of + occurrences->end, 0, (end - occurrences->end) * sizeof(uint64_t));
        occurrences->end = end;
    }
    occurrences->of[value]++;
    return RT_OK;
}

void rt_occurrences_clear(RtOccurrences *occurrences) {
    rt_free(occurrences->of);
    *occurrences = (RtOccurrences){0};
}

/* The value of rank ceil(thousandths / 1000 * count). */
static uint64_t percentile(const RtOccurrences *occurrences, uint64_t count, uint64_t thousandths) {
    uint64_t rank = count / 1000 * thousandths + (count % 1000 * thousandths + 999) / 1000, seen = 0;
    uint32_t value = 0;
    while (value + 1 < occurrences->end && (seen += occurrences->of[value]) < rank) value++;
    return value;
}

RtDistribution rt_distribution_of(const RtOccurrences *occurrences) {
    RtDistribution d = {0};
    for (uint32_t value = 0; value < occurrences->end; value++) {
        uint64_t often = occurrences->of[value];
        d.count += often;
        d.sum += often * value;
        d.bins[rt_histogram_bin(value)] += often;
    }
    if (d.count == 0) return d;
    d.median = percentile(occurrences, d.count, 500);
    d.p90 = percentile(occurrences, d.count, 900);
    d.p99 = percentile(occurrences, d.count, 990);
    d.p999 = percentile(occurrences, d.count, 999);
    d.most = occurrences->end - 1;
    return d;
}

#define FIGURES(X) X(count) X(sum) X(median) X(p90) X(p99) X(p999) X(most)

static json_t *one_json(const RtDistribution *d) {
    json_t *object = json_object(), *bins = json_array();
#define PUT(name) json_object_set_new(object, #name, json_integer((json_int_t)d->name));
    FIGURES(PUT)
#undef PUT
    for (uint32_t b = 0; b < RT_HISTOGRAM_BINS; b++) {
        if (d->bins[b])
            json_array_append_new(bins, json_pack("[I, I]", (json_int_t)b, (json_int_t)d->bins[b]));
    }
    json_object_set_new(object, "bins", bins);
    return object;
}

static bool take_one(RtDistribution *d, const json_t *object) {
    const json_t *bins = json_object_get(object, "bins");
    *d = (RtDistribution){0};
#define TAKE(name) d->name = (uint64_t)json_integer_value(json_object_get(object, #name));
    FIGURES(TAKE)
#undef TAKE
    for (size_t i = 0; i < json_array_size(bins); i++) {
        const json_t *pair = json_array_get(bins, i);
        json_int_t bin = json_integer_value(json_array_get(pair, 0));
        if (bin < 0 || bin >= RT_HISTOGRAM_BINS) return false;
        d->bins[bin] = (uint64_t)json_integer_value(json_array_get(pair, 1));
    }
    return bins != NULL;
}

json_t *rt_distributions_json(const RtDistribution *distributions, size_t first, size_t count) {
    json_t *object = json_object();
    for (size_t i = 0; i < count; i++)
        json_object_set_new(object, rt_quantity_name(first + i), one_json(&distributions[i]));
    return object;
}

bool rt_distributions_take(RtDistribution *distributions, size_t first, size_t count, const json_t *object) {
    bool all = true;
    for (size_t i = 0; i < count; i++)
        all &= take_one(&distributions[i], json_object_get(object, rt_quantity_name(first + i)));
    return all;
}
