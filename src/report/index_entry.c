/* SPDX-License-Identifier: Apache-2.0 */
#include "report/index_entry.h"

#include "claims/claims.h"
#include "core/base/memory.h"
#include "core/base/words.h"
#include "core/text/csv.h"
#include "core/text/json.h"
#include "core/text/table.h"
#include "measure/machine.h"
#include "report/page.h"
#include "results/frame_table.h"
#include "results/manifest.h"
#include "results/result_directory.h"

#include <ctype.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

/* ---- text ---- */

void rt_index_put_markdown(FILE *out, const char *text, bool cell) {
    bool code = false;
    for (const char *c = text; *c; c++) {
        if (*c == '`') code = !code && strchr(c + 1, '`');
        const bool entity = c[0] == '&' && (c[1] == '#' || isalpha((unsigned char)c[1]));
        if (*c == '|' ? cell : !code && (entity || strchr("\\*[]<", *c))) fputc('\\', out);
        fputc(*c, out);
    }
}

/* The length of the first sentence: to a full stop before a blank and a capital. */
static int first_sentence(const char *text) {
    size_t i = 0;
    while (text[i] && !(strchr(".!?", text[i]) && text[i + 1] == ' ' && isupper((unsigned char)text[i + 2])))
        i++;
    return (int)(i + (text[i] != '\0'));
}

static void put_paragraph(FILE *out, const char *title, const char *text) {
    if (!*text) return;
    fprintf(out, "<p><strong>%s</strong> ", title);
    rt_html_markup(out, text);
    fputs("</p>\n", out);
}

static void put_line(FILE *out, const char *title, const char *text) {
    if (!*text) return;
    fprintf(out, "**%s** ", title);
    rt_index_put_markdown(out, text, false);
    fputs("\n\n", out);
}

/* ---- the plot ---- */

static void take_first(void *context, const char *path) {
    char *first = context;
    if (!*first) snprintf(first, RT_MAX_PATH, "plots/%s", basename(path));
}

/* The main plot of a result directory, in `place`: that of frames, or the first; "" if there is none. */
static void find_plot(const char *directory, const char *place, char plot[RT_MAX_PATH]) {
    char folder[RT_MAX_PATH], name[RT_MAX_PATH] = "";
    if (rt_file_exists_in(directory, RT_FRAME_PLOT)) strcpy(name, RT_FRAME_PLOT);
    if (rt_path_join(directory, "plots", folder, NULL) == RT_OK)
        rt_directory_each(folder, ".svg", take_first, name);
    if (!*name || rt_path_join(place, name, plot, NULL) != RT_OK) *plot = '\0';
}

/* ---- sentences of the literature ---- */

static void put_papers(const RtIndexEntry *entry, const RtExperiment *experiment, const char *place) {
    FILE *rows = entry->parts[RT_INDEX_ROWS].file, *lines = entry->parts[RT_INDEX_LINES].file;
    for (uint32_t i = 0; i < experiment->paper_count; i++) {
        const RtPaper *paper = &experiment->papers[i];
        const bool seen = rt_paper_is_seen(paper);
        rt_html_wrap(rows, "<tr><td class=\"prose\">", paper->citation, "</td><td>");
        rt_html_wrap(rows, "", paper->page, "</td><td class=\"prose\">");
        rt_html_wrap(rows, seen ? "&ldquo;" : "", paper->quote, seen ? "&rdquo;</td><td>" : "</td><td>");
        rt_page_paper_verdict(rows, paper);
        rt_html_wrap(rows, "</td><td><a href=\"#", entry->name, "\">");
        rt_html_wrap(rows, "", entry->name, "</a></td></tr>\n");
        fputs("| ", lines);
        rt_index_put_markdown(lines, paper->citation, true);
        fputs(" | ", lines);
        rt_index_put_markdown(lines, paper->page, true);
        fputs(seen ? " | “" : " | ", lines);
        rt_index_put_markdown(lines, paper->quote, true);
        fprintf(lines, "%s | %s | [", seen ? "”" : "", rt_paper_verdict_name(paper->verdict));
        rt_index_put_markdown(lines, entry->name, true);
        fputs("](", lines);
        rt_page_path(lines, place);
        fputs(") |\n", lines);
    }
}

/* ---- a directory ---- */

