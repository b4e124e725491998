/* SPDX-License-Identifier: Apache-2.0 */
/* grid: uniform spatial partitioning. The scene's box is cut into equal voxels, each with a list of the
 * objects whose boxes touch it; a ray visits the voxels it passes through, in order. With depth > 1 a voxel
 * with too many objects is a grid in turn.
 *
 * Papers: Fujimoto, Tanaka & Iwata 1986 (ARTS); Amanatides & Woo 1987 (the walk); Jevans & Wyvill 1989
 * (nested grids); Woo 1992 and Klimaszewski & Sederberg 1997 (rules of resolution); Kirk & Arvo 1991
 * (mailboxes).
 *
 * Layout and invariant: grid.h.
 *
 * The walk is exact because it uses the crossings of base/ray.h. On each axis the thick ray is in interval i
 * of planes from near(i) = (plane - org_near) * inv until far(i) = (plane' - org_far) * inv; neighbours
 * overlap, because the thick ray is in both while it crosses their plane. A voxel is visited at the moment at
 * which the ray is in all three of its intervals. Now let a hit at t have own box b: enter(b) <= t <=
 * leave(b). Its intervals i0..i1 on an axis cover b, so near(i0) <= t <= far(i1), and at t the ray is in one
 * of them; on all three axes at once, so in a voxel that lists the object, entered at or before t. Stopping
 * when the next voxel is entered beyond the best t therefore loses nothing, and no hit need be refused for
 * lying outside the current voxel. Usually an axis has one current interval, two while the ray crosses a
 * plane; rays in a plane of voxels, or so far away that float32 cannot tell voxels apart, have more, and
 * visit more.
 *
 * Nested. A voxel that is a grid itself is walked through when it is visited, from the same moment on. Its
 * outermost planes are the voxel's, bit for bit, and the crossings of a plane are the same on every level; so
 * the ray is in one of its intervals on each axis whenever it is in the voxel. At the t of a hit it is in a
 * voxel whose intervals cover a part of b; b's part in there is covered by intervals i0..i1 of the nested
 * grid, near(i0) <= t because plane i0 does not lie beyond b or is the voxel's own, far(i1) >= t likewise,
 * and the argument goes on from there. A nested walk ends where the voxel does, or beyond the best t; only
 * the outermost one ends the search.
 *
 * With overlap=exact a voxel lists fewer objects; accel/surface.h proves that they are enough.
 *
 * Counting: an extent test for the box of the grid; a step per voxel visited. With nested grids a step per
 * grid walked through, too: the voxel that it fills is no leaf, and the outermost grid fills one. */
#include "accel/grid/grid.h"
#include "accel/mailbox.h"

static size_t scratch_bytes(const RtAccel *accel) {
    const RtGrid *grid = (const RtGrid *)accel;
    return grid->mailbox ? rt_mailbox_bytes(&accel->scene->geometry) : 0;
}

/* One axis of the walk. Intervals are numbered along the ray: 0 is the first it can meet. */
typedef struct Axis {
    const float *planes;
    uint32_t n, lo, hi; /* current intervals, lo..hi */
    bool mirrored;      /* the ray runs against the axis */
    float near_org, far_org, inv;
    float enter; /* when interval hi + 1 is entered: near(hi + 1), or INFINITY beyond the last */
    float leave; /* when interval lo is left: far(lo) */
} Axis;

RT_KERNEL float near_crossing(const Axis *axis, uint32_t i) {
    return (axis->planes[axis->mirrored ? axis->n - i : i] - axis->near_org) * axis->inv;
}

RT_KERNEL float far_crossing(const Axis *axis, uint32_t i) {
    return (axis->planes[axis->mirrored ? axis->n - 1 - i : i + 1] - axis->far_org) * axis->inv;
}

/* A crossing is NaN where the ray lies exactly in the moved plane: then it is in the interval, always. */
RT_KERNEL void update_enter(Axis *axis) {
    axis->enter = axis->hi + 1 < axis->n ? near_crossing(axis, axis->hi + 1) : INFINITY;
}

/* The intervals that the ray is in at `t`. */
RT_KERNEL Axis start_axis(const RtGridBlock *block, const RtPreparedRay *ray, int a, float t) {
    Axis axis = {.planes = block->planes[a],
                 .n = block->n[a],
                 .mirrored = ray->negative[a],
                 .near_org = ray->org_near[a],
                 .far_org = ray->org_far[a],
                 .inv = ray->inv[a]};
    float width = axis.planes[axis.n] - axis.planes[0];
    float at = (ray->org.at[a] + t * ray->dir.at[a] - axis.planes[0]) / width * (float)axis.n;
    uint32_t guess = at > 0 ? (uint32_t)rt_minf(at, (float)(axis.n - 1)) : 0;
    axis.lo = axis.mirrored ? axis.n - 1 - guess : guess;
    while (axis.lo > 0 && !(far_crossing(&axis, axis.lo - 1) < t)) axis.lo--;
    while (axis.lo + 1 < axis.n && far_crossing(&axis, axis.lo) < t) axis.lo++;
    axis.hi = axis.lo;
    while (axis.hi + 1 < axis.n && !(near_crossing(&axis, axis.hi + 1) > t)) axis.hi++;
    axis.leave = far_crossing(&axis, axis.lo);
    update_enter(&axis);
    return axis;
}

