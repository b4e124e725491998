/* SPDX-License-Identifier: Apache-2.0 */
/* What an experiment found, in memory: dense arrays over workload x candidate x ray kind, filled cell by
 * cell. Behind the candidates stands one more, the null run: the baseline (where it is the best of several,
 * the first of them) built and measured a second time, whose ratio to itself must straddle 1. */
#ifndef RT_EXPERIMENT_RESULTS_H
#define RT_EXPERIMENT_RESULTS_H

#include "experiment/experiment.h"
#include "measure/distribution.h"
#include "measure/hardware.h"
#include "measure/machine.h"
#include "measure/statistics.h"

#include <stdio.h>

#define RT_MAX_LIMIT 512

typedef struct RtWorkloadResult {
    bool known;   /* the scene was opened and its rays recorded */
    bool skipped; /* optional, and its file is missing */
    uint32_t objects;
    uint32_t width, height;                       /* of the frame */
    uint64_t scene;                               /* rt_scene_fingerprint */
    uint64_t rays[RT_RAY_KIND_COUNT];             /* in the set, after the limit */
    uint64_t ray_fingerprints[RT_RAY_KIND_COUNT]; /* of the set */
} RtWorkloadResult;

typedef struct RtBuildResult {
    bool known, exact, counts;    /* as in RtAccel */
    char spec[RT_MAX_SPEC_CHARS]; /* every effective parameter */
    double seconds;               /* median of up to three builds */
    /* Which limit it went beyond, so that no cell of it is measured, or if it is `broken` how; else "". */
    char limit[RT_MAX_LIMIT];
    bool broken; /* of a plugin, and at fault */
    RtDescription shape;
    RtDistribution
        *leaves; /* [RT_LEAF_QUANTITY_COUNT] owned, of the base; NULL: not asked for, or it has none */
} RtBuildResult;

/* Times of each round, seconds a ray: by the clock of the comparison, on the wall clock, and the baseline's
 * on the same rays, by the clock of the comparison. */
typedef enum RtEach { RT_EACH_SECONDS, RT_EACH_WALL, RT_EACH_BASELINE, RT_EACH_COUNT } RtEach;

/* What the machine did for a ray of a cell. */
#define RT_MAX_WHY 192
typedef struct RtCellHardware {
    bool known; /* counted, or known why not */
    int threads;
    uint32_t machine;        /* one of RtResults.machines */
    RtHardwareCounts counts; /* a ray */
    char why[RT_MAX_WHY];    /* nothing could be counted; else "" */
} RtCellHardware;

typedef struct RtCell {
    bool counted, timed;
    /* Which limit it would go beyond, so that it is not measured, or if it is `broken` how; else "". */
    char limit[RT_MAX_LIMIT];
    bool broken;                   /* the accelerator, of a plugin, is at fault */
    RtTally tally;                 /* tally.rays: of the thinned set */
    uint64_t differ;               /* answers unlike the baseline's; of an exact accelerator always 0 */
    RtDistribution *distributions; /* [RT_RAY_QUANTITY_COUNT] owned; NULL: not asked for */
    uint32_t rounds;
    int threads;        /* of the timing */
    uint32_t machine;   /* that timed it: one of RtResults.machines */
    RtEstimate seconds; /* a ray: processor time on one thread, wall time on several */
    RtEstimate wall;    /* a ray, on the wall clock */
    RtEstimate ratio;   /* of throughput to the baseline's on the same rays, paired by round */
    double *each;       /* [RT_EACH_COUNT][rounds] owned: every round's time; NULL: not kept */
    uint32_t baseline; /* the candidate that is: where there are several, the fastest of them on these rays */
    RtCellHardware hardware;
} RtCell;

typedef struct RtResults {
    const RtExperiment *experiment; /* borrowed */
    RtWorkloadResult *workloads;    /* [workload_count] */
    RtBuildResult *builds;          /* see rt_build_at */
    RtCell *cells;                  /* see rt_cell_at */
    RtMachine *machines;            /* [RT_MAX_MACHINES]; the first is not known */
    uint32_t machine_count;
} RtResults;

/* All unknown. Clear with rt_results_clear, also after a failure. */
RtStatus rt_results_init(RtResults *results, const RtExperiment *experiment, RtError *error);
void rt_results_clear(RtResults *results);

/* The place of a machine among those of the results, which it joins; 0 where they are too many. */
uint32_t rt_results_machine(RtResults *results, const RtMachine *machine);

/* Places in the arrays; candidate = candidate_count is the null run. */
RtBuildResult *rt_build_at(const RtResults *results, uint32_t workload, uint32_t candidate);
RtCell *rt_cell_at(const RtResults *results, uint32_t workload, uint32_t candidate, RtRayKind kind);

/* Room for the times of the cell's `rounds` rounds; and those of one sort, [rounds]. */
RtStatus rt_cell_make_rounds(RtCell *cell, RtError *error);
double *rt_cell_rounds(const RtCell *cell, RtEach each);

/* The candidate's label, that of the baseline and " (again)" for the null run. */
const char *rt_candidate_label(const RtExperiment *experiment, uint32_t candidate);

/* Every cell of the experiment but those of the null run, scene by scene, accelerator by accelerator:
 *     for (RtCellCursor at = {0}; rt_results_next(results, &at);) use(at.cell); */
typedef struct RtCellCursor {
    uint32_t next, workload, candidate;
    RtRayKind kind;
    RtCell *cell;
} RtCellCursor;
bool rt_results_next(const RtResults *results, RtCellCursor *at);

/* How many cells were measured, and on how many scenes. */
uint64_t rt_results_size(const RtResults *results, uint32_t *scenes);

/* How many of the null runs there are, and how many of them have an interval with 1 inside. */
void rt_null_verdict(const RtResults *results, uint32_t *runs, uint32_t *straddling);

/* RT_BROKEN, and which was the first, where an accelerator of a plugin broke. */
RtStatus rt_results_check_broken(const RtResults *results, RtError *error);

/* A line for each limit that was hit, and what was left out; nothing where there is none. */
void rt_print_limits(const RtResults *results, FILE *out);

/* Whether any candidate was measured on the workload's rays of that kind. */
bool rt_results_has_kind(const RtResults *results, uint32_t workload, RtRayKind kind);

/* What a ray costs: of one kind, or of all kinds together (RT_ALL_RAYS). Then each kind has the weight of its
 * unthinned set, so that thinned and full measurements compare, and all candidates of a workload are over the
 * same kinds, those that any of them was measured on. What is unknown is NAN. */
#define RT_ALL_RAYS RT_RAY_KIND_COUNT
typedef struct RtCost {
    bool whole;                               /* all kinds of rays that the experiment asks for are in it */
    uint64_t rays;                            /* measured */
    double object_tests, extent_tests, steps; /* per ray */
    RtEstimate
        seconds;      /* per ray; of all kinds the weighted ends of their intervals, which is conservative */
    RtEstimate ratio; /* of throughput to the baseline's on the same rays; of all kinds the median alone */
} RtCost;

RtCost rt_results_cost(const RtResults *results, uint32_t workload, uint32_t candidate, RtRayKind kind);

/* The break-even with the baseline: for how many rays, of all kinds in the shares that their sets have, a
 * candidate with its build takes less time than the baseline with its own (the shortest build where ratios
 * refer to the fastest of several). 0: for any number; n: from n rays on; -n: up to n rays; INFINITY: for
 * none; NAN: unknown, or the baseline itself. Builds are to run on as many threads as the timing. */
double rt_results_break_even(const RtResults *results, uint32_t workload, uint32_t candidate);

#endif
