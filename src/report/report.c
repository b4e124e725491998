/* SPDX-License-Identifier: Apache-2.0 */
/* The page: question and prediction, plots, tables, and the machine and method. Plots and images are data
 * URLs: the file can be mailed. */
#include "report/report.h"

#include "core/base/memory.h"
#include "core/base/words.h"
#include "core/text/json.h"
#include "experiment/distribution_tables.h"
#include "experiment/frame_table.h"
#include "experiment/manifest.h"
#include "experiment/result_directory.h"
#include "experiment/result_tables.h"
#include "measure/result_files.h"
#include "report/color.h"
#include "report/page.h"
#include "report/paper_tables.h"
#include "report/plot.h"

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
    fputs("<nav class=\"here\" aria-label=\"Sections\"><a href=\"#plots\">Plots</a> <a "
          "href=\"#scenes\">Scenes</a> "
          "<a href=\"#tables\">Tables</a> <a href=\"#method\">How it was measured</a></nav>\n"
          "<nav class=\"here\" aria-label=\"Files\"><span class=\"meta\">Data:</span> ",
          out);
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

/* ---- scenes and tables ---- */

static void put_scenes(FILE *out, const RtResults *results, const char *directory) {
    fputs("<h2 id=\"scenes\">Scenes</h2>\n<div class=\"scenes\">", out);
    for (uint32_t t = 0; t < results->experiment->workload_count; t++) {
        const RtWorkload *setup = &results->experiment->workloads[t];
        const RtWorkloadResult *workload = &results->workloads[t];
        char path[RT_MAX_PATH], *picture;
        size_t size;
        if (!workload->known || rt_run_image_path(directory, results->experiment, t, path, NULL) != RT_OK)
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

static void put_table(FILE *out, const RtResults *results, uint32_t t, RtResultTable which,
                      const char *what) {
    RtResultRow row = {.results = results, .workload = t};
    RtTable table = rt_result_table(which, &row);
    char caption[RT_MAX_LABEL + RT_MAX_PART_TEXT + 64];
    snprintf(caption, sizeof caption, "%s, %s", results->experiment->workloads[t].label, what);
    table.caption = caption;
    table.color = dot_of;
    rt_table_html(&table, out);
}

static void put_details(FILE *out, const char *summary, RtTable *table) {
    table->caption = summary;
    fprintf(out, "<details><summary>%s</summary>", summary);
    rt_table_html(table, out);
    fputs("</details>\n", out);
}

/* Optional tables, of all scenes. */
static void put_more_tables(FILE *out, const RtResults *results) {
    RtDistributionRow distribution = {.results = results};
    RtResultRow cell = {.results = results}, frame = cell;
    RtTable distributions = rt_distribution_table(RT_DISTRIBUTIONS, &distribution);
    RtTable hardware = rt_result_table(RT_HARDWARE, &cell);
    RtTable rendered = rt_result_table(RT_RENDERED, &frame);
    if (results->experiment->distributions)
        put_details(out, "Distributions of counts over rays and over leaves", &distributions);
    if (results->experiment->render) put_details(out, "Rendering whole frames", &rendered);
    if (results->experiment->hardware) put_details(out, "Hardware counters per ray", &hardware);
}

/* A paragraph; nothing for "" or NULL. Frees the text. */
static void put_sentences(FILE *out, char *text) {
    if (text && *text) rt_html_wrap(out, "<p>", text, "</p>\n");
    rt_free(text);
}

static void put_tables(FILE *out, const RtResults *results) {
    char interval[RT_MAX_INTERVAL_TITLE], part[RT_MAX_PART_TEXT], what[RT_MAX_PART_TEXT + 32];
    rt_interval_title(results->experiment, interval);
    fprintf(
        out,
        "<h2 id=\"tables\">Tables</h2>\n<p>In brackets: %s intervals. &#9733; marks the best of a scene "
        "and kind of rays, by %s; &asymp; marks intervals that overlap that of the best. Times "
        "over all kinds have conservative intervals, and are unknown if a kind is missing.</p>\n"
        "<div class=\"filter\" id=\"filter\" hidden><label for=\"words\">Rows with</label> "
        "<input type=\"search\" id=\"words\" placeholder=\"words, e.g. of a scene, an accelerator, a kind\"> "
        "<output for=\"words\" class=\"meta\"></output></div>\n",
        interval, results->experiment->count_only ? "object tests" : "time");
    put_sentences(out, rt_learnt_sentence(results));
    for (uint32_t t = 0; t < results->experiment->workload_count; t++) {
        const char *label = results->experiment->workloads[t].label;
        if (!results->workloads[t].known) continue;
        rt_html_wrap(out, "<section class=\"scene-tables\" data-scene=\"", label, "\"><h3>");
        rt_html_wrap(out, "", label, "</h3>\n");
        rt_results_say_part(results, 1u << t, rt_experiment_kinds(results->experiment), part);
        snprintf(what, sizeof what, "all kinds of rays together, %s", part);
        put_table(out, results, t, RT_TOTALS_MORE, what);
        fputs("<details><summary>By kind of rays</summary>", out);
        put_table(out, results, t, RT_CELLS_MORE, "by kind of rays");
        fputs("</details></section>\n", out);
    }
    put_more_tables(out, results);
}

/* ---- the answer ---- */

/* For an experiment with frames: the fastest accelerators on each scene, as sentences, plot and tables. */
static void put_answer(FILE *out, const RtResults *results, const char *directory) {
    const RtExperiment *experiment = results->experiment;
    char path[RT_MAX_PATH], text[RT_MAX_FRAME_TEXT], caption[RT_MAX_FRAME_TEXT + RT_MAX_LABEL];
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
    for (uint32_t t = 0; t < experiment->workload_count; t++) {
        RtFrameRow row = {.results = results, .one = true, .workload = t};
        RtTable table = rt_frame_table(&row);
        if (!results->workloads[t].known) continue;
        rt_frame_title(results, t, text);
        snprintf(caption, sizeof caption, "%s: %s", experiment->workloads[t].label, text);
        table.caption = caption;
        table.color = frame_dot_of;
        rt_table_html(&table, out);
    }
}

static void put_head(FILE *out, const RtResults *results, const json_t *manifest, const char *directory) {
    const RtExperiment *experiment = results->experiment;
    rt_page_begin(out, experiment->name, false);
    rt_html_wrap(out, "<p class=\"lede\">", experiment->question, "</p>\n");
    put_answer(out, results, directory);
    rt_page_papers(out, experiment);
    put_claims(out, results);
    rt_page_card(out, "Finding", *experiment->finding ? experiment->finding : "No finding yet.");
    rt_page_card(out, "Prediction, written before the run", experiment->prediction);
    rt_page_provenance(out, manifest);
    put_links(out, directory);
}

/* Every member of an object that is text, a number or a boolean. */
static void put_members(FILE *out, const json_t *object) {
    const char *key;
    json_t *value;
    json_object_foreach((json_t *)object, key, value) {
        if (json_is_object(value) || json_is_array(value) || json_is_null(value)) continue;
        if (strcmp(key, "question") == 0 || strcmp(key, "prediction") == 0) continue;
        rt_html_wrap(out, "<dt>", key, "</dt><dd>");
        if (json_is_string(value)) rt_html_put(out, json_string_value(value));
        if (json_is_integer(value)) fprintf(out, "%" JSON_INTEGER_FORMAT, json_integer_value(value));
        if (json_is_real(value)) fprintf(out, "%.9g", json_real_value(value));
        if (json_is_boolean(value)) fputs(json_is_true(value) ? "yes" : "no", out);
        fputs("</dd>\n", out);
    }
}

/* The plugins, with their hashes. */
static void put_plugins(FILE *out, const json_t *plugins) {
    json_t *plugin, *name;
    size_t i, n;
    json_array_foreach((json_t *)plugins, i, plugin) {
        fputs("<dt>plugin of", out);
        json_array_foreach(json_object_get(plugin, "accelerators"), n, name) {
            fputs(n ? ", " : " ", out);
            rt_html_put(out, json_is_string(name) ? json_string_value(name) : "");
        }
        rt_html_wrap(out, "</dt><dd>", rt_json_text(plugin, "file", ""), ", hash ");
        rt_html_wrap(out, "", rt_json_text(plugin, "hash", "unknown"), "</dd>\n");
    }
}

static void put_timing(FILE *out, const RtResults *results) {
    char sentence[RT_MAX_SENTENCE], interval[RT_MAX_INTERVAL_TITLE];
    rt_interval_title(results->experiment, interval);
    fputs("Counting and timing are separate passes. Times are medians over rounds that run all accelerators "
          "in random order; ratios are throughput relative to the baseline, paired within a round. Intervals "
          "are order statistics: they contain the median with a probability of at least ",
          out);
    fprintf(out, "%s. ", interval);
    rt_null_sentence(results, sentence);
    rt_html_put(out, sentence);
}

static void put_method(FILE *out, const RtResults *results, const json_t *manifest) {
    fputs("<h2 id=\"method\">How it was measured</h2>\n<p>Every accelerator traced the same recorded rays. "
          "Totals weight each kind of rays by the size of its whole set, before any limit. Shadow rays stop "
          "at any hit. "
          "<em>ideal</em> knows the answers in advance: it is the lower bound. <em>differ</em> counts "
          "answers that differ from the reference; the run fails if an exact accelerator has any.</p>\n<p>",
          out);
    if (results->experiment->count_only) {
        fputs("Nothing was timed: this experiment counts.", out);
    } else {
        put_timing(out, results);
    }
    fputs("</p>\n<details><summary>Counters</summary><dl>", out);
    for (size_t i = 0; i < RT_TALLY_COUNTER_COUNT; i++) {
        fprintf(out, "<dt>%s</dt><dd>", rt_tally_name(i));
        rt_html_wrap(out, "", rt_tally_meaning(i), "</dd>\n");
    }
    fputs("</dl></details>\n<pre class=\"meta\">", out);
    rt_print_left_out(results, out);
    fputs("</pre>\n<details open><summary>Manifest</summary><dl>", out);
    put_members(out, manifest);
    put_members(out, json_object_get(manifest, "machine"));
    put_plugins(out, json_object_get(json_object_get(manifest, "machine"), "plugins"));
    fputs("</dl></details>\n", out);
}

static void put_page(FILE *out, const RtResults *results, const json_t *manifest, const char *directory) {
    put_head(out, results, manifest, directory);
    put_plots(out, results->experiment, directory);
    put_scenes(out, results, directory);
    put_tables(out, results);
    put_method(out, results, manifest);
    rt_page_end(out);
}

RtStatus rt_report_write(const RtResults *results, const char *directory, RtError *error) {
    json_t *manifest;
    RtOutput output;
    RT_TRY(rt_manifest_read(directory, &manifest, error));
    RtStatus status = rt_paper_tables_write(results, directory, error);
    if (status == RT_OK) status = rt_output_open_in(&output, directory, "report.html", error);
    if (status == RT_OK) {
        put_page(output.file, results, manifest, directory);
        status = rt_output_commit(&output, error);
    }
    json_decref(manifest);
    return status;
}
