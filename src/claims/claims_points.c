/* SPDX-License-Identifier: Apache-2.0 */
#include "claims/claims_points.h"

#include "core/base/elementary.h"
#include "core/base/words.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

bool rt_claim_point_known(const RtClaimPoint *point) {
    return !isnan(point->x) && !isnan(point->y.median);
}

/* ---- values ---- */

/* The rays from which on it is ahead. If it is ahead up to some number, that is never; up to any, from 0. */
static RtEstimate break_even(const RtResults *results, uint32_t t, uint32_t c) {
    const RtBreakEven even = rt_results_break_even(results, t, c);
    const double never = (double)INFINITY;
    if (!even.up_to) return even.rays;
    return (RtEstimate){.median = isinf(even.rays.median) ? 0 : never,
                        .low = isinf(even.rays.high) ? 0 : never,
                        .high = isinf(even.rays.low) ? 0 : never};
}

/* A measure of a cell of one kind of rays, or of RT_ALL_RAYS. */
static RtEstimate value_at(const RtClaimCase *of, RtClaimMeasure measure, RtRayKind kind, uint32_t t,
                           uint32_t c) {
    const RtResults *results = of->results;
    const RtEstimate unknown = rt_estimate_exactly((double)NAN);
    if (measure >= RT_CLAIM_BUILD_TIME) {
        const RtBuildResult *build = rt_build_at(results, t, c);
        if (!build->known) return unknown;
        if (measure == RT_CLAIM_BUILD_TIME) return build->seconds;
        if (measure >= RT_CLAIM_RENDER_TIME && !build->render.known) return unknown;
        if (measure == RT_CLAIM_RENDER_TIME) return build->render.seconds;
        if (measure == RT_CLAIM_QUERY_SHARE) return build->render.share;
        if (measure == RT_CLAIM_BREAK_EVEN) return break_even(results, t, c);
        return rt_estimate_exactly(measure == RT_CLAIM_BYTES ? (double)build->structure.bytes
                                                             : build->structure.predicted_cost);
    }
    if (measure == RT_CLAIM_TIME) return rt_results_time(results, t, c, kind, of->coverage);
    const RtCost cost = rt_results_cost(results, t, c, kind);
    const double counts[] = {[RT_CLAIM_OBJECT_TESTS] = cost.object_tests,
                             [RT_CLAIM_EXTENT_TESTS] = cost.extent_tests,
                             [RT_CLAIM_STEPS] = cost.steps,
                             [RT_CLAIM_CSG_TESTS] = cost.csg_tests};
    return cost.whole ? rt_estimate_exactly(counts[measure]) : unknown;
}

/* The accelerator that `c` is compared with on workload `t`; false if it is not measured there. */
static bool find_other(const RtExperiment *experiment, const RtClaim *claim, uint32_t t, uint32_t c,
                       uint32_t *other) {
    for (*other = 0; *other < experiment->candidate_count; ++*other) {
        if (rt_candidate_runs(experiment, *other, t) && rt_claim_is_other(experiment, claim, t, c, *other))
            return true;
    }
    return false;
}

static RtEstimate ratio_at(const RtClaimCase *of, RtRayKind kind, uint32_t t, uint32_t c, uint32_t other) {
    const RtClaimMeasure measure = of->claim->measure;
    if (measure == RT_CLAIM_TIME) return rt_results_time_ratio(of->results, t, c, other, kind, of->coverage);
    const RtEstimate over = value_at(of, measure, kind, t, c);
    if (other == c) return rt_estimate_exactly(over.median / over.median);
    const RtEstimate under = value_at(of, measure, kind, t, other);
    return (RtEstimate){
        .median = over.median / under.median, .low = over.low / under.high, .high = over.high / under.low};
}

/* ---- the cells of a claim ---- */

static bool is_called(const RtExperiment *experiment, const RtClaim *claim, uint32_t c) {
    if (strcmp(claim->accel, RT_CLAIM_ALL) != 0)
        return rt_candidate_is_called(&experiment->candidates[c], claim->accel);
    return !experiment->candidates[c].tried && experiment->candidates[c].entry != UINT32_MAX;
}

