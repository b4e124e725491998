/* SPDX-License-Identifier: Apache-2.0 */
/* Where on the faces of a light's cube an object is seen, and what covers whole cells. All in double, in
 * offsets from the light. An object is seen within the rectangle around its box; of the cells there,
 *
 * - balls (spheres, and those about cones) touch those that the cone that they fill meets: points of the cell
 *   at depth z are at most z * half * sqrt(2) from its axis;
 * - triangles and polygons touch those that no plane through the light and an edge parts from them. Let s be
 *   the normal of such a plane, all vertices on its side s . v >= 0 but for rounding. A hit lies within the
 *   margin of the object along each axis, for the reasons given in build.c and side.h, and so at
 *   s . p >= -margin |s|_1; a polygon is hit in its plane, off its vertices by its warp along one axis, which
 *   is added. The cell's points of depth z have s . p <= z M, where M is the largest of its corners at
 * depth 1. With M < 0 and z at least the least depth d of the grown box: none in common if d M < -margin
 * |s|_1. The slack is more than twice that: s, computed from a and b, is off by 2^-51 |a||b|, its products
 * with a p as long as `reach` by 2^-50 |a||b| reach, where the margin is above 2^-18 reach. Where the light
 * is within the margin of the object's depth (d <= 0) no cell is parted. A concave polygon has vertices on
 * both sides of some edges, which then part nothing.
 * - Other shapes touch all cells of the rectangle, and cover none. */
#include "accel/light/light.h"

/* An offset from the light in the axes of a face: u, w, depth. */
static RtVec3d face_axes(int face, RtVec3d v) {
    int axis = face / 2;
    double depth = v.at[axis];
    return rt_vec3d(v.at[(axis + 1) % 3], v.at[(axis + 2) % 3], face % 2 ? depth : -depth);
}

static RtVec3d offsetd(const RtLightBuffer *buffer, uint32_t light, int face, RtVec3d point) {
    return face_axes(face, rt_subd(point, rt_widen(buffer->base.scene->lights[light].position)));
}

static RtVec3d offset(const RtLightBuffer *buffer, uint32_t light, int face, RtVec3 point) {
    return offsetd(buffer, light, face, rt_widen(point));
}

/* The object's box, grown by the margin. */
static void grown_box(const RtLightBuffer *buffer, uint32_t light, int face, uint32_t id, RtVec3d *lo,
                      RtVec3d *hi) {
    const RtBox *box = &buffer->base.scene->geometry.boxes[id];
    RtVec3d a = offset(buffer, light, face, box->lo), b = offset(buffer, light, face, box->hi);
    for (int k = 0; k < 3; k++) {
        lo->at[k] = fmin(a.at[k], b.at[k]) - buffer->margin[light];
        hi->at[k] = fmax(a.at[k], b.at[k]) + buffer->margin[light];
    }
}

bool rt_light_is_near(const RtLightBuffer *buffer, uint32_t light, uint32_t id) {
    RtVec3d lo, hi;
    grown_box(buffer, light, 1, id, &lo, &hi);
    return lo.x <= 0 && hi.x >= 0 && lo.y <= 0 && hi.y >= 0 && lo.z <= 0 && hi.z >= 0;
}

/* The least and largest x / z with x in [lo, hi] and z in [near, far], far > 0; z <= 0 does not count. */
static void quotients(double lo, double hi, double near, double far, double *least, double *most) {
    double least_at = lo >= 0 ? far : near, most_at = hi >= 0 ? near : far;
    *least = least_at > 0 ? lo / least_at : -INFINITY;
    *most = most_at > 0 ? hi / most_at : INFINITY;
}

