/* SPDX-License-Identifier: Apache-2.0 */
/* The page: question, verdict, finding and plots as HTML; tables, machine and method as data for page.js.
 * Plots and images are data URLs: the file can be mailed. */
#include "report/report.h"

#include "core/base/memory.h"
#include "core/base/words.h"
#include "core/text/json.h"
#include "measure/result_files.h"
#include "report/page.h"
#include "report/plot.h"
#include "results/result_directory.h"
#include "results/result_tables.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- tables.md and tables.tex ---- */

/* Writes `directory`/tables.md and tables.tex (for the package booktabs): for each measure a table with a row
 * per accelerator and a column per scene, all kinds of rays together; and for each kind of rays one of the
 * times, or of the object tests if nothing was timed. Each sweep of a scene has tables of its own, a column
 * per value. In LaTeX the letters have 8 points; a table too wide for one column of a two-column article
 * takes both, and one too wide for these is divided. The best is bold, and so is every interval that
 * overlaps with it. */

/* Characters of `footnotesize` (8 points) that fit a column and a page of a two-column article. */
enum { COLUMN_WIDTH = 50, PAGE_WIDTH = 104 };

typedef enum Measure { TIME, OBJECT_TESTS, EXTENT_TESTS, STEPS, BUILD, RATIO } Measure;
static const char *const titles[] = {"Time per ray in ns", "Object tests per ray", "Extent tests per ray",
                                     "Steps per ray",      "Time to build in ms",  "Throughput relative to"};

/* A row per accelerator, a column per scene. */
typedef struct Pivot {
    const RtResults *results;
    Measure measure;
    RtRayKind kind; /* or RT_ALL_RAYS */
    bool intervals;
    bool unmarked;      /* only widths are wanted: looking for the best takes much longer */
    uint32_t candidate; /* of the row */
    uint32_t count;     /* of the columns, with that of accelerators */
    RtTableColumn columns[1 + RT_MAX_WORKLOADS];
    RtColumnGroup group;
} Pivot;

static RtEstimate in_units(const RtEstimate *seconds, double a_second) {
    return (RtEstimate){a_second * seconds->median, a_second * seconds->low, a_second * seconds->high, 0};
}

static RtEstimate estimate_of(const Pivot *p, uint32_t workload, uint32_t candidate) {
    const RtCost cost = rt_results_cost(p->results, workload, candidate, p->kind);
    const RtBuildResult *build = rt_build_at(p->results, workload, candidate);
    switch (p->measure) {
    case TIME: return in_units(&cost.seconds, 1e9);
    case OBJECT_TESTS: return rt_estimate_exactly(cost.object_tests);
    case EXTENT_TESTS: return rt_estimate_exactly(cost.extent_tests);
    case STEPS: return rt_estimate_exactly(cost.steps);
    case RATIO:
        return rt_results_time_ratio(p->results, workload, p->results->experiment->baseline, candidate,
                                     p->kind, 0.95);
    default: return build->known ? in_units(&build->seconds, 1e3) : rt_estimate_exactly((double)NAN);
    }
}

/* Whether it is the least of the scene, or its interval overlaps with that of the least. Tables of extent
 * tests, of steps and of builds have no best: without a structure there are none. */
static bool is_best(const Pivot *p, uint32_t workload) {
    const bool time = p->measure == TIME || p->measure == RATIO;
    return (time || p->measure == OBJECT_TESTS) &&
           rt_standing_by(time, p->results, workload, p->candidate, p->kind) != RT_STANDING_BEHIND;
}

static RtField get_label(const void *row, const RtTableColumn *column) {
    const Pivot *p = row;
    (void)column;
    return rt_field_text(p->results->experiment->candidates[p->candidate].label);
}

