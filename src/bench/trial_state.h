/* A trial while it runs: what the files share that make one up (trial.c, trial_time.c). */
#ifndef RT_BENCH_TRIAL_STATE_H
#define RT_BENCH_TRIAL_STATE_H

#include "bench/measure.h"
#include "bench/trial.h"

/* The rays that one contender gets of one kind, and the answers to them; views into what the trial owns. */
typedef struct RtTrialShare {
    RtRaySet set;
    const RtHit *expected;
} RtTrialShare;

typedef struct RtTrialState {
    RtResults *results;
    const RtExperiment *experiment;
    const RtTrialOptions *options;
    uint32_t index, count; /* count: contenders and, where times are taken, the null run */
    bool count_only;
    RtScene *scene;
    RtAccel *reference;               /* answers */
    RtAccel **accels;                 /* [count], NULL for one that does not run here */
    RtRaySet sets[RT_RAY_KIND_COUNT]; /* behind the `count` rays of one at hand lie its thinned shares */
    RtTrialShare *shares;             /* [count], of the kind at hand */
    RtHit *answers;                   /* to the set of the kind at hand and the shares behind it */
} RtTrialState;

/* The contender that number `c` is built from: itself, or the baseline for the null run. */
static inline uint32_t rt_trial_origin(const RtTrialState *trial, uint32_t contender) {
    return contender < trial->experiment->contender_count ? contender : trial->experiment->baseline;
}

static inline uint64_t rt_trial_every(const RtTrialState *trial, uint32_t contender) {
    return trial->experiment->contenders[rt_trial_origin(trial, contender)].every;
}

/* Tells the observer. */
static inline RtStatus rt_trial_tell(const RtTrialState *trial, RtEventKind what, uint32_t contender,
                                     RtRayKind kind, RtError *error) {
    const RtObserver *observer = &trial->options->observer;
    RtEvent event = {what, trial->index, contender, kind};
    return observer->event ? observer->event(observer->context, trial->results, &event, error) : RT_OK;
}

/* Times all contenders on their shares of the rays of one kind. */
RtStatus rt_trial_time(RtTrialState *trial, RtRayKind kind, RtError *error);

#endif
