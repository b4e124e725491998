/* SPDX-License-Identifier: Apache-2.0 */
/* Affine transforms in double: they place meshes and built-in scenes in a scene.
 *
 * A point p (a column vector) maps to m[.][0..2] p + m[.][3]. No function here creates a mirror (determinant
 * below 0), which would turn surfaces inside out: instances and meshes may have one. */
#ifndef RT_BASE_TRANSFORM_H
#define RT_BASE_TRANSFORM_H

#include "core/base/status.h"
#include "core/base/vec.h"

typedef struct RtTransform {
    double m[3][4];
} RtTransform;

RtTransform rt_transform_identity(void);

/* The image of axis `column`, 0..2; column 3 is the image of the origin. */
static inline RtVec3d rt_transform_column(const RtTransform *transform, int column) {
    return rt_vec3d(transform->m[0][column], transform->m[1][column], transform->m[2][column]);
}

/* Applies `first`, then `second`. */
RtTransform rt_transform_compose(const RtTransform *first, const RtTransform *second);

/* The functions below append a step to *transform. They reject numbers that are not finite, and what each
 * one names; messages have no file position. */

/* Scales about the origin, with a factor per axis; rejects factors that are not above 0. */
RtStatus rt_transform_scale(RtTransform *transform, RtVec3 factors, RtError *error);

/* Rotates about `axis` through the origin, counter-clockwise seen against the axis; multiples of 90
 * degrees are exact. Rejects an axis of length 0. */
RtStatus rt_transform_rotate(RtTransform *transform, RtVec3 axis, double degrees, RtError *error);

RtStatus rt_transform_translate(RtTransform *transform, RtVec3 by, RtError *error);

/* Transforms a point; rt_transform_point rounds to float32. */
RtVec3d rt_transform_pointd(const RtTransform *transform, RtVec3d point);
RtVec3 rt_transform_point(const RtTransform *transform, RtVec3 point);

/* *inverse undoes *transform, up to rounding. Rejects what would leave too few digits: a determinant of 0,
 * and lengths that grow by factors more than RT_MAX_STRETCH apart in different directions, or by more than
 * that in any. */
#define RT_MAX_STRETCH 1e6
RtStatus rt_transform_invert(const RtTransform *transform, RtTransform *inverse, RtError *error);

/* True of a mirror: a polygon whose vertices it moves shows its other side. */
bool rt_transform_mirrors(const RtTransform *transform);

/* Transforms a normal by the cofactor matrix, of which a mirror changes the sign, so that the outside stays
 * out; rt_transform_normald does not normalise. A zero vector stays zero. */
RtVec3d rt_transform_normald(const RtTransform *transform, RtVec3d normal);
RtVec3 rt_transform_normal(const RtTransform *transform, RtVec3 normal);

/* The factor by which all lengths grow, or 0 if it depends on the direction: then a sphere would not stay
 * a sphere. */
double rt_transform_uniform_scale(const RtTransform *transform);

#endif
