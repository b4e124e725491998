/* SPDX-License-Identifier: Apache-2.0 */
/* From a binary tree of references to the nodes that are traced: which subtrees become leaves, which nodes
 * are opened into their parent. */
#include "accel/tree/hierarchy.h"

#include "base/memory.h"

#include <assert.h>

typedef struct Layout {
    RtHierarchy *self;
    const RtTree *tree;
    bool *leaf; /* [tree->used] by node of the tree: it becomes a leaf, unless it lies below one */
} Layout;

/* What a subtree holds, and what it costs to trace: area times object tests and visits of inner nodes. */
typedef struct Weight {
    uint32_t references, leaves;
    double cost;
} Weight;

/* A subtree of few enough references becomes a leaf where that costs no more. */
static Weight weigh(Layout *layout, uint32_t index) {
    const RtTreeNode *node = &layout->tree->nodes[index];
    double area = rt_box_half_area(node->box);
    layout->leaf[index] = true;
    if (rt_tree_is_leaf(layout->tree, index)) return (Weight){1, 1, area};
    Weight left = weigh(layout, node->child[0]), right = weigh(layout, node->child[1]);
    Weight inner = {left.references + right.references, left.leaves + right.leaves,
                    layout->self->traversal_cost * area + left.cost + right.cost};
    Weight leaf = {inner.references, 1, area * inner.references};
    if (leaf.references <= layout->self->leaf_limit && leaf.cost <= inner.cost) return leaf;
    layout->leaf[index] = false;
    return inner;
}

/* The children of a wide node: the largest that is no leaf is opened in its place, until there are
 * `width`. */
static uint32_t open_children(const Layout *layout, uint32_t index, uint32_t *children) {
    const RtTreeNode *nodes = layout->tree->nodes;
    uint32_t count = 2;
    for (int s = 0; s < 2; s++) children[s] = nodes[index].child[s];
    while (count < layout->self->width) {
        uint32_t best = count;
        double most = -1;
        for (uint32_t i = 0; i < count; i++) {
            double area = rt_box_half_area(nodes[children[i]].box);
            if (layout->leaf[children[i]] || !(area > most)) continue;
            most = area;
            best = i;
        }
        if (best == count) break;
        const uint32_t *opened = nodes[children[best]].child;
        children[best] = opened[0];
        children[count++] = opened[1];
    }
    return count;
}

/* Appends the objects of a subtree to the leaf whose ids begin at `first`; parts of one object are one. */
static void append_ids(const Layout *layout, uint32_t first, uint32_t index) {
    RtHierarchy *self = layout->self;
    const uint32_t *child = layout->tree->nodes[index].child;
    if (rt_tree_is_leaf(layout->tree, index)) {
        for (uint32_t i = first; i < self->id_count && self->divided; i++) {
            if (self->ids[i] == child[1]) return;
        }
        self->ids[self->id_count++] = child[1];
        return;
    }
    for (int s = 0; s < 2; s++) append_ids(layout, first, child[s]);
}

static void place(const Layout *layout, uint32_t node_index, uint32_t index) {
    RtHierarchy *self = layout->self;
    RtNode *node = &self->nodes[node_index];
    node->box = layout->tree->nodes[index].box;
    if (layout->leaf[index]) {
        node->first = self->id_count;
        append_ids(layout, node->first, index);
        node->count = RT_NODE_LEAF | (self->id_count - node->first);
        return;
    }
    uint32_t children[RT_NODE_MAX_WIDTH];
    node->count = open_children(layout, index, children);
    node->first = self->node_count;
    self->node_count += node->count;
    for (uint32_t i = 0; i < node->count; i++) place(layout, node->first + i, children[i]);
}

RtStatus rt_hierarchy_lay_out(RtHierarchy *self, RtTree *tree, RtError *error) {
    assert(self->width >= 2 && self->width <= RT_NODE_MAX_WIDTH);
    RT_TRY(rt_tree_limit_depth(tree, error));
    Layout layout = {self, tree, rt_alloc(tree->used, sizeof(bool))};
    if (!layout.leaf) return rt_fail_memory(error, "the leaves of a hierarchy", tree->used * sizeof(bool));
    Weight whole = weigh(&layout, tree->root);
    size_t most = 2 * (size_t)whole.leaves - 1;
    self->nodes = rt_alloc(most, sizeof(RtNode));
    self->ids = rt_alloc(whole.references, sizeof(uint32_t));
    bool enough = self->nodes && self->ids;
    self->node_count = 1;
    self->id_count = 0;
    self->divided = tree->divided;
    if (enough) place(&layout, 0, tree->root);
    rt_free(layout.leaf);
    if (enough) return RT_OK;
    rt_hierarchy_clear(self);
    return rt_fail_memory(error, "the nodes of a hierarchy",
                          most * sizeof(RtNode) + whole.references * sizeof(uint32_t));
}

void rt_hierarchy_clear(RtHierarchy *self) {
    rt_free(self->nodes);
    rt_free(self->ids);
    self->nodes = NULL;
    self->ids = NULL;
    self->node_count = self->id_count = 0;
}
