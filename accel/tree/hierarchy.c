/* SPDX-License-Identifier: Apache-2.0 */
/* Laying out a binary tree of references for tracing: which subtrees become leaves, which nodes are replaced
 * by their children in their parent. */
#include "accel/tree/hierarchy.h"
#include "core/base/memory.h"
#include "core/base/parallel.h"

#include <assert.h>

/* The contents of a subtree, and its expected cost: area x (object tests + visits of inner nodes). */
typedef struct Cost {
    uint32_t references, leaves;
    double cost;
} Cost;

/* Numbers of nodes and ids in use. */
typedef struct Used {
    uint32_t nodes, ids;
} Used;

/* The place of a part in the hierarchy. */
typedef struct Part {
    uint32_t node; /* its root; unset if the part is inside a leaf */
    Used used;     /* before it */
    bool has_node;
} Part;

typedef struct Layout {
    RtHierarchy *self;
    const RtTree *tree;
    bool *leaf; /* [tree->used] the node becomes a leaf, or is below one */
    RtReducedParts reduced;
    Part *parts; /* [reduced.count] */
    uint32_t next;
} Layout;

static Cost cost_of_leaf(Layout *layout, uint32_t index) {
    layout->leaf[index] = true;
    return (Cost){1, 1, rt_box_half_area(layout->tree->nodes[index].box)};
}

/* A subtree of at most leaf_limit references becomes a leaf where that costs no more. */
static Cost cost_of_both(Layout *layout, uint32_t index, const Cost *left, const Cost *right) {
    double area = rt_box_half_area(layout->tree->nodes[index].box);
    Cost inner = {left->references + right->references, left->leaves + right->leaves,
                  layout->self->traversal_cost * area + left->cost + right->cost};
    Cost leaf = {inner.references, 1, area * inner.references};
    bool better = leaf.references <= layout->self->leaf_limit && leaf.cost <= inner.cost;
    layout->leaf[index] = better;
    return better ? leaf : inner;
}

static bool reduce_subtree(void *context, uint32_t index, uint32_t levels, void *value) {
    Layout *layout = context;
    if (rt_tree_is_leaf(layout->tree, index)) {
        *(Cost *)value = cost_of_leaf(layout, index);
        return true;
    }
    const uint32_t *child = layout->tree->nodes[index].child;
    Cost left, right;
    if (levels == 0 || !reduce_subtree(layout, child[0], levels - 1, &left) ||
        !reduce_subtree(layout, child[1], levels - 1, &right))
        return false;
    *(Cost *)value = cost_of_both(layout, index, &left, &right);
    return true;
}

static void combine_children(void *context, uint32_t index, const void *const children[2], void *value) {
    *(Cost *)value = cost_of_both(context, index, children[0], children[1]);
}

/* The children of a wide node: the largest inner one is replaced by its children, until there are `width`. */
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

/* Appends the objects of a subtree to the leaf whose ids begin at `first`, each object once. */
static void append_ids(const Layout *layout, uint32_t first, uint32_t index, Used *used) {
    RtHierarchy *self = layout->self;
    const uint32_t *child = layout->tree->nodes[index].child;
    if (rt_tree_is_leaf(layout->tree, index)) {
        for (uint32_t i = first; i < used->ids && self->split_refs; i++) {
            if (self->ids[i] == child[1]) return;
        }
        self->ids[used->ids++] = child[1];
        return;
    }
    for (int s = 0; s < 2; s++) append_ids(layout, first, child[s], used);
}

/* Makes a node and reserves its children, whose nodes of the tree go to children[..]; none of a leaf. */
static void lay_out_node(const Layout *layout, uint32_t node_index, uint32_t index, uint32_t *children,
                         Used *used) {
    RtNode *node = &layout->self->nodes[node_index];
    node->box = layout->tree->nodes[index].box;
    if (layout->leaf[index]) {
        node->first = used->ids;
        append_ids(layout, node->first, index, used);
        node->count = RT_NODE_LEAF | (used->ids - node->first);
        return;
    }
    node->count = open_children(layout, index, children);
    node->first = used->nodes;
    used->nodes += node->count;
}

