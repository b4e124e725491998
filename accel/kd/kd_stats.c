/* SPDX-License-Identifier: Apache-2.0 */
/* Describing, validating and drawing a kd-tree. Cells are not stored, but cut from the root's on the way
 * down. */
#include "accel/kd/kd.h"

#include "core/base/memory.h"

/* Calls visit for each node with its cell and depth, parents first, until it returns a status other than
 * RT_OK. In a broken tree, `visit` must reject children that come before their parents and nodes deeper than
 * RT_KD_DEPTH_LIMIT. */
typedef struct CellView {
    uint32_t node, depth;
    RtBox cell;
} CellView;

static RtStatus each_node(const RtKd *kd,
                          RtStatus (*visit)(void *context, const RtKd *kd, const CellView *view),
                          void *context) {
    CellView stack[RT_KD_DEPTH_LIMIT + 2];
    uint32_t stacked = 0;
    if (kd->node_count > 0) stack[stacked++] = (CellView){0, 0, kd->box};
    while (stacked > 0) {
        CellView view = stack[--stacked];
        const RtKdNode *node = &kd->nodes[view.node];
        RT_TRY(visit(context, kd, &view));
        if (rt_kd_is_leaf(node)) continue;
        for (uint32_t c = 2; c-- > 0;) {
            RtBox half = rt_kd_half(view.cell, rt_kd_axis(node), node->split, c);
            stack[stacked++] = (CellView){rt_kd_child(node) + c, view.depth + 1, half};
        }
    }
    return RT_OK;
}

/* ---- boxes ---- */

static RtStatus show_node(void *context, const RtKd *kd, const CellView *view) {
    const RtBoxViewer *viewer = context;
    const RtKdNode *node = &kd->nodes[view->node];
    bool leaf = rt_kd_is_leaf(node);
    viewer->show(viewer->context, &(RtBoxView){.box = &view->cell,
                                               .depth = view->depth,
                                               .leaf = leaf,
                                               .objects = leaf ? rt_kd_length(node) : 0});
    return RT_OK;
}

void rt_kd_each_box(const RtAccel *accel, RtBoxViewer viewer) {
    each_node((const RtKd *)accel, show_node, &viewer);
}

void rt_kd_describe(const RtAccel *accel, RtDescription *out) {
    const RtKd *kd = (const RtKd *)accel;
    RtBoxSums sums = {.out = out};
    *out = (RtDescription){.bytes = kd->node_count * sizeof(RtKdNode) + kd->id_count * sizeof(uint32_t),
                           RT_NO_PREDICTION};
    rt_kd_each_box(accel, (RtBoxViewer){rt_box_sums_add, &sums});
    if (kd->node_count > 0) rt_box_sums_predict(&sums, &kd->box, kd->traversal_cost);
}

/* ---- validate ---- */

typedef struct Check {
    RtError *error;
    uint64_t *listed; /* [object_count] leaves that list each object */
    uint8_t *reached; /* [node_count] whether it is the child of a visited node */
    uint32_t ids;     /* entries in the lists so far */
} Check;

#define BROKEN(check, ...) rt_fail((check)->error, RT_MISMATCH, "kd: " __VA_ARGS__)

static RtStatus check_inner(const Check *check, const RtKd *kd, const CellView *view) {
    const RtKdNode *node = &kd->nodes[view->node];
    uint32_t child = rt_kd_child(node), axis = rt_kd_axis(node);
    if (child <= view->node || child >= kd->node_count - 1 || check->reached[child])
        return BROKEN(check, "the children of node %u lie outside the nodes", view->node);
    if (view->depth >= kd->max_depth)
        return BROKEN(check, "the children of node %u are deeper than %u", view->node, kd->max_depth);
    if (!(node->split >= view->cell.lo.at[axis] && node->split <= view->cell.hi.at[axis]))
        return BROKEN(check, "the split of node %u lies outside its cell", view->node);
    check->reached[child] = check->reached[child + 1] = 1;
    return RT_OK;
}

static RtStatus check_leaf(Check *check, const RtKd *kd, const CellView *view) {
    const RtGeometry *g = &kd->base.scene->geometry;
    const RtKdNode *leaf = &kd->nodes[view->node];
    uint32_t length = rt_kd_length(leaf);
    if (leaf->first > kd->id_count || length > kd->id_count - leaf->first)
        return BROKEN(check, "the list of leaf %u lies outside the lists", view->node);
    const uint32_t *ids = kd->ids + leaf->first;
    for (uint32_t i = 0; i < length; i++) {
        if (ids[i] >= g->object_count || (i > 0 && ids[i - 1] >= ids[i]))
            return BROKEN(check, "the list of leaf %u is not ascending ids", view->node);
        check->listed[ids[i]]++;
    }
    check->ids += length;
    return RT_OK;
}

