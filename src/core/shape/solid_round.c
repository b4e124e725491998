/* SPDX-License-Identifier: Apache-2.0 */
/* Round solids: spheres, cones and tori, each of one shape in object space, under a transform. */
#include "core/base/memory.h"
#include "core/shape/solid_parts.h"

#include <string.h>

static RtVec3d column(const RtSolid *solid, int i) {
    return rt_transform_column(&solid->to_world, i);
}

/* ---- spheres ----
 *
 * The unit ball under its transform: p = to_world(q), |q| <= 1. The hit is computed about the point of the
 * line nearest to the centre (raytally/hit.h): the half chord is sqrt(1 - |l|^2), with l the vector
 * to that point. */
uint32_t rt_solid_sphere_crossings(const RtSolidSet *set, uint32_t index, const RtSolidRay *ray, float near,
                                   float far, RtCrossing *out) {
    RtSolidLine line = rt_solid_line(&set->solids[index], ray, rt_vec3d(0, 0, 0));
    double half_chord_squared = 1 - rt_dotd(line.near, line.near);
    if (!(half_chord_squared > 0)) return 0;
    double half = sqrt(half_chord_squared / rt_dotd(line.dir, line.dir));
    RtSpan span = {line.closest - half, line.closest + half, 0, 0};
    return rt_span_put(&span, index, near, far, out, 0);
}

RtVec3d rt_solid_sphere_normal(const RtSolidSet *set, const RtSolid *solid, uint32_t face, RtVec3d point) {
    (void)set, (void)face;
    return rt_solid_normal_to_world(solid, rt_solid_point_to_object(solid, point));
}

double rt_solid_sphere_support(const RtSolidSet *set, const RtSolid *solid, RtVec3d direction) {
    (void)set;
    RtVec3d along;
    for (int i = 0; i < 3; i++) along.at[i] = rt_dotd(direction, column(solid, i));
    return rt_dotd(direction, column(solid, 3)) + rt_lengthd(along);
}

RtBall rt_solid_sphere_ball(const RtSolidSet *set, const RtSolid *solid) {
    (void)set;
    return (RtBall){column(solid, 3),
                    rt_largest_stretch(column(solid, 0), column(solid, 1), column(solid, 2))};
}

RtStatus rt_solid_add_sphere(RtSolidSet *set, const RtTransform *to_world, uint32_t *index, RtError *error) {
    RtSolid solid = {.kind = RT_SOLID_SPHERE, .to_world = *to_world};
    return rt_solid_finish(set, &solid, rt_solid_sphere_support, index, error);
}

/* ---- cones ----
 *
 * The cone of object space, |(x, y)| <= r(z) = 1 + (ratio - 1) z, cut by two cap planes in world space.
 *
 * With p(s) = near + s dir, x^2 + y^2 - r^2 is the quadratic a s^2 + 2 b s + c, which is negative inside
 * either nappe of the double cone. A line that is steeper than the side (a < 0) enters one nappe and leaves
 * the other; of its two half-lines the one with r above 0 is inside. A less steep line (a > 0) is inside
 * between the roots, which lie on the same nappe, if r > 0 there. A line as steep as the side (a = 0) has one
 * root and enters one nappe for good. So the apex needs no special case, and the second nappe is never hit.
 *
 * Caps across a world axis lie at a float32, like all such faces, and the transform is fitted to them as
 * closely as double allows. So the transform describes what is between the caps, for extents and for the
 * referee, too. */
enum { SIDE, BASE, APEX };

/* Sets span->open and close to where near + s dir, relative to the middle of the axis, is within the side. */
static bool within_side(double ratio, const RtSolidLine *line, RtSpan *span) {
    RtVec3d p = line->near, d = line->dir;
    double r = 1 + (ratio - 1) * (p.z + 0.5), dr = (ratio - 1) * d.z;
    double a = d.x * d.x + d.y * d.y - dr * dr;
    double half_b = p.x * d.x + p.y * d.y - r * dr;
    double c = p.x * p.x + p.y * p.y - r * r;
    *span = (RtSpan){-INFINITY, INFINITY, SIDE, SIDE};
    if (a == 0 && half_b == 0) return c < 0 && r > 0;
    if (a == 0 && (half_b < 0) != (dr > 0)) return false;

    double roots[2], discriminant = half_b * half_b - a * c;
    if (a > 0) {
        if (!(discriminant > 0) || raytally_quadratic_roots(a, half_b, c, discriminant, roots) < 2)
            return false;
        span->open = roots[0], span->close = roots[1];
        return r + dr * (roots[0] / 2 + roots[1] / 2) > 0;
    }
    int count = raytally_quadratic_roots(a, half_b, c, fmax(discriminant, 0), roots);
    if (dr > 0)
        span->open = roots[count - 1];
    else
        span->close = roots[0];
    return true;
}

