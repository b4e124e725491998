/* SPDX-License-Identifier: Apache-2.0 */
#include "literature/published_tables.h"

#include "results/result_directory.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

typedef RtPublishedCursor Row;

/* ---- fields ---- */

static double tolerance_of(const Row *r, RtColumn column) {
    double tolerance = r->published->experiment->published.tolerance[column];
    return tolerance > 0 ? tolerance : (double)NAN;
}

static const char *per_of(const Row *r) {
    if (r->figure->column != RT_COLUMN_object_tests) return NULL;
    return r->row->per_hit ? "hit" : "ray";
}

static RtField measured_of(const Row *r) {
    char measured[RT_MAX_FIGURE];
    rt_figure_measured(r->figure, measured);
    return rt_field_print("%s", measured);
}

static RtField within_of(const Row *r) {
    if (r->figure->judgement == RT_UNJUDGED) return rt_field_missing();
    return rt_field_flag(r->figure->judgement == RT_WITHIN);
}

static const char *reason_of(const RtPublished *published, const RtFigure *figure) {
    return figure->reason == RT_NO_REASON ? NULL : published->reasons[figure->reason].text;
}

static RtField name_of(const Row *r) {
    char name[RT_MAX_ROW_NAME];
    rt_published_row_name(r->row, name);
    return rt_field_print("%s", name);
}

/* A published row counts no extent tests; a grid or an octree makes one per ray. */
static RtField verdict_of(const Row *r) {
    const bool ahead = rt_best_is_ahead(r->best);
    const bool in_all = r->best->ours + r->best->extent_tests < r->best->published + 1;
    RtField field = rt_field_text(!ahead   ? "not fewer"
                                  : in_all ? "fewer, also with extent tests"
                                           : "fewer, but **more with extent tests**");
    field.missed = !ahead || !in_all;
    return field;
}

static RtField judged_of(const Row *r) {
    char tolerance[32] = "";
    if (tolerance_of(r, r->column) > 0)
        snprintf(tolerance, sizeof tolerance, ", %.9g %%", tolerance_of(r, r->column));
    return rt_field_print("%s%s", rt_column_name(r->column), tolerance);
}

static RtField outside_of(const Row *r) {
    RtField field = rt_field_integer(r->judged[RT_OUTSIDE]);
    field.missed = field.integer > 0;
    return field;
}

/* The published figure; the measured one and its deviation. */
static RtField shown_figure(const void *row, const RtTableColumn *column) {
    const Row *r = row;
    const RtFigure *figure = rt_published_figure(r->published, r->row, (RtColumn)column->key);
    char measured[RT_MAX_FIGURE], more[64] = "";
    if (!figure) return rt_field_missing();
    rt_figure_measured(figure, measured);
    bool missed = figure->judgement == RT_OUTSIDE;
    const char *bold = missed ? "**" : "";
    if (*measured)
        snprintf(more, sizeof more, "; %s%s (%+.1f %%)%s", bold, measured, figure->deviation, bold);
    RtField field =
        rt_field_print("%s%s%s", figure->text, more,
                       column->key == RT_COLUMN_object_tests && r->row->per_hit ? " per hit" : "");
    field.missed = missed;
    field.note = reason_of(r->published, figure);
    return field;
}

/* ---- columns ---- */