static void note_origin(RtIndexEntry *entry, const json_t *manifest) {
    const json_t *machine = json_object_get(manifest, "machine");
    snprintf(entry->build, RT_MAX_ORIGIN, "raytally %s (%s%s), %s",
             rt_json_text(machine, "version", "unknown"), rt_json_text(machine, "commit", "unknown"),
             json_is_true(json_object_get(machine, "dirty")) ? ", with changes" : "",
             rt_json_text(machine, "compiler", "unknown"));
    rt_machine_libraries(machine, ", ", entry->build, RT_MAX_ORIGIN);
    snprintf(entry->machine, RT_MAX_ORIGIN, "%s", rt_json_text(machine, "cpu", "an unknown machine"));
    const json_t *again = json_object_get(manifest, "recounted");
    if (again)
        snprintf(entry->again, RT_MAX_ORIGIN, "raytally %s (%s)", rt_json_text(again, "version", "unknown"),
                 rt_json_text(again, "commit", "unknown"));
}

static void put_thumbnail(FILE *out, const char *name, const char *plot) {
    fputs("<a class=\"thumb\" href=\"", out);
    rt_page_path(out, plot);
    rt_html_wrap(out, "\"><img loading=\"lazy\" alt=\"Plot of ", name, "\" src=\"");
    rt_page_path(out, plot);
    fputs("\"></a>\n", out);
}

/* The plot, and the name as a link to the report, if there is one. */
static void put_head(const RtIndexEntry *entry, const char *directory, const char *place, const char *plot) {
    FILE *out = entry->parts[RT_INDEX_HTML].file;
    char path[RT_MAX_PATH];
    rt_html_wrap(out, "<section class=\"card entry\" id=\"", entry->name, "\">");
    if (*plot) put_thumbnail(out, entry->name, plot);
    fputs("<div><h3>", out);
    if (rt_file_exists_in(directory, "report.html") &&
        rt_path_join(place, "report.html", path, NULL) == RT_OK)
        rt_page_link(out, path, entry->name);
    else
        rt_html_put(out, entry->name);
    fputs("</h3>\n", out);
}

static void put_markdown_link(FILE *out, const char *begin, const char *text, const char *path) {
    fputs(begin, out);
    rt_index_put_markdown(out, text, false);
    fputs("](", out);
    rt_page_path(out, path);
    fputs(")\n\n", out);
}

/* The same in index.md, with a link to the directory. */
static void put_heads(const RtIndexEntry *entry, const char *directory, const char *place) {
    FILE *markdown = entry->parts[RT_INDEX_MARKDOWN].file;
    char plot[RT_MAX_PATH];
    find_plot(directory, place, plot);
    put_head(entry, directory, place, plot);
    put_markdown_link(markdown, "### [", entry->name, place);
    if (*plot) put_markdown_link(markdown, "![Plot of ", entry->name, plot);
}

static void put_size(FILE *out, const RtResults *results) {
    const RtExperiment *experiment = results->experiment;
    uint32_t scenes;
    uint64_t cells = rt_results_size(results, &scenes);
    fprintf(out,
            "<p class=\"meta\">Scenes: %" PRIu32 " &middot; accelerators: %" PRIu32
            " &middot; cells: %" PRIu64 "%s</p>\n",
            scenes, experiment->candidate_count, cells,
            experiment->count_only ? " &middot; counted only" : "");
}

static void put_html(FILE *out, const RtResults *results, const json_t *manifest) {
    const RtExperiment *experiment = results->experiment;
    const char *finding = *experiment->finding ? experiment->finding : "No finding yet.";
    fputs("<p>", out);
    rt_page_verdict(out, results);
    fputs("</p>\n<p>", out);
    char *sentence = strndup(finding, (size_t)first_sentence(finding));
    if (sentence) rt_html_markup(out, sentence);
    free(sentence);
    fputs("</p>\n<details><summary>Question, prediction, claims and finding</summary>\n", out);
    put_paragraph(out, "Question:", experiment->question);
    put_paragraph(out, "Prediction:", experiment->prediction);
    rt_page_claims(out, results);
    put_paragraph(out, "Finding:", experiment->finding);
    rt_page_provenance(out, manifest);
    put_size(out, results);
    fputs("</details>\n", out);
}

static void put_markdown(FILE *out, const RtResults *results) {
    const RtExperiment *experiment = results->experiment;
    put_line(out, "Question.", experiment->question);
    put_line(out, "Finding.", experiment->finding);
    fputs("<details><summary>Prediction and claims</summary>\n\n", out);
    put_line(out, "Prediction.", experiment->prediction);
    for (uint32_t i = 0; i < experiment->claim_count; i++) {
        RtClaimResult result;
        rt_claim_judge(results, i, &result);
        fprintf(out, "- **%s**: `%s`%s", rt_claim_verdict_name(result.verdict), experiment->claims[i],
                *result.figures ? ": " : "");
        rt_index_put_markdown(out, result.figures, false);
        fputs("\n", out);
    }
    fputs("\n</details>\n\n", out);
}

