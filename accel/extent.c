/* SPDX-License-Identifier: Apache-2.0 */
/* Fitting extents, and validating them. Both use shapes only through a ball, a frame, and the support
 * function, the farthest reach of an object in a direction. All in double, then inflated by more than the
 * rounding errors. */
#include "accel/extent.h"

#define THIRD 0.57735026918962576451
#define HALF  0.70710678118654752440
const RtVec3d rt_slab_normals[RT_MAX_SLABS] = {
    {1, 0, 0},
    {0, 1, 0},
    {0, 0, 1},
    {THIRD, THIRD, THIRD},
    {-THIRD, THIRD, THIRD},
    {THIRD, -THIRD, THIRD},
    {THIRD, THIRD, -THIRD},
    {HALF, HALF, 0},
    {HALF, -HALF, 0},
    {HALF, 0, HALF},
    {HALF, 0, -HALF},
    {0, HALF, HALF},
    {0, HALF, -HALF},
};

static const char *const kind_names[RT_EXTENT_KIND_COUNT] = {"box", "sphere", "oriented box", "set of slabs"};

/* ---- sets ---- */

size_t rt_extent_set_bytes(const RtExtentSet *set) {
    const size_t each[RT_EXTENT_KIND_COUNT] = {[RT_EXTENT_SPHERE] = sizeof(RtBall),
                                               [RT_EXTENT_OBB] = sizeof(RtOrientedBox),
                                               [RT_EXTENT_SLABS] = set->slabs_each * sizeof(RtSlab)};
    return set->count * each[set->kind];
}

RtStatus rt_extent_set_init(RtExtentSet *set, RtArena *memory, RtExtentKind kind, uint32_t slabs_each,
                            uint32_t count, RtError *error) {
    *set = (RtExtentSet){.kind = kind, .slabs_each = slabs_each, .count = count};
    if (kind == RT_EXTENT_BOX) return RT_OK;
    void *block = rt_arena_alloc(memory, 1, rt_extent_set_bytes(set));
    if (kind == RT_EXTENT_SPHERE) set->balls = block;
    if (kind == RT_EXTENT_OBB) set->oriented = block;
    if (kind == RT_EXTENT_SLABS) set->slabs = block;
    return rt_arena_check(memory, "extents", error);
}

/* ---- making ---- */

/* The support function of a group. */
static double support(const RtGroup *group, RtVec3d direction) {
    double most = -INFINITY;
    for (uint32_t i = 0; i < group->count; i++) {
        double reach = rt_object_support(group->geometry, group->ids[i], direction);
        most = reach > most ? reach : most;
    }
    return most;
}

/* The rounding error of an extent of an object in `box`, computed in double: 2^-46 of its largest
 * coordinate. */
static double inflation(const RtBox *box) {
    return 0x1p-46 * rt_box_largest_coordinate(*box);
}

static RtVec3d opposite(RtVec3d a) {
    return rt_subd(rt_vec3d(0, 0, 0), a);
}

/* The ball with this centre that contains the group; *far is the point farthest from the centre. */
static RtBall ball_about(const RtGroup *group, RtVec3d center, RtVec3d *far) {
    RtBall ball = {center, -1};
    for (uint32_t i = 0; i < group->count; i++) {
        RtBall own = rt_object_ball(group->geometry, group->ids[i]);
        RtVec3d out = rt_subd(own.center, center);
        double away = rt_lengthd(out), reach = away + own.radius;
        if (reach <= ball.radius) continue;
        ball.radius = reach;
        *far = rt_add_scaledd(own.center, away > 0 ? out : rt_vec3d(1, 0, 0),
                              own.radius / (away > 0 ? away : 1));
    }
    return ball;
}

/* The centre moves in decreasing steps towards the farthest point; the smallest ball is kept. */
static RtBall fit_ball(const RtGroup *group) {
    RtBall best;
    if (group->count == 1) {
        best = rt_object_ball(group->geometry, group->ids[0]);
    } else {
        RtVec3d far, center = rt_widen(rt_box_center(group->box));
        best = ball_about(group, center, &far);
        for (int step = 2; step <= 16; step++) {
            center = rt_add_scaledd(center, rt_subd(far, center), 1.0 / step);
            RtBall ball = ball_about(group, center, &far);
            if (ball.radius < best.radius) best = ball;
        }
    }
    best.radius += inflation(&group->box);
    return best;
}

static double oriented_half_area(const RtOrientedBox *box) {
    const double *half = box->half;
    return 4 * (half[0] * (half[1] + half[2]) + half[1] * half[2]);
}

