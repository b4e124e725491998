/* SPDX-License-Identifier: Apache-2.0 */
/* Agglomerative clustering (Walter, Bala, Kulkarni & Pingali 2008): merges the two nearest clusters until one
 * is left.
 *
 * The box of a union and a third cluster is never smaller than that of either part and the third. So two
 * clusters that are each other's nearest can be merged at once: no other merge comes between them, and the
 * tree is the one that always merging the globally nearest pair would make (up to ties). Nearest-neighbour
 * chains find them: from a cluster to its nearest, to that one's nearest and so on, with strictly decreasing
 * distances; a merge leaves the rest of the chain valid, so each step is made once. Chains start at every
 * slot in turn, cyclically, which makes a balanced tree of coincident objects. */
#include "accel/tree/neighbours.h"

#include "core/base/memory.h"

typedef struct Link {
    uint32_t cluster;
    double distance; /* from the link before */
} Link;

static uint32_t next_start(const RtNeighbours *neighbours, uint32_t *slot) {
    for (;; *slot = *slot + 1 < neighbours->capacity ? *slot + 1 : 0) {
        uint32_t cluster = neighbours->cluster_at[*slot];
        if (cluster == RT_NO_CLUSTER) continue;
        *slot = *slot + 1 < neighbours->capacity ? *slot + 1 : 0;
        return cluster;
    }
}

static void unite_all(RtTree *tree, RtNeighbours *neighbours, Link *chain) {
    uint32_t length = 0, slot = 0;
    for (uint32_t left = tree->used; left > 1;) {
        if (length == 0) chain[length++] = (Link){next_start(neighbours, &slot), INFINITY};
        double distance;
        const Link *last = &chain[length - 1];
        uint32_t nearest = rt_neighbours_nearest(neighbours, last->cluster, &distance);
        if (distance < last->distance) {
            chain[length++] = (Link){nearest, distance};
            continue;
        }
        uint32_t before = chain[length - 2].cluster;
        rt_neighbours_unite(neighbours, before, last->cluster, rt_tree_unite(tree, before, last->cluster));
        length -= 2;
        left--;
    }
}

static RtStatus complete(RtTree *tree, RtError *error) {
    RtNeighbours neighbours;
    RT_TRY(rt_neighbours_init(&neighbours, tree, error));
    size_t links = (size_t)tree->used + 1;
    Link *chain = rt_alloc(links, sizeof(Link));
    if (chain) unite_all(tree, &neighbours, chain);
    rt_free(chain);
    rt_neighbours_clear(&neighbours);
    return chain ? RT_OK : rt_fail_memory(error, "a chain of clusters", links * sizeof(Link));
}

RtStatus rt_tree_agglomerative(RtTree *tree, const RtBox *boxes, uint32_t count, RtError *error) {
    RT_TRY(rt_tree_init_leaves(tree, boxes, count, error));
    RtStatus status = complete(tree, error);
    if (status != RT_OK) rt_tree_clear(tree);
    return status;
}
