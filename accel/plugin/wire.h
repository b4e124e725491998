/* SPDX-License-Identifier: Apache-2.0 */
/* Between raytally and the process in which an accelerator lives that it does not trust: what lies in the
 * memory that both share.
 *
 * The process is a fork, so it has the scene, the code, and every function at the same address. What it is
 * asked to do is therefore a function and a message: raytally writes both into a lane and sets `asked` to the
 * number of the request; over there the lane's thread runs the function on a copy of the message, writes that
 * back, and sets `answered` to the same number. Lane 0 is the process's main thread: it builds, looks after
 * the other lanes, and destroys. Each of the others belongs to one RtQuery.
 *
 * Invariant: a plugin may write anything here at any time. raytally copies what it reads, checks the copy,
 * and reads no bool, size or address from here; what it must know of a lane it keeps on its own side. */
#ifndef RT_ACCEL_PLUGIN_WIRE_H
#define RT_ACCEL_PLUGIN_WIRE_H

#include "accel/remote.h"

#include <stdatomic.h>

/* One more than there can be threads. The memory of those that nobody takes is never touched. */
enum { LANES = 1 + 1024, MESSAGE_BYTES = RT_AWAY_BYTES };

/* What is asked: of the accelerator, by the lane's query, which lane 0 has not. */
typedef RtRemoteWork WireWork;

typedef struct Lane {
    atomic_uint asked, answered; /* the number of the last request, and of the last answer */
    WireWork *work;              /* NULL: the lane is closed */
    size_t bytes;                /* of the message */
    bool begin;                  /* rt_query_begin comes first */
    _Alignas(64) char message[MESSAGE_BYTES];
} Lane;

/* How the process ended, as far as it could still say so. */
typedef struct Crash {
    atomic_int signal; /* 0: it said nothing */
    uint32_t has_ray;  /* 0 or 1 */
    uint32_t out_of;   /* 1 + the RtPluginGuard that was run into; 0: none */
    RtRay ray;         /* that was being traced */
} Crash;

typedef struct Wire {
    atomic_ulong beat; /* grows while work makes progress */
    Crash crash;
    Lane lanes[LANES];
} Wire;

/* What the process does: builds `spec` over `scene`, answers, and ends with it. RT_PROCESS_KEPT is a file
 * that reads as ended when raytally has. */
_Noreturn void rt_wire_serve(Wire *wire, const RtSpec *spec, const RtScene *scene, int threads);

/* Messages to lane 0. Its first request is to build; it needs no message. */
enum { WIRE_BUILD = 1 };
typedef struct WireBuilt {
    RtStatus status;
    RtError error;
    uint32_t exact, counts; /* 0 or 1 */
    double seconds;
    RtDescription description;
} WireBuilt;

typedef struct WireChecked {
    uint32_t lane, done; /* of rt_wire_open: a lane, and the number of its last request */
    RtStatus status;
    RtError error;
} WireChecked;

WireWork rt_wire_validate, rt_wire_show, rt_wire_check, rt_wire_open; /* of a WireChecked */
WireWork rt_wire_destroy;                                             /* of nothing; the process ends */

/* Boxes number first.. of the structure, as many as there is room for; from 0 on in a row. */
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
    uint32_t count;    /* out; fewer than WIRE_BOXES: the last */
    uint32_t complete; /* out: 1, there was memory for all of them, or 0 */
    WireBox boxes[WIRE_BOXES];
} WireBoxes;
WireWork rt_wire_boxes;

/* A stream of rays, and behind it in the message: the answers, as RtHit whatever was asked (of `any` the
 * object alone counts), and the rays. */
enum { WIRE_RAYS = 4096 };
typedef struct WireRays {
    uint32_t count;
    bool any, counted;
    RtTally tallies[RT_RAY_KIND_COUNT]; /* out: to be added */
    RtHit hits[];                       /* [count] out; then RtRay rays[count] */
} WireRays;

static inline RtRay *rt_wire_rays(WireRays *asked, uint32_t count) {
    return (RtRay *)(asked->hits + count);
}

static inline size_t rt_wire_rays_bytes(uint32_t count) {
    return sizeof(WireRays) + count * (sizeof(RtHit) + sizeof(RtRay));
}

WireWork rt_wire_trace;

_Static_assert(sizeof(WireBoxes) <= MESSAGE_BYTES &&
                   sizeof(WireRays) + WIRE_RAYS * (sizeof(RtHit) + sizeof(RtRay)) <= MESSAGE_BYTES,
               "it fits a lane");

#endif
