/* SPDX-License-Identifier: Apache-2.0 */
/* Judging claims: a figure for each cell or line of cells, and the verdict over all of them; and all claims
 * of an experiment as an exit code and as text. */
#include "claims/claims_points.h"

#include "core/base/memory.h"
#include "core/base/words.h"
#include "core/text/table.h"

#include <inttypes.h>
#include <math.h>

/* What a claim says about some of its cells. */
typedef struct Figure {
    const RtClaimPoint *points; /* [count] */
    uint32_t count;
    RtClaimVerdict verdict; /* of claims */
    uint64_t rays;          /* the fewest of any point */
    RtEstimate value;       /* of a value, ratio, exponent or correlation */
    double error;           /* of an exponent: the standard error */
    uint32_t from, to;      /* of a trend: the points of the deciding step */
    uint32_t found;         /* crossovers; the first of them: */
    RtCrossover crossovers[RT_MAX_CROSSOVERS];
} Figure;

const char *rt_claim_verdict_name(RtClaimVerdict verdict) {
    static const char *const names[] = {"holds", "undecided", "does not hold", "no measurements", "figure"};
    return names[verdict];
}

/* ---- verdicts ---- */

static RtClaimVerdict worse(RtClaimVerdict a, RtClaimVerdict b) {
    return a > b ? a : b;
}

static double in_units(const RtClaim *claim, double value) {
    const bool own = claim->form == RT_CLAIM_VALUE || claim->form == RT_CLAIM_TREND;
    if (claim->format.scale != 0) return claim->format.scale * value + claim->format.offset;
    return own && claim->first.measure == RT_CLAIM_TIME ? 1e9 * value : value;
}

static bool compares(const RtClaim *claim, double value) {
    if (value == claim->number) return claim->or_equal;
    return claim->greater ? value > claim->number : value < claim->number;
}

static RtClaimVerdict compare(const RtClaim *claim, double low, double high) {
    bool first = compares(claim, in_units(claim, low)), last = compares(claim, in_units(claim, high));
    return first && last ? RT_CLAIM_HOLDS : first || last ? RT_CLAIM_UNDECIDED : RT_CLAIM_FALSE;
}

/* The verdict on one step of a trend. */
static RtClaimVerdict step_of(const RtClaimCase *judge, const RtClaimPoint *one, const RtClaimPoint *next) {
    const RtClaim *claim = judge->claim;
    RtEstimate before = one->y, after = next->y;
    const RtClaimMeasure measure = claim->first.measure;
    const bool timed = measure == RT_CLAIM_TIME || measure == RT_CLAIM_FRAME_TIME;
    if (timed && one->at.workload == next->at.workload) {
        before = rt_estimate_exactly(1);
        after = rt_claim_ratio(judge, measure, &next->at, measure, &one->at);
    }
    const RtEstimate *from = &before, *to = &after;
    const RtEstimate *less = claim->rises ? from : to, *more = claim->rises ? to : from;
    if (claim->strictly ? more->low > less->high : more->low >= less->high) return RT_CLAIM_HOLDS;
    bool may = claim->strictly ? more->high > less->low : more->high >= less->low;
    return may ? RT_CLAIM_UNDECIDED : RT_CLAIM_FALSE;
}

/* By the first step with the worst verdict; if all hold, from the first value to the last. */
static void judge_trend(const RtClaimCase *judge, Figure *figure) {
    const RtClaimPoint *points = figure->points;
    figure->to = figure->count - 1;
    for (uint32_t i = 0, next = 0; i < figure->count; i++) {
        while (next < figure->count && points[next].x == points[i].x) next++;
        for (uint32_t k = next; k < figure->count && points[k].x == points[next].x; k++) {
            RtClaimVerdict step = step_of(judge, &points[i], &points[k]);
            if (step <= figure->verdict) continue;
            figure->verdict = step;
            figure->from = i;
            figure->to = k;
        }
    }
}

/* Whether the curves surely cross there: the ratio is below 1 on one side and above it on the other. */
static bool is_certain(const RtCrossover *crossover) {
    return crossover->before * crossover->after < 0;
}

