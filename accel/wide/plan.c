/* SPDX-License-Identifier: Apache-2.0 */
/* Planning nodes of eight children.
 *
 * Leaves, and nodes that merge into their parents, are chosen together for the least expected cost (Ylitie,
 * Karras & Laine 2017, "Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs",
 * section 2.3): let cost(n, k) be the least cost of a forest of at most k subtrees with everything below n.
 * Then
 *
 *     cost(n, 1) = min(leaf(n), area(n) + split(n, 8)),
 *     cost(n, k) = min(cost(n, k - 1), split(n, k)),
 *     split(n, k) = min over i of cost(left, i) + cost(right, k - i),
 *
 * and the choices are followed from the root down. The space of each forest is computed together with its
 * cost, so the offset of every subtree is known before any is laid out. */
#include "accel/wide/plan.h"

#include "core/base/memory.h"

#include <math.h>
#include <string.h>

/* The cost of an empty lane, relative to a block. A full block costs no more than a sparse one, so without
 * this penalty blocks hold 2.8 triangles where 3.0 need as many steps. The dragon takes 75.6 bytes a triangle
 * at 0, 73.1 at 0.05, 71.7 at 0.1 and 71.1 at 0.2, with 13.2 steps of a diffuse ray at each and 3 % more
 * triangles in the blocks at 0.1. */
#define EMPTY_LANE 0.1f

/* A subtree's contents, and its cost and space as a forest of at most k + 1 subtrees. */
typedef struct Weight {
    float cost[RT_WIDE];
    uint32_t units[RT_WIDE];
    float surface; /* of the objects, estimated by surface_of */
    uint32_t references;
    uint32_t shapes; /* bits 1 << RtShape */
} Weight;

static uint32_t blocks_of(uint32_t count) {
    return (count + RT_WIDE_BLOCK - 1) / RT_WIDE_BLOCK;
}

/* ---- costs ---- */

void rt_wide_collect(const RtTree *tree, uint32_t index, uint32_t *ids, uint32_t *count) {
    RtTreeLeaf leaf;
    if (rt_tree_get_leaf(tree, index, &leaf)) {
        for (uint32_t i = 0; i < *count && tree->split_refs; i++) {
            if (ids[i] == leaf.object) return;
        }
        ids[(*count)++] = leaf.object;
        return;
    }
    for (int s = 0; s < 2; s++) rt_wide_collect(tree, tree->nodes[index].child[s], ids, count);
}

RtWideLeafSize rt_wide_leaf_size(uint32_t count, uint32_t shapes) {
    uint32_t blocks = blocks_of(count);
    if (shapes == 1u << RT_SHAPE_TRIANGLE)
        return (RtWideLeafSize){RT_WIDE_TRIANGLES, blocks, blocks * RT_WIDE_BLOCK_UNITS,
                                blocks * RT_WIDE_BLOCK - count};
    RtWideKind kind = shapes == 1u << RT_SHAPE_SPHERE ? RT_WIDE_SPHERES : RT_WIDE_OBJECTS;
    return (RtWideLeafSize){kind, count, sizeof(RtWideList) / RT_WIDE_UNIT, 0};
}

static float leaf_cost(const RtWidePlan *self, float area, RtWideLeafSize size) {
    return area * (float)self->how->block_cost * ((float)size.tests + EMPTY_LANE * (float)size.empty);
}

static float area_of(const RtWidePlan *self, const RtBox *box) {
    return (float)(rt_box_half_area(*box) * self->scale);
}

/* A power of two that makes the area of the root 1 to 2. So sums of areas do not overflow float32, and the
 * choices do not depend on the unit of length. */
static double scale_for(const RtTree *tree) {
    double area = rt_box_half_area(rt_tree_box(tree, tree->root));
    return area > 0 ? ldexp(1, -ilogb(area)) : 1;
}

/* The largest area of a triangle with this box. It is close to half the surface of a solid that fills the
 * box. */
static float surface_of(const RtWidePlan *self, const RtBox *box) {
    RtVec3 d = rt_sub(box->hi, box->lo);
    double xy = (double)d.x * (double)d.y, yz = (double)d.y * (double)d.z, zx = (double)d.z * (double)d.x;
    return (float)(0.5 * sqrt(xy * xy + yz * yz + zx * zx) * self->scale);
}

/* A line through a box of half area `area` hits surface / area objects on average, so at least one with
 * probability near surface / (surface + area), at an expected cost of cost / area. */
static float priority_of(float surface, float area, float cost) {
    return area > 0 && cost > 0 ? surface / (surface + area) * (area / cost) : 0;
}

