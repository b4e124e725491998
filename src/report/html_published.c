/* Published figures in the report: a summary, what is least, and a table a scene, in which figures that are
 * missed are marked and tell their reasons. */
#include "literature/published_tables.h"
#include "report/html.h"

#include <inttypes.h>

static void put_table(const RtPublished *published, uint32_t trial, RtPublishedTable which, FILE *out) {
    RtPublishedCursor cursor = {.published = published, .trial = trial};
    RtTable table = rt_published_table(which, &cursor);
    if (table.group_count) rt_table_html(&table, out);
}

static void put_reasons(const RtPublished *published, FILE *out) {
    fputs("<h3>Why figures are missed</h3>\n<ul>\n", out);
    for (uint32_t i = 0; i < published->reason_count; i++) {
        const RtReason *reason = &published->reasons[i];
        if (!reason->used) continue;
        const char *const about[] = {reason->scene, *reason->accel ? reason->accel : "rays", reason->column};
        fputs("<li>", out);
        rt_html_put(out, reason->text);
        for (int k = 0; k < 3; k++) {
            fputs(k ? ", " : " <span class=\"meta\">", out);
            rt_html_put(out, about[k]);
        }
        fprintf(out, ": %" PRIu32 "</span></li>\n", reason->used);
    }
    fputs("</ul>\n", out);
}

void rt_html_published(const RtPublished *published, FILE *out) {
    const RtExperiment *experiment = published->experiment;
    if (published->row_count == 0) return;
    fputs("<h2>Published figures</h2>\n", out);
    put_table(published, 0, RT_SUMMARY, out);
    fprintf(out, "<h3>%s</h3>\n<p>%s</p>\n", RT_LEAST_TITLE, RT_LEAST_MEANING);
    put_table(published, 0, RT_LEAST_FOR_THE_EYE, out);
    put_reasons(published, out);
    fputs("<p>Below: the published figure; the measured one and its deviation. Those outside their tolerance "
          "are marked, and show their reason when pointed at.</p>\n",
          out);
    for (uint32_t t = 0; t < experiment->trial_count; t++) {
        fputs("<details><summary>", out);
        rt_html_put(out, experiment->trials[t].label);
        fputs("</summary>\n", out);
        put_table(published, t, RT_ROWS_OF_RAYS, out);
        put_table(published, t, RT_ROWS_OF_STRUCTURES, out);
        fputs("</details>\n", out);
    }
}
