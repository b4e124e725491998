/* SPDX-License-Identifier: Apache-2.0 */
#include "accel/tree/subtree.h"

#include "accel/tree/few.h"

static RtBox4 set_leaf(const RtSubtreeBuilder *b, uint32_t node, const RtTreeRef *ref) {
    rt_tree_set_leaf(b->tree, node, ref->box, ref->id);
    return rt_box4_load(&ref->box);
}

RtBox4 rt_subtree_unite(const RtSubtreeBuilder *b, uint32_t node, uint32_t left, const RtBox4 box[2]) {
    RtTreeNode *at = &b->tree->nodes[node];
    RtBox4 both = rt_box4_union(box[0], box[1]);
    rt_box4_store(&at->box, both);
    at->child[0] = node + 1;
    at->child[1] = node + 2 * left;
    return both;
}

static RtBox4 build_sides(const RtSubtreeBuilder *b, const RtRefGroup *group, uint32_t left,
                          const RtBox4 centers[2]) {
    RtRefGroup sides[2];
    RtBox4 box[2];
    rt_group_sides(group, left, centers, sides);
    for (int s = 0; s < 2; s++) box[s] = rt_subtree_build(b, sides[s]);
    return rt_subtree_unite(b, group->node, left, box);
}

static RtBox4 build_halves(const RtSubtreeBuilder *b, const RtRefGroup *group) {
    uint32_t left = rt_split_median(group->refs, group->count);
    RtBox4 centers[2] = {rt_refs_centers(group->refs, left),
                         rt_refs_centers(group->refs + left, group->count - left)};
    return build_sides(b, group, left, centers);
}

/* Those at places begin..begin + count of all three orders. */
static RtBox4 build_few(const RtSubtreeBuilder *b, RtFew *few, uint32_t begin, uint32_t count, uint32_t node,
                        int depth) {
    if (count == 1) return set_leaf(b, node, &few->refs[few->order[0][begin]]);
    RtSplit split = {.cost = INFINITY};
    if (depth < RT_TREE_MEDIAN_DEPTH) split = rt_few_split(few, begin, count);
    if (!(split.cost < INFINITY)) {
        RtTreeRef refs[RT_MAX_BINS];
        for (uint32_t i = 0; i < count; i++) refs[i] = few->refs[few->order[0][begin + i]];
        RtRefGroup group = {refs, count, node, depth, rt_box4_empty()};
        return build_halves(b, &group);
    }
    rt_few_part(few, begin, count, &split);
    RtBox4 box[2] = {
        build_few(b, few, begin, split.left, node + 1, depth + 1),
        build_few(b, few, begin + split.left, count - split.left, node + 2 * split.left, depth + 1)};
    return rt_subtree_unite(b, node, split.left, box);
}

RtBox4 rt_subtree_build(const RtSubtreeBuilder *b, RtRefGroup group) {
    if (group.count == 1) return set_leaf(b, group.node, group.refs);
    if (b->bins == 0 || group.depth >= RT_TREE_MEDIAN_DEPTH) return build_halves(b, &group);
    if (group.count <= (uint32_t)b->bins) {
        RtFew few;
        rt_few_init(&few, group.refs, group.count);
        return build_few(b, &few, 0, group.count, group.node, group.depth);
    }
    RtBox4 centers[2];
    uint32_t left = rt_split_binned(group.refs, group.count, b->bins, group.centers, centers);
    return left > 0 ? build_sides(b, &group, left, centers) : build_halves(b, &group);
}
