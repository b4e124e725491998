/* SPDX-License-Identifier: Apache-2.0 */
/* Where on the faces of a light's cube an object is seen, and which cells it covers. All in double, in
 * offsets from the light.
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
 * one each for u - grid.u, at most 2, and its product with grid.scale. A sphere's hit function computes in
 * double: the distance of the line from its centre is at most its radius + 2^-24 of the distance from the
 * origin.
 *
 * Of the cells of the rectangle around an object's box,
 *
 * - balls (spheres, and those about cones, CSG trees and the boxes of instances) are seen in those that the
 * cone about them meets: points of the cell at depth z are at most z * half * sqrt(2) from its axis;
 * - triangles and polygons are seen in those that no edge function separates from them (bound 3). In a cell
 *   s . q <= z M, with M the largest of its corners at depth 1, so a cell is separated if d M < -margin |s|_1
 *   for M < 0 and the least depth d of the grown box. The slack is more than twice that: s, computed from a
 *   and b, is off by 2^-51 |a||b|, its products with a q as long as `reach` by 2^-50 |a||b| reach, and the
 *   margin is above 2^-18 reach. A vertex may be on the other side by as much again. If d <= 0 no cell is
 *   separated. A polygon is hit in its plane, off its vertices by its warp along one axis, which is added. A
 *   concave polygon has vertices on both sides of some edges: these separate nothing.
 *
 * The depth of a flat object in a cell is that of bound 4. An object need not be proved to cover a cell: see
 * light.h. */
#include "accel/light/light.h"

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

static double norm(RtVec3d v) {
    return fabs(v.x) + fabs(v.y) + fabs(v.z);
}

/* ---- rectangles ---- */

/* The least and largest x / z with x in [lo, hi] and z in [near, far], far > 0; z <= 0 does not count. */
static void quotients(double lo, double hi, double near, double far, double *least, double *most) {
    double least_at = lo >= 0 ? far : near, most_at = hi >= 0 ? near : far;
    *least = least_at > 0 ? lo / least_at : -INFINITY;
    *most = most_at > 0 ? hi / most_at : INFINITY;
}

bool rt_light_view(const RtLightFace *on, const RtBox *box, RtLightView *view) {
    const double margin = on->cube->margin;
    RtVec3d a = offset(on, box->lo), b = offset(on, box->hi);
    double near = fmin(a.z, b.z) - margin;
    view->near = fmax(near, 0);
    view->far = fmax(a.z, b.z) + margin;
    if (!(view->far > 0)) return false;
    for (int k = 0; k < 2; k++) {
        double least, most;
        quotients(fmin(a.at[k], b.at[k]) - margin, fmax(a.at[k], b.at[k]) + margin, near, view->far, &least,
                  &most);
        view->lo[k] = fmax(least - RT_LIGHT_EDGE, -1 - RT_LIGHT_EDGE);
        view->hi[k] = fmin(most + RT_LIGHT_EDGE, 1 + RT_LIGHT_EDGE);
        if (!(view->lo[k] <= view->hi[k])) return false;
    }
    return true;
}

/* How much v . (u, w, 1) changes from the middle of a cell at most as far as `half` to the sides. */
static double across(RtVec3d v, double half) {
    return (fabs(v.x) + fabs(v.y)) * half;
}

/* ---- flat objects ---- */

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

/* Adds the lines through the edges; hits are within `grow` of the hull of the vertices. */
static void add_edges(RtLightFootprint *f, const RtVec3d *vertices, uint32_t count, double grow) {
    const double half = 0.5 * f->width;
    f->covers = true;
    for (uint32_t i = 0; i < count; i++) {
        RtVec3d a = vertices[i], b = vertices[(i + 1) % count], line = rt_crossd(a, b);
        double lo = 0, hi = 0;
        for (uint32_t k = 0; k < count; k++) {
            double at = rt_dotd(line, vertices[k]);
            lo = fmin(lo, at);
            hi = fmax(hi, at);
        }
        const double slack = 2 * grow * (norm(line) + 0x1p-20 * norm(a) * norm(b));
        if (lo < -slack && hi > slack) { /* a concave polygon */
            f->covers = false;
            continue;
        }
        if (lo < -slack) line = rt_scaled(line, -1);
        f->edges[f->edge_count++] = (RtLightEdge){
            line, -across(line, half + RT_LIGHT_EDGE) - 2 * slack / f->near, across(line, half)};
    }
}

/* Sets the plane through `point`, off which hits are by `grow`. */
static void set_plane(RtLightFootprint *f, RtVec3d point, RtVec3d normal, double grow) {
    double at = rt_dotd(normal, point), least = fabs(at) - 2 * grow * norm(normal);
    if (!(least > 0.25 * fabs(at))) return; /* nearly seen edge on */
    f->plane = rt_scaled(normal, 1 / at);
    f->plane_across = across(f->plane, 0.5 * f->width + RT_LIGHT_EDGE);
    f->nearer = least / fabs(at);
}

