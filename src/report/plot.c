/* SPDX-License-Identifier: Apache-2.0 */
#include "report/plot.h"

#include "accel/accel.h"
#include "core/base/memory.h"
#include "core/base/process.h"
#include "core/base/words.h"

#include <ctype.h>
#include <errno.h>
#include <fnmatch.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- colours ---- */

/* How far from its colour candidate `k` of `count` with the same one is drawn: the only one not at all,
 * several evenly from dark to light in the order of the experiment. No part of a dark colour is darker. */
static double shade(uint32_t color, uint32_t k, uint32_t count) {
    const bool dark = (color & 0xff) < 0x40 && (color >> 8 & 0xff) < 0x40 && color >> 16 < 0x40;
    const double darkest = dark ? 0 : -0.6, lightest = dark ? 0.65 : 0.5;
    return count == 1 ? 0 : darkest + (lightest - darkest) * k / (count - 1);
}

/* From black, -1, to white, 1. */
static uint32_t shaded(uint32_t color, double part) {
    uint32_t out = 0;
    for (int shift = 16; shift >= 0; shift -= 8) {
        const double channel = color >> shift & 255, to = part < 0 ? 0 : 255;
        const double size = part < 0 ? -part : part;
        out = out << 8 | (uint32_t)(channel + size * (to - channel) + 0.5);
    }
    return out;
}

void rt_candidate_color(const RtExperiment *experiment, uint32_t candidate, char color[RT_COLOR_CHARS]) {
    enum { NULL_RUN = 0xbbbbbb };
    uint32_t out = NULL_RUN;
    if (candidate < experiment->candidate_count) {
        const uint32_t own = rt_accel_color(experiment->candidates[candidate].spec);
        uint32_t earlier = 0, all = 0;
        for (uint32_t c = 0; c < experiment->candidate_count; c++) {
            bool same =
                rt_accel_color(experiment->candidates[c].spec) == own && !experiment->candidates[c].tried;
            earlier += same && c < candidate;
            all += same;
        }
        out = shaded(own, shade(own, earlier, all));
    }
    snprintf(color, RT_COLOR_CHARS, "#%06x", (unsigned)(out & 0xffffff));
}

/* gnuplot's pointtype, and its dashtype, 1..5, of line `i`, or of candidate `i` in the order of the
 * experiment: for grey print no two of 50 share both. */
static int marker_of(uint32_t i) {
    /* Filled and open circles, squares, triangles, diamonds, ... */
    static const int markers[] = {7, 5, 9, 11, 13, 6, 4, 8, 10, 12};
    return markers[i % 10];
}

static int dash_of(uint32_t i) {
    return (int)(1 + i / 10 % 5);
}

/* ---- data of sweeps ---- */

/* What experiments/sweeps.gp draws of a swept parameter: the cost of accelerators over its values, in a block
 * for each group of scenes that differ only in the parameter, and there a line for each accelerator. */

#define MAX_LINE_NAME (RT_MAX_LABEL + RT_MAX_SWEPT * (RT_MAX_NAME + RT_MAX_SWEPT_CHARS + 2))

/* The values of a parameter in the order of the experiment, and their places on the axis: words are numbered.
 */
typedef struct Axis {
    RtSweptKey key;
    const char *values[RT_MAX_SWEEP_VALUES];
    double places[RT_MAX_SWEEP_VALUES];
    uint32_t count;
    uint32_t group_of[RT_MAX_WORKLOADS], line_of[RT_MAX_CANDIDATES]; /* the first of each */
} Axis;

typedef struct Point {
    double x;
    const char *value;
    uint32_t workload, candidate;
} Point;

