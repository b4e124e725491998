/* SPDX-License-Identifier: Apache-2.0 */
/* What the plots of a swept parameter show (sweep_plot.h): points of the cost of accelerators over its
 * values, in lines, and in a panel for each group of scenes that differ only in the parameter. */
#ifndef RT_REPORT_SWEEP_LINES_H
#define RT_REPORT_SWEEP_LINES_H

#include "results/results.h"

#define RT_MAX_SWEEP_NAME (RT_MAX_LABEL + RT_MAX_SWEPT * (RT_MAX_NAME + RT_MAX_SWEPT_CHARS + 2))

typedef enum RtSweepMeasure {
    RT_SWEEP_TIME,
    RT_SWEEP_OBJECT_TESTS,
    RT_SWEEP_STEPS,
    RT_SWEEP_MEASURES
} RtSweepMeasure;

typedef struct RtSweepLine {
    char name[RT_MAX_SWEEP_NAME];
    uint32_t candidate; /* the first, whose colour it has */
    bool flat;          /* without the parameter: the same at each value */
} RtSweepLine;

typedef struct RtSweepPoint {
    uint32_t group, line;
    double x;
    RtCost cost;
} RtSweepPoint;

/* Of one parameter; the caller allocates the points. */
typedef struct RtSweepLines {
    const RtResults *results;
    RtSweptKey key;
    bool column; /* for a column of a paper */
    bool timed;
    uint32_t group_count, line_count, point_count, value_count;
    uint32_t groups[RT_MAX_WORKLOADS]; /* the first scene of each */
    RtSweepLine lines[RT_MAX_CANDIDATES];
    RtSweepPoint *points;                                /* [2 * workload_count * candidate_count] */
    char words[RT_MAX_SWEEP_VALUES][RT_MAX_SWEPT_CHARS]; /* values that are no numbers */
    double values[RT_MAX_SWEEP_VALUES];                  /* increasing */
} RtSweepLines;

/* Fills in all after `key` except `column`, from the results. Groups in which the parameter does not vary are
 * left out; points are sorted by group, line and x. */
void rt_sweep_lines_gather(RtSweepLines *figure);

/* The common name of the scenes in the group of scene t: everything except the parameter. */
void rt_sweep_lines_group_name(const RtExperiment *experiment, const RtSweptKey *key, uint32_t t,
                               char name[RT_MAX_SWEEP_NAME]);

/* In seconds, or per ray; perhaps NAN. */
double rt_sweep_lines_cost(const RtCost *cost, RtSweepMeasure measure);

/* Whether the line has a cost in the group. */
bool rt_sweep_lines_has(const RtSweepLines *figure, uint32_t group, uint32_t line, RtSweepMeasure measure);

/* The cost at the right end of a line in the first group that has it, or NAN. */
double rt_sweep_lines_last(const RtSweepLines *figure, uint32_t line, RtSweepMeasure measure);

/* Fills order[line_count] with the lines that have a last cost, the largest first; returns their number. */
uint32_t rt_sweep_lines_order(const RtSweepLines *figure, RtSweepMeasure measure, uint32_t *order);

#endif
