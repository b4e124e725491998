/* SPDX-License-Identifier: Apache-2.0 */
/* A workload while it runs: what the files share that make one up (workload.c, workload_time.c and others).
 */
#ifndef RT_EXPERIMENT_WORKLOAD_STATE_H
#define RT_EXPERIMENT_WORKLOAD_STATE_H

#include "accel/away.h"
#include "experiment/workload.h"
#include "measure/measure.h"

/* The rays that one candidate gets of one kind, and the answers to them; views into what the workload owns.
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
    RtAccel *reference;               /* answers */
    RtAccel **built;                  /* [count], NULL for one that does not run here */
    RtAccel **accels;                 /* [count], of them those that get the rays of the kind at hand */
    RtRaySet sets[RT_RAY_KIND_COUNT]; /* behind the `count` rays of the one at hand: thinned shares, probe */
    RtWorkloadShare *shares;          /* [count], of the kind at hand */
    RtWorkloadShare probe;            /* the part of the set by which times are foretold */
    RtHit *answers;                   /* to the set of the kind at hand and all that lies behind it */
} RtWorkloadState;

/* The candidate that number `c` is built from: itself, or the baseline for the null run. */
static inline uint32_t rt_workload_origin(const RtWorkloadState *workload, uint32_t candidate) {
    return candidate < workload->experiment->candidate_count ? candidate : workload->experiment->baseline;
}

static inline uint64_t rt_workload_ray_stride(const RtWorkloadState *workload, uint32_t candidate) {
    return workload->experiment->candidates[rt_workload_origin(workload, candidate)].ray_stride;
}

/* Tells the observer. */
static inline RtStatus rt_workload_tell(const RtWorkloadState *workload, RtEventKind what, uint32_t candidate,
                                        RtRayKind kind, RtError *error) {
    const RtObserver *observer = &workload->options->observer;
    RtEvent event = {what, workload->index, candidate, kind};
    return observer->event ? observer->event(observer->context, workload->results, &event, error) : RT_OK;
}

/* Tells that candidate `c`, or a cell of it, went beyond the limit that `limit` names. That of the baseline,
 * without which there is nothing to compare with, is RT_BAD_INPUT, and no longer named. */
RtStatus rt_workload_leave_out(RtWorkloadState *workload, uint32_t c, RtEventKind what, RtRayKind kind,
                               char *limit, RtError *error);

/* Whether `status` is of what concerns no other candidate: an accelerator of a plugin that is broken, or
 * whose answers are wrong. */
static inline bool rt_workload_is_own_fault(const RtWorkloadState *workload, uint32_t candidate,
                                            RtStatus status) {
    return status == RT_BROKEN || (status == RT_MISMATCH && rt_accel_is_away(workload->accels[candidate]));
}

/* Leaves that candidate out on the rays of that kind; *error, whose message it is, is why. */
RtStatus rt_workload_break(RtWorkloadState *workload, uint32_t c, RtRayKind kind, RtError *error);

#define RT_PROBE_RAYS 256 /* at most */

/* Draws the probe from all of the set, in short runs, with its answers, to lie from `first` on. The first
 * rays of a set are the uppermost of the image, and as a rule cheaper than others. */
RtStatus rt_workload_draw_probe(RtWorkloadState *workload, const RtRaySet *set, uint64_t first,
                                RtError *error);

/* Leaves out who would take longer on the rays of that kind than the limit: whose shares are dealt. */
RtStatus rt_workload_check_limits(RtWorkloadState *workload, RtRayKind kind, RtError *error);

/* Finds the distributions of all candidates over their shares of the rays of one kind. */
RtStatus rt_workload_distribute(RtWorkloadState *workload, RtRayKind kind, RtError *error);

/* Those over the leaves of a structure, to result->leaves. */
RtStatus rt_workload_distribute_leaves(const RtAccel *accel, RtBuildResult *result, RtError *error);

/* Times all candidates on their shares of the rays of one kind. */
RtStatus rt_workload_time(RtWorkloadState *workload, RtRayKind kind, RtError *error);

/* Counts what the machine does for all candidates on their shares of the rays of one kind. */
RtStatus rt_workload_hardware(RtWorkloadState *workload, RtRayKind kind, RtError *error);

#endif
