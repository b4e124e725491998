/* SPDX-License-Identifier: Apache-2.0 */
#include "core/base/memory.h"
#include "core/base/words.h"
#include "core/text/csv.h"
#include "literature/published.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>

/* ---- columns ---- */

static const char *const column_names[] = {
#define NAME(name) #name,
    RT_PUBLISHED_COLUMNS(NAME)
#undef NAME
};

const char *rt_column_name(RtColumn column) {
    return column_names[column];
}

/* Columns without figures to compare. */
static const char *const other_columns[] = {"scene",      "source",    "accel",         "structure",
                                            "parameters", "tests_per", "build_seconds", "trace_seconds"};
enum { OTHER_COUNT = sizeof other_columns / sizeof other_columns[0] };

static RtColumn find_column(const char *name) {
    int column = 0;
    while (column < RT_COLUMN_COUNT && strcmp(column_names[column], name) != 0) column++;
    return (RtColumn)column;
}

static bool is_of_rays(RtColumn column) {
    return column >= RT_COLUMN_primary;
}

static bool is_per_ray(RtColumn column) {
    return column >= RT_COLUMN_object_tests && !is_of_rays(column);
}

static RtStatus check_columns(const RtCsv *csv, RtError *error) {
    const char *names[RT_COLUMN_COUNT + OTHER_COUNT];
    char suggestion[RT_MAX_SUGGESTION];
    memcpy(names, column_names, sizeof column_names);
    memcpy(names + RT_COLUMN_COUNT, other_columns, sizeof other_columns);
    for (uint32_t c = 0; c < csv->columns; c++) {
        const char *name = rt_csv_name(csv, c);
        size_t i = 0;
        while (i < RT_COLUMN_COUNT + OTHER_COUNT && strcmp(names[i], name) != 0) i++;
        if (i < RT_COLUMN_COUNT + OTHER_COUNT && rt_csv_find(csv, name) == c) continue;
        rt_suggest(name, names, RT_COLUMN_COUNT + OTHER_COUNT, suggestion);
        return rt_fail(error, RT_BAD_INPUT, "%s: there is %s column '%s'%s", csv->path,
                       i < RT_COLUMN_COUNT + OTHER_COUNT ? "more than one" : "no such", name, suggestion);
    }
    if (rt_csv_find(csv, "scene") < csv->columns && rt_csv_find(csv, "source") < csv->columns) return RT_OK;
    return rt_fail(error, RT_BAD_INPUT, "%s: the columns scene and source are required", csv->path);
}

/* ---- rows ---- */

static RtStatus copy_field(const RtCsv *csv, uint32_t r, const char *column, char *out, size_t size,
                           RtError *error) {
    const char *field = rt_csv_field(csv, r, rt_csv_find(csv, column));
    if (strlen(field) < size) {
        strcpy(out, field);
        return RT_OK;
    }
    return rt_fail_at(error, csv->path, csv->lines[r], 0, "%s: at most %zu characters are allowed", column,
                      size - 1);
}

static RtStatus take_figure(RtPublished *published, const RtCsv *csv, uint32_t r, uint32_t c,
                            RtError *error) {
    RtFigure *figure = &published->figures[published->figure_count];
    RtColumn column = find_column(rt_csv_name(csv, c));
    const char *text = rt_csv_field(csv, r, c), *point = strchr(text, '.');
    char *end;
    if (column == RT_COLUMN_COUNT || !*text) return RT_OK;
    *figure = (RtFigure){.row = published->row_count, .column = column, .measured = (double)NAN};
    figure->published = strtod(text, &end);
    figure->deviation = (double)NAN;
    figure->reason = RT_NO_REASON;
    /* Without sign and exponent, counting digits finds half a unit of the last one. */
    if (strlen(text) >= RT_MAX_FIGURE || *end || strspn(text, "0123456789.") != strlen(text)) {
        return rt_fail_at(error, csv->path, csv->lines[r], 0, "%s: '%s' is not a figure such as 12.30",
                          rt_column_name(column), text);
    }
    strcpy(figure->text, text);
    figure->half_unit = is_per_ray(column) ? 0.5 : 0; /* the others are whole numbers */
    for (const char *digit = point ? point + 1 : end; *digit; digit++) figure->half_unit /= 10;
    RtPublishedRow *row = &published->rows[published->row_count];
    if (!row->of_rays && is_of_rays(column)) {
        return rt_fail_at(error, csv->path, csv->lines[r], 0,
                          "%s: a row with an accelerator cannot count rays", rt_column_name(column));
    }
    if (row->of_rays && !is_of_rays(column)) {
        return rt_fail_at(error, csv->path, csv->lines[r], 0, "%s: the table needs a column accel",
                          rt_column_name(column));
    }
    row->count++;
    published->figure_count++;
    return RT_OK;
}

/* The row's candidate, which must be measured on its scene and on every ray. */
static RtStatus find_candidate(const RtExperiment *experiment, RtPublishedRow *row, const char *path,
                               uint32_t line, RtError *error) {
    if (!*row->accel) return RT_OK;
    row->candidate = rt_candidate_find(experiment, row->accel, row->workload);
    if (row->candidate >= experiment->candidate_count) {
        return rt_fail_at(error, path, line, 0, "%s has no accelerator with the label '%s' on the scene %s",
                          experiment->name, row->accel, experiment->workloads[row->workload].label);
    }
    if (experiment->candidates[row->candidate].ray_stride == 1) return RT_OK;
    return rt_fail_at(error, path, line, 0,
                      "'%s' is measured on a part of the rays; published figures cover all of them",
                      row->accel);
}

