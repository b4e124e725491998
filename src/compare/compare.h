/* SPDX-License-Identifier: Apache-2.0 */
/* Comparisons before and after a change: of two programs that run in turns on the same rays, or of two result
 * directories. Each cell (scene, accelerator, kind of rays) gets the ratio of throughput after to that
 * before, an interval, and a verdict.
 *
 * Two programs. A process is faster or slower by a percent or two for as long as it lives, because of where
 * its code, stack and arrays happen to lie (Mytkowicz et al. 2009, "Producing Wrong Data Without Doing
 * Anything Obviously Wrong!", ASPLOS). So processes are repeated: each round starts both programs again, in
 * random order, and runs them in turns, RT_TURNS times in each cell, on the same processor. The ratio of a
 * round is the median of its turns; the order statistics of measure/statistics.h are over rounds. If both
 * programs are the same, which one is called `after` does not matter, so each ratio is as likely above 1 as
 * below, whatever the noise: the interval is exact.
 *
 * Two directories are one process each, at two times. Their rounds show how the times of these processes
 * spread, not how processes differ: single cells of two runs of one build may differ by tens of per cent.
 * So cells have intervals, over rounds (rt_estimate_unpaired), but no verdicts. Verdicts are of accelerators:
 *
 *     log(before / after) of an accelerator on a scene = its change + that of the machine + of the process
 *
 * Every scene has its own structures, in its own memory, so the third terms of scenes, and of pairs of runs,
 * are independent; they are symmetric about 0 if nothing changed, as either run may be the first. Those of
 * the kinds of rays on one scene are not independent, so the median over kinds is taken. The second term is
 * estimated by the median over accelerators on the same scene in the same pair of runs, which takes three
 * accelerators; a change of most accelerators looks like one of the machine, and is only printed. What is
 * left has Student's interval over scenes and pairs (rt_estimate_student), which long tails make no less
 * safe.
 *
 * Instructions per ray (callgrind.h) of two programs tell a change from code that merely moved.
 *
 * Many cells. All intervals of a comparison hold together in 95 % of all cases (rt_coverage_of_each): of
 * twenty comparisons of a program with itself, about one reports a difference, however many cells they have.
 * The cells of directories may have too few rounds for that: RtComparison.together is what they reach.
 */
#ifndef RT_COMPARE_COMPARE_H
#define RT_COMPARE_COMPARE_H

#include "core/base/memory.h"
#include "core/text/table.h"
#include "run/workload.h"

#define RT_TURNS        5 /* of each program in each cell, in a round */
#define RT_LEAST_ACCELS 3 /* for verdicts from directories */

/* X(CONSTANT, says) */
#define RT_CHANGES(X)                                                                                        \
    X(NONE, "no difference found")                                                                           \
    X(FASTER, "faster")                                                                                      \
    X(SLOWER, "slower")                                                                                      \
    X(BY_ACCEL, "by accelerator")                                                                            \
    X(NOT_JUDGED, "not judged")                                                                              \
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
    uint64_t scene_hash, ray_hash; /* of directories: of the first that has the cell */
    RtChange change; /* RT_CHANGE_OTHER_RAYS if any directory has other rays or another scene: then nothing of
                        the cell is compared */
    bool timed;      /* ratio is known */
    RtEstimate ratio;              /* of throughput after to that before */
    double before, after;          /* seconds a ray: median */
    bool counted;                  /* both of these are known, and independent of the machine */
    RtTally counts_before, counts; /* of the cell */
    const RtCell *(*runs)[2];      /* [pairs]: before, after; NULL: not timed */
    double *ratios;                /* [RT_MAX_ROUNDS]: of each round of two programs; or NULL */
    uint32_t rounds;               /* of these; fewer if a limit excluded the cell from some */
    double instructions[2];        /* a ray, before and after; 0: not counted */
    char uncounted[RT_MAX_WHY];    /* why instructions of one are not, though asked for; else "" */
} RtComparedCell;

