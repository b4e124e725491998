/* SPDX-License-Identifier: Apache-2.0 */
/* The protocol between raytally and the process of a remote accelerator, in memory that both share.
 *
 * The process is a fork, so it has the scene, the code, and every function at the same address. A request is
 * therefore a function, a message and rays, and needs no encoding: raytally writes them into a channel and
 * sets `asked` to the number of the request; in the process, the channel's thread runs the function, which
 * answers in the message, and sets `answered` to the same number. Channel 0 belongs to the main thread of the
 * process: it builds, opens the other channels, and destroys. Each other channel belongs to one RtQuery.
 *
 * Invariant: a plugin may write anything here at any time. raytally copies what it reads, checks the copy,
 * and reads no bool, size or address from here; what it must know of a channel it keeps in its own memory.
 *
 * Threads wait on words of this memory by futexes, not semaphores: an overwritten futex is only a number
 * nobody waits for, whereas the C library aborts on an invalid semaphore. A pipe would not survive a plugin
 * that closes all files. */
#ifndef RT_ACCEL_PLUGIN_CHANNEL_H
#define RT_ACCEL_PLUGIN_CHANNEL_H

#include "accel/plugin.h"
#include "core/shape/shape.h"

#include <raytally/accel.h>
#include <stdatomic.h>

/* One more than the most threads. The memory of unused channels is never touched. */
enum { CHANNELS = 1 + 1024 };

typedef struct Channel {
    atomic_uint asked, answered; /* number of the last request, and of the last answer */
    RtRemoteWork *work;          /* called with the channel's query, which channel 0 lacks; NULL: closes the
                                    channel */
    bool begin;                  /* rt_query_begin comes first */
    RtRay rays[RT_REMOTE_RAYS];
    RtStatus status; /* of the answer */
    RtError error;
    _Alignas(64) char message[RT_REMOTE_BYTES];
} Channel;

/* What the process recorded of its own end. */
typedef struct Crash {
    atomic_int signal; /* 0: nothing */
    uint32_t out_of;   /* it left the memory of a query: 1; its answers: 2; 0: neither */
    uint32_t
        traced; /* `ray` is: 2: the last that the plugin prepared; 1: the first of its stream; 0: unset */
    RtRay ray;
} Crash;

typedef struct Shared {
    atomic_ulong progress; /* grows while work makes progress */
    Crash crash;
    Channel channels[CHANNELS];
} Shared;

/* The process: answers requests until it is killed. The first, on channel 0, is rt_server_build.
 * RT_PROCESS_KEPT is a pipe that reads as ended once raytally has ended. */
_Noreturn void rt_server_run(Shared *shared, const RtSpec *spec, const RtScene *scene, int threads);

/* Sleeps while *word is `value`, for at most `milliseconds` (below 0: without limit). */
void rt_futex_wait(atomic_uint *word, unsigned value, int milliseconds);

/* Sets *word and wakes its waiters, which then see everything written before. */
void rt_futex_set(atomic_uint *word, unsigned value);

/* ---- requests on channel 0 ---- */

RtRemoteWork rt_server_validate, rt_server_check, rt_server_destroy; /* no message */
RtRemoteWork rt_server_open;                                         /* message: uint32_t, the channel */

typedef struct Built {
    uint32_t exact, absolute, counts; /* 0 or 1 */
    double seconds;
    RtDescription description;
} Built;
RtRemoteWork rt_server_build; /* message: Built */

/* Boxes number first, first + 1, ... of the structure, as many as fit. */
enum { MOST_BOXES = 8000, MOST_DEPTH = 10000 };
typedef struct Boxes {
    uint64_t first, seen; /* seen: all boxes, out */
    uint32_t count;       /* out; fewer than MOST_BOXES: these are the last */
    struct {
        RtBox box;
        uint32_t depth, leaf; /* leaf: 0 or 1 */
    } boxes[MOST_BOXES];
} Boxes;
RtRemoteWork rt_server_boxes;

static inline bool rt_box_can_be_shown(const RtBox *box, uint32_t depth) {
    return rt_finite(box->lo) && rt_finite(box->hi) && depth <= MOST_DEPTH;
}

/* ---- requests on channels of queries ---- */

/* A stream of rays. */
typedef struct Stream {
    uint32_t count;
    bool any, counted;
    RtTally tallies[RT_RAY_KIND_COUNT]; /* out: to be added */
    union {
        RtHit hits[RT_REMOTE_RAYS];         /* [count] out, if not `any` */
        uint32_t occluders[RT_REMOTE_RAYS]; /* [count] out, if `any` */
    };
} Stream;
RtRemoteWork rt_server_trace;

/* The ray's events number first, first + 1, ..., as many as fit (core/base/observe.h). */
enum { MOST_EVENTS = 1024 };
typedef struct Event {
    uint32_t kind, index;
    float t;
    uint32_t leaf, empty, met, boxed, round, in_tree; /* 0 or 1 */
    RtBox box;                                        /* if boxed */
    RtBall ball;                                      /* if round */
    char what[RT_MAX_NAME];                           /* "": nothing */
} Event;

typedef struct Events {
    uint64_t first, seen; /* seen: all events of the ray, out */
    uint32_t any, count;  /* count: out; fewer than MOST_EVENTS: these are the last */
    Event events[MOST_EVENTS];
} Events;
RtRemoteWork rt_server_events;

_Static_assert(sizeof(Boxes) <= RT_REMOTE_BYTES && sizeof(Events) <= RT_REMOTE_BYTES &&
                   sizeof(Stream) <= RT_REMOTE_BYTES,
               "messages fit a channel");

/* ---- in the process: host.c ---- */

/* The operations of a plugin's table; the registry holds pointers to the first member. */
typedef struct RtPluginOps {
    RtAccelOps ops;
    RtParam params[RAYTALLY_MAX_PARAMS];
    const char *path;         /* of the library */
    uint64_t fingerprint;     /* of its bytes when it was loaded */
    uint32_t place;           /* of the table in the library */
    raytally_accel_ops table; /* once rt_plugin_enter has opened the library here */
} RtPluginOps;

/* Fills the operations and parameters from a checked table, whose text must stay valid. */
void rt_plugin_ops_init(RtPluginOps *ops, const raytally_accel_ops *table);

/* ---- what a query is doing, for reports of crashes ---- */

typedef struct RtPluginNow {
    raytally_query face; /* the plugin's; its ray is the last that it prepared, or NULL */
    const RtRay *stream; /* NULL: idle */
    /* The plugin's memory and, from `middle` on, its answers, between guard pages, where an access crashes.
     */
    char *mapping, *middle;
    size_t mapped; /* bytes of all that */
} RtPluginNow;

/* Of the calling thread, or of any that traces; NULL if it, or none, does. Safe in signal handlers. */
const RtPluginNow *rt_plugin_now(bool any_thread);

#endif
