/* The structure behind `clusters`: for its own files and its test, which breaks it on purpose. */
#ifndef RT_ACCEL_CLUSTERS_CLUSTERS_H
#define RT_ACCEL_CLUSTERS_CLUSTERS_H

#include "accel/clusters/tree.h"
#include "accel/extent.h"

enum { RT_CLUSTER_MAX_WIDTH = 16 };

/* Marks the number of objects of a leaf; without it, the number of children of an inner node. */
#define RT_CLUSTER_LEAF UINT32_C(0x80000000)

typedef struct RtClusterNode {
    RtBox box;
    uint32_t first; /* inner: the first child, the others follow; leaf: the first of its ids */
    uint32_t count; /* 2..width children, or RT_CLUSTER_LEAF | 1..leaf objects */
} RtClusterNode;

/* Node 0 is the root; an object's id stands in exactly one leaf. The leaves come in the order of their ids,
 * children as they stand, so that the ids of a subtree are one run. */
typedef struct RtClusters {
    RtAccel base;
    RtClusterNode *nodes; /* [node_count] */
    uint32_t *ids;        /* [objects], leaf by leaf */
    uint32_t node_count;
    uint32_t width, leaf_limit;
    bool nearest_first; /* the traversal order; else the children as they stand */
    RtExtentSet set;    /* an extent per node */
} RtClusters;

static inline bool rt_cluster_is_leaf(const RtClusterNode *node) {
    return (node->count & RT_CLUSTER_LEAF) != 0;
}

/* Objects of a leaf, or children of an inner node. */
static inline uint32_t rt_cluster_fanout(const RtClusterNode *node) {
    return node->count & ~RT_CLUSTER_LEAF;
}

/* The objects below node `index`. */
RtGroup rt_cluster_group(const RtClusters *self, uint32_t index);

/* Lays out a complete tree of limited depth as nodes and ids, which are there with room enough. */
RtStatus rt_clusters_layout(RtClusters *self, const RtClusterTree *tree, RtError *error);

/* RtAccelOps: describe, validate. */
void rt_clusters_describe(const RtAccel *accel, RtDescription *out);
RtStatus rt_clusters_validate(const RtAccel *accel, RtError *error);

#endif
