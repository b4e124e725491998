/* SPDX-License-Identifier: Apache-2.0 */
/* Describing, validating and drawing an octree. */
#include "accel/octree/octree.h"

#include "core/base/memory.h"

/* Parents come before their children, so this ends. */
static uint32_t depth_of(const RtOctree *tree, uint32_t index) {
    uint32_t depth = 0;
    for (; index > 0; index = tree->nodes[index].parent) depth++;
    return depth;
}

/* Expected steps of traversal=neighbours into a leaf and out of it, times twice the half area of the root. A
 * line enters or leaves through a face with the ratio of areas: it walks down from the node that is divided
 * there to the leaf, and up again. Through a face of the root it starts at the root, or leaves once it has
 * climbed there. */
static double seeking_steps(const RtOctree *tree, uint32_t leaf) {
    const RtVec3 size = rt_box_size(tree->boxes[leaf]);
    const double face[3] = {(double)size.y * size.z, (double)size.z * size.x, (double)size.x * size.y};
    bool sought[3][2] = {{false}};
    double steps = 0, open = 2 * (face[0] + face[1] + face[2]);
    double climbed = 1;
    for (uint32_t at = leaf; at > 0; at = tree->nodes[at].parent, climbed++) {
        for (int a = 0; a < 3; a++) {
            bool *side = &sought[a][rt_octree_octant(at) >> a & 1 ? 0 : 1];
            if (*side) continue;
            *side = true;
            steps += 2 * climbed * face[a];
            open -= face[a];
        }
    }
    return steps + (2 * climbed - 1) * open; /* climbed: depth + 1 */
}

/* A line meets a node with the ratio of areas, and then takes the steps that lead there. */
static double steps_to(const RtOctree *tree, uint32_t index) {
    double area = rt_box_half_area(tree->boxes[index]);
    if (tree->traversal == RT_OCTREE_PARAMETRIC) return area;
    if (rt_octree_is_inner(&tree->nodes[index])) return 0;
    return tree->traversal == RT_OCTREE_POINTS ? area * (depth_of(tree, index) + 1)
                                               : seeking_steps(tree, index) / 2;
}

void rt_octree_each_box(const RtAccel *accel, RtBoxViewer viewer) {
    const RtOctree *tree = (const RtOctree *)accel;
    uint32_t depth = 0, end = 1, next = 1; /* of the level, of the next one */
    for (uint32_t i = 0; i < tree->node_count; i++) {
        const RtOctreeNode *node = &tree->nodes[i];
        bool leaf = !rt_octree_is_inner(node);
        if (i == end) depth++, end = next;
        if (!leaf) next = node->first + 8;
        viewer.show(viewer.context, &(RtBoxView){.box = &tree->boxes[i],
                                                 .depth = depth,
                                                 .leaf = leaf,
                                                 .objects = leaf ? node->count : 0});
    }
}

void rt_octree_describe(const RtAccel *accel, RtDescription *out) {
    const RtOctree *tree = (const RtOctree *)accel;
    RtBoxSums sums = {.out = out};
    *out =
        (RtDescription){.bytes = tree->node_count * RT_OCTREE_NODE_BYTES + tree->id_count * sizeof(uint32_t),
                        RT_NO_PREDICTION};
    if (tree->node_count == 0) return;
    double steps = 0, area = rt_box_half_area(tree->boxes[0]);
    rt_octree_each_box(accel, (RtBoxViewer){rt_box_sums_add, &sums});
    rt_box_sums_predict(&sums, &tree->boxes[0], 0);
    for (uint32_t i = 0; i < tree->node_count; i++) steps += steps_to(tree, i);
    if (area > 0) out->predicted_steps = steps / area;
}

/* ---- validate ---- */

typedef struct Check {
    const RtOctree *tree;
    const RtGeometry *geometry;
    RtError *error;
    uint64_t *listed; /* [object_count] leaves that list each object */
} Check;

#define BROKEN(check, ...) rt_fail((check)->error, RT_MISMATCH, "octree: " __VA_ARGS__)

/* A node other than the root: its parent, its cell, its depth. */
static RtStatus check_place(const Check *check, uint32_t index) {
    const RtOctree *tree = check->tree;
    uint32_t parent = tree->nodes[index].parent;
    const RtOctreeNode *above = &tree->nodes[parent];
    if (parent >= index || !rt_octree_is_inner(above) || above->first != index - rt_octree_octant(index))
        return BROKEN(check, "node %u is not a child of its parent", index);
    RtBox cell = rt_octree_child_box(tree->boxes[parent], above->split, rt_octree_octant(index));
    if (!rt_box_equals(cell, tree->boxes[index]))
        return BROKEN(check, "the cell of node %u is not cut from its parent's", index);
    if (depth_of(tree, index) > tree->max_depth)
        return BROKEN(check, "node %u is deeper than %u", index, tree->max_depth);
    return RT_OK;
}

