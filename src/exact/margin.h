/* SPDX-License-Identifier: Apache-2.0 */
/* Margins: which answers to a ray may be explained by rounding? They depend on the ray and the objects alone.
 *
 * The arithmetic in question subtracts the ray's origin first, and errs by up to delta (flat_margin.h). An
 * object is possible if the ray meets it grown by delta, and certain if it meets it shrunk by delta as well:
 *
 *   triangle, polygon   flat_margin.h
 *   sphere              radius +- delta
 *   cone                radius +- delta, perpendicular to its side, between heights moved by delta
 *   CSG tree            each solid by +- delta of the box of all, a subtracted one by the opposite
 *
 * The line is outside the grown object, inside the shrunk one, or between; it meets the surface in the pieces
 * between. A piece from outside to inside or back holds a crossing for certain, another piece may hold one.
 * The ends of the ray's interval move by delta, too. The first certain crossing ends the object's margin.
 *
 * An accelerator may declare that it computes with absolute coordinates (RtAccel.absolute): then delta is
 * larger by 2^-21 of the largest coordinate of the scene's box and the ray's origin. */
#ifndef RT_EXACT_MARGIN_H
#define RT_EXACT_MARGIN_H

#include "core/shape/geometry.h"
#include "exact/flat_margin.h"

/* A ray as margins need it. */
typedef struct RtMarginRay {
    RtWideRay wide;
    RtUnitLine line;
    double first, last; /* the interval as distances */
    double extra; /* added to delta: the least float32 as a difference of t, and for absolute coordinates */
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

double rt_margin_delta(const RtMarginRay *ray, const RtGeometry *geometry, uint32_t id);

/* The margin of object `id`; `asked` is a distance along the ray, or NAN. RT_NO_MEMORY for a CSG tree alone.
 */
RtStatus rt_margin_of(const RtMarginRay *ray, const RtGeometry *geometry, uint32_t id, double asked,
                      RtMargin *margin, RtError *error);

#endif
