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

static RtEstimate quotient(const RtEstimate *over, const RtEstimate *under) {
    return (RtEstimate){.median = over->median / under->median,
                        .low = over->low / under->high,
                        .high = over->high / under->low};
}

/* The rays from which on it is ahead. If it is ahead up to some number, that is never; up to any, from 0. */
static RtEstimate break_even(const RtResults *results, uint32_t t, uint32_t c) {
    const RtBreakEven even = rt_results_break_even(results, t, c);
    const double never = (double)INFINITY;
    if (!even.up_to) return even.rays;
    return (RtEstimate){.median = isinf(even.rays.median) ? 0 : never,
                        .low = isinf(even.rays.high) ? 0 : never,
                        .high = isinf(even.rays.low) ? 0 : never};
}

/* The rays of a whole set, or of all sets; NAN if they are unknown. */
static double whole_rays(const RtResults *results, uint32_t t, RtRayKind kind) {
    const RtExperiment *experiment = results->experiment;
    double sum = 0;
    for (uint32_t k = 0; k < experiment->kind_count; k++) {
        if (kind == RT_ALL_RAYS || kind == experiment->kinds[k])
            sum += rt_results_weight(results, t, experiment->kinds[k]);
    }
    return sum > 0 ? sum : (double)NAN;
}

static RtEstimate structure_value(const RtResults *results, RtClaimMeasure measure, uint32_t t, uint32_t c) {
    const RtBuildResult *build = rt_build_at(results, t, c);
    const RtDescription *structure = &build->structure;
    double value = (double)NAN;
    if (!build->known) return rt_estimate_exactly(value);
    switch (measure) {
    case RT_CLAIM_BUILD_TIME: return build->seconds;
    case RT_CLAIM_BREAK_EVEN: return break_even(results, t, c);
    case RT_CLAIM_RENDER_TIME:
        return build->render.known ? build->render.seconds : rt_estimate_exactly(value);
    case RT_CLAIM_QUERY_SHARE: return build->render.known ? build->render.share : rt_estimate_exactly(value);
    case RT_CLAIM_BYTES: value = (double)structure->bytes; break;
    case RT_CLAIM_PREDICTED_COST: value = structure->predicted_cost; break;
    case RT_CLAIM_INTERIOR: value = (double)structure->interior; break;
    case RT_CLAIM_LEAVES: value = (double)structure->leaves; break;
    case RT_CLAIM_EMPTY_LEAVES: value = (double)structure->empty_leaves; break;
    case RT_CLAIM_REFERENCES: value = (double)structure->references; break;
    default: value = (double)structure->depth;
    }
    return rt_estimate_exactly(value);
}

/* A measure of a cell of one kind of rays, or of RT_ALL_RAYS. */
static RtEstimate value_at(const RtClaimCase *of, RtClaimMeasure measure, const RtClaimCell *cell) {
    const RtResults *results = of->results;
    const uint32_t t = cell->workload, c = cell->candidate;
    const double rays = whole_rays(results, t, RT_ALL_RAYS);
    if (rt_claim_subject(measure) == RT_SUBJECT_STRUCTURE) return structure_value(results, measure, t, c);
    if (measure == RT_CLAIM_TIME) return rt_results_time(results, t, c, cell->kind, of->coverage);
    if (measure == RT_CLAIM_FRAME_TIME) {
        const RtEstimate mean = rt_results_time(results, t, c, RT_ALL_RAYS, of->coverage);
        return (RtEstimate){rays * mean.median, rays * mean.low, rays * mean.high, rays * mean.least};
    }
    if (measure == RT_CLAIM_OBJECTS)
        return rt_estimate_exactly(results->workloads[t].known ? results->workloads[t].objects : (double)NAN);
    if (measure == RT_CLAIM_RAY_COUNT) return rt_estimate_exactly(whole_rays(results, t, cell->kind));
    if (measure == RT_CLAIM_SHARE) return rt_estimate_exactly(whole_rays(results, t, cell->kind) / rays);
    const RtCost cost = rt_results_cost(results, t, c, cell->kind);
    const double counts[] = {[RT_CLAIM_OBJECT_TESTS] = cost.object_tests,
                             [RT_CLAIM_EXTENT_TESTS] = cost.extent_tests,
                             [RT_CLAIM_STEPS] = cost.steps,
                             [RT_CLAIM_CSG_TESTS] = cost.csg_tests,
                             [RT_CLAIM_HITS] = cost.hits};
    return rt_estimate_exactly(cost.whole ? counts[measure] : (double)NAN);
}