static RtOrientedBox box_along(const RtGroup *group, const RtVec3d axes[3]) {
    RtOrientedBox box = {.center = {0, 0, 0}};
    for (int a = 0; a < 3; a++) {
        double hi = support(group, axes[a]), lo = -support(group, opposite(axes[a]));
        box.axes[a] = axes[a];
        box.center = rt_add_scaledd(box.center, axes[a], 0.5 * (lo + hi));
        box.half[a] = 0.5 * (hi - lo) + inflation(&group->box);
    }
    return box;
}

/* The covariance of the centres of the objects' boxes, in units of the group's size. */
static void covariance(const RtGroup *group, double c[3][3]) {
    RtVec3d mean = {0, 0, 0}, size = rt_widen(rt_box_size(group->box));
    double unit = 1 / (size.x + size.y + size.z);
    for (uint32_t i = 0; i < group->count; i++) {
        RtVec3d center = rt_widen(rt_box_center(group->geometry->boxes[group->ids[i]]));
        mean = rt_add_scaledd(mean, center, 1.0 / group->count);
    }
    for (uint32_t i = 0; i < group->count; i++) {
        RtVec3d center = rt_widen(rt_box_center(group->geometry->boxes[group->ids[i]]));
        RtVec3d d = rt_scaled(rt_subd(center, mean), unit);
        for (int a = 0; a < 9; a++) c[a / 3][a % 3] += d.at[a / 3] * d.at[a % 3];
    }
}

/* One Jacobi rotation (1846): rotates `axes` and the symmetric `c` in the plane of axes p and q so that
 * c[p][q] vanishes. */
static void rotate_away(double c[3][3], RtVec3d axes[3], int p, int q) {
    if (c[p][q] == 0) return;
    double theta = (c[q][q] - c[p][p]) / (2 * c[p][q]);
    double tangent = (theta < 0 ? -1 : 1) / (fabs(theta) + sqrt(theta * theta + 1));
    double cosine = 1 / sqrt(tangent * tangent + 1), sine = tangent * cosine;
    for (int k = 0; k < 3; k++) {
        double cp = c[k][p], cq = c[k][q];
        c[k][p] = cosine * cp - sine * cq;
        c[k][q] = sine * cp + cosine * cq;
    }
    for (int k = 0; k < 3; k++) {
        double cp = c[p][k], cq = c[q][k];
        c[p][k] = cosine * cp - sine * cq;
        c[q][k] = sine * cp + cosine * cq;
    }
    RtVec3d old = axes[p];
    axes[p] = rt_add_scaledd(rt_scaled(old, cosine), axes[q], -sine);
    axes[q] = rt_add_scaledd(rt_scaled(old, sine), axes[q], cosine);
}

/* The principal axes of the group, or the world's if it has none. */
static void principal_frame(const RtGroup *group, RtVec3d axes[3]) {
    double c[3][3] = {{0}};
    for (int a = 0; a < 3; a++) axes[a] = rt_slab_normals[a];
    covariance(group, c);
    if (!isfinite(c[0][0] + c[1][1] + c[2][2])) return;
    for (int sweep = 0; sweep < 8; sweep++) {
        rotate_away(c, axes, 0, 1);
        rotate_away(c, axes, 0, 2);
        rotate_away(c, axes, 1, 2);
    }
    axes[0] = rt_normalized(axes[0]);
    axes[1] = rt_normalized(rt_add_scaledd(axes[1], axes[0], -rt_dotd(axes[0], axes[1])));
    axes[2] = rt_crossd(axes[0], axes[1]);
}

static RtOrientedBox fit_oriented_box(const RtGroup *group) {
    RtVec3d axes[3];
    uint32_t largest = group->ids[0];
    for (uint32_t i = 1; i < group->count; i++) {
        const RtBox *boxes = group->geometry->boxes;
        if (rt_box_half_area(boxes[group->ids[i]]) > rt_box_half_area(boxes[largest]))
            largest = group->ids[i];
    }
    rt_object_frame(group->geometry, largest, axes);
    RtOrientedBox best = box_along(group, axes);
    for (int other = 0; group->count > 1 && other < 2; other++) {
        if (other == 1) principal_frame(group, axes);
        RtOrientedBox box = box_along(group, other == 0 ? rt_slab_normals : axes);
        if (oriented_half_area(&box) < oriented_half_area(&best)) best = box;
    }
    return best;
}