#define COLUMNS(X)                                                                                           \
    X(scene, "scene", text, "", "the scene's label in the experiment",                                       \
      r->published->experiment->workloads[r->workload].label)                                                \
    X(source, "source", text, "", "who published it", r->row->source)                                        \
    X(structure, "structure", text, "", "name of the structure there", r->row->structure)                    \
    X(parameters, "parameters", text, "", "its parameters there", r->row->parameters)                        \
    X(accel, "accel", text, "", "label of the accelerator that is measured", r->accel)                       \
    X(column, "column", text, "", "the measure of the figure", rt_column_name(r->figure->column))            \
    X(per, "per", text, "", "what object tests are divided by: ray, or hit (a ray that hits)", per_of(r))    \
    X(published, "published", real6, "", "the published figure", r->said)                                    \
    X(measured, "measured", real6, "", "what was measured here", measured_of(r))                             \
    X(deviation, "deviation", percent, "%", "how much larger the measured figure is", r->figure->deviation)  \
    X(tolerance, "tolerance", real9, "%", "largest allowed deviation", tolerance_of(r, r->figure->column))   \
    X(within, "within", flag, "", "whether the deviation is within the tolerance; empty: not judged",        \
      within_of(r))                                                                                          \
    X(reason, "reason", text, "", "reason for a larger deviation", reason_of(r->published, r->figure))       \
    X(measure, "measure", text, "", "the measure to minimise, per ray of any kind",                          \
      rt_measure_name(r->measure))                                                                           \
    X(published_row, "best published row", text, "", "the published row with the smallest value",            \
      name_of(r))                                                                                            \
    X(ours, "ours", real6, "", "the smallest value among our accelerators", r->best->ours)                   \
    X(extent_tests, "extent_tests", real6, "", "extent tests per ray that this accelerator also makes",      \
      r->best->extent_tests)                                                                                 \
    X(ahead, "ahead", flag, "", "whether ours is less than what was published",                              \
      rt_field_flag(rt_best_is_ahead(r->best)))                                                              \
    X(said4, "published", real4, "", "the smallest published figure", r->said)                               \
    X(our_accel, "ours", markup, "", "our accelerator with the smallest value",                              \
      rt_field_print("`%s`", r->accel))                                                                      \
    X(ours4, "measured", real4, "", "its value", r->best->ours)                                              \
    X(extent_tests4, "extent tests", real4, "", "extent tests that it also makes", r->best->extent_tests)    \
    X(verdict, "ours needs", markup, "", "how ours compares, without extent tests and with them",            \
      verdict_of(r))                                                                                         \
    X(judged, "column", text, "", "the measure, and how much its figures may deviate", judged_of(r))         \
    X(figures, "figures", integer, "", "published figures", r->figures)                                      \
    X(inside, "within", integer, "", "those within the tolerance", r->judged[RT_WITHIN])                     \
    X(outside, "outside", integer, "", "those outside it", outside_of(r))                                    \
    X(unjudged, "not judged", integer, "", "those that are only shown", r->judged[RT_UNJUDGED])              \
    X(row_name, "row", text, "", "as it was published", name_of(r))

RT_TABLE_COLUMNS(columns, COLUMNS)

static const RtColumnGroup figures[] = {RT_FROM_TO(columns, scene, reason)};
static const RtColumnGroup best[] = {RT_ONE(columns, scene), RT_FROM_TO(columns, measure, published_row),
                                     RT_ONE(columns, published), RT_ONE(columns, accel),
                                     RT_FROM_TO(columns, ours, ahead)};
static const RtColumnGroup best_for_the_eye[] = {
    RT_ONE(columns, scene), RT_FROM_TO(columns, measure, published_row), RT_FROM_TO(columns, said4, verdict)};
static const RtColumnGroup summary[] = {RT_FROM_TO(columns, judged, unjudged)};

/* ---- rows ---- */

static const void *figures_row(void *context, size_t i) {
    Row *r = context;
    r->figure = &r->published->figures[i];
    r->row = &r->published->rows[r->figure->row];
    r->workload = r->row->workload;
    r->accel = r->row->accel;
    r->said = rt_field_text(r->figure->text);
    return r;
}

static const void *best_row(void *context, size_t i) {
    Row *r = context;
    r->workload = (uint32_t)(i / RT_MEASURE_COUNT);
    r->measure = (RtMeasure)(i % RT_MEASURE_COUNT);
    r->best = &r->published->best[r->workload][r->measure];
    if (r->best->row == RT_NOT_MEASURED) return NULL;
    r->row = &r->published->rows[r->best->row];
    r->accel = r->best->candidate == RT_NOT_MEASURED
                   ? NULL
                   : r->published->experiment->candidates[r->best->candidate].label;
    r->said = rt_field_real(r->best->published);
    return r;
}

