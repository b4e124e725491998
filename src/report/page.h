/* SPDX-License-Identifier: Apache-2.0 */
/* The common parts of report.html and index.html: frame, verdicts, cards. A page is one self-contained file
 * with its style and script (page/page.css, page/page.js), and is complete without the script. */
#ifndef RT_REPORT_PAGE_H
#define RT_REPORT_PAGE_H

#include "results/results.h"

#include <jansson.h>
#include <stdio.h>

/* The beginning up to the heading, and the end after the last section. The page loads no files; with `images`
 * it may load pictures. */
void rt_page_begin(FILE *out, const char *title, bool images);
void rt_page_end(FILE *out);

/* Writes strings up to NULL, as in generated headers. */
void rt_page_lines(FILE *out, const char *const *lines);

/* `size` bytes at `data` as a data URL in base64, `type` being "image/png" and the like. */
void rt_page_data_url(FILE *out, const char *type, const void *data, size_t size);

/* A heading with text below, which may have `code`; nothing if the text is empty. */
void rt_page_card(FILE *out, const char *title, const char *text);

/* The claims of the experiment as a list, each with its verdict and its figures. */
void rt_page_claims(FILE *out, const RtResults *results);

/* "3 of 4 claims hold, 1 does not", in the colour of the worst verdict; or that there are no claims. */
void rt_page_verdict(FILE *out, const RtResults *results);

/* The sentences of the literature that the experiment tests, each with source and verdict, in a card; nothing
 * if there are none. */
void rt_page_papers(FILE *out, const RtExperiment *experiment);

/* The verdict on such a sentence, coloured. */
void rt_page_paper_verdict(FILE *out, const RtPaper *paper);

/* A line with date and machine, from the manifest. */
void rt_page_provenance(FILE *out, const json_t *manifest);

/* The name of a file beside the page, as in links; and a link to it. */
void rt_page_path(FILE *out, const char *file);
void rt_page_link(FILE *out, const char *file, const char *text);

#endif
