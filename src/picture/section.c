/* SPDX-License-Identifier: Apache-2.0 */
#include "picture/section.h"

#include "core/base/elementary.h"

#include <string.h>

enum { SPACING = 3, MOST_CROSSINGS = 64 }; /* pixels between lines; of one line */

/* ---- extents ---- */

/* The points p with normal . (p - middle) <= at. */
typedef struct Side {
    RtVec3d normal;
    double at;
} Side;

/* A convex polytope: the intersection of its sides, in opposite pairs. */
typedef struct Polytope {
    Side sides[2 * RT_MAX_SLABS];
    uint32_t count;
    RtVec3d middle;
    double reach;     /* the largest distance of a point from the middle */
    double tolerance; /* shorter lengths are rounding: a side may touch it only in an edge or a corner */
} Polytope;

static void add_sides(Polytope *p, RtVec3d normal, double lo, double hi) {
    p->sides[p->count++] = (Side){normal, hi};
    p->sides[p->count++] = (Side){rt_scaled(normal, -1), -lo};
}

static RtVec3d axis_of_length(int axis, double length) {
    RtVec3d v = {{0, 0, 0}};
    v.at[axis] = length;
    return v;
}

/* About the origin, because a box may be infinite. */
static void add_box(Polytope *p, const RtBox *box) {
    RtVec3d most;
    for (int a = 0; a < 3; a++) {
        const double lo = (double)box->lo.at[a], hi = (double)box->hi.at[a];
        most.at[a] = fmax(fabs(lo), fabs(hi));
        add_sides(p, axis_of_length(a, 1), lo, hi);
    }
    p->reach = rt_lengthd(most);
}

static void add_oriented(Polytope *p, const RtOrientedBox *box) {
    p->middle = box->center;
    p->reach = rt_lengthd(rt_vec3d(box->half[0], box->half[1], box->half[2]));
    for (int a = 0; a < 3; a++) add_sides(p, box->axes[a], -box->half[a], box->half[a]);
}

/* The first three slabs are those of the axes. */
static void add_slabs(Polytope *p, const RtSlab *slabs, uint32_t count) {
    RtVec3d half;
    for (int a = 0; a < 3; a++) {
        p->middle.at[a] = ((double)slabs[a].lo + (double)slabs[a].hi) / 2;
        half.at[a] = ((double)slabs[a].hi - (double)slabs[a].lo) / 2;
    }
    p->reach = rt_lengthd(half);
    for (uint32_t i = 0; i < count; i++) {
        double middle = rt_dotd(p->middle, rt_slab_normals[i]);
        add_sides(p, rt_slab_normals[i], (double)slabs[i].lo - middle, (double)slabs[i].hi - middle);
    }
}

RtExtentKind rt_outline_kind(const RtBoxView *view) {
    return view->extents ? view->extents->kind : RT_EXTENT_BOX;
}

/* Of any extent but a sphere. */
static Polytope polytope_of(const RtBoxView *view) {
    const RtExtentSet *set = view->extents;
    Polytope p = {.count = 0};
    if (!set || set->kind == RT_EXTENT_BOX) {
        add_box(&p, view->box);
        return p;
    }
    if (set->kind == RT_EXTENT_OBB)
        add_oriented(&p, &set->oriented[view->extent]);
    else
        add_slabs(&p, set->slabs + (size_t)view->extent * set->slabs_each, set->slabs_each);
    p.tolerance = 1e-6 * (p.reach + rt_lengthd(p.middle));
    return p;
}

uint32_t rt_section_cut(const RtSection *section, const RtBoxView *view, RtPoint corners[RT_MAX_CORNERS]) {
    const double far = 1e9; /* pixels; each side adds a corner at most */
    const RtPoint all[4] = {{-far, -far}, {far, -far}, {far, far}, {-far, far}};
    const Polytope p = polytope_of(view);
    const RtVec3d from = rt_subd(section->on, p.middle);
    uint32_t count = 4;
    memcpy(corners, all, sizeof all);
    for (uint32_t k = 0; k < p.count && count > 0; k++) {
        const RtVec3d normal = p.sides[k].normal;
        const RtPoint in_drawing = {rt_dotd(normal, section->right) / section->scale,
                                    -rt_dotd(normal, section->up) / section->scale};
        count =
            rt_polygon_cut(corners, count, in_drawing, p.sides[k].at + p.tolerance - rt_dotd(normal, from));
    }
    for (uint32_t i = 0; i < count; i++)
        corners[i] = (RtPoint){section->origin.x + corners[i].x, section->origin.y + corners[i].y};
    return count;
}

bool rt_section_add_ball(const RtSection *section, cairo_t *cairo, RtVec3d center, double radius) {
    double off = rt_dotd(rt_subd(center, section->on), section->normal);
    if (fabs(off) >= radius) return false;
    const RtPoint middle = rt_section_point(section, center);
    if (cairo) rt_add_circle(cairo, middle, sqrt(radius * radius - off * off) * section->scale);
    return true;
}