RtEstimate rt_claim_ratio(const RtClaimCase *of, RtClaimMeasure over, const RtClaimCell *a,
                          RtClaimMeasure under, const RtClaimCell *b) {
    const bool same = over == under && a->workload == b->workload && a->kind == b->kind;
    if (same && (over == RT_CLAIM_TIME || over == RT_CLAIM_FRAME_TIME))
        return rt_results_time_ratio(of->results, a->workload, a->candidate, b->candidate,
                                     over == RT_CLAIM_TIME ? a->kind : RT_ALL_RAYS, of->coverage);
    const RtEstimate one = value_at(of, over, a), other = value_at(of, under, b);
    return same && a->candidate == b->candidate ? rt_estimate_exactly(one.median / one.median)
                                                : quotient(&one, &other);
}

/* ---- the cells of a claim ---- */

/* The second side's cell of a cell of the first; false if it is not measured. */
static bool find_other(const RtExperiment *experiment, const RtClaim *claim, const RtClaimCell *cell,
                       RtClaimCell *other) {
    *other = *cell;
    if (rt_claim_partner(experiment, claim, cell, other) == 0 ||
        !rt_candidate_runs(experiment, other->candidate, other->workload))
        return false;
    if (!*claim->second.accel) other->candidate = cell->candidate;
    return true;
}

static bool is_called(const RtExperiment *experiment, const RtClaim *claim, uint32_t c) {
    const char *accel = claim->first.accel;
    if (!*accel && claim->form != RT_CLAIM_LEAST) return c == experiment->baseline;
    if (*accel && strcmp(accel, RT_CLAIM_ALL) != 0)
        return rt_candidate_is_called(&experiment->candidates[c], accel);
    return !experiment->candidates[c].tried && experiment->candidates[c].entry != UINT32_MAX;
}

static bool is_about(const RtExperiment *experiment, const RtClaim *claim, const RtClaimCell *cell) {
    const uint32_t t = cell->workload, c = cell->candidate;
    RtClaimCell other;
    if (!is_called(experiment, claim, c)) return false;
    if (!rt_candidate_runs(experiment, c, t)) return false;
    if (!rt_claim_side_has(experiment, &claim->first, t, c)) return false;
    const bool all = rt_claim_has_two_sides(claim) && strcmp(claim->first.accel, RT_CLAIM_ALL) == 0;
    return !all || !find_other(experiment, claim, cell, &other) || memcmp(&other, cell, sizeof other) != 0;
}

/* Whether a measured structure has no such value: no prediction, no counts, or it is the baseline. */
static bool lacks(const RtResults *results, RtClaimMeasure measure, uint32_t t, uint32_t c) {
    const RtBuildResult *build = rt_build_at(results, t, c);
    if (!build->known) return false;
    if (measure == RT_CLAIM_PREDICTED_COST) return isnan(build->structure.predicted_cost);
    if (measure == RT_CLAIM_BREAK_EVEN) return rt_candidate_is_baseline(results->experiment, c);
    return measure > RT_CLAIM_TIME && measure < RT_CLAIM_FRAME_TIME && !build->counts;
}

/* Whether `is fastest` and the like compare candidate `c` on workload `t`. Not with one that refused it, the
 * yardstick, members that only a best-of tries, and best-ofs in what structures have. */
static bool is_ranked(const RtClaimCase *of, uint32_t t, uint32_t c) {
    const RtExperiment *experiment = of->results->experiment;
    const RtCandidate *candidate = &experiment->candidates[c];
    const RtClaimMeasure measure = of->claim->first.measure;
    return rt_candidate_runs(experiment, c, t) && !rt_results_refused(of->results, t, c) &&
           strcmp(candidate->spec, rt_accel_yardstick()) != 0 && !candidate->tried &&
           !(candidate->member_count > 0 && rt_claim_subject(measure) == RT_SUBJECT_STRUCTURE) &&
           !lacks(of->results, measure, t, c);
}

