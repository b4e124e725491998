/* SPDX-License-Identifier: Apache-2.0 */
/* The cone of object space, |(x, y)| <= r(z) = 1 + (ratio - 1) z, cut by two cap planes in world space.
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
#include "core/base/memory.h"
#include "core/shape/cone.h"
#include "core/shape/solid_parts.h"

#include <string.h>

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

static RtVec3d column(const RtSolid *solid, int i) {
    return rt_transform_column(&solid->to_world, i);
}

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

RtStatus rt_solid_add_frustum(RtSolidSet *set, RtVec3 base, float base_radius, RtVec3 apex, float apex_radius,
                              uint32_t *index, RtError *error) {
    RtCone checked;
    RT_TRY(rt_cone_init(&checked, base, base_radius, apex, apex_radius, error));
    if (apex_radius > base_radius)
        return rt_solid_add_frustum(set, apex, apex_radius, base, base_radius, index, error);
    RtVec3d axis = rt_subd(rt_widen(apex), rt_widen(base));
    RtTransform to_world =
        rt_solid_transform_about(rt_widen(base), axis, (double)base_radius, checked.height);
    return rt_solid_add_cone(set, (double)apex_radius / (double)base_radius, &to_world, index, error);
}
