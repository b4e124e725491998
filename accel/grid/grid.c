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
#include "accel/kernel.h"

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
    RtGridVoxel found = {.level = level, .number = (uint32_t)voxel};
    rt_grid_find_voxel(&found);
    rt_observe(&(RtTraced){.kind = RT_TRACED_STEP,
                           .what = "voxel",
                           .index = (uint32_t)voxel,
                           .box = &found.box,
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
    RtMailbox *mailbox = self->base.scratch_bytes > 0 ? scratch : NULL;
    rt_mailbox_next_ray(mailbox, &self->base.scene->geometry);
    if (self->depth == 1)
        walk_flat(self, mailbox, t, ray, any, best, tally);
    else
        *best = tally ? nested_counted(self, mailbox, t, ray, any, tally)
                      : nested_timed(self, mailbox, t, ray, any);
}

RT_DEFINE_KERNELS(RtGrid, search)

/* ---- describing ---- */

/* A random line through the box of the grid meets a voxel with the ratio of their areas; the voxels of a
 * block are equal. A voxel with a nested grid counts as the step of that grid. */
static void predict(const RtGrid *grid, const RtGridLevel *level, RtDescription *out) {
    double whole = rt_box_half_area(grid->box);
    for (uint32_t b = 0; b < level->block_count; b++) {
        const RtGridBlock *block = &level->blocks[b];
        const uint32_t corner[3] = {0, 0, 0};
        size_t voxels = (size_t)block->n[0] * block->n[1] * block->n[2];
        uint32_t references = level->first[block->voxel + voxels] - level->first[block->voxel];
        double ratio = rt_box_half_area(rt_grid_voxel_box(block, corner)) / whole;
        out->predicted_steps += (double)voxels * ratio;
        out->predicted_tests += (double)references * ratio;
    }
    out->predicted_cost = out->predicted_tests;
}

static void describe(const RtAccel *accel, RtDescription *out) {
    const RtGrid *grid = (const RtGrid *)accel;
    if (grid->depth == 0) {
        *out = (RtDescription){RT_NO_PREDICTION};
        return;
    }
    *out = (RtDescription){.depth = grid->depth, RT_NO_QUALITY};
    for (uint32_t i = 0; i < grid->depth; i++) {
        const RtGridLevel *level = &grid->levels[i];
        for (uint32_t v = 0; v < level->voxel_count; v++) {
            if (rt_grid_inner(level, v) != RT_GRID_LEAF) continue;
            out->leaves++;
            out->empty_leaves += level->first[v] == level->first[v + 1];
        }
        if (grid->depth > 1) out->interior += level->block_count;
        out->references += level->first[level->voxel_count];
        out->bytes += rt_grid_level_bytes(level);
        predict(grid, level, out);
    }
    if (grid->depth > 1) out->predicted_steps += 1; /* the outermost grid */
    out->bytes -= sizeof(RtGridBlock);              /* the outermost, which is one per accelerator */
}

/* ---- validate ---- */

typedef struct Check {
    const RtGrid *grid;
    uint64_t *listed;    /* [object_count] voxels that list each object */
    RtOutline *outlines; /* [object_count] */
    uint32_t nested;     /* blocks nested in the voxels so far */
    RtError *error;
} Check;

/* Fails with the name of a voxel and `words`. */
static RtStatus fail_voxel(const Check *check, const RtGridVoxel *voxel, const char *words) {
    return rt_fail(check->error, RT_MISMATCH, "grid: voxel (%u, %u, %u) of level %d %s", voxel->at[0],
                   voxel->at[1], voxel->at[2], (int)(voxel->level - check->grid->levels), words);
}

/* A voxel with a nested block, which must be the next one and have the same box. */
static RtStatus check_nested(Check *check, const RtGridVoxel *voxel, uint32_t inner) {
    const RtGridLevel *next = voxel->level + 1;
    if (inner != check->nested++ || inner >= next->block_count)
        return fail_voxel(check, voxel, "does not hold the next grid of its level");
    const RtGridBlock *block = &next->blocks[inner];
    for (int a = 0; a < 3; a++) {
        if (block->planes[a][0] == voxel->box.lo.at[a] &&
            block->planes[a][block->n[a]] == voxel->box.hi.at[a])
            continue;
        return fail_voxel(check, voxel, "is not filled by the grid that is nested in it");
    }
    return RT_OK;
}

static RtStatus check_voxel(Check *check, const RtGridVoxel *voxel) {
    const RtGrid *grid = check->grid;
    const RtGridLevel *level = voxel->level;
    uint32_t from = level->first[voxel->number], to = level->first[voxel->number + 1];
    uint32_t inner = rt_grid_inner(level, voxel->number);
    if (from > to || to > level->first[level->voxel_count] || (from < to && inner != RT_GRID_LEAF))
        return fail_voxel(check, voxel, "has a list that is broken");
    if (inner != RT_GRID_LEAF) return check_nested(check, voxel, inner);
    for (uint32_t i = from; i < to; i++) {
        uint32_t id = level->ids[i];
        if (id >= grid->base.scene->geometry.object_count || (i > from && level->ids[i - 1] >= id))
            return fail_voxel(check, voxel, "has a list that is not ascending ids");
        RtBox object = rt_grid_object_box(grid, id);
        bool apart = rt_box_is_empty(rt_box_common(voxel->box, object));
        if (grid->surfaces) apart |= !rt_grid_surface_meets(grid, &check->outlines[id], &voxel->box);
        if (apart) return fail_voxel(check, voxel, "lists an object which it does not touch");
        check->listed[id]++;
    }
    return RT_OK;
}

/* Planes ascend, voxels are numbered without gaps, and each block of the next level is in some voxel. */
static RtStatus check_level(Check *check, const RtGridLevel *level) {
    uint32_t voxels = 0;
    for (uint32_t b = 0; b < level->block_count; b++) {
        const RtGridBlock *block = &level->blocks[b];
        if (block->voxel != voxels)
            return rt_fail(check->error, RT_MISMATCH, "grid: the voxels of grid %u are misnumbered", b);
        voxels += block->n[0] * block->n[1] * block->n[2];
        for (int a = 0; a < 3; a++) {
            for (uint32_t i = 0; i < block->n[a]; i++) {
                if (block->planes[a][i] <= block->planes[a][i + 1]) continue;
                return rt_fail(check->error, RT_MISMATCH, "grid: plane %u of axis %d lies behind plane %u", i,
                               a, i + 1);
            }
        }
    }
    check->nested = 0;
    for (RtGridVoxel voxel = {.level = level}; rt_grid_find_voxel(&voxel); voxel.number++)
        RT_TRY(check_voxel(check, &voxel));
    bool last = level + 1 == check->grid->levels + check->grid->depth;
    if (last || check->nested == level[1].block_count) return RT_OK;
    return rt_fail(check->error, RT_MISMATCH, "grid: a nested grid is in no voxel");
}

/* The first voxel on `axis` that touches [lo, hi], and their number, by a linear search. */
static uint32_t count_touched(const RtGridBlock *block, int axis, const RtBox *box, uint32_t *first) {
    const float *plane = block->planes[axis];
    uint32_t count = 0;
    for (uint32_t i = block->n[axis]; i-- > 0;) {
        bool last = i + 1 == block->n[axis];
        if (plane[i] > box->hi.at[axis] || (plane[i + 1] <= box->lo.at[axis] && !last)) continue;
        *first = i;
        count++;
    }
    return count;
}

/* Voxels of a block, and of blocks nested in it, that must list an object, found one by one, not by bisecting
 * ranges as in the build. */
static uint64_t voxels_touched(const Check *check, const RtGridLevel *level, uint32_t index, uint32_t id) {
    const RtGrid *grid = check->grid;
    const RtGridBlock *block = &level->blocks[index];
    RtBox object = rt_grid_object_box(grid, id);
    uint32_t first[3], n[3], at[3];
    uint64_t met = 0;
    for (int a = 0; a < 3; a++) n[a] = count_touched(block, a, &object, &first[a]);
    for (at[2] = first[2]; at[2] < first[2] + n[2]; at[2]++) {
        for (at[1] = first[1]; at[1] < first[1] + n[1]; at[1]++) {
            for (at[0] = first[0]; at[0] < first[0] + n[0]; at[0]++) {
                RtBox box = rt_grid_voxel_box(block, at);
                uint32_t inner = rt_grid_inner(level, rt_grid_voxel_at(block, at));
                if (grid->surfaces && !rt_grid_surface_meets(grid, &check->outlines[id], &box)) continue;
                met += inner == RT_GRID_LEAF ? 1 : voxels_touched(check, level + 1, inner, id);
            }
        }
    }
    return met;
}

static RtStatus validate(const RtAccel *accel, RtError *error) {
    const RtGrid *grid = (const RtGrid *)accel;
    const RtGeometry *g = &accel->scene->geometry;
    if (grid->depth == 0) return RT_OK;
    const RtGridBlock *root = grid->levels[0].blocks;
    for (int a = 0; a < 3; a++) {
        if (root->planes[a][0] <= grid->box.lo.at[a] && root->planes[a][root->n[a]] >= grid->box.hi.at[a])
            continue;
        return rt_fail(error, RT_MISMATCH, "grid: the planes of axis %d do not enclose its box", a);
    }
    if (!rt_box_contains(grid->box, g->box))
        return rt_fail(error, RT_MISMATCH, "grid: its box does not contain the scene");
    RT_ARENA(arena);
    Check check = {grid, rt_arena_alloc(&arena, g->object_count, sizeof(uint64_t)),
                   rt_arena_alloc(&arena, g->object_count, sizeof(RtOutline)), 0, error};
    RT_TRY(rt_arena_check(&arena, "validating a grid", error));
    for (uint32_t id = 0; id < g->object_count; id++) check.outlines[id] = rt_object_outline(g, id);
    for (uint32_t i = 0; i < grid->depth; i++) RT_TRY(check_level(&check, &grid->levels[i]));
    for (uint32_t id = 0; id < g->object_count; id++) {
        uint64_t touched = voxels_touched(&check, &grid->levels[0], 0, id);
        if (check.listed[id] == touched) continue;
        return rt_fail(error, RT_MISMATCH, "grid: object %u touches %llu voxels, but %llu list it", id,
                       (unsigned long long)touched, (unsigned long long)check.listed[id]);
    }
    return RT_OK;
}

/* Voxels of the outermost grid have depth 1. */
static void each_box(const RtAccel *accel, RtBoxViewer viewer) {
    const RtGrid *grid = (const RtGrid *)accel;
    if (grid->depth == 0) return;
    viewer.show(viewer.context, &(RtBoxView){.box = &grid->box, .children = grid->levels[0].voxel_count});
    for (uint32_t i = 0; i < grid->depth; i++) {
        const RtGridLevel *level = &grid->levels[i];
        for (RtGridVoxel voxel = {.level = level}; rt_grid_find_voxel(&voxel); voxel.number++) {
            const uint32_t *first = &level->first[voxel.number], inner = rt_grid_inner(level, voxel.number);
            const uint32_t *n = inner == RT_GRID_LEAF ? NULL : level[1].blocks[inner].n;
            viewer.show(viewer.context, &(RtBoxView){.box = &voxel.box,
                                                     .depth = i + 1,
                                                     .leaf = !n,
                                                     .objects = first[1] - first[0],
                                                     .children = n ? n[0] * n[1] * n[2] : 0});
        }
    }
}

const RtAccelOps rt_grid_ops = {
    .name = "grid",
    .summary = "uniform grid: equal voxels with lists of objects, visited in order",
    .paper = "Fujimoto, Tanaka & Iwata 1986, ARTS, CG&A 6(4); Amanatides & Woo 1987, A Fast Voxel Traversal "
             "Algorithm; Jevans & Wyvill 1989, Adaptive Voxel Subdivision for Ray Tracing, GI'89",
    RT_PARAMS_OF(rt_grid_params),
    RT_BEST("density=4|1,depth=1|3"),
    .bytes = sizeof(RtGrid),
    .build = rt_grid_build,
    .kernels = &kernels,
    .describe = describe,
    .validate = validate,
    .each_box = each_box,
    .shows_lists = true,
};
