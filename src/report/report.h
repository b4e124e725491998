/* SPDX-License-Identifier: Apache-2.0 */
/* The report of a result directory: one HTML file with everything in it. */
#ifndef RT_REPORT_REPORT_H
#define RT_REPORT_REPORT_H

#include "literature/published.h"

/* Writes `directory`/report.html from the results, what was compared with published figures (perhaps
 * nothing), the manifest, and the plots and images that are there. */
RtStatus rt_report_write(const RtResults *results, const RtPublished *published, const char *directory,
                         RtError *error);

#endif
