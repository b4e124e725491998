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

static size_t bytes_each(const RtExtentSet *set) {
    switch (set->kind) {
    case RT_EXTENT_SPHERE: return sizeof(RtBall);
    case RT_EXTENT_OBB: return sizeof(RtOrientedBox);
    case RT_EXTENT_SLABS: return set->slabs_each * sizeof(RtSlab);
    case RT_EXTENT_BOX:
    case RT_EXTENT_KIND_COUNT: break;
    }
    return 0;
}

size_t rt_extent_set_bytes(const RtExtentSet *set) {
    return set->count * bytes_each(set);
}

RtStatus rt_extent_set_init(RtExtentSet *set, RtArena *memory, RtExtentKind kind, uint32_t slabs_each,
                            uint32_t count, RtError *error) {
    *set = (RtExtentSet){.kind = kind, .slabs_each = slabs_each, .count = count};
    if (kind == RT_EXTENT_BOX) return RT_OK;
    void *block = rt_arena_alloc(memory, count, bytes_each(set));
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
    switch (set->kind) {
    case RT_EXTENT_BOX: return rt_box_half_area(*box);
    case RT_EXTENT_SPHERE:
        return 2 * 3.14159265358979323846 * set->balls[index].radius * set->balls[index].radius;
    case RT_EXTENT_OBB: return oriented_half_area(&set->oriented[index]);
    case RT_EXTENT_SLABS:
    case RT_EXTENT_KIND_COUNT: break;
    }
    return NAN;
}

/* ---- checking ---- */

/* The extent and its group. */
typedef struct Check {
    const RtExtentSet *set;
    uint32_t index;
    const RtGroup *group;
    const char *owner;
    RtError *error;
} Check;

/* The reach of an extent along `direction`, the normal of one of its faces: any axis of a box, any unit
 * vector for a sphere. */
static double extent_support(const Check *check, RtVec3d direction) {
    const RtExtentSet *set = check->set;
    double sum = 0;
    if (set->kind == RT_EXTENT_BOX) {
        const RtBox *own = &check->group->box;
        for (int a = 0; a < 3; a++)
            sum += direction.at[a] * (double)(direction.at[a] < 0 ? own->lo.at[a] : own->hi.at[a]);
        return sum;
    }
    if (set->kind == RT_EXTENT_SPHERE) {
        const RtBall *ball = &set->balls[check->index];
        return rt_dotd(ball->center, direction) + ball->radius;
    }
    const RtOrientedBox *box = &set->oriented[check->index];
    sum = rt_dotd(box->center, direction);
    for (int a = 0; a < 3; a++) sum += box->half[a] * fabs(rt_dotd(box->axes[a], direction));
    return sum;
}

/* Whether the extent reaches `reach` along `direction`, the reach of its objects. */
static RtStatus check_reach(const Check *check, RtVec3d direction, double reach) {
    const RtGroup *group = check->group;
    for (uint32_t i = 0; i < group->count; i++) {
        if (reach >= rt_object_support(group->geometry, group->ids[i], direction)) continue;
        return rt_fail(check->error, RT_MISMATCH,
                       "%s: the %s %u does not contain object %u (%s) along (%g, %g, %g)", check->owner,
                       kind_names[check->set->kind], check->index, group->ids[i],
                       rt_shape_name(rt_ref_shape(group->geometry->objects[group->ids[i]])), direction.x,
                       direction.y, direction.z);
    }
    return RT_OK;
}

/* Checks both senses of a direction, up to the rounding of the two sums. */
static RtStatus check_along(const Check *check, RtVec3d direction) {
    double slack = 0.25 * inflation(&check->group->box);
    const RtVec3d both[2] = {direction, opposite(direction)};
    for (int i = 0; i < 2; i++) RT_TRY(check_reach(check, both[i], extent_support(check, both[i]) + slack));
    return RT_OK;
}

static RtStatus check_slabs(const Check *check) {
    const RtSlab *slabs = check->set->slabs + (size_t)check->index * check->set->slabs_each;
    for (uint32_t i = 0; i < check->set->slabs_each; i++) {
        RT_TRY(check_reach(check, rt_slab_normals[i], (double)slabs[i].hi));
        RT_TRY(check_reach(check, opposite(rt_slab_normals[i]), -(double)slabs[i].lo));
    }
    return RT_OK;
}

static RtStatus check_axes(const Check *check) {
    const RtVec3d *axes = check->set->oriented[check->index].axes;
    for (int a = 0; a < 3; a++) {
        int b = a == 2 ? 0 : a + 1;
        bool unit = fabs(rt_dotd(axes[a], axes[a]) - 1) <= 0x1p-48;
        if (!unit || !(fabs(rt_dotd(axes[a], axes[b])) <= 0x1p-48))
            return rt_fail(check->error, RT_MISMATCH,
                           "%s: the axes of the oriented box %u are not orthonormal", check->owner,
                           check->index);
        RT_TRY(check_along(check, axes[a]));
    }
    return RT_OK;
}

RtStatus rt_extent_check(const RtExtentSet *set, uint32_t index, const RtGroup *group, const char *owner,
                         RtError *error) {
    Check check = {set, index, group, owner, error};
    if (set->kind == RT_EXTENT_SLABS) return check_slabs(&check);
    /* Along other directions support functions may be less tight than the extent's own faces together. */
    if (set->kind == RT_EXTENT_OBB) return check_axes(&check);
    for (uint32_t i = 0; i < (set->kind == RT_EXTENT_BOX ? 3 : RT_MAX_SLABS); i++)
        RT_TRY(check_along(&check, rt_slab_normals[i]));
    return RT_OK;
}
