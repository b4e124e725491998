/* SPDX-License-Identifier: Apache-2.0 */
/* A workload: one scene of an experiment, with every candidate measured on the rays recorded from it. Results
 * that are known from an earlier, interrupted run are not measured again. */
#ifndef RT_RUN_WORKLOAD_H
#define RT_RUN_WORKLOAD_H

#include "results/journal.h"

/* Seconds for each build that the experiment asks for: a structure is not built again once all its builds
 * together have taken that long. */
#define RT_BUILD_BUDGET 0.15

/* Seconds for building a structure anew in each round of timing, if tracing takes no longer. */
#define RT_RENEWAL_BUDGET 0.05

/* A best-of chooses by other rays than those it is measured on: of the same scene, recorded with the next
 * seed at pixel corners in place of centres, or at centres in place of corners; in a file of rays every
 * second coherent run. So many of a kind at most. */
#define RT_CHOICE_RAYS 20000

/* A smaller set is timed again with other rays between its passes: it may be learnt (rt_measure_learning). */
#define RT_LEARNABLE_RAYS 65536

struct RtWorkloadState; /* run/workload_state.h */

typedef struct RtWorkloadOptions {
    int threads;     /* for recording, counting and builds that are not timed; 0 = all processors; changes no
                        count */
    int timing;      /* threads for timed builds and rays, usually those of the experiment */
    bool count_only; /* no timing */
    RtSelection only;
    double until;     /* rounds continue until all intervals of ratios are within this part of their medians:
                         0.01; 0: as many rounds as in the experiment */
    double patience;  /* most seconds of that for a kind of rays on a scene */
    const char *hits; /* a file for the hit of each ray (rt_hits_put) of an experiment of one cell; or NULL */
    RtRunObserver observer;
    /* Gets the recorded rays of each kind, and the exact accelerator that answers them; or NULL. */
    RtStatus (*rays)(void *context, uint32_t workload, const RtRaySet *set, const RtAccel *exact,
                     RtError *error);
    void *rays_context;
    /* Replaces the timing of one kind of rays; then there is no null run. Or NULL. */
    RtStatus (*timer)(void *context, struct RtWorkloadState *workload, RtRayKind kind, RtError *error);
    void *timer_context;
} RtWorkloadOptions;

/* Records the rays of workload number `index` on its scene, whose sampling it sets; or reads them from a
 * file, if the experiment names one. At most the experiment's limit of each of its kinds, to
 * sets[RT_RAY_KIND_COUNT]; the size of each whole set, before the limit, to whole_rays[RT_RAY_KIND_COUNT].
 * There could be any number of random rays: their whole set has one for each sample of the frame, so that it
 * does not depend on the limit either. others[RT_RAY_KIND_COUNT], or NULL, gets as many other rays, but at
 * most RT_LEARNABLE_RAYS. *reference is the exact accelerator that recorded them. Destroy and clear all, also
 * after a failure. */
RtStatus rt_workload_record(const RtExperiment *experiment, uint32_t index, int threads, RtScene *scene,
                            RtAccel **reference, RtRaySet *sets, RtRaySet *others, uint64_t *whole_rays,
                            RtError *error);

/* Whether all results of workload number `index` are known. */
bool rt_workload_is_done(RtResults *results, uint32_t index, const RtWorkloadOptions *options);

/* Opens the scene of a workload. Clear it with rt_scene_clear. */
RtStatus rt_workload_open_scene(const RtWorkload *workload, RtScene *scene, RtError *error);

/* The same; but if the scene is optional and missing, it stays empty, and the workload is skipped with a
 * notice. */
RtStatus rt_workload_open(RtResults *results, uint32_t index, const RtWorkloadOptions *options,
                          RtScene *scene, RtError *error);

/* Measures the unknown results of the workload on its scene, whose sampling it changes. RT_MISMATCH if an
 * exact accelerator gives a wrong answer, or another number of hits. */
RtStatus rt_workload_measure(RtResults *results, uint32_t index, const RtWorkloadOptions *options,
                             RtScene *scene, RtError *error);

/* Opens and measures each workload that is not done. */
RtStatus rt_workloads_run(RtResults *results, const RtWorkloadOptions *options, RtError *error);

#endif
