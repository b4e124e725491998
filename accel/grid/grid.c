/* SPDX-License-Identifier: Apache-2.0 */
/* grid: uniform spatial partitioning. The scene's box is divided into equal voxels, each with a list of the
 * objects whose boxes touch it; a ray visits the voxels it passes through in order. With depth > 1 a voxel
 * with too many objects is a grid itself.
 *
 * Papers: Fujimoto, Tanaka & Iwata 1986 (ARTS); Amanatides & Woo 1987 (the walk); Jevans & Wyvill 1989
 * (nested grids); Woo 1992 and Klimaszewski & Sederberg 1997 (rules of resolution); Kirk & Arvo 1991
 * (mailboxes).
 *
 * Layout and invariant: grid.h.
 *
 * The walk is exact because it uses the crossings of core/base/ray.h. On each axis the thick ray is in
 * interval i of planes from near(i) = (plane - org_near) * inv until far(i) = (plane' - org_far) * inv;
 * neighbouring intervals overlap, because the thick ray is in both while it crosses their plane. A voxel is
 * visited at the moment at which the ray is in all three of its intervals. Now let an object with box b be
 * hit at t: enter(b) <= t <= leave(b). Its intervals i0..i1 on an axis cover b, so near(i0) <= t <= far(i1),
 * and at t the ray is in one of them; on all three axes, so in a voxel that lists the object, entered at or
 * before t. Therefore the walk may stop when the next voxel is entered beyond the best t, and no hit is
 * rejected for lying outside the current voxel. Usually an axis has one current interval, two while the ray
 * crosses a plane; rays in a plane of voxels, or so far away that float32 cannot distinguish voxels, have
 * more, and visit more.
 *
 * Nested grids. A voxel that is a grid is walked through when it is visited, from the same moment on. Its
 * outermost planes are the voxel's, bit for bit, and the crossings of a plane are the same on every level; so
 * whenever the ray is in the voxel it is in some interval of the nested grid on each axis. At the t of a hit
 * it is in a voxel whose intervals cover a part of b; the part of b in there is covered by intervals i0..i1
 * of the nested grid, with near(i0) <= t because plane i0 does not lie beyond b or is the voxel's own, and
 * far(i1) >= t likewise. Then the argument continues inside. A nested walk ends where the voxel does, or
 * beyond the best t; only the outermost walk ends the search.
 *
 * With overlap=exact a voxel lists fewer objects; accel/clipping.h proves that they suffice.
 *
 * Counting: an extent test for the box of the grid; a step per voxel visited. With nested grids also a step
 * per grid walked through, including the outermost. */
#include "accel/grid/grid.h"
#include "accel/mailbox.h"

/* One axis of a walk. Intervals are numbered along the ray: 0 is the first it can meet, and lies between
 * planes 0 and 1. Steps and strides are negative (modulo 2^32) if the ray runs against the axis. */
typedef struct Axis {
    const float *planes; /* plane i is planes[i * step] */
    int32_t step;
    uint32_t stride;    /* from voxel to voxel */
    uint32_t n, lo, hi; /* current intervals, lo..hi */
    float near_org, far_org, inv;
    float enter; /* when interval hi + 1 is entered: near(hi + 1), or INFINITY beyond the last */
    float leave; /* when interval lo is left: far(lo) */
} Axis;

/* The walk through one block. */
typedef struct Walk {
    Axis axes[3];
    uint32_t voxel; /* in the last current intervals of the three axes */
    uint32_t extra; /* current intervals beyond one on each axis */
    int entered;    /* the axis crossed last; any before the first crossing */
    float t;        /* when that was */
} Walk;

RT_KERNEL float near_crossing(const Axis *axis, uint32_t i) {
    return (axis->planes[(ptrdiff_t)i * axis->step] - axis->near_org) * axis->inv;
}

RT_KERNEL float far_crossing(const Axis *axis, uint32_t i) {
    return (axis->planes[(ptrdiff_t)(i + 1) * axis->step] - axis->far_org) * axis->inv;
}

/* A crossing is NaN if the ray lies exactly in the moved plane: then it is always in the interval. */
RT_KERNEL void update_enter(Axis *axis) {
    axis->enter = axis->hi + 1 < axis->n ? near_crossing(axis, axis->hi + 1) : INFINITY;
}

/* The intervals that the ray is in at `t`; voxels are `stride` apart. */
RT_KERNEL Axis start_axis(const RtGridBlock *block, const RtPreparedRay *ray, int a, uint32_t stride,
                          float t) {
    const float *planes = block->planes[a];
    const uint32_t n = block->n[a];
    const bool mirrored = ray->negative[a];
    Axis axis = {.planes = mirrored ? planes + n : planes,
                 .step = mirrored ? -1 : 1,
                 .stride = mirrored ? 0 - stride : stride,
                 .n = n,
                 .near_org = ray->org_near[a],
                 .far_org = ray->org_far[a],
                 .inv = ray->inv[a]};
    float at = (ray->org[a] + t * ray->dir[a] - planes[0]) / (planes[n] - planes[0]) * (float)n;
    uint32_t guess = at > 0 ? (uint32_t)rt_minf(at, (float)(n - 1)) : 0;
    axis.lo = mirrored ? n - 1 - guess : guess;
    while (axis.lo > 0 && !(far_crossing(&axis, axis.lo - 1) < t)) axis.lo--;
    while (axis.lo + 1 < n && far_crossing(&axis, axis.lo) < t) axis.lo++;
    axis.hi = axis.lo;
    while (axis.hi + 1 < n && !(near_crossing(&axis, axis.hi + 1) > t)) axis.hi++;
    axis.leave = far_crossing(&axis, axis.lo);
    update_enter(&axis);
    return axis;
}

