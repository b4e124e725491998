/* SPDX-License-Identifier: Apache-2.0 */
/* Observing a ray while it is traced: counted kernels report every event that they count, in order.
 *
 * A thread has at most one observer. Kernels call RT_OBSERVE beside the RT_COUNT of the same event with
 * the same tally. In timed kernels the tally is a constant NULL and the call vanishes, which
 * tests/check_timed_kernels.sh verifies; counted kernels check for an observer once per event. Arguments
 * that are costly to compute (the box of a voxel, say) belong inside `if (RT_OBSERVED(tally))`. */
#ifndef RT_BASE_OBSERVE_H
#define RT_BASE_OBSERVE_H

#include "core/base/box.h"
#include "core/base/tally.h"

#include <stdbool.h>

typedef enum RtTracedKind {
    RT_TRACED_STEP,           /* a node, voxel, sample or list entry is visited */
    RT_TRACED_EXTENT_TEST,    /* `met`: the ray meets the extent where something may still be found */
    RT_TRACED_OBJECT_TEST,    /* the hit function of object `index` is called */
    RT_TRACED_OBJECT_HIT,     /* it hit, at `t`; other events of the same test may come in between */
    RT_TRACED_CSG_TEST,       /* a leaf solid of the CSG tree under test; `crossings` with it */
    RT_TRACED_CSG_RESULT,     /* `crossings` with the result of an operation of that tree; not counted */
    RT_TRACED_REPEAT_AVOIDED, /* a mailbox skipped object `index` */
    RT_TRACED_PASSED_ON,      /* an overlay passes the ray to the accelerator below */
    RT_TRACED_ENTERED,        /* instance `index` is entered: the next events, up to LEFT, are of its part */
    RT_TRACED_LEFT,           /* and left, `met` at `t`; not counted */
    RT_TRACED_KIND_COUNT
} RtTracedKind;

/* One event. Members without meaning for its kind are zero. */
typedef struct RtTraced {
    RtTracedKind kind;
    const char *what; /* what `index` numbers: "node", "voxel", ...; or NULL; valid during the call */
    uint32_t index;
    const RtBox *box; /* its box or NULL; valid during the call */
    const struct RtBall
        *ball; /* the sphere of an extent test (core/shape/shape.h) or NULL; valid during the call */
    const struct RtCrossing *crossings; /* of the ray's line (core/shape/solid.h), ascending, alternately in
                                         * and out; or NULL; valid during the call */
    uint32_t crossing_count;
    bool in_tree;     /* belongs to the test of the CSG tree whose event was the last without this mark */
    bool leaf, empty; /* of a step: counted in leaf_steps, in empty_steps */
    bool met;
    float t;
} RtTraced;

typedef struct RtTraceObserver {
    void (*observe)(void *context, const RtTraced *event);
    void *context;
} RtTraceObserver;

/* This thread's observer, or NULL (the default). Set it around the tracing of one ray. */
extern _Thread_local const RtTraceObserver *rt_trace_observer;

#define RT_COLD __attribute__((cold, noinline))

/* True in a counted kernel with an observer. */
#define RT_OBSERVED(tally) ((tally) && __builtin_expect(rt_trace_observer != NULL, 0))

/* Reports an event, given by its members, to the observer if there is one: RT_OBSERVE(tally, .kind = ...). */
#define RT_OBSERVE(tally, ...)                                                                               \
    do {                                                                                                     \
        if (RT_OBSERVED(tally)) rt_observe(&(RtTraced){__VA_ARGS__});                                        \
    } while (0)

/* For RT_OBSERVE, which has checked that there is an observer. */
RT_COLD void rt_observe(const RtTraced *event);

/* Counts an event as the kernel does: the events of a ray add up to its tally, except for `rays` and
 * `hits`. */
void rt_traced_count(const RtTraced *event, RtTally *tally);

#endif
