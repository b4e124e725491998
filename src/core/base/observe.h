/* SPDX-License-Identifier: Apache-2.0 */
/* Looking on while a ray is traced: counted kernels tell an onlooker of every event that they count, in
 * order.
 *
 * An onlooker belongs to a thread. Kernels tell it with RT_OBSERVE beside the RT_COUNT of the same event, and
 * with the same tally: where that is a constant NULL (the timed kernels) nothing is left of it after
 * inlining, which tests/check_timed_kernels.sh looks for. Counted kernels look once per event whether there
 * is an onlooker. What is only of use to one (the box of a voxel, say) is computed where RT_OBSERVED says
 * that there is. */
#ifndef RT_BASE_OBSERVE_H
#define RT_BASE_OBSERVE_H

#include "core/base/box.h"
#include "core/base/tally.h"

#include <stdbool.h>

typedef enum RtTracedKind {
    RT_TRACED_STEP,        /* a node, voxel, sample or list entry is visited */
    RT_TRACED_EXTENT_TEST, /* `met`: the ray meets the extent where there may still be something to find */
    RT_TRACED_OBJECT_TEST, /* the hit function of object `index` is entered */
    RT_TRACED_OBJECT_HIT,  /* ... and has found it, at `t`; other events of the same test may lie between */
    RT_TRACED_CSG_TEST,    /* a solid of the CSG tree that is being tested */
    RT_TRACED_REPEAT_AVOIDED, /* a mailbox knows object `index` */
    RT_TRACED_PASSED_ON,      /* an overlay hands the ray to what lies below */
    RT_TRACED_KIND_COUNT
} RtTracedKind;

/* What happened. Members that have no meaning for the kind are zero. */
typedef struct RtTraced {
    RtTracedKind kind;
    const char
        *what; /* "node", "voxel", ... that `index` is the number of; NULL where there is none. Static */
    uint32_t index;
    const RtBox *box; /* where it is; NULL where it has no box. Valid during the call */
    const struct RtBall
        *ball;        /* of an extent test of a sphere (core/shape/ball.h); else NULL. Valid likewise */
    bool leaf, empty; /* of a step: is it counted in leaf_steps, and in empty_steps? */
    bool met;
    float t;
} RtTraced;

typedef struct RtOnlooker {
    void (*see)(void *context, const RtTraced *event);
    void *context;
} RtOnlooker;

/* Of this thread; NULL, as it is at first, where nobody looks on. To be set around the tracing of one ray. */
extern _Thread_local const RtOnlooker *rt_onlooker;

#define RT_COLD __attribute__((cold, noinline))

/* Is this a counted kernel, and does anybody look on? */
#define RT_OBSERVED(tally) ((tally) && __builtin_expect(rt_onlooker != NULL, 0))

/* Tells the onlooker, if there is one, of an event given by its members: RT_OBSERVE(tally, .kind = ...). */
#define RT_OBSERVE(tally, ...)                                                                               \
    do {                                                                                                     \
        if (RT_OBSERVED(tally)) rt_observe(&(RtTraced){__VA_ARGS__});                                        \
    } while (0)

/* For RT_OBSERVE: there is an onlooker. */
RT_COLD void rt_observe(const RtTraced *event);

/* Adds an event to the counters that a kernel would count it in: the events of a ray add up to its tally,
 * but for `rays` and `hits`. */
void rt_traced_count(const RtTraced *event, RtTally *tally);

#endif
