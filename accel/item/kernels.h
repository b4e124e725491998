/* SPDX-License-Identifier: Apache-2.0 */
/* What item does in vectors, included once for each instruction set (accel/isa.h): placing triangles and
 * drawing facets (raster.h says why nothing is missed), and answering primary rays. */
#include "accel/item/raster.h"
#include "accel/pairs.h"

/* ---- where triangles are ---- */

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

/* ---- making facets of triangles ---- */

typedef struct D8 {
    RtD8 at[3];
} D8;

RT_KERNEL D8 sub8(D8 a, D8 b) {
    return (D8){{rt_d8_sub(a.at[0], b.at[0]), rt_d8_sub(a.at[1], b.at[1]), rt_d8_sub(a.at[2], b.at[2])}};
}

RT_KERNEL D8 add8(D8 a, D8 b) {
    return (D8){{rt_d8_add(a.at[0], b.at[0]), rt_d8_add(a.at[1], b.at[1]), rt_d8_add(a.at[2], b.at[2])}};
}

RT_KERNEL RtD8 dot8(D8 a, D8 b) {
    return rt_d8_add(rt_d8_add(rt_d8_mul(a.at[0], b.at[0]), rt_d8_mul(a.at[1], b.at[1])),
                     rt_d8_mul(a.at[2], b.at[2]));
}

RT_KERNEL D8 cross8(D8 a, D8 b) {
    return (D8){{rt_d8_sub(rt_d8_mul(a.at[1], b.at[2]), rt_d8_mul(a.at[2], b.at[1])),
                 rt_d8_sub(rt_d8_mul(a.at[2], b.at[0]), rt_d8_mul(a.at[0], b.at[2])),
                 rt_d8_sub(rt_d8_mul(a.at[0], b.at[1]), rt_d8_mul(a.at[1], b.at[0]))}};
}

RT_KERNEL D8 all8(RtVec3d a) {
    return (D8){{rt_d8_all(a.x), rt_d8_all(a.y), rt_d8_all(a.z)}};
}

RT_KERNEL RtD8 sum8(D8 a) { /* of |coordinates| */
    return rt_d8_add(rt_d8_add(rt_d8_abs(a.at[0]), rt_d8_abs(a.at[1])), rt_d8_abs(a.at[2]));
}

RT_KERNEL RtD8 most8(D8 a) {
    return rt_d8_max(rt_d8_max(rt_d8_abs(a.at[0]), rt_d8_abs(a.at[1])), rt_d8_abs(a.at[2]));
}

RT_KERNEL RtD8 times8(RtD8 a, double b) {
    return rt_d8_mul(a, rt_d8_all(b));
}

RT_KERNEL D8 project8(const RtItemAim *aim, D8 q) {
    return (D8){{dot8(all8(aim->x), q), dot8(all8(aim->y), q), dot8(all8(aim->depth), q)}};
}

/* `of` times `scale`, as the coefficients of (1, column, row) from the corner of the tile. */
RT_KERNEL void put_function(float to[3][RT_ITEM_FACETS], size_t at, const RtItemPainter *p, D8 of,
                            RtD8 scale) {
    RtD8 corner = rt_d8_add(rt_d8_add(times8(of.at[0], p->column), times8(of.at[1], p->row)), of.at[2]);
    rt_d8_put(&to[0][at], rt_d8_mul(corner, scale));
    rt_d8_put(&to[1][at], rt_d8_mul(of.at[0], scale));
    rt_d8_put(&to[2][at], rt_d8_mul(of.at[1], scale));
}

/* At least the length of the gradient of `of`, in units of slope, by a few per cent more. */
RT_KERNEL RtD8 gradient8(const RtItemAim *aim, D8 of) {
    RtD8 x = times8(rt_d8_abs(of.at[0]), aim->scale[0]), y = times8(rt_d8_abs(of.at[1]), aim->scale[1]);
    return rt_d8_add(rt_d8_max(x, y), times8(rt_d8_min(x, y), 0.4143));
}

