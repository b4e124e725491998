/* SPDX-License-Identifier: Apache-2.0 */
#include "report/sweep_plot.h"

#include "core/base/memory.h"
#include "report/color.h"
#include "report/page.h"
#include "report/sweep_lines.h"
#include "results/paired.h"
#include "style_gp.h"

#include <math.h>
#include <string.h>

enum { MOST_TICS = 8 };

/* Lengths in pixels, for letters of 15.6. */
enum {
    COLUMN = 480,
    PAGE = 960,
    LEFT = 84,
    RIGHT = 24,
    TOP = 32,
    PANEL = 220,
    GAP = 66,
    BOTTOM = 58,
    WORDS = 18, /* higher than numbers, as they are inclined */
    ENTRY = 20
};

static const struct {
    const char *file, *title, *axis;
    int column; /* of the data */
} measures[] = {{"time", "Time per ray", "ns per ray", 2},
                {"object-tests", "Object tests per ray", "object tests per ray", 5},
                {"steps", "Steps per ray", "steps per ray", 6}};

bool rt_sweep_plots_needed(const RtExperiment *experiment) {
    RtSweptKey keys[RT_MAX_SWEPT_KEYS];
    return experiment->plot_count == 0 && rt_experiment_swept(experiment, keys) > 0;
}

/* ---- the script ---- */

static void put_number(FILE *out, double number) {
    if (isnan(number)) {
        fputs(",NaN", out);
    } else {
        fprintf(out, ",%.9g", number);
    }
}

/* The block $pGROUP_LINE. */
static void put_data(const RtSweepLines *figure, FILE *out) {
    const RtSweepPoint *before = NULL;
    for (uint32_t i = 0; i < figure->point_count; i++) {
        const RtSweepPoint *point = &figure->points[i];
        if (!before || before->group != point->group || before->line != point->line)
            fprintf(out, "%s$p%u_%u << EOD\nx,ns,low,high,object_tests,steps\n", before ? "EOD\n" : "",
                    point->group + 1, point->line + 1);
        fprintf(out, "%.9g", point->x);
        put_number(out, 1e9 * point->cost.seconds.median);
        put_number(out, 1e9 * point->cost.seconds.low);
        put_number(out, 1e9 * point->cost.seconds.high);
        put_number(out, point->cost.object_tests);
        put_number(out, point->cost.steps);
        fputc('\n', out);
        before = point;
    }
    fputs("EOD\n", out);
}

/* The colour of the line's first accelerator; marker and dash distinguish lines in grey print. */
static void put_styles(const RtSweepLines *figure, FILE *out) {
    const RtExperiment *experiment = figure->results->experiment;
    for (uint32_t line = 0; line < figure->line_count; line++) {
        const RtSweepLine *l = &figure->lines[line];
        char color[RT_COLOR_CHARS];
        rt_candidate_color(experiment, l->candidate, color);
        fprintf(out,
                "set style line %u linecolor rgb \"%s\" dashtype %d pointtype %d pointsize %s linewidth 1.6 "
                "pointinterval %u\n",
                line + 1, color, l->flat ? 2 + (int)(line % 4) : rt_plot_dash(line),
                l->flat ? 0 : rt_plot_marker(line), l->flat ? "0.1" : "0.55", 1 + figure->value_count / 16);
    }
}

static bool is_compared(const RtSweepLines *figure, uint32_t line) {
    return rt_candidate_is_compared(figure->results->experiment, figure->lines[line].candidate);
}

/* The range of all panels, without the yardstick, which would take most of a logarithmic axis. */
typedef struct Range {
    double least, most;
    bool logarithmic; /* costs over more than a decade; others begin at 0 */
} Range;