static RtStatus check_inner(const Check *check, uint32_t index) {
    const RtOctree *tree = check->tree;
    const RtOctreeNode *node = &tree->nodes[index];
    const RtBox *cell = &tree->boxes[index];
    if (node->first <= index || rt_octree_octant(node->first) != 0 || node->first > tree->node_count - 8)
        return BROKEN(check, "the children of node %u lie outside the nodes", index);
    for (int a = 0; a < 3; a++) {
        float split = node->split.at[a];
        if ((split > cell->lo.at[a] && split < cell->hi.at[a]) || split == cell->hi.at[a]) continue;
        return BROKEN(check, "the split of node %u lies outside its cell", index);
    }
    for (uint32_t octant = 0; octant < 8; octant++) {
        const RtOctreeNode *child = &tree->nodes[node->first + octant];
        if (child->parent != index)
            return BROKEN(check, "node %u is not a child of its parent", node->first + octant);
        if ((node->count >> octant & 1) != (child->count == 0))
            return BROKEN(check, "node %u is not as empty as its parent says", node->first + octant);
    }
    return RT_OK;
}

static RtStatus check_list(const Check *check, uint32_t index) {
    const RtOctree *tree = check->tree;
    const RtOctreeNode *leaf = &tree->nodes[index];
    const RtGeometry *g = check->geometry;
    if (leaf->first > tree->id_count || leaf->count > tree->id_count - leaf->first)
        return BROKEN(check, "the list of leaf %u lies outside the lists", index);
    const uint32_t *ids = tree->ids + leaf->first;
    for (uint32_t i = 0; i < leaf->count; i++) {
        if (ids[i] >= g->object_count || (i > 0 && ids[i - 1] >= ids[i]))
            return BROKEN(check, "the list of leaf %u is not ascending ids", index);
        RtBox object = rt_octree_grown(tree, g->boxes[ids[i]]);
        if (rt_box_is_empty(rt_box_common(tree->boxes[index], object)))
            return BROKEN(check, "leaf %u lists object %u, which it does not touch", index, ids[i]);
        check->listed[ids[i]]++;
    }
    if (leaf->count > tree->max_leaf_size && depth_of(tree, index) < tree->max_depth &&
        rt_octree_divisible(tree, g->boxes, &tree->boxes[index], ids, leaf->count))
        return BROKEN(check, "leaf %u holds %u objects and could be divided", index, leaf->count);
    return RT_OK;
}

/* Leaves that must list an object with this box. */
static uint64_t leaves_touched(const RtOctree *tree, uint32_t index, const RtBox *object) {
    const RtOctreeNode *node = &tree->nodes[index];
    if (!rt_octree_is_inner(node)) return 1;
    uint32_t children = rt_octree_sides(&tree->boxes[index], node->split, object);
    uint64_t touched = 0;
    for (uint32_t octant = 0; octant < 8; octant++)
        if (children >> octant & 1) touched += leaves_touched(tree, node->first + octant, object);
    return touched;
}

static RtStatus check_all(const Check *check) {
    const RtOctree *tree = check->tree;
    for (uint32_t i = 0; i < tree->node_count; i++) {
        if (i > 0) RT_TRY(check_place(check, i));
        bool leaf = !rt_octree_is_inner(&tree->nodes[i]);
        RT_TRY(leaf ? check_list(check, i) : check_inner(check, i));
    }
    for (uint32_t id = 0; id < check->geometry->object_count; id++) {
        RtBox object = rt_octree_grown(tree, check->geometry->boxes[id]);
        uint64_t touched = leaves_touched(tree, 0, &object);
        if (check->listed[id] == touched) continue;
        return BROKEN(check, "object %u belongs to %llu leaves, but %llu list it", id,
                      (unsigned long long)touched, (unsigned long long)check->listed[id]);
    }
    return RT_OK;
}

RtStatus rt_octree_validate(const RtAccel *accel, RtError *error) {
    const RtOctree *tree = (const RtOctree *)accel;
    const RtGeometry *g = &accel->scene->geometry;
    if (tree->node_count == 0) return RT_OK;
    if (!rt_box_contains(tree->boxes[0], g->box))
        return rt_fail(error, RT_MISMATCH, "octree: its root does not contain the scene");
    Check check = {tree, g, error, rt_alloc(g->object_count, sizeof(uint64_t))};
    if (!check.listed)
        return rt_fail_memory(error, "validating an octree", g->object_count * sizeof(uint64_t));
    RtStatus status = check_all(&check);
    rt_free(check.listed);
    return status;
}
