/* SPDX-License-Identifier: Apache-2.0 */
/* Where triangles are, sixteen at a time: the tiles that each may be seen in, and its class of depth. Nothing
 * is missed: raster.h says why. */
#ifndef RT_ACCEL_ITEM_PLACE_H
#define RT_ACCEL_ITEM_PLACE_H

#include "accel/item/raster.h"
#include "accel/pairs.h"

/* RtItemAim in float32, in lanes, for placing. */
typedef struct Lens {
    RtV16 eye[3], x[3], y[3], depth[3];
    RtV16 reach[2];     /* how far an error of 1 in a direction reaches, in samples */
    RtV16 last[2];      /* the last column and row */
    RtV16 nearer;       /* w may be larger by this part of |P| / depth */
    RtV16 most_oblique; /* |P| / depth, up to which a triangle is placed here */
} Lens;

/* Beyond, or behind the eye, boxes are projected instead. */
#define MOST_OBLIQUE 256

RT_KERNEL void make_lens(Lens *lens, const RtItemBuffer *buffer) {
    const RtItemAim *aim = &buffer->aim;
    const RtSampling *s = &buffer->view.sampling;
    for (int a = 0; a < 3; a++) {
        lens->eye[a] = rt_v16_all((float)buffer->view.eye.at[a]);
        lens->x[a] = rt_v16_all((float)aim->x.at[a]);
        lens->y[a] = rt_v16_all((float)aim->y.at[a]);
        lens->depth[a] = rt_v16_all((float)aim->depth.at[a]);
    }
    lens->reach[0] = rt_v16_all((float)((aim->scale[0] + s->columns) * aim->longest));
    lens->reach[1] = rt_v16_all((float)((aim->scale[1] + s->rows) * aim->longest));
    lens->last[0] = rt_v16_all((float)(s->columns - 1));
    lens->last[1] = rt_v16_all((float)(s->rows - 1));
    lens->nearer = rt_v16_all((float)(0x1p-16 * aim->longest));
    lens->most_oblique = rt_v16_all(aim->blur <= RT_ITEM_MOST_BLUR ? MOST_OBLIQUE : -1);
}

RT_KERNEL RtV16 dot16(const RtV16 a[3], const RtV16 b[3]) {
    return rt_v16_add(rt_v16_add(rt_v16_mul(a[0], b[0]), rt_v16_mul(a[1], b[1])), rt_v16_mul(a[2], b[2]));
}

/* Columns and rows of sixteen triangles, whole numbers, and the largest w of each; bit i where they are
 * known. With |q| the sum of its coordinates, P is wrong by 2^-21 of `reach` times |q|, in samples by as much
 * of |q| / depth, and by 2^-22 of the square of that for the error of the depth; and what a hit function is
 * off by moves it by less than 2^-18 of it. */
typedef struct Bounds {
    RtV16 lo[2], hi[2], most;
    uint32_t known, behind; /* the eye: never seen */
} Bounds;

