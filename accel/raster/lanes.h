/* SPDX-License-Identifier: Apache-2.0 */
/* Sixteen triangles, or 4 x 4 points of an image, in lanes: for the kernels of every instruction set. */
#ifndef RT_ACCEL_RASTER_LANES_H
#define RT_ACCEL_RASTER_LANES_H

#include "accel/kernel.h"
#include "accel/pairs.h"
#include "accel/raster/raster.h"
#include "accel/simd_words.h"

/* Triangles objects[0..count), by reference or index, to v by vertex and axis. Lanes from `count` on repeat
 * the first. */
RT_KERNEL void rt_raster_gather(const RtGeometry *g, const uint32_t *objects, uint32_t count, RtV16 v[3][3]) {
    const RtTriangle *at[16];
    for (uint32_t i = 0; i < 16; i++) at[i] = &g->triangles[rt_ref_index(objects[i < count ? i : 0])];
    rt_pairs_gather(at, v);
}

/* The same of triangles first..first+count-1. */
RT_KERNEL void rt_raster_gather_row(const RtGeometry *g, uint32_t first, uint32_t count, RtV16 v[3][3]) {
    const RtTriangle *at[16];
    for (uint32_t i = 0; i < 16; i++) at[i] = &g->triangles[first + (i < count ? i : 0)];
    rt_pairs_gather(at, v);
}

RT_KERNEL uint32_t rt_raster_first_lanes(uint32_t count) {
    return count < 16 ? (1u << count) - 1 : 0xffff;
}

RT_KERNEL RtV16 rt_raster_least3(const RtV16 a[3]) {
    return rt_v16_min(rt_v16_min(a[0], a[1]), a[2]);
}

RT_KERNEL RtV16 rt_raster_most3(const RtV16 a[3]) {
    return rt_v16_max(rt_v16_max(a[0], a[1]), a[2]);
}

/* Columns and rows of lanes that are 4 x 4, row by row. */
static const _Alignas(64) float rt_raster_column[16] = {0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3};
static const _Alignas(64) float rt_raster_row[16] = {0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3};

/* 4 x 4 points one apart from (column, row) on. */
RT_KERNEL RtV16 rt_raster_columns(float column) {
    return rt_v16_add(rt_v16_load(rt_raster_column), rt_v16_all(column));
}

RT_KERNEL RtV16 rt_raster_rows(float row) {
    return rt_v16_add(rt_v16_load(rt_raster_row), rt_v16_all(row));
}

#endif
