/* SPDX-License-Identifier: Apache-2.0 */
#include "exact/referee.h"

static RtExactVec vertex(RtVec3 v) {
    return rt_exact_vec(rt_widen(v));
}

/* ---- flat shapes ---- */

static bool flat_hit(const RtExactLine *line, RtRational t, RtRoot *out) {
    *out = rt_root_of(t);
    return rt_exact_counts(line, out);
}

/* Edge functions are the volumes spanned by direction and edge as seen from the origin. Their sum is the
 * normal's component along the direction. */
static bool triangle_hit(const RtTriangle *triangle, const RtExactLine *line, RtRoot *t) {
    RtExactVec from[3], normals[3];
    RtRational edges[3];
    bool left = false, right = false;
    for (int i = 0; i < 3; i++) from[i] = rt_exact_vec_sub(vertex(triangle->v[i]), line->org);
    for (int i = 0; i < 3; i++) {
        normals[i] = rt_exact_cross(from[i], from[(i + 1) % 3]);
        edges[i] = rt_exact_dot(normals[i], line->dir);
        left |= rt_exact_sign(edges[i]) < 0;
        right |= rt_exact_sign(edges[i]) > 0;
    }
    if (left == right) return false; /* a miss, or all three are 0: in the plane, or no plane at all */
    RtRational sum = rt_exact_add(rt_exact_add(edges[0], edges[1]), edges[2]);
    RtRational volume = rt_exact_dot(normals[0], from[2]);
    return flat_hit(line, rt_exact_div(volume, sum), t);
}

/* Does the edge from a to b count for p in the even-odd rule, or is p on it? */
typedef enum EdgeCase { EDGE_ASIDE, EDGE_CROSSED, EDGE_MET } EdgeCase;

static EdgeCase edge_case(const RtRational a[2], const RtRational b[2], const RtRational p[2]) {
    int av = mpq_cmp(a[1], p[1]), bv = mpq_cmp(b[1], p[1]);
    if ((av < 0 && bv < 0) || (av > 0 && bv > 0)) return EDGE_ASIDE;
    RtRational along = rt_exact_mul(rt_exact_sub(b[0], a[0]), rt_exact_sub(p[1], a[1]));
    RtRational across = rt_exact_mul(rt_exact_sub(p[0], a[0]), rt_exact_sub(b[1], a[1]));
    int side = mpq_cmp(along, across), au = mpq_cmp(a[0], p[0]), bu = mpq_cmp(b[0], p[0]);
    if (side == 0 && (au >= 0 || bu >= 0) && (au <= 0 || bu <= 0)) return EDGE_MET;
    bool crossed = (av > 0) != (bv > 0) && (mpq_cmp(b[1], a[1]) > 0 ? side > 0 : side < 0);
    return crossed ? EDGE_CROSSED : EDGE_ASIDE;
}

static bool inside_polygon(const RtPolygon *polygon, const RtVec3 *vertices, RtExactVec p) {
    const RtRational point[2] = {p.at[polygon->u], p.at[polygon->v]};
    bool inside = false;
    for (uint32_t i = 0; i < polygon->count; i++) {
        size_t mark = rt_exact_mark();
        RtExactVec a = vertex(vertices[i]), b = vertex(vertices[(i + 1) % polygon->count]);
        const RtRational from[2] = {a.at[polygon->u], a.at[polygon->v]};
        const RtRational to[2] = {b.at[polygon->u], b.at[polygon->v]};
        EdgeCase what = edge_case(from, to, point);
        rt_exact_rewind(mark);
        if (what == EDGE_MET) return true;
        if (what == EDGE_CROSSED) inside = !inside;
    }
    return inside;
}

/* Relative to vertex 0: the sums are exact anyway. */
static bool polygon_hit(const RtPolygon *polygon, const RtVec3 *vertices, const RtExactLine *line,
                        RtRoot *t) {
    RtExactVec first = vertex(vertices[0]), normal = rt_exact_vec((RtVec3d){0});
    RtExactVec sum = normal, last = normal;
    RtRational one = rt_exact_of(1);
    for (uint32_t i = 1; i < polygon->count; i++) {
        RtExactVec from = rt_exact_vec_sub(vertex(vertices[i]), first);
        sum = rt_exact_vec_add_scaled(sum, from, one);
        normal = rt_exact_vec_add_scaled(normal, rt_exact_cross(last, from), one);
        last = from;
    }
    RtRational approach = rt_exact_dot(normal, line->dir);
    if (rt_exact_sign(approach) == 0) return false;
    RtRational part = rt_exact_div(one, rt_exact_of(polygon->count));
    RtExactVec center = rt_exact_vec_add_scaled(first, sum, part);
    RtRational height = rt_exact_dot(normal, rt_exact_vec_sub(center, line->org));
    RtRational at = rt_exact_div(height, approach);
    return flat_hit(line, at, t) &&
           inside_polygon(polygon, vertices, rt_exact_vec_add_scaled(line->org, line->dir, at));
}

/* ---- round shapes ---- */

static bool sphere_hit(const RtSphere *sphere, const RtExactLine *line, RtRoot *t) {
    RtExactVec org = rt_exact_vec_sub(line->org, vertex(sphere->center));
    RtRational radius = rt_exact_of((double)sphere->radius);
    RtRational c = rt_exact_sub(rt_exact_dot(org, org), rt_exact_mul(radius, radius));
    RtRational half = rt_exact_dot(org, line->dir);
    const RtRational form[3] = {c, rt_exact_add(half, half), rt_exact_dot(line->dir, line->dir)};
    RtPolynomial p = rt_polynomial(2, form);
    RtRoot roots[RT_MAX_DEGREE];
    int count = rt_polynomial_roots(&p, roots);
    for (int i = 0; i < count; i++) {
        *t = roots[i];
        if (rt_exact_counts(line, t)) return true;
    }
    return false;
}

