/* SPDX-License-Identifier: Apache-2.0 */
#include "report/sweep_lines.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The position of a value on the axis; words are numbered. */
static double place_of(RtSweepLines *figure, const char *value) {
    double x = 0;
    uint32_t i = 0;
    if (figure->key.number) rt_swept_number(value, &x);
    for (; !figure->key.number && i < figure->value_count; i++) {
        if (strcmp(figure->words[i], value) == 0) return i;
    }
    if (!figure->key.number) x = figure->value_count;
    while (figure->key.number && i < figure->value_count && figure->values[i] < x) i++;
    bool there = i < figure->value_count && figure->values[i] == x;
    if (there || figure->value_count == RT_MAX_SWEEP_VALUES) return x;
    memmove(&figure->values[i + 1], &figure->values[i], (figure->value_count - i) * sizeof(double));
    figure->values[i] = x;
    if (!figure->key.number) snprintf(figure->words[i], RT_MAX_SWEPT_CHARS, "%s", value);
    figure->value_count++;
    return x;
}

static void name_line(const RtSweepLines *figure, uint32_t c, char name[RT_MAX_SWEEP_NAME]) {
    const RtCandidate *candidate = &figure->results->experiment->candidates[c];
    snprintf(name, RT_MAX_SWEEP_NAME, "%s", figure->key.scene ? candidate->label : candidate->stem);
    if (!figure->key.scene) rt_swept_name(&candidate->swept, figure->key.key, name, RT_MAX_SWEEP_NAME);
}

static uint32_t line_of(RtSweepLines *figure, uint32_t c, bool flat) {
    char name[RT_MAX_SWEEP_NAME];
    uint32_t line = 0;
    name_line(figure, c, name);
    while (line < figure->line_count && strcmp(figure->lines[line].name, name) != 0) line++;
    if (line < figure->line_count) return line;
    figure->lines[line] = (RtSweepLine){.candidate = c, .flat = flat};
    strcpy(figure->lines[line].name, name);
    return figure->line_count++;
}

double rt_sweep_lines_cost(const RtCost *cost, RtSweepMeasure measure) {
    return measure == RT_SWEEP_TIME    ? cost->seconds.median
           : measure == RT_SWEEP_STEPS ? cost->steps
                                       : cost->object_tests;
}

void rt_sweep_lines_group_name(const RtExperiment *experiment, const RtSweptKey *key, uint32_t t,
                               char name[RT_MAX_SWEEP_NAME]) {
    const RtWorkload *workload = &experiment->workloads[t];
    snprintf(name, RT_MAX_SWEEP_NAME, "%s", key->scene ? workload->stem : workload->label);
    if (key->scene) rt_swept_name(&workload->swept, key->key, name, RT_MAX_SWEEP_NAME);
}

static bool same_group(const RtExperiment *experiment, const RtSweptKey *key, uint32_t t, uint32_t other) {
    char name[RT_MAX_SWEEP_NAME], others[RT_MAX_SWEEP_NAME];
    rt_sweep_lines_group_name(experiment, key, t, name);
    rt_sweep_lines_group_name(experiment, key, other, others);
    return strcmp(name, others) == 0;
}

static int by_place(const void *a, const void *b) {
    const RtSweepPoint *p = a, *q = b;
    if (p->group != q->group) return p->group < q->group ? -1 : 1;
    if (p->line != q->line) return p->line < q->line ? -1 : 1;
    return (p->x > q->x) - (p->x < q->x);
}

static void add_point(RtSweepLines *figure, uint32_t group, uint32_t line, double x, const RtCost *cost) {
    figure->points[figure->point_count++] = (RtSweepPoint){group, line, x, *cost};
}

/* Lines without the parameter span the axis. */
static void span_axis(RtSweepLines *figure) {
    for (uint32_t i = 0, count = figure->point_count; i < count && figure->value_count; i++) {
        RtSweepPoint *point = &figure->points[i];
        if (isfinite(point->x)) continue;
        point->x = figure->values[0];
        add_point(figure, point->group, point->line, figure->values[figure->value_count - 1], &point->cost);
    }
}

