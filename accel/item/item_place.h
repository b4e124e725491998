/* SPDX-License-Identifier: Apache-2.0 */
/* The tiles and the class of depth of triangles, RT_LANES at a time in float32. */
#ifndef RT_ACCEL_ITEM_ITEM_PLACE_H
#define RT_ACCEL_ITEM_ITEM_PLACE_H

#include "accel/item/item.h"
#include "accel/raster/lanes.h"

/* RtItemProjection in lanes. */
typedef struct LaneProjection {
    RtFloats eye[3], x[3], y[3], depth[3];
    RtFloats reach[2];     /* how far an error of 1 in a direction reaches, in samples */
    RtFloats last[2];      /* the last column and row */
    RtFloats nearer;       /* w may be larger by this part of |P| / depth */
    RtFloats most_oblique; /* |P| / depth, up to which a triangle is projected here */
} LaneProjection;

/* For triangles seen more obliquely, or behind the eye, their boxes are projected instead. */
#define MOST_OBLIQUE 256

RT_KERNEL void make_lane_projection(LaneProjection *to, const RtItemBuffer *buffer) {
    const RtItemProjection *from = &buffer->projection;
    const RtSampling *s = &buffer->view.sampling;
    for (int a = 0; a < 3; a++) {
        to->eye[a] = rt_all((float)buffer->view.eye.at[a]);
        to->x[a] = rt_all((float)from->x.at[a]);
        to->y[a] = rt_all((float)from->y.at[a]);
        to->depth[a] = rt_all((float)from->depth.at[a]);
    }
    to->reach[0] = rt_all((float)((from->scale[0] + s->columns) * from->longest));
    to->reach[1] = rt_all((float)((from->scale[1] + s->rows) * from->longest));
    to->last[0] = rt_all((float)(s->columns - 1));
    to->last[1] = rt_all((float)(s->rows - 1));
    to->nearer = rt_all((float)(0x1p-16 * from->longest));
    to->most_oblique = rt_all(from->direction_error <= RT_ITEM_MAX_DIRECTION_ERROR ? MOST_OBLIQUE : -1);
}

