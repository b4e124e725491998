/* SPDX-License-Identifier: Apache-2.0 */
/* What is known of an object besides its hits: box, ball, support function, frame and normals.
 *
 * Extents of a polygon contain its vertices and the polygon as it is hit, projected to its plane along the
 * third axis; the box is flat and exact for one in a coordinate plane.
 *
 * Smallest enclosing balls. A few points span the ball. While some point lies outside it, the farthest one
 * joins them, and points that the new ball does not need leave. The ball grows at every step, so the loop
 * ends (an LP-type problem: Sharir & Welzl 1992). Two or three coplanar points span a ball, so at most
 * four are examined together; the vertices of a triangle or a planar polygon are coplanar. */
#include "core/shape/geometry.h"

#include <assert.h>

/* ---- smallest balls ---- */

static double distance_squared(RtVec3d a, RtVec3d b) {
    RtVec3d d = rt_subd(a, b);
    return rt_dotd(d, d);
}

/* The smallest ball around `center` that contains all points. */
static RtBall ball_about(RtVec3d center, const RtVec3 *points, size_t count) {
    double most = 0;
    for (size_t i = 0; i < count; i++) {
        double d = distance_squared(center, rt_widen(points[i]));
        most = d > most ? d : most;
    }
    return (RtBall){center, sqrt(most) * (1 + 0x1p-50)};
}

/* Circumcentre of a triangle; false if the points lie on a line. */
static bool circumcenter(RtVec3d a, RtVec3d b, RtVec3d c, RtVec3d *center) {
    RtVec3d ab = rt_subd(b, a), ac = rt_subd(c, a), n = rt_crossd(ab, ac);
    double nn = rt_dotd(n, n);
    if (!(nn > 0)) return false;
    RtVec3d offset =
        rt_addd(rt_scaled(rt_crossd(n, ab), rt_dotd(ac, ac)), rt_scaled(rt_crossd(ac, n), rt_dotd(ab, ab)));
    *center = rt_add_scaledd(a, offset, 1 / (2 * nn));
    return true;
}

/* The points that span a ball, and space for one more. */
typedef struct Span {
    RtVec3 points[4];
    size_t count;
} Span;

/* Tries the ball spanned by two or three of the points (`c` may equal `b`). If it contains all of `span`
 * and is smaller than *best, it replaces *best, and *least becomes its points. */
static void try_span(const Span *span, size_t a, size_t b, size_t c, RtBall *best, Span *least) {
    const RtVec3 *p = span->points;
    RtVec3d center = rt_scaled(rt_addd(rt_widen(p[a]), rt_widen(p[b])), 0.5);
    if (c != b && !circumcenter(rt_widen(p[a]), rt_widen(p[b]), rt_widen(p[c]), &center)) return;
    RtBall ball = ball_about(center, p, span->count);
    if (!(ball.radius < best->radius)) return;
    *best = ball;
    *least = (Span){{p[a], p[b], p[c]}, c == b ? 2 : 3};
}

/* The smallest ball around the points of `span`; keeps only those that span it. */
static RtBall spanned_ball(Span *span) {
    RtBall best = ball_about(rt_widen(span->points[0]), span->points, span->count);
    Span least = {{span->points[0]}, 1};
    for (size_t i = 0; i < span->count; i++) {
        for (size_t j = i + 1; j < span->count; j++) {
            for (size_t k = j; k < span->count; k++) try_span(span, i, j, k, &best, &least);
        }
    }
    *span = least;
    return best;
}

static size_t farthest(RtVec3d from, const RtVec3 *points, size_t count) {
    size_t best = 0;
    for (size_t i = 1; i < count; i++) {
        if (distance_squared(from, rt_widen(points[i])) > distance_squared(from, rt_widen(points[best])))
            best = i;
    }
    return best;
}

/* The smallest ball around coplanar points (count >= 1), up to rounding. It contains every point exactly,
 * because its radius is measured last. For points that are not quite coplanar it is nearly the smallest. */
