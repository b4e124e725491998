/* SPDX-License-Identifier: Apache-2.0 */
/* kd: cells split at planes of the least expected cost; a ray visits the leaves it meets, nearest first.
 *
 * Papers: MacDonald & Booth 1990 (the surface area heuristic); Havran 2000, Heuristic Ray Shooting Algorithms
 * (the traversal: the interval of the ray in a cell is split at its plane, the far part goes on a stack);
 * Wald & Havran 2006 (building).
 *
 * Layout and invariants: kd.h. Exactness: in the terms of core/base/ray.h, the thick ray is in a cell at t if
 * it has crossed the near planes, (plane - org_near) * inv <= t, and not yet the far planes, (plane -
 * org_far) * inv >= t. Children overlap while the thick ray crosses their plane, so whenever it is in a cell
 * it is in at least one child. A crossing is NaN for a ray exactly in the moved plane, and is ignored: the
 * ray is in both. Now let an object with box b be hit at t, and let the ray be in a cell that lists the
 * object at t. If the object goes into the lower child alone, then b ends at or below the split, or the cell
 * does, and because enter(b) <= t <= leave(b) and crossings are monotone, the ray is in the lower child at t.
 * The same holds above; a part that lies in the plane is in both cells at t. So at t the ray is in a leaf
 * that lists the object. A leaf is skipped only if it is entered beyond the best t, and no hit is rejected
 * for lying outside the current cell.
 *
 * With overlap=exact the same follows from accel/clipping.h. At t the ray is in all closed cells that contain
 * its q, and q is in the part of the object in each such cell, because parts are boxes of all points of the
 * cell within the margin of the surface and inside the object's box. So if q lies below the split, the part
 * begins below it; if q lies in the split, either child that lists the object will do.
 *
 * Counting: an extent test for the cell of the root; a step per node visited. */
#include "accel/kd/kd.h"
#include "accel/kernel.h"

#include <stdlib.h>

/* A pending node, and the interval of t in which the ray is in its cell. */
typedef struct Span {
    uint32_t node;
    float enter, leave;
} Span;

/* The cell of a node, found by the numbers of nodes: a node is below the child whose own children come last
 * before it, because the nodes below a child are adjacent. */
static RtBox cell_of(const RtKd *kd, uint32_t index) {
    RtBox cell = kd->box;
    for (uint32_t at = 0, next; at != index; at = next) {
        const RtKdNode *node = &kd->nodes[at];
        const uint32_t lower = rt_kd_child(node), upper = lower + 1;
        uint32_t first[2] = {0, 0};
        for (uint32_t c = 0; c < 2; c++) {
            const RtKdNode *child = &kd->nodes[lower + c];
            if (!rt_kd_is_leaf(child) && rt_kd_child(child) <= index) first[c] = rt_kd_child(child);
        }
        next = index <= upper ? index : first[1] > first[0] ? upper : lower;
        cell = rt_kd_half(cell, rt_kd_axis(node), node->split, next - lower);
    }
    return cell;
}

RT_COLD static void observe_node(const RtKd *self, uint32_t index) {
    const RtKdNode *node = &self->nodes[index];
    RtBox cell = cell_of(self, index);
    bool leaf = rt_kd_is_leaf(node);
    rt_observe(&(RtTraced){.kind = RT_TRACED_STEP,
                           .what = "node",
                           .index = index,
                           .box = &cell,
                           .leaf = leaf,
                           .empty = leaf && rt_kd_length(node) == 0});
}

/* Descends from the node of *span to a leaf, nearest child first; pushes the other children. */
RT_KERNEL const RtKdNode *descend(const RtKd *self, const RtPreparedRay *ray, Span *span, Span *stack,
                                  uint32_t *stacked, RtTally *tally) {
    for (;;) {
        const RtKdNode *node = &self->nodes[span->node];
        RT_COUNT(tally, steps, 1);
        if (RT_OBSERVED(tally)) observe_node(self, span->node);
        if (rt_kd_is_leaf(node)) return node;
        uint32_t axis = rt_kd_axis(node), child = rt_kd_child(node);
        float enter = (node->split - ray->org_near[axis]) * ray->inv[axis]; /* the second child */
        float leave = (node->split - ray->org_far[axis]) * ray->inv[axis];  /* the first */
        uint32_t first = child + ray->negative[axis], second = child + 1 - ray->negative[axis];
        /* Branches, as in accel/bvh: predicted, so the next node is loaded before the crossings are known. */
        if (leave < span->enter) {
            span->node = second;
            continue;
        }
        span->node = first;
        if (enter > span->leave) continue;
        stack[(*stacked)++] = (Span){second, rt_maxf(enter, span->enter), span->leave};
        span->leave = rt_minf(leave, span->leave);
    }
}

