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

/* Writes index.html, for a browser, and index.md, for GitHub, for the result directories in `folder` or in
 * its folders, grouped by the sections of their experiments: question, answer, verdict and plot of each
 * experiment, the sentences of the literature that they test, and the sums of verifications. index.md is a
 * table of questions and answers. They say which builds and machines measured what, if there are several, and
 * name directories that cannot be read, with the reason. *count gets the number of directories; RT_BAD_INPUT
 * if there is none. */
RtStatus rt_index_write(const char *folder, size_t *count, RtError *error);

#endif
