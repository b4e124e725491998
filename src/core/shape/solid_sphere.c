/* SPDX-License-Identifier: Apache-2.0 */
/* The unit ball under its transform: p = to_world(q), |q| <= 1. The hit is computed about the point of the
 * line nearest to the centre (core/shape/sphere.h): the half chord is sqrt(1 - |l|^2), with l the vector
 * to that point. */
#include "core/shape/solid_parts.h"

uint32_t rt_solid_sphere_crossings(const RtSolidSet *set, uint32_t index, const RtSolidRay *ray, float near,
                                   float far, RtCrossing *out) {
    RtSolidLine line = rt_solid_line(&set->solids[index], ray, rt_vec3d(0, 0, 0));
    double half_chord_squared = 1 - rt_dotd(line.near, line.near);
    if (!(half_chord_squared > 0)) return 0;
    double half = sqrt(half_chord_squared / rt_dotd(line.dir, line.dir));
    RtSpan span = {line.closest - half, line.closest + half, 0, 0};
    return rt_span_put(&span, index, near, far, out, 0);
}

RtVec3d rt_solid_sphere_normal(const RtSolidSet *set, const RtSolid *solid, uint32_t face, RtVec3d point) {
    (void)set, (void)face;
    return rt_solid_normal_to_world(solid, rt_solid_point_to_object(solid, point));
}

double rt_solid_sphere_support(const RtSolidSet *set, const RtSolid *solid, RtVec3d direction) {
    (void)set;
    RtVec3d along;
    for (int i = 0; i < 3; i++) along.at[i] = rt_dotd(direction, rt_transform_column(&solid->to_world, i));
    return rt_dotd(direction, rt_transform_column(&solid->to_world, 3)) + rt_lengthd(along);
}

RtBall rt_solid_sphere_ball(const RtSolidSet *set, const RtSolid *solid) {
    (void)set;
    const RtTransform *to_world = &solid->to_world;
    return (RtBall){rt_transform_column(to_world, 3),
                    rt_largest_stretch(rt_transform_column(to_world, 0), rt_transform_column(to_world, 1),
                                       rt_transform_column(to_world, 2))};
}

RtStatus rt_solid_add_sphere(RtSolidSet *set, const RtTransform *to_world, uint32_t *index, RtError *error) {
    RtSolid solid = {.kind = RT_SOLID_SPHERE, .to_world = *to_world};
    return rt_solid_finish(set, &solid, rt_solid_sphere_support, index, error);
}

RtStatus rt_solid_add_ellipsoid(RtSolidSet *set, RtVec3 center, RtVec3 radii, uint32_t *index,
                                RtError *error) {
    if (!(radii.x > 0 && radii.y > 0 && radii.z > 0))
        return rt_fail(error, RT_BAD_INPUT, "the radii of an ellipsoid must be above 0; these are %g, %g, %g",
                       (double)radii.x, (double)radii.y, (double)radii.z);
    RtTransform to_world = rt_transform_identity();
    RT_TRY(rt_transform_scale(&to_world, radii, error));
    RT_TRY(rt_transform_translate(&to_world, center, error));
    return rt_solid_add_sphere(set, &to_world, index, error);
}
