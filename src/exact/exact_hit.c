#include "exact/exact_hit.h"

#include "exact/exact_csg.h"

static RtExactVec vertex(RtSlate *slate, RtVec3 v) {
    return rt_exact_vec(slate, rt_widen(v));
}

/* ---- flat shapes ---- */

static bool flat_hit(RtSlate *slate, const RtExactLine *line, RtRational t, RtPlace *out) {
    *out = rt_place_of(slate, t);
    return rt_exact_counts(slate, line, out);
}

/* Edge functions are the volumes between direction and edge as seen from the origin. They sum to the normal's
 * part along the direction. */
static bool triangle_hit(RtSlate *slate, const RtTriangle *triangle, const RtExactLine *line, RtPlace *t) {
    RtExactVec from[3], normals[3];
    RtRational edges[3];
    bool left = false, right = false;
    for (int i = 0; i < 3; i++) from[i] = rt_exact_vec_sub(slate, vertex(slate, triangle->v[i]), line->org);
    for (int i = 0; i < 3; i++) {
        normals[i] = rt_exact_cross(slate, from[i], from[(i + 1) % 3]);
        edges[i] = rt_exact_dot(slate, normals[i], line->dir);
        left |= rt_exact_sign(edges[i]) < 0;
        right |= rt_exact_sign(edges[i]) > 0;
    }
    if (left == right) return false; /* passes by, or all three are 0: in the plane, or no plane at all */
    RtRational sum = rt_exact_add(slate, rt_exact_add(slate, edges[0], edges[1]), edges[2]);
    RtRational volume = rt_exact_dot(slate, normals[0], from[2]);
    return flat_hit(slate, line, rt_exact_div(slate, volume, sum), t);
}

/* Of p beside the edge from a to b: does the edge count for the even-odd rule, or is p on it? */
typedef enum EdgeCase { EDGE_ASIDE, EDGE_CROSSED, EDGE_MET } EdgeCase;

static EdgeCase edge_case(RtSlate *slate, const RtRational a[2], const RtRational b[2],
                          const RtRational p[2]) {
    int av = mpq_cmp(a[1], p[1]), bv = mpq_cmp(b[1], p[1]);
    if ((av < 0 && bv < 0) || (av > 0 && bv > 0)) return EDGE_ASIDE;
    RtRational along = rt_exact_mul(slate, rt_exact_sub(slate, b[0], a[0]), rt_exact_sub(slate, p[1], a[1]));
    RtRational across = rt_exact_mul(slate, rt_exact_sub(slate, p[0], a[0]), rt_exact_sub(slate, b[1], a[1]));
    int side = mpq_cmp(along, across), au = mpq_cmp(a[0], p[0]), bu = mpq_cmp(b[0], p[0]);
    if (side == 0 && (au >= 0 || bu >= 0) && (au <= 0 || bu <= 0)) return EDGE_MET;
    bool crossed = (av > 0) != (bv > 0) && (mpq_cmp(b[1], a[1]) > 0 ? side > 0 : side < 0);
    return crossed ? EDGE_CROSSED : EDGE_ASIDE;
}

static bool inside_polygon(RtSlate *slate, const RtPolygon *polygon, const RtVec3 *vertices, RtExactVec p) {
    const RtRational point[2] = {p.at[polygon->u], p.at[polygon->v]};
    bool inside = false;
    for (uint32_t i = 0; i < polygon->count; i++) {
        size_t mark = rt_slate_mark(slate);
        RtExactVec a = vertex(slate, vertices[i]), b = vertex(slate, vertices[(i + 1) % polygon->count]);
        const RtRational from[2] = {a.at[polygon->u], a.at[polygon->v]};
        const RtRational to[2] = {b.at[polygon->u], b.at[polygon->v]};
        EdgeCase what = edge_case(slate, from, to, point);
        rt_slate_wipe(slate, mark);
        if (what == EDGE_MET) return true;
        if (what == EDGE_CROSSED) inside = !inside;
    }
    return inside;
}

/* About vertex 0: the sums are exact wherever they are taken. */
static bool polygon_hit(RtSlate *slate, const RtPolygon *polygon, const RtVec3 *vertices,
                        const RtExactLine *line, RtPlace *t) {
    RtExactVec first = vertex(slate, vertices[0]), normal = rt_exact_vec(slate, (RtVec3d){0});
    RtExactVec sum = normal, last = normal;
    RtRational one = rt_exact_of(slate, 1);
    for (uint32_t i = 1; i < polygon->count; i++) {
        RtExactVec from = rt_exact_vec_sub(slate, vertex(slate, vertices[i]), first);
        sum = rt_exact_vec_add_scaled(slate, sum, from, one);
        normal = rt_exact_vec_add_scaled(slate, normal, rt_exact_cross(slate, last, from), one);
        last = from;
    }
    RtRational approach = rt_exact_dot(slate, normal, line->dir);
    if (rt_exact_sign(approach) == 0) return false;
    RtRational part = rt_exact_div(slate, one, rt_exact_of(slate, polygon->count));
    RtExactVec center = rt_exact_vec_add_scaled(slate, first, sum, part);
    RtRational height = rt_exact_dot(slate, normal, rt_exact_vec_sub(slate, center, line->org));
    RtRational at = rt_exact_div(slate, height, approach);
    return flat_hit(slate, line, at, t) &&
           inside_polygon(slate, polygon, vertices, rt_exact_vec_add_scaled(slate, line->org, line->dir, at));
}

