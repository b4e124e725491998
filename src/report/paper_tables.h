/* SPDX-License-Identifier: Apache-2.0 */
/* The tables of a result directory for papers and web pages: tables.tex, tables.md. */
#ifndef RT_REPORT_PAPER_TABLES_H
#define RT_REPORT_PAPER_TABLES_H

#include "results/results.h"

/* Writes `directory`/tables.md and tables.tex (for the package booktabs): for each measure a table with a row
 * per accelerator and a column per scene, all kinds of rays together; and for each kind of rays one of the
 * times, or of the object tests if nothing was timed. Each sweep of a scene has tables of its own, a column
 * per value. In LaTeX the letters have 8 points; a table too wide for one column of a two-column article
 * takes both, and one too wide for these is divided. The best is bold, and so is every interval that
 * overlaps with it. */
RtStatus rt_paper_tables_write(const RtResults *results, const char *directory, RtError *error);

#endif