static RtBall ball_of_points(const RtVec3 *points, size_t count) {
    Span span = {{points[0]}, 1};
    RtBall best = ball_about(rt_widen(points[0]), points, count), ball = {best.center, 0};
    for (;;) {
        double before = ball.radius;
        span.points[span.count++] = points[farthest(ball.center, points, count)];
        ball = spanned_ball(&span);
        if (!(ball.radius > before)) return best;
        RtBall whole = ball_about(ball.center, points, count);
        if (whole.radius < best.radius) best = whole;
    }
}

/* ---- extents of each shape ---- */

static RtBox sphere_box(const RtGeometry *g, uint32_t index) {
    return rt_sphere_box(&g->spheres[index]);
}

static RtBall sphere_ball(const RtGeometry *g, uint32_t index) {
    return (RtBall){rt_widen(g->spheres[index].center), (double)g->spheres[index].radius};
}

static double sphere_support(const RtGeometry *g, uint32_t index, RtVec3d direction) {
    RtBall ball = sphere_ball(g, index);
    return rt_dotd(ball.center, direction) + ball.radius * rt_lengthd(direction);
}

static RtBox polygon_box(const RtGeometry *g, uint32_t index) {
    const RtPolygon *polygon = &g->polygons[index];
    const RtVec3 *vertices = rt_polygon_vertices(g, index);
    RtBox box = RT_EMPTY_BOX;
    for (uint32_t i = 0; i < polygon->count; i++) box = rt_box_add_point(box, vertices[i]);
    uint32_t w = 3 - polygon->u - polygon->v;
    box.lo.at[w] = rt_float_below((double)box.lo.at[w] - (double)polygon->warp);
    box.hi.at[w] = rt_float_above((double)box.hi.at[w] + (double)polygon->warp);
    return box;
}

static RtBall polygon_ball(const RtGeometry *g, uint32_t index) {
    RtBall ball = ball_of_points(rt_polygon_vertices(g, index), g->polygons[index].count);
    ball.radius += (double)g->polygons[index].warp;
    return ball;
}

static double polygon_support(const RtGeometry *g, uint32_t index, RtVec3d direction) {
    const RtPolygon *polygon = &g->polygons[index];
    const RtVec3 *vertices = rt_polygon_vertices(g, index);
    double most = rt_dotd(rt_widen(vertices[0]), direction);
    for (uint32_t i = 1; i < polygon->count; i++) {
        double along = rt_dotd(rt_widen(vertices[i]), direction);
        if (along > most) most = along;
    }
    return most + (double)polygon->warp * fabs(direction.at[3 - polygon->u - polygon->v]);
}

static RtBox triangle_box(const RtGeometry *g, uint32_t index) {
    return rt_triangle_box(&g->triangles[index]);
}

static RtBall triangle_ball(const RtGeometry *g, uint32_t index) {
    return ball_of_points(g->triangles[index].v, 3);
}

static double triangle_support(const RtGeometry *g, uint32_t index, RtVec3d direction) {
    return rt_triangle_support(&g->triangles[index], direction);
}

/* The largest dot product of `direction` with a point of the disc around `center`. */
static double disc_support(const RtCone *cone, RtVec3 center, float radius, RtVec3d direction) {
    RtVec3d across = rt_add_scaledd(direction, cone->axis, -rt_dotd(direction, cone->axis));
    return rt_dotd(rt_widen(center), direction) + (double)radius * rt_lengthd(across);
}

static double cone_support(const RtGeometry *g, uint32_t index, RtVec3d direction) {
    const RtCone *cone = &g->cones[index];
    return fmax(disc_support(cone, cone->base, cone->base_radius, direction),
                disc_support(cone, cone->apex, cone->apex_radius, direction));
}

/* Of the two circles. */
static RtBox cone_box(const RtGeometry *g, uint32_t index) {
    RtBox box = RT_EMPTY_BOX;
    for (int a = 0; a < 3; a++) {
        RtVec3d up = {a == 0, a == 1, a == 2};
        double hi = cone_support(g, index, up), lo = -cone_support(g, index, rt_scaled(up, -1));
        double slack = 0x1p-50 * (fabs(hi) + fabs(lo) + g->cones[index].height);
        box.lo.at[a] = rt_float_below(lo - slack);
        box.hi.at[a] = rt_float_above(hi + slack);
    }
    return box;
}

