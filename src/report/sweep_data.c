/* SPDX-License-Identifier: Apache-2.0 */
#include "report/sweep_data.h"

#include "report/color.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define MAX_LINE_NAME (RT_MAX_LABEL + RT_MAX_SWEPT * (RT_MAX_NAME + RT_MAX_SWEPT_CHARS + 2))

/* The values of a parameter in the order of the experiment, and their places on the axis: words are numbered.
 */
typedef struct Axis {
    RtSweptKey key;
    const char *values[RT_MAX_SWEEP_VALUES];
    double places[RT_MAX_SWEEP_VALUES];
    uint32_t count;
} Axis;

typedef struct Point {
    double x;
    const char *value;
    uint32_t workload, candidate;
} Point;

/* ---- names ---- */

/* Scenes are in one group, and candidates on one line, if they have the same name without the parameter. */
static void name_group(const RtExperiment *experiment, const RtSweptKey *key, uint32_t t, char *name) {
    const RtWorkload *workload = &experiment->workloads[t];
    snprintf(name, MAX_LINE_NAME, "%s", key->scene ? workload->stem : workload->label);
    if (key->scene) rt_swept_name(&workload->swept, key->key, name, MAX_LINE_NAME);
}

static void name_line(const RtExperiment *experiment, const RtSweptKey *key, uint32_t c, char *name) {
    const RtCandidate *candidate = &experiment->candidates[c];
    snprintf(name, MAX_LINE_NAME, "%s", key->scene ? candidate->label : candidate->stem);
    if (!key->scene) rt_swept_name(&candidate->swept, key->key, name, MAX_LINE_NAME);
}

typedef void NameIt(const RtExperiment *experiment, const RtSweptKey *key, uint32_t i, char *name);

static bool same_name(const RtExperiment *experiment, const RtSweptKey *key, NameIt *name_it, uint32_t a,
                      uint32_t b) {
    char name[MAX_LINE_NAME], other[MAX_LINE_NAME];
    name_it(experiment, key, a, name);
    name_it(experiment, key, b, other);
    return strcmp(name, other) == 0;
}

/* Whether no scene or candidate before number `i` has its name. */
static bool is_first(const RtExperiment *experiment, const RtSweptKey *key, NameIt *name_it, uint32_t i) {
    for (uint32_t before = 0; before < i; before++) {
        if (same_name(experiment, key, name_it, before, i)) return false;
    }
    return true;
}

/* ---- the axis ---- */

static bool is_measured(const RtResults *results, uint32_t t, uint32_t c) {
    const RtCost cost = rt_results_cost(results, t, c, RT_ALL_RAYS);
    return results->workloads[t].known && (!isnan(cost.seconds.median) || !isnan(cost.object_tests));
}

static double place_of(const Axis *axis, const char *value) {
    double x;
    if (axis->key.number && rt_swept_number(value, &x)) return x;
    for (uint32_t i = 0; i < axis->count; i++) {
        if (strcmp(axis->values[i], value) == 0) return i;
    }
    return axis->count;
}

static void add_value(Axis *axis, const char *value) {
    const double x = place_of(axis, value);
    for (uint32_t i = 0; i < axis->count; i++) {
        if (axis->places[i] == x) return;
    }
    if (axis->count == RT_MAX_SWEEP_VALUES) return;
    axis->values[axis->count] = value;
    axis->places[axis->count++] = x;
}

/* The values measured in the group of scene `first`. */
static void add_values(const RtResults *results, uint32_t first, Axis *axis) {
    const RtExperiment *experiment = results->experiment;
    for (uint32_t t = first; t < experiment->workload_count; t++) {
        for (uint32_t c = 0; c < experiment->candidate_count; c++) {
            const char *value = rt_swept_of(experiment, &axis->key, t, c);
            if (value && same_name(experiment, &axis->key, name_group, first, t) &&
                is_measured(results, t, c))
                add_value(axis, value);
        }
    }
}