static RtField get_cell(const void *row, const RtTableColumn *column) {
    const Pivot *p = row;
    const uint32_t workload = (uint32_t)column->key;
    const RtEstimate value = estimate_of(p, workload, p->candidate);
    if (isnan(value.median)) return rt_field_missing();
    const bool spread = p->intervals && value.low < value.high;
    RtField field =
        spread ? rt_field_interval(value.median, value.low, value.high) : rt_field_real(value.median);
    field.bold = !p->unmarked && is_best(p, workload);
    return field;
}

static const void *row_of(void *context, size_t i) {
    Pivot *p = context;
    p->candidate = (uint32_t)i;
    if (p->results->experiment->candidates[i].tried) return NULL;
    for (uint32_t c = 1; c < p->count; c++) {
        if (!isnan(estimate_of(p, (uint32_t)p->columns[c].key, p->candidate).median)) return p;
    }
    return NULL;
}

/* Scenes of one sweep have the value as their name, and a table of their own. */
static bool is_swept(const RtWorkload *workload) {
    return workload->swept.count > 0;
}

static bool same_table(const RtWorkload *a, const RtWorkload *b) {
    return is_swept(a) || is_swept(b) ? strcmp(a->stem, b->stem) == 0 : true;
}

static const char *name_of(const RtWorkload *workload) {
    const size_t stem = strlen(workload->stem);
    const bool value = is_swept(workload) && strncmp(workload->label, workload->stem, stem) == 0 &&
                       workload->label[stem] == ':';
    return workload->label + (value ? stem + 1 : 0);
}

static bool is_measured(const Pivot *p, uint32_t workload) {
    if (!p->results->workloads[workload].known) return false;
    for (uint32_t c = 0; c < p->results->experiment->candidate_count; c++) {
        if (!isnan(estimate_of(p, workload, c).median)) return true;
    }
    return false;
}

static void add_column(Pivot *p, const char *name, int key,
                       RtField (*get)(const void *row, const RtTableColumn *column)) {
    p->columns[p->count++] = (RtTableColumn){
        name, name,
        "",   titles[p->measure],
        get,  get == get_label ? RT_FORM_text : p->intervals ? RT_FORM_interval : RT_FORM_figure,
        key};
}

static RtTable pivot_table(Pivot *p) {
    p->group = (RtColumnGroup){NULL, p->columns, p->count, NULL};
    return (RtTable){&p->group, 1, .row_count = p->results->experiment->candidate_count, .row = row_of,
                     .context = p};
}

static uint32_t width_of(Pivot *p) {
    int widths[RT_MAX_TABLE_COLUMNS];
    const RtTable table = pivot_table(p);
    uint32_t width = 0;
    p->unmarked = true;
    rt_table_widths(&table, widths);
    p->unmarked = false;
    for (uint32_t c = 0; c < p->count; c++) width += (uint32_t)widths[c] + (c > 0 ? 2 : 0);
    return width;
}

/* Takes scenes from `first` on, as many as one table has room for; returns the first that it leaves. */
static uint32_t add_scenes(Pivot *p, uint32_t first) {
    const RtExperiment *experiment = p->results->experiment;
    const RtWorkload *before = NULL;
    p->count = 0;
    add_column(p, "accelerator", 0, get_label);
    for (uint32_t t = first; t < experiment->workload_count; t++) {
        const RtWorkload *workload = &experiment->workloads[t];
        if (!is_measured(p, t)) continue;
        if (before && !same_table(before, workload)) return t;
        add_column(p, name_of(workload), (int)t, get_cell);
        if (before && width_of(p) > PAGE_WIDTH) {
            p->count--;
            return t;
        }
        before = workload;
    }
    return experiment->workload_count;
}

static bool has_intervals(Measure measure) {
    return measure == TIME || measure == BUILD || measure == RATIO;
}

