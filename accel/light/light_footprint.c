/* SPDX-License-Identifier: Apache-2.0 */
/* Where on the faces of a light's cube an object is seen, and what covers whole cells. All in double, in
 * offsets from the light; light_draw.h does the same for small triangles in lanes.
 *
 * Why the lists are complete: the bounds of accel/raster/raster.h, with E = margin. A hit is off the object's
 * box by 2^-20 of the distance from the ray's origin, 2^-22 of the length of dir, and 2^-22 of the
 * coordinates; dir is the difference of light and origin in float32, which moves the ray off the true segment
 * by another 2^-24 of its length. For origins inside `domain` all of these together are below
 *
 *     margin = 2^-18 * reach + 2^-20 * farthest.
 *
 * So the true segment meets the grown box at a depth between 0 and that of the origin, in the cell of the
 * segment's direction. u and w of a ray are known to 2^-21: dir.b / dir.a but for two roundings of 2^-24, and
 * one each for u - grid.u, at most 2, and its product with grid.scale; so is its place among the parts of the
 * cell. A sphere's hit function computes in double: the distance of the line from its centre is at most its
 * radius + 2^-24 of the distance from the origin.
 *
 * Of the cells of the rectangle around an object's box,
 *
 * - balls (spheres, and those about cones and CSG trees) touch those that the cone about them meets: points
 * of the cell at depth z are at most z * half * sqrt(2) from its axis;
 * - triangles and polygons touch those that no edge function separates from them (bound 3). In a cell s . q
 * <= z M, with M the largest of its corners at depth 1, so a cell is separated if d M < -margin |s|_1 for M <
 * 0 and the least depth d of the grown box. The slack is more than twice that: s, computed from a and b, is
 * off by 2^-51 |a||b|, its products with a q as long as `reach` by 2^-50 |a||b| reach, and the margin is
 * above 2^-18 reach. If d <= 0 no cell is separated. A polygon is hit in its plane, off its vertices by its
 * warp along one axis, which is added. A concave polygon has vertices on both sides of some edges: these
 * separate nothing.
 * - Other shapes touch all cells of the rectangle, and cover none.
 *
 * Their depth in a cell is that of bound 4. What covers a cell need not be proved: see light.h. */
#include "accel/light/light.h"

#include <assert.h>

static RtVec3d face_axes(int face, RtVec3d v) {
    int axis = face / 2;
    double depth = v.at[axis];
    return rt_vec3d(v.at[(axis + 1) % 3], v.at[(axis + 2) % 3], face % 2 ? depth : -depth);
}

/* Relative to the light, in the axes of a face: u and w times depth, and depth. */
static RtVec3d offset_of(const RtLightFace *on, RtVec3d point) {
    return face_axes(on->face, rt_subd(point, rt_widen(on->position)));
}

static RtVec3d offset(const RtLightFace *on, RtVec3 point) {
    return offset_of(on, rt_widen(point));
}

/* A box grown by the margin. */
static void grow_box(const RtLightFace *on, const RtBox *box, RtVec3d *lo, RtVec3d *hi) {
    RtVec3d a = offset(on, box->lo), b = offset(on, box->hi);
    for (int k = 0; k < 3; k++) {
        lo->at[k] = fmin(a.at[k], b.at[k]) - on->cube->margin;
        hi->at[k] = fmax(a.at[k], b.at[k]) + on->cube->margin;
    }
}

bool rt_light_is_in(const RtLightFace *on, const RtBox *box) {
    RtVec3d lo, hi;
    grow_box(on, box, &lo, &hi);
    return lo.x <= 0 && hi.x >= 0 && lo.y <= 0 && hi.y >= 0 && lo.z <= 0 && hi.z >= 0;
}

/* The least and largest x / z with x in [lo, hi] and z in [near, far], far > 0; z <= 0 does not count. */
static void quotients(double lo, double hi, double near, double far, double *least, double *most) {
    double least_at = lo >= 0 ? far : near, most_at = hi >= 0 ? near : far;
    *least = least_at > 0 ? lo / least_at : -INFINITY;
    *most = most_at > 0 ? hi / most_at : INFINITY;
}

