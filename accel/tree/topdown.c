/* SPDX-License-Identifier: Apache-2.0 */
/* Trees from the top: medians, or the surface area heuristic in bins. */
#include "accel/tree/split.h"
#include "accel/tree/tree.h"
#include "base/memory.h"

typedef struct Builder {
    RtTree *tree;
    int bins; /* 0: medians */
} Builder;

static uint32_t divide(const Builder *b, RtTreeRef *refs, uint32_t count, int depth) {
    uint32_t left = b->bins > 0 && depth < RT_TREE_MEDIAN_DEPTH ? rt_split_binned(refs, count, b->bins) : 0;
    return left > 0 ? left : rt_split_median(refs, count);
}

static uint32_t build(const Builder *b, RtTreeRef *refs, uint32_t count, int depth) {
    uint32_t node = rt_tree_take(b->tree);
    if (count == 1) {
        rt_tree_set_leaf(b->tree, node, refs[0].box, refs[0].id);
        return node;
    }
    uint32_t left = divide(b, refs, count, depth);
    uint32_t first = build(b, refs, left, depth + 1);
    rt_tree_set_union(b->tree, node, first, build(b, refs + left, count - left, depth + 1));
    return node;
}

RtStatus rt_tree_topdown(RtTree *tree, const RtBox *boxes, uint32_t count, int bins, RtError *error) {
    RT_TRY(rt_tree_init(tree, count, error));
    RtTreeRef *refs = rt_refs_new(boxes, count);
    if (refs) {
        Builder builder = {tree, bins};
        tree->root = build(&builder, refs, count, 0);
        rt_free(refs);
        return RT_OK;
    }
    rt_tree_clear(tree);
    return rt_fail_memory(error, "a tree from the top", count * sizeof(RtTreeRef));
}