/* Scenes are in one group, and candidates on one line, if they have the same name without the parameter. */
static void name_without(const RtExperiment *experiment, const RtSweptKey *key, bool scene, uint32_t i,
                         char name[MAX_LINE_NAME]) {
    const RtWorkload *workload = &experiment->workloads[scene ? i : 0];
    const RtCandidate *candidate = &experiment->candidates[scene ? 0 : i];
    if (key->scene == scene) {
        snprintf(name, MAX_LINE_NAME, "%s", scene ? workload->stem : candidate->stem);
        rt_swept_name(scene ? &workload->swept : &candidate->swept, key->key, name, MAX_LINE_NAME);
    } else {
        snprintf(name, MAX_LINE_NAME, "%s", scene ? workload->label : candidate->label);
    }
}

/* first[0..count): the first scene or candidate with the same name. */
static void find_first(const RtExperiment *experiment, const RtSweptKey *key, bool scene, uint32_t count,
                       uint32_t *first) {
    char name[MAX_LINE_NAME], other[MAX_LINE_NAME];
    for (uint32_t i = 0; i < count; i++) {
        name_without(experiment, key, scene, i, name);
        for (first[i] = 0; first[i] < i; first[i]++) {
            name_without(experiment, key, scene, first[i], other);
            if (strcmp(name, other) == 0) break;
        }
    }
}

