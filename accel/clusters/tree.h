/* Binary trees of clusters: what every method of `clusters` makes, before nodes are laid out for tracing.
 *
 * Clusters 0..count-1 are the objects, by id; each later one is a union of two others. A tree is complete
 * when count - 1 unions have been made and `root` is the last one left. */
#ifndef RT_ACCEL_CLUSTERS_TREE_H
#define RT_ACCEL_CLUSTERS_TREE_H

#include "base/box.h"
#include "base/status.h"

#include <stdbool.h>
#include <stdint.h>

/* No leaf of a finished tree is deeper than this; the stacks of traversals rest on it. */
enum { RT_CLUSTER_MAX_DEPTH = 64 };

typedef struct RtCluster {
    RtBox box;
    uint32_t child[2]; /* of a union */
} RtCluster;

typedef struct RtClusterTree {
    RtCluster *clusters; /* [2 * count - 1] */
    uint32_t count;      /* objects, at least 1 */
    uint32_t used;       /* clusters there are */
    uint32_t root;
} RtClusterTree;

/* A tree of `count` objects with these boxes and no union yet; of one object it is complete. */
RtStatus rt_cluster_tree_init(RtClusterTree *tree, const RtBox *boxes, uint32_t count, RtError *error);
void rt_cluster_tree_clear(RtClusterTree *tree);

static inline bool rt_cluster_is_object(const RtClusterTree *tree, uint32_t cluster) {
    return cluster < tree->count;
}

/* Adds the union of clusters a and b, makes it the root, and gives its number. */
uint32_t rt_cluster_unite(RtClusterTree *tree, uint32_t a, uint32_t b);

/* The distance of two clusters: half the area of the box about both (Walter 2008). */
static inline double rt_cluster_distance(const RtClusterTree *tree, uint32_t a, uint32_t b) {
    return rt_box_half_area(rt_box_union(tree->clusters[a].box, tree->clusters[b].box));
}

/* Sum of the half areas of all unions: the surface area heuristic up to constants. */
double rt_cluster_tree_cost(const RtClusterTree *tree);

/* Rebuilds by medians whatever hangs so low that a leaf is deeper than RT_CLUSTER_MAX_DEPTH allows. */
RtStatus rt_cluster_tree_limit_depth(RtClusterTree *tree, RtError *error);

/* ---- the methods: each completes a tree; the result is a function of its arguments alone ---- */

/* Walter, Bala, Kulkarni & Pingali 2008: the two nearest clusters are united, until one is left. */
RtStatus rt_cluster_agglomerative(RtClusterTree *tree, RtError *error);

/* Meister & Bittner 2018: in Morton order of centres, clusters that are each other's nearest among the
 * `radius` before and after are united, in rounds. */
RtStatus rt_cluster_ploc(RtClusterTree *tree, uint32_t radius, RtError *error);

typedef struct RtInsertionOrder {
    bool random;    /* the first try, too, is a random permutation; else it is the order of ids */
    uint32_t tries; /* permutations tried; the cheapest tree is kept */
    uint64_t seed;
} RtInsertionOrder;

/* Goldsmith & Salmon 1987: objects are inserted one by one where the sum of areas grows least. */
RtStatus rt_cluster_insertion(RtClusterTree *tree, const RtInsertionOrder *order, RtError *error);

/* From the top: halves by number along the longest axis of centres (Rubin & Whitted 1980, whose hierarchies
 * were made by hand; bins = 0), or by the surface area heuristic in `bins` bins (Wald 2007). */
RtStatus rt_cluster_topdown(RtClusterTree *tree, int bins, RtError *error);

#endif