RT_KERNEL void begin_walk(Walk *walk, const RtGridBlock *block, const RtPreparedRay *ray, float t) {
    uint32_t stride = 1;
    walk->voxel = block->voxel;
    walk->extra = 0;
    walk->entered = 0;
    walk->t = t;
    for (int a = 0; a < 3; a++) {
        Axis *axis = &walk->axes[a];
        *axis = start_axis(block, ray, a, stride, t);
        walk->voxel += stride * (ray->negative[a] ? axis->n - 1 - axis->hi : axis->hi);
        walk->extra += axis->hi - axis->lo;
        stride *= axis->n;
    }
}

/* Drops the intervals of an axis that the ray has left before `t`; false if none remains. */
RT_KERNEL bool retire_axis(Walk *walk, Axis *axis, float t) {
    while (axis->leave < t) {
        if (axis->lo == axis->hi) return false;
        axis->lo++;
        walk->extra--;
        axis->leave = far_crossing(axis, axis->lo);
    }
    return true;
}

/* The same for all axes. Nearly always only the axis crossed last has something to drop. */
RT_KERNEL bool retire(Walk *walk, float t) {
    Axis *axes = walk->axes;
    if (!retire_axis(walk, &axes[walk->entered], t)) return false;
    if (!(rt_minf(axes[0].leave, rt_minf(axes[1].leave, rt_minf(axes[2].leave, INFINITY))) < t)) return true;
    for (int a = 0; a < 3; a++) {
        if (!retire_axis(walk, &axes[a], t)) return false;
    }
    return true;
}

/* The axis on which the next interval is entered, at INFINITY if there is none. */
RT_KERNEL int next_axis(const Axis axes[3]) {
    return axes[0].enter <= axes[1].enter ? (axes[0].enter <= axes[2].enter ? 0 : 2)
                                          : (axes[1].enter <= axes[2].enter ? 1 : 2);
}

/* Advances to the moment at which the next interval is entered; false if the walk is over, or that moment is
 * after `limit`. */
RT_KERNEL bool next_moment(Walk *walk, float limit) {
    int next = next_axis(walk->axes);
    Axis *axis = &walk->axes[next];
    walk->t = axis->enter;
    if (walk->t > limit || !retire(walk, walk->t)) return false;
    walk->entered = next;
    walk->voxel += axis->stride;
    walk->extra++;
    axis->hi++;
    update_enter(axis);
    return true;
}

RT_COLD static void observe_voxel(const RtGridLevel *level, size_t voxel, bool leaf, bool empty) {
    RtBox box = rt_grid_voxel_box(level, (uint32_t)voxel);
    rt_observe(&(RtTraced){.kind = RT_TRACED_STEP,
                           .what = "voxel",
                           .index = (uint32_t)voxel,
                           .box = &box,
                           .leaf = leaf,
                           .empty = empty});
}

RT_KERNEL bool visit_voxel(const RtGrid *self, const RtGridLevel *level, RtMailbox *mailbox, size_t voxel,
                           const RtPreparedRay *ray, bool any, RtHit *best, RtTally *tally) {
    uint32_t first = level->first[voxel], count = level->first[voxel + 1] - first;
    RT_COUNT(tally, steps, 1);
    RT_COUNT(tally, leaf_steps, 1);
    RT_COUNT(tally, empty_steps, count == 0);
    if (RT_OBSERVED(tally)) observe_voxel(level, voxel, true, count == 0);
    return rt_test_list(&self->base.scene->geometry, mailbox, level->ids + first, count, ray, any, best,
                        tally);
}

/* The voxels entered at one moment: in the intervals from..hi of the axes, but only the last on the axis just
 * crossed. The next is in the intervals i; none is left if i[2] is beyond. */
typedef struct Moment {
    uint32_t from[3], i[3];
} Moment;

RT_KERNEL Moment begin_moment(const Walk *walk, bool begins) {
    Moment moment;
    for (int a = 0; a < 3; a++) {
        const Axis *axis = &walk->axes[a];
        moment.i[a] = moment.from[a] = a == walk->entered && !begins ? axis->hi : axis->lo;
    }
    return moment;
}