static const void *best_eye_row(void *context, size_t i) {
    const Row *r = best_row(context, i);
    return r && r->accel ? r : NULL;
}

static const void *summary_row(void *context, size_t i) {
    Row *r = context;
    r->column = (RtColumn)i;
    r->figures = 0;
    memset(r->judged, 0, sizeof r->judged);
    for (uint32_t f = 0; f < r->published->figure_count; f++) {
        const RtFigure *figure = &r->published->figures[f];
        if (figure->column != r->column) continue;
        r->figures++;
        r->judged[figure->judgement]++;
    }
    return r->figures ? r : NULL;
}

static const void *workload_row(void *context, size_t i) {
    Row *r = context;
    r->row = &r->published->rows[i];
    return r->row->workload == r->workload && r->row->of_rays == r->of_rays ? r : NULL;
}

/* The name of the row, and the columns that any row of the workload has. */
static void show_columns(Row *r) {
    bool shown[RT_COLUMN_COUNT] = {false};
    size_t count = 0;
    r->shown[count++] = columns[AT_row_name];
    for (uint32_t i = 0; i < r->published->figure_count; i++) {
        const RtFigure *figure = &r->published->figures[i];
        const RtPublishedRow *row = &r->published->rows[figure->row];
        shown[figure->column] |= row->workload == r->workload && row->of_rays == r->of_rays;
    }
    for (int c = 0; c < RT_COLUMN_COUNT; c++) {
        const char *name = rt_column_name((RtColumn)c), *meaning = "published; measured (deviation)";
        if (shown[c])
            r->shown[count++] = (RtTableColumn){name, name, "", meaning, shown_figure, RT_FORM_markup, c};
    }
    r->shown_group = (RtColumnGroup){NULL, r->shown, count, NULL};
}

RtTable rt_published_table(RtPublishedTable which, RtPublishedCursor *cursor) {
    static const RtTable tables[RT_PUBLISHED_TABLE_COUNT] = {
        [RT_FIGURES] = {RT_GROUPS(figures), .row = figures_row},
        [RT_BEST] = {RT_GROUPS(best), .row = best_row},
        [RT_BEST_FOR_THE_EYE] = {RT_GROUPS(best_for_the_eye), .row = best_eye_row},
        [RT_SUMMARY] = {RT_GROUPS(summary), .row = summary_row},
        [RT_ROWS_OF_RAYS] = {.row = workload_row},
        [RT_ROWS_OF_STRUCTURES] = {.row = workload_row},
    };
    const RtPublished *p = cursor->published;
    const size_t measures = (size_t)p->experiment->workload_count * RT_MEASURE_COUNT;
    const size_t counts[RT_PUBLISHED_TABLE_COUNT] = {p->figure_count, measures,     measures,
                                                     RT_COLUMN_COUNT, p->row_count, p->row_count};
    RtTable table = tables[which];
    table.row_count = counts[which];
    table.context = cursor;
    table.ragged = true;
    if (table.groups) return table;
    cursor->of_rays = which == RT_ROWS_OF_RAYS;
    show_columns(cursor);
    table.groups = &cursor->shown_group;
    table.group_count = cursor->shown_group.count > 1;
    return table;
}

/* ---- the page ---- */

typedef struct Page {
    const RtPublished *published;
    bool html; /* or Markdown */
    FILE *out;
} Page;

/* Text with `code`, between two strings. */
static void put(const Page *page, const char *before, const char *text, const char *after) {
    fputs(before, page->out);
    if (page->html) {
        rt_html_markup(page->out, text);
    } else {
        fputs(text, page->out);
    }
    fputs(after, page->out);
}

static void put_title(const Page *page, const char *title) {
    put(page, page->html ? "<h3>" : "\n## ", title, page->html ? "</h3>\n" : "\n");
}

