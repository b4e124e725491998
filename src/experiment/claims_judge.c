/* SPDX-License-Identifier: Apache-2.0 */
/* Judging claims: the cells of a claim, their values with intervals, and the verdict over all of them. */
#include "experiment/claims.h"

#include "core/base/elementary.h"
#include "core/base/memory.h"
#include "core/base/words.h"
#include "core/text/table.h"

#include <assert.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A value of the claim's measure, and its cell. */
typedef struct Point {
    uint32_t workload, candidate;
    double x; /* of the parameter of an exponent or a trend */
    RtEstimate y;
} Point;

static const RtEstimate UNKNOWN = {NAN, NAN, NAN, NAN};

const char *rt_claim_verdict_name(RtClaimVerdict verdict) {
    static const char *const names[] = {"holds", "undecided", "does not hold", "no measurements"};
    return names[verdict];
}

/* ---- values ---- */

static RtEstimate exactly(double value) {
    return (RtEstimate){value, value, value, value};
}

static RtEstimate value_at(const RtResults *results, const RtClaim *claim, uint32_t t, uint32_t c) {
    const RtBuildResult *build = rt_build_at(results, t, c);
    const RtCost cost = rt_results_cost(results, t, c, claim->kind);
    const double counts[] = {0, cost.object_tests, cost.extent_tests, cost.steps};
    if (claim->measure >= RT_CLAIM_BUILD_TIME && !build->known) return UNKNOWN;
    if (claim->measure == RT_CLAIM_BUILD_TIME) return build->seconds;
    if (claim->measure == RT_CLAIM_BYTES) return exactly((double)build->structure.bytes);
    if (!cost.whole) return UNKNOWN;
    return claim->measure == RT_CLAIM_TIME ? cost.seconds : exactly(counts[claim->measure]);
}

/* The time of `c` over that of `other`, from ratios of throughput paired by round. */
static bool paired(const RtResults *results, const RtClaim *claim, uint32_t t, uint32_t c, RtEstimate *out) {
    const RtExperiment *experiment = results->experiment;
    const bool all = claim->kind == RT_ALL_RAYS;
    RtRayKind kind = all ? experiment->kinds[0] : claim->kind;
    if (claim->measure != RT_CLAIM_TIME || (all && experiment->kind_count > 1)) return false;
    const RtCell *own = rt_cell_at(results, t, c, kind), *other = rt_cell_at(results, t, claim->other, kind);
    if (!own->timed || !other->timed) return false;
    if (own->baseline == claim->other) {
        *out = (RtEstimate){
            .median = 1 / own->ratio.median, .low = 1 / own->ratio.high, .high = 1 / own->ratio.low};
        return true;
    }
    *out = other->ratio;
    return other->baseline == c;
}

static RtEstimate ratio_at(const RtResults *results, const RtClaim *claim, uint32_t t, uint32_t c) {
    RtEstimate ratio;
    if (paired(results, claim, t, c, &ratio)) return ratio;
    RtEstimate over = value_at(results, claim, t, c), under = value_at(results, claim, t, claim->other);
    return (RtEstimate){
        .median = over.median / under.median, .low = over.low / under.high, .high = over.high / under.low};
}

/* ---- the cells of a claim ---- */

static bool is_about(const RtExperiment *experiment, const RtClaim *claim, uint32_t t, uint32_t c) {
    if (!rt_candidate_runs(experiment, c, t)) return false;
    if (!rt_candidate_is_called(&experiment->candidates[c], claim->accel)) return false;
    if (*claim->scene && !rt_workload_is_called(&experiment->workloads[t], claim->scene)) return false;
    for (uint32_t p = 0; p < claim->place_count; p++) {
        const char *value = rt_swept_of(experiment, &claim->places[p].key, t, c);
        if (!value || strcmp(value, claim->places[p].value) != 0) return false;
    }
    return true;
}

