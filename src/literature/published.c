/* SPDX-License-Identifier: Apache-2.0 */
#include "literature/published.h"

#include <fnmatch.h>
#include <inttypes.h>
#include <math.h>

void rt_published_row_name(const RtPublishedRow *row, char *out) {
    const char *name = row->of_rays || !*row->structure ? row->source : row->structure;
    bool more = name == row->structure && *row->parameters;
    snprintf(out, RT_MAX_ROW_NAME, "%s%s%s", name, more ? " " : "", more ? row->parameters : "");
}

void rt_figure_measured(const RtFigure *figure, char out[RT_MAX_FIGURE]) {
    out[0] = '\0';
    if (isnan(figure->measured)) return;
    snprintf(out, RT_MAX_FIGURE, figure->measured == floor(figure->measured) ? "%.0f" : "%.6g",
             figure->measured);
}

/* ---- figures ---- */

const RtFigure *rt_published_figure(const RtPublished *published, const RtPublishedRow *row,
                                    RtColumn column) {
    for (uint32_t i = row->first; i < row->first + row->count; i++) {
        if (published->figures[i].column == column) return &published->figures[i];
    }
    return NULL;
}

/* ---- measured figures ---- */

/* Rays of the baseline, which is measured on all of them. */
static double count_rays(const RtResults *results, uint32_t workload, RtColumn column) {
    const bool primary = column == RT_COLUMN_primary || column == RT_COLUMN_primary_hit;
    const bool shadow = column == RT_COLUMN_shadow || column == RT_COLUMN_shadow_hit;
    const bool hit = column == RT_COLUMN_primary_hit || column == RT_COLUMN_shadow_hit ||
                     column == RT_COLUMN_secondary_hit;
    const RtKinds kinds = primary  ? 1u << RT_RAY_PRIMARY
                          : shadow ? 1u << RT_RAY_SHADOW
                                   : 1u << RT_RAY_REFLECTION | 1u << RT_RAY_TRANSMISSION;
    const RtCost rays = rt_results_total(results, workload, results->experiment->baseline, kinds);
    return hit ? rays.hits : rays.weight;
}

static double measure_row(const RtResults *results, const RtPublishedRow *row, RtColumn column) {
    const RtDescription *structure = &rt_build_at(results, row->workload, row->candidate)->structure;
    const RtCost cost = rt_results_cost(results, row->workload, row->candidate, RT_ALL_RAYS);
    switch (column) {
    case RT_COLUMN_interior: return (double)structure->interior;
    case RT_COLUMN_leaves: return (double)structure->leaves;
    case RT_COLUMN_empty_leaves: return (double)structure->empty_leaves;
    case RT_COLUMN_references: return (double)structure->references;
    case RT_COLUMN_object_tests: return cost.object_tests / (row->per_hit ? cost.hits : 1);
    case RT_COLUMN_steps: return cost.steps;
    case RT_COLUMN_leaf_steps: return cost.leaf_steps;
    default: return cost.empty_steps;
    }
}

/* NAN if it was not measured. */
static double measure(const RtResults *results, const RtPublishedRow *row, RtColumn column) {
    if (!results->workloads[row->workload].known) return (double)NAN;
    if (row->of_rays) return count_rays(results, row->workload, column);
    if (row->candidate == RT_NOT_MEASURED) return (double)NAN;
    if (!rt_build_at(results, row->workload, row->candidate)->known) return (double)NAN;
    return measure_row(results, row, column);
}

/* ---- comparing ---- */

static RtJudgement judge(const RtExperiment *experiment, const RtFigure *figure) {
    double tolerance = experiment->published.tolerance[figure->column];
    bool of_structure = figure->column < RT_COLUMN_object_tests;
    if (isnan(figure->measured) || tolerance <= 0 || (experiment->quick && !of_structure)) return RT_UNJUDGED;
    double most = 0.01 * tolerance * figure->published + figure->half_unit;
    return fabs(figure->measured - figure->published) <= most ? RT_WITHIN : RT_OUTSIDE;
}

static bool fits(const char *pattern, const char *text) {
    return fnmatch(pattern, text, 0) == 0;
}

static uint32_t find_reason(const RtPublished *published, const RtFigure *figure) {
    const RtPublishedRow *row = &published->rows[figure->row];
    const char *scene = published->experiment->workloads[row->workload].label;
    for (uint32_t i = 0; i < published->reason_count; i++) {
        const RtReason *reason = &published->reasons[i];
        if (fits(reason->scene, scene) && fits(reason->source, row->source) &&
            fits(reason->accel, row->accel) && fits(reason->column, rt_column_name(figure->column))) {
            return i;
        }
    }
    return RT_NO_REASON;
}

/* ---- the best rows ---- */

/* A row's figure per ray of ours, of which `hits` hit, or NAN. */
static double per_ray(const RtPublished *published, const RtPublishedRow *row, RtColumn column, double hits) {
    const RtFigure *figure = rt_published_figure(published, row, column);
    bool per_hit = row->per_hit && column == RT_COLUMN_object_tests;
    if (!figure) return (double)NAN;
    return figure->published * (per_hit ? hits : 1);
}

static bool is_less(double value, double than) {
    return isnan(than) ? !isnan(value) : value < than;
}

