/* SPDX-License-Identifier: Apache-2.0 */
/* Common to solids of all kinds: planes, transforms, and adding a solid to its set.
 *
 * Every rt_solid_add_... ends in rt_solid_finish: planes and triangles are put behind those of the set,
 * the box is computed from them, and the set counts them only when nothing can fail any more. */
#include "core/shape/solid_parts.h"

#include "core/base/memory.h"

/* ---- planes ---- */

RtPlane rt_plane_through(RtVec3d point, RtVec3d normal) {
    int axis = rt_axis_of(normal);
    if (axis >= 0) {
        double sign = normal.at[axis] < 0 ? -1 : 1;
        RtPlane plane = {.offset = sign * (double)(float)point.at[axis]};
        plane.normal.at[axis] = sign;
        return plane;
    }
    double most = fmax(fabs(normal.x), fmax(fabs(normal.y), fabs(normal.z)));
    RtVec3d unit = rt_normalized(rt_scaled(normal, 1 / most));
    return (RtPlane){unit, rt_dotd(unit, point)};
}

RtPlane rt_plane_moved(const RtPlane *plane, const RtTransform *move) {
    RtVec3d foot = rt_scaled(plane->normal, plane->offset);
    return rt_plane_through(rt_transform_pointd(move, foot), rt_transform_normald(move, plane->normal));
}

/* ---- transforms ---- */

RtStatus rt_solid_check_transform(const RtTransform *to_world, RtError *error) {
    RtVec3d x = rt_transform_column(to_world, 0), y = rt_transform_column(to_world, 1),
            z = rt_transform_column(to_world, 2), by = rt_transform_column(to_world, 3);
    double volume = rt_dotd(x, rt_crossd(y, z)), most = rt_lengthd(x) * rt_lengthd(y) * rt_lengthd(z);
    if (!isfinite(most) || !isfinite(rt_lengthd(by)))
        return rt_fail(error, RT_BAD_INPUT, "the transform of a solid is not finite");
    if (!(volume > 0x1p-40 * most))
        return rt_fail(error, RT_BAD_INPUT,
                       "a solid would be flat or turned inside out: its axes must have a length and not lie "
                       "in one plane");
    return RT_OK;
}

/* The largest eigenvalue of the matrix G of dot products is at most its trace, and that of G^2 is its
 * square: repeated squaring tightens the bound. */
double rt_largest_stretch(RtVec3d x, RtVec3d y, RtVec3d z) {
    enum { SQUARINGS = 30 };
    const RtVec3d columns[3] = {x, y, z};
    double g[3][3], traces[SQUARINGS];
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) g[i][j] = rt_dotd(columns[i], columns[j]);
    }
    for (int k = 0; k < SQUARINGS; k++) {
        double trace = g[0][0] + g[1][1] + g[2][2], squared[3][3];
        traces[k] = trace;
        for (int i = 0; i < 3; i++) {
            for (int j = 0; j < 3; j++) {
                squared[i][j] = 0;
                for (int m = 0; m < 3; m++) squared[i][j] += g[i][m] / trace * (g[m][j] / trace);
            }
        }
        for (int i = 0; i < 3; i++) {
            for (int j = 0; j < 3; j++) g[i][j] = squared[i][j];
        }
    }
    double bound = 1;
    for (int k = SQUARINGS; k-- > 0;) bound = traces[k] * sqrt(bound);
    return sqrt(bound) * (1 + 0x1p-40);
}

/* ---- finishing ---- */

static void invert(RtSolid *solid) {
    RtVec3d x = rt_transform_column(&solid->to_world, 0), y = rt_transform_column(&solid->to_world, 1),
            z = rt_transform_column(&solid->to_world, 2);
    RtVec3d yz = rt_crossd(y, z);
    double volume = rt_dotd(x, yz);
    solid->inverse[0] = rt_scaled(yz, 1 / volume);
    solid->inverse[1] = rt_scaled(rt_crossd(z, x), 1 / volume);
    solid->inverse[2] = rt_scaled(rt_crossd(x, y), 1 / volume);
}

/* From the support function, rounded outward; faces across an axis bound it exactly. */
static RtBox box_of(const RtSolidSet *set, const RtSolid *solid, RtSolidSupport *support) {
    if (solid->kind == RT_SOLID_MESH) return set->boxes[solid->first_box];
    RtBox box = RT_EMPTY_BOX;
    for (int a = 0; a < 3; a++) {
        RtVec3d up = {{a == 0, a == 1, a == 2}};
        double hi = support(set, solid, up), lo = -support(set, solid, rt_scaled(up, -1));
        double slack = 0x1p-50 * fabs(solid->to_world.m[a][3]);
        box.lo.at[a] = rt_float_below(lo - slack - 0x1p-50 * fabs(lo));
        box.hi.at[a] = rt_float_above(hi + slack + 0x1p-50 * fabs(hi));
    }
    for (uint32_t i = 0; i < solid->count; i++) {
        const RtPlane *plane = &set->planes[solid->first + i];
        int a = rt_axis_of(plane->normal);
        if (a < 0) continue;
        if (plane->normal.at[a] > 0) box.hi.at[a] = rt_minf((float)plane->offset, box.hi.at[a]);
        if (plane->normal.at[a] < 0) box.lo.at[a] = rt_maxf((float)-plane->offset, box.lo.at[a]);
    }
    return box;
}

static RtStatus check_box(const RtBox *box, RtError *error) {
    for (int a = 0; a < 3; a++) {
        const float sides[2] = {box->lo.at[a], box->hi.at[a]};
        for (int i = 0; i < 2; i++) {
            if (fabsf(sides[i]) <= RT_MAX_COORDINATE || sides[i] == (i ? INFINITY : -INFINITY)) continue;
            return rt_fail(error, RT_BAD_INPUT,
                           "a solid would extend to %g: coordinates are limited to %g; scale it down",
                           (double)sides[i], (double)RT_MAX_COORDINATE);
        }
    }
    return RT_OK;
}

RtStatus rt_solid_finish(RtSolidSet *set, RtSolid *solid, RtSolidSupport *support, uint32_t *index,
                         RtError *error) {
    bool is_mesh = solid->kind == RT_SOLID_MESH;
    RT_TRY(rt_solid_check_transform(&solid->to_world, error));
    invert(solid);
    solid->box = box_of(set, solid, support);
    RT_TRY(check_box(&solid->box, error));
    RT_TRY(rt_append(&set->solids, &set->solid_count, &set->solid_capacity, solid, sizeof *solid, error));
    *index = set->solid_count - 1;
    *(is_mesh ? &set->triangle_count : &set->plane_count) += solid->count;
    if (is_mesh) set->box_count += 2 * solid->leaves - 1;
    return RT_OK;
}
