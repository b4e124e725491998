/* SPDX-License-Identifier: Apache-2.0 */
#include "exact/margin.h"

#include "exact/referee.h"

static void set_line(RtMarginRay *m) {
    m->line = rt_unit_line(&m->wide);
    m->first = m->wide.tmin * m->line.length;
    m->last = fmin(m->wide.tmax, (double)FLT_MAX) * m->line.length;
    m->extra = 0x1p-149 * m->line.length;
}

/* What absolute coordinates add to delta. */
static double absolute_error(const RtMarginRay *ray, const RtGeometry *geometry) {
    if (!ray->absolute) return 0;
    double largest = geometry->object_count > 0 ? rt_box_largest_coordinate(geometry->box) : 0;
    for (int a = 0; a < 3; a++) largest = fmax(largest, fabs(ray->wide.org.at[a]));
    return RT_MARGIN / 2 * largest;
}

RtMarginRay rt_margin_ray(const RtGeometry *geometry, const RtRay *ray, bool absolute) {
    RtMarginRay m = {
        .wide = rt_wide_ray(ray), .absolute = absolute, .scale = 1, .enter = -HUGE_VAL, .leave = HUGE_VAL};
    set_line(&m);
    m.extra += absolute_error(&m, geometry);
    return m;
}

/* Of a CSG tree, the box of all solids. */
static RtBox reach_of(const RtGeometry *g, uint32_t id) {
    RtRef ref = g->objects[id];
    if (rt_ref_shape(ref) != RT_SHAPE_CSG) return g->boxes[id];
    return rt_box_union(g->boxes[id], g->csgs[rt_ref_index(ref)].reach);
}

static double delta_of(const RtMarginRay *ray, const RtGeometry *geometry, uint32_t object) {
    RtBox reach = reach_of(geometry, object);
    return RT_MARGIN * rt_far_corner(&ray->line, &reach) + ray->extra;
}

/* ---- instances ---- */

/* Sets inside->off: what `outside` is off by in the part, and what moving the ray adds. */
static void add_rounding(const RtInstance *instance, const RtBox *box, const RtMarginRay *outside,
                         RtMarginRay *inside) {
    const double(*m)[4] = instance->to_world.m, (*inverse)[4] = instance->columns;
    const double part = (double)rt_box_largest_coordinate(instance->geometry->box);
    double cofactors[3][3], from[3], determinant = 0;
    for (int a = 0; a < 3; a++) {
        const int b = (a + 1) % 3, c = (a + 2) % 3;
        for (int k = 0; k < 3; k++) { /* of column a, row k */
            const int u = (k + 1) % 3, v = (k + 2) % 3;
            const double one = m[u][b] * m[v][c], other = m[v][b] * m[u][c];
            cofactors[a][k] = fabs(one) + fabs(other);
            if (a == 0) determinant += m[k][0] * (one - other);
        }
        const double box_most = fmax(fabs((double)box->lo.at[a]), fabs((double)box->hi.at[a]));
        from[a] = fmax(box_most, fabs(outside->wide.org.at[a])) + outside->off.at[a] + fabs(m[a][3]) +
                  part * (fabs(m[a][0]) + fabs(m[a][1]) + fabs(m[a][2]));
    }
    for (int a = 0; a < 3; a++) {
        double off = 0x1p-140;
        for (int k = 0; k < 3; k++)
            off += 2 * RT_MARGIN * cofactors[a][k] / fabs(determinant) * from[k] +
                   fabs(inverse[k][a]) * outside->off.at[k];
        inside->off.at[a] = off;
    }
}

/* Where t may be clamped: from the beginning of the thick box to that of a box that is surely inside it. */
static void add_clamps(const RtBox *box, const RtMarginRay *outside, RtMarginRay *inside) {
    const RtUnitLine *line = &outside->line;
    const double grown = RT_MARGIN * (2 * rt_far_corner(line, box) + rt_lengthd(line->org)) + outside->extra;
    double lo, hi, near, far;
    if (!rt_line_in_box(line, box, grown, &lo, &hi)) return;
    if (!rt_line_in_box(line, box, -grown, &near, &far)) near = hi, far = lo;
    inside->enter = fmax(outside->enter, near / line->length);
    inside->leave = fmin(outside->leave, far / line->length);
}

