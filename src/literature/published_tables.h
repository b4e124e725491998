/* SPDX-License-Identifier: Apache-2.0 */
/* What was compared with published figures, as tables (core/text/table.h): those of a result directory,
 * byte-identical wherever they are made, and for the eye. */
#ifndef RT_LITERATURE_PUBLISHED_TABLES_H
#define RT_LITERATURE_PUBLISHED_TABLES_H

#include "core/text/table.h"
#include "literature/published.h"

typedef enum RtPublishedTable {
    RT_FIGURES,          /* published.csv: a row per figure */
    RT_BEST,             /* best.csv: a row per scene and measure */
    RT_BEST_FOR_THE_EYE, /* of it, what both sides have */
    RT_SUMMARY,          /* a row per column that has figures: how they were judged */
    RT_ROWS_OF_RAYS,     /* of one workload: its rows as they were published, with what was measured */
    RT_ROWS_OF_STRUCTURES,
    RT_PUBLISHED_TABLE_COUNT
} RtPublishedTable;

/* The row at hand. */
typedef struct RtPublishedCursor {
    const RtPublished *published;
    uint32_t workload; /* of RT_ROWS...: which one they are of */
    bool of_rays;
    const RtPublishedRow *row;
    const RtFigure *figure;
    RtMeasure measure;
    const RtBest *best;
    RtColumn column;
    RtColumnSummary summary;
    const char *accel;                        /* label of who measures, NULL where nobody does */
    RtField said;                             /* the published figure */
    RtTableColumn shown[1 + RT_COLUMN_COUNT]; /* the columns of RT_ROWS... */
    RtColumnGroup shown_group;
} RtPublishedCursor;

/* `cursor` stays where it is as long as the table, which alone uses it, with `published`, and its workload,
 * filled in. No group: there is nothing to show. */
RtTable rt_published_table(RtPublishedTable which, RtPublishedCursor *cursor);

/* All for the eye, with all reasons: published.md, or a part of report.html, which is empty where nothing was
 * compared. There figures that are missed show their reasons when pointed at. */
void rt_published_page(const RtPublished *published, bool html, FILE *out);

#endif
