/* SPDX-License-Identifier: Apache-2.0 */
/* Published figures beside measured ones.
 *
 * A table is a CSV file with a row per published row. Columns: scene and source; then accel, the label of the
 * candidate that measures the same (empty: nothing does), structure and parameters, how the row is called,
 * and tests_per, what its object tests are divided by: ray or hit (a ray that hits); then any of RtColumn.
 * Figures stand as they were printed, and agree where they differ by no more than the tolerance and, of those
 * that are not whole numbers, half a unit of the last digit. build_seconds and trace_seconds may be there,
 * too; other machines' times are not compared.
 *
 * Figures of structures and per-ray figures are those of the row's candidate, over all ray kinds of the
 * experiment together; those of rays are of the ray sets.
 *
 * A figure outside its tolerance must have a reason: a row of a CSV file with the columns scene, source,
 * accel, column and reason, the first four being patterns as in file names (* is anything). The first reason
 * that fits counts. A reason that no figure needs is stale; both fail the check. So does a scene on which
 * none of the candidates that the experiment calls `ours` needs fewer object tests per ray than every
 * published row, and fewer tests and steps. */
#ifndef RT_LITERATURE_PUBLISHED_H
#define RT_LITERATURE_PUBLISHED_H

#include "experiment/results.h"

#include <stdio.h>

#define RT_MAX_FIGURE   16 /* characters */
#define RT_MAX_REASON   512
#define RT_NOT_MEASURED UINT32_MAX
#define RT_NO_REASON    UINT32_MAX

typedef struct RtPublishedRow {
    char source[RT_MAX_LABEL], structure[RT_MAX_LABEL], parameters[RT_MAX_LABEL], accel[RT_MAX_LABEL];
    uint32_t workload;
    uint32_t candidate;    /* or RT_NOT_MEASURED */
    bool of_rays;          /* of a table without structures */
    bool per_hit;          /* object tests are divided by rays that hit */
    uint32_t first, count; /* its figures */
} RtPublishedRow;

typedef enum RtJudgement { RT_UNJUDGED, RT_WITHIN, RT_OUTSIDE } RtJudgement;

typedef struct RtFigure {
    uint32_t row;
    RtColumn column;
    char text[RT_MAX_FIGURE]; /* as published */
    double published, half_unit;
    double measured;  /* NAN where it is not */
    double deviation; /* of what was measured, in percent */
    RtJudgement judgement;
    uint32_t reason; /* of one that is outside: its number, or RT_NO_REASON */
} RtFigure;

typedef struct RtReason {
    char scene[RT_MAX_LABEL], source[RT_MAX_LABEL], accel[RT_MAX_LABEL], column[RT_MAX_LABEL];
    char text[RT_MAX_REASON];
    uint32_t line, used; /* of its file; figures that need it */
} RtReason;

/* What is least: object tests a ray, or object tests and steps a ray. Rows per hit are taken per ray of
 * ours. */
typedef enum RtMeasure { RT_BEST_TESTS, RT_BEST_TESTS_AND_STEPS, RT_MEASURE_COUNT } RtMeasure;

typedef struct RtBest {
    uint32_t row, candidate; /* RT_NOT_MEASURED where there is none */
    double published, ours;  /* NAN where there is none */
    double extent_tests;     /* a ray, which that candidate makes besides */
} RtBest;

typedef struct RtPublished {
    const RtExperiment *experiment; /* borrowed */
    RtPublishedRow *rows;
    RtFigure *figures; /* in the order of rows */
    RtReason *reasons;
    uint32_t row_count, figure_count, reason_count;
    char reasons_path[RT_MAX_PATH];
    RtBest best[RT_MAX_WORKLOADS][RT_MEASURE_COUNT];
} RtPublished;

/* Loads what the experiment names; nothing where it names nothing. Unknown scenes, accelerators and columns
 * are told with their line. Clear with rt_published_clear, also after a failure. */
RtStatus rt_published_load(RtPublished *published, const RtExperiment *experiment, RtError *error);
void rt_published_clear(RtPublished *published);

/* Fills what is measured of the figures, judges them, and finds what is least. In the quick variant only
 * structures are judged, since its rays are others. */
void rt_published_compare(RtPublished *published, const RtResults *results);

/* RT_MISMATCH with the first figure that is outside without a reason, stale reason, or scene on which ours
 * are not ahead, and how many there are of each. */
RtStatus rt_published_check(const RtPublished *published, RtError *error);

/* Figures of a column, and how they were judged. */
typedef struct RtColumnSummary {
    uint32_t figures;
    uint32_t judged[3]; /* by RtJudgement */
} RtColumnSummary;

RtColumnSummary rt_column_summary(const RtPublished *published, RtColumn column);

/* The row's figure in that column, NULL where it has none. */
const RtFigure *rt_published_figure(const RtPublished *published, const RtPublishedRow *row, RtColumn column);

/* Which columns the rows of a workload have that are, or are not, of rays; false: none. */
bool rt_published_columns(const RtPublished *published, uint32_t workload, bool of_rays,
                          bool shown[RT_COLUMN_COUNT]);

const char *rt_column_name(RtColumn column);
const char *rt_measure_name(RtMeasure measure);

/* Whether ours is less than what is published; false where either is not known. */
bool rt_best_is_ahead(const RtBest *best);

/* "Octree84-C depth=4", or the source of a row of rays; room for RT_MAX_ROW_NAME. */
#define RT_MAX_ROW_NAME 96
_Static_assert(RT_MAX_ROW_NAME >= 2 * RT_MAX_LABEL, "structure and parameters");
void rt_published_row_name(const RtPublishedRow *row, char *out);

/* The figure as measured: whole numbers as they are, others in six digits; "" where it is not. */
void rt_figure_measured(const RtFigure *figure, char out[RT_MAX_FIGURE]);

#endif
