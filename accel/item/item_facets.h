/* SPDX-License-Identifier: Apache-2.0 */
/* Facets of triangles, RT_HALF at a time in doubles: edges, depth, and the errors of both (item.h). */
#ifndef RT_ACCEL_ITEM_ITEM_FACETS_H
#define RT_ACCEL_ITEM_ITEM_FACETS_H

#include "accel/item/item.h"
#include "accel/kernel.h"

/* Vectors of double in lanes. */
typedef struct Vectors {
    RtDoubles at[3];
} Vectors;

RT_KERNEL Vectors subtract(Vectors a, Vectors b) {
    return (Vectors){{a.at[0] - b.at[0], a.at[1] - b.at[1], a.at[2] - b.at[2]}};
}

RT_KERNEL Vectors add(Vectors a, Vectors b) {
    return (Vectors){{a.at[0] + b.at[0], a.at[1] + b.at[1], a.at[2] + b.at[2]}};
}

RT_KERNEL RtDoubles dot(Vectors a, Vectors b) {
    return a.at[0] * b.at[0] + a.at[1] * b.at[1] + a.at[2] * b.at[2];
}

RT_KERNEL Vectors cross(Vectors a, Vectors b) {
    return (Vectors){{a.at[1] * b.at[2] - a.at[2] * b.at[1], a.at[2] * b.at[0] - a.at[0] * b.at[2],
                      a.at[0] * b.at[1] - a.at[1] * b.at[0]}};
}

RT_KERNEL Vectors in_all_lanes(RtVec3d a) {
    return (Vectors){{rt_all_doubles(a.x), rt_all_doubles(a.y), rt_all_doubles(a.z)}};
}

/* The sum of |coordinates|, and the largest. */
RT_KERNEL RtDoubles sum_of_sizes(Vectors a) {
    return rt_abs(a.at[0]) + rt_abs(a.at[1]) + rt_abs(a.at[2]);
}

RT_KERNEL RtDoubles largest_size(Vectors a) {
    return rt_max(rt_max(rt_abs(a.at[0]), rt_abs(a.at[1])), rt_abs(a.at[2]));
}

RT_KERNEL Vectors project_lanes(const RtItemProjection *projection, Vectors q) {
    return (Vectors){{dot(in_all_lanes(projection->x), q), dot(in_all_lanes(projection->y), q),
                      dot(in_all_lanes(projection->depth), q)}};
}

/* `of` times `scale`, as the coefficients of (1, column, row) from the corner of the tile. */
RT_KERNEL void put_function(float to[3][RT_ITEM_FACETS], size_t at, const RtItemDrawing *drawing, Vectors of,
                            RtDoubles scale) {
    RtDoubles corner = of.at[0] * (double)drawing->column + of.at[1] * (double)drawing->row + of.at[2];
    rt_store_doubles(&to[0][at], corner * scale);
    rt_store_doubles(&to[1][at], of.at[0] * scale);
    rt_store_doubles(&to[2][at], of.at[1] * scale);
}

/* An upper bound, by a few per cent, of the length of the gradient of `of`, in units of slope. */
RT_KERNEL RtDoubles gradient(const RtItemProjection *projection, Vectors of) {
    RtDoubles x = rt_abs(of.at[0]) * projection->scale[0], y = rt_abs(of.at[1]) * projection->scale[1];
    return rt_max(x, y) + rt_min(x, y) * 0.4143;
}

/* Facets 0..RT_HALF-1, half 0, or RT_HALF..RT_LANES-1, without lo, hi, most and id. */
RT_KERNEL void make_half(const RtItemDrawing *drawing, RtFloats v[3][3], int half, RtItemFacets *f) {
    const RtItemProjection *projection = &drawing->buffer->projection;
    const double g = projection->longest, b = 0x1.01p-24 * g,
                 product = projection->scale[0] * projection->scale[1] * g * g;
    const double coarse = 1 / fmin(projection->scale[0], projection->scale[1]);
    const size_t at = half ? RT_HALF : 0;
    Vectors vertex[3];
    for (int i = 0; i < 3; i++) {
        for (int a = 0; a < 3; a++) vertex[i].at[a] = rt_to_doubles(v[i][a], half);
    }
    const Vectors eye = in_all_lanes(drawing->buffer->view.eye);
    Vectors q = subtract(vertex[0], eye), u = subtract(vertex[1], vertex[0]);
    Vectors w = subtract(vertex[2], vertex[1]), p[3], d[3];
    p[0] = project_lanes(projection, q);
    d[0] = project_lanes(projection, u);
    d[1] = project_lanes(projection, w);
    d[2] = subtract(in_all_lanes(rt_vec3d(0, 0, 0)), add(d[0], d[1]));
    p[1] = add(p[0], d[0]);
    p[2] = add(p[1], d[1]);
    RtDoubles far = rt_max(largest_size(subtract(vertex[1], eye)), largest_size(subtract(vertex[2], eye)));
    far = rt_max(largest_size(q), far) * (1 + 0x1p-10) + 0x1p-120;
    Vectors normal = cross(d[0], d[1]);
    RtDoubles height = dot(normal, p[0]), lengths = sum_of_sizes(u) + sum_of_sizes(w);

    /* The rounding of double arithmetic, relative to the height, and below relative to the gradients. */
    RtDoubles rough = sum_of_sizes(u) * sum_of_sizes(w) * far * (0x1p-40 * product);
    rough = rough / rt_abs(height); /* infinite or NaN for the plane of the eye */
    RtDoubles steep = rt_all_doubles(0);
    for (int i = 0; i < 3; i++) {
        Vectors edge = cross(p[i], d[i]);
        RtDoubles scale = 1 / gradient(projection, edge);
        steep = rt_max(scale, steep);
        put_function(f->edge[i], at, drawing, edge, rt_copy_sign(scale, height));
    }
    RtDoubles rounding = far * lengths * (0x1p-40 * product) * steep;
    rt_store_doubles(&f->edge_error[0][at], rounding + (1.25 * g * b + 0x1p-14 * coarse));
    rt_store_doubles(&f->edge_error[1][at], far * (1.25 * g * 0.65 * 0x1p-20));

    RtDoubles inverse = 1 / height;
    put_function(f->depth, at, drawing, normal, inverse);
    RtDoubles slope = gradient(projection, normal) * rt_abs(inverse) * g, e = far * 0x1p-19;
    RtDoubles none = slope * (2 * b + 0x1p-13 * coarse) + rough / far * 4;
    RtDoubles once = (e * slope + b) * 2 + rough * 4;
    rt_store_doubles(&f->depth_error[0][at], none);
    rt_store_doubles(&f->depth_error[1][at], once + 0x1p-19);
    rt_store_doubles(&f->depth_error[2][at], e * 2);

    /* If the side from which a facet is seen is unknown, its edges bound nothing. */
    uint32_t known = rt_le_bits(rough, rt_all_doubles(0x1p-4));
    for (size_t k = 0; k < RT_HALF; k++) {
        if (!(known >> k & 1)) f->edge_error[0][at + k] = f->depth_error[0][at + k] = INFINITY;
    }
}

#endif
