/* SPDX-License-Identifier: Apache-2.0 */
/* The path of one ray through an accelerator: every step, extent test and object test, in order. */
#ifndef RT_RENDER_PATH_H
#define RT_RENDER_PATH_H

#include "accel/accel.h"
#include "core/base/observe.h"
#include "core/shape/ball.h"

/* A row of the path. An object test and its hit are one row. */
typedef struct RtPathRow {
    RtTracedKind kind; /* never RT_TRACED_OBJECT_HIT */
    const char *what;  /* as in RtTraced; "object" for object tests */
    uint32_t index;    /* as in RtTraced */
    bool leaf, empty;  /* of a step */
    bool met;          /* extent test: the ray may find something there; object test: it is hit, at `t` */
    float t;
    bool boxed; /* there is a box, and the thin ray is in it from `enter` to `leave`: not, if enter > leave */
    bool round; /* it is the box of a ball, and it is the ball that the ray is in */
    RtBox box;
    RtBall ball;
    double enter, leave; /* t, within tmin..tmax */
    float nearest;       /* t of the nearest hit so far, this row's included; INFINITY while there is none */
} RtPathRow;

/* Owned; free with rt_path_clear. */
typedef struct RtPath {
    RtRay ray;
    bool any;      /* it was asked whether anything is hit, as of shadow rays, not what is nearest */
    RtHit hit;     /* of `any`: t is that of the occluder, if one was named */
    RtTally tally; /* sums over the rows; `rays` and `hits` are the kernel's own */
    RtPathRow *rows;
    uint32_t count, capacity;
} RtPath;

/* Traces a valid ray by a counted kernel: `occluded` if it is a shadow ray, else `nearest`. What recorded
 * answers are for (rt_accel_learn) is handed the ray's own. RT_MISMATCH if the events do not add up to what
 * the kernel counted, which would be a bug of this program. */
RtStatus rt_path_trace(RtPath *path, RtAccel *accel, const RtRay *ray, RtError *error);
void rt_path_clear(RtPath *path);

/* "step", "leaf", "extent test", ... */
const char *rt_path_row_name(const RtPathRow *row);

/* How many rows from `first` on may be shown as one: four or more object tests in a row that all missed;
 * else 1. */
uint32_t rt_path_run(const RtPath *path, uint32_t first);

/* Follows the primary ray of sample (column, row) to the ray of another kind that starts where it hits: to
 * light `light` for shadow rays. RT_BAD_INPUT, and why, where there is none. */
RtStatus rt_path_ray(const RtAccel *accel, RtRayKind kind, uint32_t column, uint32_t row, uint32_t light,
                     RtRay *ray, RtError *error);

#endif