RT_KERNEL RtFloats dot_floats(const RtFloats a[3], const RtFloats b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Columns and rows of triangles, whole numbers, and the largest w of each; bit i where they are
 * known. With |q| the sum of its coordinates, P is off by 2^-21 of `reach` times |q|, in samples by as much
 * of |q| / depth, and by 2^-22 of the square of that for the error of the depth; the error of a hit function
 * moves it by less than 2^-18 of it. */
typedef struct Bounds {
    RtFloats lo[2], hi[2], most;
    RtFloats at[3][2], pad[2]; /* where vertices are seen, and how far from their hull a hit may be */
    uint32_t known, behind;    /* the eye: never seen */
} Bounds;

RT_KERNEL void bound(const LaneProjection *l, RtFloats v[3][3], Bounds *b) {
    const RtFloats zero = rt_all(0), most = rt_all(INFINITY), least = rt_all(-INFINITY);
    RtFloats oblique = zero;
    *b = (Bounds){.lo = {most, most}, .hi = {least, least}, .most = least, .known = ~0u, .behind = ~0u};
    for (int i = 0; i < 3; i++) {
        RtFloats q[3], *at = b->at[i];
        for (int a = 0; a < 3; a++) q[a] = v[i][a] - l->eye[a];
        RtFloats depth = dot_floats(l->depth, q), w = 1 / depth;
        RtFloats size = rt_abs(q[0]) + rt_abs(q[1]) + rt_abs(q[2]);
        at[0] = dot_floats(l->x, q) * w;
        at[1] = dot_floats(l->y, q) * w;
        b->behind &= rt_le_bits(depth, size * -0x1p-10f);
        size = size * w;
        b->known &= rt_bits((size >= 0) & (size <= l->most_oblique));
        oblique = rt_max(oblique, size);
        for (int a = 0; a < 2; a++) {
            b->lo[a] = rt_min(b->lo[a], at[a]);
            b->hi[a] = rt_max(b->hi[a], at[a]);
        }
        b->most = rt_max(b->most, w);
    }
    b->most = b->most * (1 + oblique * l->nearer);
    RtFloats part = (0x1p-17f + oblique * 0x1p-20f) * oblique;
    for (int a = 0; a < 2; a++) {
        b->pad[a] = l->reach[a] * part;
        b->lo[a] = rt_max(rt_ceil(b->lo[a] - b->pad[a]), zero);
        b->hi[a] = rt_min(rt_floor(b->hi[a] + b->pad[a]), l->last[a]);
    }
}

/* The triangles that may hold a sample: those seen at more than two columns or rows, and of the others those
 * whose hull, as far as a hit may be from it, holds one. Edges are rounded by less than a tenth of `margin`.
 * A triangle turned the wrong way by rounding is as thin as that. */
RT_KERNEL uint32_t holding_samples(const Bounds *b) {
    RtFloats along[3][2], margin[3];
    uint32_t some = rt_bits((b->hi[0] - b->lo[0] > 1) | (b->hi[1] - b->lo[1] > 1));
    for (int i = 0; i < 3; i++) {
        for (int a = 0; a < 2; a++) along[i][a] = b->at[(i + 1) % 3][a] - b->at[i][a];
        margin[i] = (rt_abs(along[i][0]) * b->pad[1] + rt_abs(along[i][1]) * b->pad[0]) * -1.25f;
    }
    RtFloats area = along[0][0] * along[1][1] - along[0][1] * along[1][0];
    RtFloats turn = rt_select(area < 0, rt_all(-1), rt_all(1));
    for (int k = 0; k < 4; k++) {
        RtFloats column = k & 1 ? b->hi[0] : b->lo[0], row = k & 2 ? b->hi[1] : b->lo[1];
        uint32_t out = 0;
        for (int i = 0; i < 3; i++) {
            RtFloats edge = along[i][0] * (row - b->at[i][1]) - along[i][1] * (column - b->at[i][0]);
            out |= rt_lt_bits(edge * turn, margin[i]);
        }
        some |= ~out;
    }
    return some;
}

RT_KERNEL RtInts classes_of(const Bounds *b, const float *nearer) {
    RtInts class = rt_all_ints(0);
    for (int i = 0; i < RT_ITEM_CLASSES - 1; i++) class -= b->most < nearer[i];
    return class;
}

static uint32_t place(const void *view, uint32_t first, uint32_t count, RtTileRange *to) {
    const RtItemPlacing *placing = view;
    const RtItemBuffer *buffer = placing->buffer;
    const RtGeometry *g = rt_item_geometry(buffer);
    int32_t lo[2][RT_LANES], hi[2][RT_LANES], class[RT_LANES];
    LaneProjection projection;
    uint32_t placed = 0;
    make_lane_projection(&projection, buffer);
    for (const uint32_t end = first + count; first < end; first += RT_LANES) {
        RtFloats v[3][3];
        Bounds b;
        rt_raster_gather_row(g, first, end - first, v);
        bound(&projection, v, &b);
        uint32_t there = rt_raster_first_lanes(end - first), seen = there & b.known;
        for (int a = 0; a < 2; a++) {
            seen &= rt_le_bits(b.lo[a], b.hi[a]);
            rt_store(lo[a], rt_to_ints(b.lo[a]));
            rt_store(hi[a], rt_to_ints(b.hi[a]));
        }
        if (seen) seen &= holding_samples(&b);
        if (seen) rt_store(class, classes_of(&b, placing->nearer));
        for (; seen; seen &= seen - 1) {
            uint32_t k = (uint32_t)__builtin_ctz(seen);
            RtTileRange *range = &to[placed++];
            range->object = rt_ref(RT_SHAPE_TRIANGLE, first + k);
            range->layer = (uint16_t) class[k];
            for (int a = 0; a < 2; a++) {
                range->lo[a] = (uint16_t)((uint32_t)lo[a][k] / RT_ITEM_TILE);
                range->hi[a] = (uint16_t)((uint32_t)hi[a][k] / RT_ITEM_TILE);
            }
        }
        for (there &= ~(b.known | b.behind); there; there &= there - 1) {
            uint32_t id = g->triangle_ids[first + (uint32_t)__builtin_ctz(there)];
            placed += rt_item_place_footprint(buffer, id, RT_TILE_APART, &to[placed]);
        }
    }
    return placed;
}

#endif
