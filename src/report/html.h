/* Parts of the report (report.h) that are written elsewhere. */
#ifndef RT_REPORT_HTML_H
#define RT_REPORT_HTML_H

#include "literature/published.h"

/* Text, with what HTML gives a meaning escaped; NULL is "". */
void rt_html_put(FILE *out, const char *text);

/* The section about published figures; nothing where there are none. */
void rt_html_published(const RtPublished *published, FILE *out);

#endif
