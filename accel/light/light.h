/* SPDX-License-Identifier: Apache-2.0 */
/* The inside of light: its data, shared by the files of this folder, and the geometry of cells.
 *
 * Around each light stands a cube of six faces, one per axis and direction: face 2 a + 1 looks from the light
 * along +a, 2 a along -a. A point at offset v from the light belongs to the face of its largest |v.at[a]|,
 * its depth, and lies on it at u = v.at[b] / depth, w = v.at[c] / depth, both in [-1, 1], with b, c the axes
 * after a. A face has n x n cells of equal width in u and w.
 *
 * Layout: cells light after light, face after face, row after row, u fastest. The list of cell k is
 * entries[first[k]..first[k + 1]), ascending by (depth, id); objects that touch a light are in its near list
 * instead, near[near_first[light]..near_first[light + 1]), because they would be in all cells.
 *
 * Invariant: an object that can block a ray from inside `domain` to the light, of depth at most
 * covers[cell].depth, is in the near list or in the list of the ray's cell, with a depth not above that of
 * the ray. Why rounding does not break it stands in build.c. */
#ifndef RT_ACCEL_LIGHT_LIGHT_H
#define RT_ACCEL_LIGHT_LIGHT_H

#include "accel/accel.h"

#define RT_LIGHT_PARAMS(X)                                                                                   \
    X(RT_LIGHT_CELLS, "cells", RT_INT("64", 1, 4096, "1|7|256"),                                             \
      "cells along the edge of a face of the cube", "Haines & Greenberg 1986 use 20 to 200")                 \
    X(RT_LIGHT_FULL_OCCLUSION, "full_occlusion", RT_FLAG("on"),                                              \
      "end a list at the first object that covers the whole cell", "Haines & Greenberg 1986")                \
    X(RT_LIGHT_EXTENTS, "extents", RT_FLAG("on"),                                                            \
      "test the box of an object of a list, and the side of its plane, before the object", "this program")   \
    X(RT_LIGHT_CACHE, "cache", RT_FLAG("on"), "try the object that blocked the last ray in a cell first",    \
      "Haines & Greenberg 1986")

enum { RT_LIGHT_PARAMS(RT_PARAM_INDEX) RT_LIGHT_PARAM_COUNT };
extern const RtParam rt_light_params[RT_LIGHT_PARAM_COUNT];

/* An object of a list. No point of it that can be hit is less deep. */
typedef struct RtLightEntry {
    float depth;
    uint32_t id;
} RtLightEntry;

/* The object that hides whatever is deeper than `depth` in a cell: {INFINITY, RT_NO_OBJECT} for none. */
typedef RtLightEntry RtLightCover;

typedef struct RtLightBuffer {
    RtAccel base;
    uint32_t n; /* cells along the edge of a face */
    bool full_occlusion, extents, cache;
    RtBox domain;          /* where rays start that are answered; empty without objects */
    double *margin;        /* [lights] by which boxes grow: see build.c */
    uint32_t *first;       /* [cells + 1] */
    RtLightEntry *entries; /* [first[cells]] */
    RtLightCover *covers;  /* [cells], or NULL without full occlusion */
    uint32_t *near_first;  /* [lights + 1] */
    uint32_t *near;        /* [near_first[lights]] */
} RtLightBuffer;

/* What a query remembers of a cell: which of `entries` blocked the last ray, if `epoch` is the query's.
 * Scratch memory is [1 + cells] of them; that of a query's own epoch comes first. */
typedef struct RtLightMemory {
    uint32_t epoch, entry;
} RtLightMemory;

/* By how much cells grow in u and w on all sides: more than u can be wrong by where a ray is looked up. */
#define RT_LIGHT_EDGE 0x1p-20

static inline size_t rt_light_cell_count(const RtLightBuffer *buffer) {
    return (size_t)buffer->base.scene->light_count * 6 * buffer->n * buffer->n;
}

/* The first cell of a face. */
static inline size_t rt_light_face(const RtLightBuffer *buffer, uint32_t light, int face) {
    return ((size_t)light * 6 + (size_t)face) * buffer->n * buffer->n;
}

/* The column or row at u, clamped to those that exist. */
static inline uint32_t rt_light_column(const RtLightBuffer *buffer, double u) {
    double at = (u + 1) * 0.5 * buffer->n;
    if (!(at > 0)) return 0;
    return at < buffer->n ? (uint32_t)at : buffer->n - 1;
}

/* footprint.c */

/* The cells of a face that an object may be seen in from the light, columns lo[0]..hi[0] of rows
 * lo[1]..hi[1], and its least depth there, rounded down. */
typedef struct RtLightFootprint {
    uint32_t lo[2], hi[2];
    float depth;
} RtLightFootprint;

/* False if there are none. Not to be asked of objects that touch the light. */
bool rt_light_footprint(const RtLightBuffer *buffer, uint32_t light, int face, uint32_t id,
                        RtLightFootprint *footprint);

/* Does the object's box, grown by the margin, hold the light? */
bool rt_light_is_near(const RtLightBuffer *buffer, uint32_t light, uint32_t id);

/* May the object be seen in one cell of its footprint? True where in doubt. */
bool rt_light_touches(const RtLightBuffer *buffer, uint32_t light, int face, uint32_t id, uint32_t column,
                      uint32_t row);

/* Does the object hide all that is behind it in the closed cell? Then *depth is where it ends. An answer that
 * is wrong by rounding costs time only: see light.c. */
bool rt_light_covers(const RtLightBuffer *buffer, uint32_t light, int face, uint32_t id, uint32_t column,
                     uint32_t row, float *depth);

/* build.c */
RtStatus rt_light_build(const RtBuild *what, RtAccel **out, RtError *error);
void rt_light_destroy(RtAccel *accel);

/* Objects that have a footprint on a face, ascending by (depth, id), to order[0..object_count); gives their
 * number. */
uint32_t rt_light_order(const RtLightBuffer *buffer, uint32_t light, int face, RtLightEntry *order);

/* stats.c */
void rt_light_describe(const RtAccel *accel, RtDescription *out);
RtStatus rt_light_validate(const RtAccel *accel, RtError *error);

#endif