static void put_table(Pivot *p, bool tex, FILE *out) {
    const RtExperiment *experiment = p->results->experiment;
    const RtWorkload *scene = &experiment->workloads[p->columns[1].key];
    char caption[2 * RT_MAX_LABEL + 192], part[RT_MAX_PART_TEXT];
    uint32_t scenes = 0;
    RtTable table = pivot_table(p);
    snprintf(caption, sizeof caption, "%s", titles[p->measure]);
    if (p->measure == RATIO)
        rt_append_text(caption, sizeof caption, " %s, paired by round", rt_baseline_label(experiment));
    if (p->measure != BUILD && p->kind == RT_ALL_RAYS) {
        for (uint32_t c = 1; c < p->count; c++) scenes |= 1u << p->columns[c].key;
        rt_results_say_part(p->results, scenes, rt_experiment_kinds(experiment), part);
        rt_append_text(caption, sizeof caption, ", all kinds of rays, %s", part);
    }
    if (p->measure != BUILD && p->kind != RT_ALL_RAYS)
        rt_append_text(caption, sizeof caption, ", %s rays", rt_experiment_kind_name(experiment, p->kind));
    rt_append_text(caption, sizeof caption, is_swept(scene) ? ", %s." : ".", scene->stem);
    table.caption = caption;
    table.wide = width_of(p) > COLUMN_WIDTH;
    if (tex) {
        fputc('\n', out);
        rt_table_tex(&table, out);
    } else {
        fprintf(out, "\n%s\n\n", caption);
        rt_table_markdown(&table, out);
    }
}

/* With intervals if a page has room for them beside all scenes. */
static void put_pivots(const RtResults *results, Measure measure, RtRayKind kind, bool tex, FILE *out) {
    const uint32_t scenes = results->experiment->workload_count;
    Pivot p = {.results = results, .measure = measure, .kind = kind};
    for (uint32_t first = 0; first < scenes;) {
        p.intervals = has_intervals(measure);
        const uint32_t with = add_scenes(&p, first);
        p.intervals = false;
        const uint32_t without = add_scenes(&p, first);
        p.intervals = with == without && has_intervals(measure);
        first = without;
        if (p.count > 1) put_table(&p, tex, out);
    }
}

static void put_head(const RtResults *results, bool tex, FILE *out) {
    char interval[RT_MAX_INTERVAL_TITLE];
    const char *lead = tex ? "% " : "";
    rt_interval_title(results->experiment, interval);
    fprintf(out,
            tex ? "%% %s, written by raytally. Needs \\usepackage{booktabs}.\n"
                : "# %s\n\nWritten by `raytally`.\n",
            results->experiment->name);
    fprintf(out, "%sBold: the fewest object tests%s.\n", lead,
            results->experiment->count_only
                ? ""
                : "; the least time, and times whose interval overlaps its interval");
    if (!results->experiment->count_only)
        fprintf(out, "%sIn brackets: %s intervals, where there is room for them.\n", lead, interval);
}

static RtStatus write_tables(const RtResults *results, const char *directory, const char *name, bool tex,
                             RtError *error) {
    const RtExperiment *experiment = results->experiment;
    const bool counts = experiment->count_only;
    const Measure lead = counts ? OBJECT_TESTS : TIME, last = counts ? STEPS : BUILD;
    const bool one = experiment->kind_count == 1;
    RtOutput output;
    RT_TRY(rt_output_open_in(&output, directory, name, error));
    put_head(results, tex, output.file);
    for (Measure m = lead; m <= last; m++)
        put_pivots(results, m, one ? experiment->kinds[0] : RT_ALL_RAYS, tex, output.file);
    for (uint32_t k = 0; !one && k < experiment->kind_count; k++)
        put_pivots(results, lead, experiment->kinds[k], tex, output.file);
    for (uint32_t k = 0; !counts && k < experiment->kind_count; k++)
        put_pivots(results, RATIO, experiment->kinds[k], tex, output.file);
    return rt_output_commit(&output, error);
}

/* ---- report.html ---- */

enum { MOST_FILE_BYTES = 1 << 26 };