/* ---- round shapes ---- */

static bool sphere_hit(RtSlate *slate, const RtSphere *sphere, const RtExactLine *line, RtPlace *t) {
    RtExactVec org = rt_exact_vec_sub(slate, line->org, vertex(slate, sphere->center));
    RtRational radius = rt_exact_of(slate, (double)sphere->radius);
    RtRational c = rt_exact_sub(slate, rt_exact_dot(slate, org, org), rt_exact_mul(slate, radius, radius));
    RtSurd roots[2];
    int count = rt_exact_roots(slate, rt_exact_dot(slate, line->dir, line->dir),
                               rt_exact_dot(slate, org, line->dir), c, roots);
    for (int i = 0; i < count; i++) {
        *t = rt_place_of_surd(&roots[i]);
        if (rt_exact_counts(slate, line, t)) return true;
    }
    return false;
}

/* With s the height in parts of the axis (0 at the base, 1 at the apex) and H the square of its length, the
 * side is where |p - base|^2 - H s^2 = (r0 + (r1 - r0) s)^2: no root is taken to get there. */
static bool cone_hit(RtSlate *slate, const RtCone *cone, const RtExactLine *line, RtPlace *t) {
    RtExactVec base = vertex(slate, cone->base), org = rt_exact_vec_sub(slate, line->org, base),
               dir = line->dir;
    RtExactVec axis = rt_exact_vec_sub(slate, vertex(slate, cone->apex), base);
    RtRational height = rt_exact_dot(slate, axis, axis);
    RtRational s = rt_exact_div(slate, rt_exact_dot(slate, org, axis), height);
    RtRational ds = rt_exact_div(slate, rt_exact_dot(slate, dir, axis), height);
    RtRational base_radius = rt_exact_of(slate, (double)cone->base_radius);
    RtRational slope = rt_exact_sub(slate, rt_exact_of(slate, (double)cone->apex_radius), base_radius);
    RtRational r = rt_exact_add(slate, base_radius, rt_exact_mul(slate, slope, s));
    RtRational dr = rt_exact_mul(slate, slope, ds);

    const RtExactVec points[2] = {org, dir};
    const RtRational heights[2] = {s, ds}, radii[2] = {r, dr};
    RtRational form[3]; /* c, b, a */
    for (int i = 0; i < 3; i++) {
        int k = i / 2, l = (i + 1) / 2; /* org org, org dir, dir dir */
        RtRational along = rt_exact_mul(slate, height, rt_exact_mul(slate, heights[k], heights[l]));
        RtRational around = rt_exact_mul(slate, radii[k], radii[l]);
        RtRational across = rt_exact_sub(slate, rt_exact_dot(slate, points[k], points[l]), along);
        form[i] = rt_exact_sub(slate, across, around);
    }
    RtSurd roots[2];
    int count = rt_exact_roots(slate, form[2], form[1], form[0], roots);
    RtRational beyond = rt_exact_sub(slate, s, rt_exact_of(slate, 1));
    for (int i = 0; i < count; i++) {
        *t = rt_place_of_surd(&roots[i]);
        RtSurd over = rt_surd_line(slate, s, ds, &roots[i]),
               under = rt_surd_line(slate, beyond, ds, &roots[i]);
        if (rt_surd_sign(slate, &over) < 0 || rt_surd_sign(slate, &under) > 0) continue;
        if (rt_exact_counts(slate, line, t)) return true;
    }
    return false;
}

RtFinding rt_exact_hit(RtSlate *slate, const RtGeometry *geometry, uint32_t id, const RtExactLine *line,
                       RtPlace *t) {
    uint32_t index = rt_ref_index(geometry->objects[id]);
    bool hit = false;
    switch (rt_ref_shape(geometry->objects[id])) {
    case RT_SHAPE_TRIANGLE: hit = triangle_hit(slate, &geometry->triangles[index], line, t); break;
    case RT_SHAPE_SPHERE: hit = sphere_hit(slate, &geometry->spheres[index], line, t); break;
    case RT_SHAPE_POLYGON: {
        const RtPolygon *polygon = &geometry->polygons[index];
        hit = polygon_hit(slate, polygon, geometry->polygon_vertices + polygon->first, line, t);
        break;
    }
    case RT_SHAPE_CONE: hit = cone_hit(slate, &geometry->cones[index], line, t); break;
    case RT_SHAPE_CSG: return rt_exact_csg_hit(slate, &geometry->forest, &geometry->csgs[index], line, t);
    case RT_SHAPE_COUNT: return RT_UNDECIDED;
    }
    return hit ? RT_HIT : RT_MISSED;
}