/* Whether two points lie on one line: they differ only in the parameter. */
static bool same_line(const RtExperiment *experiment, const RtClaim *claim, const Point *a, const Point *b) {
    enum { ROOM = RT_MAX_LABEL + RT_MAX_SWEPT * (RT_MAX_NAME + RT_MAX_SWEPT_CHARS + 2) };
    char names[2][2 * ROOM];
    const Point *points[] = {a, b};
    for (int i = 0; i < 2; i++) {
        const RtCandidate *candidate = &experiment->candidates[points[i]->candidate];
        const RtWorkload *workload = &experiment->workloads[points[i]->workload];
        snprintf(names[i], sizeof names[i], "%s %s", candidate->stem, workload->stem);
        rt_swept_name(&candidate->swept, claim->key.scene ? NULL : claim->key.key, names[i], sizeof names[i]);
        rt_swept_name(&workload->swept, claim->key.scene ? claim->key.key : NULL, names[i], sizeof names[i]);
    }
    return strcmp(names[0], names[1]) == 0;
}

/* Writes the cells of a claim to points[0..]; returns their number. Unknown values are not finite. */
static uint32_t gather(const RtResults *results, const RtClaim *claim, Point *points) {
    const RtExperiment *experiment = results->experiment;
    bool lines = claim->form >= RT_CLAIM_EXPONENT;
    uint32_t count = 0;
    for (uint32_t t = 0; t < experiment->workload_count; t++) {
        for (uint32_t c = 0; c < experiment->candidate_count; c++) {
            Point point = {.workload = t, .candidate = c};
            const char *x = lines ? rt_swept_of(experiment, &claim->key, t, c) : "0";
            if (!is_about(experiment, claim, t, c) || !x) continue;
            rt_swept_number(x, &point.x);
            point.y = claim->form == RT_CLAIM_RATIO ? ratio_at(results, claim, t, c)
                                                    : value_at(results, claim, t, c);
            points[count++] = point;
        }
    }
    return count;
}

static int by_x(const void *a, const void *b) {
    const Point *p = a, *q = b;
    return (p->x > q->x) - (p->x < q->x);
}

/* ---- verdicts ---- */

#define PUT(result, ...) rt_append_text((result)->figures, RT_MAX_CLAIM_FIGURES, __VA_ARGS__)

static double in_units(const RtClaim *claim, double value) {
    bool time =
        claim->measure == RT_CLAIM_TIME && (claim->form == RT_CLAIM_VALUE || claim->form == RT_CLAIM_TREND);
    return time ? 1e9 * value : value;
}

static void put_estimate(RtClaimResult *result, const RtClaim *claim, const RtEstimate *b) {
    char value[16], low[16], high[16];
    rt_format_figure(in_units(claim, b->median), value);
    rt_format_figure(in_units(claim, b->low), low);
    rt_format_figure(in_units(claim, b->high), high);
    PUT(result, "%s", isfinite(b->median) ? value : "unknown");
    if (isfinite(b->median) && b->low != b->high) PUT(result, " [%s, %s]", low, high);
}

static void put_place(RtClaimResult *result, const RtExperiment *experiment, const Point *point, bool line) {
    assert(point);
    const RtCandidate *candidate = &experiment->candidates[point->candidate];
    const RtWorkload *workload = &experiment->workloads[point->workload];
    PUT(result, " (%s on %s)", line ? candidate->stem : candidate->label,
        line ? workload->stem : workload->label);
}

static bool compares(const RtClaim *claim, double value) {
    if (value == claim->number) return claim->or_equal;
    return claim->greater ? value > claim->number : value < claim->number;
}

static RtClaimVerdict compare(const RtClaim *claim, const RtEstimate *b) {
    bool low = compares(claim, in_units(claim, b->low)), high = compares(claim, in_units(claim, b->high));
    return low && high ? RT_CLAIM_HOLDS : low || high ? RT_CLAIM_UNDECIDED : RT_CLAIM_FALSE;
}

/* The worst figure so far: the worst verdict, and among equal verdicts the figure furthest off. */
typedef struct Worst {
    RtClaimVerdict verdict;
    const Point *point; /* or NULL */
    RtEstimate figure;
} Worst;

static void take(const RtClaim *claim, const Point *point, const RtEstimate *figure, Worst *worst) {
    RtClaimVerdict verdict = isfinite(figure->median) ? compare(claim, figure) : RT_CLAIM_UNDECIDED;
    bool further = worst->point && (claim->greater ? figure->median < worst->figure.median
                                                   : figure->median > worst->figure.median);
    if (worst->point && verdict <= worst->verdict && !(verdict == worst->verdict && further)) return;
    *worst = (Worst){verdict, point, *figure};
}

/* Least-squares slope of log y over log x; points[0..count) is one line. Unknown if any point is: the others
 * may have another slope. */
