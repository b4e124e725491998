/* Parallel locally-ordered clustering on one thread (Meister & Bittner 2018).
 *
 * Clusters stand in a row, in Morton order of the objects' centres. In a round everyone looks for its nearest
 * among the `radius` before and after; two that chose each other are united and stand where the first stood.
 * Equal distances are decided by the exclusive or of the places, which is the same seen from either side and
 * differs among the partners of one cluster: so the least pair of a round always is mutual, every round makes
 * progress, and coincident objects pair up like a balanced tree. */
#include "accel/tree/tree.h"
#include "base/memory.h"

#include <stdlib.h>

typedef struct Coded {
    uint64_t code; /* Morton: 21 bits an axis, interleaved */
    uint32_t id;
} Coded;

static int by_code(const void *a, const void *b) {
    const Coded *x = a, *y = b;
    if (x->code != y->code) return x->code < y->code ? -1 : 1;
    return x->id < y->id ? -1 : x->id > y->id;
}

/* Spreads 21 bits so that two zeros follow each. */
static uint64_t spread_bits(uint64_t x) {
    x = (x | x << 32) & UINT64_C(0x1f00000000ffff);
    x = (x | x << 16) & UINT64_C(0x1f0000ff0000ff);
    x = (x | x << 8) & UINT64_C(0x100f00f00f00f00f);
    x = (x | x << 4) & UINT64_C(0x10c30c30c30c30c3);
    return (x | x << 2) & UINT64_C(0x1249249249249249);
}

static uint64_t morton_code(RtVec3 center, const RtBox *centers) {
    enum { CELLS = 1 << 21 };
    uint64_t code = 0;
    for (int a = 0; a < 3; a++) {
        double size = (double)centers->hi.at[a] - (double)centers->lo.at[a];
        double at = (double)center.at[a] - (double)centers->lo.at[a];
        int cell = size > 0 ? (int)(at / size * CELLS) : 0;
        code |= spread_bits((uint64_t)(cell < CELLS ? cell : CELLS - 1)) << a;
    }
    return code;
}

/* Fills row[0..count) with the objects in Morton order. */
static RtStatus order_objects(const RtTree *tree, uint32_t *row, RtError *error) {
    uint32_t count = tree->used;
    Coded *coded = rt_alloc(count, sizeof(Coded));
    if (!coded) return rt_fail_memory(error, "Morton codes", count * sizeof(Coded));
    RtBox centers = RT_EMPTY_BOX;
    for (uint32_t i = 0; i < count; i++) {
        centers = rt_box_add_point(centers, rt_box_center(tree->nodes[i].box));
    }
    for (uint32_t i = 0; i < count; i++) {
        coded[i] = (Coded){morton_code(rt_box_center(tree->nodes[i].box), &centers), i};
    }
    qsort(coded, count, sizeof *coded, by_code);
    for (uint32_t i = 0; i < count; i++) row[i] = coded[i].id;
    rt_free(coded);
    return RT_OK;
}

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

static RtStatus complete(RtTree *tree, uint32_t radius, RtError *error) {
    uint32_t count = tree->used;
    uint32_t *row = rt_alloc(count, sizeof(uint32_t));
    uint32_t *nearest = rt_alloc(count, sizeof(uint32_t));
    RtStatus status = row && nearest ? order_objects(tree, row, error)
                                     : rt_fail_memory(error, "clusters", count * sizeof(uint32_t) * 2);
    while (status == RT_OK && count > 1) count = unite_pairs(tree, row, nearest, count, radius);
    rt_free(row);
    rt_free(nearest);
    return status;
}

RtStatus rt_tree_ploc(RtTree *tree, const RtBox *boxes, uint32_t count, uint32_t radius, RtError *error) {
    RT_TRY(rt_tree_init_leaves(tree, boxes, count, error));
    RtStatus status = complete(tree, radius, error);
    if (status != RT_OK) rt_tree_clear(tree);
    return status;
}