bool rt_section_add_extent(const RtSection *section, cairo_t *cairo, const RtBoxView *view) {
    if (rt_outline_kind(view) == RT_EXTENT_SPHERE) {
        const RtBall *ball = &view->extents->balls[view->extent];
        return rt_section_add_ball(section, cairo, ball->center, ball->radius);
    }
    RtPoint corners[RT_MAX_CORNERS];
    const uint32_t count = rt_section_cut(section, view, corners);
    if (cairo) rt_add_polygon(cairo, corners, count);
    return count > 0;
}

/* ---- extents in space ---- */

/* Emits the line in which sides i and j meet, clipped by the other sides. */
static void show_edge(const Polytope *p, uint32_t i, uint32_t j, RtLineViewer viewer) {
    const Side *a = &p->sides[i], *b = &p->sides[j];
    RtVec3d along = rt_crossd(a->normal, b->normal);
    double squared = rt_dotd(along, along), from = -2 * p->reach, to = 2 * p->reach;
    if (squared < 1e-12) return;
    RtVec3d at = rt_scaled(rt_crossd(b->normal, along), a->at / squared);
    at = rt_add_scaledd(at, rt_crossd(along, a->normal), b->at / squared);
    along = rt_scaled(along, 1 / sqrt(squared));
    for (uint32_t k = 0; k < p->count; k++) {
        const Side *side = &p->sides[k];
        double speed = rt_dotd(side->normal, along);
        double room = side->at + p->tolerance - rt_dotd(side->normal, at);
        if (k == i || k == j) continue;
        if (fabs(speed) < 1e-9 && room < 0) return;
        if (speed >= 1e-9) to = fmin(to, room / speed);
        if (speed <= -1e-9) from = fmax(from, room / speed);
    }
    if (to - from <= 8 * p->tolerance) return; /* a corner */
    at = rt_add_scaledd(at, p->middle, 1);
    viewer.line(viewer.context, rt_add_scaledd(at, along, from), rt_add_scaledd(at, along, to));
}

/* Point `i` of RT_CIRCLE_CORNERS on the circle about `center` through center + u and center + v. */
static RtVec3d on_circle(RtVec3d center, RtVec3d u, RtVec3d v, uint32_t i) {
    RtTurn turn = rt_turn(360.0 * i / RT_CIRCLE_CORNERS);
    return rt_add_scaledd(rt_add_scaledd(center, u, turn.cosine), v, turn.sine);
}

/* Slightly enlarged, so that its chords lie outside: the extent may be the visible sphere itself. */
static void show_circle(RtVec3d center, RtVec3d u, RtVec3d v, RtLineViewer viewer) {
    const double wider = 1.003;
    u = rt_scaled(u, wider), v = rt_scaled(v, wider);
    for (uint32_t i = 0; i < RT_CIRCLE_CORNERS; i++)
        viewer.line(viewer.context, on_circle(center, u, v, i), on_circle(center, u, v, i + 1));
}

/* Lines of sight touch a sphere in a circle nearer than its centre. */
static void show_silhouette(const RtBall *ball, RtVec3d eye, RtLineViewer viewer) {
    RtVec3d away = rt_subd(ball->center, eye);
    double squared = rt_dotd(away, away), r = ball->radius;
    if (squared <= r * r) return;
    RtVec3d center = rt_add_scaledd(ball->center, away, -r * r / squared);
    double around = r * sqrt(1 - r * r / squared);
    RtVec3d u = rt_crossd(away, axis_of_length(fabs(away.x) < fabs(away.y) ? 0 : 1, 1));
    RtVec3d v = rt_crossd(away, u);
    show_circle(center, rt_scaled(u, around / rt_lengthd(u)), rt_scaled(v, around / rt_lengthd(v)), viewer);
}

static void show_ball(const RtBall *ball, RtVec3d eye, RtLineViewer viewer) {
    for (int a = 0; a < 3; a++)
        show_circle(ball->center, axis_of_length((a + 1) % 3, ball->radius),
                    axis_of_length((a + 2) % 3, ball->radius), viewer);
    show_silhouette(ball, eye, viewer);
}

void rt_outline_edges(const RtBoxView *view, RtVec3d eye, RtLineViewer viewer) {
    if (rt_outline_kind(view) == RT_EXTENT_SPHERE) {
        show_ball(&view->extents->balls[view->extent], eye, viewer);
        return;
    }
    const Polytope p = polytope_of(view);
    for (uint32_t i = 0; i < p.count; i++) {
        for (uint32_t j = i + 1; j < p.count; j++) show_edge(&p, i, j, viewer);
    }
}

/* ---- objects ---- */

static void add_flat(const RtSection *section, cairo_t *cairo, const RtVec3 *corners, uint32_t count) {
    RtPoint cut[2];
    int crossings = 0;
    for (uint32_t i = 0; i < count && crossings < 2; i++) {
        RtVec3d a = rt_widen(corners[i]), b = rt_widen(corners[(i + 1) % count]);
        double at_a = rt_dotd(rt_subd(a, section->on), section->normal);
        double at_b = rt_dotd(rt_subd(b, section->on), section->normal);
        if ((at_a < 0) == (at_b < 0)) continue;
        const RtVec3d at = rt_add_scaledd(a, rt_subd(b, a), at_a / (at_a - at_b));
        cut[crossings++] = rt_section_point(section, at);
    }
    if (crossings == 2) rt_add_line(cairo, cut[0], cut[1]);
}