/* Facets 0..7 or 8..15, but for where they are. */
RT_KERNEL void make_half(const RtItemPainter *painter, RtV16 v[3][3], int half, RtItemFacets *f) {
    const RtItemAim *aim = &painter->buffer->aim;
    const double g = aim->longest, b = 0x1.01p-24 * g, product = aim->scale[0] * aim->scale[1] * g * g;
    const double coarse = 1 / fmin(aim->scale[0], aim->scale[1]);
    const size_t at = half ? 8 : 0;
    D8 vertex[3];
    for (int i = 0; i < 3; i++) {
        for (int a = 0; a < 3; a++) vertex[i].at[a] = rt_d8_of(rt_v16_half(v[i][a], half));
    }
    const D8 eye = all8(painter->buffer->view.eye);
    D8 q = sub8(vertex[0], eye), u = sub8(vertex[1], vertex[0]), w = sub8(vertex[2], vertex[1]);
    D8 p[3], d[3];
    p[0] = project8(aim, q);
    d[0] = project8(aim, u);
    d[1] = project8(aim, w);
    d[2] = sub8(all8(rt_vec3d(0, 0, 0)), add8(d[0], d[1]));
    p[1] = add8(p[0], d[0]);
    p[2] = add8(p[1], d[1]);
    RtD8 far = rt_d8_max(most8(q), rt_d8_max(most8(sub8(vertex[1], eye)), most8(sub8(vertex[2], eye))));
    far = rt_d8_add(times8(far, 1 + 0x1p-10), rt_d8_all(0x1p-120));
    D8 normal = cross8(d[0], d[1]);
    RtD8 height = dot8(normal, p[0]), lengths = rt_d8_add(sum8(u), sum8(w));

    /* Double arithmetic: products of two edges and a vertex, of edge and vertex, each over what they make. */
    RtD8 rough = times8(rt_d8_mul(rt_d8_mul(sum8(u), sum8(w)), far), 0x1p-40 * product);
    rough = rt_d8_div(rough, rt_d8_abs(height)); /* infinite or none for the plane of the eye */
    RtD8 steep = rt_d8_all(0);
    for (int i = 0; i < 3; i++) {
        D8 edge = cross8(p[i], d[i]);
        RtD8 scale = rt_d8_div(rt_d8_all(1), gradient8(aim, edge));
        steep = rt_d8_max(scale, steep);
        put_function(f->edge[i], at, painter, edge, rt_d8_sign(scale, height));
    }
    RtD8 rounding = rt_d8_mul(times8(rt_d8_mul(far, lengths), 0x1p-40 * product), steep);
    rt_d8_put(&f->doubt[0][at], rt_d8_add(rounding, rt_d8_all(1.25 * g * b + 0x1p-14 * coarse)));
    rt_d8_put(&f->doubt[1][at], times8(far, 1.25 * g * 0.65 * 0x1p-20));

    RtD8 inverse = rt_d8_div(rt_d8_all(1), height);
    put_function(f->depth, at, painter, normal, inverse);
    RtD8 slope = times8(rt_d8_mul(gradient8(aim, normal), rt_d8_abs(inverse)), g), e = times8(far, 0x1p-19);
    RtD8 none = rt_d8_add(times8(slope, 2 * b + 0x1p-13 * coarse), times8(rt_d8_div(rough, far), 4));
    RtD8 once = rt_d8_add(times8(rt_d8_add(rt_d8_mul(e, slope), rt_d8_all(b)), 2), times8(rough, 4));
    rt_d8_put(&f->spread[0][at], none);
    rt_d8_put(&f->spread[1][at], rt_d8_add(once, rt_d8_all(0x1p-19)));
    rt_d8_put(&f->spread[2][at], times8(e, 2));

    /* Not known from which side it is seen: its edges say nothing either. */
    uint32_t known = rt_d8_at_most(rough, rt_d8_all(0x1p-4));
    for (size_t k = 0; k < 8; k++) {
        if (!(known >> k & 1)) f->doubt[0][at + k] = f->spread[0][at + k] = INFINITY;
    }
}