uint32_t rt_solid_cone_crossings(const RtSolidSet *set, uint32_t index, const RtSolidRay *ray, float near,
                                 float far, RtCrossing *out) {
    const RtSolid *solid = &set->solids[index];
    RtSolidLine line = rt_solid_line(solid, ray, rt_vec3d(0, 0, 0.5));
    RtSpan span;
    if (!within_side(solid->ratio, &line, &span)) return 0;
    span.open += line.closest, span.close += line.closest;
    for (uint32_t i = 0; i < solid->count; i++)
        rt_span_cut(&span, &set->planes[solid->first + i], BASE + i, ray);
    return rt_span_put(&span, index, near, far, out, 0);
}

/* On the side, the gradient, with the distance from the axis in place of r: at the apex it is along the
 * axis. */
RtVec3d rt_solid_cone_normal(const RtSolidSet *set, const RtSolid *solid, uint32_t face, RtVec3d point) {
    if (face != SIDE) return set->planes[solid->first + face - BASE].normal;
    RtVec3d p = rt_solid_point_to_object(solid, point);
    double across = sqrt(p.x * p.x + p.y * p.y);
    if (across == 0) return rt_solid_normal_to_world(solid, rt_vec3d(0, 0, 1));
    return rt_solid_normal_to_world(solid, rt_vec3d(p.x, p.y, (1 - solid->ratio) * across));
}

/* ---- extents: those of the two discs ---- */

static RtVec3d apex_of(const RtSolid *solid) {
    return rt_addd(column(solid, 3), column(solid, 2));
}

/* Half the width of the unit disc along `direction`. */
static double disc_reach(const RtSolid *solid, RtVec3d direction) {
    double x = rt_dotd(direction, column(solid, 0)), y = rt_dotd(direction, column(solid, 1));
    return sqrt(x * x + y * y);
}

double rt_solid_cone_support(const RtSolidSet *set, const RtSolid *solid, RtVec3d direction) {
    (void)set;
    double reach = disc_reach(solid, direction);
    return fmax(rt_dotd(direction, column(solid, 3)) + reach,
                rt_dotd(direction, apex_of(solid)) + solid->ratio * reach);
}

/* An upper bound of the squared distance from the origin of a point of the disc around v, with `radius`
 * times the unit disc: |v + w|^2 = v^2 + 2 v.w + w^2. Exact if v is perpendicular to the disc. */
static double farthest_squared(const RtSolid *solid, RtVec3d v, double radius, double stretch) {
    return rt_dotd(v, v) + 2 * radius * disc_reach(solid, v) + radius * radius * stretch * stretch;
}

/* Around the point of the axis with equal distance to both circles of an upright cone; if that is beyond
 * an end, the larger circle alone decides. */
RtBall rt_solid_cone_ball(const RtSolidSet *set, const RtSolid *solid) {
    (void)set;
    RtVec3d axis = column(solid, 2);
    double stretch = rt_largest_stretch(column(solid, 0), column(solid, 1), rt_vec3d(0, 0, 0));
    double smaller = (1 - solid->ratio * solid->ratio) * stretch * stretch;
    double s = fmax((1 - smaller / rt_dotd(axis, axis)) / 2, 0);
    double squared = fmax(farthest_squared(solid, rt_scaled(axis, -s), 1, stretch),
                          farthest_squared(solid, rt_scaled(axis, 1 - s), solid->ratio, stretch));
    return (RtBall){rt_add_scaledd(column(solid, 3), axis, s), sqrt(squared) * (1 + 0x1p-40)};
}

/* ---- making ---- */

void rt_solid_cone_to_caps(const RtSolidSet *set, RtSolid *solid) {
    const RtPlane *caps = set->planes + solid->first;
    int a = rt_axis_of(caps[0].normal);
    if (a < 0) return;
    double apex = solid->to_world.m[a][3] + solid->to_world.m[a][2];
    if (solid->count > 1) apex = caps[1].normal.at[a] * caps[1].offset;
    solid->to_world.m[a][3] = caps[0].normal.at[a] * caps[0].offset;
    solid->to_world.m[a][2] = apex - solid->to_world.m[a][3];
}