static void judge_crossover(const RtClaim *claim, Figure *figure) {
    RtClaimVerdict certain = RT_CLAIM_HOLDS, possible = RT_CLAIM_HOLDS;
    bool any = false;
    figure->found = rt_claim_crossovers(figure->points, figure->count, figure->crossovers);
    if (figure->found > RT_MAX_CROSSOVERS) possible = RT_CLAIM_UNDECIDED;
    for (uint32_t i = 0; i < figure->found && i < RT_MAX_CROSSOVERS; i++) {
        const RtCrossover *crossover = &figure->crossovers[i];
        const RtClaimVerdict verdict = compare(claim, crossover->low, crossover->high);
        any |= is_certain(crossover);
        if (is_certain(crossover))
            certain = worse(certain, verdict);
        else if (verdict != RT_CLAIM_HOLDS)
            possible = RT_CLAIM_UNDECIDED;
    }
    /* Curves that do not cross here may do so beyond. */
    figure->verdict = any ? worse(certain, possible) : RT_CLAIM_UNDECIDED;
}

static void judge_figure(const RtClaimCase *judge, Figure *figure) {
    const RtClaim *claim = judge->claim;
    figure->verdict = RT_CLAIM_HOLDS;
    figure->rays = UINT64_MAX;
    for (uint32_t i = 0; i < figure->count; i++)
        figure->rays = figure->points[i].rays < figure->rays ? figure->points[i].rays : figure->rays;
    if (claim->form == RT_CLAIM_TREND) {
        judge_trend(judge, figure);
    } else if (claim->form == RT_CLAIM_CROSSOVER) {
        judge_crossover(claim, figure);
    } else {
        figure->value = claim->mean ? rt_claim_mean(figure->points, figure->count)
                        : claim->form == RT_CLAIM_EXPONENT
                            ? rt_claim_exponent(figure->points, figure->count, &figure->error)
                        : claim->form == RT_CLAIM_CORRELATION
                            ? rt_claim_correlation(figure->points, figure->count)
                            : figure->points->y;
        figure->verdict = isnan(figure->value.median) ? RT_CLAIM_UNDECIDED
                                                      : compare(claim, figure->value.low, figure->value.high);
    }
    if (figure->rays < RT_CLAIM_RAYS) figure->verdict = RT_CLAIM_UNDECIDED;
}

/* ---- texts ---- */

static RtClaimResult no_figure(RtClaimVerdict verdict, const char *why) {
    RtClaimResult result = {.verdict = verdict, .value = "unknown"};
    rt_append_text(result.figures, RT_MAX_CLAIM_FIGURES, "%s", why);
    return result;
}

#define PUT(result, ...) rt_append_text((result)->figures, RT_MAX_CLAIM_FIGURES, __VA_ARGS__)

static void put_number(RtClaimResult *result, const RtClaim *claim, double value) {
    char text[16];
    const bool never =
        isinf(value) && claim->first.measure == RT_CLAIM_BREAK_EVEN && claim->form != RT_CLAIM_RATIO;
    rt_format_figure(in_units(claim, value), text);
    PUT(result, "%s", never ? "never" : text);
}

static void put_estimate(RtClaimResult *result, const RtClaim *claim, const RtEstimate *b) {
    char text[RT_MAX_FIELD];
    const double low = in_units(claim, b->low), high = in_units(claim, b->high);
    if (isnan(b->median)) {
        PUT(result, "unknown");
    } else if (b->low == b->high || claim->format.plain) {
        put_number(result, claim, b->median);
    } else {
        rt_format_interval(in_units(claim, b->median), fmin(low, high), fmax(low, high), text);
        PUT(result, "%s", text);
    }
}

static void put_unit(RtClaimResult *result, const RtClaim *claim) {
    if (!claim->readout || claim->form > RT_CLAIM_LEAST) return;
    PUT(result, "%s",
        claim->format.unit              ? claim->format.unit
        : claim->form == RT_CLAIM_VALUE ? rt_claim_measure_unit(claim->first.measure)
                                        : "");
}