static RtStatus check_node(void *context, const RtKd *kd, const CellView *view) {
    Check *check = context;
    return rt_kd_is_leaf(&kd->nodes[view->node]) ? check_leaf(check, kd, view) : check_inner(check, kd, view);
}

static bool lists(const RtKd *kd, const RtKdNode *leaf, uint32_t id) {
    uint32_t from = leaf->first, to = leaf->first + rt_kd_length(leaf);
    while (from < to) {
        uint32_t middle = from + (to - from) / 2;
        if (kd->ids[middle] == id) return true;
        if (kd->ids[middle] < id)
            from = middle + 1;
        else
            to = middle;
    }
    return false;
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

static RtStatus check_all(Check *check, const RtKd *kd) {
    const RtGeometry *g = &kd->base.scene->geometry;
    RT_TRY(each_node(kd, check_node, check));
    for (uint32_t i = 1; i < kd->node_count; i++) {
        if (check->reached[i]) continue;
        return BROKEN(check, "node %u has no parent", i);
    }
    if (check->ids != kd->id_count)
        return BROKEN(check, "the lists of leaves hold %u ids, but the lists end at %u", check->ids,
                      kd->id_count);
    for (uint32_t id = 0; id < g->object_count; id++) {
        uint64_t leaves = 0;
        bool found = listed_below(kd, 0, kd->box, id, g->boxes[id], &leaves);
        if (found && leaves == check->listed[id]) continue;
        return BROKEN(check, "%llu leaves list object %u, not just those it has a part in",
                      (unsigned long long)check->listed[id], id);
    }
    return RT_OK;
}

RtStatus rt_kd_validate(const RtAccel *accel, RtError *error) {
    const RtKd *kd = (const RtKd *)accel;
    const RtGeometry *g = &accel->scene->geometry;
    if (kd->node_count == 0) return RT_OK;
    if (!rt_box_contains(kd->box, g->box))
        return rt_fail(error, RT_MISMATCH, "kd: its root does not contain the scene");
    Check check = {.error = error,
                   .listed = rt_alloc(g->object_count, sizeof(uint64_t)),
                   .reached = rt_alloc(kd->node_count, 1)};
    RtStatus status = check.listed && check.reached
                          ? check_all(&check, kd)
                          : rt_fail_memory(error, "validating a kd-tree", g->object_count * sizeof(uint64_t));
    rt_free(check.listed);
    rt_free(check.reached);
    return status;
}

/* ---- one cell ---- */

typedef struct Sought {
    uint32_t node;
    RtBox cell;
} Sought;

static RtStatus compare_node(void *context, const RtKd *kd, const CellView *view) {
    (void)kd;
    Sought *sought = context;
    if (view->node == sought->node) sought->cell = view->cell;
    return RT_OK;
}

/* Descends by the numbers of nodes: where a subtree's nodes are adjacent, a node is below the child whose own
 * children come last before it. Returns false where they are not. */
static bool descend_to(const RtKd *kd, Sought *sought) {
    uint32_t at = 0;
    sought->cell = kd->box;
    while (at != sought->node) {
        const RtKdNode *node = &kd->nodes[at];
        if (rt_kd_is_leaf(node)) return false;
        const uint32_t lower = rt_kd_child(node);
        uint32_t next = lower, least = 0;
        for (uint32_t c = 0; c < 2; c++) {
            const RtKdNode *child = &kd->nodes[lower + c];
            const uint32_t below = rt_kd_is_leaf(child) ? 0 : rt_kd_child(child);
            if (lower + c == sought->node) {
                next = lower + c;
                break;
            }
            if (below > sought->node || below <= least) continue;
            next = lower + c;
            least = below;
        }
        sought->cell = rt_kd_half(sought->cell, rt_kd_axis(node), node->split, next - lower);
        at = next;
    }
    return true;
}

RtBox rt_kd_cell(const RtKd *kd, uint32_t node) {
    Sought sought = {node, RT_EMPTY_BOX};
    if (!descend_to(kd, &sought)) each_node(kd, compare_node, &sought);
    return sought.cell;
}
