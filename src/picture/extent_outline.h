/* SPDX-License-Identifier: Apache-2.0 */
/* Outlines of extents: their edges in space, and the convex polygons in which a plane cuts them; and where it
 * cuts flat objects. */
#ifndef RT_PICTURE_EXTENT_OUTLINE_H
#define RT_PICTURE_EXTENT_OUTLINE_H

#include "accel/extent.h"
#include "picture/canvas.h"

/* Receives lines, one call of `line` each. */
typedef struct RtLineViewer {
    void (*line)(void *context, RtVec3d from, RtVec3d to);
    void *context;
} RtLineViewer;

/* RT_EXTENT_BOX for voxels and other boxes that are no extents. */
RtExtentKind rt_outline_kind(const RtBoxView *view);

/* Shows the edges of a box, an oriented box or a polytope of slabs; of a sphere its three circles about the
 * axes and its silhouette as seen from `eye`. */
void rt_outline_edges(const RtBoxView *view, RtVec3d eye, RtLineViewer viewer);

#define RT_OUTLINE_CORNERS 48

/* The plane where `axis` is `at`, with coordinates along two other axes. */
typedef struct RtSectionPlane {
    int axis, across, up;
    double at;
} RtSectionPlane;

/* The corners, in order, of the convex polygon in which the plane cuts an extent, as x (across) and y (up); a
 * circle has RT_OUTLINE_CORNERS. Returns their number: 0 if the plane misses the extent. */
uint32_t rt_outline_section(const RtBoxView *view, RtSectionPlane plane, RtPoint corners[RT_OUTLINE_CORNERS]);

/* Where the plane through `on` with normal `normal` crosses the closed line through corners[0..count): the
 * first two points. False if there are not two. */
bool rt_outline_cut_flat(const RtVec3 *corners, uint32_t count, RtVec3d on, RtVec3d normal, RtVec3d cut[2]);

#endif