/* "grid on bunny, primary rays": what figures of several cells do not have in common is left out. */
static void put_cell(RtClaimResult *result, const RtExperiment *experiment, const RtClaim *claim,
                     const RtClaimCell *cell, bool kind) {
    const bool line = claim->form >= RT_CLAIM_EXPONENT && !claim->by_objects;
    const bool correlation = claim->form == RT_CLAIM_CORRELATION, accel = *claim->first.accel && !correlation;
    const RtWorkload *workload = &experiment->workloads[cell->workload];
    const char *before = accel && !claim->by_objects ? " on " : "";
    if (accel && line && !claim->key.scene) {
        const RtCandidate *candidate = &experiment->candidates[cell->candidate];
        PUT(result, "%s", candidate->stem);
        rt_swept_name(&candidate->swept, claim->key.key, result->figures, RT_MAX_CLAIM_FIGURES);
    } else if (accel) {
        PUT(result, "%s", rt_candidate_label(experiment, cell->candidate));
    }
    if (line && claim->key.scene) {
        PUT(result, "%s%s", before, workload->stem);
        rt_swept_name(&workload->swept, claim->key.key, result->figures, RT_MAX_CLAIM_FIGURES);
    } else if (!claim->by_objects) {
        PUT(result, "%s%s", before, workload->label);
    }
    if (kind)
        PUT(result, ", %s rays",
            cell->kind == RT_ALL_RAYS ? "all" : rt_experiment_kind_name(experiment, cell->kind));
}

/* Both labels, and those of the other cell if it is elsewhere; of a line without the parameter. */
static void put_place(RtClaimResult *result, const RtExperiment *experiment, const RtClaim *claim,
                      const RtClaimPoint *point) {
    const bool kind = claim->first.each_kind && experiment->kind_count > 1;
    const bool kinds = kind || point->at.kind != point->other.kind;
    if (claim->mean) {
        if (kind) PUT(result, " (%s rays)", rt_experiment_kind_name(experiment, point->at.kind));
        return;
    }
    PUT(result, " (");
    if (claim->form == RT_CLAIM_LEAST)
        PUT(result, "%s to ", rt_candidate_label(experiment, point->at.candidate));
    else
        put_cell(result, experiment, claim, &point->at, kinds);
    if (claim->apart) PUT(result, " to ");
    if (claim->apart || claim->form == RT_CLAIM_LEAST)
        put_cell(result, experiment, claim, &point->other, kinds);
    PUT(result, ")");
}

static void put_step(RtClaimResult *result, const RtClaim *claim, const Figure *figure) {
    const RtClaimPoint *from = &figure->points[figure->from], *to = &figure->points[figure->to];
    put_estimate(result, claim, &from->y);
    PUT(result, " at %s=%.9g, ", claim->key.key, from->x);
    put_estimate(result, claim, &to->y);
    PUT(result, " at %s=%.9g", claim->key.key, to->x);
}

/* "n=5230 [3100, >10000]" */
static void put_one_crossover(RtClaimResult *result, const RtClaim *claim, const Figure *figure,
                              const RtCrossover *crossover) {
    const RtClaimPoint *points = figure->points;
    double x = rt_claim_median_crossover(points, figure->count, crossover, 0);
    const char *before = "";
    PUT(result, "%s=", claim->key.key);
    for (; !isnan(x); before = " and ") {
        PUT(result, "%s", before);
        put_number(result, claim, x);
        x = rt_claim_median_crossover(points, figure->count, crossover, x);
    }
    if (crossover->low == crossover->high) return;
    PUT(result, "%s[%s", *before ? " " : "", crossover->low > 0 ? "" : "<");
    put_number(result, claim, crossover->low > 0 ? crossover->low : points->x);
    PUT(result, ", %s", isinf(crossover->high) ? ">" : "");
    put_number(result, claim, isinf(crossover->high) ? points[figure->count - 1].x : crossover->high);
    PUT(result, "]");
}

/* Of curves without a crossover: on which side of the other one is at all points, also at those without a
 * logarithm, between which no crossover can be interpolated. */
static const char *side_of(const Figure *figure) {
    bool above = true, below = true;
    for (uint32_t i = 0; i < figure->count; i++) {
        above &= figure->points[i].y.median >= 1;
        below &= figure->points[i].y.median <= 1;
    }
    return above ? "is above" : below ? "is below" : "may cross";
}

