/* SPDX-License-Identifier: Apache-2.0 */
#include "core/shape/sphere.h"

RtBox rt_sphere_box(const RtSphere *sphere) {
    RtVec3d c = rt_widen(sphere->center);
    double r = (double)sphere->radius;
    return (RtBox){{rt_float_below(c.x - r), rt_float_below(c.y - r), rt_float_below(c.z - r)},
                   {rt_float_above(c.x + r), rt_float_above(c.y + r), rt_float_above(c.z + r)}};
}

RtBall rt_sphere_ball(const RtSphere *sphere) {
    return (RtBall){rt_widen(sphere->center), (double)sphere->radius};
}

double rt_sphere_support(const RtSphere *sphere, RtVec3d direction) {
    return rt_dotd(rt_widen(sphere->center), direction) + (double)sphere->radius * rt_lengthd(direction);
}

RtVec3d rt_sphere_normal(const RtSphere *sphere, RtVec3d point) {
    return rt_normalized(rt_subd(point, rt_widen(sphere->center)));
}
