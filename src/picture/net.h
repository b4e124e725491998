/* SPDX-License-Identifier: Apache-2.0 */
/* Extents as lines, for pictures: their edges, or the circles of a net around a sphere; and where a plane
 * cuts them. */
#ifndef RT_PICTURE_NET_H
#define RT_PICTURE_NET_H

#include "accel/extent.h"

/* Who draws: one call of `line` for each. */
typedef struct RtLineViewer {
    void (*line)(void *context, RtVec3d from, RtVec3d to);
    void *context;
} RtLineViewer;

/* Is the extent not the axis-aligned box itself? */
bool rt_net_is_other(const RtBoxView *view);

/* The edges of a box, of an oriented box, or of the polytope that slabs are; of a sphere its outline as seen
 * from `eye`, and the three circles about its axes. */
void rt_net_lines(const RtBoxView *view, RtVec3d eye, RtLineViewer viewer);

#define RT_NET_CORNERS 48

/* The corners, in order, of the convex polygon in which the plane where `axis` is `at` cuts an extent that
 * is no axis-aligned box; a circle has RT_NET_CORNERS of them. Gives their number: 0 where it passes by. */
uint32_t rt_net_section(const RtBoxView *view, int axis, double at, RtVec3d corners[RT_NET_CORNERS]);

#endif
