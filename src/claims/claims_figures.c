/* SPDX-License-Identifier: Apache-2.0 */
#include "claims/claims_figures.h"

#include "core/base/elementary.h"

#include <math.h>

static bool all_have_logarithms(const RtClaimPoint *points, uint32_t count) {
    for (uint32_t i = 0; i < count; i++) {
        if (!(points[i].x > 0 && points[i].y.low > 0 && isfinite(points[i].y.high))) return false;
    }
    return true;
}

/* Sums of squares and products of the logarithms about their means. */
typedef struct Moments {
    double x, y; /* means */
    double xx, yy, xy;
} Moments;

static Moments moments_of(const RtClaimPoint *points, uint32_t count) {
    Moments m = {0};
    for (uint32_t i = 0; i < count; i++) {
        m.x += rt_log(points[i].x) / count;
        m.y += rt_log(points[i].y.median) / count;
    }
    for (uint32_t i = 0; i < count; i++) {
        const double x = rt_log(points[i].x) - m.x, y = rt_log(points[i].y.median) - m.y;
        m.xx += x * x;
        m.yy += y * y;
        m.xy += x * y;
    }
    /* Equal values differ from their mean by rounding. */
    if (m.xx < 1e-24 * count) m.xx = 0;
    if (m.yy < 1e-24 * count) m.yy = 0;
    return m;
}

/* ---- exponents ---- */

RtEstimate rt_claim_exponent(const RtClaimPoint *points, uint32_t count, double *error) {
    *error = 0;
    if (!all_have_logarithms(points, count)) return rt_estimate_exactly((double)NAN);
    const Moments m = moments_of(points, count);
    RtEstimate slope = {0};
    if (m.xx == 0) return rt_estimate_exactly((double)NAN);
    const double from = rt_log(points->y.median); /* equal values have a slope of exactly 0 */
    for (uint32_t i = 0; i < count; i++) {
        const RtEstimate *y = &points[i].y;
        const double d = (rt_log(points[i].x) - m.x) / m.xx;
        slope.median += d * (rt_log(y->median) - from);
        slope.low += d * (rt_log(d > 0 ? y->low : y->high) - from);
        slope.high += d * (rt_log(d > 0 ? y->high : y->low) - from);
    }
    const double residuals = m.yy - slope.median * m.xy;       /* the sum of their squares */
    if (count == 2 || residuals <= 1e-12 * m.yy) return slope; /* less is rounding */
    *error = sqrt(residuals / (count - 2) / m.xx);
    const double scatter = rt_student_quantile(count - 2, 0.95) * *error;
    slope.low = fmin(slope.low, slope.median - scatter);
    slope.high = fmax(slope.high, slope.median + scatter);
    return slope;
}

/* ---- correlations ---- */

RtEstimate rt_claim_correlation(const RtClaimPoint *points, uint32_t count) {
    if (!all_have_logarithms(points, count)) return rt_estimate_exactly((double)NAN);
    const Moments m = moments_of(points, count);
    const double r = fmax(-1, fmin(1, m.xy / sqrt(m.xx * m.yy)));
    if (!(m.xx > 0 && m.yy > 0)) return rt_estimate_exactly((double)NAN);
    if (count < 4) return (RtEstimate){r, -1, 1, -1};
    /* tanh(artanh r -+ d) = (r -+ tanh d) / (1 -+ r tanh d) */
    const double e = rt_power(2.718281828459045, 2 * 1.96 / sqrt(count - 3)), t = (e - 1) / (e + 1);
    return (RtEstimate){r, (r - t) / (1 - r * t), (r + t) / (1 + r * t), -1};
}

/* ---- crossovers ---- */

/* The curves of the logarithm of y between points[0] and points[1]; `at` is 0 at the first and 1 at the
 * second. */
static double x_at(const RtClaimPoint *points, double at) {
    return at == 0 ? points[0].x : rt_power(points[0].x, 1 - at) * rt_power(points[1].x, at);
}

static double between(double first, double second, double at) {
    return rt_log(first) * (1 - at) + rt_log(second) * at;
}

/* Where a curve from `first` to `second` passes 1; 1 if it does not. */
static double root(double first, double second) {
    const double a = rt_log(first), b = rt_log(second);
    return (a < 0 && b > 0) || (a > 0 && b < 0) ? a / (a - b) : 1;
}

/* On which side of 1 the interval of y lies; 0 if it contains 1. */
static int side_at(const RtClaimPoint *points, double at) {
    if (between(points[0].y.low, points[1].y.low, at) > 0) return 1;
    return between(points[0].y.high, points[1].y.high, at) < 0 ? -1 : 0;
}

/* Follows the side along x; enters `side` at `x`. */
typedef struct Walk {
    RtCrossover *crossovers;
    uint32_t count;
    int side;
    RtCrossover open; /* while side is 0 */
} Walk;

static void add(Walk *walk, RtCrossover crossover) {
    if (walk->count < RT_MAX_CROSSOVERS) walk->crossovers[walk->count] = crossover;
    walk->count++;
}

static void enter(Walk *walk, double x, int side) {
    if (side == walk->side) return;
    if (side == 0) {
        walk->open = (RtCrossover){.low = x, .before = walk->side};
    } else if (walk->side == 0) {
        walk->open.high = x;
        walk->open.after = side;
        add(walk, walk->open);
    } else {
        add(walk, (RtCrossover){x, x, walk->side, side});
    }
    walk->side = side;
}

uint32_t rt_claim_crossovers(const RtClaimPoint *points, uint32_t count,
                             RtCrossover crossovers[RT_MAX_CROSSOVERS]) {
    Walk walk = {.crossovers = crossovers};
    if (count < 2 || !all_have_logarithms(points, count)) return 0;
    for (uint32_t i = 0; i + 1 < count; i++) {
        const RtClaimPoint *p = &points[i];
        const double a = root(p[0].y.low, p[1].y.low), b = root(p[0].y.high, p[1].y.high);
        const double cuts[] = {0, fmin(a, b), fmax(a, b), 1};
        for (int k = 0; k < 3; k++) {
            const int side = side_at(p, 0.5 * (cuts[k] + cuts[k + 1]));
            if (cuts[k] == cuts[k + 1]) continue;
            if (i == 0 && k == 0) walk.side = side; /* before it: nothing is known */
            enter(&walk, x_at(p, cuts[k]), side);
        }
    }
    walk.open.high = INFINITY;
    if (walk.side == 0) add(&walk, walk.open);
    return walk.count;
}

double rt_claim_median_crossover(const RtClaimPoint *points, uint32_t count, const RtCrossover *crossover,
                                 double after) {
    for (uint32_t i = 0; i < count; i++) {
        const RtClaimPoint *p = &points[i];
        const double at = i + 1 < count ? root(p[0].y.median, p[1].y.median) : 1;
        const double x = p->y.median == 1 ? p->x : at < 1 ? x_at(p, at) : 0;
        if (x > after && x >= crossover->low && x <= crossover->high) return x;
    }
    return (double)NAN;
}