static void put_links(FILE *out, const char *directory) {
    fputs("<nav class=\"here\" aria-label=\"Files\"><span class=\"meta\">Data:</span> ", out);
    for (int i = RT_FILE_MANIFEST; i < RT_RESULT_FILE_COUNT; i++) {
        if (i == RT_FILE_REPORT || !rt_file_exists_in(directory, rt_result_files[i])) continue;
        rt_page_link(out, rt_result_files[i], rt_result_files[i]);
        fputc(' ', out);
    }
    fputs("</nav>\n", out);
}

typedef struct Plots {
    FILE *out;
    const RtExperiment *experiment;
    const char *directory;
    const char *shown; /* the file name of a plot shown elsewhere on the page, or NULL */
} Plots;

/* page.js gives it its size. */
static void put_plot(void *context, const char *path) {
    const Plots *plots = context;
    const char *file = basename(path);
    if (plots->shown && strcmp(file, plots->shown) == 0) return;
    char name[RT_MAX_PATH], pdf[RT_MAX_PATH + 16], caption[RT_MAX_CAPTION], *svg;
    size_t size;
    snprintf(name, sizeof name, "%.*s", (int)(strlen(file) - strlen(".svg")), file);
    snprintf(pdf, sizeof pdf, "plots/%s.pdf", name);
    rt_plot_caption(plots->experiment, plots->directory, name, caption);
    if (rt_file_read(path, MOST_FILE_BYTES, &svg, &size, NULL) != RT_OK) return;
    rt_html_wrap(plots->out, "<figure><div class=\"plot\" tabindex=\"0\" role=\"region\" aria-label=\"plot ",
                 name, "\">");
    rt_html_wrap(plots->out, "<img alt=\"Plot ", name,
                 ". Its figures are in the tables and files of this page.\" src=\"");
    rt_page_data_url(plots->out, "image/svg+xml", svg, size);
    rt_free(svg);
    rt_html_wrap(plots->out, "\"></div><figcaption>", *caption ? caption : name, "");
    if (rt_file_exists_in(plots->directory, pdf)) {
        fputc(' ', plots->out);
        rt_page_link(plots->out, pdf, "PDF");
    }
    fputs("</figcaption></figure>\n", plots->out);
}

static void put_plots(FILE *out, const RtExperiment *experiment, const char *directory) {
    Plots context = {out, experiment, directory, *experiment->frame.without ? basename(RT_FRAME_PLOT) : NULL};
    char plots[RT_MAX_PATH];
    fputs("<h2 id=\"plots\">Plots</h2>\n", out);
    if (rt_path_join(directory, "plots", plots, NULL) != RT_OK) return;
    if (rt_directory_each(plots, ".svg", put_plot, &context) > 0) return;
    fputs("<p class=\"meta\">No plots were drawn.</p>\n", out);
}

static void put_scenes(FILE *out, const RtResults *results, const char *directory) {
    fputs("<h2 id=\"scenes\">Scenes</h2>\n<div class=\"scenes\">", out);
    for (uint32_t t = 0; t < results->experiment->workload_count; t++) {
        const RtWorkload *setup = &results->experiment->workloads[t];
        const RtWorkloadResult *workload = &results->workloads[t];
        char path[RT_MAX_PATH], *picture;
        size_t size;
        if (!workload->known || rt_results_image_path(directory, results->experiment, t, path, NULL) != RT_OK)
            continue;
        fputs("<figure>", out);
        if (rt_file_read(path, MOST_FILE_BYTES, &picture, &size, NULL) == RT_OK) {
            rt_html_wrap(out, "<img alt=\"Picture of the scene ", setup->label, "\" src=\"");
            rt_page_data_url(out, "image/png", picture, size);
            fputs("\">", out);
            rt_free(picture);
        }
        rt_html_wrap(out, "<figcaption><strong>", setup->label, "");
        fprintf(out,
                "</strong>: %" PRIu32 " object%s; rays of a frame of %" PRIu32 " &times; %" PRIu32
                " pixel %s, depth %" PRIu32 "</figcaption></figure>\n",
                workload->objects, rt_plural(workload->objects), workload->width, workload->height,
                setup->corners ? "corners" : "centres", setup->depth);
    }
    fputs("</div>\n", out);
}