/* Moves the ray into an instance; the error of double is far below what is added to delta. */
static RtMarginRay enter(const RtMarginRay *outside, const RtGeometry *geometry, uint32_t object) {
    const RtInstance *instance = rt_instance_of(geometry, object);
    const RtBox *box = &geometry->boxes[object];
    const double(*inverse)[4] = instance->columns;
    RtMarginRay inside = *outside;
    double largest = 0;
    for (int a = 0; a < 3; a++) {
        const RtVec3d column = {inverse[0][a], inverse[1][a], inverse[2][a]};
        inside.wide.org.at[a] = rt_dotd(column, outside->wide.org) + inverse[3][a];
        inside.wide.dir.at[a] = rt_dotd(column, outside->wide.dir);
        largest = fmax(largest, fabs(inside.wide.org.at[a]));
    }
    set_line(&inside);
    add_rounding(instance, box, outside, &inside);
    add_clamps(box, outside, &inside);
    const double more = absolute_error(&inside, instance->geometry), far = rt_far_corner(&outside->line, box),
                 length = outside->line.length;
    for (int a = 0; a < 3; a++) inside.off.at[a] += more;
    inside.extra += rt_lengthd(inside.off);
    inside.scale *= length / inside.line.length;
    inside.unclear |=
        !(largest + rt_lengthd(inside.off) <= (double)RT_MAX_COORDINATE / 2) ||
        rt_exceeds_float(inside.line.length, inside.line.length) ||
        rt_exceeds_float(fmin(far, length) * fmin(far, length), fmax(far, length) * fmax(far, length));
    return inside;
}

/* Follows an id into instances: the geometry and object that it names, and the ray there. */
static RtMarginRay follow(const RtMarginRay *ray, const RtGeometry **geometry, uint32_t *id) {
    RtMarginRay here = *ray;
    for (;;) {
        const uint32_t object = rt_geometry_holder(*geometry, *id);
        if (!rt_is_instance(*geometry, object)) return here;
        const RtInstance *instance = rt_instance_of(*geometry, object);
        here = enter(&here, *geometry, object);
        *id -= instance->first;
        *geometry = instance->geometry;
    }
}

double rt_margin_delta(const RtMarginRay *ray, const RtGeometry *geometry, uint32_t id) {
    const RtMarginRay here = follow(ray, &geometry, &id);
    return delta_of(&here, geometry, id) * here.scale;
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
    const bool sure = crossed && lo >= ray->first + delta && hi <= ray->last - delta;
    if (!sure) {
        lo = fmin(lo, ray->leave * ray->line.length);
        hi = fmax(hi, ray->enter * ray->line.length);
    }
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
    m->certain = sure;
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

/* In distances along that ray. */
static RtStatus object_margin(const RtMarginRay *ray, const RtGeometry *geometry, uint32_t id, double asked,
                              RtMargin *m, RtError *error) {
    uint32_t index = rt_ref_index(geometry->objects[id]);
    const RtBox *box = &geometry->boxes[id];
    double delta = delta_of(ray, geometry, id), far = delta / RT_MARGIN, length = ray->line.length;
    const Making making = {m, ray, delta, asked};
    double lo, hi;
    *m = (RtMargin){.earliest = HUGE_VAL};
    if (ray->unclear) {
        add_piece(&making, -HUGE_VAL, HUGE_VAL, false);
        return RT_OK;
    }
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
    case RT_SHAPE_INSTANCE: /* entered before */
    case RT_SHAPE_COUNT: break;
    }
    return RT_OK;
}

/* In distances along the ray outside. */
static RtStatus margin_outside(const RtMarginRay *here, const RtGeometry *geometry, uint32_t object,
                               double asked, RtMargin *m, RtError *error) {
    double *const distances[] = {&m->earliest, &m->latest, &m->lo, &m->hi};
    RT_TRY(object_margin(here, geometry, object, asked / here->scale, m, error));
    for (int i = 0; i < 4; i++) *distances[i] *= here->scale;
    return RT_OK;
}

RtStatus rt_margin_of(const RtMarginRay *ray, const RtGeometry *geometry, uint32_t id, double asked,
                      RtMargin *m, RtError *error) {
    const RtMarginRay here = follow(ray, &geometry, &id);
    return margin_outside(&here, geometry, id, asked, m, error);
}

typedef struct Visit {
    double asked;
    RtMarginVisitor *see;
    void *context;
} Visit;

/* The objects of a geometry, whose ids begin at `first`, and the ray there. */
static RtStatus visit(const Visit *v, const RtMarginRay *ray, const RtGeometry *geometry, uint32_t first,
                      RtError *error) {
    for (uint32_t object = 0; object < geometry->object_count; object++) {
        if (rt_is_instance(geometry, object)) {
            const RtInstance *instance = rt_instance_of(geometry, object);
            const RtMarginRay inside = enter(ray, geometry, object);
            const RtBox *box = &instance->geometry->box;
            double lo, hi, delta = RT_MARGIN * rt_far_corner(&inside.line, box) + inside.extra;
            if (inside.unclear || rt_line_in_box(&inside.line, box, delta, &lo, &hi))
                RT_TRY(visit(v, &inside, instance->geometry, first + instance->first, error));
            continue;
        }
        RtMargin m;
        RT_TRY(margin_outside(ray, geometry, object, v->asked, &m, error));
        if (m.possible) v->see(v->context, first + object, &m);
    }
    return RT_OK;
}

RtStatus rt_margin_of_all(const RtMarginRay *ray, const RtGeometry *geometry, double asked,
                          RtMarginVisitor *see, void *context, RtError *error) {
    const Visit v = {asked, see, context};
    return visit(&v, ray, geometry, 0, error);
}
