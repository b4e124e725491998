/* SPDX-License-Identifier: Apache-2.0 */
/* From a binary tree of references to the nodes that are traced: which subtrees become leaves, which nodes
 * are opened into their parent. */
#include "accel/tree/hierarchy.h"
#include "accel/tree/fold.h"
#include "core/base/memory.h"
#include "core/base/parallel.h"

#include <assert.h>

/* What a subtree holds, and what it costs to trace: area times object tests and visits of inner nodes. */
typedef struct Weight {
    uint32_t references, leaves;
    double cost;
} Weight;

/* Nodes and ids that are taken. */
typedef struct Taken {
    uint32_t nodes, ids;
} Taken;

/* Where a part of the tree goes. */
typedef struct Part {
    uint32_t node; /* its root; unset if it lies in a leaf */
    Taken taken;   /* what is taken before it */
    bool placed;
} Part;

typedef struct Layout {
    RtHierarchy *self;
    const RtTree *tree;
    bool *leaf; /* [tree->used] by node of the tree: it becomes a leaf, unless it lies below one */
    RtFoldParts weighed;
    Part *parts; /* [weighed.count] */
    uint32_t next;
} Layout;

static Weight weight_of_leaf(Layout *layout, uint32_t index) {
    layout->leaf[index] = true;
    return (Weight){1, 1, rt_box_half_area(layout->tree->nodes[index].box)};
}

/* A subtree of few enough references becomes a leaf where that costs no more. */
static Weight weight_of_both(Layout *layout, uint32_t index, const Weight *left, const Weight *right) {
    double area = rt_box_half_area(layout->tree->nodes[index].box);
    Weight inner = {left->references + right->references, left->leaves + right->leaves,
                    layout->self->traversal_cost * area + left->cost + right->cost};
    Weight leaf = {inner.references, 1, area * inner.references};
    bool better = leaf.references <= layout->self->leaf_limit && leaf.cost <= inner.cost;
    layout->leaf[index] = better;
    return better ? leaf : inner;
}

static bool weigh(Layout *layout, uint32_t index, uint32_t levels, Weight *weight) {
    if (rt_tree_is_leaf(layout->tree, index)) {
        *weight = weight_of_leaf(layout, index);
        return true;
    }
    const uint32_t *child = layout->tree->nodes[index].child;
    Weight left, right;
    if (levels == 0 || !weigh(layout, child[0], levels - 1, &left) ||
        !weigh(layout, child[1], levels - 1, &right))
        return false;
    *weight = weight_of_both(layout, index, &left, &right);
    return true;
}

static bool weigh_part(void *context, uint32_t index, uint32_t levels, void *weight) {
    return weigh(context, index, levels, weight);
}

