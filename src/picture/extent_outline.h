/* SPDX-License-Identifier: Apache-2.0 */
/* Outlines of extents: their edges in space, and the convex polygons in which a plane cuts them or flat
 * objects. */
#ifndef RT_PICTURE_EXTENT_OUTLINE_H
#define RT_PICTURE_EXTENT_OUTLINE_H

#include "accel/extent.h"
#include "picture/canvas.h"

/* Receives lines, one call of `line` per line. */
typedef struct RtLineViewer {
    void (*line)(void *context, RtVec3d from, RtVec3d to);
    void *context;
} RtLineViewer;

/* RT_EXTENT_BOX also for voxels and other boxes that are not extents. */
RtExtentKind rt_outline_kind(const RtBoxView *view);

/* Emits the edges of a box, an oriented box or a slab polytope; for a sphere, its three axis-aligned
 * circles and its silhouette as seen from `eye`. */
void rt_outline_edges(const RtBoxView *view, RtVec3d eye, RtLineViewer viewer);

#define RT_OUTLINE_CORNERS 48

/* The plane where coordinate `axis` is `at`, with two other axes as coordinates. */
typedef struct RtSectionPlane {
    int axis, across, up;
    double at;
} RtSectionPlane;

/* The corners, in order, of the convex polygon in which the plane cuts an extent, as x (across) and y
 * (up); a circle has RT_OUTLINE_CORNERS. Returns their number, 0 if the plane misses the extent. */
uint32_t rt_outline_section(const RtBoxView *view, RtSectionPlane plane, RtPoint corners[RT_OUTLINE_CORNERS]);

/* The first two points in which the plane through `on` with normal `normal` crosses the closed polygon
 * corners[0..count). False if there are not two. */
bool rt_outline_cut_flat(const RtVec3 *corners, uint32_t count, RtVec3d on, RtVec3d normal, RtVec3d cut[2]);

#endif
