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
    const RtBox *boxes;
    const RtKeyed *row; /* in Morton order */
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
        uint32_t id = b->row[begin].id;
        rt_tree_set_leaf(b->tree, node, b->boxes[id], id);
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
    if (row) {
        Builder builder = {tree, boxes, row};
        tree->root = build(&builder, 0, count);
        rt_free(row);
        return RT_OK;
    }
    rt_tree_clear(tree);
    return rt_fail_memory(error, "Morton codes", 2 * (size_t)count * sizeof(RtKeyed));
}
