/* SPDX-License-Identifier: Apache-2.0 */
#include "exact/exact_hit.h"

#include "exact/exact_csg.h"

static RtExactVec vertex(RtExactArena *arena, RtVec3 v) {
    return rt_exact_vec(arena, rt_widen(v));
}

/* ---- flat shapes ---- */

static bool flat_hit(RtExactArena *arena, const RtExactLine *line, RtRational t, RtPlace *out) {
    *out = rt_place_of(arena, t);
    return rt_exact_counts(arena, line, out);
}

/* Edge functions are the volumes between direction and edge as seen from the origin. They sum to the normal's
 * part along the direction. */
static bool triangle_hit(RtExactArena *arena, const RtTriangle *triangle, const RtExactLine *line,
                         RtPlace *t) {
    RtExactVec from[3], normals[3];
    RtRational edges[3];
    bool left = false, right = false;
    for (int i = 0; i < 3; i++) from[i] = rt_exact_vec_sub(arena, vertex(arena, triangle->v[i]), line->org);
    for (int i = 0; i < 3; i++) {
        normals[i] = rt_exact_cross(arena, from[i], from[(i + 1) % 3]);
        edges[i] = rt_exact_dot(arena, normals[i], line->dir);
        left |= rt_exact_sign(edges[i]) < 0;
        right |= rt_exact_sign(edges[i]) > 0;
    }
    if (left == right) return false; /* passes by, or all three are 0: in the plane, or no plane at all */
    RtRational sum = rt_exact_add(arena, rt_exact_add(arena, edges[0], edges[1]), edges[2]);
    RtRational volume = rt_exact_dot(arena, normals[0], from[2]);
    return flat_hit(arena, line, rt_exact_div(arena, volume, sum), t);
}

/* Of p beside the edge from a to b: does the edge count for the even-odd rule, or is p on it? */
typedef enum EdgeCase { EDGE_ASIDE, EDGE_CROSSED, EDGE_MET } EdgeCase;

static EdgeCase edge_case(RtExactArena *arena, const RtRational a[2], const RtRational b[2],
                          const RtRational p[2]) {
    int av = mpq_cmp(a[1], p[1]), bv = mpq_cmp(b[1], p[1]);
    if ((av < 0 && bv < 0) || (av > 0 && bv > 0)) return EDGE_ASIDE;
    RtRational along = rt_exact_mul(arena, rt_exact_sub(arena, b[0], a[0]), rt_exact_sub(arena, p[1], a[1]));
    RtRational across = rt_exact_mul(arena, rt_exact_sub(arena, p[0], a[0]), rt_exact_sub(arena, b[1], a[1]));
    int side = mpq_cmp(along, across), au = mpq_cmp(a[0], p[0]), bu = mpq_cmp(b[0], p[0]);
    if (side == 0 && (au >= 0 || bu >= 0) && (au <= 0 || bu <= 0)) return EDGE_MET;
    bool crossed = (av > 0) != (bv > 0) && (mpq_cmp(b[1], a[1]) > 0 ? side > 0 : side < 0);
    return crossed ? EDGE_CROSSED : EDGE_ASIDE;
}

static bool inside_polygon(RtExactArena *arena, const RtPolygon *polygon, const RtVec3 *vertices,
                           RtExactVec p) {
    const RtRational point[2] = {p.at[polygon->u], p.at[polygon->v]};
    bool inside = false;
    for (uint32_t i = 0; i < polygon->count; i++) {
        size_t mark = rt_exact_arena_mark(arena);
        RtExactVec a = vertex(arena, vertices[i]), b = vertex(arena, vertices[(i + 1) % polygon->count]);
        const RtRational from[2] = {a.at[polygon->u], a.at[polygon->v]};
        const RtRational to[2] = {b.at[polygon->u], b.at[polygon->v]};
        EdgeCase what = edge_case(arena, from, to, point);
        rt_exact_arena_rewind(arena, mark);
        if (what == EDGE_MET) return true;
        if (what == EDGE_CROSSED) inside = !inside;
    }
    return inside;
}

/* About vertex 0: the sums are exact wherever they are taken. */
static bool polygon_hit(RtExactArena *arena, const RtPolygon *polygon, const RtVec3 *vertices,
                        const RtExactLine *line, RtPlace *t) {
    RtExactVec first = vertex(arena, vertices[0]), normal = rt_exact_vec(arena, (RtVec3d){0});
    RtExactVec sum = normal, last = normal;
    RtRational one = rt_exact_of(arena, 1);
    for (uint32_t i = 1; i < polygon->count; i++) {
        RtExactVec from = rt_exact_vec_sub(arena, vertex(arena, vertices[i]), first);
        sum = rt_exact_vec_add_scaled(arena, sum, from, one);
        normal = rt_exact_vec_add_scaled(arena, normal, rt_exact_cross(arena, last, from), one);
        last = from;
    }
    RtRational approach = rt_exact_dot(arena, normal, line->dir);
    if (rt_exact_sign(approach) == 0) return false;
    RtRational part = rt_exact_div(arena, one, rt_exact_of(arena, polygon->count));
    RtExactVec center = rt_exact_vec_add_scaled(arena, first, sum, part);
    RtRational height = rt_exact_dot(arena, normal, rt_exact_vec_sub(arena, center, line->org));
    RtRational at = rt_exact_div(arena, height, approach);
    return flat_hit(arena, line, at, t) &&
           inside_polygon(arena, polygon, vertices, rt_exact_vec_add_scaled(arena, line->org, line->dir, at));
}

