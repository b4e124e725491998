/* SPDX-License-Identifier: Apache-2.0 */
/* Dividing the cells of an octree, level by level: where a cell is cut, whether it is, and dealing its list
 * to the lists of its eight children. What children would take is counted before it is taken.
 *
 * Split planes: Glassner 1984 (the centre); Whang et al. 1995, Octree-R (by cost, each axis on its own). */
#include "accel/octree/octree.h"

#include "core/base/memory.h"

/* From the centre of a cell to where its objects are; planes are tried at both ends and between. */
enum { STEPS = 10 };

/* ---- split planes ---- */

/* A plane strictly inside, or the upper one: see octree.h. */
static float inside(double at, float lo, float hi) {
    float split = (float)at;
    return split > lo && split < hi ? split : hi;
}

static float centre(float lo, float hi) {
    return inside(0.5 * (double)lo + 0.5 * (double)hi, lo, hi);
}

/* Where objects are along an axis: the mean of the centres of what the cell holds of their boxes. */
static double mean_center(const RtOctreeBuilder *b, const RtBox *cell, int axis, const uint32_t *ids,
                          uint32_t count) {
    double sum = 0, lo = (double)cell->lo.at[axis], hi = (double)cell->hi.at[axis];
    for (uint32_t i = 0; i < count; i++) {
        RtBox object = rt_octree_grown(b->tree, b->objects[ids[i]]);
        sum += fmax((double)object.lo.at[axis], lo) + fmin((double)object.hi.at[axis], hi);
    }
    return sum / (2.0 * count);
}

/* Octree-R: of the planes in ten equal steps from the centre to where the objects are, the one of the least
 * cost (MacDonald & Booth 1990). */
static float cheapest(const RtOctreeBuilder *b, const RtBox *cell, int axis, const uint32_t *ids,
                      uint32_t count) {
    float lo = cell->lo.at[axis], hi = cell->hi.at[axis], best = centre(lo, hi);
    RtVec3d size = rt_subd(rt_widen(cell->hi), rt_widen(cell->lo));
    double across = size.at[(axis + 1) % 3] + size.at[(axis + 2) % 3];
    double face = size.at[(axis + 1) % 3] * size.at[(axis + 2) % 3];
    double from = (double)best, to = mean_center(b, cell, axis, ids, count), least = INFINITY;
    for (int k = 0; k <= STEPS; k++) {
        float split = inside(from + (to - from) * k / STEPS, lo, hi);
        if (split == hi) continue;
        uint32_t below = 0, above = 0; /* objects that are cut are in both, those that touch are not */
        for (uint32_t i = 0; i < count; i++) {
            RtBox object = rt_octree_grown(b->tree, b->objects[ids[i]]);
            below += object.lo.at[axis] < split;
            above += object.hi.at[axis] > split;
        }
        double left = (double)split - (double)lo, right = (double)hi - (double)split;
        double cost = below * (2 * left * across + face) + above * (2 * right * across + face);
        if (!(cost < least)) continue;
        least = cost;
        best = split;
    }
    return best;
}

static RtVec3 choose_split(const RtOctreeBuilder *b, const RtBox *cell, const uint32_t *ids, uint32_t count) {
    RtVec3 split;
    for (int a = 0; a < 3; a++) {
        split.at[a] = b->tree->split == RT_OCTREE_COST ? cheapest(b, cell, a, ids, count)
                                                       : centre(cell->lo.at[a], cell->hi.at[a]);
    }
    return split;
}

bool rt_octree_divisible(const RtOctree *tree, const RtBox *boxes, const RtBox *cell, const uint32_t *ids,
                         uint32_t count) {
    bool room = false;
    for (int a = 0; a < 3; a++) room |= centre(cell->lo.at[a], cell->hi.at[a]) < cell->hi.at[a];
    if (tree->cut_filled) return room;
    for (uint32_t i = 0; room && i < count; i++) {
        if (!rt_box_contains(rt_octree_grown(tree, boxes[ids[i]]), *cell)) return true;
    }
    return false;
}

bool rt_octree_divides(const RtOctreeBuilder *b, const RtBox *cell, const uint32_t *ids, uint32_t count) {
    return count > b->tree->max_leaf_size && b->depth < b->tree->max_depth &&
           rt_octree_divisible(b->tree, b->objects, cell, ids, count);
}

/* ---- levels ---- */