bool rt_light_footprint(const RtLightBuffer *buffer, uint32_t light, int face, uint32_t id,
                        RtLightFootprint *footprint) {
    RtVec3d lo, hi;
    grown_box(buffer, light, face, id, &lo, &hi);
    if (!(hi.z > 0)) return false;
    for (int k = 0; k < 2; k++) {
        double least, most;
        quotients(lo.at[k], hi.at[k], lo.z, hi.z, &least, &most);
        least -= RT_LIGHT_EDGE;
        most += RT_LIGHT_EDGE;
        if (least > 1 || most < -1) return false;
        footprint->lo[k] = rt_light_column(buffer, least);
        footprint->hi[k] = rt_light_column(buffer, most);
    }
    footprint->depth = lo.z > 0 ? rt_float_below(lo.z) : 0;
    return true;
}

/* ---- cells ---- */

/* The middle of a cell, at depth 1. */
static RtVec3d cell_axis(const RtLightBuffer *buffer, uint32_t column, uint32_t row) {
    return rt_vec3d((2.0 * column + 1) / buffer->n - 1, (2.0 * row + 1) / buffer->n - 1, 1);
}

/* Squared distance of a point from the line through the light along `axis`. */
static double distance_squared(RtVec3d point, RtVec3d axis) {
    RtVec3d across = rt_crossd(point, axis);
    return rt_dotd(across, across) / rt_dotd(axis, axis);
}

/* A ball's points are at most center.z + radius deep. */
static bool ball_touches(const RtLightBuffer *buffer, RtVec3d center, double radius, RtVec3d axis) {
    double half = 1.5 * (1.0 / buffer->n + RT_LIGHT_EDGE); /* above sqrt(2) */
    double reach = radius + half * (center.z + radius);
    return distance_squared(center, axis) <= reach * reach;
}

static double norm(RtVec3d v) {
    return fabs(v.x) + fabs(v.y) + fabs(v.z);
}

/* Flat objects of more vertices are taken for their boxes: the test of all edges against all vertices is not
 * worth it. */
enum { MAX_EDGES = 8 };

/* Does no plane through the light and an edge part the vertices, grown by `grow`, from the cell? */
static bool outline_touches(const RtLightBuffer *buffer, const RtVec3d *vertices, uint32_t count, double grow,
                            double least_depth, RtVec3d axis) {
    double half = 1.0 / buffer->n + RT_LIGHT_EDGE;
    for (uint32_t i = 0; i < count; i++) {
        RtVec3d a = vertices[i], b = vertices[(i + 1) % count], side = rt_crossd(a, b);
        double lo = 0, hi = 0, middle = rt_dotd(side, axis), around = half * (fabs(side.x) + fabs(side.y));
        for (uint32_t k = 0; k < count; k++) {
            double at = rt_dotd(side, vertices[k]);
            lo = fmin(lo, at);
            hi = fmax(hi, at);
        }
        double slack = 2 * grow * (norm(side) + 0x1p-20 * norm(a) * norm(b));
        if (lo > -slack && least_depth * (middle + around) < -2 * slack) return false;
        if (hi < slack && least_depth * (middle - around) > 2 * slack) return false;
    }
    return true;
}

bool rt_light_touches(const RtLightBuffer *buffer, uint32_t light, int face, uint32_t id, uint32_t column,
                      uint32_t row) {
    const RtGeometry *g = &buffer->base.scene->geometry;
    uint32_t index = rt_ref_index(g->objects[id]), count = 3;
    RtVec3d axis = cell_axis(buffer, column, row), lo, hi, offsets[MAX_EDGES];
    double grow = buffer->margin[light];
    const RtVec3 *vertices;
    switch (rt_ref_shape(g->objects[id])) {
    case RT_SHAPE_SPHERE:
    case RT_SHAPE_CONE:
    case RT_SHAPE_CSG: {
        RtBall ball = rt_object_ball(g, id);
        return ball_touches(buffer, offsetd(buffer, light, face, ball.center), ball.radius + 2 * grow, axis);
    }
    case RT_SHAPE_TRIANGLE: vertices = g->triangles[index].v; break;
    case RT_SHAPE_POLYGON:
        vertices = g->polygon_vertices + g->polygons[index].first;
        count = g->polygons[index].count;
        grow += (double)g->polygons[index].warp;
        break;
    default: return true;
    }
    grown_box(buffer, light, face, id, &lo, &hi);
    if (count > MAX_EDGES || !(lo.z > 0)) return true;
    for (uint32_t i = 0; i < count; i++) offsets[i] = offset(buffer, light, face, vertices[i]);
    return outline_touches(buffer, offsets, count, grow, lo.z, axis);
}

