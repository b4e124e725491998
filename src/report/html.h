/* Parts of the report (report.h) that are written elsewhere. */
#ifndef RT_REPORT_HTML_H
#define RT_REPORT_HTML_H

#include "literature/published.h"

/* The section about published figures; nothing where there are none. */
void rt_html_published(const RtPublished *published, FILE *out);

#endif