/* The centre is the point of the axis with equal distance to both circles; if that is beyond an end, the
 * larger circle alone decides. */
static RtBall cone_ball(const RtGeometry *g, uint32_t index) {
    const RtCone *cone = &g->cones[index];
    double r0 = (double)cone->base_radius, r1 = (double)cone->apex_radius, h = cone->height;
    double s = (h * h + r1 * r1 - r0 * r0) / (2 * h);
    s = fmin(fmax(s, 0), h);
    double to_base = sqrt(s * s + r0 * r0), to_apex = sqrt((h - s) * (h - s) + r1 * r1);
    return (RtBall){rt_add_scaledd(rt_widen(cone->base), cone->axis, s),
                    fmax(to_base, to_apex) * (1 + 0x1p-50)};
}

static RtBox csg_box(const RtGeometry *g, uint32_t index) {
    return g->csgs[index].box;
}

static RtBall csg_ball(const RtGeometry *g, uint32_t index) {
    return g->csgs[index].ball;
}

static double csg_support(const RtGeometry *g, uint32_t index, RtVec3d direction) {
    return rt_csg_support(&g->forest, &g->csgs[index], direction);
}

RtBox rt_moved_box(const RtBox *box, const RtTransform *transform) {
    RtBox moved = RT_EMPTY_BOX;
    for (int corner = 0; corner < 8; corner++) {
        RtVec3d at;
        for (int a = 0; a < 3; a++) at.at[a] = (double)(corner >> a & 1 ? box->hi : box->lo).at[a];
        at = rt_transform_pointd(transform, at);
        for (int a = 0; a < 3; a++) {
            moved.lo.at[a] = rt_minf(moved.lo.at[a], rt_float_below(at.at[a]));
            moved.hi.at[a] = rt_maxf(moved.hi.at[a], rt_float_above(at.at[a]));
        }
    }
    return moved;
}

double rt_reach(const double reach[RT_REACHES], RtVec3d direction) {
    static const int places[3] = {9, 3, 1};
    const double size[3] = {fabs(direction.x), fabs(direction.y), fabs(direction.z)};
    const int longest = size[0] >= size[1] ? (size[0] >= size[2] ? 0 : 2) : size[1] >= size[2] ? 1 : 2;
    const int next = (longest + 1) % 3, last = (longest + 2) % 3;
    const int order[3] = {longest, size[next] >= size[last] ? next : last,
                          size[next] >= size[last] ? last : next};
    double sum = 0;
    for (int i = 0, known = 13; i < 3; i++) {
        known += direction.at[order[i]] < 0 ? -places[order[i]] : places[order[i]];
        sum += (size[order[i]] - (i < 2 ? size[order[i + 1]] : 0)) * reach[known];
    }
    return sum;
}

/* The less of two bounds: by the part's reach, which is larger where it is sheared, and by its box, which is
 * larger where it is turned. */
static double instance_support(const RtGeometry *g, uint32_t index, RtVec3d direction) {
    const RtInstance *instance = &g->instances[index];
    const RtBox *box = &instance->geometry->box;
    double within = 0;
    RtVec3d inside; /* by the transposed matrix */
    for (int a = 0; a < 3; a++) {
        inside.at[a] = rt_dotd(direction, rt_transform_column(&instance->to_world, a));
        within += inside.at[a] * (double)(inside.at[a] < 0 ? box->lo : box->hi).at[a];
    }
    return fmin(rt_reach(instance->geometry->reach, inside), within) +
           rt_dotd(direction, rt_transform_column(&instance->to_world, 3));
}

static RtBox instance_box(const RtGeometry *g, uint32_t index) {
    RtBox box;
    for (int a = 0; a < 3; a++) {
        RtVec3d axis = {{0, 0, 0}};
        axis.at[a] = 1;
        box.hi.at[a] = rt_float_above(instance_support(g, index, axis));
        axis.at[a] = -1;
        box.lo.at[a] = rt_float_below(-instance_support(g, index, axis));
    }
    return box;
}