static void put_crossover(RtClaimResult *result, const RtClaim *claim, const Figure *figure) {
    const RtClaimPoint *first = figure->points, *last = first + figure->count - 1;
    const uint32_t count = figure->found < RT_MAX_CROSSOVERS ? figure->found : RT_MAX_CROSSOVERS;
    uint32_t certain = 0;
    for (uint32_t i = 0; i < count; i++) certain += is_certain(&figure->crossovers[i]);
    if (certain > 1) PUT(result, "%" PRIu32 " crossovers: ", certain);
    PUT(result, "%s", claim->first.accel);
    for (uint32_t i = 0; i < count; i++) {
        const RtCrossover *crossover = &figure->crossovers[i];
        const bool is = is_certain(crossover), begins = !is && i == 0 && crossover->before != 0;
        const int side = is ? crossover->after : crossover->before;
        PUT(result, "%s", i > 0 ? "," : "");
        if (is || begins) PUT(result, " is %s %s", side > 0 ? "above" : "below", claim->second.accel);
        if (is)
            PUT(result, " from ");
        else if (begins)
            PUT(result, " and may cross it at ");
        else
            PUT(result, " may cross %s at ", claim->second.accel);
        put_one_crossover(result, claim, figure, crossover);
    }
    if (count > 0) return;
    PUT(result, " %s %s from %s=%.9g to %.9g", side_of(figure), claim->second.accel, claim->key.key, first->x,
        last->x);
}

static void put_figure(RtClaimResult *result, const RtExperiment *experiment, const RtClaim *claim,
                       const Figure *figure) {
    if (claim->form == RT_CLAIM_TREND)
        put_step(result, claim, figure);
    else if (claim->form == RT_CLAIM_CROSSOVER)
        put_crossover(result, claim, figure);
    else
        put_estimate(result, claim, &figure->value);
    if (isfinite(figure->value.median)) put_unit(result, claim);
    if (figure->error > 0) {
        PUT(result, ", standard error ");
        put_number(result, claim, figure->error);
    }
    if (claim->form == RT_CLAIM_EXPONENT || claim->form == RT_CLAIM_CORRELATION || claim->mean)
        PUT(result, " over %" PRIu32 " values", figure->count);
    put_place(result, experiment, claim, figure->points);
    if (!claim->readout && figure->rays < RT_CLAIM_RAYS)
        PUT(result, ", but of %" PRIu64 " ray%s, and fewer than %d decide nothing", figure->rays,
            rt_plural(figure->rays), RT_CLAIM_RAYS);
}

/* "; holds for primary and shadow rays, does not hold for reflection rays", unless all kinds agree. */
static void put_kinds(RtClaimResult *result, const RtExperiment *experiment, const Figure *figures,
                      uint32_t count) {
    RtClaimVerdict verdicts[RT_RAY_KIND_COUNT];
    bool has[RT_RAY_KIND_COUNT] = {false}, agree = true;
    for (uint32_t i = 0; i < count; i++) {
        const RtRayKind kind = figures[i].points->at.kind;
        verdicts[kind] = has[kind] ? worse(verdicts[kind], figures[i].verdict) : figures[i].verdict;
        has[kind] = true;
    }
    for (int k = 0; k < RT_RAY_KIND_COUNT; k++) agree &= !has[k] || verdicts[k] == result->verdict;
    for (int v = 0; v < RT_CLAIM_VERDICT_COUNT && !agree; v++) {
        const char *names[RT_RAY_KIND_COUNT];
        char list[128];
        uint32_t found = 0;
        for (int k = 0; k < RT_RAY_KIND_COUNT; k++) {
            if (has[k] && verdicts[k] == (RtClaimVerdict)v)
                names[found++] = rt_experiment_kind_name(experiment, (RtRayKind)k);
        }
        if (found == 0) continue;
        rt_join_names(names, found, list, sizeof list);
        PUT(result, "; %s for %s rays", rt_claim_verdict_name((RtClaimVerdict)v), list);
    }
}

/* ---- the figures of a claim ---- */