/* Drops the intervals that the ray has left before `t`; false if none remains. */
RT_KERNEL bool retire(Axis *axis, float t) {
    while (axis->leave < t) {
        if (axis->lo == axis->hi) return false;
        axis->lo++;
        axis->leave = far_crossing(axis, axis->lo);
    }
    return true;
}

/* The axis on which the next interval is entered: at INFINITY where there is none left on any. */
RT_KERNEL int next_axis(const Axis axes[3]) {
    return axes[0].enter <= axes[1].enter ? (axes[0].enter <= axes[2].enter ? 0 : 2)
                                          : (axes[1].enter <= axes[2].enter ? 1 : 2);
}

RT_KERNEL void enter_next(Axis *axis) {
    axis->hi++;
    update_enter(axis);
}

/* The voxel that lies in the intervals i of the three axes, as a number in its block: rt_grid_voxel_at by
 * what the axes know. */
RT_KERNEL size_t voxel_in(const Axis axes[3], const uint32_t i[3]) {
    uint32_t at[3];
    for (int a = 0; a < 3; a++) at[a] = axes[a].mirrored ? axes[a].n - 1 - i[a] : i[a];
    return ((size_t)at[2] * axes[1].n + at[1]) * axes[0].n + at[0];
}

RT_KERNEL bool visit_voxel(const RtGrid *self, const RtGridLevel *level, RtMailbox *mailbox, size_t voxel,
                           const RtPreparedRay *ray, bool any, RtHit *best, RtTally *tally) {
    uint32_t from = level->first[voxel], to = level->first[voxel + 1];
    RT_COUNT(tally, steps, 1);
    RT_COUNT(tally, leaf_steps, 1);
    RT_COUNT(tally, empty_steps, from == to);
    return rt_test_list(&self->base.scene->geometry, mailbox, level->ids + from, to - from, ray, any, best,
                        tally);
}

/* ---- one level ---- */

/* Visits the voxels of all current intervals, but of axis `entered` only the newest. */
RT_KERNEL bool visit_current(const RtGrid *self, RtMailbox *mailbox, const Axis axes[3], int entered,
                             const RtPreparedRay *ray, bool any, RtHit *best, RtTally *tally) {
    const RtGridLevel *level = &self->levels[0];
    uint32_t from[3], i[3];
    for (int a = 0; a < 3; a++) from[a] = a == entered ? axes[a].hi : axes[a].lo;
    for (i[2] = from[2]; i[2] <= axes[2].hi; i[2]++) {
        for (i[1] = from[1]; i[1] <= axes[1].hi; i[1]++) {
            for (i[0] = from[0]; i[0] <= axes[0].hi; i[0]++) {
                size_t voxel = voxel_in(axes, i);
                if (visit_voxel(self, level, mailbox, voxel, ray, any, best, tally)) return true;
            }
        }
    }
    return false;
}

RT_KERNEL void walk_flat(const RtGrid *self, RtMailbox *mailbox, float t, const RtPreparedRay *ray, bool any,
                         RtHit *best, RtTally *tally) {
    Axis axes[3];
    int entered = -1;
    for (int a = 0; a < 3; a++) axes[a] = start_axis(self->levels[0].blocks, ray, a, t);
    for (;;) {
        if (visit_current(self, mailbox, axes, entered, ray, any, best, tally)) return;
        entered = next_axis(axes);
        t = axes[entered].enter;
        if (t > rt_limit(ray, best)) return;
        for (int a = 0; a < 3; a++) {
            if (!retire(&axes[a], t)) return;
        }
        enter_next(&axes[entered]);
    }
}

/* ---- several levels ---- */

/* The walk through one block, that of each level on a stack. Of the voxels to visit at moment t, those in the
 * intervals from..hi of the axes, the next is in the intervals i; none is left where i[2] is beyond. */
typedef struct Walk {
    Axis axes[3];
    uint32_t voxel; /* the first of the block */
    uint32_t from[3], i[3];
    int entered; /* the axis that was crossed last, or -1 */
    float t;
} Walk;

RT_KERNEL void begin_moment(Walk *walk) {
    for (int a = 0; a < 3; a++) {
        walk->i[a] = walk->from[a] = a == walk->entered ? walk->axes[a].hi : walk->axes[a].lo;
    }
}

RT_KERNEL void begin_walk(Walk *walk, const RtGridBlock *block, const RtPreparedRay *ray, float t) {
    walk->voxel = block->voxel;
    walk->entered = -1;
    walk->t = t;
    for (int a = 0; a < 3; a++) walk->axes[a] = start_axis(block, ray, a, t);
    begin_moment(walk);
}

