/* SPDX-License-Identifier: Apache-2.0 */
/* The results of an experiment: dense arrays over workload x candidate x ray kind, filled cell by cell. The
 * candidate after the last is the null run: the baseline (the first of several) built and measured a second
 * time. The interval of its ratio to itself should contain 1. */
#ifndef RT_RESULTS_RESULTS_H
#define RT_RESULTS_RESULTS_H

#include "core/text/json.h"
#include "core/text/table.h"
#include "experiment/experiment.h"
#include "measure/machine.h"
#include "measure/statistics.h"

#include <stdio.h>

#define RT_MAX_LEFT_OUT 512
#define RT_MAX_WHY      192 /* of a reason why a figure is unknown */

/* A set of ray kinds: a bit 1 << kind for each. */
typedef uint32_t RtKinds;
RtKinds rt_experiment_kinds(const RtExperiment *experiment);

typedef struct RtWorkloadResult {
    bool known;   /* the scene was opened and its rays recorded */
    bool skipped; /* optional, and its file is missing */
    uint32_t objects;
    uint32_t width, height;                       /* of the frame */
    uint64_t scene;                               /* rt_scene_fingerprint */
    uint64_t rays[RT_RAY_KIND_COUNT];             /* in the set, after the limit */
    uint64_t whole_rays[RT_RAY_KIND_COUNT];       /* in the whole set, before it; 0: unknown, as in results
                                                     of version 1.0 (rt_workload_record) */
    uint64_t ray_fingerprints[RT_RAY_KIND_COUNT]; /* of the set */
    char warnings[4096];                          /* of the scene's files, a line each (RtWarnings) */
} RtWorkloadResult;

/* Rendering the whole frame with an accelerator (`render`). */
typedef struct RtRenderResult {
    bool known;
    uint32_t rounds;
    int threads;
    uint32_t machine;   /* one of RtResults.machines */
    RtEstimate seconds; /* a frame: processor time on one thread, wall time on several */
    RtEstimate share;   /* of it spent in queries of the accelerator */
} RtRenderResult;

typedef struct RtBuildResult {
    bool known, exact, counts;    /* as in RtAccel */
    char spec[RT_MAX_SPEC_CHARS]; /* every effective parameter */
    uint32_t builds;              /* timed; 0: unknown, from the journal of an older version */
    uint32_t threads;             /* of the build; 0: unknown, likewise */
    RtEstimate seconds;           /* to build it; of fewer than two builds low = median = high */
    /* Why no cell of it is measured: the structure's reason if it was `refused`, the time it would take, or
     * the message of a `broken` plugin; or "". */
    char left_out[RT_MAX_LEFT_OUT];
    bool refused; /* rt_accel_refuses: its rows say why */
    bool broken;  /* a plugin's fault */
    RtDescription structure;
    RtDistribution
        *leaves; /* [RT_LEAF_QUANTITY_COUNT] owned, of the base; NULL: not asked for, or it has none */
    RtRenderResult render;
} RtBuildResult;

/* Times of each round in seconds per ray: by the clock of the comparison, by the wall clock, and the
 * baseline's on the same rays by the clock of the comparison. */
typedef enum RtRoundTime {
    RT_ROUND_SECONDS,
    RT_ROUND_WALL,
    RT_ROUND_BASELINE,
    RT_ROUND_TIME_COUNT
} RtRoundTime;

typedef struct RtCell {
    bool counted, timed;
    /* Why it is not measured: the limit that it would exceed, or the message of a `broken` plugin; or "". */
    char left_out[RT_MAX_LEFT_OUT];
    bool broken; /* a plugin's fault */
    bool chosen; /* of a best-of: `choice`, a member, is the fastest on other rays */
    uint32_t choice;
    RtTally tally;                 /* tally.rays: of the thinned set */
    uint64_t differ;               /* answers that differ from the reference's; 0 for exact accelerators */
    RtDistribution *distributions; /* [RT_RAY_QUANTITY_COUNT] owned; NULL: not asked for */
    uint32_t rounds;
    double repeats;      /* passes over the rays in a round; NAN: unknown, as in older journals */
    uint32_t structures; /* built anew and timed in turns; 0: unknown, from an older journal */
    double learnt;       /* time with other rays between its passes, over time without (rt_measure_learning);
                            NAN: not checked */
    int threads;         /* of the timing */
    uint32_t machine;    /* that timed it, in RtResults.machines */
    RtEstimate seconds;  /* per ray: processor time on one thread, wall time on several */
    RtEstimate wall;     /* per ray, by the wall clock */
    RtEstimate ratio;    /* of throughput to the baseline's on the same rays, paired by round */
    double *round_times; /* [RT_ROUND_TIME_COUNT][rounds] owned; NULL: not kept */
    uint32_t baseline;   /* its candidate: of a best-of the choice for these rays */
} RtCell;