static RtEstimate exponent_of(const Point *points, uint32_t count) {
    double mean = 0, squares = 0;
    RtEstimate slope = {0};
    for (uint32_t i = 0; i < count; i++) {
        if (!(points[i].x > 0 && points[i].y.low > 0)) return UNKNOWN;
        mean += rt_log(points[i].x) / count;
    }
    for (uint32_t i = 0; i < count; i++) {
        double d = rt_log(points[i].x) - mean;
        squares += d * d;
    }
    for (uint32_t i = 0; i < count; i++) {
        const RtEstimate *y = &points[i].y;
        double d = (rt_log(points[i].x) - mean) / squares;
        slope.median += d * rt_log(y->median);
        slope.low += d * rt_log(d > 0 ? y->low : y->high);
        slope.high += d * rt_log(d > 0 ? y->high : y->low);
    }
    return slope;
}

/* The verdict on one step of a trend. */
static RtClaimVerdict step_of(const RtClaim *claim, const RtEstimate *from, const RtEstimate *to) {
    double least = claim->rises ? to->low - from->high : from->low - to->high;
    double most = claim->rises ? to->high - from->low : from->high - to->low;
    if (claim->strictly ? least > 0 : least >= 0) return RT_CLAIM_HOLDS;
    return (claim->strictly ? most > 0 : most >= 0) ? RT_CLAIM_UNDECIDED : RT_CLAIM_FALSE;
}

static void put_step(RtClaimResult *result, const RtClaim *claim, const Point *from, const Point *to) {
    put_estimate(result, claim, &from->y);
    PUT(result, " at %s=%.9g, ", claim->key.key, from->x);
    put_estimate(result, claim, &to->y);
    PUT(result, " at %s=%.9g", claim->key.key, to->x);
}

/* Judges by the first step with the worst verdict; if all hold, shows the first value and the last. */
static void judge_trend(const RtExperiment *experiment, const RtClaim *claim, const Point *points,
                        uint32_t count, RtClaimResult *result) {
    const Point *from = &points[0], *to = &points[count - 1];
    RtClaimVerdict verdict = RT_CLAIM_HOLDS;
    for (uint32_t i = 1; i < count; i++) {
        RtClaimVerdict step = step_of(claim, &points[i - 1].y, &points[i].y);
        if (step <= verdict) continue;
        verdict = step;
        from = &points[i - 1];
        to = &points[i];
    }
    if (*result->figures && verdict <= result->verdict) return;
    *result = (RtClaimResult){.verdict = verdict};
    put_step(result, claim, from, to);
    put_place(result, experiment, from, true);
}

/* Line by line: moves the points of each line together. */
static void judge_lines(const RtExperiment *experiment, const RtClaim *claim, Point *points, uint32_t count,
                        RtClaimResult *result) {
    Worst worst = {RT_CLAIM_HOLDS, NULL, UNKNOWN};
    bool any = false;
    for (uint32_t first = 0, end; first < count; first = end) {
        end = first + 1;
        for (uint32_t i = end; i < count; i++) {
            if (!same_line(experiment, claim, &points[first], &points[i])) continue;
            Point point = points[i];
            points[i] = points[end];
            points[end++] = point;
        }
        if (end - first < 2) continue;
        any = true;
        qsort(points + first, end - first, sizeof *points, by_x);
        if (claim->form == RT_CLAIM_TREND) {
            judge_trend(experiment, claim, points + first, end - first, result);
        } else {
            RtEstimate slope = exponent_of(points + first, end - first);
            take(claim, &points[first], &slope, &worst);
        }
    }
    if (!any) *result = (RtClaimResult){RT_CLAIM_UNDECIDED, "fewer than two values were measured"};
    if (!worst.point) return;
    result->verdict = worst.verdict;
    put_estimate(result, claim, &worst.figure);
    put_place(result, experiment, worst.point, true);
}

static void judge_values(const RtExperiment *experiment, const RtClaim *claim, const Point *points,
                         uint32_t count, RtClaimResult *result) {
    Worst worst = {RT_CLAIM_HOLDS, NULL, UNKNOWN};
    for (uint32_t i = 0; i < count; i++) take(claim, &points[i], &points[i].y, &worst);
    result->verdict = worst.verdict;
    put_estimate(result, claim, &worst.figure);
    put_place(result, experiment, worst.point, false);
}