/* ---- covering ---- */

static bool sphere_covers(RtVec3d center, double radius, const RtVec3d corners[4]) {
    for (int k = 0; k < 4; k++) {
        if (!(rt_dotd(center, corners[k]) > 0)) return false;
        if (!(distance_squared(center, corners[k]) < radius * radius * (1 - 0x1p-10))) return false;
    }
    return true;
}

/* Are all corners on the same side of all edges, that is, inside? Adds the depth of the plane at each. */
static bool polygon_covers(const RtLightBuffer *buffer, uint32_t light, int face, const RtVec3 *vertices,
                           uint32_t count, RtVec3d point, RtVec3d normal, const RtVec3d corners[4],
                           double *depth) {
    bool positive = false, negative = false;
    RtVec3d a = offset(buffer, light, face, vertices[count - 1]);
    for (uint32_t i = 0; i < count; i++) {
        RtVec3d b = offset(buffer, light, face, vertices[i]), side = rt_crossd(a, b);
        for (int k = 0; k < 4; k++) {
            double on = rt_dotd(side, corners[k]);
            positive = positive || on >= 0;
            negative = negative || on <= 0;
        }
        if (positive && negative) return false;
        a = b;
    }
    for (int k = 0; k < 4; k++) {
        double at = rt_dotd(normal, point) / rt_dotd(normal, corners[k]);
        if (!(at > 0)) return false;
        *depth = fmax(*depth, at);
    }
    return true;
}

bool rt_light_covers(const RtLightBuffer *buffer, uint32_t light, int face, uint32_t id, uint32_t column,
                     uint32_t row, float *depth) {
    const RtGeometry *g = &buffer->base.scene->geometry;
    uint32_t index = rt_ref_index(g->objects[id]);
    RtVec3d axis = cell_axis(buffer, column, row), corners[4];
    double half = 1.0 / buffer->n + RT_LIGHT_EDGE, deepest = 0;
    for (int k = 0; k < 4; k++) {
        corners[k] = rt_vec3d(axis.x + (k & 1 ? half : -half), axis.y + (k & 2 ? half : -half), 1);
    }
    bool covers = false;
    switch (rt_ref_shape(g->objects[id])) {
    case RT_SHAPE_SPHERE: {
        const RtSphere *sphere = &g->spheres[index];
        RtVec3d center = offset(buffer, light, face, sphere->center);
        covers = sphere_covers(center, (double)sphere->radius, corners);
        deepest = center.z + (double)sphere->radius;
        break;
    }
    case RT_SHAPE_TRIANGLE: {
        const RtTriangle *triangle = &g->triangles[index];
        RtVec3d a = offset(buffer, light, face, triangle->v[0]);
        RtVec3d b = rt_subd(offset(buffer, light, face, triangle->v[1]), a);
        RtVec3d c = rt_subd(offset(buffer, light, face, triangle->v[2]), a);
        covers = polygon_covers(buffer, light, face, triangle->v, 3, a, rt_crossd(b, c), corners, &deepest);
        break;
    }
    case RT_SHAPE_POLYGON: {
        const RtPolygon *polygon = &g->polygons[index];
        covers = polygon_covers(buffer, light, face, g->polygon_vertices + polygon->first, polygon->count,
                                offsetd(buffer, light, face, polygon->center),
                                face_axes(face, polygon->normal), corners, &deepest);
        break;
    }
    default: break;
    }
    *depth = rt_float_above(deepest + buffer->margin[light]);
    return covers;
}
