/* SPDX-License-Identifier: Apache-2.0 */
/* The inside of item: its data, shared by the files of this folder.
 *
 * A sample of the image says which object is seen there, and from which t on any other object may be:
 *
 *     id      the object that is nearest, RT_NO_OBJECT where there is none, or RT_ITEM_UNDECIDED
 *     other   no object but `id` is hit by exactly the ray of this sample at a t below `other`; INFINITY
 * where no other is hit at all. A tie counts as below, unless `id` is the lesser id and wins it.
 *
 * Layout: samples row after row from the upper left, as the sources of primary rays count them.
 *
 * Invariant: `other` is what it says. That `id` is right need not be known: its hit function is asked. The
 * invariant rests on two facts that footprint.c shows, whatever the rounding: a footprint holds every sample
 * whose ray can hit the object, and a span begins at no later a t than such a hit. */
#ifndef RT_ACCEL_ITEM_ITEM_H
#define RT_ACCEL_ITEM_ITEM_H

#include "accel/accel.h"

enum { RT_ITEM_SETTLE, RT_ITEM_PARAM_COUNT };
extern const RtParam rt_item_params[RT_ITEM_PARAM_COUNT];

#define RT_ITEM_UNDECIDED (UINT32_MAX - 1)

typedef struct RtItemSample {
    uint32_t id;
    float other;
} RtItemSample;

typedef struct RtItemBuffer {
    RtAccel base;
    RtView view;
    bool settle;
    RtItemSample *samples; /* [rows * columns] */
    /* For projecting: q . across and q . downward, over q . forward, are the position of q in the image,
     * -1..1. */
    RtVec3d across, downward;
    double longest; /* |dir| of all rays is below this */
    double blur;    /* by how much directions, rounded to float32, are off, as a part of 1 */
} RtItemBuffer;

static inline size_t rt_item_sample_count(const RtItemBuffer *buffer) {
    return (size_t)buffer->view.sampling.columns * buffer->view.sampling.rows;
}

/* footprint.c */

/* Fills what is for projecting; `view` is there. */
void rt_item_aim(RtItemBuffer *buffer);

/* Samples lo[0]..hi[0] of rows lo[1]..hi[1]; no ray hits the object at a t below `near`. */
typedef struct RtItemFootprint {
    uint32_t lo[2], hi[2];
    float near;
} RtItemFootprint;

/* The samples whose rays may hit an object, from its box; false if there are none. */
bool rt_item_footprint(const RtItemBuffer *buffer, uint32_t id, RtItemFootprint *footprint);

/* facet.c */

#define RT_ITEM_MAX_EDGES 16

/* A flat convex object for scan conversion. Vectors are relative to the eye. */
typedef struct RtItemFacet {
    uint32_t count;
    RtVec3d edges[RT_ITEM_MAX_EDGES];   /* normals of the planes through eye and edge, towards the inside */
    double slack[RT_ITEM_MAX_EDGES];    /* error of dir . edge, times t: the hit function's */
    double rounding[RT_ITEM_MAX_EDGES]; /* error of dir . edge: our own */
    RtVec3d normal;
    double height;                             /* normal . any vertex */
    double slop, height_error, approach_error; /* of normal . point of a hit, height, normal . dir */
} RtItemFacet;

/* False for what is not flat, not convex, or has too many edges. */
bool rt_item_facet(const RtItemBuffer *buffer, uint32_t id, RtItemFacet *facet);

/* Where along a ray an object is hit, if it is: at lo <= t <= hi. Exactly known where lo = hi. */
typedef struct RtItemSpan {
    float lo, hi;
    bool certain; /* that it is hit */
} RtItemSpan;

/* False if the ray certainly misses the facet, of whose footprint it is; else *span. */
bool rt_item_cross(const RtItemFacet *facet, const RtRay *ray, float near, RtItemSpan *span);

/* build.c */
RtStatus rt_item_build(const RtBuild *what, RtAccel **out, RtError *error);
void rt_item_destroy(RtAccel *accel);

/* stats.c */
void rt_item_describe(const RtAccel *accel, RtDescription *out);
RtStatus rt_item_validate(const RtAccel *accel, RtError *error);

#endif
