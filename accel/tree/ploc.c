/* Parallel locally-ordered clustering on one thread (Meister & Bittner 2018).
 *
 * Clusters stand in a row, in Morton order of the objects' centres. In a round everyone looks for its nearest
 * among the `radius` before and after; two that chose each other are united and stand where the first stood.
 * Equal distances are decided by the exclusive or of the places, which is the same seen from either side and
 * differs among the partners of one cluster: so the least pair of a round always is mutual, every round makes
 * progress, and coincident objects pair up like a balanced tree. */
#include "accel/tree/order.h"
#include "accel/tree/tree.h"
#include "base/memory.h"

/* The place of the nearest of row[i] within `radius`. */
static uint32_t find_nearest(const RtTree *tree, const uint32_t *row, uint32_t count, uint32_t i,
                             uint32_t radius) {
    uint32_t first = i > radius ? i - radius : 0;
    uint32_t last = count - 1 - i > radius ? i + radius : count - 1;
    uint32_t best = UINT32_MAX;
    double least = INFINITY;
    for (uint32_t j = first; j <= last; j++) {
        if (j == i) continue;
        double d = rt_tree_distance(tree, row[i], row[j]);
        if (d > least || (d == least && (i ^ j) > (i ^ best))) continue;
        least = d;
        best = j;
    }
    return best;
}

/* One round; gives the length of the row it leaves. */
static uint32_t unite_pairs(RtTree *tree, uint32_t *row, uint32_t *nearest, uint32_t count, uint32_t radius) {
    uint32_t left = 0;
    for (uint32_t i = 0; i < count; i++) nearest[i] = find_nearest(tree, row, count, i, radius);
    for (uint32_t i = 0; i < count; i++) {
        bool mutual = nearest[nearest[i]] == i;
        if (mutual && nearest[i] < i) continue;
        row[left++] = mutual ? rt_tree_unite(tree, row[i], row[nearest[i]]) : row[i];
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
    uint32_t *nearest = rt_alloc(count, sizeof(uint32_t));
    bool enough = row && nearest;
    for (uint32_t i = 0; enough && i < count; i++) row[i] = i;
    for (uint32_t left = count; enough && left > 1;) left = unite_pairs(tree, row, nearest, left, radius);
    rt_free(row);
    rt_free(nearest);
    if (enough) return RT_OK;
    rt_tree_clear(tree);
    return rt_fail_memory(error, "a row of clusters", 2 * (size_t)count * sizeof(uint32_t));
}