/* Drops the points without a value; returns the number left. */
static uint32_t drop_unknown(RtClaimPoint *points, uint32_t count) {
    uint32_t known = 0;
    for (uint32_t i = 0; i < count; i++) {
        if (rt_claim_point_known(&points[i])) points[known++] = points[i];
    }
    return known;
}

/* Whether an unknown value matters: between known ones it may hide a crossover. */
static bool trim_line(RtClaimPoint **points, uint32_t *count) {
    while (*count > 0 && !rt_claim_point_known(*points)) ++*points, --*count;
    while (*count > 0 && !rt_claim_point_known(*points + *count - 1)) --*count;
    const uint32_t known = drop_unknown(*points, *count);
    const bool hidden = known < *count;
    *count = known;
    return hidden;
}

/* How many points, from the first on, belong to one mean or correlation: of one kind of rays, and of a
 * correlation of one scene. */
static uint32_t count_of_kind(const RtClaim *claim, const RtClaimPoint *points, uint32_t count) {
    uint32_t same = 1;
    while (same < count && points[same].at.kind == points->at.kind &&
           (claim->mean || points[same].at.workload == points->at.workload))
        same++;
    return same;
}

/* Reorders the points; returns the number of figures[]. */
static uint32_t make_figures(const RtClaimCase *judge, RtClaimPoint *points, uint32_t count,
                             Figure *figures) {
    const RtClaim *claim = judge->claim;
    const bool line = claim->form >= RT_CLAIM_EXPONENT;
    const bool group = claim->form == RT_CLAIM_CORRELATION || claim->mean;
    uint32_t made = 0;
    for (uint32_t first = 0, length; first < count; first += length) {
        RtClaimPoint *start = points + first;
        length = group  ? count_of_kind(claim, start, count - first)
                 : line ? rt_claim_line(judge->results->experiment, claim, start, count - first)
                        : 1;
        uint32_t left = length;
        const bool hidden = claim->form == RT_CLAIM_CROSSOVER && trim_line(&start, &left);
        if (line && left < 2) continue;
        Figure *figure = &figures[made++];
        *figure = (Figure){.points = start, .count = left};
        judge_figure(judge, figure);
        if (hidden) figure->verdict = worse(figure->verdict, RT_CLAIM_UNDECIDED);
    }
    return made;
}

/* The figure with the worst verdict, and among equal verdicts the furthest off. */
static const Figure *find_worst(const RtClaim *claim, const Figure *figures, uint32_t count) {
    const Figure *worst = figures;
    for (uint32_t i = 1; i < count; i++) {
        const double one = figures[i].value.median, other = worst->value.median;
        const bool further = claim->greater ? one < other : one > other;
        if (figures[i].verdict > worst->verdict || (figures[i].verdict == worst->verdict && further))
            worst = &figures[i];
    }
    return worst;
}

/* For a sentence: one figure, or the smallest and the largest; of curves, where they surely cross once. */
static void put_value(RtClaimResult *result, const RtClaim *claim, const Figure *figures, uint32_t count,
                      const Figure *least, const Figure *most) {
    if (claim->form == RT_CLAIM_CROSSOVER) {
        const bool certain = count == 1 && figures->found == 1 && is_certain(figures->crossovers);
        if (certain)
            put_one_crossover(result, claim, figures, figures->crossovers);
        else
            PUT(result, "unknown");
    } else if (count == 1 || least->value.median == most->value.median) {
        put_estimate(result, claim, &least->value);
    } else {
        const bool falls = claim->format.scale < 0; /* the larger the value */
        put_number(result, claim, (falls ? most : least)->value.median);
        PUT(result, " to ");
        put_number(result, claim, (falls ? least : most)->value.median);
    }
    for (uint32_t i = 0; i < count && claim->format.offset != 0; i++)
        result->contrary |=
            in_units(claim, claim->format.scale < 0 ? figures[i].value.high : figures[i].value.low) < 0;
    put_unit(result, claim);
    rt_append_text(result->value, sizeof result->value, "%s", result->figures);
    result->figures[0] = '\0';
}