RtStatus rt_solid_add_cone(RtSolidSet *set, double ratio, const RtTransform *to_world, uint32_t *index,
                           RtError *error) {
    if (!(ratio >= 0 && ratio <= 1))
        return rt_fail(error, RT_BAD_INPUT, "the ratio of a cone's radii is %g: expected 0..1; swap its ends",
                       ratio);
    RT_TRY(rt_solid_check_transform(to_world, error));
    RtSolid solid = {.kind = RT_SOLID_CONE,
                     .first = set->plane_count,
                     .count = ratio > 0 ? 2 : 1,
                     .ratio = ratio,
                     .to_world = *to_world};
    RT_TRY(rt_reserve(&set->planes, &set->plane_capacity, (uint64_t)set->plane_count + 2, sizeof(RtPlane),
                      error));
    RtVec3d up = rt_crossd(column(&solid, 0), column(&solid, 1));
    RtPlane *caps = set->planes + set->plane_count;
    caps[0] = rt_plane_through(column(&solid, 3), rt_scaled(up, -1));
    caps[1] = rt_plane_through(apex_of(&solid), up);
    rt_solid_cone_to_caps(set, &solid);
    return rt_solid_finish(set, &solid, rt_solid_cone_support, index, error);
}

/* Equal except for rounding of a point at the plane's distance from the origin, or of one as far as the
 * solid. */
static bool is_nearly(const RtPlane *a, const RtPlane *b, double size) {
    bool near = fabs(a->offset - b->offset) <= 0x1p-40 * (fabs(b->offset) + size);
    for (int i = 0; i < 3; i++) near &= fabs(a->normal.at[i] - b->normal.at[i]) <= 0x1p-40;
    return near;
}

RtStatus rt_solid_set_caps(RtSolidSet *set, uint32_t index, const RtPlane *caps, uint32_t count,
                           RtError *error) {
    const RtSolid *solid = &set->solids[index];
    RtPlane *own = set->planes + solid->first;
    const double size = rt_lengthd(column(solid, 3)) + rt_lengthd(column(solid, 2));
    bool near = solid->kind == RT_SOLID_CONE && count == solid->count;
    for (uint32_t i = 0; i < count && near; i++) near = is_nearly(&caps[i], &own[i], size);
    if (!near) return rt_fail(error, RT_BAD_INPUT, "the caps are not those of the cone: leave them out");
    memcpy(own, caps, count * sizeof *caps);
    return RT_OK;
}

/* ---- tori ----
 *
 * The torus around the unit circle of the xy plane, with a tube of radius `ratio` < 1.
 *
 * A point is inside where g = (w - 1)^2 + z^2 - ratio^2 < 0, w = sqrt(x^2 + y^2). Multiplied by (w + 1)^2 +
 * z^2 - ratio^2, which is above 0, g becomes a polynomial of degree 4 in s along a line p + s e. With p the
 * point nearest to the centre and e of length 1 it has no cubic term:
 *
 *     f(s) = (s^2 + k)^2 - 4 ((p.x + s e.x)^2 + (p.y + s e.y)^2),    k = p^2 + 1 - ratio^2,
 *
 * and all roots are within 1 + ratio of the centre. f' / 4 is s^3 + a s + b, which is monotone between the
 * roots -h and h of its derivative: it has at most one root between each two of these and the ends. Its roots
 * cut the line into pieces on which f is monotone. A piece whose ends differ in sign holds one crossing,
 * which a bracketing iteration finds.
 *
 * The sign is taken from g, because rounding in f loses a thin tube; f only says where to look. A line
 * that touches from outside has no point inside; where rounding decides, a short span appears with both
 * its ends or not at all. */
typedef struct Value {
    double y, slope;
} Value;

/* A function of s along the line. */
typedef struct Curve {
    Value (*at)(const struct Curve *curve, double s);
    RtVec3d p, e;
    double ratio;
    double a, b;
} Curve;

static Value torus_at(const Curve *c, double s) {
    RtVec3d q = rt_add_scaledd(c->p, c->e, s);
    double w = sqrt(q.x * q.x + q.y * q.y);
    double dw = w > 0 ? (q.x * c->e.x + q.y * c->e.y) / w : 0;
    return (Value){(w - 1) * (w - 1) + q.z * q.z - c->ratio * c->ratio, 2 * ((w - 1) * dw + q.z * c->e.z)};
}

static Value cubic_at(const Curve *c, double s) {
    return (Value){(s * s + c->a) * s + c->b, 3 * s * s + c->a};
}

/* The point between lo and hi where y changes from below 0 (or to below 0): by Newton steps while they
 * stay within the bracket and shrink, otherwise by bisection. */
static double change_between(const Curve *curve, double lo, double hi, bool from_below) {
    double s = lo / 2 + hi / 2, step = hi - lo;
    while (lo < s && s < hi) {
        Value v = curve->at(curve, s);
        if ((v.y < 0) == from_below)
            lo = s;
        else
            hi = s;
        double next = s - v.y / v.slope;
        if (next == s) break;
        if (!(lo < next && next < hi && fabs(next - s) < step / 2)) next = lo / 2 + hi / 2;
        step = fabs(next - s);
        s = next;
    }
    return s;
}