/* Where footprints of boxes say that a facet is. */
static void place_around(const RtItemPainter *p, const RtItemFootprint *at, RtItemFacets *f, uint32_t k) {
    const uint32_t corner[2] = {p->column, p->row};
    for (int a = 0; a < 2; a++) {
        f->lo[a][k] = (int32_t)at->lo[a] - (int32_t)corner[a];
        f->hi[a][k] = (int32_t)at->hi[a] - (int32_t)corner[a];
    }
    f->most[k] = rt_float_above(1 / (double)at->near);
    if (!(f->doubt[1][k] * f->most[k] < 0x1p-4f)) f->most[k] = INFINITY;
}

/* ---- drawing facets ---- */

/* Columns and rows of the samples of a block, in the tile. */
typedef struct Grid {
    RtV16 along[RT_ITEM_TILE / RT_ITEM_BLOCK][2];
    RtV16
        blocks[1 + RT_ITEM_BLOCKS / RT_ITEM_LANES]; /* columns of the first samples of sixteen blocks; rows */
} Grid;

RT_KERNEL void make_grid(Grid *grid) {
    _Alignas(64) float at[2][RT_ITEM_LANES];
    for (int i = 0; i < RT_ITEM_TILE / RT_ITEM_BLOCK; i++) {
        for (int k = 0; k < RT_ITEM_LANES; k++) {
            const int down = k / RT_ITEM_BLOCK;
            at[0][k] = (float)(i * RT_ITEM_BLOCK + k % RT_ITEM_BLOCK);
            at[1][k] = (float)(i * RT_ITEM_BLOCK + down);
        }
        grid->along[i][0] = rt_v16_load(at[0]);
        grid->along[i][1] = rt_v16_load(at[1]);
    }
    for (int i = 0; i < RT_ITEM_BLOCKS / RT_ITEM_LANES; i++) {
        for (int k = 0; k < RT_ITEM_LANES; k++) {
            const int block = i * RT_ITEM_LANES + k, across = RT_ITEM_TILE / RT_ITEM_BLOCK;
            const int row = block / across * RT_ITEM_BLOCK;
            at[0][k] = (float)(block % across * RT_ITEM_BLOCK);
            at[1][k] = (float)row;
        }
        grid->blocks[0] = rt_v16_load(at[0]);
        grid->blocks[1 + i] = rt_v16_load(at[1]);
    }
}

RT_KERNEL RtV16 function(const float of[3][RT_ITEM_FACETS], uint32_t k, RtV16 column, RtV16 row) {
    return rt_v16_add(rt_v16_add(rt_v16_all(of[0][k]), rt_v16_mul(rt_v16_all(of[1][k]), column)),
                      rt_v16_mul(rt_v16_all(of[2][k]), row));
}

