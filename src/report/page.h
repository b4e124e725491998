/* SPDX-License-Identifier: Apache-2.0 */
/* The frame of report.html and index.html, which is also the explorer's. A page is one self-contained file
 * with its style, its data as JSON, and the script (page/page.js) that makes tables of them. Without the
 * script it shows question, answer and plots. */
#ifndef RT_REPORT_PAGE_H
#define RT_REPORT_PAGE_H

#include "claims/findings.h"

#include <jansson.h>
#include <stdio.h>

/* The beginning up to the heading. The page loads no files; with `images` it may load pictures. */
void rt_page_begin(FILE *out, const char *title, bool images);

/* The end after the last section, with the script and its data; page.js lists the members that it knows.
 * Takes the reference. */
RtStatus rt_page_end(json_t *data, FILE *out, RtError *error);

/* The data alone, as the element `data`. Takes the reference. */
RtStatus rt_page_data(json_t *data, FILE *out, RtError *error);

/* Writes strings up to NULL, as in generated headers. */
void rt_page_lines(FILE *out, const char *const *lines);

/* `size` bytes at `data` as a data URL in base64, `type` being "image/png" and the like. */
void rt_page_data_url(FILE *out, const char *type, const void *data, size_t size);

/* Writes text as HTML, escaped; NULL is "". The same between `before` and `after`, which are HTML. In
 * paragraphs of cards page.js makes elements of `code` and **bold**, as in Markdown. */
void rt_html_put(FILE *out, const char *text);
void rt_html_wrap(FILE *out, const char *before, const char *text, const char *after);

/* A heading with text below; nothing if the text is empty. */
void rt_page_card(FILE *out, const char *title, const char *text);

/* The same of the experiment's finding, whose figures and claims have a tooltip, and a mark where they do not
 * hold (claims/findings.h). */
void rt_page_finding(FILE *out, const RtFinding *finding);

/* The claims of the experiment with their verdicts and figures, as data. */
json_t *rt_page_claims(const RtResults *results);

/* The sentences of the literature that the experiment tests, with what their verdicts lack, as data. */
json_t *rt_page_papers(const RtResults *results);

/* The name of a file beside the page, as in links; and a link to it. */
void rt_page_path(FILE *out, const char *file);
void rt_page_link(FILE *out, const char *file, const char *text);

#endif