static RtBall instance_ball(const RtGeometry *g, uint32_t index) {
    const RtBox box = instance_box(g, index);
    const RtVec3d lo = rt_widen(box.lo), hi = rt_widen(box.hi), center = rt_scaled(rt_addd(lo, hi), 0.5);
    return (RtBall){center, rt_lengthd(rt_subd(hi, center)) * (1 + 0x1p-50)};
}

static const struct {
    RtBox (*box)(const RtGeometry *g, uint32_t index);
    RtBall (*ball)(const RtGeometry *g, uint32_t index);
    double (*support)(const RtGeometry *g, uint32_t index, RtVec3d direction);
} extents[] = {
#define EXTENTS(CONSTANT, name, Type) {name##_box, name##_ball, name##_support},
    RT_SHAPES(EXTENTS)
#undef EXTENTS
};

RtBox rt_object_box(const RtGeometry *geometry, uint32_t id) {
    RtRef ref = geometry->objects[id];
    return extents[rt_ref_shape(ref)].box(geometry, rt_ref_index(ref));
}

RtBall rt_object_ball(const RtGeometry *geometry, uint32_t id) {
    RtRef ref = geometry->objects[id];
    return extents[rt_ref_shape(ref)].ball(geometry, rt_ref_index(ref));
}

double rt_object_support(const RtGeometry *geometry, uint32_t id, RtVec3d direction) {
    RtRef ref = geometry->objects[id];
    return extents[rt_ref_shape(ref)].support(geometry, rt_ref_index(ref), direction);
}

/* ---- normals ---- */

