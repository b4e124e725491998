/* Bounding spheres, in double. */
#ifndef RT_SHAPE_BALL_H
#define RT_SHAPE_BALL_H

#include "base/vec.h"

#include <stddef.h>

typedef struct RtBall {
    RtVec3d center;
    double radius;
} RtBall;

/* The smallest ball about `points` (count >= 1), up to rounding: it contains every point exactly, because its
 * radius is measured last. Triangles and small polygons get the minimum; for more than RT_BALL_EXACT_POINTS
 * points Ritter's two-pass ball (1990) is used, at most about 5 % larger. */
#define RT_BALL_EXACT_POINTS 16
RtBall rt_ball_of_points(const RtVec3 *points, size_t count);

#endif
