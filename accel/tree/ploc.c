/* SPDX-License-Identifier: Apache-2.0 */
/* Parallel locally-ordered clustering on one thread (Meister & Bittner 2018).
 *
 * Clusters stand in a row, in Morton order of the objects' centres. In a round everyone looks for its nearest
 * among the `radius` before and after; two that chose each other are united and stand where the first stood.
 * Equal distances are decided by the exclusive or of the places, which is the same seen from either side and
 * differs among the partners of one cluster: so the least pair of a round always is mutual, every round makes
 * progress, and coincident objects pair up like a balanced tree.
 *
 * Deviation: where distances grow along the row, the nearest of everyone is the one before, and only one pair
 * of a round is mutual. So after PATIENCE rounds, in which most scenes are done, a cluster is also united
 * with its nearest if that has not been united yet: rounds are then fewer than objects by far, and the time
 * is linear in the objects but for a logarithm. */
#include "accel/tree/order.h"
#include "accel/tree/tree.h"
#include "base/memory.h"

enum { PATIENCE = RT_TREE_MAX_DEPTH };

typedef struct Nearest {
    double distance;
    uint32_t place; /* in the row */
} Nearest;

static void offer(Nearest *nearest, uint32_t from, uint32_t place, double distance) {
    if (distance > nearest->distance) return;
    if (distance == nearest->distance && (from ^ place) > (from ^ nearest->place)) return;
    *nearest = (Nearest){distance, place};
}

/* Fills nearest[0..count) for the clusters of the row; each pair is measured once. */
static void find_nearest(const RtTree *tree, const uint32_t *row, Nearest *nearest, uint32_t count,
                         uint32_t radius) {
    for (uint32_t i = 0; i < count; i++) nearest[i] = (Nearest){INFINITY, UINT32_MAX};
    for (uint32_t i = 0; i < count; i++) {
        uint32_t last = count - 1 - i > radius ? i + radius : count - 1;
        for (uint32_t j = i + 1; j <= last; j++) {
            double distance = rt_tree_distance(tree, row[i], row[j]);
            offer(&nearest[i], i, j, distance);
            offer(&nearest[j], j, i, distance);
        }
    }
}

static bool is_mutual(const Nearest *nearest, uint32_t i) {
    return nearest[nearest[i].place].place == i;
}

/* Whoever's choice is still free gets it. */
static void pair_more(Nearest *nearest, uint32_t count) {
    for (uint32_t i = 0; i < count; i++) {
        uint32_t other = nearest[i].place;
        if (!is_mutual(nearest, i) && !is_mutual(nearest, other)) nearest[other].place = i;
    }
}

/* One round; gives the length of the row it leaves. */
static uint32_t unite_pairs(RtTree *tree, uint32_t *row, Nearest *nearest, uint32_t count, uint32_t radius,
                            uint32_t round) {
    uint32_t left = 0;
    find_nearest(tree, row, nearest, count, radius);
    if (round >= PATIENCE) pair_more(nearest, count);
    for (uint32_t i = 0; i < count; i++) {
        uint32_t other = nearest[i].place;
        bool mutual = is_mutual(nearest, i);
        if (mutual && other < i) continue;
        row[left++] = mutual ? rt_tree_unite(tree, row[i], row[other]) : row[i];
    }
    return left;
}

/* Neighbours in the row are neighbours in memory, as far as can be. */
static RtStatus init_in_order(RtTree *tree, const RtBox *boxes, uint32_t count, uint32_t bits,
                              RtError *error) {
    RtKeyed *order = rt_order_morton(boxes, count, bits);
    if (!order) return rt_fail_memory(error, "Morton codes", 2 * (size_t)count * sizeof(RtKeyed));
    RtStatus status = rt_tree_init(tree, count, error);
    for (uint32_t i = 0; status == RT_OK && i < count; i++) {
        uint32_t id = order[i].id;
        rt_tree_set_leaf(tree, rt_tree_take(tree), boxes[id], id);
    }
    rt_free(order);
    return status;
}

RtStatus rt_tree_ploc(RtTree *tree, const RtBox *boxes, uint32_t count, uint32_t bits, uint32_t radius,
                      RtError *error) {
    RT_TRY(init_in_order(tree, boxes, count, bits, error));
    uint32_t *row = rt_alloc(count, sizeof(uint32_t));
    Nearest *nearest = rt_alloc(count, sizeof(Nearest));
    bool enough = row && nearest;
    for (uint32_t i = 0; enough && i < count; i++) row[i] = i;
    for (uint32_t left = count, round = 0; enough && left > 1; round++)
        left = unite_pairs(tree, row, nearest, left, radius, round);
    rt_free(row);
    rt_free(nearest);
    if (enough) return RT_OK;
    rt_tree_clear(tree);
    return rt_fail_memory(error, "a row of clusters", (size_t)count * sizeof(Nearest));
}