static json_t *table_of(const RtResults *results, uint32_t t, RtResultTable which, const char *caption) {
    RtResultRow row = {.results = results, .workload = t};
    RtTable table = rt_result_table(which, &row);
    table.caption = caption;
    return rt_table_page(&table);
}

/* Of each scene the totals, and folded the cells by kind of rays; then what is of all scenes. */
static json_t *tables_of(const RtResults *results) {
    const RtExperiment *experiment = results->experiment;
    json_t *sections = json_array();
    for (uint32_t t = 0; t < experiment->workload_count; t++) {
        char part[RT_MAX_PART_TEXT], caption[RT_MAX_PART_TEXT + 32];
        if (!results->workloads[t].known) continue;
        rt_results_say_part(results, 1u << t, rt_experiment_kinds(experiment), part);
        snprintf(caption, sizeof caption, "all kinds of rays together, %s", part);
        char *choices = rt_choices_sentences(results, t);
        json_array_append_new(sections,
                              json_pack("{s:s, s:[o], s:s, s:[o]}", "title", experiment->workloads[t].label,
                                        "tables", table_of(results, t, RT_TOTALS_MORE, caption), "choices",
                                        choices ? choices : "", "folded",
                                        table_of(results, t, RT_CELLS_MORE, "By kind of rays")));
        rt_free(choices);
    }
    json_t *more = json_array();
    if (experiment->distributions)
        json_array_append_new(more, table_of(results, 0, RT_DISTRIBUTIONS,
                                             "Distributions of counts over rays and over leaves"));
    if (experiment->render)
        json_array_append_new(more, table_of(results, 0, RT_RENDERED, "Rendering whole frames"));
    if (json_array_size(more))
        json_array_append_new(sections,
                              json_pack("{s:s, s:[], s:O}", "title", "All scenes", "tables", "folded", more));
    json_decref(more);
    return sections;
}

static json_t *frames_of(const RtResults *results) {
    json_t *frames = json_array();
    for (uint32_t t = 0; *results->experiment->frame.without && t < results->experiment->workload_count;
         t++) {
        char text[RT_MAX_FRAME_TEXT], caption[RT_MAX_FRAME_TEXT + RT_MAX_LABEL];
        RtFrameRow row = {.results = results, .one = true, .workload = t};
        RtTable table = rt_frame_table(&row);
        if (!results->workloads[t].known) continue;
        rt_frame_title(results, t, text);
        snprintf(caption, sizeof caption, "%s: %s", results->experiment->workloads[t].label, text);
        table.caption = caption;
        json_array_append_new(frames, rt_table_page(&table));
    }
    return frames;
}

/* What page.js makes tables and the description of the method of. */
static json_t *data_of(const RtResults *results, const json_t *manifest, RtError *error) {
    const RtExperiment *experiment = results->experiment;
    char interval[RT_MAX_INTERVAL_TITLE], null_runs[RT_MAX_SENTENCE];
    RtMemoryFile left_out;
    json_t *counters = json_array(), *colors = json_object();
    if (rt_memory_file_open(&left_out, error) != RT_OK) return counters;
    rt_print_left_out(results, left_out.file);
    rt_interval_title(experiment, interval);
    rt_null_sentence(results, null_runs);
    for (uint32_t c = 0; c <= experiment->candidate_count; c++) {
        char color[RT_COLOR_CHARS];
        rt_candidate_color(experiment, c, color);
        json_object_set_new(colors, rt_candidate_label(experiment, c), json_string(color));
    }
    for (size_t i = 0; i < RT_TALLY_COUNTER_COUNT; i++)
        json_array_append_new(counters, json_pack("[s, s]", rt_tally_name(i), rt_tally_meaning(i)));
    char *learnt = rt_learnt_sentence(results);
    rt_memory_file_close(&left_out, "what was left out", error);
    json_t *data =
        json_pack("{s:O, s:s, s:b, s:s, s:s, s:s, s:o, s:o, s:o, s:o, s:o, s:o}", "manifest", manifest,
                  "interval", interval, "count_only", experiment->count_only, "null_runs", null_runs,
                  "learnt", learnt ? learnt : "", "left_out", left_out.data ? left_out.data : "", "counters",
                  counters, "colors", colors, "verdict", rt_page_claims(results), "papers",
                  rt_page_papers(results), "frames", frames_of(results), "sections", tables_of(results));
    rt_free(learnt);
    rt_free(left_out.data);
    return data;
}

