/* SPDX-License-Identifier: Apache-2.0 */
/* Describing, showing and validating hierarchies. */
#include "accel/tree/hierarchy.h"

#include "core/base/memory.h"

static void show_node(const RtHierarchy *self, const struct RtExtentSet *extents, uint32_t index,
                      uint32_t depth, RtBoxViewer viewer) {
    const RtNode *node = &self->nodes[index];
    uint32_t fanout = rt_node_fanout(node);
    bool leaf = rt_node_is_leaf(node);
    viewer.show(viewer.context,
                &(RtBoxView){&node->box, depth, leaf, extents, index, .objects = leaf ? fanout : 0});
    for (uint32_t i = 0; i < fanout && !leaf; i++)
        show_node(self, extents, node->first + i, depth + 1, viewer);
}

void rt_hierarchy_each_box(const RtHierarchy *self, const struct RtExtentSet *extents, RtBoxViewer viewer) {
    if (self->node_count > 0) show_node(self, extents, 0, 0, viewer);
}

void rt_hierarchy_describe(const RtHierarchy *self, const RtGeometry *geometry, RtDescription *out) {
    RtBoxSums sums = {.out = out};
    *out = (RtDescription){.bytes = self->node_count * sizeof(RtNode) + self->id_count * sizeof(uint32_t),
                           RT_NO_PREDICTION};
    if (self->node_count == 0) return;
    rt_hierarchy_each_box(self, NULL, (RtBoxViewer){rt_box_sums_add, &sums});
    rt_hierarchy_measure(self, geometry, out);
    rt_box_sums_predict(&sums, &self->nodes[0].box, self->traversal_cost);
}

/* ---- checking ---- */

typedef struct Check {
    const RtHierarchy *self;
    const RtGeometry *geometry;
    const char *name;
    RtError *error;
    uint32_t *seen;   /* [objects] how often each is in a leaf */
    uint32_t reached; /* nodes */
    uint32_t ended;   /* where the ids of the leaves so far end */
} Check;

#define BROKEN(check, what, ...) rt_fail((check)->error, RT_MISMATCH, "%s: " what, (check)->name, __VA_ARGS__)

static RtStatus check_leaf(Check *check, uint32_t index) {
    const RtHierarchy *self = check->self;
    const RtNode *node = &self->nodes[index];
    uint64_t end = (uint64_t)node->first + rt_node_fanout(node);
    for (uint64_t i = node->first; i < end; i++) {
        uint32_t id = i < self->id_count ? self->ids[i] : RT_NO_OBJECT;
        if (id >= check->geometry->object_count) return BROKEN(check, "leaf %u holds no object", index);
        check->seen[id]++;
        for (uint64_t j = node->first; j < i && self->split_refs; j++) {
            if (self->ids[j] != id) continue;
            return BROKEN(check, "object %u is in leaf %u twice", id, index);
        }
        if (self->split_refs || rt_box_contains(node->box, check->geometry->boxes[id])) continue;
        return BROKEN(check, "leaf %u does not contain its object %u", index, id);
    }
    if (node->first != check->ended)
        return BROKEN(check, "the ids of leaf %u begin at %u, not at %u", index, node->first, check->ended);
    check->ended += rt_node_fanout(node);
    return RT_OK;
}

static RtStatus check_node(Check *check, uint32_t index, uint32_t depth) {
    const RtHierarchy *self = check->self;
    const RtNode *node = &self->nodes[index];
    uint32_t fanout = rt_node_fanout(node), first = node->first;
    bool leaf = rt_node_is_leaf(node);
    if (depth > RT_TREE_MAX_DEPTH) return BROKEN(check, "node %u is too deep", index);
    if (++check->reached > self->node_count) return BROKEN(check, "node %u has two parents", index);
    uint32_t least = leaf ? 1 : 2, most = leaf ? self->leaf_limit : self->width;
    if (fanout < least || fanout > most)
        return BROKEN(check, "node %u has %u %s, not %u to %u", index, fanout, leaf ? "objects" : "children",
                      least, most);
    if (leaf) return check_leaf(check, index);
    if (first <= index || (uint64_t)first + fanout > self->node_count)
        return BROKEN(check, "node %u has children that are not there", index);
    for (uint32_t child = first; child < first + fanout; child++) {
        RT_TRY(check_node(check, child, depth + 1));
        if (rt_box_contains(node->box, self->nodes[child].box)) continue;
        return BROKEN(check, "node %u does not contain its child %u", index, child);
    }
    return RT_OK;
}

static RtStatus check_all(Check *check) {
    uint32_t node_count = check->self->node_count;
    RT_TRY(check_node(check, 0, 0));
    for (uint32_t id = 0; id < check->geometry->object_count; id++) {
        if (check->seen[id] == 1 || (check->self->split_refs && check->seen[id] > 1)) continue;
        return BROKEN(check, "object %u is in %u leaves, not in one", id, check->seen[id]);
    }
    if (check->reached == node_count) return RT_OK;
    return BROKEN(check, "%u of %u nodes are in the tree", check->reached, node_count);
}

RtStatus rt_hierarchy_validate(const RtHierarchy *self, const RtGeometry *geometry, const char *name,
                               RtError *error) {
    uint32_t count = geometry->object_count;
    if (count == 0) return RT_OK;
    Check check = {self, geometry, name, error, rt_alloc(count, sizeof(uint32_t)), 0, 0};
    if (!check.seen) return rt_fail_memory(error, "validating a hierarchy", count * sizeof(uint32_t));
    RtStatus status = check_all(&check);
    rt_free(check.seen);
    if (status == RT_OK && self->split_refs)
        status = rt_hierarchy_check_coverage(self, geometry, name, error);
    return status;
}