static void weigh_reference(const RtWidePlan *self, RtTreeLeaf leaf, Weight *own) {
    own->references = 1;
    own->surface = surface_of(self, leaf.box);
    own->shapes = 1u << rt_wide_shape_of(self, leaf.object);
    RtWideLeafSize size = rt_wide_leaf_size(1, own->shapes);
    float cost = leaf_cost(self, area_of(self, leaf.box), size);
    for (int k = 0; k < RT_WIDE; k++) {
        own->cost[k] = cost;
        own->units[k] = size.units;
    }
}

/* split[k], left[k]: the least cost of k + 1 subtrees, and how many of them the left child gets. */
static void split_costs(const Weight *sides[2], float split[RT_WIDE], int32_t left[RT_WIDE]) {
    float right[2 * RT_WIDE]; /* from RT_WIDE on */
    int most = sides[0]->references < RT_WIDE ? (int)sides[0]->references : RT_WIDE - 1;
    for (int k = 0; k < RT_WIDE; k++) {
        right[k] = split[k] = INFINITY;
        right[RT_WIDE + k] = sides[1]->cost[k];
        left[k] = 0;
    }
    for (int i = 1; i <= most; i++) {
        const float *others = &right[RT_WIDE - i]; /* k + 1 - i of them */
        float some = sides[0]->cost[i - 1];
        for (int k = 0; k < RT_WIDE; k++) {
            float cost = some + others[k];
            left[k] = cost < split[k] ? i : left[k];
            split[k] = cost < split[k] ? cost : split[k];
        }
    }
}

/* Makes a leaf of a small subtree if that costs no more. */
static void consider_leaf(const RtWidePlan *self, uint32_t index, float area, Weight *own,
                          RtWideChoice *chosen) {
    uint32_t count = own->references;
    if (count > self->how->leaf_limit) return;
    if (self->tree->split_refs) {
        uint32_t ids[RT_WIDE_MAX_LEAF];
        count = 0;
        rt_wide_collect(self->tree, index, ids, &count);
    }
    RtWideLeafSize size = rt_wide_leaf_size(count, own->shapes);
    float cost = leaf_cost(self, area, size);
    if (!(cost <= own->cost[0])) return;
    own->cost[0] = cost;
    own->units[0] = size.units;
    chosen->choice[0] = RT_WIDE_LEAF;
}

/* weigh_both for two references, the most frequent case: the same result, sooner. */
static void weigh_pair(const RtWidePlan *self, uint32_t index, const Weight *sides[2], Weight *own) {
    RtWideChoice *chosen = &self->choices[index];
    float area = area_of(self, &self->tree->nodes[index].box), split = sides[0]->cost[0] + sides[1]->cost[0];
    uint32_t units = sides[0]->units[0] + sides[1]->units[0];
    memset(chosen, 0, sizeof *chosen);
    chosen->choice[0] = 1;
    own->cost[0] = area + split;
    own->units[0] = RT_WIDE_NODE_UNITS + units;
    consider_leaf(self, index, area, own, chosen);
    bool two = split < own->cost[0];
    for (int k = 1; k < RT_WIDE; k++) {
        own->cost[k] = two ? split : own->cost[0];
        own->units[k] = two ? units : own->units[0];
    }
    chosen->choice[1] = two ? 1 : RT_WIDE_FEWER;
    chosen->units = own->units[0];
    chosen->priority = priority_of(own->surface, area, own->cost[0]);
}

static void weigh_both(const RtWidePlan *self, uint32_t index, const Weight *sides[2], Weight *own) {
    RtWideChoice *chosen = &self->choices[index];
    float area = area_of(self, &self->tree->nodes[index].box), split[RT_WIDE];
    int32_t left[RT_WIDE];
    own->references = sides[0]->references + sides[1]->references;
    own->surface = sides[0]->surface + sides[1]->surface;
    own->shapes = sides[0]->shapes | sides[1]->shapes;
    if (own->references == 2) {
        weigh_pair(self, index, sides, own);
        return;
    }
    split_costs(sides, split, left);
    int all = left[RT_WIDE - 1];
    memset(chosen, 0, sizeof *chosen);
    chosen->choice[0] = (uint8_t)all;
    own->cost[0] = area + split[RT_WIDE - 1];
    own->units[0] = RT_WIDE_NODE_UNITS + sides[0]->units[all - 1] + sides[1]->units[RT_WIDE - all - 1];
    consider_leaf(self, index, area, own, chosen);
    for (int k = 1; k < RT_WIDE; k++) {
        bool fewer = !(split[k] < own->cost[k - 1]);
        own->cost[k] = fewer ? own->cost[k - 1] : split[k];
        own->units[k] =
            fewer ? own->units[k - 1] : sides[0]->units[left[k] - 1] + sides[1]->units[k - left[k]];
        chosen->choice[k] = fewer ? RT_WIDE_FEWER : (uint8_t)left[k];
    }
    chosen->units = own->units[0];
    chosen->priority = priority_of(own->surface, area, own->cost[0]);
}

