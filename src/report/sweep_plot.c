/* SPDX-License-Identifier: Apache-2.0 */
#include "report/sweep_plot.h"

#include "core/base/memory.h"
#include "report/color.h"
#include "report/page.h"
#include "style_gp.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_TICS = 8, NAME_CHARS = RT_MAX_LABEL + RT_MAX_SWEPT * (RT_MAX_NAME + RT_MAX_SWEPT_CHARS + 2) };

typedef struct Line {
    char name[NAME_CHARS];
    uint32_t candidate; /* the first, whose colour it has */
    bool flat;          /* without the parameter: the same at each value */
    double last;        /* its cost at the right end */
} Line;

typedef struct Point {
    uint32_t line;
    double x;
    RtCost cost;
} Point;

/* A figure: the cost of some lines over the values of one parameter. */
typedef struct Figure {
    const RtResults *results;
    RtSweptKey key;
    bool timed;
    uint32_t line_count, point_count, value_count;
    Line *lines;                                         /* [candidate_count] */
    Point *points;                                       /* [workload_count * candidate_count] */
    char words[RT_MAX_SWEEP_VALUES][RT_MAX_SWEPT_CHARS]; /* values that are no numbers */
    double values[RT_MAX_SWEEP_VALUES];                  /* increasing */
} Figure;

bool rt_sweep_plots_needed(const RtExperiment *experiment) {
    RtSweptKey keys[RT_MAX_SWEPT_KEYS];
    return experiment->plot_count == 0 && rt_experiment_swept(experiment, keys) > 0;
}

/* ---- what is drawn ---- */