static RtBest find_best(const RtPublished *published, const RtResults *results, uint32_t workload,
                        RtMeasure measure) {
    const RtExperiment *experiment = published->experiment;
    RtBest best = {RT_NOT_MEASURED, RT_NOT_MEASURED, (double)NAN, (double)NAN, (double)NAN};
    const double hits = rt_results_cost(results, workload, experiment->baseline, RT_ALL_RAYS).hits;
    bool steps = measure == RT_BEST_TESTS_AND_STEPS;
    for (uint32_t r = 0; r < published->row_count; r++) {
        const RtPublishedRow *row = &published->rows[r];
        if (row->workload != workload || row->of_rays) continue;
        double value = per_ray(published, row, RT_COLUMN_object_tests, hits);
        if (steps) value += per_ray(published, row, RT_COLUMN_steps, hits);
        if (!is_less(value, best.published)) continue;
        best.published = value;
        best.row = r;
    }
    for (uint32_t c = 0; c < experiment->candidate_count; c++) {
        if (!experiment->candidates[c].ours || !rt_build_at(results, workload, c)->known) continue;
        const RtCost cost = rt_results_cost(results, workload, c, RT_ALL_RAYS);
        double value = cost.object_tests + (steps ? cost.steps : 0);
        if (!is_less(value, best.ours)) continue;
        best.ours = value;
        best.extent_tests = cost.extent_tests;
        best.candidate = c;
    }
    return best;
}

const char *rt_measure_name(RtMeasure measure) {
    return measure == RT_BEST_TESTS ? "object_tests" : "object_tests+steps";
}

bool rt_best_is_ahead(const RtBest *best) {
    return best->ours < best->published;
}

void rt_published_compare(RtPublished *published, const RtResults *results) {
    for (uint32_t i = 0; i < published->reason_count; i++) published->reasons[i].used = 0;
    for (uint32_t i = 0; i < published->figure_count; i++) {
        RtFigure *figure = &published->figures[i];
        const RtPublishedRow *row = &published->rows[figure->row];
        figure->measured = measure(results, row, figure->column);
        double difference = figure->measured - figure->published;
        figure->deviation = difference == 0 ? 0 : 100 * difference / figure->published;
        figure->judgement = judge(published->experiment, figure);
        figure->reason = figure->judgement == RT_OUTSIDE ? find_reason(published, figure) : RT_NO_REASON;
        if (figure->reason != RT_NO_REASON) published->reasons[figure->reason].used++;
    }
    for (uint32_t t = 0; t < published->experiment->workload_count; t++) {
        for (int m = 0; m < RT_MEASURE_COUNT; m++)
            published->best[t][m] = find_best(published, results, t, (RtMeasure)m);
    }
}

/* ---- the check ---- */

static RtStatus fail_outside(const RtPublished *published, const RtFigure *figure, uint32_t count,
                             RtError *error) {
    const RtPublishedRow *row = &published->rows[figure->row];
    char name[RT_MAX_ROW_NAME], measured[RT_MAX_FIGURE];
    rt_published_row_name(row, name);
    rt_figure_measured(figure, measured);
    return rt_fail(error, RT_MISMATCH,
                   "%u measured figures differ from the published ones by more than their tolerance, without "
                   "a reason; the first: %s of %s on %s is %s, published is %s",
                   count, rt_column_name(figure->column), name,
                   published->experiment->workloads[row->workload].label, measured, figure->text);
}

static RtStatus check_figures(const RtPublished *published, RtError *error) {
    const RtFigure *first = NULL;
    uint32_t count = 0;
    for (uint32_t i = published->figure_count; i-- > 0;) {
        const RtFigure *figure = &published->figures[i];
        if (figure->judgement != RT_OUTSIDE || figure->reason != RT_NO_REASON) continue;
        first = figure;
        count++;
    }
    return first ? fail_outside(published, first, count, error) : RT_OK;
}

static RtStatus check_reasons(const RtPublished *published, RtError *error) {
    for (uint32_t i = 0; i < published->reason_count; i++) {
        if (published->reasons[i].used) continue;
        return rt_fail(error, RT_MISMATCH,
                       "%s:%" PRIu32 ": no figure needs this reason: all figures that it applies to are "
                       "within their tolerance, not measured, or have an earlier reason",
                       published->reasons_path, published->reasons[i].line);
    }
    return RT_OK;
}

static RtStatus check_best(const RtPublished *published, RtError *error) {
    const RtExperiment *experiment = published->experiment;
    bool any = false;
    for (uint32_t c = 0; c < experiment->candidate_count; c++) any |= experiment->candidates[c].ours;
    for (uint32_t t = 0; any && t < experiment->workload_count; t++) {
        for (int m = 0; m < RT_MEASURE_COUNT; m++) {
            const RtBest *best = &published->best[t][m];
            if (best->row == RT_NOT_MEASURED || rt_best_is_ahead(best)) continue;
            return rt_fail(error, RT_MISMATCH,
                           "on %s none of ours is better than the best published row: %s are %.4g per ray, "
                           "published %.4g",
                           experiment->workloads[t].label, rt_measure_name((RtMeasure)m), best->ours,
                           best->published);
        }
    }
    return RT_OK;
}

RtStatus rt_published_check(const RtPublished *published, RtError *error) {
    RT_TRY(check_figures(published, error));
    if (published->experiment->quick) return RT_OK;
    RT_TRY(check_reasons(published, error));
    return check_best(published, error);
}
