/* SPDX-License-Identifier: Apache-2.0 */
/* Results as tables (core/text/table.h): CSV files of a result directory, bench --json, and tables to read.
 */
#ifndef RT_RESULTS_RESULT_TABLES_H
#define RT_RESULTS_RESULT_TABLES_H

#include "core/text/table.h"
#include "results/results.h"

typedef enum RtResultTable {
    /* counts.csv: a row per cell of each accelerator whose counts are the same on every machine: every
       effective parameter, all counters, and the figures of the structure. Byte-identical on every machine.
     */
    RT_COUNTS,
    /* times.csv: a row per timed cell, null runs included: times per ray with intervals, ratios, build
       seconds, bytes, and the tests and steps counted here. Accelerators that are not in counts.csv may count
       differently elsewhere. */
    RT_TIMES,
    /* rounds.csv: a row per round of a timed cell, null runs included. */
    RT_ROUNDS,
    RT_RENDERED, /* render.csv: a row per scene and accelerator: time to render the frame, and the part of
                    it spent in queries */
    /* distributions.csv: a row per cell and quantity over rays, and per structure and quantity over leaves:
       percentiles; histograms.csv: a row for each bin that is not empty. As exact as counts.csv, for the same
       accelerators. */
    RT_DISTRIBUTIONS,
    RT_HISTOGRAMS,
    RT_BENCH,     /* "rows" of bench --json: a row per counted cell */
    RT_NULL_RUNS, /* "null_runs" there */
    RT_CELLS, /* to read: one workload by accelerator and ray kind; of several baselines only the fastest */
    RT_STRUCTURES,    /* to read: build time, memory and break-even of each accelerator */
    RT_COUNTED_CELLS, /* both without times: sizes of structures instead */
    RT_COUNTED_STRUCTURES,
    RT_PERCENTILES, /* to read: one workload by accelerator and ray kind: medians, 99th percentiles and maxima
                   of object tests and steps */
    RT_LEAF_PERCENTILES, /* to read: the same of sizes and depths of leaves, by accelerator */
    RT_RENDER_ROWS,      /* to read: one workload by accelerator: time of a frame and the part of queries */
    RT_CELLS_MORE,       /* cells with more columns, and all rows */
    RT_TOTALS,           /* one workload by accelerator, all kinds together */
    RT_TOTALS_MORE,      /* these with the intervals of their times */
} RtResultTable;

#define RT_MAX_RESULT_GROUPS 16

/* The row at hand. */
typedef struct RtResultRow {
    const RtResults *results;
    RtResultTable which;
    uint32_t workload; /* of tables of one workload */
    uint32_t candidate;
    char shown[RT_MAX_SHOWN]; /* its label on a screen */
    RtRayKind kind;
    uint32_t round, most_rounds; /* of RT_ROUNDS; most_rounds: of any cell */
    size_t quantity;             /* rt_quantity_name, of RT_DISTRIBUTIONS and RT_HISTOGRAMS */
    uint32_t bin;                /* of RT_HISTOGRAMS */
    const RtDistribution *distribution;
    uint32_t headed; /* printed rows: 1 + the kind of rays of the last heading */
    const RtWorkload *setup;
    const RtWorkloadResult *scene;
    const RtBuildResult *build;
    const RtCell *cell;
    RtCost cost; /* of the cell; of all kinds of rays for RT_TOTALS... */
    uint32_t swept_count;
    RtSweptKey swept[RT_MAX_SWEPT_KEYS];                  /* the swept parameters */
    char swept_names[RT_MAX_SWEPT_KEYS][RT_MAX_NAME + 8]; /* and their columns */
    RtTableColumn swept_columns[RT_MAX_SWEPT_KEYS];
    RtColumnGroup groups[RT_MAX_RESULT_GROUPS];
} RtResultRow;

/* `row` belongs to the table and must outlive it. The caller fills in its results, and its workload for a
 * table of one workload. */
RtTable rt_result_table(RtResultTable which, RtResultRow *row);

/* Whether it has a column for each parameter that the experiment sweeps. */
bool rt_result_table_sweeps(RtResultTable which);

/* The time to build in ms, with its interval: without one if it was built once. */
RtField rt_build_ms(const RtBuildResult *build);