/* Passes the parts below a node of the top. */
static void skip_parts(Layout *layout, uint32_t index, uint32_t depth) {
    const uint32_t *child = layout->tree->nodes[index].child;
    bool top = rt_reduction_is_top(layout->tree, index, depth);
    layout->next += !top;
    for (int s = 0; s < 2 && top; s++) skip_parts(layout, child[s], depth + 1);
}

/* Lays out the subtree of a node; if `top`, leaves out the parts, whose sizes are known: nodes are binary,
 * and no references split. */
static void lay_out_subtree(Layout *layout, uint32_t node_index, uint32_t index, bool top, uint32_t depth,
                            Used *used) {
    if (top && !rt_reduction_is_top(layout->tree, index, depth)) {
        const Cost *cost = (const Cost *)(const void *)layout->reduced.values + layout->next;
        layout->parts[layout->next++] = (Part){node_index, *used, true};
        used->nodes += 2 * cost->leaves - 2;
        used->ids += cost->references;
        return;
    }
    const RtNode *node = &layout->self->nodes[node_index];
    uint32_t children[RT_NODE_MAX_WIDTH] = {0};
    lay_out_node(layout, node_index, index, children, used);
    if (rt_node_is_leaf(node)) {
        if (top) skip_parts(layout, index, depth);
        return;
    }
    for (uint32_t i = 0; i < node->count; i++)
        lay_out_subtree(layout, node->first + i, children[i], top, depth + 1, used);
}

static void lay_out_part(void *context, size_t item) {
    Layout *layout = context;
    const Part *part = &layout->parts[item];
    Used used = part->used;
    if (part->has_node) lay_out_subtree(layout, part->node, layout->reduced.index[item], false, 0, &used);
}

/* Lays out a complete tree. */
static RtStatus lay_out(RtHierarchy *self, RtArena *memory, RtTree *tree, int threads, RtError *error) {
    RT_ARENA(arena);
    Layout layout = {.self = self,
                     .tree = tree,
                     .leaf = rt_arena_alloc_unset(&arena, tree->used, sizeof(bool)),
                     .parts = rt_arena_alloc(&arena, RT_REDUCTION_MAX_PARTS, sizeof(Part))};
    const RtReduction reduction = {sizeof(Cost), reduce_subtree, combine_children, &layout};
    Cost whole;
    assert(self->width >= 2 && self->width <= RT_NODE_MAX_WIDTH);
    RT_TRY(rt_arena_check(&arena, "the leaves of a hierarchy", error));
    RT_TRY(rt_tree_reduce(tree, &reduction, &arena, threads, &layout.reduced, &whole, error));
    self->nodes = rt_arena_alloc_unset(memory, 2 * (size_t)whole.leaves - 1, sizeof(RtNode));
    self->ids = rt_arena_alloc_unset(memory, whole.references, sizeof(uint32_t));
    self->split_refs = tree->split_refs;
    RT_TRY(rt_arena_check(memory, "the nodes of a hierarchy", error));
    const bool top = self->width == 2 && !self->split_refs;
    Used used = {1, 0};
    lay_out_subtree(&layout, 0, tree->root, top, 0, &used);
    if (top) RT_TRY(rt_parallel_each(layout.reduced.count, threads, lay_out_part, &layout, error));
    self->node_count = used.nodes;
    self->id_count = used.ids;
    return RT_OK;
}

RtStatus rt_hierarchy_build(RtHierarchy *self, RtArena *memory, const RtGeometry *geometry,
                            const RtTreeOptions *options, int threads, RtError *error) {
    RtTree tree;
    if (geometry->object_count == 0) return RT_OK;
    RT_TRY(rt_tree_build(&tree, geometry, options, threads, error));
    RtStatus status = lay_out(self, memory, &tree, threads, error);
    rt_tree_clear(&tree);
    return status;
}
