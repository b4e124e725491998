/* SPDX-License-Identifier: Apache-2.0 */
/* Affine transforms in double: what places meshes and built-in scenes in a scene.
 *
 * A point p (a column) goes to m[.][0..2] p + m[.][3]. Transforms keep the orientation of space (determinant
 * above 0): mirrors would turn surfaces inside out, and no function here makes one of others. */
#ifndef RT_BASE_TRANSFORM_H
#define RT_BASE_TRANSFORM_H

#include "core/base/status.h"
#include "core/base/vec.h"

typedef struct RtTransform {
    double m[3][4];
} RtTransform;

RtTransform rt_transform_identity(void);

/* Where the axis `column` goes, 0..2, and 3 the origin. */
static inline RtVec3d rt_transform_column(const RtTransform *transform, int column) {
    return rt_vec3d(transform->m[0][column], transform->m[1][column], transform->m[2][column]);
}

/* Does what `first` does, and then what `second` does. */
RtTransform rt_transform_compose(const RtTransform *first, const RtTransform *second);

/* The step makers below change *transform so that it does what it did and then the new step, and refuse, with
 * a message without a place, numbers that are not finite and what is named. */

/* Scales about the origin, along each axis; refuses factors that are not above 0. */
RtStatus rt_transform_scale(RtTransform *transform, RtVec3 factors, RtError *error);

/* Turns about `axis` through the origin, counter-clockwise for one who looks against the axis; multiples of
 * 90 degrees are exact. Refuses an axis of length 0. */
RtStatus rt_transform_rotate(RtTransform *transform, RtVec3 axis, double degrees, RtError *error);

RtStatus rt_transform_translate(RtTransform *transform, RtVec3 by, RtError *error);

/* Where a point goes; rt_transform_point rounds to float32. */
RtVec3d rt_transform_pointd(const RtTransform *transform, RtVec3d point);
RtVec3 rt_transform_point(const RtTransform *transform, RtVec3 point);

/* Where a normal goes (by the matrix of cofactors): of any length, and of unit length; a zero vector stays
 * zero. */
RtVec3d rt_transform_normald(const RtTransform *transform, RtVec3d normal);
RtVec3 rt_transform_normal(const RtTransform *transform, RtVec3 normal);

/* The factor by which all lengths grow, or 0 if lengths grow differently along different directions: then a
 * sphere would not stay a sphere. */
double rt_transform_uniform_scale(const RtTransform *transform);

#endif