/* What walk_flat does between two moments; false where the walk is over. One function for both would cost
 * walk_flat 3 %, for reasons of the compiler's. */
RT_KERNEL bool next_moment(Walk *walk, const RtPreparedRay *ray, const RtHit *best) {
    walk->entered = next_axis(walk->axes);
    walk->t = walk->axes[walk->entered].enter;
    if (walk->t > rt_limit(ray, best)) return false;
    for (int a = 0; a < 3; a++) {
        if (!retire(&walk->axes[a], walk->t)) return false;
    }
    enter_next(&walk->axes[walk->entered]);
    return true;
}

/* The next voxel of this moment; false where there is none. */
RT_KERNEL bool next_voxel(Walk *walk, size_t *voxel) {
    uint32_t *i = walk->i;
    if (i[2] > walk->axes[2].hi) return false;
    *voxel = walk->voxel + voxel_in(walk->axes, i);
    if (++i[0] <= walk->axes[0].hi) return true;
    i[0] = walk->from[0];
    if (++i[1] <= walk->axes[1].hi) return true;
    i[1] = walk->from[1];
    i[2]++;
    return true;
}

RT_KERNEL void walk_nested(const RtGrid *self, RtMailbox *mailbox, float t, const RtPreparedRay *ray,
                           bool any, RtHit *best, RtTally *tally) {
    Walk stack[RT_GRID_MAX_LEVELS], *walk = stack;
    const RtGridLevel *level = self->levels;
    RT_COUNT(tally, steps, 1);
    begin_walk(walk, level->blocks, ray, t);
    for (;;) {
        size_t voxel;
        if (!next_voxel(walk, &voxel)) {
            if (next_moment(walk, ray, best)) {
                begin_moment(walk);
            } else if (walk == stack) {
                return;
            } else {
                walk--;
                level--;
            }
            continue;
        }
        uint32_t inner = rt_grid_inner(level, voxel);
        if (inner == RT_GRID_LEAF) {
            if (visit_voxel(self, level, mailbox, voxel, ray, any, best, tally)) return;
        } else {
            RT_COUNT(tally, steps, 1);
            level++;
            begin_walk(walk + 1, &level->blocks[inner], ray, walk->t);
            walk++;
        }
    }
}

/* Out of line, so that what one level needs is all that the walk through one level keeps in registers. */
__attribute__((noinline)) static RtHit nested_timed(const RtGrid *self, RtMailbox *mailbox, float t,
                                                    const RtPreparedRay *ray, bool any) {
    RtHit best = RT_MISS;
    walk_nested(self, mailbox, t, ray, any, &best, NULL);
    return best;
}

__attribute__((noinline)) static RtHit nested_counted(const RtGrid *self, RtMailbox *mailbox, float t,
                                                      const RtPreparedRay *ray, bool any, RtTally *tally) {
    RtHit best = RT_MISS;
    walk_nested(self, mailbox, t, ray, any, &best, tally);
    return best;
}

RT_KERNEL void search(const RtGrid *self, void *scratch, const RtPreparedRay *ray, bool any, RtHit *best,
                      RtTally *tally) {
    float t;
    if (self->depth == 0) return;
    RT_COUNT(tally, extent_tests, 1);
    if (!rt_box_hit(&self->box, ray, ray->tmax, &t)) return;
    if (self->surfaces && !rt_surface_serves(&self->served, ray)) {
        rt_test_all(&self->base.scene->geometry, ray, any, best, tally);
        return;
    }
    RtMailbox *mailbox = self->mailbox ? scratch : NULL;
    rt_mailbox_next_ray(mailbox, &self->base.scene->geometry);
    if (self->depth == 1) {
        walk_flat(self, mailbox, t, ray, any, best, tally);
    } else {
        *best = tally ? nested_counted(self, mailbox, t, ray, any, tally)
                      : nested_timed(self, mailbox, t, ray, any);
    }
}

RT_DEFINE_KERNELS(RtGrid, search)

const RtAccelOps rt_grid_ops = {
    .name = "grid",
    .summary = "uniform spatial partitioning: equal voxels with lists of objects, walked in order",
    .paper = "Fujimoto, Tanaka & Iwata 1986, ARTS, CG&A 6(4); Amanatides & Woo 1987, A Fast Voxel Traversal "
             "Algorithm; Jevans & Wyvill 1989, Adaptive Voxel Subdivision for Ray Tracing, GI'89",
    RT_PARAMS_OF(rt_grid_params),
    .build = rt_grid_build,
    .destroy = rt_grid_destroy,
    RT_KERNEL_OPS,
    .scratch_bytes = scratch_bytes,
    .describe = rt_grid_describe,
    .validate = rt_grid_validate,
    .each_box = rt_grid_each_box,
};
