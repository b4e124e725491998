/* SPDX-License-Identifier: Apache-2.0 */
#include "core/base/transform.h"

#include "core/base/elementary.h"

RtTransform rt_transform_identity(void) {
    return (RtTransform){{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
}

RtTransform rt_transform_compose(const RtTransform *first, const RtTransform *second) {
    RtTransform both;
    for (int row = 0; row < 3; row++) {
        const double *s = second->m[row];
        for (int column = 0; column < 4; column++)
            both.m[row][column] = s[0] * first->m[0][column] + s[1] * first->m[1][column] +
                                  s[2] * first->m[2][column] + (column == 3 ? s[3] : 0);
    }
    return both;
}

static RtStatus check_finite(RtVec3 v, const char *what, RtError *error) {
    if (rt_finite(v)) return RT_OK;
    return rt_fail(error, RT_BAD_INPUT, "%s is not finite: (%g, %g, %g)", what, (double)v.x, (double)v.y,
                   (double)v.z);
}

RtStatus rt_transform_scale(RtTransform *transform, RtVec3 factors, RtError *error) {
    RT_TRY(check_finite(factors, "the scale", error));
    if (!(factors.x > 0 && factors.y > 0 && factors.z > 0))
        return rt_fail(error, RT_BAD_INPUT,
                       "the scale is (%g, %g, %g): every factor must be above 0 (only the `place` of an "
                       "instance may mirror)",
                       (double)factors.x, (double)factors.y, (double)factors.z);
    RtTransform step = rt_transform_identity();
    for (int a = 0; a < 3; a++) step.m[a][a] = (double)factors.at[a];
    *transform = rt_transform_compose(transform, &step);
    return RT_OK;
}

/* Rodrigues' formula. */
RtStatus rt_transform_rotate(RtTransform *transform, RtVec3 axis, double degrees, RtError *error) {
    RT_TRY(check_finite(axis, "the axis of the rotation", error));
    if (!isfinite(degrees))
        return rt_fail(error, RT_BAD_INPUT, "the angle of the rotation is not finite: %g degrees", degrees);
    RtVec3d u = rt_normalized(rt_widen(axis));
    if (rt_lengthd(u) == 0)
        return rt_fail(error, RT_BAD_INPUT,
                       "the axis of the rotation has length 0: give a direction, as in [0, 0, 1]");
    RtTurn turn = rt_turn(fmod(degrees, 360));
    double c = turn.cosine, s = turn.sine;
    RtTransform step = rt_transform_identity();
    for (int row = 0; row < 3; row++) {
        for (int column = 0; column < 3; column++)
            step.m[row][column] = (1 - c) * u.at[row] * u.at[column] + (row == column ? c : 0);
    }
    for (int a = 0; a < 3; a++) {
        int b = (a + 1) % 3, next = (a + 2) % 3;
        step.m[b][a] += s * u.at[next];
        step.m[a][b] -= s * u.at[next];
    }
    *transform = rt_transform_compose(transform, &step);
    return RT_OK;
}

RtStatus rt_transform_translate(RtTransform *transform, RtVec3 by, RtError *error) {
    RT_TRY(check_finite(by, "the translation", error));
    for (int a = 0; a < 3; a++) transform->m[a][3] += (double)by.at[a];
    return RT_OK;
}

RtVec3d rt_transform_pointd(const RtTransform *transform, RtVec3d point) {
    RtVec3d moved;
    for (int row = 0; row < 3; row++) {
        const double *m = transform->m[row];
        moved.at[row] = m[0] * point.x + m[1] * point.y + m[2] * point.z + m[3];
    }
    return moved;
}

RtVec3 rt_transform_point(const RtTransform *transform, RtVec3 point) {
    return rt_narrow(rt_transform_pointd(transform, rt_widen(point)));
}

/* The largest column sum of a matrix: at most sqrt(3) times, and at least 1 / sqrt(3) of, the factor by which
 * it stretches vectors at most. */
static double stretch(const RtTransform *t) {
    double most = 0;
    for (int column = 0; column < 3; column++)
        most = fmax(most, fabs(t->m[0][column]) + fabs(t->m[1][column]) + fabs(t->m[2][column]));
    return most;
}

RtStatus rt_transform_invert(const RtTransform *transform, RtTransform *inverse, RtError *error) {
    const RtVec3d x = rt_transform_column(transform, 0), y = rt_transform_column(transform, 1),
                  z = rt_transform_column(transform, 2), at = rt_transform_column(transform, 3);
    const RtVec3d rows[3] = {rt_crossd(y, z), rt_crossd(z, x), rt_crossd(x, y)};
    const double determinant = rt_dotd(x, rows[0]);
    for (int row = 0; row < 3; row++) {
        for (int column = 0; column < 3; column++)
            inverse->m[row][column] = rows[row].at[column] / determinant;
        inverse->m[row][3] = -rt_dotd(rows[row], at) / determinant;
    }
    const double most = stretch(transform), least = 1 / stretch(inverse),
                 limit = RT_MAX_STRETCH * (1 + 0x1p-22);
    if (most <= limit && least >= 1 / limit && most <= least * limit &&
        isfinite(inverse->m[0][3] + inverse->m[1][3] + inverse->m[2][3]))
        return RT_OK;
    return rt_fail(error, RT_BAD_INPUT,
                   "the matrix of an instance scales by factors from %.3g to %.3g: between 1e-6 and 1e6, at "
                   "most a factor of 1e6 apart, can be undone",
                   least, most);
}

bool rt_transform_mirrors(const RtTransform *transform) {
    RtVec3d x = rt_transform_column(transform, 0), y = rt_transform_column(transform, 1),
            z = rt_transform_column(transform, 2);
    return rt_dotd(rt_crossd(x, y), z) < 0;
}

RtVec3d rt_transform_normald(const RtTransform *transform, RtVec3d normal) {
    RtVec3d x = rt_transform_column(transform, 0), y = rt_transform_column(transform, 1),
            z = rt_transform_column(transform, 2);
    RtVec3d sum = rt_scaled(rt_crossd(y, z), normal.x);
    sum = rt_add_scaledd(sum, rt_crossd(z, x), normal.y);
    const RtVec3d xy = rt_crossd(x, y);
    sum = rt_add_scaledd(sum, xy, normal.z);
    return rt_dotd(xy, z) < 0 ? rt_scaled(sum, -1) : sum; /* rt_transform_mirrors */
}

RtVec3 rt_transform_normal(const RtTransform *transform, RtVec3 normal) {
    return rt_narrow(rt_normalized(rt_transform_normald(transform, rt_widen(normal))));
}

double rt_transform_uniform_scale(const RtTransform *transform) {
    RtVec3d x = rt_transform_column(transform, 0), y = rt_transform_column(transform, 1),
            z = rt_transform_column(transform, 2);
    double scale = rt_lengthd(x);
    double slack = 1e-6 * scale;
    bool same = fabs(rt_lengthd(y) - scale) <= slack && fabs(rt_lengthd(z) - scale) <= slack;
    bool square = fabs(rt_dotd(x, y)) <= slack * scale && fabs(rt_dotd(y, z)) <= slack * scale &&
                  fabs(rt_dotd(z, x)) <= slack * scale;
    return same && square ? scale : 0;
}
