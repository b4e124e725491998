/* SPDX-License-Identifier: Apache-2.0 */
/* The distance of a ray from the decision boundary of an object: a hit function may differ from exact
 * arithmetic only if a slightly moved ray would be decided its way.
 *
 * The unit is the effect of rounding to float32 on a point seen from the origin: 2^-24 of the distance to
 * the farthest plane of the object's box, along the axis where it is largest. The thickness by which boxes
 * are widened (core/base/ray.h) is 16 units. */
#ifndef RT_TESTS_EXACT_BORDER_H
#define RT_TESTS_EXACT_BORDER_H

#include "exact/referee.h"

/* The result of a hit function for a ray and an object. */
typedef struct RtDecision {
    bool hit;
    float t;
} RtDecision;

/* The unit for object `id`. */
double rt_border_unit(const RtGeometry *geometry, uint32_t id, const RtWideRay *line);

/* The result of our hit function; `crossings` comes from rt_crossings_alloc. */
RtDecision rt_decision_of(const RtGeometry *geometry, uint32_t id, const RtRay *ray, RtCrossing *crossings);

/* Is it what exact arithmetic decides? A hit on an object that a line can meet more than once has to be the
 * same one: t and the exact t are no farther apart than 2^-8 of the size of the box and two units.
 * RT_UNDECIDED where that is. */
RtExactResult rt_decision_check(const RtGeometry *geometry, uint32_t id, const RtWideRay *line,
                                RtDecision decision);

/* t - exact t, an exact difference, and the same in ulps of the exact t in float32. RT_MISSED if object `id`
 * is not met. */
RtExactResult rt_referee_error(const RtGeometry *geometry, uint32_t id, const RtRay *ray, float t,
                               long double *off, long double *ulps);

/* How near to a border of the object the ray's line passes, in units. Of flat shapes it is the distance from
 * the nearest edge, or of the ray's start from the plane. Of others it is the least power of two,
 * 2^RT_BORDER_NEAR or more, by which the origin has to be moved, along one of the 26 directions of a cube's
 * faces, edges and corners, for exact arithmetic to decide like `decision`; INFINITY where 2^RT_BORDER_FAR
 * does not do. */
#define RT_BORDER_NEAR (-6)
#define RT_BORDER_FAR  20
double rt_border_distance(const RtGeometry *geometry, uint32_t id, const RtRay *ray, RtDecision decision);

#endif
