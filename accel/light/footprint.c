/* Where on the faces of a light's cube an object is seen: its box by the rectangle around it, a sphere by the
 * cone that it fills, and what covers whole cells. All in double, in offsets from the light. */
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

/* Points of the cell at depth z are at most z * half from its axis; a sphere is at most center.z + radius
 * deep.
 */
bool rt_light_touches(const RtLightBuffer *buffer, uint32_t light, int face, uint32_t id, uint32_t column,
                      uint32_t row) {
    const RtGeometry *g = &buffer->base.scene->geometry;
    if (rt_ref_shape(g->objects[id]) != RT_SHAPE_SPHERE) return true;
    const RtSphere *sphere = &g->spheres[rt_ref_index(g->objects[id])];
    RtVec3d center = offset(buffer, light, face, sphere->center);
    double radius = (double)sphere->radius + 2 * buffer->margin[light];
    double half = 1.5 * (1.0 / buffer->n + RT_LIGHT_EDGE); /* above sqrt(2) */
    double reach = radius + half * (center.z + radius);
    return distance_squared(center, cell_axis(buffer, column, row)) <= reach * reach;
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
    case RT_SHAPE_CONE:
    case RT_SHAPE_COUNT: break;
    }
    *depth = rt_float_above(deepest + buffer->margin[light]);
    return covers;
}