static bool is_measured(const RtSweepLines *figure, uint32_t t, uint32_t c) {
    const RtCost cost = rt_results_cost(figure->results, t, c, RT_ALL_RAYS);
    return !isnan(cost.seconds.median) || !isnan(cost.object_tests);
}

/* Whether scene t is in the panel of scene `first`. */
static bool in_group(const RtSweepLines *figure, uint32_t first, uint32_t t) {
    return figure->results->workloads[t].known &&
           same_group(figure->results->experiment, &figure->key, first, t);
}

/* Whether the parameter has several values there. */
static bool varies(const RtSweepLines *figure, uint32_t first) {
    const RtExperiment *experiment = figure->results->experiment;
    const char *one = NULL;
    for (uint32_t t = first; t < experiment->workload_count; t++) {
        for (uint32_t c = 0; in_group(figure, first, t) && c < experiment->candidate_count; c++) {
            const char *value = rt_swept_of(experiment, &figure->key, t, c);
            if (!value || !is_measured(figure, t, c)) continue;
            if (one && !rt_swept_equal(one, value)) return true;
            one = value;
        }
    }
    return false;
}

/* The lines of the scenes that differ from scene `first` only in the parameter. */
static void gather_group(RtSweepLines *figure, uint32_t first) {
    const RtExperiment *experiment = figure->results->experiment;
    const uint32_t group = figure->group_count;
    figure->groups[figure->group_count++] = first;
    for (uint32_t t = first; t < experiment->workload_count; t++) {
        for (uint32_t c = 0; in_group(figure, first, t) && c < experiment->candidate_count; c++) {
            const char *value = rt_swept_of(experiment, &figure->key, t, c);
            const RtCost cost = rt_results_cost(figure->results, t, c, RT_ALL_RAYS);
            if (!is_measured(figure, t, c)) continue;
            figure->timed |= !isnan(cost.seconds.median);
            add_point(figure, group, line_of(figure, c, !value), value ? place_of(figure, value) : -INFINITY,
                      &cost);
        }
    }
}

void rt_sweep_lines_gather(RtSweepLines *figure) {
    const RtExperiment *experiment = figure->results->experiment;
    figure->group_count = figure->line_count = figure->point_count = figure->value_count = 0;
    figure->timed = false;
    for (uint32_t t = 0; t < experiment->workload_count; t++) {
        bool first = true;
        for (uint32_t before = 0; before < t; before++)
            first &= !same_group(experiment, &figure->key, before, t);
        if (first && varies(figure, t)) gather_group(figure, t);
    }
    span_axis(figure);
    qsort(figure->points, figure->point_count, sizeof(RtSweepPoint), by_place);
}

bool rt_sweep_lines_has(const RtSweepLines *figure, uint32_t group, uint32_t line, RtSweepMeasure measure) {
    for (uint32_t i = 0; i < figure->point_count; i++) {
        const RtSweepPoint *point = &figure->points[i];
        if (point->group == group && point->line == line &&
            !isnan(rt_sweep_lines_cost(&point->cost, measure)))
            return true;
    }
    return false;
}

double rt_sweep_lines_last(const RtSweepLines *figure, uint32_t line, RtSweepMeasure measure) {
    double last = NAN;
    for (uint32_t i = figure->point_count; i-- > 0;) {
        const RtSweepPoint *point = &figure->points[i];
        const double cost = rt_sweep_lines_cost(&point->cost, measure);
        const bool later = i + 1 < figure->point_count && figure->points[i + 1].group == point->group &&
                           figure->points[i + 1].line == line;
        if (point->line == line && !later && !isnan(cost)) last = cost;
    }
    return last;
}

uint32_t rt_sweep_lines_order(const RtSweepLines *figure, RtSweepMeasure measure, uint32_t *order) {
    uint32_t count = 0;
    for (uint32_t line = 0; line < figure->line_count; line++) {
        const double last = rt_sweep_lines_last(figure, line, measure);
        if (isnan(last)) continue;
        uint32_t at = count++;
        for (; at > 0 && rt_sweep_lines_last(figure, order[at - 1], measure) < last; at--)
            order[at] = order[at - 1];
        order[at] = line;
    }
    return count;
}