static RtStatus put_experiment(RtIndexEntry *entry, const char *directory, const char *place,
                               RtExperiment *experiment, RtError *error) {
    RtResults results;
    json_t *manifest = NULL;
    RtStatus status = rt_results_load(directory, experiment, &results, error);
    if (status == RT_OK) status = rt_manifest_read(directory, &manifest, error);
    if (status == RT_OK) {
        strcpy(entry->section, experiment->section);
        note_origin(entry, manifest);
        put_heads(entry, directory, place);
        put_html(entry->parts[RT_INDEX_HTML].file, &results, manifest);
        put_markdown(entry->parts[RT_INDEX_MARKDOWN].file, &results);
        put_papers(entry, experiment, place);
    }
    json_decref(manifest);
    rt_results_clear(&results);
    return status;
}

static uint64_t sum_of(const RtCsv *csv, const char *column) {
    uint64_t sum = 0;
    const uint32_t at = rt_csv_find(csv, column);
    for (uint32_t i = 0; i < csv->rows; i++) sum += strtoull(rt_csv_field(csv, i, at), NULL, 10);
    return sum;
}

static RtStatus put_verification(RtIndexEntry *entry, const char *directory, const char *place,
                                 RtError *error) {
    RtCsv csv = {0};
    json_t *manifest = NULL;
    char path[RT_MAX_PATH], sums[512];
    FILE *html = entry->parts[RT_INDEX_HTML].file, *markdown = entry->parts[RT_INDEX_MARKDOWN].file;
    RT_TRY(rt_path_join(directory, rt_result_files[RT_FILE_VERIFY_CSV], path, error));
    RtStatus status = rt_csv_read(&csv, path, error);
    if (status == RT_OK) status = rt_manifest_read(directory, &manifest, error);
    if (status == RT_OK) {
        strcpy(entry->section, "verification");
        note_origin(entry, manifest);
        snprintf(sums, sizeof sums,
                 "%" PRIu64 " comparisons in %" PRIu32 " row%s: %" PRIu64
                 " answers to nearest are wrong, %" PRIu64 " to occluded.",
                 sum_of(&csv, "rays"), csv.rows, rt_plural(csv.rows), sum_of(&csv, "wrong"),
                 sum_of(&csv, "occluded_wrong"));
        put_heads(entry, directory, place);
        fprintf(html, "<p>%s</p>\n", sums);
        rt_page_provenance(html, manifest);
        fprintf(markdown, "%s\n\n", sums);
    }
    json_decref(manifest);
    rt_csv_clear(&csv);
    return status;
}

/* ---- both kinds ---- */

static bool is_verification(const char *directory) {
    return rt_file_exists_in(directory, rt_result_files[RT_FILE_VERIFY_CSV]);
}

bool rt_index_is_entry(const char *directory) {
    return rt_file_exists_in(directory, RT_MANIFEST) &&
           (is_verification(directory) || rt_file_exists_in(directory, rt_result_files[RT_FILE_EXPERIMENT]));
}

static RtStatus close_parts(RtIndexEntry *entry, RtError *error) {
    RtStatus status = RT_OK;
    for (int p = 0; p < RT_INDEX_PARTS; p++) {
        if (!entry->parts[p].file) continue;
        RtStatus closed = rt_memory_file_close(&entry->parts[p], "the index", error);
        if (status == RT_OK) status = closed;
    }
    return status;
}

RtStatus rt_index_entry_read(RtIndexEntry *entry, const char *directory, const char *place,
                             RtExperiment *experiment, RtError *error) {
    RtError why = {RT_OK, ""};
    *entry = (RtIndexEntry){0};
    snprintf(entry->name, sizeof entry->name, "%s", place);
    for (int p = 0; p < RT_INDEX_PARTS; p++) RT_TRY(rt_memory_file_open(&entry->parts[p], error));
    FILE *html = entry->parts[RT_INDEX_HTML].file;
    RtStatus status = is_verification(directory) ? put_verification(entry, directory, place, &why)
                                                 : put_experiment(entry, directory, place, experiment, &why);
    if (status != RT_OK) {
        put_heads(entry, directory, place);
        put_paragraph(html, "Cannot be read:", why.message);
        put_line(entry->parts[RT_INDEX_MARKDOWN].file, "Cannot be read:", why.message);
    }
    fputs("</div></section>\n", html);
    return close_parts(entry, error);
}

void rt_index_entry_clear(RtIndexEntry *entry) {
    close_parts(entry, NULL);
    for (int p = 0; p < RT_INDEX_PARTS; p++) rt_free(entry->parts[p].data);
}
