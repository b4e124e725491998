/* SPDX-License-Identifier: Apache-2.0 */
/* The page: question, verdict, finding and plots as HTML; tables, machine and method as data for page.js.
 * Plots and images are data URLs: the file can be mailed. */
#include "report/report.h"

#include "core/base/memory.h"
#include "core/base/words.h"
#include "core/text/json.h"
#include "measure/result_files.h"
#include "report/page.h"
#include "report/paper_tables.h"
#include "report/plot.h"
#include "results/frame_table.h"
#include "results/result_directory.h"
#include "results/result_tables.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_FILE_BYTES = 1 << 26 };

/* ---- sections ---- */

/* The verdict comes before the prediction. */
static void put_claims(FILE *out, const RtResults *results) {
    fputs("<section class=\"card\" id=\"verdict\"><h2>Verdict</h2><p>", out);
    rt_page_verdict(out, results);
    if (!results->experiment->claim_count)
        fputs(" The prediction states no claims (<code>expect</code>) to check.", out);
    fputs("</p>\n", out);
    rt_page_claims(out, results);
    fputs("</section>\n", out);
}

static void put_links(FILE *out, const char *directory) {
    fputs("<nav class=\"here\" aria-label=\"Files\"><span class=\"meta\">Data:</span> ", out);
    for (int i = RT_FILE_MANIFEST; i < RT_RESULT_FILE_COUNT; i++) {
        if (i == RT_FILE_REPORT || !rt_file_exists_in(directory, rt_result_files[i])) continue;
        rt_page_link(out, rt_result_files[i], rt_result_files[i]);
        fputc(' ', out);
    }
    fputs("</nav>\n", out);
}

/* ---- plots ---- */

typedef struct Plots {
    FILE *out;
    const RtExperiment *experiment;
    const char *directory;
    const char *shown; /* the file name of a plot shown elsewhere on the page, or NULL */
} Plots;

/* Its size in pixels: gnuplot writes viewBox="0 0 WIDTH HEIGHT". */
static void read_size(const char *svg, int *width, int *height) {
    static const char box[] = "viewBox=\"0 0 ";
    const char *at = strstr(svg, box);
    char *end = NULL;
    *width = at ? (int)strtol(at + strlen(box), &end, 10) : 0;
    *height = end ? (int)strtol(end, NULL, 10) : 0;
    if (*width > 0 && *height > 0) return;
    *width = 960;
    *height = 480;
}

static void put_svg(FILE *out, const char *svg, size_t size, const char *name, const char *caption) {
    int width, height;
    read_size(svg, &width, &height);
    /* The first sentence of the caption. */
    const char *end = strstr(caption, ". ");
    size_t length = end ? (size_t)(end - caption) : strlen(caption);
    if (length > 0 && caption[length - 1] == '.') length--;
    fprintf(
        out,
        "<figure><div class=\"plot\" style=\"--w:%dpx\" tabindex=\"0\" role=\"region\" aria-label=\"plot ",
        width);
    rt_html_put(out, name);
    fprintf(out, "\"><img width=\"%d\" height=\"%d\" alt=\"Plot: ", width, height);
    char text[RT_MAX_CAPTION];
    snprintf(text, sizeof text, "%.*s", (int)length, caption);
    rt_html_wrap(out, "", *text ? text : name,
                 ". Its figures are in the tables and files of this page.\" src=\"");
    rt_page_data_url(out, "image/svg+xml", svg, size);
    fputs("\"></div>", out);
}

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
    put_svg(plots->out, svg, size, name, caption);
    rt_free(svg);
    rt_html_wrap(plots->out, "<figcaption>", *caption ? caption : name, "");
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

/* ---- scenes ---- */

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

/* ---- tables ---- */

static const char *dot_of_candidate(const RtExperiment *experiment, uint32_t candidate) {
    static char color[RT_COLOR_CHARS]; /* until the next row */
    rt_candidate_color(experiment, candidate, color);
    return color;
}

static const char *dot_of(const void *row) {
    const RtResultRow *r = row;
    return dot_of_candidate(r->results->experiment, r->candidate);
}

static const char *frame_dot_of(const void *row) {
    const RtFrameRow *r = row;
    return dot_of_candidate(r->results->experiment, r->candidate);
}

static json_t *table_of(const RtResults *results, uint32_t t, RtResultTable which, const char *caption) {
    RtResultRow row = {.results = results, .workload = t};
    RtTable table = rt_result_table(which, &row);
    table.caption = caption;
    table.color = dot_of;
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
        json_array_append_new(sections,
                              json_pack("{s:s, s:[o], s:[o]}", "title", experiment->workloads[t].label,
                                        "tables", table_of(results, t, RT_TOTALS_MORE, caption), "folded",
                                        table_of(results, t, RT_CELLS_MORE, "By kind of rays")));
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
        table.color = frame_dot_of;
        json_array_append_new(frames, rt_table_page(&table));
    }
    return frames;
}

/* What page.js makes tables and the description of the method of. */
static json_t *data_of(const RtResults *results, const json_t *manifest, RtError *error) {
    const RtExperiment *experiment = results->experiment;
    char interval[RT_MAX_INTERVAL_TITLE], null_runs[RT_MAX_SENTENCE];
    RtMemoryFile left_out;
    json_t *counters = json_array();
    if (rt_memory_file_open(&left_out, error) != RT_OK) return counters;
    rt_print_left_out(results, left_out.file);
    rt_interval_title(experiment, interval);
    rt_null_sentence(results, null_runs);
    for (size_t i = 0; i < RT_TALLY_COUNTER_COUNT; i++)
        json_array_append_new(counters, json_pack("[s, s]", rt_tally_name(i), rt_tally_meaning(i)));
    char *learnt = rt_learnt_sentence(results);
    rt_memory_file_close(&left_out, "what was left out", error);
    json_t *data = json_pack(
        "{s:O, s:s, s:b, s:s, s:s, s:s, s:o, s:o, s:o, s:o}", "manifest", manifest, "interval", interval,
        "count_only", experiment->count_only, "null_runs", null_runs, "learnt", learnt ? learnt : "",
        "left_out", left_out.data ? left_out.data : "", "counters", counters, "papers",
        rt_page_papers(experiment), "frames", frames_of(results), "sections", tables_of(results));
    rt_free(learnt);
    rt_free(left_out.data);
    return data;
}

/* ---- the answer ---- */

/* A paragraph; nothing for "" or NULL. Frees the text. */
static void put_sentences(FILE *out, char *text) {
    if (text && *text) rt_html_wrap(out, "<p>", text, "</p>\n");
    rt_free(text);
}

/* For an experiment with frames: the fastest accelerators on each scene, as sentences and plot; page.js adds
 * the tables. */
static void put_answer(FILE *out, const RtResults *results, const char *directory) {
    const RtExperiment *experiment = results->experiment;
    char path[RT_MAX_PATH], text[RT_MAX_FRAME_TEXT];
    if (!*experiment->frame.without) return;
    fputs("<section class=\"card\" id=\"answer\"><h2>Answer</h2>", out);
    for (uint32_t t = 0; t < experiment->workload_count; t++)
        put_sentences(out, rt_frame_sentence(results, t));
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
    rt_page_begin(out, experiment->name, false);
    rt_html_wrap(out, "<p class=\"lede\">", experiment->question, "</p>\n");
    put_answer(out, results, directory);
    put_claims(out, results);
    rt_page_card(out, "Finding", *experiment->finding ? experiment->finding : "No finding yet.");
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
    RtStatus status = rt_paper_tables_write(results, directory, error);
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