/* ---- round shapes ---- */

static bool sphere_hit(RtExactArena *arena, const RtSphere *sphere, const RtExactLine *line, RtPlace *t) {
    RtExactVec org = rt_exact_vec_sub(arena, line->org, vertex(arena, sphere->center));
    RtRational radius = rt_exact_of(arena, (double)sphere->radius);
    RtRational c = rt_exact_sub(arena, rt_exact_dot(arena, org, org), rt_exact_mul(arena, radius, radius));
    RtSurd roots[2];
    int count = rt_exact_roots(arena, rt_exact_dot(arena, line->dir, line->dir),
                               rt_exact_dot(arena, org, line->dir), c, roots);
    for (int i = 0; i < count; i++) {
        *t = rt_place_of_surd(&roots[i]);
        if (rt_exact_counts(arena, line, t)) return true;
    }
    return false;
}

/* With s the height in parts of the axis (0 at the base, 1 at the apex) and H the square of its length, the
 * side is where |p - base|^2 - H s^2 = (r0 + (r1 - r0) s)^2: no root is taken to get there. */
static bool cone_hit(RtExactArena *arena, const RtCone *cone, const RtExactLine *line, RtPlace *t) {
    RtExactVec base = vertex(arena, cone->base), org = rt_exact_vec_sub(arena, line->org, base),
               dir = line->dir;
    RtExactVec axis = rt_exact_vec_sub(arena, vertex(arena, cone->apex), base);
    RtRational height = rt_exact_dot(arena, axis, axis);
    RtRational s = rt_exact_div(arena, rt_exact_dot(arena, org, axis), height);
    RtRational ds = rt_exact_div(arena, rt_exact_dot(arena, dir, axis), height);
    RtRational base_radius = rt_exact_of(arena, (double)cone->base_radius);
    RtRational slope = rt_exact_sub(arena, rt_exact_of(arena, (double)cone->apex_radius), base_radius);
    RtRational r = rt_exact_add(arena, base_radius, rt_exact_mul(arena, slope, s));
    RtRational dr = rt_exact_mul(arena, slope, ds);

    const RtExactVec points[2] = {org, dir};
    const RtRational heights[2] = {s, ds}, radii[2] = {r, dr};
    RtRational form[3]; /* c, b, a */
    for (int i = 0; i < 3; i++) {
        int k = i / 2, l = (i + 1) / 2; /* org org, org dir, dir dir */
        RtRational along = rt_exact_mul(arena, height, rt_exact_mul(arena, heights[k], heights[l]));
        RtRational around = rt_exact_mul(arena, radii[k], radii[l]);
        RtRational across = rt_exact_sub(arena, rt_exact_dot(arena, points[k], points[l]), along);
        form[i] = rt_exact_sub(arena, across, around);
    }
    RtSurd roots[2];
    int count = rt_exact_roots(arena, form[2], form[1], form[0], roots);
    RtRational beyond = rt_exact_sub(arena, s, rt_exact_of(arena, 1));
    for (int i = 0; i < count; i++) {
        *t = rt_place_of_surd(&roots[i]);
        RtSurd over = rt_surd_line(arena, s, ds, &roots[i]),
               under = rt_surd_line(arena, beyond, ds, &roots[i]);
        if (rt_surd_sign(arena, &over) < 0 || rt_surd_sign(arena, &under) > 0) continue;
        if (rt_exact_counts(arena, line, t)) return true;
    }
    return false;
}

RtFinding rt_exact_hit(RtExactArena *arena, const RtGeometry *geometry, uint32_t id, const RtExactLine *line,
                       RtPlace *t) {
    uint32_t index = rt_ref_index(geometry->objects[id]);
    bool hit = false;
    switch (rt_ref_shape(geometry->objects[id])) {
    case RT_SHAPE_TRIANGLE: hit = triangle_hit(arena, &geometry->triangles[index], line, t); break;
    case RT_SHAPE_SPHERE: hit = sphere_hit(arena, &geometry->spheres[index], line, t); break;
    case RT_SHAPE_POLYGON:
        hit = polygon_hit(arena, &geometry->polygons[index], rt_polygon_vertices(geometry, index), line, t);
        break;
    case RT_SHAPE_CONE: hit = cone_hit(arena, &geometry->cones[index], line, t); break;
    case RT_SHAPE_CSG: return rt_exact_csg_hit(arena, &geometry->forest, &geometry->csgs[index], line, t);
    case RT_SHAPE_COUNT: return RT_UNDECIDED;
    }
    return hit ? RT_HIT : RT_MISSED;
}
