/* SPDX-License-Identifier: Apache-2.0 */
/* A workload: one scene of an experiment, with every candidate measured on the rays recorded from it. What is
 * already known (from an earlier, interrupted run) is not measured again. */
#ifndef RT_BENCH_WORKLOAD_H
#define RT_BENCH_WORKLOAD_H

#include "bench/results.h"

typedef enum RtEventKind {
    RT_EVENT_WORKLOAD,  /* results->workloads[workload] is known */
    RT_EVENT_BUILD,     /* the build of `candidate` is known */
    RT_EVENT_COUNT,     /* the cell is counted */
    RT_EVENT_TIME,      /* the cell is timed */
    RT_EVENT_TOO_LARGE, /* the structure of `candidate` went beyond a limit */
    RT_EVENT_TOO_LONG   /* the cell would go beyond a limit */
} RtEventKind;

/* Which part of the results was just filled. */
typedef struct RtEvent {
    RtEventKind what;
    uint32_t workload, candidate;
    RtRayKind kind;
} RtEvent;

/* Who is told. Both members are called from the thread that runs the workload; either may be NULL. A status
 * other than RT_OK ends the workload with it. */
typedef struct RtObserver {
    void *context;
    RtStatus (*event)(void *context, const RtResults *results, const RtEvent *event, RtError *error);
    void (*notice)(void *context, const char *message);
} RtObserver;

/* A part of an experiment: one scene, or one accelerator on it, or one kind of rays, by labels or what labels
 * of a sweep have in common; NULL for all. What ratios refer to is always measured, too. */
typedef struct RtOnly {
    const char *scene, *accel, *kind;
    uint32_t shard, shards; /* of the scenes those that fall to one of several machines, 1..shards; 0: all */
} RtOnly;

bool rt_only_scene(const RtOnly *only, const RtExperiment *experiment, uint32_t workload);
bool rt_only_accel(const RtOnly *only, const RtExperiment *experiment, uint32_t candidate);
bool rt_only_kind(const RtOnly *only, RtRayKind kind);

typedef struct RtWorkloadOptions {
    int threads;     /* of recording, building and counting: 0 = all processors; changes no count */
    int timing;      /* threads of the timing, 1 as a rule */
    bool count_only; /* no timing */
    RtOnly only;
    RtObserver observer;
} RtWorkloadOptions;

/* Whether nothing is unknown of the experiment's workload number `index`. */
bool rt_workload_is_done(RtResults *results, uint32_t index, const RtWorkloadOptions *options);

/* Opens its scene, which is the caller's: rt_scene_clear. Where it is optional and missing, it is empty, and
 * the workload is skipped with a notice. */
RtStatus rt_workload_open(RtResults *results, uint32_t index, const RtWorkloadOptions *options,
                          RtScene *scene, RtError *error);

/* Fills what is unknown of the workload, on the scene that was opened, whose sampling it changes. An exact
 * accelerator whose answers differ from the baseline's, or whose hits are not the same number, is
 * RT_MISMATCH. */
RtStatus rt_workload_measure(RtResults *results, uint32_t index, const RtWorkloadOptions *options,
                             RtScene *scene, RtError *error);

/* Both, unless it is done. */
RtStatus rt_workload_run(RtResults *results, uint32_t index, const RtWorkloadOptions *options,
                         RtError *error);

#endif