RtStatus rt_octree_refuse(const RtOctreeBuilder *b, double bytes, uint32_t fits, RtError *error) {
    return rt_fail(error, RT_BAD_INPUT,
                   "an octree of max_depth=%u, max_leaf_size=%u would take about %.3g GiB or more, more than "
                   "%.3g GiB: max_depth=%u would fit",
                   b->tree->max_depth, b->tree->max_leaf_size, bytes / 0x1p30, (double)b->limit / 0x1p30,
                   fits);
}

/* Makes room for `nodes` more nodes, `ids` more entries of leaves and `next` more of the next level. */
static RtStatus make_room(RtOctreeBuilder *b, uint64_t nodes, uint64_t ids, uint64_t next, RtError *error) {
    RtOctree *tree = b->tree;
    nodes += tree->node_count;
    ids += tree->id_count;
    next += b->next_count;
    uint64_t bytes = nodes * RT_OCTREE_NODE_BYTES + (ids + next) * sizeof(uint32_t);
    if (bytes > b->limit) return rt_octree_refuse(b, (double)bytes, b->depth, error);
    RT_TRY(rt_reserve(&tree->nodes, &b->node_capacity, nodes, sizeof(RtOctreeNode), error));
    RT_TRY(rt_reserve(&tree->boxes, &b->box_capacity, nodes, sizeof(RtBox), error));
    RT_TRY(rt_reserve(&tree->ids, &b->id_capacity, ids, sizeof(uint32_t), error));
    return rt_reserve(&b->next, &b->next_capacity, next, sizeof(uint32_t), error);
}

RtStatus rt_octree_begin(RtOctreeBuilder *b, RtBox cell, uint32_t count, RtError *error) {
    RT_TRY(make_room(b, 1, 0, 0, error));
    b->tree->nodes[0] = (RtOctreeNode){.first = 0, .count = count};
    b->tree->boxes[0] = cell;
    b->tree->node_count = 1;
    return RT_OK;
}

void rt_octree_next_level(RtOctreeBuilder *b) {
    rt_free(b->list);
    b->list = b->next;
    b->next = NULL;
    b->next_count = b->next_capacity = 0;
    b->depth++;
}

RtStatus rt_octree_make_leaf(RtOctreeBuilder *b, uint32_t index, const uint32_t *ids, uint32_t count,
                             RtError *error) {
    RtOctree *tree = b->tree;
    RT_TRY(make_room(b, 0, count, 0, error));
    tree->nodes[index].first = tree->id_count;
    for (uint32_t i = 0; i < count; i++) tree->ids[tree->id_count++] = ids[i];
    return RT_OK;
}

/* A count pass, room, a fill pass. */
RtStatus rt_octree_divide(RtOctreeBuilder *b, uint32_t index, const uint32_t *ids, uint32_t count,
                          RtError *error) {
    RtOctree *tree = b->tree;
    RtBox cell = tree->boxes[index];
    RtVec3 split = choose_split(b, &cell, ids, count);
    uint32_t length[8] = {0}, end[8];
    uint64_t total = 0;
    for (uint32_t i = 0; i < count; i++) {
        RtBox object = rt_octree_grown(tree, b->objects[ids[i]]);
        uint32_t children = rt_octree_sides(&cell, split, &object);
        for (uint32_t c = 0; c < 8; c++) length[c] += children >> c & 1;
    }
    uint32_t empty = 0; /* too few to be divided again: these are leaves */
    for (uint32_t c = 0; c < 8; c++) {
        total += length[c];
        empty |= (uint32_t)(length[c] == 0) << c;
    }
    RT_TRY(make_room(b, 8, 0, total, error));
    RtOctreeNode *node = &tree->nodes[index];
    node->split = split;
    node->first = tree->node_count;
    node->count = RT_OCTREE_INNER | empty;
    for (uint32_t c = 0; c < 8; c++) {
        tree->boxes[tree->node_count] = rt_octree_child_box(cell, split, c);
        tree->nodes[tree->node_count++] =
            (RtOctreeNode){.first = b->next_count, .count = length[c], .parent = index};
        end[c] = b->next_count;
        b->next_count += length[c];
    }
    for (uint32_t i = 0; i < count; i++) {
        RtBox object = rt_octree_grown(tree, b->objects[ids[i]]);
        uint32_t children = rt_octree_sides(&cell, split, &object);
        for (uint32_t c = 0; c < 8; c++) {
            if (children >> c & 1) b->next[end[c]++] = ids[i];
        }
    }
    return RT_OK;
}

void rt_octree_end(RtOctreeBuilder *b) {
    rt_free(b->list);
    rt_free(b->next);
    rt_free(b->tree->nodes);
    rt_free(b->tree->boxes);
    rt_free(b->tree->ids);
}
