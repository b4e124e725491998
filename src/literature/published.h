/* SPDX-License-Identifier: Apache-2.0 */
/* Published figures compared with measured ones.
 *
 * A table is a CSV file with a row per published row. Columns: scene and source; then accel, the label of the
 * corresponding candidate (empty: none), structure and parameters, the name of the row, and tests_per, the
 * divisor of its object tests: ray or hit (a ray that hits); then any of RtColumn. Figures are written as
 * printed. They agree if they differ by at most the tolerance, plus half a unit of the last digit for figures
 * that are not whole numbers. build_seconds and trace_seconds are allowed but not compared, since they are
 * other machines' times.
 *
 * Figures of structures and per-ray figures are compared with the row's candidate, over all ray kinds of the
 * experiment; figures of rays with the ray sets.
 *
 * A figure outside its tolerance needs a reason: a row of a CSV file with the columns scene, source, accel,
 * column and reason, the first four being patterns as in file names (* is anything). The first matching
 * reason counts. The check fails for a figure without a reason, for a reason that no figure needs, and for a
 * scene on which no candidate that the experiment calls `ours` needs fewer object tests per ray, and fewer
 * tests and steps, than every published row. */
#ifndef RT_LITERATURE_PUBLISHED_H
#define RT_LITERATURE_PUBLISHED_H

#include "results/results.h"

#define RT_MAX_FIGURE   16 /* characters */
#define RT_MAX_REASON   512
#define RT_NOT_MEASURED UINT32_MAX
#define RT_NO_REASON    UINT32_MAX

typedef struct RtPublishedRow {
    char source[RT_MAX_WORD], structure[RT_MAX_WORD], parameters[RT_MAX_WORD], accel[RT_MAX_LABEL];
    uint32_t workload;
    uint32_t candidate;    /* or RT_NOT_MEASURED */
    bool of_rays;          /* from a table without structures */
    bool per_hit;          /* object tests are divided by rays that hit */
    uint32_t first, count; /* its figures */
} RtPublishedRow;

typedef enum RtJudgement { RT_UNJUDGED, RT_WITHIN, RT_OUTSIDE } RtJudgement;

typedef struct RtFigure {
    uint32_t row;
    RtColumn column;
    char text[RT_MAX_FIGURE]; /* as published */
    double published, half_unit;
    double measured;  /* or NAN */
    double deviation; /* of the measured figure, in percent */
    RtJudgement judgement;
    uint32_t reason; /* of a figure outside its tolerance: its number, or RT_NO_REASON */
} RtFigure;

typedef struct RtReason {
    char scene[RT_MAX_LABEL], source[RT_MAX_WORD], accel[RT_MAX_LABEL], column[RT_MAX_WORD];
    char text[RT_MAX_REASON];
    uint32_t line, used; /* in its file; number of figures that need it */
} RtReason;

/* The compared cost: object tests per ray, or object tests and steps per ray. Rows per hit are converted to
 * our rays. */
typedef enum RtMeasure { RT_BEST_TESTS, RT_BEST_TESTS_AND_STEPS, RT_MEASURE_COUNT } RtMeasure;

typedef struct RtBest {
    uint32_t row, candidate; /* or RT_NOT_MEASURED */
    double published, ours;  /* or NAN */
    double extent_tests;     /* per ray, of that candidate */
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

/* Loads the tables that the experiment names, if any. Reports unknown scenes, accelerators and columns with
 * their line. Clear with rt_published_clear, also after a failure. */
RtStatus rt_published_load(RtPublished *published, const RtExperiment *experiment, RtError *error);
void rt_published_clear(RtPublished *published);

/* Fills in the measured figures, judges them, and finds the best rows. The quick variant has other rays: only
 * structures are judged. */
void rt_published_compare(RtPublished *published, const RtResults *results);

/* RT_MISMATCH with the first figure outside its tolerance without a reason and the number of them, the first
 * reason that no figure needs, or the first scene on which ours are not better. */
RtStatus rt_published_check(const RtPublished *published, RtError *error);

/* The row's figure in that column, or NULL. */
const RtFigure *rt_published_figure(const RtPublished *published, const RtPublishedRow *row, RtColumn column);

const char *rt_column_name(RtColumn column);
const char *rt_measure_name(RtMeasure measure);

/* Whether ours is less than the published figure; false if either is unknown. */
bool rt_best_is_ahead(const RtBest *best);

/* "Octree84-C depth=4", or the source of a row of rays; room for RT_MAX_ROW_NAME. */
#define RT_MAX_ROW_NAME 96
_Static_assert(RT_MAX_ROW_NAME >= 2 * RT_MAX_WORD, "structure and parameters");
void rt_published_row_name(const RtPublishedRow *row, char *out);

/* The measured figure: whole numbers exactly, others in six digits; "" if there is none. */
void rt_figure_measured(const RtFigure *figure, char out[RT_MAX_FIGURE]);

#endif
