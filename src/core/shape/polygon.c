/* SPDX-License-Identifier: Apache-2.0 */
#include "core/shape/polygon.h"

/* Newell's normal: twice the area of the polygon along its normal, about vertex 0 for precision. */
static RtVec3d newell(const RtVec3 *vertices, uint32_t count) {
    RtVec3d sum = {0, 0, 0}, origin = rt_widen(vertices[0]);
    for (uint32_t i = 1; i + 1 < count; i++) {
        RtVec3d a = rt_subd(rt_widen(vertices[i]), origin), b = rt_subd(rt_widen(vertices[i + 1]), origin);
        sum = rt_addd(sum, rt_crossd(a, b));
    }
    return sum;
}

RtStatus rt_polygon_init(RtPolygon *polygon, const RtVec3 *vertices, uint32_t first, uint32_t count,
                         RtError *error) {
    if (count < 3)
        return rt_fail(error, RT_BAD_INPUT, "a polygon needs at least 3 vertices, this one has %u", count);
    RtVec3d sum = newell(vertices, count), first_vertex = rt_widen(vertices[0]), offset = {0, 0, 0};
    RtBox box = RT_EMPTY_BOX;
    for (uint32_t i = 0; i < count; i++) {
        offset = rt_addd(offset, rt_subd(rt_widen(vertices[i]), first_vertex));
        box = rt_box_add_point(box, vertices[i]);
    }
    RtVec3d center = rt_add_scaledd(first_vertex, offset, 1.0 / count);
    double size = rt_lengthd(rt_widen(rt_box_size(box)));
    double area = rt_lengthd(sum) / 2;
    if (!(area > 1e-12 * size * size))
        return rt_fail(error, RT_BAD_INPUT,
                       "the polygon has no area: its vertices lie on a line or in a point; remove it");
    RtVec3d normal = rt_normalized(sum);
    double warp = 0;
    for (uint32_t i = 0; i < count; i++) {
        double off = fabs(rt_dotd(normal, rt_subd(rt_widen(vertices[i]), center)));
        if (off > warp) warp = off; /* gcc 12 for ARM fails to compile fmax here, and below */
    }
    if (warp > RT_POLYGON_MAX_WARP * size)
        return rt_fail(
            error, RT_BAD_INPUT,
            "the polygon is not planar: a vertex is %.3g off the plane of the others; split it into "
            "triangles",
            warp);
    int dropped = rt_major_axis(rt_narrow(normal));
    *polygon = (RtPolygon){.normal = normal,
                           .center = center,
                           .first = first,
                           .count = count,
                           .u = dropped == 0 ? 1 : 0,
                           .v = dropped == 2 ? 1 : 2,
                           .warp = rt_float_above(warp / fabs(normal.at[dropped]))};
    return RT_OK;
}

static int third_axis(const RtPolygon *polygon) {
    return (int)(3 - polygon->u - polygon->v);
}

RtBox rt_polygon_box(const RtPolygon *polygon, const RtVec3 *vertices) {
    RtBox box = RT_EMPTY_BOX;
    for (uint32_t i = 0; i < polygon->count; i++) box = rt_box_add_point(box, vertices[i]);
    int w = third_axis(polygon);
    box.lo.at[w] = rt_float_below((double)box.lo.at[w] - (double)polygon->warp);
    box.hi.at[w] = rt_float_above((double)box.hi.at[w] + (double)polygon->warp);
    return box;
}

RtBall rt_polygon_ball(const RtPolygon *polygon, const RtVec3 *vertices) {
    RtBall ball = rt_ball_of_points(vertices, polygon->count);
    ball.radius += (double)polygon->warp;
    return ball;
}

double rt_polygon_support(const RtPolygon *polygon, const RtVec3 *vertices, RtVec3d direction) {
    double most = rt_dotd(rt_widen(vertices[0]), direction);
    for (uint32_t i = 1; i < polygon->count; i++) {
        double along = rt_dotd(rt_widen(vertices[i]), direction);
        if (along > most) most = along;
    }
    return most + (double)polygon->warp * fabs(direction.at[third_axis(polygon)]);
}
