/* SPDX-License-Identifier: Apache-2.0 */
/* The memory that raytally shares with the process of a remote accelerator.
 *
 * The process is a fork, so it has the scene, the code, and every function at the same address. A request is
 * therefore a function, a message and rays: raytally writes them into a channel and sets `asked` to the
 * number of the request; in the process, the channel's thread runs the function on copies, writes the message
 * back, and sets `answered` to the same number. Channel 0 belongs to the main thread of the process: it
 * builds, opens the other channels, and destroys. Each other channel belongs to one RtQuery.
 *
 * Invariant: a plugin may write anything here at any time. raytally copies what it reads, checks the copy,
 * and reads no bool, size or address from here; what it must know of a channel it keeps in its own memory.
 *
 * Threads wait on words of this memory by futexes, not semaphores: an overwritten futex is only a number
 * nobody waits for, whereas the C library aborts on an invalid semaphore. */
#ifndef RT_ACCEL_PLUGIN_WIRE_H
#define RT_ACCEL_PLUGIN_WIRE_H

#include "accel/remote.h"
#include "core/shape/ball.h"

#include <errno.h>
#include <limits.h>
#include <linux/futex.h>
#include <stdatomic.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

/* One more than the most threads. The memory of unused channels is never touched. */
enum { CHANNELS = 1 + 1024, MESSAGE_BYTES = RT_REMOTE_BYTES + 1024 };

typedef struct Channel {
    atomic_uint asked, answered; /* number of the last request, and of the last answer */
    RtRemoteWork *work;          /* called with the channel's query, which channel 0 lacks; NULL: closes the
                                    channel */
    size_t bytes, rays;          /* of the message, and the number of rays after it */
    bool begin;                  /* rt_query_begin comes first */
    _Alignas(64) char message[MESSAGE_BYTES];
} Channel;

/* The rays after a message of so many bytes. */
static inline RtRay *rt_wire_rays(char *message, size_t bytes) {
    return (RtRay *)(message + (bytes + sizeof(RtHit) - 1) / sizeof(RtHit) * sizeof(RtHit));
}

enum { WIRE_RAYS = 4096 }; /* of a stream, at most */

/* What the process recorded of its own end. */
typedef struct Crash {
    atomic_int signal; /* 0: nothing */
    uint32_t out_of;   /* 1 + the guard pages that were hit (RT_GUARD_QUERY, ..); 0: none */
    /* The stream that was being traced. */
    uint32_t count;        /* 0: none */
    uint32_t ray;          /* index of the last one prepared; 0: perhaps none was prepared */
    uint32_t any, counted; /* which kernel; 0 or 1 */
    uint32_t layers;       /* of the stack, from the bottom to the plugin */
    uint32_t alone;        /* index of the last ray that rt_wire_trace_alone began */
    RtRay rays[WIRE_RAYS]; /* [count] */
} Crash;

typedef struct Wire {
    atomic_ulong progress; /* grows while work makes progress */
    Crash crash;
    Channel channels[CHANNELS];
} Wire;

/* Sleeps while *word is `value`, for at most `most` (NULL: without limit). True if the word may have changed;
 * false after a timeout or a signal. */
static inline bool rt_futex_wait(atomic_uint *word, unsigned value, const struct timespec *most) {
    return syscall(SYS_futex, word, FUTEX_WAIT, value, most, NULL, 0) == 0 || errno == EAGAIN;
}

/* Sets *word and wakes its waiters, which then see everything written before. */
static inline void rt_futex_set(atomic_uint *word, unsigned value) {
    atomic_store_explicit(word, value, memory_order_release);
    syscall(SYS_futex, word, FUTEX_WAKE, INT_MAX, NULL, NULL, 0);
}

/* The process: builds `spec` over `scene`, answers requests until the accelerator is destroyed, and waits to
 * be ended. RT_PROCESS_KEPT is a pipe that reads as ended once raytally has ended. */
_Noreturn void rt_wire_serve(Wire *wire, const RtSpec *spec, const RtScene *scene, int threads);

/* Messages of channel 0. Its first request, to build, has none. */
enum { WIRE_BUILD = 1 };
typedef struct WireBuilt {
    RtStatus status;
    RtError error;
    uint32_t exact, absolute, counts; /* 0 or 1 */
    double seconds;
    RtDescription description;
} WireBuilt;

typedef struct WireChecked {
    uint32_t channel, done; /* for rt_wire_open: a channel, and the number of its last request */
    RtStatus status;
    RtError error;
} WireChecked;

RtRemoteWork rt_wire_validate, rt_wire_show, rt_wire_check, rt_wire_open; /* message: WireChecked */
RtRemoteWork rt_wire_destroy;                                             /* no message; the last request */

/* Boxes number first, first + 1, ... of the structure, as many as fit; called in order from 0. */
enum { WIRE_BOXES = 4096, WIRE_DEPTH = 10000 };
typedef struct WireBox {
    RtBox box;
    uint32_t depth, leaf; /* leaf: 0 or 1 */
} WireBox;

static inline bool rt_wire_is_box(const RtBox *box, uint32_t depth) {
    return rt_finite(box->lo) && rt_finite(box->hi) && depth <= WIRE_DEPTH;
}

typedef struct WireBoxes {
    uint64_t first;
    uint32_t count;    /* out; fewer than WIRE_BOXES: these are the last */
    uint32_t complete; /* out: 1 if memory sufficed for all of them, else 0 */
    WireBox boxes[WIRE_BOXES];
} WireBoxes;
RtRemoteWork rt_wire_boxes;

/* A stream of rays. The answers are hits: an occluder is a hit at tmin. */
typedef struct WireRays {
    uint32_t count;
    bool any, counted;
    RtTally tallies[RT_RAY_KIND_COUNT]; /* out: to be added */
    RtHit hits[];                       /* [count] out */
} WireRays;
RtRemoteWork rt_wire_trace;

/* Traces a ray for its events number first, first + 1, ..., as many as fit (core/base/observe.h). */
enum { WIRE_EVENTS = 1024 };
typedef struct WireEvent {
    uint32_t kind, index;
    float t;
    uint32_t leaf, empty, met, boxed, round; /* 0 or 1 */
    RtBox box;                               /* if boxed */
    RtBall ball;                             /* if round */
    char what[RT_MAX_NAME];                  /* "": nothing */
} WireEvent;

typedef struct WireEvents {
    uint64_t first, seen; /* seen: all events of the ray, out */
    uint32_t any, count;  /* count: out; fewer than WIRE_EVENTS: these are the last */
    WireEvent events[WIRE_EVENTS];
} WireEvents;
RtRemoteWork rt_wire_events;

/* Reports an event that was sent, whatever it holds, to the observer of this thread. */
void rt_wire_observe(const WireEvent *sent);

/* Traces each ray of a stream in a call of its own, to find the one that fails. */
typedef struct WireAlone {
    uint32_t count, any, counted; /* as in Crash */
} WireAlone;
RtRemoteWork rt_wire_trace_alone;

_Static_assert(sizeof(WireBoxes) <= MESSAGE_BYTES &&
                   sizeof(WireEvents) + 2 * sizeof(RtRay) <= MESSAGE_BYTES &&
                   sizeof(WireRays) + WIRE_RAYS * (sizeof(RtHit) + sizeof(RtRay)) <= RT_REMOTE_BYTES,
               "messages fit a channel");

#endif