/* Whether both are the same cell: a best-of and what it chose. */
static bool same_cell(const RtClaimCase *of, const RtClaimCell *cell, uint32_t c) {
    const RtExperiment *e = of->results->experiment;
    if (c == cell->candidate) return true;
    if (cell->kind == RT_ALL_RAYS)
        return rt_candidate_is_member(e, c, cell->candidate) || rt_candidate_is_member(e, cell->candidate, c);
    return rt_results_candidate(of->results, cell->workload, c, cell->kind) ==
           rt_results_candidate(of->results, cell->workload, cell->candidate, cell->kind);
}

/* The x of a cell; false if the claim excludes it. */
static bool abscissa(const RtClaimCase *of, const RtClaimCell *cell, double *x) {
    const RtResults *results = of->results;
    const RtClaim *claim = of->claim;
    const uint32_t t = cell->workload, c = cell->candidate;
    *x = 1;
    if (claim->form == RT_CLAIM_CORRELATION) {
        *x = value_at(of, claim->first.measure, cell).median;
        bool all = strcmp(claim->first.accel, RT_CLAIM_ALL) == 0;
        return !(all &&
                 (lacks(results, claim->first.measure, t, c) || lacks(results, claim->second.measure, t, c)));
    }
    if (claim->by_objects) {
        *x = value_at(of, RT_CLAIM_OBJECTS, cell).median;
        return true;
    }
    const char *value = claim->key.key ? rt_swept_of(results->experiment, &claim->key, t, c) : "1";
    return value && rt_swept_number(value, x);
}

/* UINT64_MAX for measures that no number of rays makes surer. */
static uint64_t rays_of(const RtClaimCase *of, RtClaimMeasure measure, const RtClaimCell *cell) {
    const RtClaimSubject subject = rt_claim_subject(measure);
    const bool all = measure == RT_CLAIM_BREAK_EVEN || subject == RT_SUBJECT_FRAME;
    if (subject != RT_SUBJECT_RAYS && measure != RT_CLAIM_HITS && !all) return UINT64_MAX;
    return rt_results_cost(of->results, cell->workload, cell->candidate, all ? RT_ALL_RAYS : cell->kind).rays;
}

static bool has_other(const RtClaim *claim) {
    return rt_claim_has_two_sides(claim) || (claim->form == RT_CLAIM_LEAST && *claim->first.accel);
}

/* Sets rays and y of a point whose cells are known. */
static void set_values(const RtClaimCase *of, RtClaimPoint *point) {
    const RtClaim *claim = of->claim;
    const bool correlation = claim->form == RT_CLAIM_CORRELATION, two = has_other(claim);
    const RtClaimMeasure first = claim->first.measure, second = rt_claim_has_two_sides(claim) || correlation
                                                                    ? claim->second.measure
                                                                    : first;
    const uint64_t own = rays_of(of, first, &point->at),
                   its = two && !point->found ? own : rays_of(of, second, &point->other);
    point->rays = own < its ? own : its;
    point->y = !two            ? value_at(of, second, &point->at)
               : !point->found ? rt_estimate_exactly((double)NAN)
                               : rt_claim_ratio(of, first, &point->at, second, &point->other);
}

/* Whether the scene has rays of that kind, as far as is known. */
static bool has_rays(const RtResults *results, uint32_t t, RtRayKind kind) {
    return !results->workloads[t].known || results->workloads[t].rays[kind] > 0;
}

/* One point of a cell; of a comparison with all others one for each of them. */
static uint32_t add_points(const RtClaimCase *of, const RtClaimCell *cell, RtClaimPoint *points) {
    const RtExperiment *experiment = of->results->experiment;
    const RtClaim *claim = of->claim;
    const bool readout = claim->form == RT_CLAIM_LEAST && !*claim->first.accel,
               ranks = claim->form == RT_CLAIM_LEAST && !readout;
    RtClaimPoint point = {.at = *cell, .other = *cell, .found = true};
    uint32_t count = 0;
    if (!is_about(experiment, claim, cell) || !abscissa(of, cell, &point.x)) return 0;
    if (readout && !is_ranked(of, cell->workload, cell->candidate)) return 0;
    for (uint32_t c = 0; c < (ranks ? experiment->candidate_count : 1); c++) {
        if (ranks) point.other.candidate = c;
        if (ranks && (same_cell(of, cell, c) || !is_ranked(of, cell->workload, c))) continue;
        if (points && rt_claim_has_two_sides(claim))
            point.found = find_other(experiment, claim, cell, &point.other);
        if (points) set_values(of, &point);
        if (points) points[count] = point;
        count++;
    }
    return count;
}

