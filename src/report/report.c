/* SPDX-License-Identifier: Apache-2.0 */
/* The page: what was asked and predicted, the figures, the tables, and what it was measured with. Plots and
 * images go in as data URLs, so that the file can be mailed. */
#include "report/report.h"

#include "base/memory.h"
#include "bench/claims.h"
#include "bench/distribution_tables.h"
#include "bench/hardware_table.h"
#include "bench/result_tables.h"
#include "literature/published_tables.h"
#include "report/color.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

enum { MOST_IMAGE_BYTES = 1 << 26 };

static const char style[] =
    "body{font:16px/1.5 system-ui,sans-serif;color:#222;background:#fafafa;margin:0}"
    "main{max-width:1180px;margin:0 auto;padding:1.5rem}"
    "h1{font-size:1.9rem;margin:.2rem 0}h2{font-size:1.25rem;margin:2.2rem 0 .6rem}h3{margin:1.4rem 0 .3rem}"
    ".meta{color:#666;font-size:.9rem}"
    ".card{background:#fff;border:1px solid #e4e4e4;border-radius:8px;padding:.8rem 1.1rem;margin:.7rem 0}"
    ".card b{display:block;color:#666;font-size:.8rem;font-weight:600;text-transform:uppercase;"
    "letter-spacing:.05em}"
    "figure{margin:1rem 0;background:#fff;border:1px solid #e4e4e4;border-radius:8px;padding:.6rem}"
    "figure img{width:100%;height:auto;display:block}"
    ".scenes{display:flex;flex-wrap:wrap;gap:1rem}.scenes figure{flex:1 1 240px;max-width:360px;margin:0}"
    "figcaption{color:#666;font-size:.85rem;padding:.4rem .2rem 0}"
    "table{border-collapse:collapse;background:#fff;font-size:.9rem;font-variant-numeric:tabular-nums;width:"
    "100%}"
    "th,td{padding:.28rem .7rem;border-bottom:1px solid #eee;text-align:left;white-space:nowrap}"
    "th{color:#666;font-weight:600;border-bottom:2px solid #ddd}.number,[data-value]{text-align:right}"
    "tbody tr:hover{background:#f4f8ff}.wide{overflow-x:auto}"
    ".missed{background:#fde8dc}"
    "tr[style] td:first-child::before{content:'';display:inline-block;width:.75em;height:.75em;"
    "border-radius:2px;margin-right:.5em;background:var(--dot)}"
    "details{margin:.8rem 0}summary{cursor:pointer;color:#0059b3}"
    "dl{display:grid;grid-template-columns:max-content 1fr;gap:.1rem 1rem;font-size:.9rem}dt{color:#666}"
    "dd{margin:0;overflow-wrap:anywhere}";

/* ---- text and files ---- */

static void put_base64(FILE *out, const unsigned char *data, size_t size) {
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (size_t i = 0; i < size; i += 3) {
        uint32_t left = size - i < 3 ? (uint32_t)(size - i) : 3, word = 0;
        for (uint32_t k = 0; k < 3; k++) word = word << 8 | (k < left ? data[i + k] : 0u);
        for (uint32_t k = 0; k < 4; k++) fputc(k <= left ? digits[word >> (18 - 6 * k) & 63] : '=', out);
    }
}

/* <img> with the file inside, or nothing where it cannot be read. */
static void put_image(FILE *out, const char *path, const char *type, const char *alt) {
    char *data;
    size_t size;
    if (rt_file_read(path, MOST_IMAGE_BYTES, &data, &size, NULL) != RT_OK) return;
    fprintf(out, "<img alt=\"");
    rt_html_put(out, alt);
    fprintf(out, "\" src=\"data:%s;base64,", type);
    put_base64(out, (const unsigned char *)data, size);
    fputs("\">", out);
    rt_free(data);
}

/* ---- sections ---- */

static void put_card(FILE *out, const char *title, const char *text) {
    if (!*text) return;
    fprintf(out, "<div class=\"card\"><b>%s</b>", title);
    rt_html_put(out, text);
    fputs("</div>\n", out);
}

