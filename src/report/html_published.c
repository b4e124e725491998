/* Published figures in the report: a summary, what is least, and a table a scene, in which figures that are
 * missed are marked and tell their reasons. */
#include "report/html.h"

#include <inttypes.h>
#include <math.h>

static void put_summary(const RtPublished *published, FILE *out) {
    fputs("<table><thead><tr><th>column</th><th>tolerance</th><th>figures</th><th>within</th><th>outside</th>"
          "<th>not judged</th></tr></thead><tbody>\n",
          out);
    for (int c = 0; c < RT_COLUMN_COUNT; c++) {
        RtColumnSummary summary = rt_column_summary(published, (RtColumn)c);
        const double tolerance = published->experiment->published.tolerance[c];
        if (summary.figures == 0) continue;
        fprintf(out, "<tr><td>%s</td><td>", rt_column_name((RtColumn)c));
        if (tolerance > 0) fprintf(out, "%.9g %%", tolerance);
        fprintf(
            out,
            "</td><td>%" PRIu32 "</td><td>%" PRIu32 "</td><td%s>%" PRIu32 "</td><td>%" PRIu32 "</td></tr>\n",
            summary.figures, summary.judged[RT_WITHIN], summary.judged[RT_OUTSIDE] ? " class=\"missed\"" : "",
            summary.judged[RT_OUTSIDE], summary.judged[RT_UNJUDGED]);
    }
    fputs("</tbody></table>\n", out);
}

static void put_least(const RtPublished *published, uint32_t t, RtMeasure measure, FILE *out) {
    const RtLeast *least = &published->least[t][measure];
    char name[RT_MAX_ROW_NAME];
    if (least->row == RT_NOT_MEASURED || least->contender == RT_NOT_MEASURED) return;
    rt_published_row_name(&published->rows[least->row], name);
    fputs("<tr><td>", out);
    rt_html_put(out, published->experiment->trials[t].label);
    fprintf(out, "</td><td class=\"row\">%s</td><td class=\"row\">", rt_measure_name(measure));
    rt_html_put(out, name);
    fprintf(out, "</td><td>%.4g</td><td class=\"row\">", least->published);
    rt_html_put(out, published->experiment->contenders[least->contender].label);
    fprintf(out, "</td><td%s>%.4g</td><td>%.4g</td></tr>\n",
            rt_least_is_ahead(least) ? "" : " class=\"missed\"", least->ours, least->extent_tests);
}

static void put_all_least(const RtPublished *published, FILE *out) {
    fputs("<h3>Ours against the best published row</h3>\n<p>Per ray of all kinds; a row that counts tests "
          "per ray that hits "
          "is taken per ray. Extent tests are what ours make besides.</p>\n<div "
          "class=\"wide\"><table><thead><tr>"
          "<th>scene</th><th class=\"row\">measure</th><th class=\"row\">best published "
          "row</th><th>published</th>"
          "<th class=\"row\">ours</th><th>measured</th><th>extent tests</th></tr></thead><tbody>\n",
          out);
    for (uint32_t t = 0; t < published->experiment->trial_count; t++) {
        for (int m = 0; m < RT_MEASURE_COUNT; m++) put_least(published, t, (RtMeasure)m, out);
    }
    fputs("</tbody></table></div>\n", out);
}

static void put_figure(const RtPublished *published, const RtFigure *figure, FILE *out) {
    char measured[RT_MAX_FIGURE];
    rt_figure_measured(figure, measured);
    fputs(figure->judgement == RT_OUTSIDE ? "<td class=\"missed\" title=\"" : "<td title=\"", out);
    if (figure->reason != RT_NO_REASON) rt_html_put(out, published->reasons[figure->reason].text);
    fprintf(out, "\">%s", figure->text);
    if (*measured)
        fprintf(out, "<br>%s<br><span class=\"meta\">%+.1f&nbsp;%%</span>", measured, figure->deviation);
    fputs("</td>", out);
}

static void put_row(const RtPublished *published, const RtPublishedRow *row, const bool *shown, FILE *out) {
    char name[RT_MAX_ROW_NAME];
    rt_published_row_name(row, name);
    fputs("<tr><td>", out);
    rt_html_put(out, name);
    if (row->per_hit) fputs("<br><span class=\"meta\">tests per hit</span>", out);
    fputs("</td>", out);
    for (int c = 0; c < RT_COLUMN_COUNT; c++) {
        const RtFigure *figure = rt_published_figure(published, row, (RtColumn)c);
        if (figure) {
            put_figure(published, figure, out);
        } else if (shown[c]) {
            fputs("<td></td>", out);
        }
    }
    fputs("</tr>\n", out);
}

static void put_rows(const RtPublished *published, uint32_t t, bool of_rays, FILE *out) {
    bool shown[RT_COLUMN_COUNT];
    if (!rt_published_columns(published, t, of_rays, shown)) return;
    fputs("<div class=\"wide\"><table><thead><tr><th>row</th>", out);
    for (int c = 0; c < RT_COLUMN_COUNT; c++) {
        if (shown[c]) fprintf(out, "<th>%s</th>", rt_column_name((RtColumn)c));
    }
    fputs("</tr></thead><tbody>\n", out);
    for (uint32_t r = 0; r < published->row_count; r++) {
        const RtPublishedRow *row = &published->rows[r];
        if (row->trial == t && row->of_rays == of_rays) put_row(published, row, shown, out);
    }
    fputs("</tbody></table></div>\n", out);
}

static void put_reasons(const RtPublished *published, FILE *out) {
    fputs("<h3>Why figures are missed</h3>\n<ul>\n", out);
    for (uint32_t i = 0; i < published->reason_count; i++) {
        const RtReason *reason = &published->reasons[i];
        if (!reason->used) continue;
        fputs("<li>", out);
        rt_html_put(out, reason->text);
        fputs(" <span class=\"meta\">", out);
        rt_html_put(out, reason->scene);
        fputs(", ", out);
        rt_html_put(out, *reason->accel ? reason->accel : "rays");
        fputs(", ", out);
        rt_html_put(out, reason->column);
        fprintf(out, ": %" PRIu32 "</span></li>\n", reason->used);
    }
    fputs("</ul>\n", out);
}

void rt_html_published(const RtPublished *published, FILE *out) {
    const RtExperiment *experiment = published->experiment;
    if (published->row_count == 0) return;
    fputs("<h2>Published figures</h2>\n", out);
    put_summary(published, out);
    put_all_least(published, out);
    put_reasons(published, out);
    fputs("<p>Below: the published figure, the measured one, its deviation. Those outside their tolerance "
          "are marked, and "
          "show their reason when pointed at.</p>\n",
          out);
    for (uint32_t t = 0; t < experiment->trial_count; t++) {
        fputs("<details><summary>", out);
        rt_html_put(out, experiment->trials[t].label);
        fputs("</summary>\n", out);
        put_rows(published, t, true, out);
        put_rows(published, t, false, out);
        fputs("</details>\n", out);
    }
}
