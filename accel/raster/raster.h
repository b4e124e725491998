/* SPDX-License-Identifier: Apache-2.0 */
/* What the item buffer and the light buffer share as rasterisers: the bounds of rounding below, triangles in
 * lanes.
 *
 * Setting. All points q are relative to a centre of projection, the eye or a light. A point of depth
 * z = depth . q > 0 is seen at (x . q) / z, (y . q) / z: in columns and rows of samples for item, whose axes
 * are those of the camera, in u and w on the face of a cube for light, whose axes are those of the scene.
 *
 * A hit function rounds, and so does the direction of a ray. What can be relied on (core/base/ray.h): if it
 * reports a hit at t, the ray's exact point at t is q - e, where q is a point of the object and |e| <= E
 * along each axis. Each buffer derives its own E, because its rays start elsewhere:
 *
 *     item    rays start at the centre:                  E = 2^-19 M + 2^-21 |eye|    (item_draw.c)
 *     light   rays end there, and start in a domain:     E = 2^-18 reach + 2^-20 farthest (light_project.c)
 *
 * with M the largest distance along an axis from the eye to the object, reach the longest side of the box
 * around domain and light, and farthest its largest coordinate. From this follows, for any projection:
 *
 * 1. Boxes. A hit lies in the object's box grown by E. Where that box is in front of the centre, it is seen
 *    between the projections of its corners, because it is convex. Where it reaches depth 0 it is seen to
 *    infinity on the side on which it does.
 * 2. Vertices. A hit on a flat object is seen in the hull of its projected vertices, moved by at most
 *    (1 + |u|) E / (z - E): a point at slope u and depth z > E moves by E along the axis and along depth.
 * 3. Edges. Let s = a x b be the normal of the plane through the centre and the edge from a to b, with
 *    s . v >= 0 for all vertices v. Then a hit has s . q >= -E |s|_1. The edge function s . (u, w, 1) is
 * linear (Pineda 1988), so where it is below -E |s|_1 / z for the least depth z, nothing is hit.
 * 4. Depths. Let n be the normal of the plane of a flat object and k = n . v > 0 for its points. A hit has
 *    n . q >= k - E |n|_1, and 1 / depth = n . (u, w, 1) / k is linear, too (Olano & Greer 1997).
 *
 * To these each buffer adds the rounding of its own arithmetic, written where it computes. */
#ifndef RT_ACCEL_RASTER_RASTER_H
#define RT_ACCEL_RASTER_RASTER_H

#include "accel/watertight.h"

/* The id of the object that a reference stands for. */
static inline uint32_t rt_raster_id(const RtGeometry *g, RtRef object) {
    switch (rt_ref_shape(object)) {
#define RT_RASTER_ID(CONSTANT, name, Type)                                                                   \
    case RT_SHAPE_##CONSTANT: return g->name##_ids[rt_ref_index(object)];
        RT_SHAPES(RT_RASTER_ID)
#undef RT_RASTER_ID
    default: return RT_NO_OBJECT;
    }
}

static inline bool rt_raster_is_triangle(RtRef object) {
    return rt_ref_shape(object) == RT_SHAPE_TRIANGLE;
}

/* Triangles objects[0..count), by reference or index, to v by vertex and axis. Lanes from `count` on repeat
 * the first. */
RT_KERNEL void rt_raster_gather(const RtGeometry *g, const uint32_t *objects, uint32_t count,
                                RtFloats v[3][3]) {
    const RtTriangle *at[RT_LANES];
    for (uint32_t i = 0; i < RT_LANES; i++) at[i] = &g->triangles[rt_ref_index(objects[i < count ? i : 0])];
    rt_load_triangles(at, v);
}

#endif