/* The outline around a crossing: a line along the surface, within the plane. `along`: the direction of the
 * line that crosses; another one, across it, draws surfaces that are nearly parallel to this one. */
static void add_tangent(const RtSection *section, cairo_t *cairo, RtVec3d at, RtVec3d normal, RtVec3d along) {
    RtVec3d tangent = rt_crossd(normal, section->normal);
    double length = rt_lengthd(tangent), slant = fabs(rt_dotd(normal, along));
    if (!(length > 1e-6) || slant < 0.6 * length) return;
    RtVec3d half = rt_scaled(tangent, (double)SPACING / section->scale / length);
    RtPoint from = rt_section_point(section, rt_subd(at, half)),
            to = rt_section_point(section, rt_addd(at, half));
    cairo_move_to(cairo, from.x, from.y);
    cairo_line_to(cairo, to.x, to.y);
}

/* Follows one line of the plane through the object. */
static void add_crossings(const RtSection *section, cairo_t *cairo, const RtGeometry *g, uint32_t id,
                          RtVec3d from, RtVec3d along, RtHitMemory *hit_memory) {
    RtRay ray = {.org = rt_narrow(from), .dir = rt_narrow(along), .tmax = INFINITY};
    RtPreparedRay prepared;
    float t;
    for (int i = 0; i < MOST_CROSSINGS; i++) {
        rt_hit_ray(&prepared, g, &ray, hit_memory);
        if (!rt_object_hit(g, id, &prepared, &t, NULL)) return;
        RtNormals normals = rt_object_normals(g, id, &ray, t, hit_memory);
        add_tangent(section, cairo, rt_ray_point(&ray, t), normals.geometric, along);
        ray.tmin = nextafterf(t, INFINITY);
    }
}

/* The part of the line through `middle` in direction `across`, `right` or `up`, that the drawing shows. */
static void visible(const RtSection *section, cairo_t *cairo, RtVec3d middle, RtVec3d across, double *from,
                    double *to) {
    double left, top, right, bottom, x = rt_dotd(across, section->right), y = rt_dotd(across, section->up);
    RtPoint at = rt_section_point(section, middle);
    cairo_clip_extents(cairo, &left, &top, &right, &bottom);
    *from = (x * (left - at.x) + y * (at.y - bottom)) / section->scale;
    *to = (x * (right - at.x) + y * (at.y - top)) / section->scale;
}

/* Lines over the object's ball, in direction `along`, side by side in direction `across`. */
static void scan(const RtSection *section, cairo_t *cairo, const RtGeometry *g, uint32_t id, RtVec3d along,
                 RtVec3d across, RtHitMemory *hit_memory) {
    const RtBall ball = rt_object_ball(g, id);
    double off = rt_dotd(rt_subd(ball.center, section->on), section->normal);
    if (fabs(off) >= ball.radius) return;
    const double radius = sqrt(ball.radius * ball.radius - off * off), step = SPACING / section->scale;
    double from, to;
    RtVec3d middle = rt_add_scaledd(ball.center, section->normal, -off);
    RtVec3d start = rt_add_scaledd(middle, along, -1.1 * radius);
    visible(section, cairo, middle, across, &from, &to);
    from = fmax(from, -radius), to = fmin(to, radius);
    for (int i = 0; from + i * step <= to; i++)
        add_crossings(section, cairo, g, id, rt_add_scaledd(start, across, from + i * step), along,
                      hit_memory);
}

void rt_section_add_object(const RtSection *section, cairo_t *cairo, const RtGeometry *geometry, uint32_t id,
                           RtHitMemory *hit_memory) {
    const uint32_t index = rt_ref_index(geometry->objects[id]);
    switch (rt_ref_shape(geometry->objects[id])) {
    case RT_SHAPE_SPHERE:
        rt_section_add_ball(section, cairo, rt_widen(geometry->spheres[index].center),
                            (double)geometry->spheres[index].radius);
        break;
    case RT_SHAPE_TRIANGLE: add_flat(section, cairo, geometry->triangles[index].v, 3); break;
    case RT_SHAPE_POLYGON:
        add_flat(section, cairo, rt_polygon_vertices(geometry, index), geometry->polygons[index].count);
        break;
    case RT_SHAPE_CONE:
    case RT_SHAPE_CSG:
        scan(section, cairo, geometry, id, section->right, section->up, hit_memory);
        scan(section, cairo, geometry, id, section->up, section->right, hit_memory);
        break;
    case RT_SHAPE_INSTANCE:
        rt_section_add_extent(section, cairo, &(RtBoxView){.box = &geometry->boxes[id]});
        break;
    case RT_SHAPE_COUNT: break;
    }
}