static RtStatus take_row(RtPublished *published, const RtCsv *csv, uint32_t r, RtError *error) {
    const RtExperiment *experiment = published->experiment;
    RtPublishedRow *row = &published->rows[published->row_count];
    char scene[RT_MAX_LABEL], per[RT_MAX_LABEL];
    uint32_t line = csv->lines[r];
    *row = (RtPublishedRow){.candidate = RT_NOT_MEASURED, .first = published->figure_count};
    RT_TRY(copy_field(csv, r, "scene", scene, sizeof scene, error));
    RT_TRY(copy_field(csv, r, "source", row->source, sizeof row->source, error));
    RT_TRY(copy_field(csv, r, "accel", row->accel, sizeof row->accel, error));
    RT_TRY(copy_field(csv, r, "structure", row->structure, sizeof row->structure, error));
    RT_TRY(copy_field(csv, r, "parameters", row->parameters, sizeof row->parameters, error));
    RT_TRY(copy_field(csv, r, "tests_per", per, sizeof per, error));
    row->of_rays = rt_csv_find(csv, "accel") == csv->columns;
    row->per_hit = strcmp(per, "hit") == 0;
    row->workload = rt_workload_find(experiment, scene);
    if (row->workload == experiment->workload_count) {
        return rt_fail_at(error, csv->path, line, 0, "%s has no scene with the label '%s'", experiment->name,
                          scene);
    }
    RT_TRY(find_candidate(experiment, row, csv->path, line, error));
    if (!row->per_hit && strcmp(per, "ray") != 0 &&
        *rt_csv_field(csv, r, rt_csv_find(csv, rt_column_name(RT_COLUMN_object_tests)))) {
        return rt_fail_at(error, csv->path, line, 0, "tests_per: invalid value '%s': expected ray or hit",
                          per);
    }
    for (uint32_t c = 0; c < csv->columns; c++) RT_TRY(take_figure(published, csv, r, c, error));
    published->row_count++;
    return RT_OK;
}

static RtStatus take_rows(RtPublished *published, const RtCsv *csv, RtError *error) {
    uint32_t rows = published->row_count, figures = published->figure_count;
    RT_TRY(check_columns(csv, error));
    RT_TRY(rt_reserve(&published->rows, &rows, (uint64_t)rows + csv->rows, sizeof(RtPublishedRow), error));
    RT_TRY(rt_reserve(&published->figures, &figures, figures + (uint64_t)csv->rows * csv->columns,
                      sizeof(RtFigure), error));
    for (uint32_t r = 0; r < csv->rows; r++) RT_TRY(take_row(published, csv, r, error));
    return RT_OK;
}

/* ---- reasons ---- */

static RtStatus take_reason(RtPublished *published, const RtCsv *csv, uint32_t r, RtError *error) {
    RtReason *reason = &published->reasons[r];
    *reason = (RtReason){.line = csv->lines[r]};
    RT_TRY(copy_field(csv, r, "scene", reason->scene, sizeof reason->scene, error));
    RT_TRY(copy_field(csv, r, "source", reason->source, sizeof reason->source, error));
    RT_TRY(copy_field(csv, r, "accel", reason->accel, sizeof reason->accel, error));
    RT_TRY(copy_field(csv, r, "column", reason->column, sizeof reason->column, error));
    RT_TRY(copy_field(csv, r, "reason", reason->text, sizeof reason->text, error));
    for (const char *c = reason->text; *c; c++) {
        if (!isspace((unsigned char)*c)) return RT_OK;
    }
    return rt_fail_at(error, csv->path, csv->lines[r], 0, "the reason is missing");
}

static RtStatus take_reasons(RtPublished *published, const RtCsv *csv, RtError *error) {
    const char *const columns[] = {"scene", "source", "accel", "column", "reason"};
    for (size_t i = 0; i < sizeof columns / sizeof columns[0]; i++) {
        if (rt_csv_find(csv, columns[i]) < csv->columns) continue;
        return rt_fail(error, RT_BAD_INPUT,
                       "%s: the column '%s' is missing: expected scene, source, accel, column, reason",
                       csv->path, columns[i]);
    }
    published->reasons = rt_alloc(csv->rows, sizeof(RtReason));
    if (!published->reasons) return rt_fail_memory(error, csv->path, csv->rows * sizeof(RtReason));
    for (uint32_t r = 0; r < csv->rows; r++) RT_TRY(take_reason(published, csv, r, error));
    published->reason_count = csv->rows;
    return RT_OK;
}

/* ---- files ---- */

typedef RtStatus TakeTable(RtPublished *published, const RtCsv *csv, RtError *error);

static RtStatus load_table(RtPublished *published, const char *path, TakeTable take, RtError *error) {
    RtCsv csv;
    RtStatus status = rt_csv_read(&csv, path, error);
    if (status == RT_OK) status = take(published, &csv, error);
    rt_csv_clear(&csv);
    return status;
}

RtStatus rt_published_load(RtPublished *published, const RtExperiment *experiment, RtError *error) {
    const RtPublishedSetup *setup = &experiment->published;
    *published = (RtPublished){.experiment = experiment};
    for (uint32_t i = 0; i < setup->table_count; i++) {
        char path[RT_MAX_PATH];
        RT_TRY(rt_path_join(experiment->folder, setup->tables[i], path, error));
        RT_TRY(load_table(published, path, take_rows, error));
    }
    if (!*setup->reasons) return RT_OK;
    RT_TRY(rt_path_join(experiment->folder, setup->reasons, published->reasons_path, error));
    return load_table(published, published->reasons_path, take_reasons, error);
}

void rt_published_clear(RtPublished *published) {
    rt_free(published->rows);
    rt_free(published->figures);
    rt_free(published->reasons);
    *published = (RtPublished){0};
}
