/* SPDX-License-Identifier: Apache-2.0 */
/* The distance of a ray from the decision boundary of an object: a hit function may differ from exact
 * arithmetic only if a slightly moved ray would be decided its way.
 *
 * The unit is the effect of rounding to float32 on a point seen from the origin: 2^-24 of the distance to
 * the farthest plane of the object's box, along the axis where it is largest. The thickness by which boxes
 * are widened (core/base/ray.h) is 16 units. */
#ifndef RT_TESTS_EXACT_BORDER_H
#define RT_TESTS_EXACT_BORDER_H

#include "exact/referee.h"

/* The result of a hit function for a ray and an object. */
typedef struct Decision {
    bool hit;
    float t;
} Decision;

/* The least and the greatest move that border_distance tries, as powers of two. */
enum { BORDER_NEAR = -6, BORDER_FAR = 20 };

/* The distance of the line's origin from the farthest plane of the box. */
static inline double farthest_plane(RtBox box, const RtWideRay *line) {
    double reach = 0;
    for (int a = 0; a < 3; a++) {
        reach = fmax(reach, fabs((double)box.lo.at[a] - line->org.at[a]));
        reach = fmax(reach, fabs((double)box.hi.at[a] - line->org.at[a]));
    }
    return reach;
}

/* The unit for object `id`. */
static inline double border_unit(const RtGeometry *geometry, uint32_t id, const RtWideRay *line) {
    return 0x1p-24 * farthest_plane(geometry->boxes[id], line);
}

static inline bool same_place(const RtGeometry *g, uint32_t id, const RtWideRay *line, float ours,
                              long double exact) {
    RtShape shape = rt_ref_shape(g->objects[id]);
    if (shape == RT_SHAPE_TRIANGLE || shape == RT_SHAPE_POLYGON) return true;
    double off = (double)fabsl((long double)ours - exact) * rt_lengthd(line->dir);
    double size = rt_lengthd(rt_widen(rt_box_size(g->boxes[id])));
    return off <= 0x1p-8 * size + 2 * border_unit(g, id, line);
}

/* The result of our hit function; `hit_memory` comes from rt_hit_memory_alloc. */
static inline Decision decision_of(const RtGeometry *geometry, uint32_t id, const RtRay *ray,
                                   RtHitMemory *hit_memory) {
    RtPreparedRay prepared;
    rt_hit_ray(&prepared, geometry, ray, hit_memory);
    Decision decision = {.t = INFINITY};
    decision.hit = rt_object_hit(geometry, id, &prepared, &decision.t, NULL);
    return decision;
}

/* Is it what exact arithmetic decides? A hit on an object that a line can meet more than once has to be the
 * same one: t and the exact t are no farther apart than 2^-8 of the size of the box and two units.
 * RT_UNDECIDED where that is. */
static inline RtExactResult check_decision(const RtGeometry *geometry, uint32_t id, const RtWideRay *line,
                                           Decision decision) {
    long double t;
    RtExactResult finding = rt_referee_hit(geometry, id, line, &t);
    if (finding == RT_UNDECIDED) return finding;
    if (!decision.hit || finding == RT_MISSED)
        return decision.hit == (finding == RT_HIT) ? RT_HIT : RT_MISSED;
    return same_place(geometry, id, line, decision.t, t) ? RT_HIT : RT_MISSED;
}

/* The distance of the line from the segment a b: of the origin from its projection along the line. `dir` is
 * unit. */
static inline double distance_from_edge(const RtWideRay *line, RtVec3d dir, RtVec3 a, RtVec3 b) {
    RtVec3d from = rt_subd(rt_widen(a), line->org), side = rt_subd(rt_widen(b), rt_widen(a));
    from = rt_add_scaledd(from, dir, -rt_dotd(from, dir));
    side = rt_add_scaledd(side, dir, -rt_dotd(side, dir));
    double length = rt_dotd(side, side);
    double part = length > 0 ? fmin(fmax(-rt_dotd(from, side) / length, 0), 1) : 0;
    return rt_lengthd(rt_add_scaledd(from, side, part));
}

static inline double distance_from_edges(const RtWideRay *line, const RtVec3 *vertices, uint32_t count) {
    double least = HUGE_VAL;
    RtVec3d dir = rt_normalized(line->dir);
    for (uint32_t i = 0; i < count; i++)
        least = fmin(least, distance_from_edge(line, dir, vertices[i], vertices[(i + 1) % count]));
    return least;
}

/* By moving the line until the referee decides so, along the faces, edges and corners of a cube. */
static inline double least_move(const RtGeometry *g, uint32_t id, RtWideRay line, double unit,
                                Decision decision) {
    RtVec3d org = line.org;
    for (int k = BORDER_NEAR; k <= BORDER_FAR; k++) {
        for (int i = 0; i < 27; i++) {
            int x = i % 3, y = i / 3 % 3, z = i / 9;
            RtVec3d move = {x - 1, y - 1, z - 1};
            line.org = rt_add_scaledd(org, move, ldexp(unit, k));
            if (check_decision(g, id, &line, decision) == RT_HIT) return ldexp(1, k);
        }
    }
    return INFINITY;
}

/* Of the start of the ray from the plane: the ends of the interval are a border, too. */
static inline double distance_from_plane(const RtWideRay *line, RtVec3d point, RtVec3d normal) {
    RtVec3d start = rt_add_scaledd(line->org, line->dir, line->tmin);
    return fabs(rt_dotd(rt_subd(start, point), rt_normalized(normal)));
}

/* How near to a border of the object the ray's line passes, in units. Of flat shapes it is the distance from
 * the nearest edge, or of the ray's start from the plane. Of others it is the least power of two,
 * 2^BORDER_NEAR or more, by which the origin has to be moved, along one of the 26 directions of a cube's
 * faces, edges and corners, for exact arithmetic to decide like `decision`; INFINITY where 2^BORDER_FAR
 * does not do. */
static inline double border_distance(const RtGeometry *geometry, uint32_t id, const RtRay *ray,
                                     Decision decision) {
    RtWideRay line = rt_wide_ray(ray);
    uint32_t index = rt_ref_index(geometry->objects[id]);
    double unit = border_unit(geometry, id, &line);
    const RtShape shape = rt_ref_shape(geometry->objects[id]);
    const bool triangle = shape == RT_SHAPE_TRIANGLE;
    if (!triangle && shape != RT_SHAPE_POLYGON) return least_move(geometry, id, line, unit, decision);
    const RtVec3 *v = triangle ? geometry->triangles[index].v : rt_polygon_vertices(geometry, index);
    const RtVec3d normal = triangle ? rt_area_vector(rt_widen(v[0]), rt_widen(v[1]), rt_widen(v[2]))
                                    : geometry->polygons[index].normal;
    const double edge = distance_from_edges(&line, v, triangle ? 3 : geometry->polygons[index].count);
    return fmin(edge, distance_from_plane(&line, rt_widen(v[0]), normal)) / unit;
}

/* t - exact t, an exact difference, and the same in ulps of the exact t in float32. RT_MISSED if object `id`
 * is not met. */
static inline RtExactResult error_of_t(const RtGeometry *geometry, uint32_t id, const RtRay *ray, float t,
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

#endif