static RtSlab fit_slab(const RtGroup *group, RtVec3d normal) {
    double more = inflation(&group->box);
    double hi = support(group, normal), lo = -support(group, opposite(normal));
    return (RtSlab){rt_float_below(lo - more), rt_float_above(hi + more)};
}

void rt_extent_fit(RtExtentSet *set, uint32_t index, const RtGroup *group) {
    if (set->kind == RT_EXTENT_SPHERE) set->balls[index] = fit_ball(group);
    if (set->kind == RT_EXTENT_OBB) set->oriented[index] = fit_oriented_box(group);
    for (uint32_t i = 0; set->kind == RT_EXTENT_SLABS && i < set->slabs_each; i++)
        set->slabs[(size_t)index * set->slabs_each + i] = fit_slab(group, rt_slab_normals[i]);
}

double rt_extent_half_area(const RtExtentSet *set, uint32_t index, const RtBox *box) {
    if (set->kind == RT_EXTENT_BOX) return rt_box_half_area(*box);
    if (set->kind == RT_EXTENT_OBB) return oriented_half_area(&set->oriented[index]);
    if (set->kind == RT_EXTENT_SLABS) return NAN;
    return 2 * 3.14159265358979323846 * set->balls[index].radius * set->balls[index].radius;
}

/* ---- checking ---- */

/* How far the extent reaches in `direction`, `sense` (1 or -1) times the i-th normal of its faces: any unit
 * vector for a sphere. Up to the rounding of sums, except for slabs, which are rounded outward. */
static double reach_of(const RtExtentSet *set, uint32_t index, const RtBox *own, uint32_t i, int sense,
                       RtVec3d direction) {
    double sum = 0.25 * inflation(own);
    if (set->kind == RT_EXTENT_SLABS) {
        const RtSlab *slab = &set->slabs[(size_t)index * set->slabs_each + i];
        return sense < 0 ? -(double)slab->lo : (double)slab->hi;
    }
    if (set->kind == RT_EXTENT_BOX) return sum + sense * (double)(sense < 0 ? own->lo : own->hi).at[i];
    if (set->kind == RT_EXTENT_SPHERE)
        return sum + rt_dotd(set->balls[index].center, direction) + set->balls[index].radius;
    const RtOrientedBox *box = &set->oriented[index];
    for (int a = 0; a < 3; a++) sum += box->half[a] * fabs(rt_dotd(box->axes[a], direction));
    return sum + rt_dotd(box->center, direction);
}

/* RT_OK if the extent, which reaches so far in `direction`, contains the group. */
static RtStatus check_reach(const RtExtentSet *set, uint32_t index, const RtGroup *group, const char *owner,
                            RtVec3d direction, double reach, RtError *error) {
    for (uint32_t i = 0; i < group->count; i++) {
        if (reach >= rt_object_support(group->geometry, group->ids[i], direction)) continue;
        return rt_fail(error, RT_MISMATCH, "%s: the %s %u does not contain object %u (%s) along (%g, %g, %g)",
                       owner, kind_names[set->kind], index, group->ids[i],
                       rt_shape_name(rt_ref_shape(group->geometry->objects[group->ids[i]])), direction.x,
                       direction.y, direction.z);
    }
    return RT_OK;
}

/* Oriented boxes along their own axes: along other directions support functions may be less tight than the
 * faces of the extent together. */
RtStatus rt_extent_check(const RtExtentSet *set, uint32_t index, const RtGroup *group, const char *owner,
                         RtError *error) {
    const RtVec3d *normals = set->kind == RT_EXTENT_OBB ? set->oriented[index].axes : rt_slab_normals;
    const uint32_t count = set->kind == RT_EXTENT_SPHERE  ? RT_MAX_SLABS
                           : set->kind == RT_EXTENT_SLABS ? set->slabs_each
                                                          : 3;
    for (uint32_t i = 0; i < count; i++) {
        const double square = rt_dotd(normals[i], normals[i]),
                     across = rt_dotd(normals[i], normals[(i + 1) % 3]);
        if (set->kind == RT_EXTENT_OBB && !(fabs(square - 1) <= 0x1p-48 && fabs(across) <= 0x1p-48))
            return rt_fail(error, RT_MISMATCH, "%s: the axes of the oriented box %u are not orthonormal",
                           owner, index);
        for (int sense = 1; sense >= -1; sense -= 2) {
            const RtVec3d direction = sense > 0 ? normals[i] : opposite(normals[i]);
            const double reach = reach_of(set, index, &group->box, i, sense, direction);
            RT_TRY(check_reach(set, index, group, owner, direction, reach, error));
        }
    }
    return RT_OK;
}
