#include "base/csv.h"
#include "literature/published.h"

#include <inttypes.h>
#include <math.h>

/* ---- CSV ---- */

static void put(FILE *out, const char *field) {
    rt_csv_put(out, field);
    fputc(',', out);
}

static void put_figure(const RtPublished *published, const RtFigure *figure, FILE *out) {
    const RtPublishedRow *row = &published->rows[figure->row];
    const double tolerance = published->experiment->published.tolerance[figure->column];
    char measured[RT_MAX_FIGURE];
    rt_figure_measured(figure, measured);
    put(out, published->experiment->trials[row->trial].label);
    put(out, row->source);
    put(out, row->structure);
    put(out, row->parameters);
    put(out, row->accel);
    put(out, rt_column_name(figure->column));
    put(out, figure->column == RT_COLUMN_object_tests ? (row->per_hit ? "hit" : "ray") : "");
    put(out, figure->text);
    put(out, measured);
    if (!isnan(figure->deviation)) fprintf(out, "%.2f", figure->deviation);
    fputc(',', out);
    if (tolerance > 0) fprintf(out, "%.9g", tolerance);
    fprintf(out, ",%s,",
            figure->judgement == RT_WITHIN    ? "yes"
            : figure->judgement == RT_OUTSIDE ? "no"
                                              : "");
    rt_csv_put(out, figure->reason == RT_NO_REASON ? "" : published->reasons[figure->reason].text);
    fputc('\n', out);
}

void rt_published_csv(const RtPublished *published, FILE *out) {
    fputs("scene,source,structure,parameters,accel,column,per,published,measured,deviation,tolerance,within,"
          "reason\n",
          out);
    for (uint32_t i = 0; i < published->figure_count; i++) put_figure(published, &published->figures[i], out);
}

static void put_known(FILE *out, double value) {
    if (!isnan(value)) fprintf(out, "%.6g", value);
    fputc(',', out);
}

static void put_least(const RtPublished *published, uint32_t t, RtMeasure measure, FILE *out) {
    const RtLeast *least = &published->least[t][measure];
    char name[RT_MAX_ROW_NAME];
    if (least->row == RT_NOT_MEASURED) return;
    rt_published_row_name(&published->rows[least->row], name);
    put(out, published->experiment->trials[t].label);
    put(out, rt_measure_name(measure));
    put(out, name);
    put_known(out, least->published);
    put(out,
        least->contender == RT_NOT_MEASURED ? "" : published->experiment->contenders[least->contender].label);
    put_known(out, least->ours);
    put_known(out, least->extent_tests);
    fprintf(out, "%s\n", rt_least_is_ahead(least) ? "yes" : "no");
}

void rt_least_csv(const RtPublished *published, FILE *out) {
    fputs("scene,measure,published_row,published,accel,ours,extent_tests,ahead\n", out);
    for (uint32_t t = 0; t < published->experiment->trial_count; t++) {
        for (int m = 0; m < RT_MEASURE_COUNT; m++) put_least(published, t, (RtMeasure)m, out);
    }
}

/* ---- Markdown ---- */

/* Text of a cell: bars are escaped. */
static void put_cell(FILE *out, const char *text) {
    for (; *text; text++) fprintf(out, *text == '|' ? "\\|" : "%c", *text);
}

static void put_summary(const RtPublished *published, FILE *out) {
    fputs("| column | figures | within | outside | not judged |\n| --- | --- | --- | --- | --- |\n", out);
    for (int c = 0; c < RT_COLUMN_COUNT; c++) {
        RtColumnSummary summary = rt_column_summary(published, (RtColumn)c);
        if (summary.figures == 0) continue;
        const double tolerance = published->experiment->published.tolerance[c];
        fprintf(out, "| %s", rt_column_name((RtColumn)c));
        if (tolerance > 0) fprintf(out, ", %.9g %%", tolerance);
        fprintf(out, " | %" PRIu32 " | %" PRIu32 " | %" PRIu32 " | %" PRIu32 " |\n", summary.figures,
                summary.judged[RT_WITHIN], summary.judged[RT_OUTSIDE], summary.judged[RT_UNJUDGED]);
    }
}

