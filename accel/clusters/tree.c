/* Binary trees of clusters, and the bound on their depth. */
#include "accel/clusters/tree.h"

#include "accel/split.h"
#include "base/memory.h"

#include <assert.h>

/* A subtree that hangs at MEDIAN_DEPTH is rebuilt if it is higher than what medians of 2^28 objects need. */
enum { MEDIAN_DEPTH = 34, MEDIAN_HEIGHT = 28 };

RtStatus rt_cluster_tree_init(RtClusterTree *tree, const RtBox *boxes, uint32_t count, RtError *error) {
    assert(count > 0);
    size_t most = 2 * (size_t)count - 1;
    *tree = (RtClusterTree){.clusters = rt_alloc(most, sizeof(RtCluster)), .count = count, .used = count};
    if (!tree->clusters) return rt_fail_memory(error, "clusters", most * sizeof(RtCluster));
    for (uint32_t i = 0; i < count; i++) tree->clusters[i].box = boxes[i];
    return RT_OK;
}

void rt_cluster_tree_clear(RtClusterTree *tree) {
    rt_free(tree->clusters);
    *tree = (RtClusterTree){.clusters = NULL};
}

static void set_union(RtClusterTree *tree, uint32_t cluster, uint32_t a, uint32_t b) {
    RtBox box = rt_box_union(tree->clusters[a].box, tree->clusters[b].box);
    tree->clusters[cluster] = (RtCluster){box, {a, b}};
}

uint32_t rt_cluster_unite(RtClusterTree *tree, uint32_t a, uint32_t b) {
    assert(tree->used < 2 * tree->count - 1);
    tree->root = tree->used++;
    set_union(tree, tree->root, a, b);
    return tree->root;
}

double rt_cluster_tree_cost(const RtClusterTree *tree) {
    double sum = 0;
    for (uint32_t i = tree->count; i < tree->used; i++) sum += rt_box_half_area(tree->clusters[i].box);
    return sum;
}

/* ---- depth ---- */

/* Makes `cluster` the union of ids[0..count), halved again and again; further unions are taken from `spare`.
 */
static void rebuild(RtClusterTree *tree, const RtBox *boxes, uint32_t cluster, uint32_t *ids, uint32_t count,
                    uint32_t **spare) {
    uint32_t left = rt_split_median(boxes, ids, count), sides[2];
    const uint32_t counts[2] = {left, count - left};
    for (int s = 0; s < 2; s++) {
        uint32_t *of_side = s == 0 ? ids : ids + left;
        sides[s] = counts[s] == 1 ? of_side[0] : *(*spare)++;
        if (counts[s] > 1) rebuild(tree, boxes, sides[s], of_side, counts[s], spare);
    }
    set_union(tree, cluster, sides[0], sides[1]);
}

/* The tree as a list: each cluster before its children, a subtree in one run. */
typedef struct Listing {
    uint32_t *order;         /* [used] clusters */
    uint32_t *depth, *stack; /* [used] by cluster; of clusters */
    uint32_t *height, *size; /* [used] by cluster: of its subtree, and how many clusters are in it */
    RtBox *boxes;            /* [count] of the objects */
} Listing;

static void list_clusters(const RtClusterTree *tree, Listing *list) {
    uint32_t stacked = 0, listed = 0;
    list->stack[stacked++] = tree->root;
    list->depth[tree->root] = 0;
    while (stacked > 0) {
        uint32_t at = list->stack[--stacked];
        list->order[listed++] = at;
        for (int s = 1; s >= 0 && !rt_cluster_is_object(tree, at); s--) {
            uint32_t child = tree->clusters[at].child[s];
            list->depth[child] = list->depth[at] + 1;
            list->stack[stacked++] = child;
        }
    }
    assert(listed == tree->used);
    for (uint32_t i = listed; i-- > 0;) {
        uint32_t at = list->order[i];
        const uint32_t *child = tree->clusters[at].child;
        list->height[at] = 0;
        list->size[at] = 1;
        for (int s = 0; s < 2 && !rt_cluster_is_object(tree, at); s++) {
            uint32_t height = list->height[child[s]] + 1;
            if (height > list->height[at]) list->height[at] = height;
            list->size[at] += list->size[child[s]];
        }
    }
}

/* Rebuilds the subtree that is listed from place `first` on. */
static void rebuild_run(RtClusterTree *tree, const Listing *list, uint32_t first) {
    uint32_t top = list->order[first], objects = 0, unions = 0;
    uint32_t *ids = list->stack, *spare = list->order + first;
    for (uint32_t i = first; i < first + list->size[top]; i++) {
        uint32_t at = list->order[i];
        if (rt_cluster_is_object(tree, at))
            ids[objects++] = at;
        else
            spare[unions++] = at;
    }
    spare++; /* the top itself */
    rebuild(tree, list->boxes, top, ids, objects, &spare);
}

RtStatus rt_cluster_tree_limit_depth(RtClusterTree *tree, RtError *error) {
    uint32_t used = tree->used;
    uint32_t *block = rt_alloc(used, 5 * sizeof(uint32_t));
    Listing list = {.boxes = rt_alloc(tree->count, sizeof(RtBox))};
    if (!block || !list.boxes) {
        rt_free(block);
        rt_free(list.boxes);
        return rt_fail_memory(error, "limiting the depth of clusters", used * sizeof(uint32_t) * 5);
    }
    list.order = block;
    list.depth = block + used;
    list.stack = list.depth + used;
    list.height = list.stack + used;
    list.size = list.height + used;
    for (uint32_t i = 0; i < tree->count; i++) list.boxes[i] = tree->clusters[i].box;
    list_clusters(tree, &list);
    for (uint32_t i = 0; i < used;) {
        uint32_t at = list.order[i];
        bool low = list.depth[at] == MEDIAN_DEPTH;
        uint32_t next = low ? i + list.size[at] : i + 1;
        if (low && list.height[at] > MEDIAN_HEIGHT) rebuild_run(tree, &list, i);
        i = next;
    }
    rt_free(block);
    rt_free(list.boxes);
    return RT_OK;
}