RT_KERNEL void search(const RtKd *self, void *scratch, const RtPreparedRay *ray, bool any, RtHit *best,
                      RtTally *tally) {
    const RtGeometry *g = &self->base.scene->geometry;
    Span stack[RT_KD_DEPTH_LIMIT], span = {0, ray->tmin, ray->tmax};
    uint32_t stacked = 0;
    if (self->node_count == 0) return;
    RT_COUNT(tally, extent_tests, 1);
    rt_box_cut(&self->box, ray, &span.enter, &span.leave);
    bool met = span.enter <= span.leave;
    RT_OBSERVE(tally, .kind = RT_TRACED_EXTENT_TEST, .what = "node", .box = &self->box, .met = met);
    if (!met) return;
    if (self->surfaces && !rt_clipped_serves(&self->served, ray)) {
        rt_test_all(g, ray, any, best, tally);
        return;
    }
    RtMailbox *mailbox = self->base.scratch_bytes > 0 ? scratch : NULL;
    rt_mailbox_next_ray(mailbox, g);
    for (;;) {
        const RtKdNode *leaf = descend(self, ray, &span, stack, &stacked, tally);
        RT_COUNT(tally, leaf_steps, 1);
        RT_COUNT(tally, empty_steps, rt_kd_length(leaf) == 0);
        if (rt_test_list(g, mailbox, self->ids + leaf->first, rt_kd_length(leaf), ray, any, best, tally))
            return;
        do {
            if (stacked == 0) return;
            span = stack[--stacked];
        } while (span.enter > best->t);
        span.leave = rt_minf(best->t, span.leave);
    }
}

RT_DEFINE_KERNELS(RtKd, search)

/* ---- looking at it ---- */

/* Cells are not stored, but cut from the root's on the way down. */
static void show_node(const RtKd *kd, uint32_t index, RtBox cell, uint32_t depth, RtBoxViewer viewer) {
    const RtKdNode *node = &kd->nodes[index];
    bool leaf = rt_kd_is_leaf(node);
    viewer.show(viewer.context, &(RtBoxView){.box = &cell,
                                             .depth = depth,
                                             .leaf = leaf,
                                             .objects = leaf ? rt_kd_length(node) : 0,
                                             .children = leaf ? 0 : 2});
    for (uint32_t c = 0; c < 2 && !leaf; c++) {
        RtBox half = rt_kd_half(cell, rt_kd_axis(node), node->split, c);
        show_node(kd, rt_kd_child(node) + c, half, depth + 1, viewer);
    }
}

static void each_box(const RtAccel *accel, RtBoxViewer viewer) {
    const RtKd *kd = (const RtKd *)accel;
    if (kd->node_count > 0) show_node(kd, 0, kd->box, 0, viewer);
}

static void describe(const RtAccel *accel, RtDescription *out) {
    const RtKd *kd = (const RtKd *)accel;
    RtBoxSums sums = {.out = out};
    *out = (RtDescription){.bytes = kd->node_count * sizeof(RtKdNode) + kd->id_count * sizeof(uint32_t),
                           RT_NO_PREDICTION};
    each_box(accel, (RtBoxViewer){rt_box_sums_add, &sums});
    if (kd->node_count > 0) rt_box_sums_predict(&sums, &kd->box, kd->traversal_cost);
}

/* ---- validate ---- */

typedef struct Check {
    const RtKd *kd;
    RtError *error;
    uint64_t *listed; /* [object_count] leaves that list each object */
    uint8_t *reached; /* [node_count] whether it is the child of a visited node */
    uint32_t ids;     /* entries in the lists so far */
} Check;

#define BROKEN(check, ...) rt_fail((check)->error, RT_MISMATCH, "kd: " __VA_ARGS__)

static RtStatus check_leaf(Check *check, uint32_t index) {
    const RtKd *kd = check->kd;
    const RtKdNode *leaf = &kd->nodes[index];
    uint32_t length = rt_kd_length(leaf);
    if (leaf->first > kd->id_count || length > kd->id_count - leaf->first)
        return BROKEN(check, "the list of leaf %u lies outside the lists", index);
    const uint32_t *ids = kd->ids + leaf->first;
    for (uint32_t i = 0; i < length; i++) {
        if (ids[i] >= kd->base.scene->geometry.object_count || (i > 0 && ids[i - 1] >= ids[i]))
            return BROKEN(check, "the list of leaf %u is not ascending ids", index);
        check->listed[ids[i]]++;
    }
    check->ids += length;
    return RT_OK;
}