/* The position of a value on the axis; words are numbered. */
static double place_of(Figure *figure, const char *value) {
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

static void name_line(const Figure *figure, uint32_t c, char name[NAME_CHARS]) {
    const RtCandidate *candidate = &figure->results->experiment->candidates[c];
    snprintf(name, NAME_CHARS, "%s", figure->key.scene ? candidate->label : candidate->stem);
    if (!figure->key.scene) rt_swept_name(&candidate->swept, figure->key.key, name, NAME_CHARS);
}

static uint32_t line_of(Figure *figure, uint32_t c, bool flat) {
    char name[NAME_CHARS];
    uint32_t line = 0;
    name_line(figure, c, name);
    while (line < figure->line_count && strcmp(figure->lines[line].name, name) != 0) line++;
    if (line < figure->line_count) return line;
    figure->lines[line] = (Line){.candidate = c, .flat = flat, .last = NAN};
    strcpy(figure->lines[line].name, name);
    return figure->line_count++;
}

static double cost_of(const Figure *figure, const RtCost *cost) {
    return figure->timed ? cost->seconds.median : cost->object_tests;
}

/* The common name of the scenes of one figure: everything except the parameter. */
static void name_group(const RtExperiment *experiment, const RtSweptKey *key, uint32_t t,
                       char name[NAME_CHARS]) {
    const RtWorkload *workload = &experiment->workloads[t];
    snprintf(name, NAME_CHARS, "%s", key->scene ? workload->stem : workload->label);
    if (key->scene) rt_swept_name(&workload->swept, key->key, name, NAME_CHARS);
}

static bool same_group(const RtExperiment *experiment, const RtSweptKey *key, uint32_t t, uint32_t other) {
    char name[NAME_CHARS], others[NAME_CHARS];
    name_group(experiment, key, t, name);
    name_group(experiment, key, other, others);
    return strcmp(name, others) == 0;
}

static int by_place(const void *a, const void *b) {
    const Point *p = a, *q = b;
    if (p->line != q->line) return p->line < q->line ? -1 : 1;
    return (p->x > q->x) - (p->x < q->x);
}

static void add_point(Figure *figure, uint32_t line, double x, const RtCost *cost) {
    figure->points[figure->point_count++] = (Point){line, x, *cost};
    figure->timed |= !isnan(cost->seconds.median);
}

/* The lines of the group of scene `first`. */
static void gather(Figure *figure, uint32_t first) {
    const RtResults *results = figure->results;
    const RtExperiment *experiment = results->experiment;
    figure->line_count = figure->point_count = figure->value_count = 0;
    figure->timed = false;
    for (uint32_t t = first; t < experiment->workload_count; t++) {
        if (!results->workloads[t].known || !same_group(experiment, &figure->key, first, t)) continue;
        for (uint32_t c = 0; c < experiment->candidate_count; c++) {
            const char *value = rt_swept_of(experiment, &figure->key, t, c);
            const RtCost cost = rt_results_cost(results, t, c, RT_ALL_RAYS);
            if (isnan(cost.seconds.median) && isnan(cost.object_tests)) continue;
            uint32_t line = line_of(figure, c, !value);
            add_point(figure, line, value ? place_of(figure, value) : -INFINITY, &cost);
        }
    }
    /* Lines without the parameter span the axis. */
    for (uint32_t i = 0, count = figure->point_count; i < count && figure->value_count; i++) {
        Point *point = &figure->points[i];
        if (isfinite(point->x)) continue;
        point->x = figure->values[0];
        add_point(figure, point->line, figure->values[figure->value_count - 1], &point->cost);
    }
    qsort(figure->points, figure->point_count, sizeof(Point), by_place);
    for (uint32_t i = 0; i < figure->point_count; i++)
        figure->lines[figure->points[i].line].last = cost_of(figure, &figure->points[i].cost);
}

/* ---- the script ---- */

static void put_number(FILE *out, double number) {
    if (isnan(number)) {
        fputs(",NaN", out);
    } else {
        fprintf(out, ",%.9g", number);
    }
}

static void put_data(const Figure *figure, FILE *out) {
    for (uint32_t line = 0; line < figure->line_count; line++) {
        fprintf(out, "$line%u << EOD\nx,ns,low,high,object_tests,steps\n", line + 1);
        for (uint32_t i = 0; i < figure->point_count; i++) {
            const Point *point = &figure->points[i];
            if (point->line != line) continue;
            fprintf(out, "%.9g", point->x);
            put_number(out, 1e9 * point->cost.seconds.median);
            put_number(out, 1e9 * point->cost.seconds.low);
            put_number(out, 1e9 * point->cost.seconds.high);
            put_number(out, point->cost.object_tests);
            put_number(out, point->cost.steps);
            fputc('\n', out);
        }
        fputs("EOD\n", out);
    }
}

/* The colour of the line's first accelerator; marker and dash distinguish lines in grey print. */
static void put_styles(const Figure *figure, FILE *out) {
    const RtExperiment *experiment = figure->results->experiment;
    for (uint32_t line = 0; line < figure->line_count; line++) {
        const Line *l = &figure->lines[line];
        char color[RT_COLOR_CHARS];
        rt_candidate_color(experiment, l->candidate, color);
        fprintf(out,
                "set style line %u linecolor rgb \"%s\" dashtype %d pointtype %d pointsize %s linewidth 1.6 "
                "pointinterval %u\n",
                line + 1, color, l->flat ? 2 + (int)(line % 4) : rt_plot_dash(line),
                l->flat ? 0 : rt_plot_marker(line), l->flat ? "0.1" : "0.55", 1 + figure->value_count / 16);
    }
}

/* The order of the lines at the right of the first panel, from top to bottom. */
static void put_order(const Figure *figure, FILE *out) {
    bool *put = rt_alloc(figure->line_count, sizeof(bool));
    fputs("order = \"", out);
    for (uint32_t n = 0; put && n < figure->line_count; n++) {
        uint32_t best = figure->line_count;
        for (uint32_t line = 0; line < figure->line_count; line++) {
            bool above = best == figure->line_count || figure->lines[line].last > figure->lines[best].last;
            if (!put[line] && above) best = line;
        }
        put[best] = true;
        fprintf(out, "%u ", best + 1);
    }
    rt_free(put);
    fputs("\"\n", out);
}

/* Costs over more than a decade get a logarithmic axis, others one that begins at 0. */
static bool is_wide(const Figure *figure, int panel) {
    double least = INFINITY, most = 0;
    for (uint32_t i = 0; i < figure->point_count; i++) {
        const RtCost *cost = &figure->points[i].cost;
        double y = panel == 0 ? cost->seconds.median : panel == 1 ? cost->object_tests : cost->steps;
        if (!(y > 0)) continue;
        least = fmin(least, y);
        most = fmax(most, y);
    }
    return most > 10 * least;
}

static void put_axis(const Figure *figure, FILE *out) {
    const double *x = figure->values;
    uint32_t count = figure->value_count;
    fprintf(out, "set xlabel \"%s\" noenhanced textcolor rgb ink\n", figure->key.key);
    if (!figure->key.number) {
        fputs("set xtics rotate by -30 (", out);
        for (uint32_t i = 0; i < count; i++) fprintf(out, "%s\"%s\" %u", i ? "," : "", figure->words[i], i);
        fprintf(out, ")\nset xrange [-0.2:%.9g]\n", count - 0.8);
    } else if (rt_swept_logarithmic(x, count)) {
        fprintf(out, "set logscale x\nset xrange [%.9g:%.9g]\n", x[0] / 1.05, x[count - 1] * 1.05);
        /* Fewer than three decades: label the values themselves. */
        if (count <= MOST_TICS && x[count - 1] / x[0] < 1000) {
            for (uint32_t i = 0; i < count; i++)
                fprintf(out, "%s\"%.4g\" %.9g", i ? "," : "set xtics (", x[i], x[i]);
            fputs(")\n", out);
        }
        if (x[count - 1] / x[0] >= 1000) fputs("set format x \"10^{%T}\"\n", out);
    } else {
        double margin = 0.02 * (x[count - 1] - x[0]);
        fprintf(out, "set xrange [%.9g:%.9g]\n", x[0] - margin, x[count - 1] + margin);
    }
}

static void put_panels(const Figure *figure, double legend, FILE *out) {
    static const char *const titles[] = {"ns per ray", "object tests per ray", "steps per ray"};
    const int first = figure->timed ? 0 : 1;
    double wide = (1 - legend) / (3 - first);
    for (int panel = first; panel < 3; panel++) {
        double left = (panel - first) * wide;
        bool log = is_wide(figure, panel);
        fprintf(out, "set lmargin at screen %.4f; set rmargin at screen %.4f\n", left + 0.2 * wide,
                left + 0.97 * wide);
        fprintf(out, "set title \"%s\" textcolor rgb ink\n%s\n", titles[panel],
                log ? "set logscale y; set autoscale y" : "unset logscale y; set yrange [0:*]");
        fputs("plot for [i = 1:words(order)] '$line'.word(order, i) using 1:", out);
        fputs(panel == 0 ? "2" : panel == 1 ? "5" : "6", out);
        fputs(" with linespoints linestyle int(word(order, i)) notitle", out);
        if (panel == 0)
            fputs(", for [i = 1:words(order)] '$line'.word(order, i) using 1:3:(0):($4 - $3) with vectors "
                  "nohead linestyle int(word(order, i)) dashtype 1 linewidth 1 notitle",
                  out);
        fputs("\nunset label\n", out); /* only the first shows the group */
    }
}

/* One column in pixels from the top; gnuplot's own keys break into several. */
static void put_legend(double legend, double width, double height, FILE *out) {
    fprintf(
        out,
        "unset title; unset xlabel; unset tics; unset logscale; set border 0; unset grid; unset label\n"
        "set lmargin at screen %.4f; set rmargin at screen 1; set xrange [0:%.0f]; set yrange [%.0f:0]\n"
        "set tmargin at screen 1; set bmargin at screen 0\n"
        "$legend << EOD\nx\n6\n22\n38\nEOD\n"
        "do for [i = 1:words(order)] { set label i word(names, int(word(order, i))) at 46, 24 + 18 * i "
        "left noenhanced font ',11' textcolor rgb ink }\n"
        "plot for [i = 1:words(order)] $legend using 1:(24 + 18 * i) with lines linestyle "
        "int(word(order, i)) notitle, for [i = 1:words(order)] $legend using 1:(24 + 18 * i) every ::1::1 "
        "with points linestyle int(word(order, i)) notitle\n",
        1 - legend / width, legend, height);
}

static void put_figure(const Figure *figure, uint32_t number, const char *group, FILE *out) {
    size_t longest = 0;
    for (uint32_t i = 0; i < figure->line_count; i++) {
        size_t length = strlen(figure->lines[i].name);
        longest = length > longest ? length : longest;
    }
    uint32_t needed = 48 + 18 * figure->line_count, panels = figure->timed ? 3 : 2;
    double height = needed > 420 ? needed : 420;
    double legend = 70 + 7.0 * (double)(longest < RT_MAX_LABEL ? longest : RT_MAX_LABEL);
    double width = 270 * panels + legend;
    fprintf(out,
            "\n#: %02u-sweep-%s: %s per ray of the accelerators on %s over %s.\n#:   All kinds of rays "
            "together%s; the legend has the order of the lines at their right ends in the first panel.\n",
            number, figure->key.key,
            figure->timed ? "Time, object tests and steps" : "Object tests and steps", group, figure->key.key,
            figure->timed ? ", times with intervals" : "");
    fprintf(out, "reset session\nload \"plots/names.gp\"; load \"plots/style.gp\"\n");
    put_data(figure, out);
    put_styles(figure, out);
    put_order(figure, out);
    fputs("names = \"", out);
    for (uint32_t i = 0; i < figure->line_count; i++) fprintf(out, "%s ", figure->lines[i].name);
    fprintf(out, "\"\neval canvas(\"%02u-sweep-%s\", %.0f, %.0f)\n", number, figure->key.key, width, height);
    put_axis(figure, out);
    fprintf(out,
            "set grid xtics ytics\nset multiplot\n"
            "set label \"%s\" at screen %.4f, screen %.4f left noenhanced font ',14' textcolor rgb ink\n"
            "set tmargin at screen %.4f; set bmargin at screen %.4f\n",
            group, 12 / width, 1 - 16 / height, 1 - 66 / height, 66 / height);
    put_panels(figure, legend / width, out);
    put_legend(legend, width, height, out);
    fputs("unset multiplot\nunset output\n", out);
}

static void put_figures(Figure *figure, FILE *out) {
    const RtExperiment *experiment = figure->results->experiment;
    RtSweptKey keys[RT_MAX_SWEPT_KEYS];
    uint32_t count = rt_experiment_swept(experiment, keys), number = 0;
    fputs(
        "# Written by raytally: cost over each swept parameter, over all ray kinds. For your own plots name\n"
        "# gnuplot scripts under `plots` of the experiment.\n",
        out);
    for (uint32_t k = 0; k < count; k++) {
        figure->key = keys[k];
        for (uint32_t t = 0; t < experiment->workload_count; t++) {
            char group[NAME_CHARS];
            bool first = true;
            for (uint32_t before = 0; before < t; before++)
                first &= !same_group(experiment, &figure->key, before, t);
            if (!first) continue;
            gather(figure, t);
            name_group(experiment, &figure->key, t, group);
            if (figure->value_count > 1) put_figure(figure, ++number, group, out);
        }
    }
}

static RtStatus write_script(Figure *figure, const char *directory, RtError *error) {
    RtOutput output;
    RT_TRY(rt_output_open_in(&output, directory, "plots/sweep.gp", error));
    put_figures(figure, output.file);
    return rt_output_commit(&output, error);
}

static RtStatus write_style(const char *directory, RtError *error) {
    RtOutput output;
    RT_TRY(rt_output_open_in(&output, directory, "plots/style.gp", error));
    rt_page_lines(output.file, style_gp);
    return rt_output_commit(&output, error);
}

RtStatus rt_sweep_plots_write(const RtResults *results, const char *directory, RtError *error) {
    const size_t candidates = results->experiment->candidate_count;
    const size_t points = 2 * candidates * results->experiment->workload_count;
    RT_TRY(write_style(directory, error));
    Figure figure = {.results = results,
                     .lines = rt_alloc(candidates, sizeof(Line)),
                     .points = rt_alloc(points, sizeof(Point))};
    RtStatus status = figure.lines && figure.points ? write_script(&figure, directory, error)
                                                    : rt_fail_memory(error, "plots", points * sizeof(Point));
    rt_free(figure.lines);
    rt_free(figure.points);
    return status;
}