/* Prints RT_CELLS, with RT_STRUCTURES and an explanation of the figures (or the counted tables
 * if nothing was timed), or RT_TOTALS; for each known workload. */
void rt_print_results(const RtResults *results, RtResultTable which, FILE *out);

/* Prints the percentiles of each known workload: a row per cell, and then a row per structure. */
void rt_print_distributions(const RtResults *results, FILE *out);

/* Prints the frames' costs and what follows from them, or the totals if the experiment has no frames;
 * what was left out. */
void rt_print_outcome(const RtResults *results, FILE *out);

/* Prints a blank line and rt_null_sentence. */
void rt_print_null_runs(const RtResults *results, FILE *out);

/* "... 12 of 12 intervals include 1, ...", or a warning if fewer do; and the coverage of the intervals if
 * rounds are too few. "" if nothing was timed. */
#define RT_MAX_SENTENCE 640
void rt_null_sentence(const RtResults *results, char out[RT_MAX_SENTENCE]);

/* What each best-of chose on the workload, by kinds of rays: for rt_free(). "" without any, NULL if memory is
 * short. */
char *rt_choices_sentences(const RtResults *results, uint32_t workload);

/* A warning that names the workloads and kinds of rays that caches have learnt (rt_cell_is_learnt), and a
 * remedy; likewise. */
char *rt_learnt_sentence(const RtResults *results);

/* The least coverage of the intervals: "95 %", or less if rounds are too few. */
#define RT_MAX_INTERVAL_TITLE 16
void rt_interval_title(const RtExperiment *experiment, char out[RT_MAX_INTERVAL_TITLE]);

/* ---- frames ---- */

/* The cost of a whole frame by accelerator, compared with the frame without a structure: the answer of an
 * experiment that has `frame` (RtFrameSetup).
 *
 * A frame's rays are its primary, shadow, reflection and transmission rays: measurements on a part of them
 * are scaled up (rt_results_total). If one kind was not measured, the frame's cost is unknown. The gain of an
 * overlay is relative to the accelerator below it, if that is measured too; the gain of any other accelerator
 * is relative to no structure. */

#define RT_FRAME_PLOT "plots/frame.svg" /* drawn by a script of the experiment */

typedef enum RtFramePart {
    RT_FRAME_ALL,
    RT_FRAME_PRIMARY,
    RT_FRAME_SHADOW,
    RT_FRAME_SECONDARY, /* reflection and transmission */
    RT_FRAME_PARTS
} RtFramePart;

/* The row at hand. */
typedef struct RtFrameRow {
    const RtResults *results;
    bool one;          /* a table to read, of one workload; else frame.csv, of all */
    uint32_t workload; /* of the row; given if `one` */
    uint32_t candidate;
    char shown[2 + RT_MAX_SHOWN]; /* its mark and its label, for a screen */
    const char *group;            /* printed rows: that of the last heading */
    const RtBuildResult *build;
    /* Totals over a part of the frame; its tests and times are NAN if a kind was not measured, or if the part
       has no rays. */
    RtCost cost[RT_FRAME_PARTS], without[RT_FRAME_PARTS];
    uint32_t winner; /* the fastest of the group, without overlays; of the fewest object tests if nothing was
                        timed; candidate_count: none */
} RtFrameRow;

/* `row` belongs to the table and must outlive it. The caller fills in its results, `one`, and then its
 * workload. The winner is marked as the best. */
RtTable rt_frame_table(RtFrameRow *row);

/* The size of a workload's frame, its rays by kind, and how many were measured: "a frame of 256x256: 65536
 * primary, ... rays; of 326921 rays, 152585 measured". */
#define RT_MAX_FRAME_TEXT 1024
void rt_frame_title(const RtResults *results, uint32_t workload, char out[RT_MAX_FRAME_TEXT]);

/* Explains the columns of the tables to read, and `mark` beside the fastest. */
void rt_frame_legend(const RtExperiment *experiment, const char *mark, char out[RT_MAX_FRAME_TEXT]);

/* Prints the tables of all known workloads. */
void rt_print_frames(const RtResults *results, FILE *out);

#endif
