/* SPDX-License-Identifier: Apache-2.0 */
/* What the pages share (report.html, index.html): their frame, verdicts, cards. A page is one file that asks
 * for no other: style and script lie in it (page/page.css, page/page.js), and it is whole without the script.
 */
#ifndef RT_REPORT_PAGE_H
#define RT_REPORT_PAGE_H

#include "experiment/results.h"

#include <jansson.h>
#include <stdio.h>

/* Up to the title as the heading, and from after the last section on. */
void rt_page_begin(FILE *out, const char *title);
void rt_page_end(FILE *out);

/* Strings ended by NULL, such as generated headers have. */
void rt_page_lines(FILE *out, const char *const *lines);

/* `size` bytes at `data` as a data URL in base64, `type` being "image/png" and the like. */
void rt_page_data_url(FILE *out, const char *type, const void *data, size_t size);

/* A heading with text under it; nothing where there is no text. */
void rt_page_card(FILE *out, const char *title, const char *text);

/* "3 of 4 claims hold, 1 does not": how the experiment's claims came out, in the colour of the worst; that
 * nothing was claimed, too. */
void rt_page_verdict(FILE *out, const RtResults *results);

/* When and on what it was measured, in a line, by the manifest. */
void rt_page_provenance(FILE *out, const json_t *manifest);

/* ` href="FILE"` of a link to a file beside the page, escaped. */
void rt_page_href(FILE *out, const char *file);

#endif
