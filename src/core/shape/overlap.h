/* SPDX-License-Identifier: Apache-2.0 */
/* Tests of surfaces against boxes, and the part of a surface within a box: for structures that put an
 * object only into the cells that its surface meets, not into all that its box touches. */
#ifndef RT_SHAPE_OVERLAP_H
#define RT_SHAPE_OVERLAP_H

#include "core/shape/geometry.h"

/* Data of object `id`, computed once before it is tested against many boxes. */
typedef struct RtOutline {
    const RtGeometry *geometry; /* borrowed */
    uint32_t id;
    RtVec3d axes[3];     /* of cones and CSG trees: rt_object_frame; otherwise unset */
    double lo[3], hi[3]; /* the object's projections on these axes */
} RtOutline;

RtOutline rt_object_outline(const RtGeometry *geometry, uint32_t id);

/* False only if every point of the object's surface, as its hit function sees it, is more than `margin` from
 * `box` along some axis. Nearly exact except for cones and concave polygons (treated as convex). To cover
 * rounding, `margin` must be at least 2^-40 of the largest coordinate of scene and box. */
bool rt_outline_meets_box(const RtOutline *outline, const RtBox *box, double margin);

/* Sets *out to a box around all points of `box` that are inside the object's own box and within `margin`,
 * along each axis, of its surface; false only if there are none. It is nearly the smallest such box for
 * triangles, spheres, cones, and polygons of up to 16 vertices; for others it is the intersection of `box`
 * and the own box, unless they do not meet. `margin` as above. */
bool rt_object_part(const RtGeometry *geometry, uint32_t id, const RtBox *box, double margin, RtBox *out);

#endif
