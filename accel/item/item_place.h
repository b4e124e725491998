/* SPDX-License-Identifier: Apache-2.0 */
/* The tiles and the class of depth of triangles, sixteen at a time in float32. */
#ifndef RT_ACCEL_ITEM_ITEM_PLACE_H
#define RT_ACCEL_ITEM_ITEM_PLACE_H

#include "accel/item/item.h"
#include "accel/raster/lanes.h"

/* RtItemProjection in lanes. */
typedef struct LaneProjection {
    RtV16 eye[3], x[3], y[3], depth[3];
    RtV16 reach[2];     /* how far an error of 1 in a direction reaches, in samples */
    RtV16 last[2];      /* the last column and row */
    RtV16 nearer;       /* w may be larger by this part of |P| / depth */
    RtV16 most_oblique; /* |P| / depth, up to which a triangle is projected here */
} LaneProjection;

/* For triangles seen more obliquely, or behind the eye, their boxes are projected instead. */
#define MOST_OBLIQUE 256

RT_KERNEL void make_lane_projection(LaneProjection *to, const RtItemBuffer *buffer) {
    const RtItemProjection *from = &buffer->projection;
    const RtSampling *s = &buffer->view.sampling;
    for (int a = 0; a < 3; a++) {
        to->eye[a] = rt_v16_all((float)buffer->view.eye.at[a]);
        to->x[a] = rt_v16_all((float)from->x.at[a]);
        to->y[a] = rt_v16_all((float)from->y.at[a]);
        to->depth[a] = rt_v16_all((float)from->depth.at[a]);
    }
    to->reach[0] = rt_v16_all((float)((from->scale[0] + s->columns) * from->longest));
    to->reach[1] = rt_v16_all((float)((from->scale[1] + s->rows) * from->longest));
    to->last[0] = rt_v16_all((float)(s->columns - 1));
    to->last[1] = rt_v16_all((float)(s->rows - 1));
    to->nearer = rt_v16_all((float)(0x1p-16 * from->longest));
    to->most_oblique = rt_v16_all(from->direction_error <= RT_ITEM_MAX_DIRECTION_ERROR ? MOST_OBLIQUE : -1);
}

RT_KERNEL RtV16 dot16(const RtV16 a[3], const RtV16 b[3]) {
    return rt_v16_add(rt_v16_add(rt_v16_mul(a[0], b[0]), rt_v16_mul(a[1], b[1])), rt_v16_mul(a[2], b[2]));
}

/* Columns and rows of sixteen triangles, whole numbers, and the largest w of each; bit i where they are
 * known. With |q| the sum of its coordinates, P is off by 2^-21 of `reach` times |q|, in samples by as much
 * of |q| / depth, and by 2^-22 of the square of that for the error of the depth; the error of a hit function
 * moves it by less than 2^-18 of it. */
typedef struct Bounds {
    RtV16 lo[2], hi[2], most;
    uint32_t known, behind; /* the eye: never seen */
} Bounds;

RT_KERNEL void bound(const LaneProjection *l, RtV16 v[3][3], Bounds *b) {
    const RtV16 zero = rt_v16_all(0), most = rt_v16_all(INFINITY), least = rt_v16_all(-INFINITY);
    RtV16 oblique = zero;
    *b = (Bounds){{most, most}, {least, least}, least, 0xffff, 0xffff};
    for (int i = 0; i < 3; i++) {
        RtV16 q[3], at[2];
        for (int a = 0; a < 3; a++) q[a] = rt_v16_sub(v[i][a], l->eye[a]);
        RtV16 depth = dot16(l->depth, q), w = rt_v16_div(rt_v16_all(1), depth);
        RtV16 size = rt_v16_add(rt_v16_add(rt_v16_abs(q[0]), rt_v16_abs(q[1])), rt_v16_abs(q[2]));
        at[0] = rt_v16_mul(dot16(l->x, q), w);
        at[1] = rt_v16_mul(dot16(l->y, q), w);
        b->behind &= rt_v16_at_most(depth, rt_v16_mul(size, rt_v16_all(-0x1p-10f)));
        size = rt_v16_mul(size, w);
        b->known &= rt_v16_at_most(zero, size) & rt_v16_at_most(size, l->most_oblique);
        oblique = rt_v16_max(oblique, size);
        for (int a = 0; a < 2; a++) {
            b->lo[a] = rt_v16_min(b->lo[a], at[a]);
            b->hi[a] = rt_v16_max(b->hi[a], at[a]);
        }
        b->most = rt_v16_max(b->most, w);
    }
    RtV16 more = rt_v16_add(rt_v16_all(1), rt_v16_mul(oblique, l->nearer));
    b->most = rt_v16_mul(b->most, more);
    RtV16 part =
        rt_v16_mul(rt_v16_add(rt_v16_all(0x1p-17f), rt_v16_mul(oblique, rt_v16_all(0x1p-20f))), oblique);
    for (int a = 0; a < 2; a++) {
        RtV16 pad = rt_v16_mul(l->reach[a], part);
        b->lo[a] = rt_v16_max(rt_v16_ceil(rt_v16_sub(b->lo[a], pad)), zero);
        b->hi[a] = rt_v16_min(rt_v16_floor(rt_v16_add(b->hi[a], pad)), l->last[a]);
    }
}

RT_KERNEL void put_classes(const Bounds *b, const float *nearer, int32_t class[RT_ITEM_FACETS]) {
    const RtV16 zero = rt_v16_all(0), one = rt_v16_all(1);
    RtV16 sum = zero;
    for (int i = 0; i < RT_ITEM_CLASSES - 1; i++)
        sum = rt_v16_add(sum, rt_v16_pick(rt_v16_below(b->most, rt_v16_all(nearer[i])), zero, one));
    rt_v16_truncate(class, sum);
}

static uint32_t place(const void *view, uint32_t first, uint32_t count, RtTileRange *to) {
    const RtItemPlacing *placing = view;
    const RtItemBuffer *buffer = placing->buffer;
    const RtGeometry *g = rt_item_geometry(buffer);
    _Alignas(64) int32_t lo[2][RT_ITEM_FACETS], hi[2][RT_ITEM_FACETS], class[RT_ITEM_FACETS];
    LaneProjection projection;
    uint32_t placed = 0;
    make_lane_projection(&projection, buffer);
    for (const uint32_t end = first + count; first < end; first += RT_ITEM_FACETS) {
        RtV16 v[3][3];
        Bounds b;
        rt_raster_gather_row(g, first, end - first, v);
        bound(&projection, v, &b);
        uint32_t there = rt_raster_first_lanes(end - first), seen = there & b.known;
        for (int a = 0; a < 2; a++) {
            seen &= rt_v16_at_most(b.lo[a], b.hi[a]);
            rt_v16_truncate(lo[a], b.lo[a]);
            rt_v16_truncate(hi[a], b.hi[a]);
        }
        if (seen) put_classes(&b, placing->nearer, class);
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
