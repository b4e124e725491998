/* SPDX-License-Identifier: Apache-2.0 */
/* The path of one ray through an accelerator: every step, extent test and object test, in order. */
#ifndef RT_RENDER_PATH_H
#define RT_RENDER_PATH_H

#include "accel/accel.h"
#include "core/base/observe.h"
#include "core/shape/shape.h"

/* What rows are about: the scene, or the part of an instance that the ray entered. */
typedef struct RtPathPlace {
    RtRay ray;            /* moved into the part: t stays what it is */
    const RtScene *scene; /* the part; borrowed */
    RtTransform to_world;
    uint32_t part;  /* its index in the scene */
    uint32_t first; /* the id in the whole scene of object 0 there */
    uint32_t level; /* instances around it; 0: the scene */
    uint32_t test;  /* the row of the instance's object test, outside */
} RtPathPlace;

/* A row of the path. An object test and its hit are one row; that of a CSG tree follows the rows of its
 * parts. */
typedef struct RtPathRow {
    RtTracedKind kind;      /* never RT_TRACED_OBJECT_HIT, RT_TRACED_LEFT */
    uint32_t place;         /* index in path->places, of whose scene `index` and `box` are; "entered" is the
                             * first row there, and its index the part */
    uint32_t level;         /* of the place */
    char what[RT_MAX_NAME]; /* as in RtTraced; "object" or "instance" for object tests; "": nothing */
    uint32_t index;         /* as in RtTraced */
    bool object, instance;  /* `index` is that of an object; and that is an instance */
    bool leaf, empty;       /* of a step */
    bool met;               /* extent test: something may be found there; object test: it is hit, at `t` */
    float t;
    bool boxed; /* there is a box, and the exact ray is in it from `enter` to `leave`, or misses it if
                 * enter > leave */
    bool round; /* the box is that of `ball`; enter and leave are for the ball */
    RtBox box;
    RtBall ball;
    double enter, leave; /* t, within tmin..tmax */
    bool listed;         /* csg test or result: its intervals are known, path->ends[first_end..+end_count) */
    uint32_t first_end, end_count;
    float nearest; /* t of the nearest hit so far, including this row; INFINITY if there is none */
} RtPathRow;

/* Owned; free with rt_path_clear. */
typedef struct RtPath {
    RtRay ray;
    const RtAccel *accel; /* borrowed */
    bool any;             /* traced for any hit, like shadow rays, not for the nearest */
    RtHit hit;            /* for `any`, t is that of the occluder if one was named */
    RtTally tally;        /* sums over the rows, except `rays` and `hits`, from the kernel */
    RtPathRow *rows;
    uint32_t count, capacity;
    RtPathPlace *places; /* the scene first */
    uint32_t place_count, place_capacity;
    float *ends; /* t where the ray's line enters and leaves, alternately, a solid or a part of a CSG tree */
    uint32_t end_count, end_capacity;
} RtPath;

/* RT_OK, or RT_BAD_INPUT if paths through the accelerator of `spec` cannot be traced: a plugin must be exact
 * and count. */
RtStatus rt_path_available(const RtAccel *accel, const char *spec, RtError *error);

/* Traces a valid ray with a counted kernel: `occluded` for a shadow ray, else `nearest`. An accelerator
 * that learns (rt_accel_learn) learns the ray's own hit first. Which steps of a remote accelerator were
 * leaves may be unknown. RT_MISMATCH if the events do not add up to
 * the kernel's counts, which would be a bug in this program. */
RtStatus rt_path_trace(RtPath *path, RtAccel *accel, const RtRay *ray, RtError *error);
void rt_path_clear(RtPath *path);

/* For people: of an object in a part its id in the whole scene, of an instance its number in its scene. */
uint32_t rt_path_row_index(const RtPath *path, const RtPathRow *row);

/* Whether `met` is known: not of other events, nor of an extent test that a plugin did not show. */
bool rt_path_row_answers(const RtPathRow *row);

/* The number of intervals of t in which the ray is inside, and the ends of interval `i`: of a csg test or
 * result those of the solid or part, unclipped; else that of the box, if the ray meets it. */
uint32_t rt_path_row_spans(const RtPathRow *row);
void rt_path_row_span(const RtPath *path, const RtPathRow *row, uint32_t i, double *enter, double *leave);

/* "step", "leaf", "extent test", ... */
const char *rt_path_row_name(const RtPathRow *row);

/* The number of rows from `first` on to display as one: four or more consecutive object tests that missed;
 * else 1. */
uint32_t rt_path_run(const RtPath *path, uint32_t first);

/* The ray of another kind that starts where the primary ray of sample (column, row) hits; a shadow ray
 * goes to light `light`. RT_BAD_INPUT, with the reason, if there is none. */
RtStatus rt_path_ray(const RtAccel *accel, RtRayKind kind, uint32_t column, uint32_t row, uint32_t light,
                     RtRay *ray, RtError *error);

#endif