static bool is_about(const RtExperiment *experiment, const RtClaim *claim, uint32_t t, uint32_t c) {
    if (!is_called(experiment, claim, c)) return false;
    if (!rt_candidate_runs(experiment, c, t)) return false;
    if (*claim->scene && !rt_workload_is_called(&experiment->workloads[t], claim->scene)) return false;
    for (uint32_t p = 0; p < claim->place_count; p++) {
        const char *value = rt_swept_of(experiment, &claim->places[p].key, t, c);
        if (!value || !rt_swept_equal(value, claim->places[p].value)) return false;
    }
    uint32_t other;
    const bool all = claim->form == RT_CLAIM_CROSSOVER && strcmp(claim->accel, RT_CLAIM_ALL) == 0;
    return !all || !find_other(experiment, claim, t, c, &other) || other != c;
}

/* Whether a measured structure has no such value: no prediction, no counts, or it is the baseline. */
static bool lacks(const RtResults *results, RtClaimMeasure measure, uint32_t t, uint32_t c) {
    const RtBuildResult *build = rt_build_at(results, t, c);
    if (!build->known) return false;
    if (measure == RT_CLAIM_PREDICTED_COST) return isnan(build->structure.predicted_cost);
    if (measure == RT_CLAIM_BREAK_EVEN) return rt_candidate_is_baseline(results->experiment, c);
    return measure > RT_CLAIM_TIME && measure < RT_CLAIM_BUILD_TIME && !build->counts;
}

/* The x of a cell; false if the claim excludes it. */
static bool abscissa(const RtClaimCase *of, RtRayKind kind, uint32_t t, uint32_t c, double *x) {
    const RtResults *results = of->results;
    const RtClaim *claim = of->claim;
    *x = 0;
    if (claim->form == RT_CLAIM_CORRELATION) {
        *x = value_at(of, claim->first, kind, t, c).median;
        bool all = strcmp(claim->accel, RT_CLAIM_ALL) == 0;
        return !(all && (lacks(results, claim->first, t, c) || lacks(results, claim->measure, t, c)));
    }
    if (claim->by_objects) {
        const RtWorkloadResult *workload = &results->workloads[t];
        *x = workload->known ? (double)workload->objects : (double)NAN;
        return true;
    }
    const char *value = claim->key.key ? rt_swept_of(results->experiment, &claim->key, t, c) : "0";
    return value && rt_swept_number(value, x);
}

static uint64_t rays_of(const RtClaimCase *of, RtRayKind kind, uint32_t t, uint32_t c) {
    const bool all = of->claim->measure == RT_CLAIM_BREAK_EVEN;
    if (!rt_claim_is_of_rays(of->claim) && !all) return UINT64_MAX;
    return rt_results_cost(of->results, t, c, all ? RT_ALL_RAYS : kind).rays;
}

static void set_values(const RtClaimCase *of, RtClaimPoint *point) {
    const RtClaim *claim = of->claim;
    const uint32_t t = point->workload, c = point->candidate;
    uint32_t other = c;
    const bool found = !*claim->other || find_other(of->results->experiment, claim, t, c, &other);
    const uint64_t own = rays_of(of, point->kind, t, c),
                   its = found ? rays_of(of, point->kind, t, other) : own;
    point->rays = own < its ? own : its;
    point->y = !found          ? rt_estimate_exactly((double)NAN)
               : *claim->other ? ratio_at(of, point->kind, t, c, other)
                               : value_at(of, claim->measure, point->kind, t, c);
}

/* Whether the scene has rays of that kind, as far as is known. */
static bool has_rays(const RtResults *results, uint32_t t, RtRayKind kind) {
    return !results->workloads[t].known || results->workloads[t].rays[kind] > 0;
}

/* Those of one kind of rays, or of RT_ALL_RAYS. */
static uint32_t gather_kind(const RtClaimCase *of, RtRayKind kind, RtClaimPoint *points) {
    const RtExperiment *experiment = of->results->experiment;
    const RtClaim *claim = of->claim;
    uint32_t count = 0;
    for (uint32_t t = 0; t < experiment->workload_count; t++) {
        if (claim->each_kind && !has_rays(of->results, t, kind)) continue;
        for (uint32_t c = 0; c < experiment->candidate_count; c++) {
            RtClaimPoint point = {.workload = t, .candidate = c, .kind = kind};
            if (!is_about(experiment, claim, t, c) || !abscissa(of, kind, t, c, &point.x)) continue;
            if (points) set_values(of, &point);
            if (points) points[count] = point;
            count++;
        }
    }
    return count;
}

