/* SPDX-License-Identifier: Apache-2.0 */
/* Facets of triangles, eight at a time in doubles: edges, depth, and the errors of both (item.h). */
#ifndef RT_ACCEL_ITEM_ITEM_FACETS_H
#define RT_ACCEL_ITEM_ITEM_FACETS_H

#include "accel/item/item.h"
#include "accel/kernel.h"
#include "accel/simd_doubles.h"

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

/* The sum of |coordinates|, and the largest. */
RT_KERNEL RtD8 sum8(D8 a) {
    return rt_d8_add(rt_d8_add(rt_d8_abs(a.at[0]), rt_d8_abs(a.at[1])), rt_d8_abs(a.at[2]));
}

RT_KERNEL RtD8 most8(D8 a) {
    return rt_d8_max(rt_d8_max(rt_d8_abs(a.at[0]), rt_d8_abs(a.at[1])), rt_d8_abs(a.at[2]));
}

RT_KERNEL RtD8 times8(RtD8 a, double b) {
    return rt_d8_mul(a, rt_d8_all(b));
}

RT_KERNEL D8 project8(const RtItemProjection *projection, D8 q) {
    return (D8){
        {dot8(all8(projection->x), q), dot8(all8(projection->y), q), dot8(all8(projection->depth), q)}};
}

/* `of` times `scale`, as the coefficients of (1, column, row) from the corner of the tile. */
RT_KERNEL void put_function(float to[3][RT_ITEM_FACETS], size_t at, const RtItemDrawing *drawing, D8 of,
                            RtD8 scale) {
    RtD8 corner =
        rt_d8_add(rt_d8_add(times8(of.at[0], drawing->column), times8(of.at[1], drawing->row)), of.at[2]);
    rt_d8_put(&to[0][at], rt_d8_mul(corner, scale));
    rt_d8_put(&to[1][at], rt_d8_mul(of.at[0], scale));
    rt_d8_put(&to[2][at], rt_d8_mul(of.at[1], scale));
}

/* At least the length of the gradient of `of`, in units of slope, by a few per cent more. */
RT_KERNEL RtD8 gradient8(const RtItemProjection *projection, D8 of) {
    RtD8 x = times8(rt_d8_abs(of.at[0]), projection->scale[0]),
         y = times8(rt_d8_abs(of.at[1]), projection->scale[1]);
    return rt_d8_add(rt_d8_max(x, y), times8(rt_d8_min(x, y), 0.4143));
}

/* Facets 0..7 or 8..15, without lo, hi, most and id. */
RT_KERNEL void make_half(const RtItemDrawing *drawing, RtV16 v[3][3], int half, RtItemFacets *f) {
    const RtItemProjection *projection = &drawing->buffer->projection;
    const double g = projection->longest, b = 0x1.01p-24 * g,
                 product = projection->scale[0] * projection->scale[1] * g * g;
    const double coarse = 1 / fmin(projection->scale[0], projection->scale[1]);
    const size_t at = half ? 8 : 0;
    D8 vertex[3];
    for (int i = 0; i < 3; i++) {
        for (int a = 0; a < 3; a++) vertex[i].at[a] = rt_d8_of(rt_v16_half(v[i][a], half));
    }
    const D8 eye = all8(drawing->buffer->view.eye);
    D8 q = sub8(vertex[0], eye), u = sub8(vertex[1], vertex[0]), w = sub8(vertex[2], vertex[1]);
    D8 p[3], d[3];
    p[0] = project8(projection, q);
    d[0] = project8(projection, u);
    d[1] = project8(projection, w);
    d[2] = sub8(all8(rt_vec3d(0, 0, 0)), add8(d[0], d[1]));
    p[1] = add8(p[0], d[0]);
    p[2] = add8(p[1], d[1]);
    RtD8 far = rt_d8_max(most8(q), rt_d8_max(most8(sub8(vertex[1], eye)), most8(sub8(vertex[2], eye))));
    far = rt_d8_add(times8(far, 1 + 0x1p-10), rt_d8_all(0x1p-120));
    D8 normal = cross8(d[0], d[1]);
    RtD8 height = dot8(normal, p[0]), lengths = rt_d8_add(sum8(u), sum8(w));

    /* The rounding of double arithmetic, relative to the height, and below relative to the gradients. */
    RtD8 rough = times8(rt_d8_mul(rt_d8_mul(sum8(u), sum8(w)), far), 0x1p-40 * product);
    rough = rt_d8_div(rough, rt_d8_abs(height)); /* infinite or none for the plane of the eye */
    RtD8 steep = rt_d8_all(0);
    for (int i = 0; i < 3; i++) {
        D8 edge = cross8(p[i], d[i]);
        RtD8 scale = rt_d8_div(rt_d8_all(1), gradient8(projection, edge));
        steep = rt_d8_max(scale, steep);
        put_function(f->edge[i], at, drawing, edge, rt_d8_sign(scale, height));
    }
    RtD8 rounding = rt_d8_mul(times8(rt_d8_mul(far, lengths), 0x1p-40 * product), steep);
    rt_d8_put(&f->edge_error[0][at], rt_d8_add(rounding, rt_d8_all(1.25 * g * b + 0x1p-14 * coarse)));
    rt_d8_put(&f->edge_error[1][at], times8(far, 1.25 * g * 0.65 * 0x1p-20));

    RtD8 inverse = rt_d8_div(rt_d8_all(1), height);
    put_function(f->depth, at, drawing, normal, inverse);
    RtD8 slope = times8(rt_d8_mul(gradient8(projection, normal), rt_d8_abs(inverse)), g),
         e = times8(far, 0x1p-19);
    RtD8 none = rt_d8_add(times8(slope, 2 * b + 0x1p-13 * coarse), times8(rt_d8_div(rough, far), 4));
    RtD8 once = rt_d8_add(times8(rt_d8_add(rt_d8_mul(e, slope), rt_d8_all(b)), 2), times8(rough, 4));
    rt_d8_put(&f->depth_error[0][at], none);
    rt_d8_put(&f->depth_error[1][at], rt_d8_add(once, rt_d8_all(0x1p-19)));
    rt_d8_put(&f->depth_error[2][at], times8(e, 2));

    /* Where the side from which it is seen is unknown its edges say nothing either. */
    uint32_t known = rt_d8_at_most(rough, rt_d8_all(0x1p-4));
    for (size_t k = 0; k < 8; k++) {
        if (!(known >> k & 1)) f->edge_error[0][at + k] = f->depth_error[0][at + k] = INFINITY;
    }
}

#endif
