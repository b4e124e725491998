/* SPDX-License-Identifier: Apache-2.0 */
#include "exact/margin.h"

#include "exact/referee.h"

RtMarginRay rt_margin_ray(const RtGeometry *geometry, const RtRay *ray, bool absolute) {
    RtMarginRay m = {.wide = rt_wide_ray(ray)};
    m.line = rt_unit_line(&m.wide);
    m.first = m.wide.tmin * m.line.length;
    m.last = fmin(m.wide.tmax, (double)FLT_MAX) * m.line.length;
    m.extra = 0x1p-149 * m.line.length;
    if (!absolute) return m;
    double largest = geometry->object_count > 0 ? rt_box_largest_coordinate(geometry->box) : 0;
    for (int a = 0; a < 3; a++) largest = fmax(largest, fabs(m.wide.org.at[a]));
    m.extra += RT_MARGIN / 2 * largest;
    return m;
}

/* Of a CSG tree, the box of all solids. */
static RtBox reach_of(const RtGeometry *g, uint32_t id) {
    RtRef ref = g->objects[id];
    if (rt_ref_shape(ref) != RT_SHAPE_CSG) return g->boxes[id];
    return rt_box_union(g->boxes[id], g->csgs[rt_ref_index(ref)].reach);
}

double rt_margin_delta(const RtMarginRay *ray, const RtGeometry *geometry, uint32_t id) {
    RtBox reach = reach_of(geometry, id);
    return RT_MARGIN * rt_far_corner(&ray->line, &reach) + ray->extra;
}

/* ---- pieces of the line ---- */

/* A margin that is being made. */
typedef struct Making {
    RtMargin *margin;
    const RtMarginRay *ray;
    double delta, asked;
} Making;

/* Adds a piece between the grown and the shrunk object; `crossed` if a crossing in it is certain. Pieces come
 * in ascending order. */
static void add_piece(const Making *making, double lo, double hi, bool crossed) {
    RtMargin *m = making->margin;
    const RtMarginRay *ray = making->ray;
    const double delta = making->delta, asked = making->asked;
    lo = fmax(lo, ray->first - delta);
    hi = fmin(hi, ray->last + delta);
    if (m->certain || !(lo <= hi)) return;
    m->possible = true;
    m->earliest = fmin(m->earliest, lo);
    if (asked >= lo && asked <= hi) {
        m->holds = true;
        m->lo = lo;
        m->hi = hi;
    }
    m->certain = crossed && lo >= ray->first + delta && hi <= ray->last - delta;
    m->latest = hi;
}

/* The boundaries of an object on the line, in ascending order; before the first the line is outside. */
typedef struct Boundaries {
    const double *at; /* [count] */
    uint32_t count;
} Boundaries;

/* Where a crossing must lie: heights of a cone. Elsewhere everything is allowed. */
typedef struct Limits {
    double possible_lo, possible_hi, certain_lo, certain_hi;
} Limits;

static const Limits no_limits = {-HUGE_VAL, HUGE_VAL, -HUGE_VAL, HUGE_VAL};

/* Adds the pieces of the line that are inside the grown object and outside the shrunk one. */
static void add_pieces(const Making *m, Boundaries grown, Boundaries shrunk, Limits limits) {
    uint32_t g = 0, s = 0;
    bool began_inside = false; /* the shrunk object lies before the piece */
    double begin = 0;
    while (g < grown.count || s < shrunk.count) {
        bool between = g % 2 == 1 && s % 2 == 0;
        /* Inside the grown object wherever inside the shrunk one, so in a tie the grown one begins first and
         * ends last. */
        bool next_grown =
            s == shrunk.count ||
            (g < grown.count && (g % 2 == 0 ? grown.at[g] <= shrunk.at[s] : grown.at[g] < shrunk.at[s]));
        double at = next_grown ? grown.at[g++] : shrunk.at[s++];
        if (between) {
            bool ends_inside = s % 2 == 1;
            bool crossed =
                began_inside != ends_inside && begin >= limits.certain_lo && at <= limits.certain_hi;
            add_piece(m, fmax(begin, limits.possible_lo), fmin(at, limits.possible_hi), crossed);
        }
        began_inside = !next_grown;
        begin = at;
    }
}