/* The next voxel of this moment; false if there is none. */
RT_KERNEL bool next_voxel(const Walk *walk, Moment *moment, uint32_t *voxel) {
    const Axis *axes = walk->axes;
    uint32_t *i = moment->i;
    if (i[2] > axes[2].hi) return false;
    *voxel = walk->voxel;
    for (int a = 0; a < 3; a++) *voxel -= (axes[a].hi - i[a]) * axes[a].stride;
    if (++i[0] <= axes[0].hi) return true;
    i[0] = moment->from[0];
    if (++i[1] <= axes[1].hi) return true;
    i[1] = moment->from[1];
    i[2]++;
    return true;
}

/* Whether a moment has other voxels than walk->voxel: only the last interval counts on the axis just crossed,
 * and usually the other two axes have one. */
RT_KERNEL bool several_voxels(const Walk *walk) {
    const Axis *entered = &walk->axes[walk->entered];
    return walk->extra > entered->hi - entered->lo;
}

/* ---- one level ---- */

RT_KERNEL void walk_flat(const RtGrid *self, RtMailbox *mailbox, float t, const RtPreparedRay *ray, bool any,
                         RtHit *best, RtTally *tally) {
    const RtGridLevel *level = &self->levels[0];
    Walk walk;
    uint32_t voxel;
    begin_walk(&walk, level->blocks, ray, t);
    Moment moment = begin_moment(&walk, true);
    for (;;) {
        while (next_voxel(&walk, &moment, &voxel)) {
            if (visit_voxel(self, level, mailbox, voxel, ray, any, best, tally)) return;
        }
        do {
            if (!next_moment(&walk, rt_limit(ray, best))) return;
            if (several_voxels(&walk)) break;
            if (visit_voxel(self, level, mailbox, walk.voxel, ray, any, best, tally)) return;
        } while (true);
        moment = begin_moment(&walk, false);
    }
}

/* ---- several levels ---- */

/* A walk that is interrupted by one through a nested grid. */
typedef struct Interrupted {
    Walk walk;
    Moment moment;
} Interrupted;

RT_KERNEL void walk_nested(const RtGrid *self, RtMailbox *mailbox, float t, const RtPreparedRay *ray,
                           bool any, RtHit *best, RtTally *tally) {
    Interrupted stack[RT_GRID_MAX_LEVELS], *at = stack;
    const RtGridLevel *level = self->levels;
    RT_COUNT(tally, steps, 1);
    RT_OBSERVE(tally, .kind = RT_TRACED_STEP, .what = "grid", .box = &self->box);
    begin_walk(&at->walk, level->blocks, ray, t);
    at->moment = begin_moment(&at->walk, true);
    for (;;) {
        uint32_t voxel;
        if (!next_voxel(&at->walk, &at->moment, &voxel)) {
            if (next_moment(&at->walk, rt_limit(ray, best))) {
                at->moment = begin_moment(&at->walk, false);
            } else if (at == stack) {
                return;
            } else {
                at--;
                level--;
            }
            continue;
        }
        uint32_t inner = rt_grid_inner(level, voxel);
        if (inner == RT_GRID_LEAF) {
            if (visit_voxel(self, level, mailbox, voxel, ray, any, best, tally)) return;
        } else {
            RT_COUNT(tally, steps, 1);
            if (RT_OBSERVED(tally)) observe_voxel(level, voxel, false, false);
            level++;
            begin_walk(&at[1].walk, &level->blocks[inner], ray, at->walk.t);
            at++;
            at->moment = begin_moment(&at->walk, true);
        }
    }
}

/* Out of line, so that the walk through one level keeps its own variables in registers. */
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
    bool met = rt_box_hit(&self->box, ray, ray->tmax, &t);
    RT_OBSERVE(tally, .kind = RT_TRACED_EXTENT_TEST, .what = "grid", .box = &self->box, .met = met);
    if (!met) return;
    if (self->surfaces && !rt_clipped_serves(&self->served, ray)) {
        rt_test_all(&self->base.scene->geometry, ray, any, best, tally);
        return;
    }
    RtMailbox *mailbox = self->mailbox ? scratch : NULL;
    rt_mailbox_next_ray(mailbox, &self->base.scene->geometry);
    if (self->depth == 1)
        walk_flat(self, mailbox, t, ray, any, best, tally);
    else
        *best = tally ? nested_counted(self, mailbox, t, ray, any, tally)
                      : nested_timed(self, mailbox, t, ray, any);
}

RT_DEFINE_KERNELS(RtGrid, search)

const RtAccelOps rt_grid_ops = {
    .name = "grid",
    .summary = "uniform grid: equal voxels with lists of objects, visited in order",
    .paper = "Fujimoto, Tanaka & Iwata 1986, ARTS, CG&A 6(4); Amanatides & Woo 1987, A Fast Voxel Traversal "
             "Algorithm; Jevans & Wyvill 1989, Adaptive Voxel Subdivision for Ray Tracing, GI'89",
    RT_PARAMS_OF(rt_grid_params),
    .bytes = sizeof(RtGrid),
    .build = rt_grid_build,
    .destroy = rt_grid_destroy,
    RT_KERNEL_OPS,
    .describe = rt_grid_describe,
    .validate = rt_grid_validate,
    .each_box = rt_grid_each_box,
    .shows_lists = true,
};