/* At `point` on the side, away from the axis. */
static RtVec3d cone_normal(const RtCone *cone, RtVec3d point) {
    RtVec3d from_base = rt_subd(point, rt_widen(cone->base));
    double s = rt_dotd(from_base, cone->axis);
    RtVec3d outward = rt_normalized(rt_add_scaledd(from_base, cone->axis, -s));
    return rt_normalized(rt_add_scaledd(outward, cone->axis, -cone->slope));
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

static RtVec3d interpolated_normal(const RtGeometry *g, uint32_t index, RtVec3d point, RtVec3d geometric) {
    uint32_t entry = g->triangle_normals ? g->triangle_normals[index] : RT_NO_NORMALS;
    if (entry == RT_NO_NORMALS) return geometric;
    const RtVec3 *n = g->vertex_normals[entry].n;
    RtVec3d w = rt_triangle_weights(&g->triangles[index], point);
    RtVec3d sum = rt_scaled(rt_widen(n[0]), w.x);
    sum = rt_add_scaledd(sum, rt_widen(n[1]), w.y);
    sum = rt_add_scaledd(sum, rt_widen(n[2]), w.z);
    return rt_lengthd(sum) > 0 ? rt_normalized(sum) : geometric;
}

static RtNormals csg_normals(const RtGeometry *g, uint32_t index, const RtRay *ray, float t,
                             RtHitMemory *hit_memory) {
    RtPreparedRay prepared;
    rt_hit_ray(&prepared, g, ray, hit_memory);
    RtCsgFacet facet = rt_csg_facet(&g->forest, &g->csgs[index], &prepared, t);
    return (RtNormals){facet.normal, facet.normal, facet.solid};
}

RtNormals rt_object_normals(const RtGeometry *geometry, uint32_t id, const RtRay *ray, float t,
                            RtHitMemory *hit_memory) {
    uint32_t index = rt_ref_index(geometry->objects[id]);
    RtVec3d point = rt_ray_point(ray, t), normal = {0, 0, 0};
    switch (rt_ref_shape(geometry->objects[id])) {
    case RT_SHAPE_SPHERE:
        normal = rt_normalized(rt_subd(point, rt_widen(geometry->spheres[index].center)));
        break;
    case RT_SHAPE_POLYGON: normal = geometry->polygons[index].normal; break;
    case RT_SHAPE_CONE: normal = cone_normal(&geometry->cones[index], point); break;
    case RT_SHAPE_TRIANGLE:
        normal = rt_triangle_normal(&geometry->triangles[index]);
        return (RtNormals){normal, interpolated_normal(geometry, index, point, normal), RT_NO_SOLID};
    case RT_SHAPE_CSG: return csg_normals(geometry, index, ray, t, hit_memory);
    case RT_SHAPE_INSTANCE: /* rt_scene_place */
    case RT_SHAPE_COUNT: break;
    }
    return (RtNormals){normal, normal, RT_NO_SOLID};
}

/* ---- frames ---- */

/* The longest edge of a closed chain of vertices. */
static RtVec3d longest_edge(const RtVec3 *vertices, uint32_t count) {
    RtVec3d best = {0, 0, 0};
    for (uint32_t i = 0; i < count; i++) {
        RtVec3d edge = rt_subd(rt_widen(vertices[(i + 1) % count]), rt_widen(vertices[i]));
        if (rt_dotd(edge, edge) > rt_dotd(best, best)) best = edge;
    }
    return best;
}

/* The longest axis of a tree's largest solid, and another one; of a polyhedron, two normals. */
static void csg_axes(const RtGeometry *g, const RtCsg *tree, RtVec3d *main, RtVec3d *normal) {
    const RtSolidSet *set = &g->forest.set;
    double largest = -1;
    for (uint32_t i = 0; i < tree->solid_count; i++) {
        const RtSolid *solid = &set->solids[tree->first_solid + i];
        double area = rt_box_half_area(solid->box);
        if (solid->subtracted || !isfinite(area) || area <= largest) continue;
        largest = area;
        if (solid->kind == RT_SOLID_POLYHEDRON) {
            *main = set->planes[solid->first].normal;
            *normal = set->planes[solid->first + solid->count - 1].normal;
            continue;
        }
        *main = *normal = rt_vec3d(0, 0, 0);
        for (int a = 0; a < 3; a++) {
            RtVec3d axis = rt_transform_column(&solid->to_world, a);
            bool longer = rt_dotd(axis, axis) > rt_dotd(*main, *main);
            *normal = rt_normalized(longer ? *main : axis);
            if (longer) *main = axis;
        }
    }
}

void rt_object_frame(const RtGeometry *geometry, uint32_t id, RtVec3d axes[3]) {
    uint32_t index = rt_ref_index(geometry->objects[id]);
    RtVec3d main = {1, 0, 0}, normal = {0, 0, 1};
    switch (rt_ref_shape(geometry->objects[id])) {
    case RT_SHAPE_TRIANGLE:
        main = longest_edge(geometry->triangles[index].v, 3);
        normal = rt_triangle_normal(&geometry->triangles[index]);
        break;
    case RT_SHAPE_POLYGON:
        main = longest_edge(rt_polygon_vertices(geometry, index), geometry->polygons[index].count);
        normal = geometry->polygons[index].normal;
        break;
    case RT_SHAPE_CONE: main = geometry->cones[index].axis; break;
    case RT_SHAPE_CSG: csg_axes(geometry, &geometry->csgs[index], &main, &normal); break;
    case RT_SHAPE_SPHERE:
    case RT_SHAPE_INSTANCE:
    case RT_SHAPE_COUNT: break;
    }
    if (rt_dotd(main, main) == 0) main = rt_vec3d(1, 0, 0);
    main = rt_normalized(main);
    /* Gram-Schmidt, starting from a candidate that is not along the main axis. */
    RtVec3d candidates[4] = {normal, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    for (int i = 0; i < 4; i++) {
        RtVec3d rest = rt_add_scaledd(candidates[i], main, -rt_dotd(candidates[i], main));
        if (rt_lengthd(rest) < 0.5) continue;
        axes[0] = main;
        axes[1] = rt_normalized(rest);
        axes[2] = rt_crossd(axes[0], axes[1]);
        return;
    }
    assert(false && "one of three axes is always far enough from any direction");
}
