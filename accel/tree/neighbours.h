/* SPDX-License-Identifier: Apache-2.0 */
/* The nearest neighbour of a cluster, exactly, among clusters that come and go.
 *
 * Every cluster has a slot; slots are the leaves of a complete binary tree in one array (children of i: 2i
 * and 2i + 1), filled in the order of medians. A union takes the slot of one of its two, the other slot is
 * empty from then on. A node of the tree knows, of the clusters below it, the largest lower corner, the
 * smallest upper corner and the smallest size; the box about a cluster and any of them is at least as large
 * as the box about it and those, so what cannot be nearer is skipped. */
#ifndef RT_ACCEL_TREE_NEIGHBOURS_H
#define RT_ACCEL_TREE_NEIGHBOURS_H

#include "accel/tree/tree.h"

typedef struct RtNeighbourBound {
    RtVec3 lo, hi, size; /* of an empty node: -inf, +inf, +inf, whatever is asked about is infinitely far */
} RtNeighbourBound;

typedef struct RtNeighbours {
    const RtTree *tree;       /* borrowed */
    uint32_t capacity;        /* slots, a power of two */
    RtNeighbourBound *bounds; /* [2 * capacity]; a slot's is at capacity + slot */
    uint32_t *cluster_at;     /* [capacity] by slot, or RT_NO_CLUSTER */
    uint32_t *slot_of;        /* [tree->capacity] by cluster */
} RtNeighbours;

#define RT_NO_CLUSTER UINT32_MAX

/* The references of `tree`, which has no union yet, each in a slot. */
RtStatus rt_neighbours_init(RtNeighbours *self, const RtTree *tree, RtError *error);
void rt_neighbours_clear(RtNeighbours *self);

/* Puts `united`, the union of a and b, in their place. */
void rt_neighbours_unite(RtNeighbours *self, uint32_t a, uint32_t b, uint32_t united);

/* The cluster at the least distance from `cluster`, which goes to *distance; of equal ones that whose slot
 * shares the lowest subtree with it. RT_NO_CLUSTER and INFINITY if there is no other. */
uint32_t rt_neighbours_nearest(const RtNeighbours *self, uint32_t cluster, double *distance);

#endif
