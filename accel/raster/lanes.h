/* SPDX-License-Identifier: Apache-2.0 */
/* RT_LANES triangles, or points of an image, in lanes: for the kernels of every instruction set. */
#ifndef RT_ACCEL_RASTER_LANES_H
#define RT_ACCEL_RASTER_LANES_H

#include "accel/kernel.h"
#include "accel/raster/raster.h"
#include "accel/watertight.h"

/* Triangles objects[0..count), by reference or index, to v by vertex and axis. Lanes from `count` on repeat
 * the first. */
RT_KERNEL void rt_raster_gather(const RtGeometry *g, const uint32_t *objects, uint32_t count,
                                RtFloats v[3][3]) {
    const RtTriangle *at[RT_LANES];
    for (uint32_t i = 0; i < RT_LANES; i++) at[i] = &g->triangles[rt_ref_index(objects[i < count ? i : 0])];
    rt_load_triangles(at, v);
}

/* The same of triangles first..first+count-1. */
RT_KERNEL void rt_raster_gather_row(const RtGeometry *g, uint32_t first, uint32_t count, RtFloats v[3][3]) {
    const RtTriangle *at[RT_LANES];
    for (uint32_t i = 0; i < RT_LANES; i++) at[i] = &g->triangles[first + (i < count ? i : 0)];
    rt_load_triangles(at, v);
}

/* The bits of the first `count` lanes, or of all. */
RT_KERNEL uint32_t rt_raster_first_lanes(uint32_t count) {
    return count < RT_LANES ? (1u << count) - 1 : (1u << RT_LANES) - 1;
}

RT_KERNEL RtFloats rt_raster_least3(const RtFloats a[3]) {
    return rt_min(rt_min(a[0], a[1]), a[2]);
}

RT_KERNEL RtFloats rt_raster_most3(const RtFloats a[3]) {
    return rt_max(rt_max(a[0], a[1]), a[2]);
}

/* Points one apart from (column, row) on, row by row: four columns, RT_GROUPS rows. */
RT_KERNEL RtFloats rt_raster_columns(float column) {
    return rt_to_floats(rt_lane_numbers() & 3) + column;
}

RT_KERNEL RtFloats rt_raster_rows(float row) {
    return rt_to_floats(rt_lane_numbers() >> 2) + row;
}

#endif
