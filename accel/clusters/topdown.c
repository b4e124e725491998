/* Clusters from the top: medians, or the surface area heuristic in bins as the yardstick of the others. */
#include "accel/clusters/tree.h"

#include "accel/split.h"
#include "base/memory.h"

/* From this depth on bins give way to medians, so that the recursion is bounded. */
enum { MEDIAN_DEPTH = 34 };

typedef struct Builder {
    RtClusterTree *tree;
    const RtBox *boxes; /* [count] */
    int bins;           /* 0: medians */
} Builder;

static uint32_t divide(const Builder *b, uint32_t *ids, uint32_t count, int depth) {
    if (b->bins > 0 && depth < MEDIAN_DEPTH) {
        RtSplit split = rt_split_find(b->boxes, ids, count, b->bins);
        if (split.cost < INFINITY) return rt_split_partition(&split, b->boxes, ids, count);
    }
    return rt_split_median(b->boxes, ids, count);
}

static uint32_t cluster_of(const Builder *b, uint32_t *ids, uint32_t count, int depth) {
    if (count == 1) return ids[0];
    uint32_t left = divide(b, ids, count, depth);
    uint32_t first = cluster_of(b, ids, left, depth + 1);
    return rt_cluster_unite(b->tree, first, cluster_of(b, ids + left, count - left, depth + 1));
}

RtStatus rt_cluster_topdown(RtClusterTree *tree, int bins, RtError *error) {
    RtBox *boxes = rt_alloc(tree->count, sizeof(RtBox));
    uint32_t *ids = rt_alloc(tree->count, sizeof(uint32_t));
    RtStatus status = RT_OK;
    if (boxes && ids) {
        for (uint32_t i = 0; i < tree->count; i++) {
            boxes[i] = tree->clusters[i].box;
            ids[i] = i;
        }
        Builder builder = {tree, boxes, bins};
        cluster_of(&builder, ids, tree->count, 0);
    } else {
        status = rt_fail_memory(error, "clusters from the top", tree->count * sizeof(RtBox));
    }
    rt_free(boxes);
    rt_free(ids);
    return status;
}