/* ---- spheres ---- */

/* Where the line is inside a sphere of that radius about the point at `closest`, which it passes at a
 * distance whose square is `square`. */
static Boundaries chord(double closest, double square, double radius, double at[2]) {
    if (!(radius > 0 && square < radius * radius)) return (Boundaries){at, 0};
    double half = sqrt(radius * radius - square);
    at[0] = closest - half;
    at[1] = closest + half;
    return (Boundaries){at, 2};
}

static void sphere_margin(const Making *m, const RtSphere *sphere) {
    const RtUnitLine *line = &m->ray->line;
    RtVec3d org = rt_subd(line->org, rt_widen(sphere->center));
    double closest = -rt_dotd(org, line->dir), radius = (double)sphere->radius;
    RtVec3d across = rt_add_scaledd(org, line->dir, closest);
    double square = rt_dotd(across, across), at[2][2];
    add_pieces(m, chord(closest, square, radius + m->delta, at[0]),
               chord(closest, square, radius - m->delta, at[1]), no_limits);
}

/* ---- cones ---- */

/* A linear function of the distance. */
typedef struct Linear {
    double at_0, rate;
} Linear;

/* Where the line, `square` = |p - base|^2 with terms of degree 0 and 1 (halved), is nearer to the axis than
 * `radius`, and that is above 0: at most one interval. */
static Boundaries cone_chord(const double square[2], Linear height, Linear radius, double at[2]) {
    double a = 1 - height.rate * height.rate - radius.rate * radius.rate;
    double half_b = square[1] - height.at_0 * height.rate - radius.at_0 * radius.rate;
    double c = square[0] - height.at_0 * height.at_0 - radius.at_0 * radius.at_0;
    double discriminant = half_b * half_b - a * c, roots[2];
    if (a > 0 ? !(discriminant > 0) : a == 0 && half_b == 0) return (Boundaries){at, 0};
    int count = raytally_quadratic_roots(a, half_b, c, fmax(discriminant, 0), roots);
    if (count == 0) return (Boundaries){at, 0};
    at[0] = roots[0];
    at[1] = roots[count - 1];
    if (a > 0) {
        double middle = (at[0] + at[1]) / 2;
        return (Boundaries){at, radius.at_0 + radius.rate * middle > 0 ? 2 : 0};
    }
    /* Steeper than the side: in one of the two halves of the double cone from its root on, or up to it. */
    if (radius.rate > 0)
        at[0] = at[1], at[1] = HUGE_VAL;
    else
        at[1] = at[0], at[0] = -HUGE_VAL;
    return (Boundaries){at, 2};
}

static void cone_margin(const Making *m, const RtCone *cone) {
    const RtUnitLine *line = &m->ray->line;
    const double delta = m->delta;
    RtVec3d base = rt_widen(cone->base), axis = rt_subd(rt_widen(cone->apex), base);
    double length = rt_lengthd(axis),
           slope = ((double)cone->apex_radius - (double)cone->base_radius) / length;
    axis = rt_scaled(axis, 1 / length);
    /* Distances from the place nearest to the cone's middle, for the sake of digits. */
    RtVec3d middle = rt_add_scaledd(base, axis, length / 2);
    double shift = rt_dotd(rt_subd(middle, line->org), line->dir), at[2][2];
    RtVec3d from = rt_subd(rt_add_scaledd(line->org, line->dir, shift), base);
    const double square[2] = {rt_dotd(from, from), rt_dotd(from, line->dir)};
    const Linear height = {rt_dotd(from, axis), rt_dotd(line->dir, axis)};
    Boundaries boundaries[2];
    for (int i = 0; i < 2; i++) {
        double grow = (i == 0 ? delta : -delta) * sqrt(1 + slope * slope);
        const Linear radius = {(double)cone->base_radius + grow + slope * height.at_0, slope * height.rate};
        boundaries[i] = cone_chord(square, height, radius, at[i]);
        for (uint32_t k = 0; k < boundaries[i].count; k++) at[i][k] += shift;
    }
    Limits limits = no_limits;
    double lo = -height.at_0, hi = length - height.at_0;
    if (height.rate == 0) {
        if (lo > delta || hi < -delta) return;
        if (lo > -delta || hi < delta) limits.certain_lo = HUGE_VAL;
    } else {
        double sign = copysign(1, height.rate), near = sign > 0 ? lo : hi, far = sign > 0 ? hi : lo;
        limits.possible_lo = shift + (near - sign * delta) / height.rate;
        limits.possible_hi = shift + (far + sign * delta) / height.rate;
        limits.certain_lo = shift + (near + sign * delta) / height.rate;
        limits.certain_hi = shift + (far - sign * delta) / height.rate;
    }
    add_pieces(m, boundaries[0], boundaries[1], limits);
}