static void put_claims(FILE *out, const RtResults *results) {
    const RtExperiment *experiment = results->experiment;
    if (!experiment->claim_count) return;
    fputs("<div class=\"card\"><b>Claims</b><table><tbody>\n", out);
    for (uint32_t i = 0; i < experiment->claim_count; i++) {
        RtClaimResult result;
        rt_claim_judge(results, i, &result);
        fprintf(out, "<tr><td%s>%s</td><td>", result.verdict == RT_CLAIM_FALSE ? " class=\"missed\"" : "",
                rt_claim_verdict_name(result.verdict));
        rt_html_put(out, experiment->claims[i]);
        fputs("</td><td>", out);
        rt_html_put(out, result.figures);
        fputs("</td></tr>\n", out);
    }
    fputs("</tbody></table></div>\n", out);
}

static const char *text_at(const json_t *object, const char *key) {
    const char *text = json_string_value(json_object_get(object, key));
    return text ? text : "unknown";
}

static void put_head(FILE *out, const RtResults *results, const json_t *manifest) {
    const RtExperiment *experiment = results->experiment;
    const json_t *machine = json_object_get(manifest, "machine");
    fputs("<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">"
          "<meta name=\"viewport\" content=\"width=device-width\"><title>",
          out);
    rt_html_put(out, experiment->name);
    fprintf(out, "</title><style>%s</style></head>\n<body><main>\n<h1>", style);
    rt_html_put(out, experiment->name);
    fputs("</h1>\n<div class=\"meta\">", out);
    rt_html_put(out, text_at(manifest, "date"));
    fputs(" &middot; ", out);
    rt_html_put(out, text_at(machine, "cpu"));
    fputs(" &middot; raytally ", out);
    rt_html_put(out, text_at(machine, "version"));
    fputs(" (", out);
    rt_html_put(out, text_at(machine, "commit"));
    fprintf(out, "%s)%s</div>\n", json_is_true(json_object_get(machine, "dirty")) ? ", with changes" : "",
            experiment->quick ? " &middot; <strong>quick variant</strong>" : "");
    put_card(out, "Question", experiment->question);
    put_card(out, "Prediction, written before the run", experiment->prediction);
    put_claims(out, results);
    put_card(out, "Finding", experiment->finding);
}

static void put_plot(void *context, const char *path) {
    FILE *out = context;
    fputs("<figure>", out);
    put_image(out, path, "image/svg+xml", "plot");
    fputs("</figure>\n", out);
}

static void put_plots(FILE *out, const char *directory) {
    char plots[RT_MAX_PATH];
    if (rt_path_join(directory, "plots", plots, NULL) != RT_OK) return;
    if (rt_directory_each(plots, ".svg", put_plot, out) > 0) return;
    fputs("<p class=\"meta\">No plots were drawn.</p>\n", out);
}

static void put_scenes(FILE *out, const RtResults *results, const char *directory) {
    fputs("<h2>Scenes</h2>\n<div class=\"scenes\">", out);
    for (uint32_t t = 0; t < results->experiment->workload_count; t++) {
        const RtWorkload *setup = &results->experiment->workloads[t];
        const RtWorkloadResult *workload = &results->workloads[t];
        char name[RT_MAX_LABEL + 16], path[RT_MAX_PATH];
        snprintf(name, sizeof name, "images/%s.png", setup->label);
        if (!workload->known || rt_path_join(directory, name, path, NULL) != RT_OK) continue;
        fputs("<figure>", out);
        put_image(out, path, "image/png", setup->label);
        fputs("<figcaption><strong>", out);
        rt_html_put(out, setup->label);
        fprintf(out,
                "</strong>: %" PRIu32 " objects; rays of a frame of %" PRIu32 " &times; %" PRIu32
                " pixel %s, depth %" PRIu32 "</figcaption></figure>\n",
                workload->objects, workload->width, workload->height, setup->corners ? "corners" : "centres",
                setup->depth);
    }
    fputs("</div>\n", out);
}

static const char *dot_of(const void *row) {
    const RtResultRow *r = row;
    bool null = r->candidate == r->results->experiment->candidate_count;
    return null ? "#ddd" : rt_candidate_color(r->candidate);
}

static void put_table(FILE *out, const RtResults *results, uint32_t t, RtResultTable which) {
    RtResultRow row = {.results = results, .workload = t};
    RtTable table = rt_result_table(which, &row);
    table.color = dot_of;
    rt_table_html(&table, out);
}

static void put_details(FILE *out, const char *summary, const RtTable *table) {
    fprintf(out, "<details><summary>%s</summary><div class=\"wide\">", summary);
    rt_table_html(table, out);
    fputs("</div></details>\n", out);
}

