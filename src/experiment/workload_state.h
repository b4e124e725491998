/* SPDX-License-Identifier: Apache-2.0 */
/* A workload while it runs, and its steps, one file each: record, build, count, time, hardware counters. */
#ifndef RT_EXPERIMENT_WORKLOAD_STATE_H
#define RT_EXPERIMENT_WORKLOAD_STATE_H

#include "experiment/workload.h"
#include "measure/measure.h"

/* The rays of one kind that one candidate gets, and the answers to them: views into what the workload owns.
 */
typedef struct RtWorkloadShare {
    RtRaySet set;
    const RtHit *expected;
} RtWorkloadShare;

typedef struct RtWorkloadState {
    RtResults *results;
    const RtExperiment *experiment;
    const RtWorkloadOptions *options;
    uint32_t index, count; /* count: candidates and, where times are taken, the null run */
    bool count_only, hardware, distributions;
    RtScene *scene;
    RtAccel *reference;               /* its answers are the expected ones */
    RtAccel **built;                  /* [count], NULL for one that does not run here */
    RtAccel **accels;                 /* [count], those of them that get the rays of the current kind */
    RtRaySet sets[RT_RAY_KIND_COUNT]; /* behind the `count` rays of the current one: thinned shares, probe */
    RtWorkloadShare *shares;          /* [count], of the current kind */
    RtWorkloadShare probe;            /* the part of the set by which times are predicted */
    RtHit *answers;                   /* to the set of the current kind and all that lies behind it */
} RtWorkloadState;

/* What candidate `c` is built from: itself, or the baseline for the null run. */
static inline const RtCandidate *rt_workload_setup(const RtWorkloadState *workload, uint32_t candidate) {
    const RtExperiment *e = workload->experiment;
    return &e->candidates[candidate < e->candidate_count ? candidate : e->baseline];
}

/* Tells the observer. */
RtStatus rt_workload_tell(const RtWorkloadState *workload, RtEventKind what, uint32_t candidate,
                          RtRayKind kind, RtError *error);
void rt_workload_notice(const RtWorkloadState *workload, const char *message);

/* Tells that candidate `c`, or a cell of it, went beyond the limit that `limit` names, or is broken. Without
 * a baseline there is nothing to compare with: then the workload fails, and `limit` is cleared. */
RtStatus rt_workload_leave_out(RtWorkloadState *workload, uint32_t c, RtEventKind what, RtRayKind kind,
                               char *limit, RtError *error);

/* Leaves that candidate out on the rays of that kind, as broken; *error says why. */
RtStatus rt_workload_break(RtWorkloadState *workload, uint32_t c, RtRayKind kind, RtError *error);

/* ---- the steps ---- */

/* Records the rays; fills the workload's part of the results, or compares it with that of a previous run. */
RtStatus rt_workload_prepare(RtWorkloadState *workload, RtError *error);

/* Builds all candidates, within the limits. */
RtStatus rt_workload_build(RtWorkloadState *workload, RtError *error);

/* Counts all candidates on their shares of the rays of one kind, and finds distributions where they are asked
 * for. */
RtStatus rt_workload_count(RtWorkloadState *workload, RtRayKind kind, RtError *error);

/* Times all candidates on their shares of the rays of one kind. */
RtStatus rt_workload_time(RtWorkloadState *workload, RtRayKind kind, RtError *error);

/* Reads hardware counters while all candidates trace their shares of the rays of one kind. */
RtStatus rt_workload_hardware(RtWorkloadState *workload, RtRayKind kind, RtError *error);

/* Whether candidate `c` takes part in the workload, so far. */
bool rt_workload_runs(const RtWorkloadState *workload, uint32_t c);

#endif
