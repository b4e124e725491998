/* SPDX-License-Identifier: Apache-2.0 */
/* Bounding spheres ("balls"), in double. */
#ifndef RT_SHAPE_BALL_H
#define RT_SHAPE_BALL_H

#include "core/base/vec.h"

#include <stddef.h>

typedef struct RtBall {
    RtVec3d center;
    double radius;
} RtBall;

/* The smallest ball around coplanar `points` (count >= 1), up to rounding. It contains every point
 * exactly, because its radius is measured last. For points that are not quite coplanar it is nearly the
 * smallest. */
RtBall rt_ball_of_points(const RtVec3 *points, size_t count);

#endif