static bool is_measured(const RtResults *results, uint32_t t, uint32_t c) {
    const RtCost cost = rt_results_cost(results, t, c, RT_ALL_RAYS);
    if (results->experiment->candidates[c].tried) return false;
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
            if (value && axis->group_of[t] == first && is_measured(results, t, c)) add_value(axis, value);
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
        if (axis->group_of[t] != first) continue;
        for (uint32_t c = line; c < experiment->candidate_count; c++) {
            const char *value = rt_swept_of(experiment, &axis->key, t, c);
            if (count == RT_MAX_SWEEP_VALUES || axis->line_of[c] != line || !is_measured(results, t, c))
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
    name_without(results->experiment, &axis->key, true, first, group);
    name_without(results->experiment, &axis->key, false, line, name);
    rt_candidate_color(results->experiment, line, color);
    const uint32_t rgb = (uint32_t)strtoul(color + 1, NULL, 16);
    const int marker = flat ? 0 : marker_of(number);
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
    bool drawn[RT_MAX_WORKLOADS] = {false};
    find_first(experiment, &axis->key, true, experiment->workload_count, axis->group_of);
    find_first(experiment, &axis->key, false, experiment->candidate_count, axis->line_of);
    for (uint32_t t = 0; t < experiment->workload_count; t++) {
        Axis own = *axis;
        own.count = 0;
        if (axis->group_of[t] == t) add_values(results, t, &own);
        drawn[t] = own.count > 1;
        if (drawn[t]) add_values(results, t, axis);
    }
    for (uint32_t t = 0; t < experiment->workload_count; t++) {
        uint32_t number = 0;
        for (uint32_t c = 0; drawn[t] && c < experiment->candidate_count; c++) {
            if (axis->line_of[c] == c) put_line(results, axis, t, c, number++, out);
        }
        if (drawn[t]) fputc('\n', out);
    }
}

/* Writes DIR/plots/sweep-KEY.tsv for each swept parameter that varies in the results, over all kinds of rays,
 * and appends "KEY KEY ..." to `keys`, and "log", "linear" or "words" for each to `axes`. Columns of a file,
 * which has no header: group of scenes, line, colour as a number, marker (0: the line lacks the parameter and
 * spans the axis), place of the value on the axis, the value, ns per ray with its interval, object tests and
 * steps per ray. A blank line is between lines, two are between groups. */
static RtStatus write_sweep_data(const RtResults *results, const char *directory, FILE *keys, FILE *axes,
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

enum { MOST_SCRIPTS = RT_MAX_PLOTS + 4 };

/* ---- variables ---- */

/* Whether times.csv or counts.csv has rows of the candidate, it is the first of its label, and not only
 * tried.
 */
static bool has_rows(const RtResults *results, uint32_t candidate) {
    const RtCandidate *candidates = results->experiment->candidates;
    for (uint32_t c = 0; c < candidate; c++) {
        if (strcmp(candidates[c].label, candidates[candidate].label) == 0) return false;
    }
    for (uint32_t t = 0; t < results->experiment->workload_count; t++) {
        for (uint32_t k = 0; k < RT_RAY_KIND_COUNT; k++) {
            const RtCell *cell = rt_cell_at(results, t, candidate, (RtRayKind)k);
            if (cell->counted || cell->timed || cell->chosen) return !candidates[candidate].tried;
        }
    }
    return false;
}

static bool has_rays(const RtResults *results, RtRayKind kind) {
    for (uint32_t t = 0; t < results->experiment->workload_count; t++) {
        if (results->workloads[t].rays[kind]) return true;
    }
    return false;
}

/* "SCENE/KIND=WEIGHT ...", for weight() of style.gp: the weight of each set of rays in sums over kinds. */
static void put_sets(const RtResults *results, FILE *out) {
    const RtExperiment *experiment = results->experiment;
    for (uint32_t t = 0; t < experiment->workload_count; t++) {
        for (uint32_t k = 0; k < experiment->kind_count; k++) {
            const RtRayKind kind = experiment->kinds[k];
            if (results->workloads[t].rays[kind])
                fprintf(out, "%s/%s=%.0f ", experiment->workloads[t].label,
                        rt_experiment_kind_name(experiment, kind), rt_results_weight(results, t, kind));
        }
    }
}

static void put_candidate(const RtExperiment *experiment, uint32_t c, const char *list, FILE *out) {
    char color[RT_COLOR_CHARS];
    rt_candidate_color(experiment, c, color);
    if (strcmp(list, "accels") == 0) fprintf(out, "%s ", experiment->candidates[c].label);
    if (strcmp(list, "colors") == 0) fprintf(out, "%s ", color);
    if (strcmp(list, "markers") == 0) fprintf(out, "%d ", marker_of(c));
    if (strcmp(list, "dashes") == 0) fprintf(out, "%d ", dash_of(c));
    if (strcmp(list, "groups") == 0) fprintf(out, "\\\"%s\\\" ", experiment->candidates[c].group);
}

/* What style.gp says; labels hold nothing that gnuplot's double quotes would interpret
 * (rt_experiment_check). */
static void put_variables(const RtResults *results, const char *shared, const char *format, bool column,
                          FILE *out) {
    static const char *const lists[] = {"accels", "colors", "markers", "dashes", "groups"};
    const RtExperiment *experiment = results->experiment;
    fprintf(out, "shared = \"%s\"; experiment = \"%s\"; format = \"%s\"; paper = \"%s\"; scenes = \"", shared,
            experiment->name, format, column ? "column" : "page");
    for (uint32_t t = 0; t < experiment->workload_count; t++) {
        if (results->workloads[t].known) fprintf(out, "%s ", experiment->workloads[t].label);
    }
    fputs("\"; files = \"", out);
    for (uint32_t t = 0; t < experiment->workload_count; t++) {
        if (results->workloads[t].known) fprintf(out, "%s ", experiment->workloads[t].file_name);
    }
    for (size_t i = 0; i < sizeof lists / sizeof lists[0]; i++) {
        fprintf(out, "\"; %s = \"", lists[i]);
        for (uint32_t c = 0; c < experiment->candidate_count; c++) {
            if (has_rows(results, c)) put_candidate(experiment, c, lists[i], out);
        }
    }
    fprintf(out, "\"; baseline = \"%s\"; without = \"%s\"; among = \"%s\"; kinds = \"",
            rt_baseline_label(experiment), experiment->frame.without, experiment->frame.among);
    for (uint32_t k = 0; k < experiment->kind_count; k++) {
        if (has_rays(results, experiment->kinds[k]))
            fprintf(out, "%s ", rt_ray_kind_name(experiment->kinds[k]));
    }
    fputs("\"; sets = \"", out);
    put_sets(results, out);
    fputs("\"", out);
}

/* ---- gnuplot ---- */

/* Whether gnuplot drew everything: it only warns of a file that it could not open. Else reports the end of
 * its log, which names the script and the line; if that is empty, the scripts. */
static RtStatus check_drawing(int code, char **arguments, const char *directory, RtError *error) {
    enum { MOST_BYTES = 1 << 24, MOST_SHOWN = 600 };
    char path[RT_MAX_PATH], scripts[MOST_SHOWN] = "", *log;
    size_t size;
    RT_TRY(rt_path_join(directory, "plots/gnuplot.log", path, error));
    RT_TRY(rt_file_read(path, MOST_BYTES, &log, &size, error));
    const bool drawn = code == 0 && !strstr(log, "Cannot find or open file");
    for (char **script = arguments + 4; *script; script++) /* without those that are always there */
        rt_append_text(scripts, sizeof scripts, " %s", *script);
    while (size > 0 && isspace((unsigned char)log[size - 1])) log[--size] = '\0';
    const char *last = size > MOST_SHOWN ? log + size - MOST_SHOWN : log;
    while (isspace((unsigned char)*last)) last++;
    if (!drawn)
        rt_fail(error, RT_MISMATCH, "%s: gnuplot failed%s%s", directory,
                *last ? ":\n" : " without a message; its scripts:", *last ? last : scripts);
    rt_free(log);
    return drawn ? RT_OK : RT_MISMATCH;
}

/* Runs gnuplot in `directory` with the scripts as arguments, its messages going to plots/gnuplot.log. */
static RtStatus run_gnuplot(char **arguments, const char *directory, RtError *error) {
    const RtProcessCommand command = {
        .arguments = arguments, .directory = directory, .out = "/dev/null", .log = "plots/gnuplot.log"};
    RtProcessEnd end;
    RtStatus status = rt_process_run(&command, &end, error);
    if (status == RT_NOT_AVAILABLE)
        return rt_fail(
            error, status,
            "gnuplot is not installed, so no plots were drawn; `raytally plot %s` draws them later",
            directory);
    RT_TRY(status);
    return check_drawing(end.code, arguments, directory, error);
}

/* gnuplot does not say when the disk is full: whether the file ends as files in its format do. */
static bool is_whole(const char *path) {
    char tail[16] = "";
    FILE *file = fopen(path, "re");
    if (!file) return false;
    const bool end =
        fseek(file, -(long)(sizeof tail - 1), SEEK_END) == 0 && fread(tail, 1, sizeof tail - 1, file) > 0;
    fclose(file);
    return end && (strstr(tail, "</svg>") || strstr(tail, "%%EOF"));
}

/* Renames the files that the scripts wrote, or removes them if drawing failed. */
typedef struct Settling {
    bool keep;
    RtStatus status;
    RtError *error;
} Settling;

static void settle_file(void *context, const char *path) {
    Settling *settling = context;
    char name[RT_MAX_PATH];
    snprintf(name, sizeof name, "%.*s", (int)(strlen(path) - strlen(".tmp")), path);
    if (!settling->keep)
        remove(path);
    else if (!is_whole(path))
        settling->status =
            rt_fail(settling->error, RT_IO, "%s: gnuplot wrote only a part of it: is the disk full?", name);
    else if (rename(path, name) != 0)
        settling->status = rt_fail(settling->error, RT_IO, "%s: renaming failed: %s", path, strerror(errno));
}

/* Those in a format, "svg" or "pdf". */
static RtStatus settle(const char *directory, const char *format, bool keep, RtError *error) {
    char plots[RT_MAX_PATH], end[16];
    Settling settling = {keep, RT_OK, error};
    snprintf(end, sizeof end, ".%s.tmp", format);
    RT_TRY(rt_path_join(directory, "plots", plots, error));
    errno = 0;
    const size_t count = rt_directory_each(plots, end, settle_file, &settling);
    if (count > 0 || errno == 0) return settling.status;
    return rt_fail(error, RT_IO, "%s: reading the folder failed: %s", plots, strerror(errno));
}

/* What is drawn: the variables of all formats, and the paths of the scripts. */
typedef struct Drawing {
    const RtResults *results;
    const char *directory;
    bool column;
    RtMemoryFile sweeps, axes; /* of sweeps.gp */
    char shared[RT_MAX_PATH];
    char scripts[MOST_SCRIPTS][RT_MAX_PATH];
    uint32_t script_count;
} Drawing;

static RtStatus draw(const Drawing *drawing, const char *format, RtError *error) {
    char program[] = "gnuplot", option[] = "-e";
    char *arguments[MOST_SCRIPTS + 4] = {program, option};
    RtMemoryFile variables;
    RT_TRY(rt_memory_file_open(&variables, error));
    put_variables(drawing->results, drawing->shared, format, drawing->column, variables.file);
    fprintf(variables.file, "; sweeps = \"%s\"; axes = \"%s\"", drawing->sweeps.data, drawing->axes.data);
    RT_TRY(rt_memory_file_close(&variables, "variables of plots", error));
    arguments[2] = variables.data;
    for (uint32_t i = 0; i < drawing->script_count; i++) arguments[3 + i] = (char *)drawing->scripts[i];
    settle(drawing->directory, format, false, NULL); /* of an interrupted drawing */
    RtStatus status = run_gnuplot(arguments, drawing->directory, error);
    if (status == RT_OK) status = settle(drawing->directory, format, true, error);
    if (status != RT_OK) settle(drawing->directory, format, false, NULL);
    rt_free(variables.data);
    return status;
}

static void add_shipped(Drawing *drawing, const char *name) {
    if (rt_scripts_shipped(name, drawing->scripts[drawing->script_count])) drawing->script_count++;
}

/* Whether any accelerator beside the baseline has a ratio to it. */
static bool has_ratios(const RtResults *results) {
    for (RtCellCursor at = {0}; rt_results_next(results, &at);) {
        if (at.cell->timed && at.cell->baseline != at.candidate && isfinite(at.cell->ratio.median))
            return true;
    }
    return false;
}

/* How many accelerators have rows in counts.csv. */
static uint32_t count_counted(const RtResults *results) {
    bool counted[RT_MAX_CANDIDATES + 1] = {false};
    uint32_t count = 0;
    for (RtCellCursor at = {0}; rt_results_next(results, &at);) {
        const bool exact = at.cell->counted && rt_build_at(results, at.workload, at.candidate)->counts;
        count += exact && !counted[at.candidate];
        counted[at.candidate] |= exact;
    }
    return count;
}

static RtStatus choose_scripts(Drawing *drawing, RtScripts allowed, RtError *error) {
    const RtResults *results = drawing->results;
    const RtExperiment *experiment = results->experiment;
    RT_TRY(rt_scripts_folder(drawing->shared, error));
    add_shipped(drawing, "style.gp");
    for (uint32_t i = 0; i < experiment->plot_count; i++)
        rt_scripts_path(experiment, i, drawing->directory, allowed,
                        drawing->scripts[drawing->script_count++]);
    if (experiment->plot_count == 0) {
        if (*drawing->sweeps.data) {
            add_shipped(drawing, "sweeps.gp");
        } else {
            if (has_ratios(results)) add_shipped(drawing, "relative-time.gp");
            if (count_counted(results) > 1) add_shipped(drawing, "relative-counts.gp");
        }
    }
    if (experiment->distributions) add_shipped(drawing, "histograms.gp");
    return RT_OK;
}

/* The files that sweeps.gp reads, and its variables; they are empty if the experiment has scripts of its own.
 */
static RtStatus write_sweeps(Drawing *drawing, RtError *error) {
    RtStatus status = rt_memory_file_open(&drawing->sweeps, error);
    if (status == RT_OK) status = rt_memory_file_open(&drawing->axes, error);
    if (status == RT_OK && drawing->results->experiment->plot_count == 0)
        status = write_sweep_data(drawing->results, drawing->directory, drawing->sweeps.file,
                                  drawing->axes.file, error);
    RtMemoryFile *const files[] = {&drawing->sweeps, &drawing->axes};
    for (int i = 0; i < 2; i++) {
        if (!files[i]->file) continue;
        RtStatus closed = rt_memory_file_close(files[i], "sweeps", status == RT_OK ? error : NULL);
        if (status == RT_OK) status = closed;
    }
    return status;
}

static RtStatus draw_all(Drawing *drawing, RtScripts allowed, RtError *error) {
    RtError reason;
    RT_TRY(write_sweeps(drawing, error));
    RT_TRY(choose_scripts(drawing, allowed, error));
    if (drawing->script_count == 1) return RT_OK; /* style.gp alone */
    RT_TRY(draw(drawing, "svg", error));
    /* If only PDF fails, this gnuplot does not support it. */
    draw(drawing, "pdf", &reason);
    return RT_OK;
}

RtStatus rt_plots_draw(const RtResults *results, const char *directory, RtScripts allowed, bool column,
                       RtError *error) {
    RT_ARENA(arena);
    Drawing *drawing = rt_arena_alloc(&arena, 1, sizeof *drawing);
    RT_TRY(rt_arena_check(&arena, "plots", error));
    *drawing = (Drawing){.results = results, .directory = directory, .column = column};
    RtStatus status = draw_all(drawing, allowed, error);
    rt_free(drawing->sweeps.data);
    rt_free(drawing->axes.data);
    return status;
}

/* ---- captions ---- */

typedef struct Caption {
    const char *name;
    char *text; /* [RT_MAX_CAPTION] */
} Caption;

/* Of the lines "#: NAME: text", continued in lines "#:   text". */
static void take_caption(const Caption *caption, const char *script) {
    bool ours = false;
    for (const char *line = script; *line; line += strcspn(line, "\n"), line += *line == '\n') {
        if (strncmp(line, "#:", 2) != 0) continue;
        const char *text = line + 2 + strspn(line + 2, " ");
        if (strncmp(line, "#:   ", 5) != 0) {
            char name[RT_MAX_LABEL];
            const size_t length = strcspn(text, ":\n");
            snprintf(name, sizeof name, "%.*s", (int)length, text);
            ours = text[length] == ':' && fnmatch(name, caption->name, 0) == 0;
            text += ours ? length + 1 + strspn(text + length + 1, " ") : 0;
        }
        if (ours)
            rt_append_text(caption->text, RT_MAX_CAPTION, "%s%.*s", *caption->text ? " " : "",
                           (int)strcspn(text, "\n"), text);
    }
}

static void look_for_caption(void *context, const char *path) {
    enum { MOST_BYTES = 1 << 24 };
    const Caption *caption = context;
    char *script;
    size_t size;
    if (*caption->text || rt_file_read(path, MOST_BYTES, &script, &size, NULL) != RT_OK) return;
    take_caption(caption, script);
    rt_free(script);
}

void rt_plot_caption(const RtExperiment *experiment, const char *directory, const char *name,
                     char text[RT_MAX_CAPTION]) {
    static const char *const standard[] = {"sweeps.gp", "relative-time.gp", "relative-counts.gp",
                                           "histograms.gp"};
    char path[RT_MAX_PATH];
    Caption caption = {name, text};
    *text = '\0';
    if (rt_path_join(directory, "plots", path, NULL) == RT_OK)
        rt_directory_each(path, ".gp", look_for_caption, &caption);
    for (uint32_t i = 0; i < experiment->plot_count; i++) {
        if (rt_scripts_shipped(rt_plot_name(experiment, i), path)) look_for_caption(&caption, path);
    }
    for (size_t i = 0; i < sizeof standard / sizeof standard[0]; i++) {
        if (rt_scripts_shipped(standard[i], path)) look_for_caption(&caption, path);
    }
}
