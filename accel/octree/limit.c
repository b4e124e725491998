/* SPDX-License-Identifier: Apache-2.0 */
/* What an octree that has been built down to some level will take at each depth below, estimated by random
 * probes before it is taken: a probe goes from a cell of the level down to one child at a time, picked from
 * those that would be divided too, and stands for as many cells as there were to pick from. Its sums are
 * unbiased; their scatter says how far they can be trusted.
 *
 * Paper: Knuth 1975, Estimating the efficiency of backtrack programs, Mathematics of Computation 29. */
#include "accel/octree/octree.h"

#include "core/base/memory.h"
#include "core/base/random.h"

#include <string.h>

/* Probes a level; standard errors by which an estimate must clear the limit. */
enum { PROBES = 256, CERTAIN = 4 };

/* Nothing is estimated before this part of the limit is taken, and so nothing for most trees. */
#define CHEAP (1.0 / 1024)

/* Over the probes so far, of the bytes that the depths down to d add to what is there. */
typedef struct Estimate {
    double sum[RT_OCTREE_DEPTH_LIMIT + 1], squares[RT_OCTREE_DEPTH_LIMIT + 1];
} Estimate;

static void add(Estimate *estimate, uint32_t from, uint32_t to, double bytes) {
    for (uint32_t depth = from; depth <= to; depth++) {
        estimate->sum[depth] += bytes;
        estimate->squares[depth] += bytes * bytes;
    }
}

static bool is_long(const RtOctreeBuilder *b, uint32_t index) {
    return b->tree->nodes[index].count > b->tree->max_leaf_size;
}

/* Bytes of the tree that is cut off at the current level, nodes [from, to). */
static double bytes_so_far(const RtOctreeBuilder *b, uint32_t from, uint32_t to) {
    uint64_t references = b->tree->id_count;
    for (uint32_t i = from; i < to; i++) references += b->tree->nodes[i].count;
    return (double)(to * RT_OCTREE_NODE_BYTES + references * sizeof(uint32_t));
}

/* One of the eight nodes from `first` on, of those that would be divided; 0 if there is none. `weight` is
 * multiplied by their number. */
static uint32_t pick_child(const RtOctreeBuilder *probe, uint32_t first, RtRandom *random, double *weight) {
    const RtOctree *tree = probe->tree;
    uint32_t open[8], n = 0;
    for (uint32_t child = first; child < first + 8; child++) {
        const RtOctreeNode *node = &tree->nodes[child];
        bool divided = rt_octree_divides(probe, &tree->boxes[child], probe->list + node->first, node->count);
        if (divided) open[n++] = child;
    }
    *weight *= n;
    return n == 0 ? 0 : open[(uint64_t)rt_random_bits(random) * n >> 32];
}

/* Walks from the only node of the probe's tree, to be divided, which stands for `weight` nodes. */
static RtStatus walk(RtOctreeBuilder *probe, double weight, RtRandom *random, Estimate *estimate,
                     RtError *error) {
    RtOctree *tree = probe->tree;
    double bytes = 0;
    uint32_t index = 0;
    do {
        uint32_t count = tree->nodes[index].count, children = tree->node_count;
        RT_TRY(rt_octree_divide(probe, index, probe->list + tree->nodes[index].first, count, error));
        bytes += weight * (8.0 * RT_OCTREE_NODE_BYTES +
                           ((double)probe->next_count - count) * (double)sizeof(uint32_t));
        rt_octree_next_level(probe);
        add(estimate, probe->depth, probe->depth, bytes);
        index = pick_child(probe, children, random, &weight);
    } while (index != 0);
    add(estimate, probe->depth + 1, tree->max_depth, bytes);
    return RT_OK;
}

/* Starts a probe at a node of the current level of `b`. */
static RtStatus start(RtOctreeBuilder *probe, const RtOctreeBuilder *b, uint32_t index, RtError *error) {
    RtOctreeNode node = b->tree->nodes[index];
    probe->depth = b->depth;
    probe->tree->node_count = 0;
    rt_free(probe->list);
    probe->list = rt_alloc(node.count, sizeof(uint32_t));
    if (!probe->list) return rt_fail_memory(error, "a probe", node.count * sizeof(uint32_t));
    memcpy(probe->list, b->list + node.first, node.count * sizeof(uint32_t));
    return rt_octree_begin(probe, b->tree->boxes[index], node.count, error);
}

/* Probes start at nodes with long lists, of which there are `candidates`, one in each of as many equal parts
 * of them as there are probes. */
static RtStatus probe_level(const RtOctreeBuilder *b, RtOctreeBuilder *probe, uint32_t from,
                            uint32_t candidates, Estimate *estimate, RtError *error) {
    RtRandom random = rt_random(PROBES, b->depth);
    uint32_t index = from, seen = 0;
    for (uint32_t p = 0; p < PROBES; p++) {
        double at = (p + (double)rt_random_unit(&random)) * candidates / PROBES;
        for (; !is_long(b, index) || seen < (uint32_t)at; index++) seen += is_long(b, index);
        const RtOctreeNode *node = &b->tree->nodes[index];
        if (!rt_octree_divides(b, &b->tree->boxes[index], b->list + node->first, node->count)) continue;
        RT_TRY(start(probe, b, index, error));
        RT_TRY(walk(probe, candidates, &random, estimate, error));
    }
    return RT_OK;
}

/* `certain` standard errors away from the estimate of what the depths down to `depth` add. */
static double bound(const Estimate *estimate, uint32_t depth, double certain) {
    double mean = estimate->sum[depth] / PROBES;
    double variance = estimate->squares[depth] / PROBES - mean * mean;
    return mean + certain * sqrt(fmax(variance, 0) / (PROBES - 1));
}

RtStatus rt_octree_check_limit(const RtOctreeBuilder *b, uint32_t from, uint32_t to, RtError *error) {
    double bytes = bytes_so_far(b, from, to), limit = (double)b->limit;
    uint32_t candidates = 0, max_depth = b->tree->max_depth, fits = b->depth;
    for (uint32_t i = from; i < to; i++) candidates += is_long(b, i);
    if (b->depth == max_depth || candidates < PROBES || bytes < CHEAP * limit) return RT_OK;

    Estimate estimate = {{0}, {0}};
    RtOctree tree = {.max_leaf_size = b->tree->max_leaf_size,
                     .max_depth = max_depth,
                     .split = b->tree->split,
                     .slack = b->tree->slack,
                     .flat = b->tree->flat,
                     .cut_filled = b->tree->cut_filled};
    RtOctreeBuilder probe = {.tree = &tree, .objects = b->objects, .limit = UINT64_MAX};
    RtStatus status = probe_level(b, &probe, from, candidates, &estimate, error);
    rt_octree_end(&probe);
    RT_TRY(status);

    /* A deeper tree takes no less, and what is nearer is known better. */
    double least = 0;
    for (uint32_t depth = fits + 1; depth <= max_depth; depth++) {
        least = fmax(least, bytes + bound(&estimate, depth, -CERTAIN));
    }
    if (least <= limit) return RT_OK;
    while (bytes + bound(&estimate, fits + 1, CERTAIN) <= limit) fits++;
    return rt_octree_refuse(b, bytes + bound(&estimate, max_depth, 0), fits, error);
}