uint32_t rt_claim_gather(const RtClaimCase *of, RtClaimPoint *points) {
    const RtExperiment *experiment = of->results->experiment;
    uint32_t count = 0;
    if (!of->claim->each_kind) return gather_kind(of, of->claim->kind, points);
    for (uint32_t k = 0; k < experiment->kind_count; k++)
        count += gather_kind(of, experiment->kinds[k], points ? points + count : NULL);
    return count;
}

static bool is_measured(const RtResults *results, const RtClaim *claim, RtRayKind asked, uint32_t t,
                        uint32_t c) {
    if (claim->measure >= RT_CLAIM_BUILD_TIME) return rt_build_at(results, t, c)->known;
    for (int k = 0; k < RT_RAY_KIND_COUNT; k++) {
        const RtRayKind kind = (RtRayKind)k;
        const uint32_t measured = rt_results_candidate(results, t, c, kind);
        if ((asked == RT_ALL_RAYS || asked == kind) && rt_cell_at(results, t, measured, kind)->counted)
            return true;
    }
    return false;
}

bool rt_claim_any_measured(const RtResults *results, const RtClaim *claim, const RtClaimPoint *points,
                           uint32_t count) {
    for (uint32_t i = 0; i < count; i++) {
        const RtClaimPoint *p = &points[i];
        uint32_t other = p->candidate;
        bool found = !*claim->other || find_other(results->experiment, claim, p->workload, other, &other);
        if (found && is_measured(results, claim, p->kind, p->workload, p->candidate) &&
            is_measured(results, claim, p->kind, p->workload, other))
            return true;
    }
    return false;
}

/* ---- lines ---- */

/* Whether two points differ only in the parameter. */
static bool same_line(const RtExperiment *experiment, const RtClaim *claim, const RtClaimPoint *a,
                      const RtClaimPoint *b) {
    enum { ROOM = RT_MAX_LABEL + RT_MAX_SWEPT * (RT_MAX_NAME + RT_MAX_SWEPT_CHARS + 2) };
    char names[2][2 * ROOM];
    const RtClaimPoint *points[] = {a, b};
    if (a->kind != b->kind) return false;
    for (int i = 0; i < 2; i++) {
        const RtWorkload *workload = &experiment->workloads[points[i]->workload];
        names[i][0] = '\0';
        if (!claim->by_objects) {
            snprintf(names[i], sizeof names[i], "%s ", workload->stem);
            rt_swept_name(&workload->swept, claim->key.scene ? claim->key.key : NULL, names[i],
                          sizeof names[i]);
        }
        const RtCandidate *candidate = &experiment->candidates[points[i]->candidate];
        rt_append_text(names[i], sizeof names[i], " %s", candidate->stem);
        rt_swept_name(&candidate->swept, claim->key.scene ? NULL : claim->key.key, names[i], sizeof names[i]);
    }
    return strcmp(names[0], names[1]) == 0;
}

/* Scenes may have equally many objects; unknown numbers come first. */
static int by_x(const void *a, const void *b) {
    const RtClaimPoint *p = a, *q = b;
    if (isnan(p->x) != isnan(q->x)) return isnan(p->x) ? -1 : 1;
    if (p->x != q->x && !isnan(p->x)) return p->x < q->x ? -1 : 1;
    return (p->workload > q->workload) - (p->workload < q->workload);
}

uint32_t rt_claim_line(const RtExperiment *experiment, const RtClaim *claim, RtClaimPoint *points,
                       uint32_t count) {
    uint32_t end = 1;
    for (uint32_t i = end; i < count; i++) {
        if (!same_line(experiment, claim, &points[0], &points[i])) continue;
        RtClaimPoint point = points[i];
        points[i] = points[end];
        points[end++] = point;
    }
    qsort(points, end, sizeof *points, by_x);
    return end;
}

const char *rt_claim_refusal(const RtResults *results, const RtClaim *claim) {
    const RtExperiment *e = results->experiment;
    for (RtCellCursor at = {0}; rt_results_next(results, &at);) {
        const RtCandidate *candidate = &e->candidates[at.candidate];
        const RtBuildResult *build = rt_build_at(results, at.workload, at.candidate);
        const bool named =
            is_called(e, claim, at.candidate) || rt_candidate_is_called(candidate, claim->other);
        const bool here = !*claim->scene || rt_workload_is_called(&e->workloads[at.workload], claim->scene);
        if (build->refused && named && here) return build->left_out;
    }
    return NULL;
}

/* ---- figures ---- */

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
