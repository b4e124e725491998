/* SPDX-License-Identifier: Apache-2.0 */
#include "report/paper_tables.h"

#include "core/base/file.h"
#include "experiment/result_tables.h"

#include <inttypes.h>
#include <string.h>

/* The rows of a table that are of one kind of rays. */
typedef struct OfKind {
    RtTable table;
    const RtResultRow *row;
    RtRayKind kind;
} OfKind;

static const void *row_of_kind(void *context, size_t i) {
    const OfKind *of = context;
    const void *row = of->table.row(of->table.context, i);
    return row && of->row->kind == of->kind ? row : NULL;
}

static bool has_rows(const RtTable *table) {
    for (size_t i = 0; i < table->row_count; i++) {
        if (table->row(table->context, i)) return true;
    }
    return false;
}

static void put_table(const RtResults *results, uint32_t t, RtRayKind kind, bool tex, FILE *out) {
    const RtExperiment *experiment = results->experiment;
    RtResultRow row = {.results = results, .workload = t};
    const RtResultTable which = experiment->count_only ? RT_COUNTED_PAPER : RT_CELLS_PAPER;
    OfKind of = {.table = rt_result_table(which, &row), .row = &row, .kind = kind};
    RtTable table = of.table;
    char caption[RT_MAX_LABEL + 128];
    table.row = row_of_kind;
    table.context = &of;
    if (!has_rows(&table)) return;
    snprintf(caption, sizeof caption, "%s, %" PRIu64 " %s rays.", experiment->workloads[t].label,
             results->workloads[t].rays[kind], rt_experiment_kind_name(experiment, kind));
    table.caption = caption;
    if (tex) {
        fputc('\n', out);
        rt_table_tex(&table, out);
    } else {
        fprintf(out, "\n%s\n\n", caption);
        rt_table_markdown(&table, out);
    }
}

static void put_head(const RtResults *results, bool tex, FILE *out) {
    char interval[RT_MAX_INTERVAL_TITLE];
    rt_interval_title(results->experiment, interval);
    char *sign = strchr(interval, '%');
    if (sign && sign > interval) sign[-1] = '\0';
    fprintf(out,
            tex ? "%% %s, written by raytally. Needs \\usepackage{booktabs,graphicx}.\n"
                : "# %s\n\nWritten by `raytally`.\n",
            results->experiment->name);
    const char *lead = tex ? "% " : "";
    fprintf(out, "%sTests, extent tests (ext.) and steps are per ray.", lead);
    if (results->experiment->count_only) {
        fprintf(out, "\n%sBold: the fewest object tests.\n", lead);
        return;
    }
    fprintf(out,
            "  Ratios compare throughput with %s; intervals of %s percent.\n"
            "%sBold: the best, and those whose time intervals overlap with its interval.\n",
            rt_baseline_label(results->experiment), interval, lead);
}

static RtStatus write_tables(const RtResults *results, const char *directory, const char *name, bool tex,
                             RtError *error) {
    const RtExperiment *experiment = results->experiment;
    RtOutput output;
    RT_TRY(rt_output_open_in(&output, directory, name, error));
    put_head(results, tex, output.file);
    for (uint32_t t = 0; t < experiment->workload_count; t++) {
        if (!results->workloads[t].known) continue;
        for (uint32_t k = 0; k < experiment->kind_count; k++)
            put_table(results, t, experiment->kinds[k], tex, output.file);
    }
    return rt_output_commit(&output, error);
}

RtStatus rt_paper_tables_write(const RtResults *results, const char *directory, RtError *error) {
    RT_TRY(write_tables(results, directory, "tables.md", false, error));
    return write_tables(results, directory, "tables.tex", true, error);
}