/* An accelerator in directories. */
typedef struct RtComparedAccel {
    char accel[RT_MAX_LABEL];
    uint32_t groups;  /* scenes times pairs of runs that it is judged by; verdicts need two */
    RtEstimate ratio; /* of throughput after to before, relative to the median of all; the mean of groups */
    RtChange change;
} RtComparedAccel;

typedef struct RtComparison {
    RtArena memory;        /* of all but the cells */
    RtComparedCell *cells; /* [count] owned */
    uint32_t count, capacity;
    uint32_t timed;               /* cells with an interval */
    uint32_t rounds;              /* of two programs; 0: of directories */
    RtComparedAccel *accels;      /* [accel_count]; of directories */
    uint32_t accel_count, judged; /* and those with an interval */
    uint32_t pairs;               /* of directories */
    double all_accels;            /* ratio of the median accelerator; NAN: unknown */
    double together;              /* the confidence with which the intervals of all cells hold */
    double coverage;              /* of the interval of the cell with the fewest rounds */
    double margin;                /* differences count beyond this part */
    double seconds;               /* of the comparison */
    char before[256], after[256]; /* what was compared */
    json_t *plugins;              /* owned: of directories; those that changed (experiment/plugins_used.h) */
} RtComparison;

/* Zero a comparison first; clear it, also after a failure. */
void rt_comparison_clear(RtComparison *comparison);

/* ---- directories ---- */

/* Compares all cells, except null runs, of results[0..2 * pairs), loaded from directories: in each pair
 * before and after. The results may be cleared afterwards. RT_NO_MEMORY. */
RtStatus rt_compare_results(const RtResults *results, uint32_t pairs, RtComparison *comparison,
                            RtError *error);

/* ---- two programs ---- */

typedef struct RtPrograms {
    const char *before, *after; /* paths of programs: another, and this one */
    char *const *arguments;     /* of either, NULL behind the last, after those of a worker (worker.h) */
    uint32_t rounds;            /* at least; more if the number of cells requires them */
    double until, patience;     /* as in RtWorkloadOptions; patience is of all */
    double least;               /* least seconds of a turn */
    bool pinned;                /* each cell on one processor */
    uint64_t seed;              /* of all orders */
    void *context;              /* for the callbacks, which may be NULL */
    void (*progress)(void *context, uint32_t round, uint32_t rounds, const char *scene, const char *kind);
    void (*notice)(void *context, const char *message);
} RtPrograms;

RtStatus rt_compare_programs(const RtPrograms *programs, RtComparison *comparison, RtError *error);

/* Counts the instructions of both programs with callgrind.h, on at most `most` rays of each kind: for the
 * cells of an earlier rt_compare_programs. `arguments` are those of `bench`, NULL behind the last. */
RtStatus rt_compare_instructions(const RtExperiment *experiment, uint64_t most, const char *before,
                                 char *const *arguments, RtComparison *comparison, RtError *error);

/* ---- results ---- */

/* FASTER, SLOWER or NONE. */
RtChange rt_comparison_verdict(const RtComparison *comparison, const RtEstimate *ratio);

/* Finds the cell, or appends it; NULL if memory is short. Valid until the next call. */
RtComparedCell *rt_comparison_cell(RtComparison *comparison, const char *scene, const char *accel,
                                   const char *kind);

/* Whether both counts are known and differ. */
bool rt_compared_counts_differ(const RtComparedCell *cell);

/* Cells and accelerators with that verdict; cells whose counts differ. */
uint32_t rt_comparison_count(const RtComparison *comparison, RtChange change);
uint32_t rt_comparison_changed(const RtComparison *comparison);

/* A table with a row per cell, or per accelerator, for text or, with all columns, for JSON; `row` is scratch
 * memory of the table.
 */
typedef struct RtComparedRow {
    const RtComparison *comparison;
    const RtComparedCell *cell;
    const RtComparedAccel *accel;
} RtComparedRow;
RtTable rt_comparison_table(RtComparedRow *row, bool accels, bool all);

/* Prints the table, changed counts, and an explanation; or makes a JSON document, a new reference, NULL if
 * memory is short. */
void rt_comparison_print(const RtComparison *comparison, FILE *out);
json_t *rt_comparison_json(const RtComparison *comparison);

#endif
