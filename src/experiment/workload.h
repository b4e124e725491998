/* SPDX-License-Identifier: Apache-2.0 */
/* A workload: one scene of an experiment, with every candidate measured on the rays recorded from it. Results
 * that are known from an earlier, interrupted run are not measured again. */
#ifndef RT_EXPERIMENT_WORKLOAD_H
#define RT_EXPERIMENT_WORKLOAD_H

#include "experiment/results.h"
#include "rays/rayset.h"

/* Seconds for each build that the experiment asks for: a structure is not built again once all its builds
 * together have taken that long. */
#define RT_BUILD_BUDGET 0.15

/* Seconds for building a structure anew in each round of timing, if tracing takes no longer. */
#define RT_RENEWAL_BUDGET 0.05

typedef enum RtEventKind {
    RT_EVENT_WORKLOAD,     /* results->workloads[workload] is known */
    RT_EVENT_BUILD,        /* the build of `candidate` is known */
    RT_EVENT_COUNT,        /* the cell is counted */
    RT_EVENT_DISTRIBUTION, /* the cell has its distributions */
    RT_EVENT_TIME,         /* the cell is timed */
    RT_EVENT_RENDER,       /* rendering with `candidate` is timed */
    RT_EVENT_NO_BUILD,     /* `candidate` is left out: it refuses the scene, took too long, or broke */
    RT_EVENT_NO_CELL /* the cell is left out: it would exceed a limit, or `candidate` broke on its rays */
} RtEventKind;

/* The part of the results that was just filled. */
typedef struct RtEvent {
    RtEventKind what;
    uint32_t workload, candidate;
    RtRayKind kind;
} RtEvent;

/* Whether the candidate or the cell is left out because it broke. */
bool rt_event_is_broken(const RtResults *results, const RtEvent *event);

/* Callbacks, called on the thread that runs the workload; each may be NULL. A status other than RT_OK ends
 * the workload with that status. */
typedef struct RtRunObserver {
    void *context;
    RtStatus (*event)(void *context, const RtResults *results, const RtEvent *event, RtError *error);
    void (*notice)(void *context, const char *message);
} RtRunObserver;

/* Formats a notice like printf, and passes it to the observer. */
__attribute__((format(printf, 2, 3))) void rt_notify(const RtRunObserver *observer, const char *format, ...);

/* A part of an experiment: a scene, an accelerator, a kind of rays, each by its label, or the common part of
 * the labels of a sweep; NULL for all. */
typedef struct RtPart {
    const char *scene, *accel, *kind;
} RtPart;

/* What is measured: the cells of any of the parts, and the baseline's beside them. */
enum { RT_MAX_PARTS = 32 };
typedef struct RtOnly {
    RtPart parts[RT_MAX_PARTS];
    uint32_t part_count;    /* 0: all cells */
    uint32_t shard, shards; /* the scenes of one of several machines, 1..shards; 0: all */
} RtOnly;

/* Whether the cell is measured; with RT_ALL_RAYS, whether any of the candidate's is. The baseline and the
 * null run (candidate_count) belong to every part. */
bool rt_only_cell(const RtOnly *only, const RtExperiment *experiment, uint32_t workload, uint32_t candidate,
                  RtRayKind kind);

/* Whether any cell of the workload is measured. */
static inline bool rt_only_scene(const RtOnly *only, const RtExperiment *experiment, uint32_t workload) {
    return rt_only_cell(only, experiment, workload, experiment->candidate_count, RT_ALL_RAYS);
}

/* RT_BAD_INPUT if a label is none of the experiment's. The message begins with "--only". */
RtStatus rt_only_check(const RtOnly *only, const RtExperiment *experiment, RtError *error);

struct RtWorkloadState; /* experiment/workload_state.h */

typedef struct RtWorkloadOptions {
    int threads;     /* for recording, building and counting; 0 = all processors; changes no count */
    int timing;      /* threads for timing, usually 1 */
    bool count_only; /* no timing */
    RtOnly only;
    double until;    /* rounds continue until all intervals of ratios are within this part of their medians:
                        0.01; 0: as many rounds as in the experiment */
    double patience; /* most seconds of that for a kind of rays on a scene */
    /* FILE.npy, which gets the hit and the cost of each ray (measure/ray_file.h); or NULL. If the experiment
     * has several cells, FILE-NAME.npy for each, with the names of scene, accelerator and kind of rays of
     * which there are several. */
    const char *hits, *counts;
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
 * does not depend on the limit either. *reference is the exact accelerator that recorded them. Destroy and
 * clear both, also after a failure. */
RtStatus rt_workload_record(const RtExperiment *experiment, uint32_t index, int threads, RtScene *scene,
                            RtAccel **reference, RtRaySet *sets, uint64_t *whole_rays, RtError *error);

/* Whether all results of workload number `index` are known. */
bool rt_workload_is_done(RtResults *results, uint32_t index, const RtWorkloadOptions *options);

/* Whether the experiment asks for frames rendered with candidate `c`: not with the null run, plugins, and
 * candidates that are measured on a part of the rays. */
bool rt_candidate_renders(const RtExperiment *experiment, uint32_t c);

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
