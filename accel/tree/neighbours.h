/* SPDX-License-Identifier: Apache-2.0 */
/* Exact nearest neighbours of clusters, in a set that changes.
 *
 * Every cluster has a slot. Slots are the leaves of a complete binary tree in one array (children of i: 2i
 * and 2i + 1), filled by medians. A union takes the slot of one of its two parts; the other slot becomes
 * empty. A node stores, over the clusters below it, the largest lower corner, the smallest upper corner and
 * the smallest size. The common box of a query and any of these clusters is at least as large as that of the
 * query and these bounds, so the search skips nodes that cannot be nearer. */
#ifndef RT_ACCEL_TREE_NEIGHBOURS_H
#define RT_ACCEL_TREE_NEIGHBOURS_H

#include "accel/tree/tree.h"

typedef struct RtNeighbourBound {
    RtVec3 lo, hi, size; /* of an empty node: -inf, +inf, +inf, so that it is infinitely far from any query */
} RtNeighbourBound;

typedef struct RtNeighbours {
    const RtTree *tree;       /* borrowed */
    uint32_t capacity;        /* slots, a power of two */
    RtNeighbourBound *bounds; /* [2 * capacity]; a slot's is at capacity + slot */
    uint32_t *cluster_at;     /* [capacity] by slot, or RT_NO_CLUSTER */
    uint32_t *slot_of;        /* [tree->capacity] by cluster */
} RtNeighbours;

#define RT_NO_CLUSTER UINT32_MAX

/* Gives each reference of `tree`, which has no inner nodes yet, a slot. */
RtStatus rt_neighbours_init(RtNeighbours *self, const RtTree *tree, RtError *error);
void rt_neighbours_clear(RtNeighbours *self);

/* Replaces a and b by `united`, their union. */
void rt_neighbours_unite(RtNeighbours *self, uint32_t a, uint32_t b, uint32_t united);

/* The cluster nearest to `cluster`, and its *distance. Ties go to the slot in the smallest common subtree.
 * RT_NO_CLUSTER and INFINITY if there is no other. */
uint32_t rt_neighbours_nearest(const RtNeighbours *self, uint32_t cluster, double *distance);

#endif