/* For an experiment with frames: their plot; page.js adds the tables. */
static void put_frames(FILE *out, const RtResults *results, const char *directory) {
    const RtExperiment *experiment = results->experiment;
    char path[RT_MAX_PATH], text[RT_MAX_FRAME_TEXT];
    if (!*experiment->frame.without) return;
    fputs("<section class=\"card\" id=\"answer\"><h2>Whole frames</h2>", out);
    rt_frame_legend(experiment, "\u2605", text);
    rt_html_wrap(out, "<p class=\"meta\">", text, " ");
    rt_html_wrap(out, "", experiment->frame.note, "</p>\n");
    fputs("</section>\n", out);
    if (rt_file_exists_in(directory, RT_FRAME_PLOT) &&
        rt_path_join(directory, RT_FRAME_PLOT, path, NULL) == RT_OK)
        put_plot(&(Plots){out, experiment, directory, NULL}, path);
    fputs("<div id=\"frames\"></div>\n", out);
}

static RtStatus put_page(FILE *out, const RtResults *results, const json_t *manifest, const char *directory,
                         RtError *error) {
    const RtExperiment *experiment = results->experiment;
    RtFinding finding;
    RT_TRY(rt_finding_fill(results, directory, &finding, error));
    rt_page_begin(out, experiment->name, false);
    rt_html_wrap(out, "<p class=\"lede\">", experiment->question, "</p>\n");
    put_frames(out, results, directory);
    fputs("<div id=\"verdict\"></div>\n", out); /* before the prediction */
    rt_page_finding(out, &finding);
    rt_finding_clear(&finding);
    rt_page_card(out, "What it does not show", experiment->not_shown);
    rt_page_card(out, "Prediction, written before the run", experiment->prediction);
    put_links(out, directory);
    put_plots(out, experiment, directory);
    put_scenes(out, results, directory);
    return rt_page_end(data_of(results, manifest, error), out, error);
}

RtStatus rt_report_write(const RtResults *results, const char *directory, RtError *error) {
    json_t *manifest;
    RtOutput output;
    RT_TRY(rt_manifest_read(directory, &manifest, error));
    RtStatus status = write_tables(results, directory, "tables.md", false, error);
    if (status == RT_OK) status = write_tables(results, directory, "tables.tex", true, error);
    if (status == RT_OK) status = rt_output_open_in(&output, directory, "report.html", error);
    if (status == RT_OK) {
        status = put_page(output.file, results, manifest, directory, error);
        if (status == RT_OK) status = rt_output_commit(&output, error);
        rt_output_discard(&output); /* unless it is committed */
    }
    json_decref(manifest);
    return status;
}

RtStatus rt_run_report(const RtResults *results, const char *directory, RtScripts scripts,
                       const RtRunObserver *observer, RtError *error) {
    /* The report is written even if drawing failed. */
    RtError drawing = {RT_OK, ""};
    const RtStatus drawn = rt_plots_draw(results, directory, scripts, false, &drawing);
    RT_TRY(rt_report_write(results, directory, error));
    if (drawn == RT_NOT_AVAILABLE) rt_notify(observer, "%s", drawing.message);
    if (drawn == RT_OK || drawn == RT_NOT_AVAILABLE) return RT_OK;
    if (error) *error = drawing;
    return drawn;
}