bool rt_light_view(const RtLightFace *on, const RtBox *box, RtLightView *view) {
    RtVec3d lo, hi;
    grow_box(on, box, &lo, &hi);
    if (!(hi.z > 0)) return false;
    for (int k = 0; k < 2; k++) {
        double least, most;
        quotients(lo.at[k], hi.at[k], lo.z, hi.z, &least, &most);
        view->lo[k] = fmax(least - RT_LIGHT_EDGE, -1 - RT_LIGHT_EDGE);
        view->hi[k] = fmin(most + RT_LIGHT_EDGE, 1 + RT_LIGHT_EDGE);
        if (!(view->lo[k] <= view->hi[k])) return false;
    }
    view->near = fmax(lo.z, 0);
    view->far = hi.z;
    return true;
}

/* The rounding of float32 in columns and rows, as a part of a cell or tile. */
#define SLACK 0x1p-6

/* The vertices of a flat object; NULL of another. A point hit is within *warp of their hull. */
static const RtVec3 *vertices_of(const RtGeometry *g, uint32_t id, uint32_t *count, double *warp) {
    uint32_t index = rt_ref_index(g->objects[id]);
    *count = 3;
    *warp = 0;
    if (rt_ref_shape(g->objects[id]) == RT_SHAPE_TRIANGLE) return g->triangles[index].v;
    if (rt_ref_shape(g->objects[id]) != RT_SHAPE_POLYGON) return NULL;
    *count = g->polygons[index].count;
    *warp = (double)g->polygons[index].warp;
    return g->polygon_vertices + g->polygons[index].first;
}

/* Narrows the view of a flat object that is all in front of the light to the hull of its vertices, each grown
 * by the margin. False if it is not on the face. */
static bool narrow_view(const RtLightFace *on, uint32_t id, RtLightView *view) {
    uint32_t count;
    double warp, least[2] = {INFINITY, INFINITY}, most[2] = {-INFINITY, -INFINITY};
    const RtVec3 *vertices = vertices_of(on->geometry, id, &count, &warp);
    double grow = on->cube->margin + warp;
    if (!vertices) return true;
    for (uint32_t i = 0; i < count; i++) {
        RtVec3d at = offset(on, vertices[i]);
        if (!(at.z > 2 * grow)) return true;
        for (int k = 0; k < 2; k++) {
            double lo, hi;
            quotients(at.at[k] - grow, at.at[k] + grow, at.z - grow, at.z + grow, &lo, &hi);
            least[k] = fmin(lo, least[k]);
            most[k] = fmax(hi, most[k]);
        }
    }
    for (int k = 0; k < 2; k++) {
        view->lo[k] = fmax(least[k] - RT_LIGHT_EDGE, view->lo[k]);
        view->hi[k] = fmin(most[k] + RT_LIGHT_EDGE, view->hi[k]);
        if (!(view->lo[k] <= view->hi[k])) return false;
    }
    return true;
}

bool rt_light_footprint(const RtLightFace *on, uint32_t id, RtLightFootprint *footprint) {
    const RtLightGrid *grid = on->grid;
    RtLightView view;
    if (grid->columns == 0 || !rt_light_view(on, &on->geometry->boxes[id], &view)) return false;
    if (!narrow_view(on, id, &view)) return false;
    for (int k = 0; k < 2; k++) {
        double corner = (double)(k ? grid->w : grid->u), scale = (double)grid->scale;
        uint32_t count = k ? grid->rows : grid->columns;
        double lo = (view.lo[k] - corner) * scale - SLACK, hi = (view.hi[k] - corner) * scale + SLACK;
        if (hi < 0 || lo >= count) return false;
        footprint->lo[k] = lo > 0 ? (uint32_t)lo : 0;
        footprint->hi[k] = hi < count ? (uint32_t)hi : count - 1;
        footprint->least[k] = (float)((view.lo[k] - corner) * scale);
        footprint->most[k] = (float)((view.hi[k] - corner) * scale);
    }
    footprint->near = rt_float_below(view.near);
    footprint->far = rt_float_above(view.far);
    return true;
}