static RtStatus check_node(Check *check, uint32_t index, RtBox cell, uint32_t depth) {
    const RtKd *kd = check->kd;
    const RtKdNode *node = &kd->nodes[index];
    if (rt_kd_is_leaf(node)) return check_leaf(check, index);
    uint32_t child = rt_kd_child(node), axis = rt_kd_axis(node);
    if (child <= index || child >= kd->node_count - 1 || check->reached[child])
        return BROKEN(check, "the children of node %u lie outside the nodes", index);
    if (depth >= kd->max_depth)
        return BROKEN(check, "the children of node %u are deeper than %u", index, kd->max_depth);
    if (!(node->split >= cell.lo.at[axis] && node->split <= cell.hi.at[axis]))
        return BROKEN(check, "the split of node %u lies outside its cell", index);
    check->reached[child] = check->reached[child + 1] = 1;
    for (uint32_t c = 0; c < 2; c++)
        RT_TRY(check_node(check, child + c, rt_kd_half(cell, axis, node->split, c), depth + 1));
    return RT_OK;
}

static int by_id(const void *a, const void *b) {
    const uint32_t *x = a, *y = b;
    return *x < *y ? -1 : *x > *y;
}

static bool lists(const RtKd *kd, const RtKdNode *leaf, uint32_t id) {
    const size_t length = rt_kd_length(leaf);
    return length > 0 && bsearch(&id, kd->ids + leaf->first, length, sizeof id, by_id) != NULL;
}

/* Adds to *leaves the number of leaves below a node that must list an object with this part of its cell;
 * false if one of them does not list it. */
static bool listed_below(const RtKd *kd, uint32_t index, RtBox cell, uint32_t id, RtBox part,
                         uint64_t *leaves) {
    const RtKdNode *node = &kd->nodes[index];
    ++*leaves;
    if (rt_kd_is_leaf(node)) return lists(kd, node, id);
    --*leaves;
    uint32_t axis = rt_kd_axis(node);
    bool goes[2] = {part.lo.at[axis]<node->split, part.hi.at[axis]> node->split}, found[2];
    bool cut = goes[0] && goes[1], flat = !goes[0] && !goes[1];
    uint64_t count[2] = {0, 0};
    for (uint32_t c = 0; c < 2; c++) {
        RtBox half = rt_kd_half(cell, axis, node->split, c), inside = part;
        if (cut) goes[c] = rt_kd_part(kd, id, &half, &inside);
        found[c] = !(goes[c] || flat) || listed_below(kd, rt_kd_child(node) + c, half, id, inside, &count[c]);
        if (flat && !found[c]) count[c] = 0;
    }
    *leaves += flat && count[0] > 0 ? count[0] : count[0] + count[1];
    return flat ? found[0] || found[1] : found[0] && found[1];
}

static RtStatus validate(const RtAccel *accel, RtError *error) {
    const RtKd *kd = (const RtKd *)accel;
    const RtGeometry *g = &accel->scene->geometry;
    RT_ARENA(arena);
    if (kd->node_count == 0) return RT_OK;
    Check check = {.kd = kd,
                   .error = error,
                   .listed = rt_arena_alloc(&arena, g->object_count, sizeof(uint64_t)),
                   .reached = rt_arena_alloc(&arena, kd->node_count, 1)};
    RT_TRY(rt_arena_check(&arena, "validating a kd-tree", error));
    if (!rt_box_contains(kd->box, g->box)) return BROKEN(&check, "its root does not contain the scene");
    RT_TRY(check_node(&check, 0, kd->box, 0));
    for (uint32_t i = 1; i < kd->node_count; i++) {
        if (!check.reached[i]) return BROKEN(&check, "node %u has no parent", i);
    }
    if (check.ids != kd->id_count)
        return BROKEN(&check, "the lists of leaves hold %u ids, but the lists end at %u", check.ids,
                      kd->id_count);
    for (uint32_t id = 0; id < g->object_count; id++) {
        uint64_t leaves = 0;
        bool found = listed_below(kd, 0, kd->box, id, g->boxes[id], &leaves);
        if (found && leaves == check.listed[id]) continue;
        return BROKEN(&check, "%llu leaves list object %u, not just those it has a part in",
                      (unsigned long long)check.listed[id], id);
    }
    return RT_OK;
}

static void destroy(RtAccel *accel) {
    RtKd *kd = (RtKd *)accel;
    rt_free(kd->nodes);
    rt_free(kd->ids);
}

const RtAccelOps rt_kd_ops = {
    .name = "kd",
    .summary = "cells split at the plane of least expected cost, by the surface area heuristic",
    .paper =
        "Wald & Havran 2006, On building fast kd-trees for Ray Tracing, and on doing that in O(N log N), "
        "RT'06",
    RT_PARAMS_OF(rt_kd_params),
    RT_BEST("traversal_cost=1|0.3,overlap=box|exact"),
    .bytes = sizeof(RtKd),
    .build = rt_kd_build,
    .destroy = destroy,
    .kernels = &kernels,
    .describe = describe,
    .validate = validate,
    .each_box = each_box,
    .shows_lists = true,
};