static void put_least_rows(const RtPublished *published, FILE *out) {
    fputs("\n## Ours against the best published row\n\nPer ray of all kinds. A row that counts tests per ray "
          "that hits is "
          "taken per ray. Extent tests are what ours make besides.\n\n"
          "| scene | measure | best published row | published | ours | measured | extent tests |\n"
          "| --- | --- | --- | --- | --- | --- | --- |\n",
          out);
    for (uint32_t t = 0; t < published->experiment->trial_count; t++) {
        for (int m = 0; m < RT_MEASURE_COUNT; m++) {
            const RtLeast *least = &published->least[t][m];
            char name[RT_MAX_ROW_NAME];
            if (least->row == RT_NOT_MEASURED || least->contender == RT_NOT_MEASURED) continue;
            rt_published_row_name(&published->rows[least->row], name);
            fputs("| ", out);
            put_cell(out, published->experiment->trials[t].label);
            fprintf(out, " | %s | ", rt_measure_name((RtMeasure)m));
            put_cell(out, name);
            fprintf(out, " | %.4g | `", least->published);
            put_cell(out, published->experiment->contenders[least->contender].label);
            fprintf(out, "` | %.4g%s | %.4g |\n", least->ours, rt_least_is_ahead(least) ? "" : ", not less",
                    least->extent_tests);
        }
    }
}

static void put_row_cell(const RtPublished *published, const RtPublishedRow *row, RtColumn column,
                         FILE *out) {
    const RtFigure *figure = rt_published_figure(published, row, column);
    char measured[RT_MAX_FIGURE];
    fputs(" |", out);
    if (!figure) return;
    rt_figure_measured(figure, measured);
    const char *bold = figure->judgement == RT_OUTSIDE ? "**" : "";
    fprintf(out, " %s", figure->text);
    if (*measured) fprintf(out, "; %s%s (%+.1f %%)%s", bold, measured, figure->deviation, bold);
    if (column == RT_COLUMN_object_tests && row->per_hit) fputs(" per hit", out);
}

static void put_rows(const RtPublished *published, uint32_t t, bool of_rays, FILE *out) {
    bool shown[RT_COLUMN_COUNT];
    if (!rt_published_columns(published, t, of_rays, shown)) return;
    fputs("\n| row", out);
    for (int c = 0; c < RT_COLUMN_COUNT; c++) {
        if (shown[c]) fprintf(out, " | %s", rt_column_name((RtColumn)c));
    }
    fputs(" |\n| ---", out);
    for (int c = 0; c < RT_COLUMN_COUNT; c++) fputs(shown[c] ? " | ---" : "", out);
    fputs(" |\n", out);
    for (uint32_t r = 0; r < published->row_count; r++) {
        const RtPublishedRow *row = &published->rows[r];
        char name[RT_MAX_ROW_NAME];
        if (row->trial != t || row->of_rays != of_rays) continue;
        rt_published_row_name(row, name);
        fputs("| ", out);
        put_cell(out, name);
        for (int c = 0; c < RT_COLUMN_COUNT; c++) {
            if (shown[c]) put_row_cell(published, row, (RtColumn)c, out);
        }
        fputs(" |\n", out);
    }
}

static void put_reasons(const RtPublished *published, FILE *out) {
    fputs("\n## Why figures are missed\n\n", out);
    for (uint32_t i = 0; i < published->reason_count; i++) {
        const RtReason *reason = &published->reasons[i];
        if (!reason->used) continue;
        fprintf(out, "- `%s` of `%s` on `%s` (%s): %s", reason->column,
                *reason->accel ? reason->accel : "the rays", reason->scene, reason->source, reason->text);
        fprintf(out, " [%" PRIu32 "]\n", reason->used);
    }
}

void rt_published_markdown(const RtPublished *published, FILE *out) {
    const RtExperiment *experiment = published->experiment;
    fprintf(out,
            "# %s: published, measured\n\nWritten by `raytally run`. A cell is the published figure; the "
            "measured one and "
            "its deviation, in bold where it is more than the tolerance.\n\n",
            experiment->name);
    put_summary(published, out);
    put_least_rows(published, out);
    for (uint32_t t = 0; t < experiment->trial_count; t++) {
        fprintf(out, "\n## %s\n", experiment->trials[t].label);
        put_rows(published, t, true, out);
        put_rows(published, t, false, out);
    }
    put_reasons(published, out);
}