typedef struct RtResults {
    const RtExperiment *experiment; /* borrowed */
    RtWorkloadResult workloads[RT_MAX_WORKLOADS];
    RtBuildResult *builds;               /* see rt_build_at */
    RtCell *cells;                       /* see rt_cell_at */
    RtMachine machines[RT_MAX_MACHINES]; /* the first is the unknown one */
    uint32_t machine_count;
    int refusals; /* their column in tables: 1 always, 0 if there are any, -1 never, as in version 1.0 */
    json_t *first_claims; /* owned: the list of claims when the run began, from its journal; NULL: unknown */
} RtResults;

/* All unknown. Clear with rt_results_clear, also after a failure. */
RtStatus rt_results_init(RtResults *results, const RtExperiment *experiment, RtError *error);
void rt_results_clear(RtResults *results);

/* The index of a machine in the results, which adds it; 0 if there are too many. */
uint32_t rt_results_machine(RtResults *results, const RtMachine *machine);

/* Places in the arrays; candidate = candidate_count is the null run. */
RtBuildResult *rt_build_at(const RtResults *results, uint32_t workload, uint32_t candidate);
RtCell *rt_cell_at(const RtResults *results, uint32_t workload, uint32_t candidate, RtRayKind kind);

/* Allocates the times of the cell's `rounds` rounds; returns one kind of them, [rounds]. */
RtStatus rt_cell_make_round_times(RtCell *cell, RtError *error);
double *rt_cell_round_times(const RtCell *cell, RtRoundTime which);

/* The candidate that stands for `candidate` on these rays: itself; for a best-of the chosen member, if one is
 * chosen. */
uint32_t rt_results_candidate(const RtResults *results, uint32_t workload, uint32_t candidate,
                              RtRayKind kind);

/* Whether the cell is timed when it is measured: that of a member that is only tried is where it is chosen,
 * or if the null run repeats it. */
bool rt_results_times(const RtResults *results, uint32_t workload, uint32_t candidate, RtRayKind kind);

/* The candidate's label; for the null run the baseline's and " (again)". */
const char *rt_candidate_label(const RtExperiment *experiment, uint32_t candidate);

/* The same for a screen (RtWorkload.shown). */
#define RT_MAX_SHOWN (RT_MAX_LABEL + 8)
void rt_candidate_show(const RtExperiment *experiment, uint32_t candidate, char out[RT_MAX_SHOWN]);

/* Every cell of the experiment except null runs and those of best-ofs, scene by scene, accelerator by
 * accelerator: for (RtCellCursor at = {0}; rt_results_next(results, &at);) use(at.cell); */
typedef struct RtCellCursor {
    uint32_t next, workload, candidate;
    RtRayKind kind;
    RtCell *cell;
} RtCellCursor;
bool rt_results_next(const RtResults *results, RtCellCursor *at);

/* Branch predictors and caches learn a small set of rays that is traced again and again; it then takes less
 * time than among the rays of a frame. Whether they have learnt the cell's: other rays between its passes
 * slow it down by more than 5 %. */
#define RT_LEARNT 1.05
bool rt_cell_is_learnt(const RtCell *cell);

/* The number of measured cells, and of their scenes. */
uint64_t rt_results_size(const RtResults *results, uint32_t *scenes);

/* RT_BROKEN with the first plugin that broke, if any did; RT_BAD_INPUT if all accelerators refused all
 * scenes. */
RtStatus rt_results_check(const RtResults *results, RtError *error);

/* Whether the candidate was refused on the workload; of a best-of, whether all its members were. */
bool rt_results_refused(const RtResults *results, uint32_t workload, uint32_t candidate);

/* Notes why a candidate is left out of a workload: as in RtBuildResult. */
void rt_results_leave_out(RtResults *results, uint32_t workload, uint32_t candidate, const char *why,
                          bool refused, bool broken);

/* Prints a line for each structure and each cell that was left out, with the reason. */
void rt_print_left_out(const RtResults *results, FILE *out);

/* What a ray kind weighs in every sum over kinds: the rays of its whole set, so that a lower limit changes no
 * total; of the measured set if the size of the whole is unknown. */
double rt_results_weight(const RtResults *results, uint32_t workload, RtRayKind kind);

/* Beside a total: "of 326921 rays, 152585 measured", or "of the measured part" if the size of a whole set is
 * unknown. `workloads`: a bit 1 << t for each. */
#define RT_MAX_PART_TEXT 64
void rt_results_say_part(const RtResults *results, uint32_t workloads, RtKinds kinds,
                         char out[RT_MAX_PART_TEXT]);

/* Counters of costs: X(name), as in RtTally. */
#define RT_COST_COUNTERS(X)                                                                                  \
    X(hits) X(object_tests) X(extent_tests) X(steps) X(leaf_steps) X(empty_steps) X(csg_tests)

