/* SPDX-License-Identifier: Apache-2.0 */
/* Comparisons of what was measured before and after a change: by two programs that run in turns on the same
 * rays, or as two result directories have it. Each cell (scene, accelerator, kind of rays) gets the ratio of
 * throughput after to that before, with an interval, and a verdict.
 *
 * Two programs. What a process is given by chance, where its code, stack and arrays lie, makes it faster or
 * slower by a percent or two for as long as it lives (Mytkowicz et al. 2009, "Producing Wrong Data Without
 * Doing Anything Obviously Wrong!", ASPLOS), so it is processes that are repeated: a round starts both
 * programs anew, in an order drawn by lot, and has them take turns RT_TURNS times in each cell, on the same
 * processor. Its ratio is the median of the turns, and rounds are what the order statistics of
 * measure/statistics.h are over. If both programs are the same, which of them is called `after` makes no
 * difference to a round, so each ratio is as likely above 1 as below, whatever the noise: the interval is
 * exact.
 *
 * Two directories are one process each, at two times. Nothing in them says what such runs differ by on their
 * own, so a difference is one from a margin on (Options.margin), and their rounds, which were not taken
 * together, are compared as unpaired ones.
 *
 * Many cells. All intervals of a comparison hold together in 95 % of all cases (rt_coverage_of_each): of
 * twenty comparisons of a program with itself, however many cells they have, about one says that something
 * differs. */
#ifndef RT_EXPERIMENT_COMPARE_H
#define RT_EXPERIMENT_COMPARE_H

#include "core/text/table.h"
#include "experiment/workload.h"

#define RT_TURNS 5 /* of each program in each cell, in a round */

/* X(CONSTANT, says) */
#define RT_CHANGES(X)                                                                                        \
    X(NONE, "no difference")                                                                                 \
    X(FASTER, "faster")                                                                                      \
    X(SLOWER, "slower")                                                                                      \
    X(OTHER_RAYS, "other rays")                                                                              \
    X(ONLY_BEFORE, "only before")                                                                            \
    X(ONLY_AFTER, "only after")                                                                              \
    X(NOT_TIMED, "not timed")

typedef enum RtChange {
#define RT_CHANGE_ENUM(CONSTANT, says) RT_CHANGE_##CONSTANT,
    RT_CHANGES(RT_CHANGE_ENUM)
#undef RT_CHANGE_ENUM
} RtChange;

typedef struct RtComparedCell {
    char scene[RT_MAX_LABEL], accel[RT_MAX_LABEL], kind[RT_MAX_NAME];
    uint64_t rays;
    RtChange change;
    bool timed;                    /* ratio is known */
    RtEstimate ratio;              /* of throughput after to that before */
    double before, after;          /* seconds a ray: median */
    bool counted;                  /* both of these are known, and the same wherever they are counted */
    RtTally counts_before, counts; /* of the cell */
    double *ratios;                /* [RT_MAX_ROUNDS] owned: of each round of two programs; or NULL */
    uint32_t rounds;               /* of them: where limits leave a cell out of one, fewer than of others */
} RtComparedCell;

typedef struct RtComparison {
    RtComparedCell *cells; /* [count] owned */
    uint32_t count, capacity;
    uint32_t timed;               /* cells with an interval */
    uint32_t rounds;              /* of two programs; 0: of two directories */
    double margin;                /* a difference is one beyond this part */
    double seconds;               /* that it took */
    char before[256], after[256]; /* who was compared */
    json_t
        *plugins; /* owned: of two directories, whose plugins are not the same (experiment/plugins_used.h) */
} RtComparison;

/* Zero it before. Clear also after a failure. */
void rt_comparison_clear(RtComparison *comparison);

/* ---- two directories ---- */

/* Compares all cells of results that were loaded from two directories; their null runs aside. */
RtStatus rt_compare_results(const RtResults *before, const RtResults *after, RtComparison *comparison,
                            RtError *error);

/* ---- two programs ---- */

typedef struct RtPrograms {
    const char *before, *after; /* paths of programs: another, and this one */
    char *const *arguments;     /* of either, NULL behind the last: which make it a worker (worker.c) */
    uint32_t rounds;            /* at least; more where so many cells ask for them */
    double until, patience;     /* as in RtWorkloadOptions; patience is of all */
    double least;               /* seconds that a turn takes at least */
    bool pinned;                /* each cell on one processor */
    uint64_t seed;              /* of all orders */
    void *context;              /* who is told; both members may be NULL */
    void (*progress)(void *context, uint32_t round, uint32_t rounds, const char *scene, const char *kind);
    void (*notice)(void *context, const char *message);
} RtPrograms;

RtStatus rt_compare_programs(const RtPrograms *programs, RtComparison *comparison, RtError *error);

/* The worker's side (worker.c): answers requests from `in` on `out` until everything is timed or the input
 * ends. */
RtStatus rt_worker_serve(const RtExperiment *experiment, const RtWorkloadOptions *options, FILE *in,
                         FILE *out, RtError *error);

/* ---- what came out ---- */

/* Decides on all cells, of which the ratios are there. */
void rt_comparison_judge(RtComparison *comparison);

/* The cell, appended where it is not there yet; NULL where memory is short. It stays where it is until the
 * next call. */
RtComparedCell *rt_comparison_cell(RtComparison *comparison, const char *scene, const char *accel,
                                   const char *kind);

/* Cells with that verdict; cells whose counts differ. */
uint32_t rt_comparison_count(const RtComparison *comparison, RtChange change);
uint32_t rt_comparison_changed(const RtComparison *comparison);

/* A row per cell, for the eye and for JSON; `row` is used by the table alone. */
typedef struct RtComparedRow {
    const RtComparison *comparison;
    const RtComparedCell *cell;
} RtComparedRow;
RtTable rt_comparison_table(RtComparedRow *row, bool all);

/* All of it: the table, counts that changed, and sentences that say what it is worth; or a new reference to a
 * document, NULL where memory is short. */
void rt_comparison_print(const RtComparison *comparison, FILE *out);
json_t *rt_comparison_json(const RtComparison *comparison);

#endif
