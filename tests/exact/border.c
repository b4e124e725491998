/* SPDX-License-Identifier: Apache-2.0 */
#include "exact/border.h"

double rt_border_unit(const RtGeometry *geometry, uint32_t id, const RtWideRay *line) {
    double reach = 0;
    for (int a = 0; a < 3; a++) {
        reach = fmax(reach, fabs((double)geometry->boxes[id].lo.at[a] - line->org.at[a]));
        reach = fmax(reach, fabs((double)geometry->boxes[id].hi.at[a] - line->org.at[a]));
    }
    return 0x1p-24 * reach;
}

static bool same_place(const RtGeometry *g, uint32_t id, const RtWideRay *line, float ours,
                       long double exact) {
    RtShape shape = rt_ref_shape(g->objects[id]);
    if (shape == RT_SHAPE_TRIANGLE || shape == RT_SHAPE_POLYGON) return true;
    double off = (double)fabsl((long double)ours - exact) * rt_lengthd(line->dir);
    double size = rt_lengthd(rt_widen(rt_box_size(g->boxes[id])));
    return off <= 0x1p-8 * size + 2 * rt_border_unit(g, id, line);
}

RtDecision rt_decision_of(const RtGeometry *geometry, uint32_t id, const RtRay *ray, RtCrossing *crossings) {
    RtPreparedRay prepared;
    rt_hit_ray(&prepared, geometry, ray, crossings);
    RtDecision decision = {.t = INFINITY};
    decision.hit = rt_object_hit(geometry, id, &prepared, &decision.t, NULL);
    return decision;
}

RtExactResult rt_decision_check(const RtGeometry *geometry, uint32_t id, const RtWideRay *line,
                                RtDecision decision) {
    long double t;
    RtExactResult finding = rt_referee_hit(geometry, id, line, &t);
    if (finding == RT_UNDECIDED) return finding;
    if (!decision.hit || finding == RT_MISSED)
        return decision.hit == (finding == RT_HIT) ? RT_HIT : RT_MISSED;
    return same_place(geometry, id, line, decision.t, t) ? RT_HIT : RT_MISSED;
}

/* The distance of the line from the segment a b: of the origin from its projection along the line. `dir` is
 * unit. */
static double distance_from_edge(const RtWideRay *line, RtVec3d dir, RtVec3 a, RtVec3 b) {
    RtVec3d from = rt_subd(rt_widen(a), line->org), side = rt_subd(rt_widen(b), rt_widen(a));
    from = rt_add_scaledd(from, dir, -rt_dotd(from, dir));
    side = rt_add_scaledd(side, dir, -rt_dotd(side, dir));
    double length = rt_dotd(side, side);
    double part = length > 0 ? fmin(fmax(-rt_dotd(from, side) / length, 0), 1) : 0;
    return rt_lengthd(rt_add_scaledd(from, side, part));
}

static double distance_from_edges(const RtWideRay *line, const RtVec3 *vertices, uint32_t count) {
    double least = HUGE_VAL;
    RtVec3d dir = rt_normalized(line->dir);
    for (uint32_t i = 0; i < count; i++)
        least = fmin(least, distance_from_edge(line, dir, vertices[i], vertices[(i + 1) % count]));
    return least;
}

/* By moving the line until the referee decides so, along the faces, edges and corners of a cube. */
static double least_move(const RtGeometry *g, uint32_t id, RtWideRay line, double unit, RtDecision decision) {
    RtVec3d org = line.org;
    for (int k = RT_BORDER_NEAR; k <= RT_BORDER_FAR; k++) {
        for (int i = 0; i < 27; i++) {
            int x = i % 3, y = i / 3 % 3, z = i / 9;
            RtVec3d move = {x - 1, y - 1, z - 1};
            line.org = rt_add_scaledd(org, move, ldexp(unit, k));
            if (rt_decision_check(g, id, &line, decision) == RT_HIT) return ldexp(1, k);
        }
    }
    return INFINITY;
}

/* Of the start of the ray from the plane: the ends of the interval are a border, too. */
static double distance_from_plane(const RtWideRay *line, RtVec3d point, RtVec3d normal) {
    RtVec3d start = rt_add_scaledd(line->org, line->dir, line->tmin);
    return fabs(rt_dotd(rt_subd(start, point), rt_normalized(normal)));
}

double rt_border_distance(const RtGeometry *geometry, uint32_t id, const RtRay *ray, RtDecision decision) {
    RtWideRay line = rt_wide_ray(ray);
    uint32_t index = rt_ref_index(geometry->objects[id]);
    double unit = rt_border_unit(geometry, id, &line);
    switch (rt_ref_shape(geometry->objects[id])) {
    case RT_SHAPE_TRIANGLE: {
        const RtVec3 *v = geometry->triangles[index].v;
        const RtVec3d normal = rt_area_vector(rt_widen(v[0]), rt_widen(v[1]), rt_widen(v[2]));
        return fmin(distance_from_edges(&line, v, 3), distance_from_plane(&line, rt_widen(v[0]), normal)) /
               unit;
    }
    case RT_SHAPE_POLYGON: {
        const RtPolygon *polygon = &geometry->polygons[index];
        const RtVec3 *v = geometry->polygon_vertices + polygon->first;
        return fmin(distance_from_edges(&line, v, polygon->count),
                    distance_from_plane(&line, rt_widen(v[0]), polygon->normal)) /
               unit;
    }
    default: return least_move(geometry, id, line, unit, decision);
    }
}

RtExactResult rt_referee_error(const RtGeometry *geometry, uint32_t id, const RtRay *ray, float t,
                               long double *off, long double *ulps) {
    size_t mark = rt_exact_mark();
    RtWideRay line = rt_wide_ray(ray);
    RtExactLine exact = rt_exact_line(&line);
    RtRoot at;
    RtExactResult finding = rt_exact_hit(geometry, id, &exact, &at);
    if (finding == RT_HIT) {
        *off = -rt_root_value(&at, rt_exact_of((double)t));
        *ulps = *off / rt_float_ulp(rt_root_value(&at, exact.zero));
    }
    rt_exact_rewind(mark);
    return finding;
}
