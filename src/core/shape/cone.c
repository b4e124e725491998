/* SPDX-License-Identifier: Apache-2.0 */
#include "core/shape/cone.h"

RtStatus rt_cone_init(RtCone *cone, RtVec3 base, float base_radius, RtVec3 apex, float apex_radius,
                      RtError *error) {
    if (!(base_radius >= 0) || !(apex_radius >= 0) || (base_radius == 0 && apex_radius == 0))
        return rt_fail(error, RT_BAD_INPUT,
                       "a cone needs radii of at least 0, one of them above 0; these are %g and %g",
                       (double)base_radius, (double)apex_radius);
    RtVec3d axis = rt_subd(rt_widen(apex), rt_widen(base));
    double height = rt_lengthd(axis);
    if (!(height > 0))
        return rt_fail(error, RT_BAD_INPUT, "the two ends of the cone are the same point: move one of them");
    *cone = (RtCone){.base = base,
                     .apex = apex,
                     .base_radius = base_radius,
                     .apex_radius = apex_radius,
                     .axis = rt_normalized(axis),
                     .middle = rt_scaled(rt_addd(rt_widen(base), rt_widen(apex)), 0.5),
                     .height = height,
                     .slope = ((double)apex_radius - (double)base_radius) / height};
    return RT_OK;
}

/* The largest dot product of `direction` with a point of the disc around `center`. */
static double disc_support(const RtCone *cone, RtVec3 center, float radius, RtVec3d direction) {
    RtVec3d across = rt_add_scaledd(direction, cone->axis, -rt_dotd(direction, cone->axis));
    return rt_dotd(rt_widen(center), direction) + (double)radius * rt_lengthd(across);
}

double rt_cone_support(const RtCone *cone, RtVec3d direction) {
    return fmax(disc_support(cone, cone->base, cone->base_radius, direction),
                disc_support(cone, cone->apex, cone->apex_radius, direction));
}

RtBox rt_cone_box(const RtCone *cone) {
    RtBox box = RT_EMPTY_BOX;
    for (int a = 0; a < 3; a++) {
        RtVec3d up = {a == 0, a == 1, a == 2};
        double hi = rt_cone_support(cone, up), lo = -rt_cone_support(cone, rt_scaled(up, -1));
        double slack = 0x1p-50 * (fabs(hi) + fabs(lo) + cone->height);
        box.lo.at[a] = rt_float_below(lo - slack);
        box.hi.at[a] = rt_float_above(hi + slack);
    }
    return box;
}

/* The centre is the point of the axis with equal distance to both circles; if that is beyond an end, the
 * larger circle alone decides. */
RtBall rt_cone_ball(const RtCone *cone) {
    double r0 = (double)cone->base_radius, r1 = (double)cone->apex_radius, h = cone->height;
    double s = (h * h + r1 * r1 - r0 * r0) / (2 * h);
    s = fmin(fmax(s, 0), h);
    double to_base = sqrt(s * s + r0 * r0), to_apex = sqrt((h - s) * (h - s) + r1 * r1);
    return (RtBall){rt_add_scaledd(rt_widen(cone->base), cone->axis, s),
                    fmax(to_base, to_apex) * (1 + 0x1p-50)};
}

RtVec3d rt_cone_normal(const RtCone *cone, RtVec3d point) {
    RtVec3d from_base = rt_subd(point, rt_widen(cone->base));
    double s = rt_dotd(from_base, cone->axis);
    RtVec3d outward = rt_normalized(rt_add_scaledd(from_base, cone->axis, -s));
    return rt_normalized(rt_add_scaledd(outward, cone->axis, -cone->slope));
}
