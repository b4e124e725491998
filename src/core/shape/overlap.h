/* SPDX-License-Identifier: Apache-2.0 */
/* Which boxes does the surface of an object meet, and how much of them? For structures that put an object
 * only into such cells, not into all that its box touches. */
#ifndef RT_SHAPE_OVERLAP_H
#define RT_SHAPE_OVERLAP_H

#include "core/shape/geometry.h"

/* What is to be known of object `id` before it is asked about boxes, many as a rule. */
typedef struct RtOutline {
    const RtGeometry *geometry; /* borrowed */
    uint32_t id;
    RtVec3d axes[3];     /* of cones and CSG trees: rt_object_frame; of others not set */
    double lo[3], hi[3]; /* their shadows on these axes */
} RtOutline;

RtOutline rt_object_outline(const RtGeometry *geometry, uint32_t id);

/* False only if every point of the object's surface, as its hit function sees it, is more than `margin` from
 * `box` along some axis; a box inside a sphere is not met. Nearly always false then, for all shapes but cones
 * and concave polygons (taken as convex), where it may be true nearby. `margin` must be at least 2^-40 of the
 * largest coordinate of the scene and the box, to cover rounding. */
bool rt_outline_meets_box(const RtOutline *outline, const RtBox *box, double margin);

/* The same for one box. */
bool rt_object_meets_box(const RtGeometry *geometry, uint32_t id, const RtBox *box, double margin);

/* To *out, a box about all points of `box` that are inside the object's own box and within `margin`, along
 * each axis, of its surface; false only if there are none. Nearly the least such box for triangles, spheres
 * and cones, and for polygons of up to 16 vertices; for others all of `box` that is in the own box, where
 * rt_object_meets_box does not say no. `margin` as there. */
bool rt_object_part(const RtGeometry *geometry, uint32_t id, const RtBox *box, double margin, RtBox *out);

#endif