static Range range_of(const RtSweepLines *figure, RtSweepMeasure measure) {
    Range range = {INFINITY, 0, false};
    for (uint32_t i = 0; i < figure->point_count; i++) {
        const RtCost *cost = &figure->points[i].cost;
        const double y = rt_sweep_lines_cost(cost, measure), unit = measure == RT_SWEEP_TIME ? 1e9 : 1;
        if (!(y > 0) || !is_compared(figure, figure->points[i].line)) continue;
        range.least = fmin(range.least, unit * (measure == RT_SWEEP_TIME ? fmin(y, cost->seconds.low) : y));
        range.most = fmax(range.most, unit * (measure == RT_SWEEP_TIME ? fmax(y, cost->seconds.high) : y));
    }
    range.logarithmic = range.most > 10 * range.least;
    return range;
}

/* 1, 2 and 5 of each decade; of more than two decades the powers of ten. */
static void put_y_axis(const Range *range, FILE *out) {
    if (!(range->most > 0)) return;
    if (!range->logarithmic) {
        fprintf(out, "unset logscale y; set ytics autofreq; set yrange [0:%.9g]\n", 1.06 * range->most);
        return;
    }
    const double low = range->least / 1.3, high = range->most * 1.3;
    fprintf(out, "set logscale y; set yrange [%.9g:%.9g]; set ytics autofreq\n", low, high);
    if (high > 100 * low) return;
    static const int steps[] = {1, 2, 5};
    const char *before = "set ytics (";
    double decade = 1;
    while (decade > low) decade /= 10;
    while (10 * decade <= low) decade *= 10;
    while (decade <= high) {
        for (int i = 0; i < 3; i++) {
            const double tic = steps[i] * decade;
            if (tic < low || tic > high) continue;
            fprintf(out, "%s%.9g", before, tic);
            before = ",";
        }
        decade *= 10;
    }
    fputs(")\n", out);
}

static bool all_whole(const double *values, uint32_t count) {
    for (uint32_t i = 0; i < count; i++) {
        if (values[i] != floor(values[i])) return false;
    }
    return true;
}

static void put_x_axis(const RtSweepLines *figure, FILE *out) {
    const double *x = figure->values;
    const uint32_t count = figure->value_count;
    const double span = x[count - 1] - x[0];
    const bool logarithmic = figure->key.number && rt_swept_logarithmic(x, count);
    if (!figure->key.number) {
        fputs("set xtics rotate by -30 (", out);
        for (uint32_t i = 0; i < count; i++) fprintf(out, "%s\"%s\" %u", i ? "," : "", figure->words[i], i);
        fprintf(out, ")\nset xrange [-0.2:%.9g]\n", count - 0.8);
        return;
    }
    if (logarithmic)
        fprintf(out, "set logscale x\nset xrange [%.9g:%.9g]\n", x[0] / 1.05, x[count - 1] * 1.05);
    else
        fprintf(out, "set xrange [%.9g:%.9g]\n", x[0] - 0.02 * span, x[count - 1] + 0.02 * span);
    if (logarithmic && (x[count - 1] / x[0] >= 1000 || x[count - 1] >= 1e5)) {
        fputs("set format x \"10^{%T}\"\n", out);
    } else if (count <= MOST_TICS) { /* the values themselves */
        for (uint32_t i = 0; i < count; i++)
            fprintf(out, "%s\"%.6g\" %.9g", i ? "," : "set xtics (", x[i], x[i]);
        fputs(")\n", out);
    } else if (all_whole(x, count)) {
        if (!logarithmic && span < 2 * MOST_TICS) fprintf(out, "set xtics %.9g\n", ceil(span / MOST_TICS));
    }
}

/* A figure of one measure, in pixels. */
typedef struct Layout {
    RtSweepMeasure measure;
    uint32_t columns, rows, entries, entry_columns;
    double width, height, panel; /* panel: the width of one */
    double gap;                  /* between rows of panels */
    double entry;                /* the width of an entry of the legend */
} Layout;