uint32_t rt_light_place(const RtLightFace *on, uint32_t id, RtTileRange *to) {
    RtLightFootprint at;
    if (!rt_light_footprint(on, id, &at)) return 0;
    *to = (RtTileRange){.object = on->geometry->objects[id] | RT_LIGHT_BY_FOOTPRINT,
                        .lo = {(uint16_t)at.lo[0], (uint16_t)at.lo[1]},
                        .hi = {(uint16_t)at.hi[0], (uint16_t)at.hi[1]},
                        .layer = (uint16_t)on->face};
    return 1;
}

RtLightCells rt_light_cells(const RtLightTile *tile, const RtLightFootprint *footprint) {
    RtLightCells at;
    for (int k = 0; k < 2; k++) {
        double from = k ? tile->row : tile->column, n = tile->n;
        double lo = ((double)footprint->least[k] - from) * n - SLACK;
        double hi = ((double)footprint->most[k] - from) * n + SLACK;
        lo = fmin(fmax(lo, -1), n + 1);
        hi = fmin(fmax(hi, -1), n + 1);
        at.lo[k] = (int32_t)fmax(floor(lo), 0);
        at.hi[k] = (int32_t)fmin(floor(hi), n - 1);
        at.part_lo[k] = (int32_t)floor(RT_LIGHT_PART * lo);
        at.part_hi[k] = (int32_t)floor(RT_LIGHT_PART * hi);
    }
    return at;
}

/* A tile on its face: direction (u, w) of its corner, and cells per 1 of it. */
typedef struct Frame {
    double u, w, scale;
} Frame;

static Frame frame_of(const RtLightTile *tile) {
    const RtLightGrid *grid = tile->on.grid;
    double scale = (double)grid->scale;
    return (Frame){(double)grid->u + tile->column / scale, (double)grid->w + tile->row / scale,
                   scale * tile->n};
}

/* ---- flat objects ---- */

static double norm(RtVec3d v) {
    return fabs(v.x) + fabs(v.y) + fabs(v.z);
}

/* v . (u, w, 1) in columns and rows. */
static void in_cells(const Frame *frame, RtVec3d v, double out[3]) {
    out[0] = v.x / frame->scale;
    out[1] = v.y / frame->scale;
    out[2] = v.x * frame->u + v.y * frame->w + v.z;
}

static void narrow(const double from[3], double by, float to[3]) {
    for (int k = 0; k < 3; k++) to[k] = (float)(from[k] * by);
}

/* How much v . (u, w, 1) changes from the middle of a cell to its borders, and a little beyond. */
static double across_cell(const Frame *frame, RtVec3d v) {
    return (fabs(v.x) + fabs(v.y)) * ((0.5 + SLACK) / frame->scale + RT_LIGHT_EDGE);
}

/* Adds the lines through the edges. */
static void add_edges(RtLightOutline *o, const Frame *frame, const RtVec3d *vertices, uint32_t count,
                      double grow, double least_depth) {
    for (uint32_t i = 0; i < count; i++) {
        RtVec3d a = vertices[i], b = vertices[(i + 1) % count], side = rt_crossd(a, b);
        double lo = 0, hi = 0;
        for (uint32_t k = 0; k < count; k++) {
            double at = rt_dotd(side, vertices[k]);
            lo = fmin(lo, at);
            hi = fmax(hi, at);
        }
        double slack = 2 * grow * (norm(side) + 0x1p-20 * norm(a) * norm(b)), line[3];
        bool positive = lo > -slack, negative = hi < slack;
        in_cells(frame, side, line);
        double unit = fabs(line[0]) + fabs(line[1]);
        o->covers = o->covers && positive != negative && unit > 0x1p-60 * norm(side);
        if (!(unit > 0x1p-60 * norm(side))) continue;
        if (o->covers) narrow(line, (positive ? 1 : -1) / unit, o->inside[i]);
        /* What is seen edge on is on both sides. */
        double around = across_cell(frame, side) + 2 * slack / least_depth;
        around += 0x1p-20 * (fabs(line[2]) + around + unit * 2 * RT_LIGHT_MAX_RESOLUTION);
        for (int sign = -1; sign <= 1; sign += 2) {
            if (!(sign > 0 ? positive : negative)) continue;
            const double part[3] = {sign * line[0], sign * line[1], sign * line[2] + around};
            narrow(part, 1 / unit, o->parts[o->count++]);
        }
    }
}