RT_KERNEL void bound(const Lens *lens, RtV16 v[3][3], Bounds *b) {
    const RtV16 zero = rt_v16_all(0);
    RtV16 oblique = zero;
    b->known = b->behind = 0xffff;
    for (int i = 0; i < 3; i++) {
        RtV16 q[3];
        for (int a = 0; a < 3; a++) q[a] = rt_v16_sub(v[i][a], lens->eye[a]);
        RtV16 depth = dot16(lens->depth, q), w = rt_v16_div(rt_v16_all(1), depth);
        RtV16 size = rt_v16_add(rt_v16_add(rt_v16_abs(q[0]), rt_v16_abs(q[1])), rt_v16_abs(q[2]));
        RtV16 column = rt_v16_mul(dot16(lens->x, q), w), row = rt_v16_mul(dot16(lens->y, q), w);
        b->behind &= rt_v16_at_most(depth, rt_v16_mul(size, rt_v16_all(-0x1p-10f)));
        size = rt_v16_mul(size, w);
        b->known &= rt_v16_at_most(zero, size) & rt_v16_at_most(size, lens->most_oblique);
        oblique = rt_v16_max(oblique, size);
        b->lo[0] = i == 0 ? column : rt_v16_min(b->lo[0], column);
        b->hi[0] = i == 0 ? column : rt_v16_max(b->hi[0], column);
        b->lo[1] = i == 0 ? row : rt_v16_min(b->lo[1], row);
        b->hi[1] = i == 0 ? row : rt_v16_max(b->hi[1], row);
        b->most = i == 0 ? w : rt_v16_max(b->most, w);
    }
    RtV16 more = rt_v16_add(rt_v16_all(1), rt_v16_mul(oblique, lens->nearer));
    b->most = rt_v16_mul(b->most, more);
    RtV16 part =
        rt_v16_mul(rt_v16_add(rt_v16_all(0x1p-17f), rt_v16_mul(oblique, rt_v16_all(0x1p-20f))), oblique);
    for (int i = 0; i < 2; i++) {
        RtV16 pad = rt_v16_mul(lens->reach[i], part);
        b->lo[i] = rt_v16_max(rt_v16_ceil(rt_v16_sub(b->lo[i], pad)), zero);
        b->hi[i] = rt_v16_min(rt_v16_floor(rt_v16_add(b->hi[i], pad)), lens->last[i]);
    }
}

RT_KERNEL void put_classes(const Bounds *b, const float *nearer, int32_t class[RT_ITEM_FACETS]) {
    const RtV16 zero = rt_v16_all(0), one = rt_v16_all(1);
    RtV16 sum = zero;
    for (int i = 0; i < RT_ITEM_CLASSES - 1; i++)
        sum = rt_v16_add(sum, rt_v16_pick(rt_v16_below(b->most, rt_v16_all(nearer[i])), zero, one));
    rt_v16_truncate(class, sum);
}

static void place(const RtItemBuffer *buffer, uint32_t first, uint32_t count, const float *nearer,
                  RtItemPlace *places, size_t *placed, uint32_t *around, size_t *left) {
    const RtGeometry *g = &buffer->isa.base.scene->geometry;
    _Alignas(64) int32_t lo[2][RT_ITEM_FACETS], hi[2][RT_ITEM_FACETS], class[RT_ITEM_FACETS];
    Lens lens;
    make_lens(&lens, buffer);
    for (uint32_t i = 0; i < count; i += RT_ITEM_FACETS) {
        const RtTriangle *at[RT_ITEM_FACETS];
        RtV16 v[3][3];
        Bounds b;
        for (uint32_t k = 0; k < RT_ITEM_FACETS; k++)
            at[k] = &g->triangles[first + (i + k < count ? i + k : count - 1)];
        rt_pairs_gather(at, v);
        bound(&lens, v, &b);
        uint32_t there = count - i < RT_ITEM_FACETS ? (1u << (count - i)) - 1 : 0xffff;
        uint32_t seen = there & b.known;
        for (int a = 0; a < 2; a++) {
            seen &= rt_v16_at_most(b.lo[a], b.hi[a]);
            rt_v16_truncate(lo[a], b.lo[a]);
            rt_v16_truncate(hi[a], b.hi[a]);
        }
        if (seen) put_classes(&b, nearer, class);
        for (; seen; seen &= seen - 1) {
            uint32_t k = (uint32_t)__builtin_ctz(seen);
            RtItemPlace *to = &places[(*placed)++];
            to->object = rt_ref(RT_SHAPE_TRIANGLE, first + i + k);
            to->class = (uint16_t) class[k];
            for (int a = 0; a < 2; a++) {
                to->lo[a] = (uint16_t)((uint32_t)lo[a][k] / RT_ITEM_TILE);
                to->hi[a] = (uint16_t)((uint32_t)hi[a][k] / RT_ITEM_TILE);
            }
        }
        for (there &= ~(b.known | b.behind); there; there &= there - 1)
            around[(*left)++] = g->triangle_ids[first + i + (uint32_t)__builtin_ctz(there)];
    }
}

#endif