static Layout lay_out(const RtSweepLines *figure, RtSweepMeasure measure, uint32_t entries) {
    const uint32_t most = figure->column ? 2 : 3; /* panels beside each other leave the letters room */
    Layout l = {.measure = measure, .entries = entries};
    size_t longest = 0;
    l.columns = figure->group_count < most ? figure->group_count : most;
    for (uint32_t i = 0; i < figure->line_count; i++) {
        const size_t length = strlen(figure->lines[i].name);
        longest = length > longest ? length : longest;
    }
    l.rows = (figure->group_count + l.columns - 1) / l.columns;
    l.width = figure->column || l.columns == 1 ? COLUMN : PAGE;
    l.panel = (l.width - LEFT) / l.columns - RIGHT;
    l.entry_columns = (uint32_t)((l.width - RIGHT) / (64 + 8.8 * (double)longest));
    if (l.entry_columns < 1) l.entry_columns = 1;
    l.entry = (l.width - RIGHT) / l.entry_columns;
    const uint32_t entry_rows = (entries + l.entry_columns - 1) / l.entry_columns;
    l.gap = figure->key.number ? GAP : GAP + WORDS;
    l.height = TOP + l.rows * (PANEL + l.gap) - GAP + BOTTOM + ENTRY * entry_rows + 8;
    return l;
}

/* Below the panels, in the order of the lines, row by row. A yardstick below the axis is named so. */
static void put_legend(const RtSweepLines *figure, const Layout *l, const uint32_t *order, const Range *range,
                       FILE *out) {
    const uint32_t rows = (l->entries + l->entry_columns - 1) / l->entry_columns;
    for (uint32_t i = 0; i < l->entries; i++) {
        const uint32_t line = order[i];
        const double x = 12 + l->entry * (i % l->entry_columns);
        const uint32_t row = i / l->entry_columns;
        const double y = ENTRY * (rows - row) - 6;
        const double unit = l->measure == RT_SWEEP_TIME ? 1e9 : 1;
        const bool below = !is_compared(figure, line) && range->logarithmic &&
                           unit * rt_sweep_lines_last(figure, line, l->measure) < range->least / 1.3;
        fprintf(out,
                "set arrow %u from screen %.4f, screen %.4f to screen %.4f, screen %.4f nohead linestyle %u\n"
                "set label %u \"%s%s\" at screen %.4f, screen %.4f left noenhanced point linestyle %u "
                "offset screen %.4f, 0 textcolor rgb ink\n",
                i + 1, x / l->width, y / l->height, (x + 32) / l->width, y / l->height, line + 1, i + 1,
                figure->lines[line].name, below ? " (below)" : "", (x + 16) / l->width, y / l->height,
                line + 1, 22 / l->width);
    }
}

static void put_panel(const RtSweepLines *figure, const Layout *l, const uint32_t *order, const Range *range,
                      uint32_t group, FILE *out) {
    const uint32_t column = group % l->columns, row = group / l->columns;
    const double left = LEFT + column * (l->panel + RIGHT);
    const double top = TOP + row * (PANEL + l->gap);
    const bool lowest = group + l->columns >= figure->group_count;
    char name[RT_MAX_SWEEP_NAME];
    rt_sweep_lines_group_name(figure->results->experiment, &figure->key, figure->groups[group], name);
    fprintf(out,
            "set lmargin at screen %.4f; set rmargin at screen %.4f; set tmargin at screen %.4f; "
            "set bmargin at screen %.4f\n",
            left / l->width, (left + l->panel) / l->width, 1 - top / l->height,
            1 - (top + PANEL) / l->height);
    fprintf(out, "set title \"%s\" noenhanced textcolor rgb ink offset 0, -0.4\n", name);
    if (column == 0)
        fprintf(out, "set ylabel \"%s\" textcolor rgb ink; set format y \"%s\"\n", measures[l->measure].axis,
                range->logarithmic && range->most * 1.3 >= 1e5 ? "10^{%T}" : "%g");
    else
        fputs("unset ylabel; set format y \"\"\n", out);
    if (lowest)
        fprintf(out, "set xlabel \"%s\" noenhanced textcolor rgb ink\n", figure->key.key);
    else
        fputs("unset xlabel\n", out);
    fputs("order = \"", out);
    for (uint32_t i = 0; i < l->entries; i++) {
        if (rt_sweep_lines_has(figure, group, order[i], l->measure)) fprintf(out, "%u ", order[i] + 1);
    }
    fprintf(out,
            "\"\nplot for [i = 1:words(order)] '$p%u_'.word(order, i) using 1:%d with linespoints "
            "linestyle int(word(order, i)) notitle",
            group + 1, measures[l->measure].column);
    if (l->measure == RT_SWEEP_TIME)
        fprintf(
            out,
            ", for [i = 1:words(order)] '$p%u_'.word(order, i) using 1:3:(0):($4 - $3) with vectors heads "
            "size graph 0.01, 90 nofilled linestyle int(word(order, i)) dashtype 1 linewidth 1.6 notitle",
            group + 1);
    fputs("\nunset arrow; unset label\n", out); /* the legend, once */
}