/* ---- CSG trees ---- */

static RtStatus csg_margin(const Making *m, const RtGeometry *g, uint32_t index, RtError *error) {
    RT_ARENA(memory);
    Boundaries boundaries[2];
    for (int i = 0; i < 2; i++) {
        double *at, grow = i == 0 ? m->delta : -m->delta;
        RT_TRY(rt_exact_csg_boundaries(&g->forest, &g->csgs[index], &m->ray->wide, grow, &memory, &at,
                                       &boundaries[i].count, error));
        for (uint32_t k = 0; k < boundaries[i].count; k++) at[k] *= m->ray->line.length;
        boundaries[i].at = at;
    }
    add_pieces(m, boundaries[0], boundaries[1], no_limits);
    return RT_OK;
}

/* ---- all shapes ---- */

static void flat_margin(const Making *m, const RtVec3 *vertices, uint32_t count, const RtBox *box) {
    RtFlatMargin flat = rt_flat_margin(&m->ray->line, vertices, count, box, m->delta);
    if (flat.possible) add_piece(m, flat.lo, flat.hi, flat.certain);
    m->margin->edge_on = flat.edge_on;
}

RtStatus rt_margin_of(const RtMarginRay *ray, const RtGeometry *geometry, uint32_t id, double asked,
                      RtMargin *m, RtError *error) {
    uint32_t index = rt_ref_index(geometry->objects[id]);
    const RtBox *box = &geometry->boxes[id];
    double delta = rt_margin_delta(ray, geometry, id), far = delta / RT_MARGIN, length = ray->line.length;
    const Making making = {m, ray, delta, asked};
    double lo, hi;
    *m = (RtMargin){.earliest = HUGE_VAL};
    if (!rt_line_in_box(&ray->line, box, delta, &lo, &hi) || hi < ray->first - delta ||
        lo > ray->last + delta)
        return RT_OK;
    const RtShape shape = rt_ref_shape(geometry->objects[id]);
    const bool flat = shape == RT_SHAPE_TRIANGLE || shape == RT_SHAPE_POLYGON;
    if (!flat &&
        rt_exceeds_float(fmin(far, length) * fmin(far, length), fmax(far, length) * fmax(far, length))) {
        add_piece(&making, -HUGE_VAL, HUGE_VAL, false);
        return RT_OK;
    }
    switch (shape) {
    case RT_SHAPE_TRIANGLE: flat_margin(&making, geometry->triangles[index].v, 3, box); break;
    case RT_SHAPE_POLYGON:
        flat_margin(&making, rt_polygon_vertices(geometry, index), geometry->polygons[index].count, box);
        break;
    case RT_SHAPE_SPHERE: sphere_margin(&making, &geometry->spheres[index]); break;
    case RT_SHAPE_CONE: cone_margin(&making, &geometry->cones[index]); break;
    case RT_SHAPE_CSG: return csg_margin(&making, geometry, index, error);
    case RT_SHAPE_INSTANCE: /* what is judged has none */
    case RT_SHAPE_COUNT: break;
    }
    return RT_OK;
}
