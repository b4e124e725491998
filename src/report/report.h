/* SPDX-License-Identifier: Apache-2.0 */
/* The report of a result directory: one HTML file with everything in it. */
#ifndef RT_REPORT_REPORT_H
#define RT_REPORT_REPORT_H

#include "literature/published.h"
#include "run/run.h"

/* Writes `directory`/report.html from the results, what was compared with published figures (perhaps
 * nothing), the manifest, and the plots and images that are there. */
RtStatus rt_report_write(const RtResults *results, const RtPublished *published, const char *directory,
                         RtError *error);

/* What a finished run leaves besides its measurements: comparisons with published figures, plots, the report.
 * Without gnuplot there is a notice, and a report without plots. RT_MISMATCH, with everything written, if
 * gnuplot fails, or if rt_published_check fails (run_report.c). */
extern const RtRunReport rt_run_report;

#endif