/* The samples of a block where facet k may be nearest. */
RT_KERNEL void paint_block(RtItemPainter *p, uint32_t block, const RtItemFacets *f, uint32_t k,
                           uint32_t edges, uint32_t lanes, RtV16 column, RtV16 row) {
    RtItemTile *tile = &p->tile;
    const RtV16 zero = rt_v16_all(0), there_lo = rt_v16_load(tile->lo[block]);
    RtV16 w = function(f->depth, k, column, row), size = rt_v16_abs(w),
          half = rt_v16_mul(w, rt_v16_all(0.5f));
    RtV16 spread = rt_v16_mul(rt_v16_all(f->spread[2][k]), size);
    spread = rt_v16_mul(rt_v16_add(spread, rt_v16_all(f->spread[1][k])), size);
    spread = rt_v16_add(spread, rt_v16_all(f->spread[0][k]));
    RtSet16 known = rt_v16_below(spread, half);
    RtV16 lo = rt_v16_pick(known, zero, rt_v16_sub(w, spread));
    RtV16 hi = rt_v16_pick(known, rt_v16_all(f->most[k]), rt_v16_add(w, spread));
    uint32_t behind = rt_v16_bits(rt_v16_below(spread, rt_v16_sub(zero, half)));
    uint32_t front = lanes & ~behind & rt_v16_at_most(there_lo, hi);
    if (!front) return;

    RtV16 doubt = rt_v16_mul(rt_v16_all(f->doubt[1][k]), hi);
    doubt = rt_v16_add(doubt, rt_v16_all(f->doubt[0][k]));
    RtV16 minus = rt_v16_sub(zero, doubt);
    uint32_t inside = rt_v16_bits(known);
    for (uint32_t i = 0; i < edges; i++) {
        RtV16 edge = function(f->edge[i], k, column, row);
        front &= ~rt_v16_bits(rt_v16_below(edge, minus));
        inside &= rt_v16_bits(rt_v16_below(doubt, edge));
    }
    front &= rt_v16_at_most(lo, rt_v16_all(p->nearest));
    if (!front) return;
    inside &= rt_v16_at_most(rt_v16_mul(hi, rt_v16_all(1 + 0x1p-18f)), rt_v16_all(p->nearest));
    uint32_t clear = front & inside & rt_v16_bits(rt_v16_below(rt_v16_load(tile->hi[block]), lo));
    if (clear) {
        rt_v16_store_some(tile->lo[block], clear, lo);
        rt_v16_store_some(tile->hi[block], clear, hi);
        rt_v16_store_some(tile->t[block], clear, rt_v16_all(-1));
        rt_w16_store_some(tile->id[block], clear, rt_w16_all(f->id[k]));
        tile->least[block] = rt_v16_least(rt_v16_load(tile->lo[block]));
    }
    front &= ~clear;
    if (!front) return;
    _Alignas(64) float los[RT_ITEM_LANES], his[RT_ITEM_LANES];
    rt_v16_store(los, lo);
    rt_v16_store(his, hi);
    for (; front; front &= front - 1) {
        uint32_t lane = (uint32_t)__builtin_ctz(front);
        rt_item_doubt(p, block, lane, f->id[k], los[lane], his[lane], inside >> lane & 1);
    }
}

/* Of facets of triangles those that may hold a sample: all that are seen at more than two columns or rows,
 * and of the others, sixteen at a time, those whose edges let one pass. */
RT_KERNEL uint32_t hold_some(const RtItemFacets *f, const Bounds *b, const RtV16 corner[2]) {
    const RtV16 one = rt_v16_all(1);
    RtV16 doubt =
        rt_v16_add(rt_v16_load(f->doubt[0]), rt_v16_mul(rt_v16_load(f->doubt[1]), rt_v16_load(f->most)));
    RtV16 minus = rt_v16_sub(rt_v16_all(0), doubt), start[2];
    uint32_t some = 0, wide[2];
    for (int a = 0; a < 2; a++) {
        start[a] = rt_v16_sub(b->lo[a], corner[a]);
        RtV16 more = rt_v16_sub(b->hi[a], b->lo[a]);
        wide[a] = rt_v16_at_most(one, more);
        some |= ~rt_v16_at_most(more, one);
    }
    for (int i = 0; i < 4; i++) {
        RtV16 column = i & 1 ? rt_v16_add(start[0], one) : start[0];
        RtV16 row = i & 2 ? rt_v16_add(start[1], one) : start[1];
        uint32_t in = (i & 1 ? wide[0] : ~0u) & (i & 2 ? wide[1] : ~0u);
        for (int e = 0; e < 3; e++) {
            RtV16 edge = rt_v16_mul(rt_v16_load(f->edge[e][1]), column);
            edge = rt_v16_add(rt_v16_add(rt_v16_load(f->edge[e][0]), edge),
                              rt_v16_mul(rt_v16_load(f->edge[e][2]), row));
            in &= ~rt_v16_bits(rt_v16_below(edge, minus));
        }
        some |= in;
    }
    return some;
}

/* From so many blocks on it is looked first which of them a facet is in. */
enum { MANY_BLOCKS = 4 };