static bool weigh(void *context, uint32_t index, uint32_t levels, void *weight) {
    const RtWidePlan *self = context;
    RtTreeLeaf leaf;
    if (rt_tree_get_leaf(self->tree, index, &leaf)) {
        weigh_reference(self, leaf, weight);
        return true;
    }
    const uint32_t *child = self->tree->nodes[index].child;
    Weight below[2];
    if (levels == 0 || !weigh(context, child[0], levels - 1, &below[0]) ||
        !weigh(context, child[1], levels - 1, &below[1]))
        return false;
    weigh_both(self, index, (const Weight *[2]){&below[0], &below[1]}, weight);
    return true;
}

static void weigh_node(void *context, uint32_t index, const void *const sides[2], void *weight) {
    weigh_both(context, index, (const Weight *[2]){sides[0], sides[1]}, weight);
}

RtStatus rt_wide_plan_init(RtWidePlan *self, RtTree *tree, const RtGeometry *geometry,
                           const RtWideLayout *how, RtError *error) {
    RtReduction reduction = {sizeof(Weight), weigh, weigh_node, self};
    RT_ARENA(arena);
    RtReducedParts parts;
    Weight whole;
    *self = (RtWidePlan){.tree = tree,
                         .geometry = geometry,
                         .how = how,
                         .scale = scale_for(tree),
                         .all_triangles = geometry->triangle_count == geometry->object_count,
                         .choices = rt_alloc_unset(tree->used, sizeof(RtWideChoice))};
    if (!self->choices)
        return rt_fail_memory(error, "the plan of a hierarchy", tree->used * sizeof(RtWideChoice));
    RT_TRY(rt_tree_reduce(tree, &reduction, &arena, how->threads, &parts, &whole, error));
    self->units = whole.units[0] + (rt_wide_becomes_leaf(self, tree->root) ? RT_WIDE_NODE_UNITS : 0);
    return RT_OK;
}

void rt_wide_plan_clear(RtWidePlan *self) {
    rt_free(self->choices);
    self->choices = NULL;
}

/* ---- following the choices ---- */

/* The roots of the forest of at most `most` subtrees below `index`, appended to children[0..*count). */
static void open_children(const RtWidePlan *self, uint32_t index, uint32_t most, uint32_t *children,
                          uint32_t *count) {
    const RtWideChoice *chosen = &self->choices[index];
    RtTreeLeaf leaf;
    bool whole = rt_tree_get_leaf(self->tree, index, &leaf);
    while (!whole && most > 1 && chosen->choice[most - 1] == RT_WIDE_FEWER) most--;
    if (whole || most == 1) {
        children[(*count)++] = index;
        return;
    }
    const uint32_t *child = self->tree->nodes[index].child;
    uint32_t left = chosen->choice[most - 1];
    open_children(self, child[0], left, children, count);
    open_children(self, child[1], most - left, children, count);
}

static float priority_of_child(const RtWidePlan *self, uint32_t index) {
    RtTreeLeaf leaf;
    Weight own;
    if (!rt_tree_get_leaf(self->tree, index, &leaf)) return self->choices[index].priority;
    weigh_reference(self, leaf, &own);
    return priority_of(own.surface, area_of(self, leaf.box), own.cost[0]);
}

static void sort_by_priority(const RtWidePlan *self, uint32_t *children, uint32_t count) {
    float priority[RT_WIDE];
    for (uint32_t i = 0; i < count; i++) {
        uint32_t child = children[i], j = i;
        float own = priority_of_child(self, child);
        for (; j > 0 && own < priority[j - 1]; j--) {
            children[j] = children[j - 1];
            priority[j] = priority[j - 1];
        }
        children[j] = child;
        priority[j] = own;
    }
}

uint32_t rt_wide_children_of(const RtWidePlan *self, uint32_t index, uint32_t children[RT_WIDE]) {
    uint32_t count = 0;
    if (rt_wide_becomes_leaf(self, index)) {
        children[count++] = index;
        return count;
    }
    const uint32_t *child = self->tree->nodes[index].child;
    uint32_t left = self->choices[index].choice[0];
    open_children(self, child[0], left, children, &count);
    open_children(self, child[1], RT_WIDE - left, children, &count);
    sort_by_priority(self, children, count);
    return count;
}