static void weigh_node(void *context, uint32_t index, const void *const sides[2], void *weight) {
    *(Weight *)weight = weight_of_both(context, index, sides[0], sides[1]);
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
static void append_ids(const Layout *layout, uint32_t first, uint32_t index, Taken *taken) {
    RtHierarchy *self = layout->self;
    const uint32_t *child = layout->tree->nodes[index].child;
    if (rt_tree_is_leaf(layout->tree, index)) {
        for (uint32_t i = first; i < taken->ids && self->divided; i++) {
            if (self->ids[i] == child[1]) return;
        }
        self->ids[taken->ids++] = child[1];
        return;
    }
    for (int s = 0; s < 2; s++) append_ids(layout, first, child[s], taken);
}

/* Makes a node, and takes places for its children, which go to children[..]; none of a leaf. */
static void place_one(const Layout *layout, uint32_t node_index, uint32_t index, uint32_t *children,
                      Taken *taken) {
    RtNode *node = &layout->self->nodes[node_index];
    node->box = layout->tree->nodes[index].box;
    if (layout->leaf[index]) {
        node->first = taken->ids;
        append_ids(layout, node->first, index, taken);
        node->count = RT_NODE_LEAF | (taken->ids - node->first);
        return;
    }
    node->count = open_children(layout, index, children);
    node->first = taken->nodes;
    taken->nodes += node->count;
}

static void place(const Layout *layout, uint32_t node_index, uint32_t index, Taken *taken) {
    const RtNode *node = &layout->self->nodes[node_index];
    uint32_t children[RT_NODE_MAX_WIDTH] = {0};
    place_one(layout, node_index, index, children, taken);
    if (rt_node_is_leaf(node)) return;
    for (uint32_t i = 0; i < node->count; i++) place(layout, node->first + i, children[i], taken);
}

static RtStatus place_part(void *context, size_t item, int thread, RtError *error) {
    const Layout *layout = context;
    const Part *part = &layout->parts[item];
    Taken taken = part->taken;
    (void)thread;
    (void)error;
    if (part->placed) place(layout, part->node, layout->weighed.index[item], &taken);
    return RT_OK;
}

/* Passes by the parts of a subtree. */
static void skip_parts(Layout *layout, uint32_t index, uint32_t depth) {
    const uint32_t *child = layout->tree->nodes[index].child;
    if (!rt_fold_is_top(layout->tree, index, depth)) {
        layout->next++;
        return;
    }
    for (int s = 0; s < 2; s++) skip_parts(layout, child[s], depth + 1);
}

/* Of pairs, none of them divided: what the parts take is known before. */
static void place_top(Layout *layout, uint32_t node_index, uint32_t index, uint32_t depth, Taken *taken) {
    if (!rt_fold_is_top(layout->tree, index, depth)) {
        const Weight *weight = (const Weight *)(const void *)layout->weighed.weights + layout->next;
        Part *part = &layout->parts[layout->next++];
        part->node = node_index;
        part->taken = *taken;
        part->placed = true;
        taken->nodes += 2 * weight->leaves - 2;
        taken->ids += weight->references;
        return;
    }
    const RtNode *node = &layout->self->nodes[node_index];
    uint32_t children[RT_NODE_MAX_WIDTH] = {0};
    place_one(layout, node_index, index, children, taken);
    if (rt_node_is_leaf(node)) {
        skip_parts(layout, index, depth);
        return;
    }
    for (uint32_t i = 0; i < 2; i++) place_top(layout, node->first + i, children[i], depth + 1, taken);
}

static RtStatus place_all(Layout *layout, int threads, RtError *error) {
    RtHierarchy *self = layout->self;
    uint32_t root = layout->tree->root;
    Taken taken = {1, 0};
    if (self->width > 2 || self->divided) {
        place(layout, 0, root, &taken);
    } else {
        place_top(layout, 0, root, 0, &taken);
        RT_TRY(rt_parallel_for(layout->weighed.count, threads, place_part, layout, error));
    }
    self->node_count = taken.nodes;
    self->id_count = taken.ids;
    return RT_OK;
}

static RtStatus lay_out(Layout *layout, RtTree *tree, int threads, RtError *error) {
    RtHierarchy *self = layout->self;
    RtFold fold = {sizeof(Weight), weigh_part, weigh_node, layout};
    Weight whole;
    RT_TRY(rt_tree_fold(tree, &fold, threads, &layout->weighed, &whole, error));
    size_t most = 2 * (size_t)whole.leaves - 1;
    self->nodes = rt_alloc_unset(most, sizeof(RtNode));
    self->ids = rt_alloc_unset(whole.references, sizeof(uint32_t));
    self->divided = tree->divided;
    if (self->nodes && self->ids) return place_all(layout, threads, error);
    return rt_fail_memory(error, "the nodes of a hierarchy",
                          most * sizeof(RtNode) + whole.references * sizeof(uint32_t));
}

RtStatus rt_hierarchy_lay_out(RtHierarchy *self, RtTree *tree, int threads, RtError *error) {
    assert(self->width >= 2 && self->width <= RT_NODE_MAX_WIDTH);
    Layout layout = {.self = self,
                     .tree = tree,
                     .leaf = rt_alloc_unset(tree->used, sizeof(bool)),
                     .parts = rt_alloc(RT_FOLD_MAX_PARTS, sizeof(Part))};
    RtStatus status = layout.leaf && layout.parts
                          ? lay_out(&layout, tree, threads, error)
                          : rt_fail_memory(error, "the leaves of a hierarchy", tree->used * sizeof(bool));
    rt_free(layout.leaf);
    rt_free(layout.parts);
    rt_fold_parts_clear(&layout.weighed);
    if (status != RT_OK) rt_hierarchy_clear(self);
    return status;
}

void rt_hierarchy_clear(RtHierarchy *self) {
    rt_free(self->nodes);
    rt_free(self->ids);
    self->nodes = NULL;
    self->ids = NULL;
    self->node_count = self->id_count = 0;
}
