/* SPDX-License-Identifier: Apache-2.0 */
/* A workload while it runs, and its longer steps. */
#ifndef RT_RUN_WORKLOAD_STATE_H
#define RT_RUN_WORKLOAD_STATE_H

#include "measure/measure.h"
#include "run/workload.h"

enum { RT_MAX_MEASURED = RT_MAX_CANDIDATES + 1 }; /* candidates and the null run */

/* The rays of one kind for one candidate, and their answers: views into arrays of the workload. */
typedef struct RtWorkloadShare {
    RtRaySet set;
    const RtHit *expected;
} RtWorkloadShare;

typedef struct RtWorkloadState {
    RtResults *results;
    const RtExperiment *experiment;
    const RtWorkloadOptions *options;
    uint32_t index, count; /* count: candidates and, if times are taken, the null run */
    bool count_only, distributions;
    RtScene *scene;
    RtAccel *reference;                   /* gives the expected answers */
    RtAccel *built[RT_MAX_MEASURED];      /* [count], NULL for one that does not run here */
    RtAccel *accels[RT_MAX_MEASURED];     /* [count], those that trace the current kind of rays, or NULL */
    void *displacements[RT_MAX_MEASURED]; /* [count] blocks in front of structures, or NULL */
    RtRaySet sets[RT_RAY_KIND_COUNT];   /* the current one is followed by its thinned shares and the probe */
    RtRaySet others[RT_RAY_KIND_COUNT]; /* to choose by, and to trace between passes; empty if nothing is
                                           timed */
    RtWorkloadShare shares[RT_MAX_MEASURED]; /* [count], of the current kind */
    RtWorkloadShare probe;                   /* the part of the set that predicts times */
    RtHit *answers;                          /* for the set of the current kind and what follows it */
    uint64_t answer_count;
} RtWorkloadState;

/* The candidate that is built for this one (rt_candidate_built). */
static inline const RtCandidate *rt_workload_setup(const RtWorkloadState *workload, uint32_t candidate) {
    const RtExperiment *e = workload->experiment;
    return &e->candidates[rt_candidate_built(e, candidate)];
}

/* Whether it takes times itself. */
static inline bool rt_workload_is_timed(const RtWorkloadState *workload) {
    return !workload->count_only && !workload->options->timer;
}

/* Notifies the observer. */
static inline RtStatus rt_workload_tell(const RtWorkloadState *workload, RtEventKind what, uint32_t candidate,
                                        RtRayKind kind, RtError *error) {
    const RtRunObserver *observer = &workload->options->observer;
    const RtEvent event = {what, workload->index, candidate, kind};
    return observer->event ? observer->event(observer->context, workload->results, &event, error) : RT_OK;
}

/* Why something is left out: it would take too long, the structure refuses the scene, or a plugin broke. */
typedef enum RtCause { RT_CAUSE_TIME, RT_CAUSE_REFUSED, RT_CAUSE_BROKEN } RtCause;

/* Leaves candidate `c` (RT_EVENT_NO_BUILD), or its cell of that kind of rays (RT_EVENT_NO_CELL), out of the
 * results. `why`, as of printf, is kept there and reported. If it is the baseline, the workload fails
 * instead, unless it was refused: then ratios are unknown. */
__attribute__((format(printf, 7, 8))) RtStatus rt_workload_leave_out(RtWorkloadState *workload, uint32_t c,
                                                                     RtEventKind what, RtRayKind kind,
                                                                     RtCause cause, RtError *error,
                                                                     const char *why, ...);

/* Excludes the candidate on rays of that kind as broken, for the reason in *error. */
RtStatus rt_workload_break(RtWorkloadState *workload, uint32_t c, RtRayKind kind, RtError *error);

/* ---- the steps ---- */

/* Builds all candidates within the limits, and times that unless it is known. One that refuses the scene, or
 * exceeds a limit, is left out. */
RtStatus rt_workload_build(RtWorkloadState *workload, RtError *error);

/* Builds an accelerator again that broke on other rays. */
RtStatus rt_workload_rebuild(RtWorkloadState *workload, uint32_t c, RtError *error);

/* Destroys workload->built[c]; NULL is allowed. */
void rt_workload_destroy(RtWorkloadState *workload, uint32_t c);

/* Replaces workload->built[c] by a structure built anew at another address, which knows the answers to the
 * current rays, of that kind, if it learns. After a failure there is none. */
RtStatus rt_workload_build_elsewhere(RtWorkloadState *workload, uint32_t c, RtRayKind kind, RtRandom *random,
                                     RtError *error);

/* Hands the answers to the current rays, of that kind, to an accelerator that learns. */
RtStatus rt_workload_teach(const RtWorkloadState *workload, RtRayKind kind, RtAccel *accel, RtError *error);

/* Counts all candidates on their shares of the rays of one kind, and distributions if they are requested. */
RtStatus rt_workload_count(RtWorkloadState *workload, RtRayKind kind, RtError *error);

/* Lets each best-of choose one of its members by their times on other rays of that kind; members that are
 * only tried, and not chosen, do not trace the current rays any more. */
RtStatus rt_workload_choose(RtWorkloadState *workload, RtRayKind kind, RtError *error);

/* Times all candidates on their shares of the rays of one kind. */
RtStatus rt_workload_time(RtWorkloadState *workload, RtRayKind kind, RtError *error);

/* Whether candidate `c` takes part in the workload, so far. */
bool rt_workload_runs(const RtWorkloadState *workload, uint32_t c);

#endif
