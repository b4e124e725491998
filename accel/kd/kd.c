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
#include "accel/mailbox.h"

/* A pending node, and the interval of t in which the ray is in its cell. */
typedef struct Span {
    uint32_t node;
    float enter, leave;
} Span;

RT_COLD static void observe_node(const RtKd *self, uint32_t index) {
    const RtKdNode *node = &self->nodes[index];
    RtBox cell = rt_kd_cell(self, index);
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
    RtMailbox *mailbox = self->mailbox ? scratch : NULL;
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

const RtAccelOps rt_kd_ops = {
    .name = "kd",
    .summary = "cells split at the plane of least expected cost, by the surface area heuristic",
    .paper =
        "Wald & Havran 2006, On building fast kd-trees for Ray Tracing, and on doing that in O(N log N), "
        "RT'06",
    RT_PARAMS_OF(rt_kd_params),
    .bytes = sizeof(RtKd),
    .build = rt_kd_build,
    .destroy = rt_kd_destroy,
    RT_KERNEL_OPS,
    .describe = rt_kd_describe,
    .validate = rt_kd_validate,
    .each_box = rt_kd_each_box,
    .shows_lists = true,
};
