/* SPDX-License-Identifier: Apache-2.0 */
/* Results as tables (core/text/table.h): those of a result directory, of bench --json, and for the eye. */
#ifndef RT_EXPERIMENT_RESULT_TABLES_H
#define RT_EXPERIMENT_RESULT_TABLES_H

#include "core/text/table.h"
#include "experiment/results.h"

typedef enum RtResultTable {
    /* counts.csv: a row per cell of an accelerator whose counts are the same on every machine, with every
     * effective parameter, all counters, and the figures of the structure. Byte-identical wherever it is
     * made. */
    RT_COUNTS,
    /* times.csv: a row per timed cell, null runs included: times a ray with their intervals, ratios, build
     * seconds, bytes; and tests and steps as counted here, which for an accelerator that is not in counts.csv
     * may be others elsewhere. */
    RT_TIMES,
    /* rounds.csv: a row per round of a timed cell, null runs included. */
    RT_ROUNDS,
    /* hardware.csv: a row per cell for which counters were asked for. Where there are none it says why. */
    RT_HARDWARE,
    RT_BENCH,         /* "rows" of bench --json: of each cell that was counted */
    RT_NULL_RUNS,     /* "null_runs" there */
    RT_CELLS,         /* for the eye: one workload by accelerator and ray kind; of a best of only the best */
    RT_STRUCTURES,    /* for the eye: of each accelerator in it, what its structure takes */
    RT_COUNTED_CELLS, /* both where nothing was timed, with the sizes of structures in place of times */
    RT_COUNTED_STRUCTURES,
    RT_SPREADS, /* for the eye: one workload by accelerator and ray kind: medians, 99th percentiles and maxima
                   of object tests and steps */
    RT_LEAF_SPREADS,   /* for the eye: by accelerator: those of sizes and depths of leaves */
    RT_HARDWARE_CELLS, /* for the eye: one workload by accelerator and ray kind: hardware counters */
    /* Those from here on mark the best. */
    RT_CELLS_PAPER,   /* as RT_CELLS, with whole labels and without null runs */
    RT_COUNTED_PAPER, /* the same where nothing was timed */
    RT_CELLS_MORE,    /* cells with more columns, and all rows */
    RT_TOTALS,        /* one workload by accelerator, all kinds together */
    RT_TOTALS_MORE,   /* these with the intervals of their times */
    RT_RESULT_TABLE_COUNT
} RtResultTable;

#define RT_MAX_RESULT_GROUPS 16

/* The row at hand. */
typedef struct RtResultRow {
    const RtResults *results;
    RtResultTable which;
    uint32_t workload; /* of tables for the eye, and of bench: the one that they show */
    uint32_t candidate;
    RtRayKind kind;
    uint32_t round; /* of RT_ROUNDS */
    const RtWorkload *setup;
    const RtWorkloadResult *scene;
    const RtBuildResult *build;
    const RtCell *cell;
    RtCost all; /* of the cell, or of RT_TOTALS... of all kinds of rays */
    uint32_t swept_count;
    RtSweptKey swept[RT_MAX_SWEPT_KEYS]; /* what the experiment sweeps */
    char swept_names[RT_MAX_SWEPT_KEYS]
                    [RT_MAX_NAME + 8]; /* and its columns, at the end of CSV and of bench */
    RtTableColumn swept_columns[RT_MAX_SWEPT_KEYS];
    RtColumnGroup groups[RT_MAX_RESULT_GROUPS];
} RtResultRow;

/* `row` stays where it is as long as the table, which alone uses it, with its results, and for the eye its
 * workload, filled in. */
RtTable rt_result_table(RtResultTable which, RtResultRow *row);

/* How a candidate compares with all others that were measured on the workload, for one kind of rays or
 * RT_ALL_RAYS: by time where any was timed, else by object tests per ray. The best has the smallest median;
 * one whose interval overlaps with that of the best is level with it. Null runs and the yardstick
 * (rt_accel_yardstick) are not compared. */
RtStanding rt_standing(const RtResults *results, uint32_t workload, uint32_t candidate, RtRayKind kind);

/* How a row is called for the eye: its label, and a star if it is measured on a part of the rays. One of more
 * than RT_EYE_WIDTH characters stands on a line of its own. */
#define RT_EYE_WIDTH     24
#define RT_MAX_EYE_LABEL (RT_MAX_LABEL + 16)
void rt_result_eye_label(const RtResultRow *row, char out[RT_MAX_EYE_LABEL]);

/* RT_CELLS, in 80 columns, with RT_STRUCTURES and what the figures refer to, or where nothing was timed what
 * there is then; or RT_TOTALS; of each workload that is known. */
void rt_print_results(const RtResults *results, RtResultTable which, FILE *out);

/* Hardware counters of each workload that is known; or why there are none. */
void rt_print_hardware(const RtResults *results, FILE *out);

/* The rows of a table for the eye, behind a blank line and the names of its columns. */
void rt_print_rows(const RtResults *results, RtResultTable which, uint32_t workload, FILE *out);

/* What a run ends with: the frames' costs, or the totals if the experiment has no frames; hardware counters;
 * limits; claims; null runs; and for frames the accelerator that helped most. */
void rt_print_summary(const RtResults *results, FILE *out);

/* "12 of 12 null runs straddle 1.", and what to think of it otherwise; and where rounds are too few, what
 * their intervals are worth. "" where none was timed. */
#define RT_MAX_SENTENCE 384
void rt_null_sentence(const RtResults *results, char out[RT_MAX_SENTENCE]);

/* What the intervals cover at least: "95 %", or less where rounds are too few. */
#define RT_MAX_INTERVAL_TITLE 16
void rt_interval_title(const RtExperiment *experiment, char out[RT_MAX_INTERVAL_TITLE]);

#endif