static void put_figure(const RtSweepLines *figure, RtSweepMeasure measure, uint32_t number, FILE *out) {
    uint32_t order[RT_MAX_CANDIDATES];
    const Layout l = lay_out(figure, measure, rt_sweep_lines_order(figure, measure, order));
    const Range range = range_of(figure, measure);
    const RtResults *results = figure->results;
    char name[RT_MAX_SWEEP_NAME + 16], part[RT_MAX_PART_TEXT];
    rt_results_say_part(results, UINT32_MAX, rt_experiment_kinds(results->experiment), part);
    snprintf(name, sizeof name, "%02u-sweep-%s-%s", number, figure->key.key, measures[measure].file);
    fprintf(
        out,
        "\n#: %s: %s over %s, a line per accelerator, a panel per scene.\n#:   All kinds of rays together, "
        "%s%s. "
        "All panels have the same scales; the legend has the order of the lines at the right of the first "
        "panel.\n",
        name, measures[measure].title, figure->key.key, part,
        measure == RT_SWEEP_TIME ? ", medians with intervals" : "");
    fprintf(out, "eval canvas(\"%s\", %.0f, %.0f)\nset multiplot\n", name, l.width, l.height);
    put_y_axis(&range, out);
    put_legend(figure, &l, order, &range, out);
    for (uint32_t group = 0; group < figure->group_count; group++)
        put_panel(figure, &l, order, &range, group, out);
    fputs("unset multiplot\nunset output\n", out);
}

static void put_figures(RtSweepLines *figure, FILE *out) {
    RtSweptKey keys[RT_MAX_SWEPT_KEYS];
    const uint32_t count = rt_experiment_swept(figure->results->experiment, keys);
    uint32_t number = 0;
    fputs(
        "# Written by raytally: cost over each swept parameter, over all ray kinds. For your own plots name\n"
        "# gnuplot scripts under `plots` of the experiment.\n",
        out);
    for (uint32_t k = 0; k < count; k++) {
        figure->key = keys[k];
        rt_sweep_lines_gather(figure);
        if (figure->group_count == 0) continue;
        fputs("\nreset session\nload \"plots/names.gp\"; load \"plots/style.gp\"\nset grid xtics ytics\n",
              out);
        put_data(figure, out);
        put_styles(figure, out);
        put_x_axis(figure, out);
        for (RtSweepMeasure m = figure->timed ? RT_SWEEP_TIME : RT_SWEEP_OBJECT_TESTS; m < RT_SWEEP_MEASURES;
             m++)
            put_figure(figure, m, ++number, out);
    }
}

static RtStatus write_script(RtSweepLines *figure, const char *directory, RtError *error) {
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

RtStatus rt_sweep_plots_write(const RtResults *results, const char *directory, bool column, RtError *error) {
    const RtExperiment *experiment = results->experiment;
    const size_t points = (size_t)2 * experiment->candidate_count * experiment->workload_count;
    RT_TRY(write_style(directory, error));
    RtSweepLines figure = {
        .results = results, .column = column, .points = rt_alloc(points, sizeof(RtSweepPoint))};
    if (!figure.points) return rt_fail_memory(error, "plots", points * sizeof(RtSweepPoint));
    RtStatus status = write_script(&figure, directory, error);
    rt_free(figure.points);
    return status;
}