/* A few figures, or the smallest and the largest of many. */
static void put_readout(RtClaimResult *result, const RtExperiment *experiment, const RtClaim *claim,
                        const Figure *figures, uint32_t count) {
    enum { MOST_LISTED = 4 };
    const Figure *least = figures, *most = figures;
    for (uint32_t i = 1; i < count; i++) {
        const double value = figures[i].value.median;
        if (isnan(least->value.median) || value < least->value.median) least = &figures[i];
        if (isnan(most->value.median) || value > most->value.median) most = &figures[i];
    }
    put_value(result, claim, figures, count, least, most);
    if (count <= MOST_LISTED || claim->form == RT_CLAIM_CROSSOVER) {
        for (uint32_t i = 0; i < count; i++) {
            PUT(result, "%s", i ? "; " : "");
            put_figure(result, experiment, claim, &figures[i]);
        }
        return;
    }
    put_figure(result, experiment, claim, least);
    PUT(result, " to ");
    put_figure(result, experiment, claim, most);
}

/* "5 of 7, 1 undecided": in how many figures a claim holds. Those of `least` are one for each other
 * accelerator; then it holds in a cell if it does for all of them. */
static void put_count(RtClaimResult *result, const Figure *figures, uint32_t count) {
    uint32_t verdicts[RT_CLAIM_VERDICT_COUNT] = {0}, cells = 0;
    for (uint32_t i = 0, next; i < count; i = next) {
        const RtClaimCell *cell = &figures[i].points->at;
        RtClaimVerdict worst = figures[i].verdict;
        for (next = i + 1; next < count && memcmp(cell, &figures[next].points->at, sizeof *cell) == 0; next++)
            worst = worse(worst, figures[next].verdict);
        verdicts[worst]++;
        cells++;
    }
    PUT(result, "%" PRIu32 " of %" PRIu32, verdicts[RT_CLAIM_HOLDS], cells);
    if (verdicts[RT_CLAIM_UNDECIDED]) PUT(result, ", %" PRIu32 " undecided", verdicts[RT_CLAIM_UNDECIDED]);
    rt_append_text(result->value, sizeof result->value, "%s", result->figures);
}

/* Whether no other point of the same scene and kind of rays is surely less. */
static bool is_least(const RtClaimCase *judge, const RtClaimPoint *points, uint32_t count, uint32_t i) {
    const RtClaimMeasure measure = judge->claim->first.measure;
    for (uint32_t k = 0; k < count; k++) {
        if (points[k].at.workload != points[i].at.workload || points[k].at.kind != points[i].at.kind)
            continue;
        if (k != i && rt_claim_ratio(judge, measure, &points[i].at, measure, &points[k].at).low > 1)
            return false;
    }
    return true;
}

/* The accelerators with the least, each with its scene and kind of rays unless there is one only: level ones,
 * too. */
static void put_least(const RtClaimCase *judge, const RtClaimPoint *points, uint32_t count,
                      RtClaimResult *result) {
    const RtExperiment *experiment = judge->results->experiment;
    const char *names[RT_MAX_CANDIDATES];
    uint32_t found = 0;
    for (uint32_t i = 0; i < count; i++) {
        const RtClaimCell *cell = &points[i].at;
        const char *label = rt_candidate_label(experiment, cell->candidate);
        uint32_t k = 0;
        if (!is_least(judge, points, count, i)) continue;
        PUT(result, "%s%s (%s", *result->figures ? "; " : "", label,
            experiment->workloads[cell->workload].label);
        if (judge->claim->first.each_kind)
            PUT(result, ", %s rays", rt_experiment_kind_name(experiment, cell->kind));
        PUT(result, ")");
        while (k < found && strcmp(names[k], label) != 0) k++;
        if (k == found) names[found++] = label;
    }
    rt_join_names(names, found, result->value, sizeof result->value);
}

static void judge_points(const RtClaimCase *judge, RtClaimPoint *points, uint32_t count,
                         RtClaimResult *result) {
    const RtExperiment *experiment = judge->results->experiment;
    const RtClaim *claim = judge->claim;
    Figure *figures = rt_alloc(count, sizeof *figures);
    const uint32_t made = figures ? make_figures(judge, points, count, figures) : 0;
    if (made == 0) {
        *result = no_figure(RT_CLAIM_UNDECIDED, "fewer than two values were measured");
    } else if (claim->counted) {
        put_count(result, figures, made);
    } else if (claim->readout && claim->form == RT_CLAIM_LEAST) {
        put_least(judge, points, count, result);
    } else if (claim->readout) {
        put_readout(result, experiment, claim, figures, made);
    } else {
        const Figure *worst = find_worst(claim, figures, made);
        result->verdict = worst->verdict;
        put_figure(result, experiment, claim, worst);
        if (claim->first.each_kind) put_kinds(result, experiment, figures, made);
    }
    rt_free(figures);
}