/* Bit i: facet k may be seen in block i. An edge is largest in a block at the corner on its inner side. */
RT_KERNEL uint64_t blocks_of(const RtItemPainter *p, const Grid *grid, const RtItemFacets *f, uint32_t k,
                             uint32_t edges) {
    const float last = RT_ITEM_BLOCK - 1;
    const RtV16 least = rt_v16_all(-(f->doubt[0][k] + f->doubt[1][k] * f->most[k]));
    uint64_t open = 0;
    for (size_t i = 0; i < RT_ITEM_BLOCKS / RT_ITEM_LANES; i++) {
        uint32_t in = rt_v16_at_most(rt_v16_load(&p->tile.least[i * RT_ITEM_LANES]), rt_v16_all(f->most[k]));
        for (uint32_t e = 0; e < edges; e++) {
            RtV16 edge = function(f->edge[e], k, grid->blocks[0], grid->blocks[1 + i]);
            float more = last * (rt_maxf(f->edge[e][1][k], 0) + rt_maxf(f->edge[e][2][k], 0));
            in &= ~rt_v16_bits(rt_v16_below(rt_v16_add(edge, rt_v16_all(more)), least));
        }
        open |= (uint64_t)(in & 0xffff) << i * RT_ITEM_LANES;
    }
    return open;
}

RT_KERNEL void paint_one(RtItemPainter *p, const Grid *grid, const RtItemFacets *f, uint32_t k,
                         uint32_t edges) {
    static const uint32_t from[2][RT_ITEM_BLOCK] = {{0xffff, 0xeeee, 0xcccc, 0x8888},
                                                    {0xffff, 0xfff0, 0xff00, 0xf000}};
    static const uint32_t to[2][RT_ITEM_BLOCK] = {{0x1111, 0x3333, 0x7777, 0xffff},
                                                  {0x000f, 0x00ff, 0x0fff, 0xffff}};
    int32_t lo[2], hi[2];
    for (int a = 0; a < 2; a++) {
        lo[a] = f->lo[a][k] > 0 ? f->lo[a][k] : 0;
        hi[a] = f->hi[a][k] < RT_ITEM_TILE - 1 ? f->hi[a][k] : RT_ITEM_TILE - 1;
    }
    int32_t blocks = (hi[0] / RT_ITEM_BLOCK - lo[0] / RT_ITEM_BLOCK + 1) *
                     (hi[1] / RT_ITEM_BLOCK - lo[1] / RT_ITEM_BLOCK + 1);
    uint64_t open = blocks < MANY_BLOCKS ? ~UINT64_C(0) : blocks_of(p, grid, f, k, edges);
    for (int32_t y = lo[1] / RT_ITEM_BLOCK; y <= hi[1] / RT_ITEM_BLOCK; y++) {
        uint32_t rows = y == lo[1] / RT_ITEM_BLOCK ? from[1][lo[1] % RT_ITEM_BLOCK] : 0xffff;
        if (y == hi[1] / RT_ITEM_BLOCK) rows &= to[1][hi[1] % RT_ITEM_BLOCK];
        for (int32_t x = lo[0] / RT_ITEM_BLOCK; x <= hi[0] / RT_ITEM_BLOCK; x++) {
            uint32_t block = (uint32_t)(y * (RT_ITEM_TILE / RT_ITEM_BLOCK) + x), lanes = rows;
            if (!(open >> block & 1) || f->most[k] < p->tile.least[block]) continue;
            if (x == lo[0] / RT_ITEM_BLOCK) lanes &= from[0][lo[0] % RT_ITEM_BLOCK];
            if (x == hi[0] / RT_ITEM_BLOCK) lanes &= to[0][hi[0] % RT_ITEM_BLOCK];
            paint_block(p, block, f, k, edges, lanes, grid->along[x][0], grid->along[y][1]);
        }
    }
}

/* The least w of the tile: what is less is hidden everywhere. */
RT_KERNEL float farthest(const RtItemTile *tile) {
    RtV16 least = rt_v16_load(tile->least);
    for (int i = RT_ITEM_LANES; i < RT_ITEM_BLOCKS; i += RT_ITEM_LANES)
        least = rt_v16_min(least, rt_v16_load(&tile->least[i]));
    return rt_v16_least(least);
}

