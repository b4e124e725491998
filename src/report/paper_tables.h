/* SPDX-License-Identifier: Apache-2.0 */
/* The tables of a result directory for papers and web pages: tables.tex, tables.md. */
#ifndef RT_REPORT_PAPER_TABLES_H
#define RT_REPORT_PAPER_TABLES_H

#include "experiment/results.h"

/* Writes `directory`/tables.md and tables.tex (for the packages booktabs and graphicx): a table per scene and
 * ray kind, as wide as a column of a paper. The best is bold, and so is every interval that overlaps with it
 * (rt_standing). */
RtStatus rt_paper_tables_write(const RtResults *results, const char *directory, RtError *error);

#endif
