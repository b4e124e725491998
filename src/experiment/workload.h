/* SPDX-License-Identifier: Apache-2.0 */
/* A workload: one scene of an experiment, with every candidate measured on the rays recorded from it. What is
 * already known (from an earlier, interrupted run) is not measured again. */
#ifndef RT_EXPERIMENT_WORKLOAD_H
#define RT_EXPERIMENT_WORKLOAD_H

#include "experiment/results.h"
#include "rays/rayset.h"

/* A structure is built up to three times while that is cheap. The forecast knows it, too. */
#define RT_MOST_BUILDS 3
#define RT_CHEAP_BUILD 0.25 /* seconds, all builds together */

typedef enum RtEventKind {
    RT_EVENT_WORKLOAD,     /* results->workloads[workload] is known */
    RT_EVENT_BUILD,        /* the build of `candidate` is known */
    RT_EVENT_COUNT,        /* the cell is counted */
    RT_EVENT_DISTRIBUTION, /* the cell has its distributions */
    RT_EVENT_TIME,         /* the cell is timed */
    RT_EVENT_HARDWARE,     /* it is known what the machine did for the rays of the cell, or why not */
    RT_EVENT_TOO_LARGE,    /* the structure of `candidate` went beyond a limit */
    RT_EVENT_TOO_LONG,     /* the cell would go beyond a limit */
    RT_EVENT_BROKEN_BUILD, /* `candidate`, of a plugin, broke while it was built */
    RT_EVENT_BROKEN        /* it broke on the rays of the cell, or answered them wrong */
} RtEventKind;

/* Which part of the results was just filled. */
typedef struct RtEvent {
    RtEventKind what;
    uint32_t workload, candidate;
    RtRayKind kind;
} RtEvent;

/* Who is told. Both members are called from the thread that runs the workload; either may be NULL. A status
 * other than RT_OK ends the workload with it. */
typedef struct RtRunObserver {
    void *context;
    RtStatus (*event)(void *context, const RtResults *results, const RtEvent *event, RtError *error);
    void (*notice)(void *context, const char *message);
} RtRunObserver;

/* A part of an experiment: one scene, or one accelerator on it, or one kind of rays, by labels or what labels
 * of a sweep have in common; NULL for all. What ratios refer to is always measured, too. */
typedef struct RtOnly {
    const char *scene, *accel, *kind;
    uint32_t shard, shards; /* of the scenes those that fall to one of several machines, 1..shards; 0: all */
} RtOnly;

bool rt_only_scene(const RtOnly *only, const RtExperiment *experiment, uint32_t workload);
bool rt_only_accel(const RtOnly *only, const RtExperiment *experiment, uint32_t candidate);
bool rt_only_kind(const RtOnly *only, RtRayKind kind);
struct RtWorkloadState; /* experiment/workload_state.h */

typedef struct RtWorkloadOptions {
    int threads;     /* of recording, building and counting: 0 = all processors; changes no count */
    int timing;      /* threads of the timing, 1 as a rule */
    bool count_only; /* no timing */
    RtOnly only;
    double until; /* rounds go on until all intervals of ratios lie this near to their medians, as a part of
                     them: 0.01; 0: as many rounds as the experiment says */
    double patience; /* seconds that a kind of rays on a scene may take until then */
    /* Files for what each ray met and cost (measure/ray_file.h), or NULL: of an experiment of one workload,
     * one candidate without a stride, and one kind of rays. */
    const char *hits, *counts;
    RtRunObserver observer;
    const RtHardwareEvent *events; /* [RT_HARDWARE_COUNT] counted in place of those of their names; or NULL */
    /* Is shown the rays of each kind that were recorded on a workload, while they and the exact accelerator
     * that answers them are there; or NULL. */
    RtStatus (*rays)(void *context, uint32_t workload, const RtRaySet *set, const RtAccel *exact,
                     RtError *error);
    void *rays_context;
    /* Takes the place of the timing of one kind of rays, and of the null run, which there is none of; or
     * NULL. */
    RtStatus (*timer)(void *context, struct RtWorkloadState *workload, RtRayKind kind, RtError *error);
    void *timer_context;
} RtWorkloadOptions;

/* Records the rays of workload number `index` on its scene, whose sampling it sets: at most the experiment's
 * limit of each of its kinds, to sets[RT_RAY_KIND_COUNT]; or, where it has rays of a file, reads those.
 * *reference is the exact accelerator that recorded them. Destroy and clear both, also after a failure. */
RtStatus rt_workload_record(const RtExperiment *experiment, uint32_t index, int threads, RtScene *scene,
                            RtAccel **reference, RtRaySet *sets, RtError *error);

/* Whether nothing is unknown of the experiment's workload number `index`. */
bool rt_workload_is_done(RtResults *results, uint32_t index, const RtWorkloadOptions *options);

/* Opens the scene of a workload, which has to be there. The caller's: rt_scene_clear. */
RtStatus rt_workload_open_scene(const RtWorkload *workload, RtScene *scene, RtError *error);

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
