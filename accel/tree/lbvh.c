/* SPDX-License-Identifier: Apache-2.0 */
/* Trees along the Morton curve (Lauterbach, Garland, Sengupta, Luebke & Manocha 2009): references in Morton
 * order are parted where the highest bit in which their codes differ changes, which cuts space in the middle
 * along one axis after another. Equal codes are halved by number.
 *
 * The place of the change is found by halving, as in Karras 2012, "Maximizing Parallelism in the Construction
 * of BVHs, Octrees, and k-d Trees"; his order, in which all nodes can be made at once, is left out. */
#include "accel/tree/order.h"
#include "accel/tree/tree.h"
#include "base/memory.h"

typedef struct Builder {
    RtTree *tree;
    const RtKeyed *row; /* in Morton order */
    const RtBox *boxes; /* in the same order */
} Builder;

/* How many of row[0..count) go to the left; count >= 2. */
static uint32_t divide(const RtKeyed *row, uint32_t count) {
    uint64_t differing = row[0].key ^ row[count - 1].key;
    if (differing == 0) return count / 2;
    while (differing & (differing - 1)) differing &= differing - 1; /* the highest bit alone is left */
    uint32_t first = 0, last = count - 1;                           /* the bit is 0 in `first`, 1 in `last` */
    while (last - first > 1) {
        uint32_t middle = first + (last - first) / 2;
        *(row[middle].key & differing ? &last : &first) = middle;
    }
    return last;
}

/* Goes no deeper than a code has bits and a number of references has halves. */
static uint32_t build(const Builder *b, uint32_t begin, uint32_t count) {
    uint32_t node = rt_tree_take(b->tree);
    if (count == 1) {
        rt_tree_set_leaf(b->tree, node, b->boxes[begin], b->row[begin].id);
        return node;
    }
    uint32_t left = divide(b->row + begin, count);
    uint32_t first = build(b, begin, left);
    rt_tree_set_union(b->tree, node, first, build(b, begin + left, count - left));
    return node;
}

RtStatus rt_tree_lbvh(RtTree *tree, const RtBox *boxes, uint32_t count, uint32_t bits, RtError *error) {
    RT_TRY(rt_tree_init(tree, count, error));
    RtKeyed *row = rt_order_morton(boxes, count, bits);
    RtBox *boxes_in_row = rt_alloc(count, sizeof(RtBox));
    bool enough = row && boxes_in_row;
    if (enough) {
        /* All at once, so that the processor waits for many boxes at a time. */
        for (uint32_t i = 0; i < count; i++) boxes_in_row[i] = boxes[row[i].id];
        Builder builder = {tree, row, boxes_in_row};
        tree->root = build(&builder, 0, count);
    }
    rt_free(row);
    rt_free(boxes_in_row);
    if (enough) return RT_OK;
    rt_tree_clear(tree);
    return rt_fail_memory(error, "Morton codes", 2 * (size_t)count * sizeof(RtKeyed));
}
