/* SPDX-License-Identifier: Apache-2.0 */
/* A workload: one scene of an experiment, with every candidate measured on the rays recorded from it. What is
 * already known (from an earlier, interrupted run) is not measured again. */
#ifndef RT_BENCH_WORKLOAD_H
#define RT_BENCH_WORKLOAD_H

#include "bench/results.h"

typedef enum RtEventKind {
    RT_EVENT_WORKLOAD, /* results->workloads[workload] is known */
    RT_EVENT_BUILD,    /* the build of `candidate` is known */
    RT_EVENT_COUNT,    /* the cell is counted */
    RT_EVENT_TIME      /* the cell is timed */
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

typedef struct RtWorkloadOptions {
    int threads;     /* of recording, building and counting: 0 = all processors; changes no count */
    int timing;      /* threads of the timing, 1 as a rule */
    bool count_only; /* no timing */
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
