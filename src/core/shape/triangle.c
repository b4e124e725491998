/* SPDX-License-Identifier: Apache-2.0 */
#include "core/shape/triangle.h"

RtBall rt_triangle_ball(const RtTriangle *triangle) {
    return rt_ball_of_points(triangle->v, 3);
}

double rt_triangle_support(const RtTriangle *triangle, RtVec3d direction) {
    double most = rt_dotd(rt_widen(triangle->v[0]), direction);
    for (int i = 1; i < 3; i++) most = fmax(most, rt_dotd(rt_widen(triangle->v[i]), direction));
    return most;
}

RtVec3d rt_triangle_normal(const RtTriangle *triangle) {
    const RtVec3 *v = triangle->v;
    return rt_normalized(rt_area_vector(rt_widen(v[0]), rt_widen(v[1]), rt_widen(v[2])));
}

RtVec3d rt_triangle_weights(const RtTriangle *triangle, RtVec3d point) {
    RtVec3d a = rt_widen(triangle->v[0]), b = rt_widen(triangle->v[1]), c = rt_widen(triangle->v[2]);
    RtVec3d whole = rt_area_vector(a, b, c);
    double ww = rt_dotd(whole, whole);
    if (!(ww > 0)) return rt_vec3d(1, 0, 0);
    double wb = rt_dotd(rt_area_vector(a, point, c), whole) / ww;
    double wc = rt_dotd(rt_area_vector(a, b, point), whole) / ww;
    return rt_vec3d(1 - wb - wc, wb, wc);
}