RT_KERNEL void paint_some(RtItemPainter *painter, const Lens *lens, const Grid *grid,
                          const uint32_t *triangles, uint32_t count, RtItemFacets *f) {
    const RtGeometry *g = &painter->buffer->isa.base.scene->geometry;
    const RtV16 corner[2] = {rt_v16_all((float)painter->column), rt_v16_all((float)painter->row)};
    const RtTriangle *at[RT_ITEM_FACETS];
    RtV16 v[3][3];
    Bounds b;
    for (uint32_t k = 0; k < RT_ITEM_FACETS; k++) at[k] = &g->triangles[triangles[k < count ? k : 0]];
    rt_pairs_gather(at, v);
    bound(lens, v, &b);
    uint32_t there = (1u << count) - 1, around = ~b.known & there;
    there &= around | rt_v16_at_most(rt_v16_all(farthest(&painter->tile)), b.most);
    if (!there) return;
    make_half(painter, v, 0, f);
    if (there >> 8) make_half(painter, v, 1, f);
    for (int a = 0; a < 2; a++) {
        rt_v16_truncate(f->lo[a], rt_v16_sub(b.lo[a], corner[a]));
        rt_v16_truncate(f->hi[a], rt_v16_sub(b.hi[a], corner[a]));
    }
    rt_v16_store(f->most, b.most);
    there &= around | hold_some(f, &b, corner);
    for (; around; around &= around - 1) {
        uint32_t k = (uint32_t)__builtin_ctz(around);
        RtItemFootprint footprint;
        rt_item_footprint(painter->buffer, g->triangle_ids[triangles[k]], &footprint);
        place_around(painter, &footprint, f, k);
    }
    for (; there; there &= there - 1) {
        uint32_t k = (uint32_t)__builtin_ctz(there);
        f->id[k] = g->triangle_ids[triangles[k]];
        paint_one(painter, grid, f, k, 3);
    }
}

static void paint(RtItemPainter *painter, const RtRef *objects, size_t count) {
    RtItemFacets facets;
    Lens lens;
    Grid grid;
    make_lens(&lens, painter->buffer);
    make_grid(&grid);
    for (size_t i = 0; i < count;) {
        uint32_t triangles[RT_ITEM_FACETS], some = 0;
        for (; i < count && some < RT_ITEM_FACETS; i++) {
            if (rt_ref_shape(objects[i]) == RT_SHAPE_TRIANGLE) triangles[some++] = rt_ref_index(objects[i]);
        }
        if (some > 0) paint_some(painter, &lens, &grid, triangles, some, &facets);
    }
}

static void paint_facet(RtItemPainter *painter, const RtItemFacets *facets, uint32_t edges) {
    Grid grid;
    make_grid(&grid);
    paint_one(painter, &grid, facets, 0, edges);
}

/* ---- answering rays ---- */

/* Rays whose samples name triangles, waiting until there are sixteen. */
typedef struct Waiting {
    const RtTriangle *triangle[RT_ITEM_LANES];
    const float *dir[RT_ITEM_LANES]; /* and tmax */
    uint32_t id[RT_ITEM_LANES], ray[RT_ITEM_LANES];
    uint32_t count;
} Waiting;

enum { AHEAD = 64 }; /* rays so far ahead are fetched */

/* Rays that are passed on, together. */
enum { PASSED = 64 };
typedef struct Passed {
    RtRay ray[PASSED];
    size_t place[PASSED];
    uint32_t count;
} Passed;

typedef struct Question {
    const RtItemBuffer *buffer;
    const RtScratch *scratch;
    const RtRay *rays;
    RtHit *hits;
    RtTally *tallies;    /* NULL where nothing is counted */
    uint64_t reciprocal; /* 2^64 / columns, rounded up; 0 for a single column */
    Waiting waiting;
    Passed passed;
} Question;

RT_KERNEL void pass_waiting(Question *q, RtTally *tallies) {
    Passed *p = &q->passed;
    RtHit hits[PASSED];
    if (tallies) tallies[RT_RAY_PRIMARY].passed_on += p->count;
    RT_OBSERVE(tallies, .kind = RT_TRACED_PASSED_ON, .what = "item");
    rt_hand_down_nearest(&q->buffer->isa.base, q->scratch, p->ray, p->count, hits, tallies);
    for (uint32_t i = 0; i < p->count; i++) q->hits[p->place[i]] = hits[i];
    p->count = 0;
}

