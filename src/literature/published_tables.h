/* SPDX-License-Identifier: Apache-2.0 */
/* The comparison with published figures as tables (core/text/table.h): CSV files of a result directory,
 * byte-identical on every machine, and tables to read. */
#ifndef RT_LITERATURE_PUBLISHED_TABLES_H
#define RT_LITERATURE_PUBLISHED_TABLES_H

#include "core/text/table.h"
#include "literature/published.h"
#include "measure/result_files.h"

typedef enum RtPublishedTable {
    RT_FIGURES,          /* published.csv: a row per figure */
    RT_BEST,             /* best.csv: a row per scene and measure */
    RT_BEST_FOR_THE_EYE, /* to read: the rows that both sides have */
    RT_SUMMARY,          /* a row per column with figures: the judgements */
    RT_ROWS_OF_RAYS,     /* of one workload: its published rows, with the measured figures */
    RT_ROWS_OF_STRUCTURES,
    RT_PUBLISHED_TABLE_COUNT
} RtPublishedTable;

/* The row at hand. */
typedef struct RtPublishedCursor {
    const RtPublished *published;
    uint32_t workload; /* of RT_ROWS... */
    bool of_rays;
    const RtPublishedRow *row;
    const RtFigure *figure;
    RtMeasure measure;
    const RtBest *best;
    RtColumn column;
    uint32_t figures, judged[3];              /* of the column; those of each RtJudgement */
    const char *accel;                        /* label of the measured accelerator, or NULL */
    RtField said;                             /* the published figure */
    RtTableColumn shown[1 + RT_COLUMN_COUNT]; /* the columns of RT_ROWS... */
    RtColumnGroup shown_group;
} RtPublishedCursor;

/* `cursor` belongs to the table and must outlive it. The caller fills in `published` and the workload. A
 * table without groups is empty. */
RtTable rt_published_table(RtPublishedTable which, RtPublishedCursor *cursor);

/* All tables to read, with all reasons: published.md, or a part of report.html, empty if nothing was
 * compared. In HTML a figure outside its tolerance shows its reason as a tooltip. */
void rt_published_page(const RtPublished *published, bool html, FILE *out);

/* A file of RT_FILE_COMPARED (results/result_directory.h); and all of them, if anything was compared. */
void rt_published_file_write(RtResultFile file, const RtPublished *published, FILE *out);
RtStatus rt_published_files_write(const RtPublished *published, const char *directory, RtError *error);

#endif
