/* SPDX-License-Identifier: Apache-2.0 */
/* The torus around the unit circle of the xy plane, with a tube of radius `ratio` < 1.
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
#include "core/shape/solid_parts.h"

/* ---- changes of sign along a line ---- */

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
    for (int i = 0; i < 3; i++) along.at[i] = rt_dotd(direction, rt_transform_column(&solid->to_world, i));
    return rt_dotd(direction, rt_transform_column(&solid->to_world, 3)) +
           sqrt(along.x * along.x + along.y * along.y) + solid->ratio * rt_lengthd(along);
}

RtBall rt_solid_torus_ball(const RtSolidSet *set, const RtSolid *solid) {
    (void)set;
    RtVec3d x = rt_transform_column(&solid->to_world, 0), y = rt_transform_column(&solid->to_world, 1),
            z = rt_transform_column(&solid->to_world, 2);
    double circle = rt_largest_stretch(x, y, rt_vec3d(0, 0, 0)), tube = rt_largest_stretch(x, y, z);
    return (RtBall){rt_transform_column(&solid->to_world, 3), circle + solid->ratio * tube};
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

RtStatus rt_solid_add_ring(RtSolidSet *set, RtVec3 center, RtVec3 axis, float major, float minor,
                           uint32_t *index, RtError *error) {
    if (!(minor > 0 && minor < major))
        return rt_fail(
            error, RT_BAD_INPUT,
            "a torus needs 0 < minor < major, the radii of its tube and of the circle in it; these "
            "are %g and %g",
            (double)minor, (double)major);
    if (rt_lengthd(rt_widen(axis)) == 0)
        return rt_fail(error, RT_BAD_INPUT,
                       "the axis of the torus has length 0: give a direction, as in [0, 0, 1]");
    RtTransform to_world =
        rt_solid_transform_about(rt_widen(center), rt_widen(axis), (double)major, (double)major);
    return rt_solid_add_torus(set, (double)minor / (double)major, &to_world, index, error);
}