/* The intervals of tracing times that a claim rests on. */
static uint32_t count_intervals(const RtResults *results, const RtClaim *claim) {
    const RtClaimMeasure first = claim->first.measure, second = claim->second.measure;
    const bool other = claim->form == RT_CLAIM_CORRELATION || claim->apart;
    bool timed = first == RT_CLAIM_TIME || first == RT_CLAIM_FRAME_TIME;
    timed |= other && (second == RT_CLAIM_TIME || second == RT_CLAIM_FRAME_TIME);
    if (!timed) return 0;
    return rt_claim_gather(&(RtClaimCase){results, claim, 0}, NULL) * (claim->apart ? 2 : 1);
}

/* Those of a text, if it is a claim. */
static uint32_t count_of(const RtResults *results, const char *text) {
    RtClaim claim;
    if (rt_claim_parse(results->experiment, text, &claim, NULL) != RT_OK) return 0;
    return claim.readout && !claim.counted ? 0 : count_intervals(results, &claim);
}

double rt_claims_coverage(const RtResults *results, uint32_t *count) {
    const RtExperiment *experiment = results->experiment;
    RtFindingPiece piece;
    *count = 0;
    for (uint32_t i = 0; i < experiment->claim_count; i++) *count += count_of(results, experiment->claims[i]);
    for (const char *at = experiment->finding; rt_finding_next(&at, &piece, NULL);) {
        if (piece.sort >= RT_FINDING_READOUT && !*piece.from) *count += count_of(results, piece.expression);
    }
    return rt_coverage_of_each(*count);
}

static void judge_parsed(const RtClaimCase *judge, RtClaimPoint *points, RtClaimResult *result) {
    const RtResults *results = judge->results;
    const RtClaim *claim = judge->claim;
    uint32_t known = 0;
    const uint32_t count = rt_claim_gather(judge, points);
    for (uint32_t k = 0; k < count; k++) known += rt_claim_point_known(&points[k]) ? 1 : 0;
    const bool measured = rt_claim_any_measured(results, claim, points, count);
    if (!measured) {
        *result = no_figure(RT_CLAIM_UNMEASURED, "nothing that this claim is about was measured");
    } else if (known == 0) {
        const RtClaimMeasure measure = claim->first.measure;
        *result = no_figure(RT_CLAIM_UNDECIDED, measure == RT_CLAIM_BREAK_EVEN
                                                    ? "the baseline, or builds on other threads than the rays"
                                                : rt_claim_subject(measure) == RT_SUBJECT_STRUCTURE
                                                    ? "these structures have no such value"
                                                    : "no measurements of all kinds of rays");
    } else {
        /* An exponent needs all values; a crossover those between its ends. */
        const bool whole = claim->form == RT_CLAIM_EXPONENT || claim->form == RT_CLAIM_CROSSOVER;
        judge_points(judge, points, whole ? count : drop_unknown(points, count), result);
    }
    result->measured = measured;
    result->whole = known == count && count > 0;
    if (known > 0 && known < count) {
        if (claim->form != RT_CLAIM_CROSSOVER) result->verdict = worse(result->verdict, RT_CLAIM_UNDECIDED);
        PUT(result, "; %" PRIu32 " of %" PRIu32 " values are unknown", count - known, count);
    }
    const char *refusal = known < count || count == 0 ? rt_claim_refusal(results, claim) : NULL;
    if (refusal && result->verdict == RT_CLAIM_UNMEASURED) result->verdict = RT_CLAIM_UNDECIDED;
    if (refusal) PUT(result, "; refused: %.300s", refusal);
    if (claim->readout) result->verdict = RT_CLAIM_FIGURE;
}