/* The plane through `point`. */
static void add_plane(RtLightOutline *o, const Frame *frame, RtVec3d point, RtVec3d normal, double grow) {
    double at = rt_dotd(normal, point), plane[3];
    if (at < 0) normal = rt_scaled(normal, -1), at = -at;
    double least = at - 2 * grow * norm(normal) - 0x1p-40 * norm(normal) * norm(point);
    in_cells(frame, normal, plane);
    if (!(least > 0.25 * at)) {
        o->covers = false;
        return;
    }
    narrow(plane, 1 / at, o->face);
    plane[2] += across_cell(frame, normal);
    plane[2] += 0x1p-20 * (fabs(plane[2]) + 2 * RT_LIGHT_MAX_RESOLUTION * (fabs(plane[0]) + fabs(plane[1])));
    narrow(plane, 1 / least, o->slope);
}

void rt_light_outline(const RtLightTile *tile, uint32_t id, const RtLightFootprint *at, RtLightOutline *o) {
    const RtLightFace *on = &tile->on;
    const RtGeometry *g = on->geometry;
    const Frame frame = frame_of(tile);
    uint32_t count;
    double grow = on->cube->margin, warp;
    RtVec3d offsets[RT_LIGHT_MAX_EDGES], normal, point;
    const RtVec3 *vertices = vertices_of(g, id, &count, &warp);
    assert(vertices);
    *o = (RtLightOutline){.covers = count <= RT_LIGHT_MAX_EDGES, .edges = count, .slope = {0, 0, INFINITY}};
    if (o->covers && at->near > 0) {
        for (uint32_t i = 0; i < count; i++) offsets[i] = offset(on, vertices[i]);
        add_edges(o, &frame, offsets, count, grow + warp, (double)at->near);
    } else {
        o->covers = false;
    }
    if (rt_ref_shape(g->objects[id]) == RT_SHAPE_POLYGON) {
        const RtPolygon *polygon = &g->polygons[rt_ref_index(g->objects[id])];
        normal = face_axes(on->face, polygon->normal);
        point = offset_of(on, polygon->center);
    } else {
        point = offset(on, vertices[0]);
        RtVec3d b = rt_subd(offset(on, vertices[1]), point);
        normal = rt_crossd(b, rt_subd(offset(on, vertices[2]), point));
        grow += 0x1p-40 * norm(point);
    }
    add_plane(o, &frame, point, normal, grow);
}

/* ---- round objects ---- */

/* The direction of column x, row y, at depth 1. */
static RtVec3d direction(const Frame *frame, double x, double y) {
    return rt_vec3d(frame->u + x / frame->scale, frame->w + y / frame->scale, 1);
}

/* Squared distance of a point from the line through the light along `axis`. */
static double distance_squared(RtVec3d point, RtVec3d axis) {
    RtVec3d across = rt_crossd(point, axis);
    return rt_dotd(across, across) / rt_dotd(axis, axis);
}

bool rt_light_touches(const RtLightTile *tile, uint32_t id, uint32_t column, uint32_t row) {
    const Frame frame = frame_of(tile);
    RtBall ball = rt_object_ball(tile->on.geometry, id);
    RtVec3d center = offset_of(&tile->on, ball.center);
    double radius = ball.radius + 2 * tile->on.cube->margin;
    double half = 1.5 * ((0.5 + SLACK) / frame.scale + RT_LIGHT_EDGE); /* above sqrt(2) */
    double reach = radius + half * (center.z + radius); /* a ball's points are at most so deep */
    return distance_squared(center, direction(&frame, column + 0.5, row + 0.5)) <= reach * reach;
}

bool rt_light_covers(const RtLightTile *tile, uint32_t id, uint32_t column, uint32_t row, float *depth) {
    const RtGeometry *g = tile->on.geometry;
    if (rt_ref_shape(g->objects[id]) != RT_SHAPE_SPHERE) return false;
    const RtSphere *sphere = &g->spheres[rt_ref_index(g->objects[id])];
    const Frame frame = frame_of(tile);
    RtVec3d center = offset(&tile->on, sphere->center);
    RtVec3d corner = direction(&frame, column, row);
    double radius = (double)sphere->radius;
    if (!(rt_dotd(center, corner) > 0) || !(distance_squared(center, corner) < radius * radius)) return false;
    *depth = (float)center.z;
    return true;
}
