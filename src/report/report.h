/* SPDX-License-Identifier: Apache-2.0 */
/* The report of a result directory: one HTML file with everything in it. */
#ifndef RT_REPORT_REPORT_H
#define RT_REPORT_REPORT_H

#include "run/run.h"

/* Writes `directory`/report.html, tables.md and tables.tex from the results, the manifest, and the plots and
 * images that are there. */
RtStatus rt_report_write(const RtResults *results, const char *directory, RtError *error);

/* What a finished run leaves besides its measurements: plots and the report. Without gnuplot there is a
 * notice, and a report without plots. RT_MISMATCH, with everything written, if gnuplot fails. */
RtRunReport rt_run_report;

#endif
