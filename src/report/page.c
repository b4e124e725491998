/* SPDX-License-Identifier: Apache-2.0 */
#include "report/page.h"

#include "claims/claims.h"
#include "page_css.h"
#include "page_js.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>

/* ---- the frame ---- */

void rt_page_lines(FILE *out, const char *const *lines) {
    for (; *lines; lines++) fputs(*lines, out);
}

/* For browsers, a page that is opened as a file has no 'self'. */
void rt_page_begin(FILE *out, const char *title, bool images) {
    fprintf(out,
            "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n"
            "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
            "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; img-src data:%s; "
            "style-src 'unsafe-inline'; script-src 'unsafe-inline'\">\n<link rel=\"icon\" "
            "href=\"data:,\">\n<title>",
            images ? " 'self' file:" : "");
    rt_html_wrap(out, "", title, "</title>\n<style>\n");
    rt_page_lines(out, page_css);
    rt_html_wrap(out, "</style></head>\n<body><main>\n<h1>", title, "</h1>\n");
}

/* `<` would end the element in some places. */
RtStatus rt_page_data(json_t *data, FILE *out, RtError *error) {
    char *text = data ? json_dumps(data, JSON_COMPACT | JSON_REAL_PRECISION(9)) : NULL;
    json_decref(data);
    if (!text) return rt_fail(error, RT_NO_MEMORY, "memory is short for the data of the page");
    fputs("<script type=\"application/json\" id=\"data\">", out);
    for (const char *c = text; *c; c++) {
        if (*c == '<')
            fputs("\\u003c", out);
        else
            fputc(*c, out);
    }
    fputs("</script>\n", out);
    free(text);
    return RT_OK;
}

RtStatus rt_page_end(json_t *data, FILE *out, RtError *error) {
    fputs("<div id=\"tables\"><noscript><p class=\"meta\">Tables need JavaScript; tables.md and the CSV "
          "files have "
          "their figures.</p></noscript></div>\n</main>\n",
          out);
    RT_TRY(rt_page_data(data, out, error));
    fputs("<script>\n", out);
    rt_page_lines(out, page_js);
    fputs("</script></body></html>\n", out);
    return RT_OK;
}

/* ---- files ---- */

void rt_page_data_url(FILE *out, const char *type, const void *data, size_t size) {
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    const unsigned char *bytes = data;
    fprintf(out, "data:%s;base64,", type);
    for (size_t i = 0; i < size; i += 3) {
        uint32_t left = size - i < 3 ? (uint32_t)(size - i) : 3, word = 0;
        for (uint32_t k = 0; k < 3; k++) word = word << 8 | (k < left ? bytes[i + k] : 0u);
        for (uint32_t k = 0; k < 4; k++) fputc(k <= left ? digits[word >> (18 - 6 * k) & 63] : '=', out);
    }
}

void rt_page_path(FILE *out, const char *file) {
    for (const char *c = file; *c; c++) {
        fprintf(out, isalnum((unsigned char)*c) || strchr("-_.~/", *c) ? "%c" : "%%%02X", (unsigned char)*c);
    }
}

void rt_page_link(FILE *out, const char *file, const char *text) {
    fputs("<a href=\"", out);
    rt_page_path(out, file);
    rt_html_wrap(out, "\">", text, "</a>");
}

/* ---- text ---- */

void rt_html_put(FILE *out, const char *text) {
    for (; text && *text; text++) {
        switch (*text) {
        case '<': fputs("&lt;", out); break;
        case '>': fputs("&gt;", out); break;
        case '&': fputs("&amp;", out); break;
        case '"': fputs("&quot;", out); break;
        default: fputc(*text, out);
        }
    }
}

void rt_html_wrap(FILE *out, const char *before, const char *text, const char *after) {
    fputs(before, out);
    rt_html_put(out, text);
    fputs(after, out);
}

void rt_page_card(FILE *out, const char *title, const char *text) {
    if (!*text) return;
    fprintf(out, "<section class=\"card\"><h2>%s</h2>", title);
    rt_html_wrap(out, "<p>", text, "</p></section>\n");
}

void rt_page_finding(FILE *out, const RtFinding *finding) {
    static const char *const classes[] = {[RT_FINDING_FIGURE] = "bound",
                                          [RT_FINDING_UPHELD] = "bound",
                                          [RT_FINDING_MISSING] = "bound open",
                                          [RT_FINDING_BROKEN] = "bound false"};
    fputs("<section class=\"card\"><h2>Finding</h2><p>", out);
    for (uint32_t i = 0; i < finding->count; i++) {
        const RtFindingSegment *segment = &finding->segments[i];
        const char *name = classes[segment->mark];
        if (name) rt_html_wrap(out, "<span class=\"", name, "\"");
        if (name) rt_html_wrap(out, " title=\"", segment->note, "\">");
        rt_html_put(out, segment->text);
        if (*segment->said) rt_html_wrap(out, " [", segment->said, "]");
        if (name) fputs("</span>", out);
    }
    fputs(finding->count ? "</p></section>\n" : "No finding yet.</p></section>\n", out);
}

json_t *rt_page_claims(const RtResults *results) {
    const RtExperiment *experiment = results->experiment;
    json_t *claims = json_array();
    char level[RT_MAX_CLAIM_LEVEL];
    for (uint32_t i = 0; i < experiment->claim_count; i++) {
        RtClaimResult result;
        rt_claim_judge(results, i, &result);
        json_array_append_new(claims,
                              json_pack("{s:s, s:s, s:s, s:s}", "text", experiment->claims[i], "verdict",
                                        rt_claim_verdict_name(result.verdict), "figures", result.figures,
                                        "later", rt_claim_is_later(results, i) ? RT_CLAIM_LATER : ""));
    }
    rt_claims_level(results, level);
    return json_pack("{s:o, s:o, s:s}", "claims", claims, "dropped", rt_claims_dropped(results), "level",
                     level);
}

json_t *rt_page_papers(const RtResults *results) {
    const RtExperiment *experiment = results->experiment;
    json_t *papers = json_array();
    for (uint32_t i = 0; i < experiment->paper_count; i++) {
        const RtPaper *paper = &experiment->papers[i];
        json_array_append_new(papers,
                              json_pack("{s:s, s:s, s:s, s:b, s:s, s:s, s:s, s:s}", "experiment",
                                        experiment->name, "citation", paper->citation, "page", paper->page,
                                        "seen", rt_paper_is_seen(paper), "quote", paper->quote, "verdict",
                                        rt_paper_verdict_name(paper->verdict), "problem",
                                        rt_paper_problem(results, paper), "modelled", paper->modelled));
    }
    return papers;
}