/* Whether anything that the claim could be about was measured. */
static bool is_measured(const RtResults *results, const RtClaim *claim, uint32_t t, uint32_t c) {
    if (claim->measure >= RT_CLAIM_BUILD_TIME) return rt_build_at(results, t, c)->known;
    for (int k = 0; k < RT_RAY_KIND_COUNT; k++) {
        const bool asked = claim->kind == RT_ALL_RAYS || claim->kind == (RtRayKind)k;
        if (asked && rt_cell_at(results, t, c, (RtRayKind)k)->counted) return true;
    }
    return false;
}

static bool any_is_measured(const RtResults *results, const RtClaim *claim, const Point *points,
                            uint32_t count) {
    for (uint32_t i = 0; i < count; i++) {
        const Point *p = &points[i];
        if (is_measured(results, claim, p->workload, p->candidate) &&
            (claim->form != RT_CLAIM_RATIO || is_measured(results, claim, p->workload, claim->other)))
            return true;
    }
    return false;
}

/* Drops the points without a value; returns the number left. */
static uint32_t drop_unknown(Point *points, uint32_t count) {
    uint32_t known = 0;
    for (uint32_t i = 0; i < count; i++) {
        if (isfinite(points[i].y.median)) points[known++] = points[i];
    }
    return known;
}

void rt_claim_judge(const RtResults *results, uint32_t i, RtClaimResult *result) {
    const RtExperiment *experiment = results->experiment;
    uint32_t count = 0, known = 0;
    RtClaim claim = {0};
    RtError error;
    *result = (RtClaimResult){.verdict = RT_CLAIM_HOLDS};
    Point *points =
        rt_alloc((size_t)experiment->workload_count * experiment->candidate_count, sizeof *points);
    RtStatus status = rt_claim_parse(experiment, experiment->claims[i], &claim, &error);
    if (points && status == RT_OK) count = gather(results, &claim, points);
    for (uint32_t k = 0; k < count; k++) known += isfinite(points[k].y.median) ? 1 : 0;
    if (!any_is_measured(results, &claim, points, count)) {
        *result = (RtClaimResult){RT_CLAIM_UNMEASURED, "nothing that this claim is about was measured"};
    } else if (known == 0) {
        *result = (RtClaimResult){RT_CLAIM_UNDECIDED, "no measurements of all kinds of rays"};
    } else if (claim.form == RT_CLAIM_EXPONENT) {
        judge_lines(experiment, &claim, points, count, result);
    } else if (claim.form == RT_CLAIM_TREND) {
        judge_lines(experiment, &claim, points, drop_unknown(points, count), result);
    } else {
        judge_values(experiment, &claim, points, drop_unknown(points, count), result);
    }
    if (known > 0 && known < count) {
        if (result->verdict == RT_CLAIM_HOLDS) result->verdict = RT_CLAIM_UNDECIDED;
        PUT(result, "; %" PRIu32 " of %" PRIu32 " values are unknown", count - known, count);
    }
    rt_free(points);
}

RtStatus rt_claims_check(const RtResults *results, RtError *error) {
    const RtExperiment *experiment = results->experiment;
    uint32_t wrong = 0, first = 0;
    RtClaimResult result;
    for (uint32_t i = experiment->claim_count; i-- > 0;) {
        rt_claim_judge(results, i, &result);
        if (result.verdict != RT_CLAIM_FALSE) continue;
        first = i;
        wrong++;
    }
    if (wrong == 0) return RT_OK;
    return rt_fail(error, RT_MISMATCH, "%" PRIu32 " of %" PRIu32 " claims do not hold, the first: %s", wrong,
                   experiment->claim_count, experiment->claims[first]);
}

void rt_claims_print(const RtResults *results, FILE *out) {
    const RtExperiment *experiment = results->experiment;
    bool open = false;
    if (experiment->claim_count) fputs("\nClaims:\n", out);
    for (uint32_t i = 0; i < experiment->claim_count; i++) {
        RtClaimResult result;
        rt_claim_judge(results, i, &result);
        fprintf(out, "  %-15s  %s\n  %-15s  %s\n", rt_claim_verdict_name(result.verdict),
                experiment->claims[i], "", result.figures);
        open |= result.verdict == RT_CLAIM_UNDECIDED;
    }
    if (open) fputs("  undecided: the interval includes the bound, or a value is missing\n", out);
}
