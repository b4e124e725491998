/* SPDX-License-Identifier: Apache-2.0 */
/* Describing, showing and validating hierarchies. */
#include "accel/tree/hierarchy.h"

#include "core/base/memory.h"
#include "core/shape/overlap.h"

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

/* ---- the coverage of objects ---- */

/* Checks whether the boxes of the leaves that list an object contain all of its surface. rt_object_part
 * computes the part of the surface in a box. If no single leaf contains that part, the box is split at a side
 * of a leaf that runs through it, recursively, until a leaf contains it or no side is left.
 *
 * The tree and this check clip boxes in different ways and round outward differently, so leaves are enlarged
 * here by a few roundings, less than the thickness of rays. */
typedef struct Parts {
    const RtHierarchy *self;
    const RtGeometry *geometry;
    uint32_t *first;  /* [objects + 1] where the leaves of each object begin */
    uint32_t *leaves; /* [ids] nodes, object after object */
    double margin;    /* for rt_object_part */
} Parts;

/* The side of a leaf that runs through `box` nearest to its middle; false if there is none. */
static bool find_side(const Parts *parts, const uint32_t *leaves, uint32_t count, const RtBox *box, int *axis,
                      float *at) {
    double least = INFINITY;
    for (uint32_t i = 0; i < count; i++) {
        const RtBox *leaf = &parts->self->nodes[leaves[i]].box;
        for (int side = 0; side < 6; side++) {
            int a = side % 3;
            float plane = side < 3 ? leaf->lo.at[a] : leaf->hi.at[a];
            double lo = (double)box->lo.at[a], hi = (double)box->hi.at[a];
            double off = fabs((double)plane - (lo + hi) / 2) / (hi - lo);
            if (!(plane > box->lo.at[a] && plane < box->hi.at[a]) || !(off < least)) continue;
            least = off;
            *axis = a;
            *at = plane;
        }
    }
    return least < INFINITY;
}

/* Whether leaves[0..count) contain the part of the object in `box`; reorders the leaves. */
static bool is_covered(const Parts *parts, uint32_t id, uint32_t *leaves, uint32_t count, RtBox box) {
    RtBox rest;
    if (!rt_object_part(parts->geometry, id, &box, parts->margin, &rest)) return true;
    uint32_t near = 0;
    for (uint32_t i = 0; i < count; i++) {
        RtBox leaf = parts->self->nodes[leaves[i]].box, wide = leaf;
        for (int a = 0; a < 3; a++) {
            float most = rt_maxf(fabsf(leaf.lo.at[a]), fabsf(leaf.hi.at[a])), slack = most * 0x1p-21f;
            wide.lo.at[a] -= slack;
            wide.hi.at[a] += slack;
        }
        if (rt_box_contains(wide, rest)) return true;
        if (rt_box_is_empty(rt_box_common(leaf, rest))) continue;
        uint32_t kept = leaves[i];
        leaves[i] = leaves[near];
        leaves[near++] = kept;
    }
    int axis = 0;
    float at = 0;
    if (!find_side(parts, leaves, near, &rest, &axis, &at)) return false;
    RtBox lower = rest, upper = rest;
    lower.hi.at[axis] = upper.lo.at[axis] = at;
    return is_covered(parts, id, leaves, near, lower) && is_covered(parts, id, leaves, near, upper);
}

/* Lists the leaves by object: count pass, fill pass. */
static void list_leaves(Parts *parts) {
    const RtHierarchy *self = parts->self;
    uint32_t objects = parts->geometry->object_count;
    for (uint32_t i = 0; i < self->id_count; i++) parts->first[self->ids[i] + 1]++;
    for (uint32_t id = 0; id < objects; id++) parts->first[id + 1] += parts->first[id];
    for (uint32_t n = 0; n < self->node_count; n++) {
        const RtNode *node = &self->nodes[n];
        for (uint32_t i = 0; i < rt_node_fanout(node) && rt_node_is_leaf(node); i++)
            parts->leaves[parts->first[self->ids[node->first + i]]++] = n;
    }
    for (uint32_t id = objects; id > 0; id--) parts->first[id] = parts->first[id - 1];
    parts->first[0] = 0;
}

static RtStatus check_coverage(const RtHierarchy *self, const RtGeometry *geometry, const char *name,
                               RtError *error) {
    uint32_t objects = geometry->object_count;
    Parts parts = {self, geometry, rt_alloc((size_t)objects + 1, sizeof(uint32_t)),
                   rt_alloc(self->id_count, sizeof(uint32_t)), rt_tree_part_margin(&geometry->box)};
    RtStatus status = RT_OK;
    if (parts.first && parts.leaves) {
        list_leaves(&parts);
        for (uint32_t id = 0; id < objects && status == RT_OK; id++) {
            uint32_t first = parts.first[id], count = parts.first[id + 1] - first;
            if (is_covered(&parts, id, parts.leaves + first, count, geometry->boxes[id])) continue;
            status = rt_fail(error, RT_MISMATCH, "%s: part of object %u is in none of its %u leaves", name,
                             id, count);
        }
    } else {
        status = rt_fail_memory(error, "the leaves of each object", self->id_count * sizeof(uint32_t));
    }
    rt_free(parts.first);
    rt_free(parts.leaves);
    return status;
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
    if (status == RT_OK && self->split_refs) status = check_coverage(self, geometry, name, error);
    return status;
}