/* Those of one kind of rays, or of RT_ALL_RAYS. */
static uint32_t gather_kind(const RtClaimCase *of, RtRayKind kind, RtClaimPoint *points) {
    const RtExperiment *experiment = of->results->experiment;
    const RtClaimSide *first = &of->claim->first;
    uint32_t count = 0;
    for (uint32_t t = 0; t < experiment->workload_count; t++) {
        if (first->each_kind && !has_rays(of->results, t, kind)) continue;
        for (uint32_t c = 0; c < experiment->candidate_count; c++) {
            const RtClaimCell cell = {t, c, kind};
            count += add_points(of, &cell, points ? points + count : NULL);
        }
    }
    return count;
}

uint32_t rt_claim_gather(const RtClaimCase *of, RtClaimPoint *points) {
    const RtExperiment *experiment = of->results->experiment;
    uint32_t count = 0;
    if (!of->claim->first.each_kind) return gather_kind(of, of->claim->first.kind, points);
    for (uint32_t k = 0; k < experiment->kind_count; k++)
        count += gather_kind(of, experiment->kinds[k], points ? points + count : NULL);
    return count;
}

static bool is_measured(const RtResults *results, RtClaimMeasure measure, const RtClaimCell *cell) {
    const uint32_t t = cell->workload;
    const RtClaimSubject subject = rt_claim_subject(measure);
    if (subject == RT_SUBJECT_STRUCTURE) return rt_build_at(results, t, cell->candidate)->known;
    if (subject >= RT_SUBJECT_SET && measure != RT_CLAIM_HITS)
        return !isnan(whole_rays(results, t, RT_ALL_RAYS));
    for (int k = 0; k < RT_RAY_KIND_COUNT; k++) {
        const RtRayKind kind = (RtRayKind)k;
        const uint32_t measured = rt_results_candidate(results, t, cell->candidate, kind);
        if ((cell->kind == RT_ALL_RAYS || cell->kind == kind) &&
            rt_cell_at(results, t, measured, kind)->counted)
            return true;
    }
    return false;
}

bool rt_claim_any_measured(const RtResults *results, const RtClaim *claim, const RtClaimPoint *points,
                           uint32_t count) {
    const RtClaimMeasure second =
        claim->form == RT_CLAIM_LEAST ? claim->first.measure : claim->second.measure;
    for (uint32_t i = 0; i < count; i++) {
        const RtClaimPoint *p = &points[i];
        if (p->found && is_measured(results, claim->first.measure, &p->at) &&
            (!has_other(claim) || is_measured(results, second, &p->other)))
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
    if (a->at.kind != b->at.kind) return false;
    for (int i = 0; i < 2; i++) {
        const RtWorkload *workload = &experiment->workloads[points[i]->at.workload];
        names[i][0] = '\0';
        if (!claim->by_objects) {
            snprintf(names[i], sizeof names[i], "%s ", workload->stem);
            rt_swept_name(&workload->swept, claim->key.scene ? claim->key.key : NULL, names[i],
                          sizeof names[i]);
        }
        const RtCandidate *candidate = &experiment->candidates[points[i]->at.candidate];
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
    return (p->at.workload > q->at.workload) - (p->at.workload < q->at.workload);
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
            is_called(e, claim, at.candidate) || rt_candidate_is_called(candidate, claim->second.accel);
        const char *scene = claim->first.scene;
        const bool here = !*scene || rt_workload_is_called(&e->workloads[at.workload], scene);
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

/* ---- means ---- */

RtEstimate rt_claim_mean(const RtClaimPoint *points, uint32_t count) {
    RtEstimate logs = {0};
    if (!all_have_logarithms(points, count)) return rt_estimate_exactly((double)NAN);
    for (uint32_t i = 0; i < count; i++) {
        logs.median += rt_log(points[i].y.median) / count;
        logs.low += rt_log(points[i].y.low) / count;
        logs.high += rt_log(points[i].y.high) / count;
    }
    const double e = 2.718281828459045;
    return (RtEstimate){rt_power(e, logs.median), rt_power(e, logs.low), rt_power(e, logs.high), -1};
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