static int by_number(const void *a, const void *b) {
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static const char *kind_of_axis(const Axis *axis) {
    double places[RT_MAX_SWEEP_VALUES];
    if (!axis->key.number) return "words";
    memcpy(places, axis->places, sizeof places);
    qsort(places, axis->count, sizeof *places, by_number);
    return rt_swept_logarithmic(places, axis->count) ? "log" : "linear";
}

/* ---- lines ---- */

static int by_place(const void *a, const void *b) {
    return by_number(&((const Point *)a)->x, &((const Point *)b)->x);
}

/* The points of the line of candidate `line` in the group of scene `first`; *flat: it lacks the parameter. */
static uint32_t gather(const RtResults *results, const Axis *axis, uint32_t first, uint32_t line,
                       Point points[RT_MAX_SWEEP_VALUES], bool *flat) {
    const RtExperiment *experiment = results->experiment;
    uint32_t count = 0;
    *flat = false;
    for (uint32_t t = first; t < experiment->workload_count; t++) {
        if (!same_name(experiment, &axis->key, name_group, first, t)) continue;
        for (uint32_t c = line; c < experiment->candidate_count; c++) {
            const char *value = rt_swept_of(experiment, &axis->key, t, c);
            if (count == RT_MAX_SWEEP_VALUES || !is_measured(results, t, c) ||
                !same_name(experiment, &axis->key, name_line, line, c))
                continue;
            *flat |= !value;
            points[count++] = (Point){value ? place_of(axis, value) : NAN, value, t, c};
        }
    }
    if (!*flat) qsort(points, count, sizeof *points, by_place);
    return count;
}

static void put_point(const RtResults *results, const char *group, const char *line, uint32_t color,
                      int marker, const Point *point, double x, const char *value, FILE *out) {
    const RtCost cost = rt_results_cost(results, point->workload, point->candidate, RT_ALL_RAYS);
    const double columns[] = {1e9 * cost.seconds.median, 1e9 * cost.seconds.low, 1e9 * cost.seconds.high,
                              cost.object_tests, cost.steps};
    fprintf(out, "%s\t%s\t%u\t%d\t%.9g\t%s", group, line, color, marker, x, value);
    for (size_t i = 0; i < sizeof columns / sizeof columns[0]; i++)
        fprintf(out, isnan(columns[i]) ? "\tNaN" : "\t%.9g", columns[i]);
    fputc('\n', out);
}

static void put_line(const RtResults *results, const Axis *axis, uint32_t first, uint32_t line,
                     uint32_t number, FILE *out) {
    char group[MAX_LINE_NAME], name[MAX_LINE_NAME], color[RT_COLOR_CHARS];
    Point points[RT_MAX_SWEEP_VALUES];
    bool flat;
    const uint32_t count = gather(results, axis, first, line, points, &flat);
    name_group(results->experiment, &axis->key, first, group);
    name_line(results->experiment, &axis->key, line, name);
    rt_candidate_color(results->experiment, line, color);
    const uint32_t rgb = (uint32_t)strtoul(color + 1, NULL, 16);
    const int marker = flat ? 0 : rt_plot_marker(number);
    for (uint32_t i = 0; i < count && !flat; i++)
        put_point(results, group, name, rgb, marker, &points[i], points[i].x, points[i].value, out);
    uint32_t least = 0, most = 0;
    for (uint32_t i = 0; i < axis->count; i++) {
        if (axis->places[i] < axis->places[least]) least = i;
        if (axis->places[i] > axis->places[most]) most = i;
    }
    if (flat) {
        put_point(results, group, name, rgb, marker, points, axis->places[least], axis->values[least], out);
        put_point(results, group, name, rgb, marker, points, axis->places[most], axis->values[most], out);
    }
    if (count > 0) fputc('\n', out);
}

/* All groups in which the parameter has several values. */
static void put_groups(const RtResults *results, Axis *axis, FILE *out) {
    const RtExperiment *experiment = results->experiment;
    const RtSweptKey *key = &axis->key;
    bool drawn[RT_MAX_WORKLOADS] = {false};
    for (uint32_t t = 0; t < experiment->workload_count; t++) {
        Axis own = {.key = *key};
        if (is_first(experiment, key, name_group, t)) add_values(results, t, &own);
        drawn[t] = own.count > 1;
        if (drawn[t]) add_values(results, t, axis);
    }
    for (uint32_t t = 0; t < experiment->workload_count; t++) {
        uint32_t number = 0;
        for (uint32_t c = 0; drawn[t] && c < experiment->candidate_count; c++) {
            if (is_first(experiment, key, name_line, c)) put_line(results, axis, t, c, number++, out);
        }
        if (drawn[t]) fputc('\n', out);
    }
}

RtStatus rt_sweep_data_write(const RtResults *results, const char *directory, FILE *keys, FILE *axes,
                             RtError *error) {
    RtSweptKey swept[RT_MAX_SWEPT_KEYS];
    const uint32_t count = rt_experiment_swept(results->experiment, swept);
    for (uint32_t k = 0; k < count; k++) {
        Axis axis = {.key = swept[k]};
        char name[RT_MAX_NAME + 32];
        RtOutput output;
        snprintf(name, sizeof name, "plots/sweep-%s.tsv", swept[k].key);
        RT_TRY(rt_output_open_in(&output, directory, name, error));
        put_groups(results, &axis, output.file);
        RT_TRY(rt_output_commit(&output, error));
        if (axis.count < 2) continue;
        fprintf(keys, "%s ", swept[k].key);
        fprintf(axes, "%s ", kind_of_axis(&axis));
    }
    return RT_OK;
}