/* The points at which y changes between below 0 and not, at most one between each two of the ascending
 * `cuts`; returns their number, below `count`. */
static int changes(const Curve *curve, const double *cuts, int count, double *places) {
    int found = 0;
    bool below = curve->at(curve, cuts[0]).y < 0;
    for (int i = 1; i < count; i++) {
        bool next_below = curve->at(curve, cuts[i]).y < 0;
        if (next_below != below) places[found++] = change_between(curve, cuts[i - 1], cuts[i], below);
        below = next_below;
    }
    return found;
}

/* ---- crossings ---- */

uint32_t rt_solid_torus_crossings(const RtSolidSet *set, uint32_t index, const RtSolidRay *ray, float near,
                                  float far, RtCrossing *out) {
    const RtSolid *solid = &set->solids[index];
    RtSolidLine line = rt_solid_line(solid, ray, rt_vec3d(0, 0, 0));
    double length = rt_lengthd(line.dir), p_squared = rt_dotd(line.near, line.near);
    double reach = 1 + solid->ratio + 0x1p-20; /* slightly more, so that the ends of the line are outside */
    if (!(p_squared < reach * reach)) return 0;
    RtVec3d p = line.near, e = rt_scaled(line.dir, 1 / length);
    double k = p_squared + 1 - solid->ratio * solid->ratio;
    Curve curve = {.at = cubic_at,
                   .p = p,
                   .e = e,
                   .ratio = solid->ratio,
                   .a = k - 2 * (e.x * e.x + e.y * e.y),
                   .b = -2 * (p.x * e.x + p.y * e.y)};

    double end = sqrt(reach * reach - p_squared);
    double h = fmin(sqrt(fmax(-curve.a / 3, 0)), end);
    double pieces[5] = {-end}, places[4];
    int turns = changes(&curve, (double[]){-end, -h, h, end}, 4, pieces + 1);
    pieces[turns + 1] = end;
    curve.at = torus_at;
    int count = changes(&curve, pieces, turns + 2, places);

    uint32_t crossings = 0;
    for (int i = 0; i + 1 < count; i += 2) {
        RtSpan span = {line.closest + places[i] / length, line.closest + places[i + 1] / length, 0, 0};
        crossings = rt_span_put(&span, index, near, far, out, crossings);
    }
    return crossings;
}

/* From the nearest point of the circle. */
RtVec3d rt_solid_torus_normal(const RtSolidSet *set, const RtSolid *solid, uint32_t face, RtVec3d point) {
    (void)set, (void)face;
    RtVec3d q = rt_solid_point_to_object(solid, point);
    double w = sqrt(q.x * q.x + q.y * q.y);
    RtVec3d circle = w > 0 ? rt_vec3d(q.x / w, q.y / w, 0) : rt_vec3d(1, 0, 0);
    return rt_solid_normal_to_world(solid, rt_subd(q, circle));
}

/* ---- extents: those of the circle, and of the ball that goes round it ---- */

double rt_solid_torus_support(const RtSolidSet *set, const RtSolid *solid, RtVec3d direction) {
    (void)set;
    RtVec3d along;
    for (int i = 0; i < 3; i++) along.at[i] = rt_dotd(direction, column(solid, i));
    return rt_dotd(direction, column(solid, 3)) + sqrt(along.x * along.x + along.y * along.y) +
           solid->ratio * rt_lengthd(along);
}

RtBall rt_solid_torus_ball(const RtSolidSet *set, const RtSolid *solid) {
    (void)set;
    RtVec3d x = column(solid, 0), y = column(solid, 1), z = column(solid, 2);
    double circle = rt_largest_stretch(x, y, rt_vec3d(0, 0, 0)), tube = rt_largest_stretch(x, y, z);
    return (RtBall){column(solid, 3), circle + solid->ratio * tube};
}

/* ---- making ---- */

RtStatus rt_solid_add_torus(RtSolidSet *set, double ratio, const RtTransform *to_world, uint32_t *index,
                            RtError *error) {
    if (!(ratio > 0 && ratio < 1))
        return rt_fail(
            error, RT_BAD_INPUT,
            "the tube of a torus is %g times as wide as its circle: expected a value above 0 and below 1",
            ratio);
    RtSolid solid = {.kind = RT_SOLID_TORUS, .ratio = ratio, .to_world = *to_world};
    return rt_solid_finish(set, &solid, rt_solid_torus_support, index, error);
}
