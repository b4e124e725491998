/* SPDX-License-Identifier: Apache-2.0 */
/* What a run tells while it fills the results. */
#ifndef RT_RESULTS_EVENTS_H
#define RT_RESULTS_EVENTS_H

#include "results/results.h"

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

#endif