RtStatus rt_claim_judge_text(const RtResults *results, const char *text, bool other, RtClaimResult *result,
                             RtError *error) {
    const RtExperiment *experiment = results->experiment;
    const size_t most = (size_t)experiment->workload_count * experiment->candidate_count * RT_RAY_KIND_COUNT;
    RtClaim claim;
    uint32_t intervals, own;
    *result = no_figure(RT_CLAIM_UNMEASURED, "nothing that this claim is about was measured");
    RT_TRY(rt_claim_parse(experiment, text, &claim, error));
    RtClaimPoint *points = rt_alloc(most, sizeof *points);
    if (!points) return rt_fail_memory(error, "the cells of a claim", most * sizeof *points);
    RtClaimCase judge = {results, &claim, rt_claims_coverage(results, &intervals)};
    own = count_intervals(results, &claim);
    if (other) judge.coverage = rt_coverage_of_each(intervals + own);
    if (claim.readout && !claim.counted)
        judge.coverage = rt_coverage_of_each(claim.mean ? own : claim.apart ? 2 : 1);
    *result = (RtClaimResult){.verdict = RT_CLAIM_HOLDS};
    judge_parsed(&judge, points, result);
    rt_free(points);
    return RT_OK;
}

void rt_claim_judge(const RtResults *results, uint32_t i, RtClaimResult *result) {
    rt_claim_judge_text(results, results->experiment->claims[i], false, result, NULL);
}

/* ---- all claims ---- */

const char *rt_claims_variant(const RtExperiment *experiment) {
    return experiment->quick ? " (made for the full experiment; this is its --quick variant)" : "";
}

RtStatus rt_claims_check(const RtResults *results, RtError *error) {
    const RtExperiment *experiment = results->experiment;
    uint32_t wrong = 0, first = 0, claims = 0;
    RtClaimResult result;
    for (uint32_t i = experiment->claim_count; i-- > 0;) {
        rt_claim_judge(results, i, &result);
        claims += result.verdict != RT_CLAIM_FIGURE;
        if (result.verdict != RT_CLAIM_FALSE) continue;
        first = i;
        wrong++;
    }
    if (wrong == 0) return RT_OK;
    return rt_fail(error, RT_MISMATCH, "%" PRIu32 " of %" PRIu32 " claims do not hold, the first: %s", wrong,
                   claims, experiment->claims[first]);
}

void rt_claims_level(const RtResults *results, char out[RT_MAX_CLAIM_LEVEL]) {
    uint32_t count;
    const double coverage = rt_claims_coverage(results, &count);
    out[0] = '\0';
    if (count > 1)
        rt_append_text(out, RT_MAX_CLAIM_LEVEL,
                       "The %" PRIu32 " intervals of tracing times in these claims hold together with 95 %% "
                       "confidence: each covers %.6g %%.",
                       count, 100 * coverage);
}

void rt_claims_print(const RtResults *results, FILE *out) {
    const RtExperiment *experiment = results->experiment;
    char level[RT_MAX_CLAIM_LEVEL];
    bool open = false;
    if (experiment->claim_count) fprintf(out, "\nClaims%s:\n", rt_claims_variant(experiment));
    for (uint32_t i = 0; i < experiment->claim_count; i++) {
        RtClaimResult result;
        rt_claim_judge(results, i, &result);
        fprintf(out, "  %-15s  %s%s\n  %-15s  %s\n", rt_claim_verdict_name(result.verdict),
                experiment->claims[i], rt_claim_is_later(results, i) ? " [" RT_CLAIM_LATER "]" : "", "",
                result.figures);
        open |= result.verdict == RT_CLAIM_UNDECIDED;
    }
    json_t *dropped = rt_claims_dropped(results), *text;
    size_t k;
    json_array_foreach(dropped, k, text)
        fprintf(out, "  %-15s  %s\n", "dropped since", json_string_value(text));
    json_decref(dropped);
    if (open)
        fprintf(out,
                "  undecided: the interval includes the bound, a value is missing, fewer than %d rays were "
                "measured, or no crossover is certain\n",
                RT_CLAIM_RAYS);
    rt_claims_level(results, level);
    if (*level) fprintf(out, "  %s\n", level);
}