/* What an experiment may ask for besides, of all scenes. */
static void put_more_tables(FILE *out, const RtResults *results) {
    RtDistributionRow distribution = {.results = results};
    RtHardwareRow cell = {.results = results};
    const RtTable distributions = rt_distribution_table(RT_DISTRIBUTIONS, &distribution);
    const RtTable hardware = rt_hardware_table(&cell);
    if (results->experiment->distributions)
        put_details(out, "How counts are distributed, over rays and over leaves", &distributions);
    if (results->experiment->hardware) put_details(out, "What the machine did for a ray", &hardware);
}

static void put_tables(FILE *out, const RtResults *results) {
    fputs("<h2>Tables</h2>\n", out);
    for (uint32_t t = 0; t < results->experiment->workload_count; t++) {
        if (!results->workloads[t].known) continue;
        fputs("<h3>", out);
        rt_html_put(out, results->experiment->workloads[t].label);
        fputs("</h3>\n", out);
        put_table(out, results, t, RT_TOTALS);
        fputs("<details><summary>By ray kind, with intervals</summary>", out);
        put_table(out, results, t, RT_CELLS_MORE);
        fputs("</details>\n", out);
    }
    put_more_tables(out, results);
}

/* Every member of an object that is text, a number or a truth. */
static void put_members(FILE *out, const json_t *object) {
    const char *key;
    json_t *value;
    json_object_foreach((json_t *)object, key, value) {
        if (json_is_object(value) || json_is_array(value) || json_is_null(value)) continue;
        if (strcmp(key, "question") == 0 || strcmp(key, "prediction") == 0) continue;
        fputs("<dt>", out);
        rt_html_put(out, key);
        fputs("</dt><dd>", out);
        if (json_is_string(value)) rt_html_put(out, json_string_value(value));
        if (json_is_integer(value)) fprintf(out, "%" JSON_INTEGER_FORMAT, json_integer_value(value));
        if (json_is_boolean(value)) fputs(json_is_true(value) ? "yes" : "no", out);
        fputs("</dd>\n", out);
    }
}

static void put_timing(FILE *out, const RtResults *results) {
    char sentence[RT_MAX_SENTENCE], interval[RT_MAX_INTERVAL_TITLE];
    rt_interval_title(results->experiment, interval);
    fputs("Counting and timing are separate passes. Times are medians over rounds in which all accelerators "
          "took "
          "turns in random order; ratios are throughput over the baseline's, paired within a round. "
          "Intervals are "
          "those of order statistics: they hold the median with a probability of at least ",
          out);
    fprintf(out, "%s. ", interval);
    rt_null_sentence(results, sentence);
    rt_html_put(out, sentence);
}

static void put_method(FILE *out, const RtResults *results, const json_t *manifest) {
    fputs("<h2>How it was measured</h2>\n<p>Every accelerator got the same recorded rays. Totals weigh each "
          "ray "
          "kind by the size of its set. Shadow rays stop at any hit. <em>ideal</em> knows the answers "
          "beforehand: "
          "it is the floor. <em>differ</em> counts answers unlike the reference; an exact accelerator has "
          "none, or "
          "the run would have failed.</p>\n<p>",
          out);
    if (results->experiment->count_only) {
        fputs("Nothing was timed: this experiment counts.", out);
    } else {
        put_timing(out, results);
    }
    fputs("</p>\n<details><summary>Counters</summary><dl>", out);
    for (size_t i = 0; i < RT_TALLY_COUNTER_COUNT; i++) {
        fprintf(out, "<dt>%s</dt><dd>", rt_tally_name(i));
        rt_html_put(out, rt_tally_meaning(i));
        fputs("</dd>\n", out);
    }
    fputs("</dl></details>\n<pre class=\"meta\">", out);
    rt_print_limits(results, out);
    fputs("</pre>\n<details open><summary>Manifest</summary><dl>", out);
    put_members(out, manifest);
    put_members(out, json_object_get(manifest, "machine"));
    fputs("</dl></details>\n", out);
}

RtStatus rt_report_write(const RtResults *results, const RtPublished *published, const json_t *manifest,
                         const char *directory, RtError *error) {
    char path[RT_MAX_PATH];
    RtOutput output;
    RT_TRY(rt_path_join(directory, "report.html", path, error));
    RT_TRY(rt_output_open(&output, path, error));
    put_head(output.file, results, manifest);
    put_plots(output.file, directory);
    rt_published_page(published, true, output.file);
    put_scenes(output.file, results, directory);
    put_tables(output.file, results);
    put_method(output.file, results, manifest);
    fputs("</main></body></html>\n", output.file);
    return rt_output_commit(&output, error);
}