/* A cost: of a ray, or the total of many. Unknown values are NAN. */
typedef struct RtCost {
    bool whole;    /* it includes all kinds of rays that it is asked for */
    uint64_t rays; /* measured */
    double weight; /* rays that it stands for */
#define RT_COST_COUNTER(name) double name;
    RT_COST_COUNTERS(RT_COST_COUNTER)
#undef RT_COST_COUNTER
    RtEstimate seconds; /* of several kinds the weighted ends of their intervals: conservative */
    RtEstimate saved;   /* wall seconds less than the baseline on the same rays, conservative; no `least` */
    RtEstimate ratio;   /* of throughput to the baseline's on the same rays; of several kinds the median */
} RtCost;

/* The cost of a ray: of one kind, or of all kinds of the experiment together (RT_ALL_RAYS), each with its
 * weight; all candidates of a workload use the kinds that any of them was measured on. */
RtCost rt_results_cost(const RtResults *results, uint32_t workload, uint32_t candidate, RtRayKind kind);

/* The total of the whole sets of several kinds: the cost of a ray of each times its weight. */
RtCost rt_results_total(const RtResults *results, uint32_t workload, uint32_t candidate, RtKinds kinds);

/* The break-even with the baseline: the number of rays, of all kinds by their weights, from which
 * on a candidate takes less time than the baseline, builds included (of several baselines the shortest
 * build); or up to which, if it builds faster and traces slower. The interval follows from the ends of those
 * of builds, ratios and times, and so is conservative. Unknown unless all were built and timed on the same
 * number of threads, and of a best-of, which has a structure for each kind of rays. */
typedef struct RtBreakEven {
    bool up_to;      /* faster for at most so many rays; else for at least so many */
    RtEstimate rays; /* each 0..INFINITY; NAN: unknown, or the baseline itself. `least` is NAN */
    uint32_t builds; /* the fewest of a structure; fewer than two have no interval, nor has this then */
} RtBreakEven;

RtBreakEven rt_results_break_even(const RtResults *results, uint32_t workload, uint32_t candidate);

/* The most rounds of any timed cell of a workload, null runs included, and in *least the fewest; 0 if nothing
 * was timed. */
uint32_t rt_results_rounds(const RtResults *results, uint32_t workload, uint32_t *least);

/* ---- paired times ---- */

/* Times of accelerators relative to each other are divided within each round, so that what slows a round
 * slows both. Only cells that were timed in the same rounds can be paired directly; of others each is first
 * divided by the baseline of its own rounds and rays. In a sum over kinds, times on thinned and on other sets
 * of rays are added as they were measured. */

/* The time of a ray: of one kind, or with RT_ALL_RAYS the weighted mean of all kinds, summed within each
 * round. Its interval covers at least `coverage`, 0.95 or more (rt_estimate_covering); that of a journal of
 * an older version, which has no times of rounds, is as it was kept. NAN if a kind was not measured. */
RtEstimate rt_results_time(const RtResults *results, uint32_t workload, uint32_t candidate, RtRayKind kind,
                           double coverage);

/* The time of `over` relative to that of `under`, likewise. Where nothing can be paired, because there are no
 * times of rounds or no common baseline, the quotient of both estimates, with those of the intervals' ends.
 */
RtEstimate rt_results_time_ratio(const RtResults *results, uint32_t workload, uint32_t over, uint32_t under,
                                 RtRayKind kind, double coverage);

/* Compares a candidate with all others of the workload, for one kind of rays or RT_ALL_RAYS: by time if
 * anything was timed, else by object tests per ray. No other is faster than the best by the medians of paired
 * ratios; one whose ratio to the best has 1 in its interval is level with it. Null runs, members that only a
 * best-of tries, and the yardstick (rt_accel_yardstick) are not compared. */
RtStanding rt_standing(const RtResults *results, uint32_t workload, uint32_t candidate, RtRayKind kind);

/* The same by time, or by object tests, whatever was timed. */
RtStanding rt_standing_by(bool time, const RtResults *results, uint32_t workload, uint32_t candidate,
                          RtRayKind kind);

/* ---- claims that changed ---- */

/* Claims may be edited after a run began, but not in secret. Readouts claim nothing, and may come and go. */
#define RT_CLAIM_LATER "stated after the run began"

/* The texts of all claims, readouts too: a new reference, NULL if memory is short. */
json_t *rt_claims_json(const RtExperiment *experiment);

/* Whether claim number `i` was not there when the run began. False if that is unknown, as in runs of version
 * 1.0. */
bool rt_claim_is_later(const RtResults *results, uint32_t i);

/* The texts of the claims that were there when the run began and are not any more; likewise. */
json_t *rt_claims_dropped(const RtResults *results);

/* Whether any claim is later or dropped. */
bool rt_claims_are_changed(const RtResults *results);

#endif
