/* SPDX-License-Identifier: Apache-2.0 */
/* Where rounding may move the hit of a line with a flat shape. Places along a line are distances from its
 * origin; all arithmetic is double, whose own error is 2^-30 of any bound here.
 *
 * The arithmetic in question subtracts the ray's origin from float32 coordinates, and then works in float32.
 * Its error for an object moves each vertex by up to
 *
 *     delta = 2^-20 * the distance from the origin to the far corner of the object's box      (16 half-ulps)
 *
 * An edge function is a triple product of a vertex, an edge and the direction; it decides correctly if the
 * line passes the edge, as seen along the line, by delta, and by delta * longest / edge where the edge is a
 * difference of longer ones. The plane of a shape with longest side L and area A moves by delta * L^2 / 2A
 * within the shape, at least by delta. In the plane both distances are divided by the cosine between line and
 * normal. Vertices of a polygon that are not in its plane add their distance from it. */
#ifndef RT_EXACT_FLAT_MARGIN_H
#define RT_EXACT_FLAT_MARGIN_H

#include "exact/exact.h"

/* The factor of delta. */
#define RT_MARGIN 0x1p-20

/* A line with a direction of length 1; the distance is t * length. */
typedef struct RtUnitLine {
    RtVec3d org, dir;
    double length;
} RtUnitLine;

RtUnitLine rt_unit_line(const RtWideRay *ray);

/* The distance of the origin from the far corner of the box. */
double rt_far_corner(const RtUnitLine *line, const RtBox *box);

/* Does the line pass through the box grown by delta, and between which distances? */
bool rt_line_in_box(const RtUnitLine *line, const RtBox *box, double delta, double *lo, double *hi);

/* Do products of these magnitudes overflow float32, or lose digits at its lower end? Then a hit may be
 * reported anywhere. */
bool rt_exceeds_float(double least, double most);

typedef struct RtFlatMargin {
    bool possible; /* the line may meet the shape: then between lo and hi */
    bool certain;  /* it must */
    bool edge_on;  /* seen so nearly edge on that float32 does not resolve the plane: anywhere in the box */
    double lo, hi;
} RtFlatMargin;

/* For a shape with vertices[0..count), count >= 3, and that box. */
RtFlatMargin rt_flat_margin(const RtUnitLine *line, const RtVec3 *vertices, uint32_t count, const RtBox *box,
                            double delta);

#endif