RT_KERNEL void pass_on(Question *q, size_t i, RtTally *tallies) {
    Passed *p = &q->passed;
    p->ray[p->count] = q->rays[i];
    p->place[p->count++] = i;
    if (p->count == PASSED) pass_waiting(q, tallies);
}

/* The object that its sample names is hit, or, against all expectation, missed. */
RT_KERNEL void answer(Question *q, size_t i, RtHit hit, RtTally *tallies) {
    RtTally *tally = tallies ? &tallies[RT_RAY_PRIMARY] : NULL;
    if (hit.object == RT_NO_OBJECT)
        pass_on(q, i, tallies);
    else
        q->hits[i] = rt_answer_nearest(hit, tally);
}

RT_COLD static void observe_waiting(const RtGeometry *g, const Waiting *w, uint32_t hit, const float *t) {
    for (uint32_t k = 0; k < w->count; k++) {
        uint32_t id = w->id[k];
        rt_observe(&(RtTraced){.kind = RT_TRACED_OBJECT_TEST, .index = id, .box = &g->boxes[id]});
        if (hit >> k & 1) rt_observe(&(RtTraced){.kind = RT_TRACED_OBJECT_HIT, .index = id, .t = t[k]});
    }
}

/* Tests up to sixteen rays, all from the eye. */
RT_KERNEL void test_waiting(Question *q, RtTally *tallies) {
    const RtItemBuffer *buffer = q->buffer;
    Waiting *w = &q->waiting;
    _Alignas(64) float t[RT_ITEM_LANES];
    for (uint32_t k = w->count; k < RT_ITEM_LANES; k++) {
        w->triangle[k] = w->triangle[0];
        w->dir[k] = w->dir[0];
    }
    RtV16 four[4], at;
    RtPairs pairs = {.tmin = rt_v16_all((float)buffer->view.near), .tmax = rt_v16_all(INFINITY)};
    rt_v16_columns(w->dir, four);
    for (int a = 0; a < 3; a++) {
        pairs.org[a] = rt_v16_all((float)buffer->view.eye.at[a]);
        pairs.dir[a] = four[a];
    }
    rt_pairs_gather(w->triangle, pairs.v);
    uint32_t hit = rt_pairs_hit(&pairs, &at);
    rt_v16_store(t, at);
    if (tallies) {
        tallies[RT_RAY_PRIMARY].object_tests += w->count;
        tallies[RT_RAY_PRIMARY].object_hits += (uint32_t)__builtin_popcount(hit & ((1u << w->count) - 1));
        if (RT_OBSERVED(tallies)) observe_waiting(&buffer->isa.base.scene->geometry, w, hit, t);
    }
    for (uint32_t k = 0; k < w->count; k++)
        answer(q, w->ray[k], hit >> k & 1 ? (RtHit){t[k], w->id[k]} : RT_MISS, tallies);
    w->count = 0;
}

__extension__ typedef unsigned __int128 Wide;

/* Is it, bit for bit, the ray of its sample? */
RT_KERNEL bool is_of_sample(const RtItemBuffer *self, const RtRay *ray, __m128 org, uint64_t reciprocal) {
    if (ray->source >= rt_item_sample_count(self)) return false;
    uint32_t row = reciprocal ? (uint32_t)((Wide)reciprocal * ray->source >> 64) : ray->source;
    uint32_t column = ray->source - row * self->view.sampling.columns;
    __m256d dir = _mm256_add_pd(_mm256_load_pd(self->columns[column].at), _mm256_load_pd(self->rows[row].at));
    __m128i same = _mm_cmpeq_epi32(_mm_castps_si128(_mm256_cvtpd_ps(dir)),
                                   _mm_loadu_si128((const __m128i *)(const void *)&ray->dir));
    same = _mm_and_si128(same, _mm_cmpeq_epi32(_mm_castps_si128(org),
                                               _mm_loadu_si128((const __m128i *)(const void *)&ray->org)));
    return _mm_movemask_epi8(same) == 0xffff;
}