/* The sign of a + b t. */
static int sign_of_linear(RtRational a, RtRational b, const RtRoot *t) {
    if (rt_exact_sign(b) == 0) return rt_exact_sign(a);
    return rt_exact_sign(b) * rt_root_compare_rational(t, rt_exact_neg(rt_exact_div(a, b)));
}

/* With s the height as a fraction of the axis (0 at the base, 1 at the apex) and H its squared length, the
 * side is where |p - base|^2 - H s^2 = (r0 + (r1 - r0) s)^2: no square root is needed. */
static bool cone_hit(const RtCone *cone, const RtExactLine *line, RtRoot *t) {
    RtExactVec base = vertex(cone->base), org = rt_exact_vec_sub(line->org, base), dir = line->dir;
    RtExactVec axis = rt_exact_vec_sub(vertex(cone->apex), base);
    RtRational height = rt_exact_dot(axis, axis);
    RtRational s = rt_exact_div(rt_exact_dot(org, axis), height);
    RtRational ds = rt_exact_div(rt_exact_dot(dir, axis), height);
    RtRational base_radius = rt_exact_of((double)cone->base_radius);
    RtRational slope = rt_exact_sub(rt_exact_of((double)cone->apex_radius), base_radius);
    RtRational r = rt_exact_add(base_radius, rt_exact_mul(slope, s));
    RtRational dr = rt_exact_mul(slope, ds);

    const RtExactVec points[2] = {org, dir};
    const RtRational heights[2] = {s, ds}, radii[2] = {r, dr};
    RtRational form[3];
    for (int i = 0; i < 3; i++) {
        int k = i / 2, l = (i + 1) / 2; /* org org, org dir, dir dir */
        RtRational along = rt_exact_mul(height, rt_exact_mul(heights[k], heights[l]));
        RtRational around = rt_exact_mul(radii[k], radii[l]);
        RtRational across = rt_exact_sub(rt_exact_dot(points[k], points[l]), along);
        form[i] = rt_exact_sub(across, around);
    }
    form[1] = rt_exact_add(form[1], form[1]);
    RtPolynomial p = rt_polynomial(2, form);
    RtRoot roots[RT_MAX_DEGREE];
    int count = rt_polynomial_roots(&p, roots);
    RtRational beyond = rt_exact_sub(s, rt_exact_of(1));
    for (int i = 0; i < count; i++) {
        *t = roots[i];
        if (sign_of_linear(s, ds, t) < 0 || sign_of_linear(beyond, ds, t) > 0) continue;
        if (rt_exact_counts(line, t)) return true;
    }
    return false;
}

/* ---- all objects ---- */

bool rt_exact_enter(const RtExactLine *line, const RtInstance *instance, RtExactLine *inside) {
    RtExactVec columns[4], rows[3]; /* of the cofactor matrix: the inverse by Cramer's rule */
    for (int c = 0; c < 4; c++) columns[c] = rt_exact_vec(rt_transform_column(&instance->to_world, c));
    for (int a = 0; a < 3; a++) rows[a] = rt_exact_cross(columns[(a + 1) % 3], columns[(a + 2) % 3]);
    const RtRational determinant = rt_exact_dot(columns[0], rows[0]);
    if (rt_exact_sign(determinant) == 0) return false;
    const RtExactVec from = rt_exact_vec_sub(line->org, columns[3]), along = line->dir;
    *inside = *line;
    for (int a = 0; a < 3; a++) {
        inside->org.at[a] = rt_exact_div(rt_exact_dot(rows[a], from), determinant);
        inside->dir.at[a] = rt_exact_div(rt_exact_dot(rows[a], along), determinant);
        inside->wide.org.at[a] = (double)rt_exact_value(inside->org.at[a]);
        inside->wide.dir.at[a] = (double)rt_exact_value(inside->dir.at[a]);
    }
    const RtVec3 dir = rt_narrow(inside->wide.dir);
    return dir.x != 0 || dir.y != 0 || dir.z != 0;
}

static RtExactResult object_hit(const RtGeometry *geometry, uint32_t object, const RtExactLine *line,
                                RtRoot *t) {
    uint32_t index = rt_ref_index(geometry->objects[object]);
    bool hit = false;
    switch (rt_ref_shape(geometry->objects[object])) {
    case RT_SHAPE_TRIANGLE: hit = triangle_hit(&geometry->triangles[index], line, t); break;
    case RT_SHAPE_SPHERE: hit = sphere_hit(&geometry->spheres[index], line, t); break;
    case RT_SHAPE_POLYGON:
        hit = polygon_hit(&geometry->polygons[index], rt_polygon_vertices(geometry, index), line, t);
        break;
    case RT_SHAPE_CONE: hit = cone_hit(&geometry->cones[index], line, t); break;
    case RT_SHAPE_CSG: return rt_exact_csg_hit(&geometry->forest, &geometry->csgs[index], line, t);
    case RT_SHAPE_INSTANCE: /* rt_exact_hit enters it */
    case RT_SHAPE_COUNT: return RT_UNDECIDED;
    }
    return hit ? RT_HIT : RT_MISSED;
}

RtExactResult rt_exact_hit(const RtGeometry *geometry, uint32_t id, const RtExactLine *line, RtRoot *t) {
    RtExactLine here = *line;
    for (;;) {
        const uint32_t object = rt_geometry_holder(geometry, id);
        if (!rt_is_instance(geometry, object)) return object_hit(geometry, object, &here, t);
        const RtInstance *instance = rt_instance_of(geometry, object);
        if (!rt_exact_enter(&here, instance, &here)) return RT_MISSED;
        id -= instance->first;
        geometry = instance->geometry;
    }
}
