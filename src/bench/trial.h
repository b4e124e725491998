/* A trial: one scene of an experiment, with every contender measured on the rays recorded from it. What is
 * already known (from an earlier, interrupted run) is not measured again. */
#ifndef RT_BENCH_TRIAL_H
#define RT_BENCH_TRIAL_H

#include "bench/results.h"

typedef enum RtEventKind {
    RT_EVENT_TRIAL, /* results->trials[trial] is known */
    RT_EVENT_BUILD, /* the build of `contender` is known */
    RT_EVENT_COUNT, /* the cell is counted */
    RT_EVENT_TIME   /* the cell is timed */
} RtEventKind;

/* Which part of the results was just filled. */
typedef struct RtEvent {
    RtEventKind what;
    uint32_t trial, contender;
    RtRayKind kind;
} RtEvent;

/* Who is told. Both members are called from the thread that runs the trial; either may be NULL. A status
 * other than RT_OK ends the trial with it. */
typedef struct RtObserver {
    void *context;
    RtStatus (*event)(void *context, const RtResults *results, const RtEvent *event, RtError *error);
    void (*notice)(void *context, const char *message);
} RtObserver;

typedef struct RtTrialOptions {
    int threads;     /* of recording, building and counting: 0 = all processors; changes no count */
    int timing;      /* threads of the timing, 1 as a rule */
    bool count_only; /* no timing */
    RtObserver observer;
} RtTrialOptions;

/* Whether nothing is unknown of the experiment's trial number `index`. */
bool rt_trial_is_done(RtResults *results, uint32_t index, const RtTrialOptions *options);

/* Opens its scene, which is the caller's: rt_scene_clear. Where it is optional and missing, it is empty, and
 * the trial is skipped with a notice. */
RtStatus rt_trial_open(RtResults *results, uint32_t index, const RtTrialOptions *options, RtScene *scene,
                       RtError *error);

/* Fills what is unknown of the trial, on the scene that was opened, whose sampling it changes. An exact
 * accelerator whose answers differ from the baseline's, or whose hits are not the same number, is
 * RT_MISMATCH. */
RtStatus rt_trial_measure(RtResults *results, uint32_t index, const RtTrialOptions *options, RtScene *scene,
                          RtError *error);

/* Both, unless it is done. */
RtStatus rt_trial_run(RtResults *results, uint32_t index, const RtTrialOptions *options, RtError *error);

#endif