/* If it is, *triangle is its index. */
RT_KERNEL bool is_triangle(const RtGeometry *g, uint32_t id, uint32_t *triangle) {
    *triangle = rt_ref_index(g->objects[id]);
    return rt_ref_shape(g->objects[id]) == RT_SHAPE_TRIANGLE;
}

RT_KERNEL void see(const RtAccel *accel, const RtScratch *scratch, const RtRay *rays, size_t count,
                   RtHit *hits, RtTally *tallies) {
    const RtItemBuffer *self = (const RtItemBuffer *)accel;
    const RtGeometry *g = &accel->scene->geometry;
    RtTally *tally = tallies ? &tallies[RT_RAY_PRIMARY] : NULL;
    Question q;
    q.buffer = self;
    q.scratch = scratch;
    q.rays = rays;
    q.hits = hits;
    q.reciprocal = UINT64_MAX / self->view.sampling.columns + 1;
    q.waiting.count = q.passed.count = 0;
    const bool mixed = g->triangle_count < g->object_count;
    const __m128 org = _mm_setr_ps((float)self->view.eye.x, (float)self->view.eye.y, (float)self->view.eye.z,
                                   (float)self->view.near);
    for (size_t i = 0; i < count; i++) {
        const RtRay *ray = &rays[i];
        if (!is_of_sample(self, ray, org, q.reciprocal)) {
            pass_on(&q, i, tallies);
            continue;
        }
        uint32_t id = self->samples[ray->source], triangle = id;
        RT_COUNT(tally, steps, 1);
        RT_OBSERVE(tally, .kind = RT_TRACED_STEP, .what = "sample", .index = ray->source);
        __builtin_prefetch(ray + AHEAD);
        if (id == RT_NO_OBJECT) {
            hits[i] = rt_answer_nearest(RT_MISS, tally);
        } else if (id == RT_ITEM_UNDECIDED) {
            pass_on(&q, i, tallies);
        } else if (mixed ? is_triangle(g, id, &triangle) : true) {
            Waiting *w = &q.waiting;
            const RtTriangle *at = &g->triangles[triangle];
            __builtin_prefetch(at);
            __builtin_prefetch(&at->v[2].z);
            w->triangle[w->count] = at;
            w->dir[w->count] = ray->dir.at;
            w->id[w->count] = id;
            w->ray[w->count++] = (uint32_t)i;
            if (w->count == RT_ITEM_LANES) test_waiting(&q, tallies);
        } else {
            RtPreparedRay prepared;
            RtHit hit = RT_MISS;
            rt_hit_ray(&prepared, g, ray, scratch->room);
            rt_test_object(g, id, &prepared, false, &hit, tally);
            answer(&q, i, hit, tallies);
        }
    }
    if (q.waiting.count > 0) test_waiting(&q, tallies);
    if (q.passed.count > 0) pass_waiting(&q, tallies);
}

/* Rays looked at before they are answered: they are read from memory once. */
enum { RUN = 256 };

/* Primary rays of a stream; runs of others are handed down. */
RT_KERNEL void see_all(const RtAccel *accel, const RtScratch *scratch, const RtRay *rays, size_t count,
                       RtHit *hits, RtTally *tallies) {
    for (size_t i = 0, next; i < count; i = next) {
        bool own = rays[i].kind == RT_RAY_PRIMARY;
        for (next = i + 1; next < count && (!own || next - i < RUN); next++) {
            if ((rays[next].kind == RT_RAY_PRIMARY) != own) break;
        }
        if (own)
            see(accel, scratch, rays + i, next - i, hits + i, tallies);
        else
            rt_hand_down_nearest(accel, scratch, rays + i, next - i, hits + i, tallies);
    }
}

RT_DEFINE_BOTH(nearest, RtHit, see_all)
RT_REFUSE_QUESTION(occluded, uint32_t)
RT_DEFINE_KERNEL_TABLE(0);
const RtItemPainting RT_PAINTING = {place, paint, paint_facet};