static void project_flat(const RtLightFace *on, uint32_t id, const RtVec3 *vertices, uint32_t count,
                         double warp, RtLightFootprint *f) {
    const RtGeometry *g = on->geometry;
    const double grow = on->cube->margin;
    RtVec3d offsets[RT_LIGHT_MAX_EDGES];
    if (count <= RT_LIGHT_MAX_EDGES && f->near > 0) {
        for (uint32_t i = 0; i < count; i++) offsets[i] = offset(on, vertices[i]);
        add_edges(f, offsets, count, grow + warp);
    }
    if (rt_ref_shape(g->objects[id]) == RT_SHAPE_POLYGON) {
        const RtPolygon *polygon = &g->polygons[rt_ref_index(g->objects[id])];
        set_plane(f, offset_of(on, polygon->center), face_axes(on->face, polygon->normal), grow);
        return;
    }
    RtVec3d point = offset(on, vertices[0]), b = rt_subd(offset(on, vertices[1]), point),
            c = rt_subd(offset(on, vertices[2]), point), normal = rt_crossd(b, c);
    /* The normal of any other triangle is known to 2^-30 of itself. */
    bool sliver = norm(normal) < 0x1p-20 * norm(b) * norm(c);
    if (!sliver) set_plane(f, point, normal, grow);
}

/* ---- one object ---- */

bool rt_light_project(const RtLightFace *on, uint32_t id, RtLightFootprint *f) {
    const RtLightGrid *grid = on->grid;
    RtLightView view;
    uint32_t count;
    double warp;
    if (grid->columns == 0 || !rt_light_view(on, &on->geometry->boxes[id], &view)) return false;
    *f = (RtLightFootprint){.corner = {(double)grid->u, (double)grid->w},
                            .width = 1 / (double)grid->scale,
                            .near = view.near,
                            .far = view.far};
    for (int k = 0; k < 2; k++) {
        double lo = (view.lo[k] - f->corner[k]) / f->width, hi = (view.hi[k] - f->corner[k]) / f->width;
        uint32_t cells = k ? grid->rows : grid->columns;
        if (hi < 0 || lo >= cells) return false;
        f->lo[k] = lo > 0 ? (uint32_t)lo : 0;
        f->hi[k] = hi < cells ? (uint32_t)hi : cells - 1;
    }
    const RtVec3 *vertices = vertices_of(on->geometry, id, &count, &warp);
    if (vertices) {
        project_flat(on, id, vertices, count, warp, f);
        return true;
    }
    RtBall ball = rt_object_ball(on->geometry, id);
    f->center = offset_of(on, ball.center);
    f->radius = ball.radius + 2 * on->cube->margin;
    f->covers = rt_ref_shape(on->geometry->objects[id]) == RT_SHAPE_SPHERE;
    return true;
}

/* ---- one cell ---- */

/* Rounded outward by up to a column. */
bool rt_light_columns(const RtLightFootprint *f, uint32_t row, uint32_t *first, uint32_t *last) {
    const RtVec3d middle = rt_vec3d(f->corner[0] + 0.5 * f->width, f->corner[1] + (row + 0.5) * f->width, 1);
    double lo = f->lo[0], hi = f->hi[0];
    for (uint32_t i = 0; i < f->edge_count; i++) {
        const RtLightEdge *edge = &f->edges[i];
        double column = (edge->outside - rt_dotd(edge->line, middle)) / (edge->line.x * f->width);
        if (edge->line.x > 0) lo = fmax(floor(column), lo);
        if (edge->line.x < 0) hi = fmin(floor(column) + 1, hi);
    }
    if (lo > hi) return false;
    *first = (uint32_t)lo;
    *last = (uint32_t)hi;
    return true;
}

static bool see_flat(const RtLightFootprint *f, RtVec3d middle, double *near, double *cover) {
    bool covers = f->covers;
    for (uint32_t i = 0; i < f->edge_count; i++) {
        double at = rt_dotd(f->edges[i].line, middle);
        if (at < f->edges[i].outside) return false;
        covers &= at >= f->edges[i].inside;
    }
    if (covers) *cover = f->far;
    if (f->nearer > 0) {
        double inv_depth = rt_dotd(f->plane, middle), least = inv_depth - f->plane_across,
               depth = f->nearer / (inv_depth + f->plane_across);
        if (!(depth >= 0 && depth < f->far)) depth = f->far;
        if (depth > *near) *near = depth;
        if (covers && least * f->far > 1) *cover = (1 + 0x1p-20) / least;
    }
    return true;
}

static bool see_ball(const RtLightFootprint *f, RtVec3d middle, double *cover) {
    RtVec3d off_axis = rt_crossd(f->center, middle);
    double half = 1.5 * (0.5 * f->width + RT_LIGHT_EDGE); /* above sqrt(2) */
    double distance = sqrt(rt_dotd(off_axis, off_axis) / rt_dotd(middle, middle));
    double wide = half * (f->center.z + f->radius); /* the ball's points are at most so deep */
    if (f->covers && distance + wide < f->radius && rt_dotd(f->center, middle) > 0) *cover = f->far;
    return distance <= f->radius + wide;
}

bool rt_light_see(const RtLightFootprint *f, uint32_t column, uint32_t row, RtLightDepths *depths) {
    const RtVec3d middle =
        rt_vec3d(f->corner[0] + (column + 0.5) * f->width, f->corner[1] + (row + 0.5) * f->width, 1);
    double near = f->near, cover = INFINITY;
    if (!(f->radius > 0 ? see_ball(f, middle, &cover) : see_flat(f, middle, &near, &cover))) return false;
    *depths = (RtLightDepths){rt_float_below(near), (float)cover};
    return true;
}