static void put_paragraph(const Page *page, const char *text) {
    put(page, page->html ? "<p>" : "\n", text, page->html ? "</p>\n" : "\n");
}

static void put_table(const Page *page, uint32_t workload, RtPublishedTable which) {
    RtPublishedCursor cursor = {.published = page->published, .workload = workload};
    RtTable table = rt_published_table(which, &cursor);
    if (!table.group_count) return;
    if (!page->html) fputc('\n', page->out);
    (page->html ? rt_table_html : rt_table_markdown)(&table, page->out);
}

static void put_workload(const Page *page, uint32_t t) {
    const char *label = page->published->experiment->workloads[t].label;
    put(page, page->html ? "<details><summary>" : "\n## ", label, page->html ? "</summary>\n" : "\n");
    put_table(page, t, RT_ROWS_OF_RAYS);
    put_table(page, t, RT_ROWS_OF_STRUCTURES);
    if (page->html) fputs("</details>\n", page->out);
}

static void put_reasons(const Page *page) {
    put_title(page, "Reasons for deviations");
    fputs(page->html ? "<ul>\n" : "\n", page->out);
    for (uint32_t i = 0; i < page->published->reason_count; i++) {
        const RtReason *reason = &page->published->reasons[i];
        char text[RT_MAX_REASON + 5 * RT_MAX_LABEL];
        if (!reason->used) continue;
        snprintf(text, sizeof text, "`%s` of `%s` on `%s` (%s): %s [%" PRIu32 "]", reason->column,
                 *reason->accel ? reason->accel : "the rays", reason->scene, reason->source, reason->text,
                 reason->used);
        put(page, page->html ? "<li>" : "- ", text, page->html ? "</li>\n" : "\n");
    }
    if (page->html) fputs("</ul>\n", page->out);
}

void rt_published_page(const RtPublished *published, bool html, FILE *out) {
    const Page page = {published, html, out};
    const RtExperiment *experiment = published->experiment;
    if (published->row_count == 0 && html) return;
    if (html) {
        fputs("<h2>Published figures</h2>\n", out);
    } else {
        fprintf(out, "# %s: published, measured\n", experiment->name);
    }
    put_paragraph(&page, "Written by `raytally run`. A cell shows the published figure, then the measured "
                         "one and its deviation, in bold if it exceeds the tolerance.");
    put_table(&page, 0, RT_SUMMARY);
    put_title(&page, "Ours compared with the best published row");
    put_paragraph(&page, "Per ray, over all kinds. Rows that count tests per hit are converted to tests per "
                         "ray. Published rows count no extent tests, of which a grid or an octree makes one "
                         "per ray; ours make those listed. The last column compares without extent tests, "
                         "then with them.");
    put_table(&page, 0, RT_BEST_FOR_THE_EYE);
    for (uint32_t t = 0; t < experiment->workload_count; t++) put_workload(&page, t);
    put_reasons(&page);
}

/* ---- files ---- */

void rt_published_file_write(RtResultFile file, const RtPublished *published, FILE *out) {
    RtPublishedCursor cursor = {.published = published};
    RtTable table = rt_published_table(file == RT_FILE_BEST ? RT_BEST : RT_FIGURES, &cursor);
    if (file == RT_FILE_PUBLISHED_PAGE)
        rt_published_page(published, false, out);
    else
        rt_table_csv(&table, out);
}

RtStatus rt_published_files_write(const RtPublished *published, const char *directory, RtError *error) {
    for (RtResultFile file = 0; file < RT_RESULT_FILE_COUNT; file++) {
        RtOutput output;
        if (rt_result_file_sort(published->experiment, file) != RT_FILE_COMPARED) continue;
        RT_TRY(rt_output_open_in(&output, directory, rt_result_files[file], error));
        rt_published_file_write(file, published, output.file);
        RT_TRY(rt_output_commit(&output, error));
    }
    return RT_OK;
}
