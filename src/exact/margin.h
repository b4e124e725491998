/* SPDX-License-Identifier: Apache-2.0 */
/* Margins: which answers to a ray may be explained by rounding? They depend on the ray and the objects alone.
 * Places along a line are distances from its origin; all arithmetic is double, whose own error is 2^-30 of
 * any bound here.
 *
 * The arithmetic in question subtracts the ray's origin from float32 coordinates, and then works in float32.
 * Its error for an object moves each vertex by up to
 *
 *     delta = 2^-20 * the distance from the origin to the far corner of the object's box      (16 half-ulps)
 *
 * An object is possible if the ray meets it grown by delta, and certain if it meets it shrunk by delta as
 * well:
 *
 *   triangle, polygon   below
 *   sphere              radius +- delta
 *   cone                radius +- delta, perpendicular to its side, between heights moved by delta
 *   CSG tree            each solid by +- delta of the box of all, a subtracted one by the opposite
 *
 * The line is outside the grown object, inside the shrunk one, or between; it meets the surface in the pieces
 * between. A piece from outside to inside or back holds a crossing for certain, another piece may hold one.
 * The ends of the ray's interval move by delta, too. The first certain crossing ends the object's margin.
 *
 * An accelerator may declare that it computes with absolute coordinates (RtAccel.absolute): then delta is
 * larger by 2^-21 of the largest coordinate of the scene's box and the ray's origin.
 *
 * Instances. An object in a part has its margin there, for the ray that the inverse of the matrix moves into
 * the part. An accelerator may invert and move in float32, at each level, or move the part's points instead.
 * With u = 2^-24, C the cofactors of the matrix M with sums in place of differences, W = C / |det M|, and r
 * the largest coordinate of the part, Cramer's rule moves a point p of the ray, at most q, as follows.
 * Cofactors err by 4u C, and the division by 3u: 7u W (q + |at|). The determinant errs by 8u of its products
 * without signs, which scales the part: 8u W |M| r. Moving adds 4u of the origin's, 8u of the direction's (t
 * |dir| <= 2 q) and 5u of |at|'s part. A moved point of the part errs by 4u W (|M| r + |at|), and its
 * rounding by u q. That is less than
 *
 *     2^-19 W (q + |at| + |M| r)                                                           (32u, per axis)
 *
 * and the inverse moves what the levels outside are off by; delta is larger by the length of the sum. Ours
 * round once a level, from doubles, and are far below it. Where float32 cannot invert, nothing is certain.
 *
 * Ours also clamp t to the interval of the instance's thick box. That contains the exact t of a hit, so t
 * does not leave the piece of a certain crossing. The pieces of others are extended to the ends of the
 * interval. */
#ifndef RT_EXACT_MARGIN_H
#define RT_EXACT_MARGIN_H

#include "core/shape/geometry.h"
#include "exact/exact.h"

/* ---- flat shapes: flat_margin.c ----
 *
 * An edge function is a triple product of a vertex, an edge and the direction; it decides correctly if the
 * line passes the edge, as seen along the line, by delta, and by delta * longest / edge where the edge is a
 * difference of longer ones. The plane of a shape with longest side L and area A moves by delta * L^2 / 2A
 * within the shape, at least by delta. In the plane both distances are divided by the cosine between line and
 * normal. Vertices of a polygon that are not in its plane add their distance from it. */

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

/* ---- all objects ---- */

/* A ray as margins need it. */
typedef struct RtMarginRay {
    RtWideRay wide;
    RtUnitLine line;
    double first, last; /* the interval as distances */
    double
        extra; /* added to delta: the least float32 as a difference of t; for absolute coordinates; |off| */
    bool absolute;
    RtVec3d off;         /* by how far the ray may be off in a part */
    double scale;        /* distances outside per distance here */
    double enter, leave; /* t to which the pieces of uncertain crossings are extended in a part */
    bool unclear;        /* moved beyond the range of float32: anything there may be hit anywhere */
} RtMarginRay;

/* For a valid ray. */
RtMarginRay rt_margin_ray(const RtGeometry *geometry, const RtRay *ray, bool absolute);

typedef struct RtMargin {
    bool possible, certain;
    double earliest; /* distance at which it may be hit; HUGE_VAL: nowhere */
    double latest;   /* if certain: by this distance it is hit */
    bool holds;      /* it may be hit at `asked` */
    double lo, hi;   /* if so: the piece of the line with that hit */
    bool edge_on;    /* as of RtFlatMargin */
} RtMargin;

/* delta of object `id`, as a distance along the ray. */
double rt_margin_delta(const RtMarginRay *ray, const RtGeometry *geometry, uint32_t id);

/* The margin of object `id`; `asked` is a distance along the ray, or NAN. RT_NO_MEMORY for a CSG tree alone.
 */
RtStatus rt_margin_of(const RtMarginRay *ray, const RtGeometry *geometry, uint32_t id, double asked,
                      RtMargin *margin, RtError *error);

/* Calls see(context, id, margin) for each object that is possible, in order of ids. */
typedef void RtMarginVisitor(void *context, uint32_t id, const RtMargin *margin);
RtStatus rt_margin_of_all(const RtMarginRay *ray, const RtGeometry *geometry, double asked,
                          RtMarginVisitor *see, void *context, RtError *error);

#endif
