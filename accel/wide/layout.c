/* SPDX-License-Identifier: Apache-2.0 */
/* Lays out a binary tree of references eight wide: a plan says which subtrees become leaves, which nodes
 * merge into their parents, and how much space each takes; then nodes and leaves are placed.
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
 * cost. So the offset of every subtree is known before any is placed, threads place subtrees in any order,
 * and the arena is the same as by one thread. In it a node is followed by its leaves, and these by the
 * subtrees of its inner children. */
#include "accel/wide/wide.h"

#include "core/base/memory.h"
#include "core/base/parallel.h"

#include <assert.h>
#include <math.h>
#include <string.h>

enum { NODE_UNITS = sizeof(RtWideNode) / RT_WIDE_UNIT, BLOCK_UNITS = sizeof(RtWideTriangles) / RT_WIDE_UNIT };

/* No arena holds more references, and their units fit into 32 bits. */
enum { MAX_REFERENCES = RT_MAX_OBJECTS };
static_assert(MAX_REFERENCES * (uint64_t)(NODE_UNITS + BLOCK_UNITS) <= UINT32_MAX,
              "units are counted in 32 bits");
static_assert(MAX_REFERENCES * sizeof(RtWideTriangles) / RT_WIDE_BLOCK >= RT_WIDE_MAX_BYTES,
              "no arena holds more");

/* choice[k - 1]: how many of k subtrees the left child gets, or FEWER if k - 1 cost no more. For k = 1: LEAF,
 * or how many of eight the left child gets. */
enum { FEWER = 0, LEAF = 255 };

/* The choices for an inner node of the binary tree. */
typedef struct Choice {
    uint8_t choice[RT_WIDE];
    uint32_t units; /* of the arena, if it is a child */
    float priority; /* for any-hit rays */
} Choice;

/* A subtree to be placed: the node of the binary tree, and its offset in the arena, in units. */
typedef struct Task {
    uint32_t index, at;
    uint32_t nodes; /* result: nodes made */
    double cost;    /* result: their cost, times the area of the root */
} Task;

typedef struct Layout {
    RtWideTree *self;
    RtTree *tree; /* complete */
    const RtGeometry *geometry;
    const RtWideLayout *how;
    double scale;       /* of areas in costs */
    bool all_triangles; /* object i is triangle i */
    Choice *choices;    /* [tree->used] of inner nodes */
    Task *tasks;        /* [task_count] */
    uint32_t task_count, task_capacity;
    uint32_t task_units; /* largest subtree that is a task */
} Layout;

static uint32_t shape_of(const Layout *self, uint32_t id) {
    return self->all_triangles ? RT_SHAPE_TRIANGLE : rt_ref_shape(self->geometry->objects[id]);
}

static bool becomes_leaf(const Layout *self, uint32_t index) {
    RtTreeLeaf leaf;
    return rt_tree_get_leaf(self->tree, index, &leaf) || self->choices[index].choice[0] == LEAF;
}

/* Writes the objects of a subtree, each once, to ids[0..*count). *count must be 0. */
static void collect(const RtTree *tree, uint32_t index, uint32_t *ids, uint32_t *count) {
    RtTreeLeaf leaf;
    if (rt_tree_get_leaf(tree, index, &leaf)) {
        for (uint32_t i = 0; i < *count && tree->split_refs; i++) {
            if (ids[i] == leaf.object) return;
        }
        ids[(*count)++] = leaf.object;
        return;
    }
    for (int s = 0; s < 2; s++) collect(tree, tree->nodes[index].child[s], ids, count);
}

/* ---- the plan ---- */

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

/* A leaf of `count` objects of these shapes (bits 1 << RtShape): its kind, its tests, its units of the arena,
 * and its empty lanes. */
typedef struct LeafSize {
    RtWideKind kind;
    uint32_t tests, units, empty;
} LeafSize;

static LeafSize leaf_size(uint32_t count, uint32_t shapes) {
    const uint32_t blocks = (count + RT_WIDE_BLOCK - 1) / RT_WIDE_BLOCK;
    if (shapes == 1u << RT_SHAPE_TRIANGLE)
        return (LeafSize){RT_WIDE_TRIANGLES, blocks, blocks * BLOCK_UNITS, blocks * RT_WIDE_BLOCK - count};
    RtWideKind kind = shapes == 1u << RT_SHAPE_SPHERE ? RT_WIDE_SPHERES : RT_WIDE_OBJECTS;
    return (LeafSize){kind, count, sizeof(RtWideList) / RT_WIDE_UNIT, 0};
}

static float leaf_cost(const Layout *self, float area, LeafSize size) {
    return area * (float)self->how->block_cost * ((float)size.tests + EMPTY_LANE * (float)size.empty);
}

static float area_of(const Layout *self, const RtBox *box) {
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
static float surface_of(const Layout *self, const RtBox *box) {
    RtVec3 d = rt_sub(box->hi, box->lo);
    double xy = (double)d.x * (double)d.y, yz = (double)d.y * (double)d.z, zx = (double)d.z * (double)d.x;
    return (float)(0.5 * sqrt(xy * xy + yz * yz + zx * zx) * self->scale);
}

/* A line through a box of half area `area` hits surface / area objects on average, so at least one with
 * probability near surface / (surface + area), at an expected cost of cost / area. */
static float priority_of(float surface, float area, float cost) {
    return area > 0 && cost > 0 ? surface / (surface + area) * (area / cost) : 0;
}

static void weigh_reference(const Layout *self, RtTreeLeaf leaf, Weight *own) {
    own->references = 1;
    own->surface = surface_of(self, leaf.box);
    own->shapes = 1u << shape_of(self, leaf.object);
    LeafSize size = leaf_size(1, own->shapes);
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
static void consider_leaf(const Layout *self, uint32_t index, float area, Weight *own, Choice *chosen) {
    uint32_t count = own->references;
    if (count > self->how->max_leaf_size) return;
    if (self->tree->split_refs) {
        uint32_t ids[RT_WIDE_MAX_LEAF];
        count = 0;
        collect(self->tree, index, ids, &count);
    }
    LeafSize size = leaf_size(count, own->shapes);
    float cost = leaf_cost(self, area, size);
    if (!(cost <= own->cost[0])) return;
    own->cost[0] = cost;
    own->units[0] = size.units;
    chosen->choice[0] = LEAF;
}

/* weigh_both for two references, the most frequent case: the same result, sooner. */
static void weigh_pair(const Layout *self, uint32_t index, const Weight *sides[2], Weight *own) {
    Choice *chosen = &self->choices[index];
    float area = area_of(self, &self->tree->nodes[index].box), split = sides[0]->cost[0] + sides[1]->cost[0];
    uint32_t units = sides[0]->units[0] + sides[1]->units[0];
    memset(chosen, 0, sizeof *chosen);
    chosen->choice[0] = 1;
    own->cost[0] = area + split;
    own->units[0] = NODE_UNITS + units;
    consider_leaf(self, index, area, own, chosen);
    bool two = split < own->cost[0];
    for (int k = 1; k < RT_WIDE; k++) {
        own->cost[k] = two ? split : own->cost[0];
        own->units[k] = two ? units : own->units[0];
    }
    chosen->choice[1] = two ? 1 : FEWER;
    chosen->units = own->units[0];
    chosen->priority = priority_of(own->surface, area, own->cost[0]);
}

static void weigh_both(const Layout *self, uint32_t index, const Weight *sides[2], Weight *own) {
    Choice *chosen = &self->choices[index];
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
    own->units[0] = NODE_UNITS + sides[0]->units[all - 1] + sides[1]->units[RT_WIDE - all - 1];
    consider_leaf(self, index, area, own, chosen);
    for (int k = 1; k < RT_WIDE; k++) {
        bool fewer = !(split[k] < own->cost[k - 1]);
        own->cost[k] = fewer ? own->cost[k - 1] : split[k];
        own->units[k] =
            fewer ? own->units[k - 1] : sides[0]->units[left[k] - 1] + sides[1]->units[k - left[k]];
        chosen->choice[k] = fewer ? FEWER : (uint8_t)left[k];
    }
    chosen->units = own->units[0];
    chosen->priority = priority_of(own->surface, area, own->cost[0]);
}

static bool weigh(void *context, uint32_t index, uint32_t levels, void *weight) {
    const Layout *self = context;
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

/* Chooses for the whole tree, and sets the size of the arena. */
static RtStatus make_plan(Layout *self, RtError *error) {
    RtReduction reduction = {sizeof(Weight), weigh, weigh_node, self};
    RT_ARENA(work);
    RtReducedParts parts;
    Weight whole;
    RT_TRY(rt_tree_reduce(self->tree, &reduction, &work, self->how->threads, &parts, &whole, error));
    const uint32_t units = whole.units[0] + (becomes_leaf(self, self->tree->root) ? NODE_UNITS : 0);
    self->self->bytes = (uint64_t)units * RT_WIDE_UNIT;
    return RT_OK;
}

/* ---- following the choices ---- */

/* The roots of the forest of at most `most` subtrees below `index`, appended to children[0..*count). */
static void open_children(const Layout *self, uint32_t index, uint32_t most, uint32_t *children,
                          uint32_t *count) {
    const Choice *chosen = &self->choices[index];
    RtTreeLeaf leaf;
    bool whole = rt_tree_get_leaf(self->tree, index, &leaf);
    while (!whole && most > 1 && chosen->choice[most - 1] == FEWER) most--;
    if (whole || most == 1) {
        children[(*count)++] = index;
        return;
    }
    const uint32_t *child = self->tree->nodes[index].child;
    uint32_t left = chosen->choice[most - 1];
    open_children(self, child[0], left, children, count);
    open_children(self, child[1], most - left, children, count);
}

static float priority_of_child(const Layout *self, uint32_t index) {
    RtTreeLeaf leaf;
    Weight own;
    if (!rt_tree_get_leaf(self->tree, index, &leaf)) return self->choices[index].priority;
    weigh_reference(self, leaf, &own);
    return priority_of(own.surface, area_of(self, leaf.box), own.cost[0]);
}

static void sort_by_priority(const Layout *self, uint32_t *children, uint32_t count) {
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

/* Writes the children of a subtree that becomes a node, and returns their number. A root that is a leaf is
 * its own only child. Children are sorted by ascending priority: the probability that a random line through a
 * child's box hits an object, divided by the expected cost. Any-hit rays visit the last child first, which
 * minimises the expected cost. (Nah & Manocha 2014, "SATO: Surface Area Traversal Order for Shadow Ray
 * Tracing".) */
static uint32_t children_of(const Layout *self, uint32_t index, uint32_t children[RT_WIDE]) {
    uint32_t count = 0;
    if (becomes_leaf(self, index)) {
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

/* ---- placing ---- */

/* A subtree that takes at most this fraction (1 / SHARES) of the arena is placed by one thread. */
enum { SHARES = 256 };

/* Leaves are filled some time after their triangles are prefetched. */
enum { WAITING = 16 };

typedef struct Leaf {
    uint32_t ids[RT_WIDE_MAX_LEAF], count;
    uint32_t at; /* in units */
    RtWideKind kind;
} Leaf;

/* The state of one thread. */
typedef struct Placer {
    Layout *layout;
    Leaf leaves[WAITING]; /* a ring: the last `waiting` before `turn` */
    uint32_t turn, waiting;
    uint32_t nodes; /* made */
    double cost;    /* of their visits and of tests of blocks, times area */
    bool top;       /* small subtrees become tasks */
    RtStatus status;
    RtError *error;
} Placer;

static const RtTriangle *triangle_of(const Layout *layout, uint32_t id) {
    const RtGeometry *g = layout->geometry;
    return &g->triangles[layout->all_triangles ? id : rt_ref_index(g->objects[id])];
}

static void fill_block(const Layout *layout, RtWideTriangles *block, const uint32_t *ids, uint32_t count) {
    for (uint32_t lane = 0; lane < RT_WIDE_BLOCK; lane++) {
        const RtTriangle *triangle = lane < count ? triangle_of(layout, ids[lane]) : NULL;
        for (int c = 0; c < 9; c++)
            block->v[c / 3][c % 3][lane] = triangle ? triangle->v[c / 3].at[c % 3] : NAN;
        block->id[lane] = triangle ? ids[lane] : RT_NO_OBJECT;
    }
}

static void *place_at(const Layout *layout, uint32_t units) {
    return layout->self->arena + (size_t)units * RT_WIDE_UNIT;
}

static void fill_leaf(const Layout *layout, const Leaf *leaf) {
    const RtGeometry *g = layout->geometry;
    void *place = place_at(layout, leaf->at);
    RtWideTriangles *blocks = place;
    RtWideSphere *sphere = place;
    RtWideList *list = place;
    if (leaf->kind == RT_WIDE_TRIANGLES) {
        for (uint32_t i = 0; i < leaf->count; i += RT_WIDE_BLOCK)
            fill_block(layout, blocks++, leaf->ids + i, leaf->count - i);
    } else if (leaf->kind == RT_WIDE_SPHERES && leaf->count == 1) {
        *sphere = (RtWideSphere){g->spheres[rt_ref_index(g->objects[leaf->ids[0]])], leaf->ids[0], {0}};
    } else {
        for (uint32_t i = 0; i < RT_WIDE_MAX_LEAF; i++)
            list->id[i] = i < leaf->count ? leaf->ids[i] : RT_NO_OBJECT;
    }
}

static void fill_waiting(Placer *placer, uint32_t most) {
    for (; placer->waiting > most; placer->waiting--)
        fill_leaf(placer->layout, &placer->leaves[(placer->turn - placer->waiting) % WAITING]);
}

/* Makes a leaf at *at and advances *at to its end. */
static RtWideRef place_leaf(Placer *placer, uint32_t index, uint32_t *at) {
    const Layout *layout = placer->layout;
    fill_waiting(placer, WAITING - 1);
    Leaf *leaf = &placer->leaves[placer->turn++ % WAITING];
    uint32_t shapes = 0;
    placer->waiting++;
    leaf->count = 0;
    collect(layout->tree, index, leaf->ids, &leaf->count);
    for (uint32_t i = 0; i < leaf->count; i++) shapes |= 1u << shape_of(layout, leaf->ids[i]);
    LeafSize size = leaf_size(leaf->count, shapes);
    leaf->kind = size.kind;
    for (uint32_t i = 0; i < leaf->count && leaf->kind == RT_WIDE_TRIANGLES; i++) {
        const RtTriangle *triangle = triangle_of(layout, leaf->ids[i]);
        __builtin_prefetch(triangle);
        __builtin_prefetch((const char *)(triangle + 1) - 1);
    }
    leaf->at = *at;
    placer->cost += rt_box_half_area(rt_tree_box(layout->tree, index)) * layout->how->block_cost * size.tests;
    *at += size.units;
    return rt_wide_ref(leaf->at, leaf->kind,
                       leaf->count > (leaf->kind == RT_WIDE_TRIANGLES ? RT_WIDE_BLOCK : 1));
}

static void put_box(RtWideNode *node, uint32_t lane, RtBox box) {
    for (int p = 0; p < 6; p++) node->plane[p][lane] = (p % 2 ? box.hi : box.lo).at[p / 2];
}

static void place_node(Placer *placer, uint32_t at, uint32_t index);

/* Places the subtree of an inner child, or makes it a task. */
static void place_below(Placer *placer, uint32_t at, uint32_t index) {
    Layout *layout = placer->layout;
    if (!placer->top || layout->choices[index].units > layout->task_units) {
        place_node(placer, at, index);
        return;
    }
    if (placer->status == RT_OK)
        placer->status = rt_reserve(&layout->tasks, &layout->task_capacity, (uint64_t)layout->task_count + 1,
                                    sizeof(Task), placer->error);
    if (placer->status == RT_OK) layout->tasks[layout->task_count++] = (Task){.index = index, .at = at};
}

static void place_node(Placer *placer, uint32_t at, uint32_t index) {
    const Layout *layout = placer->layout;
    RtWideNode *node = place_at(layout, at);
    uint32_t children[RT_WIDE] = {0}, count = children_of(layout, index, children);
    *node = (RtWideNode){.count = count};
    placer->nodes++;
    placer->cost += rt_box_half_area(rt_tree_box(layout->tree, index));
    at += NODE_UNITS;
    for (uint32_t i = 0; i < RT_WIDE; i++) {
        put_box(node, i, i < count ? rt_tree_box(layout->tree, children[i]) : RT_EMPTY_BOX);
        node->child[i] = RT_WIDE_DONE;
        if (i < count && becomes_leaf(layout, children[i]))
            node->child[i] = place_leaf(placer, children[i], &at);
    }
    for (uint32_t i = 0; i < count; i++) {
        if (node->child[i] != RT_WIDE_DONE) continue;
        node->child[i] = rt_wide_ref(at, RT_WIDE_NODE, false);
        place_below(placer, at, children[i]);
        at += layout->choices[children[i]].units;
    }
}

static void place_task(void *context, size_t item) {
    Layout *layout = context;
    Task *task = &layout->tasks[item];
    Placer placer = {.layout = layout};
    place_node(&placer, task->at, task->index);
    fill_waiting(&placer, 0);
    task->nodes = placer.nodes;
    task->cost = placer.cost;
}

static RtStatus place_all(Layout *layout, RtError *error) {
    Placer placer = {.layout = layout, .top = true, .error = error};
    layout->task_units = (uint32_t)(layout->self->bytes / RT_WIDE_UNIT / SHARES);
    place_node(&placer, 0, layout->tree->root);
    fill_waiting(&placer, 0);
    RT_TRY(placer.status);
    RT_TRY(rt_parallel_each(layout->task_count, layout->how->threads, place_task, layout, error));
    for (uint32_t i = 0; i < layout->task_count; i++) {
        placer.nodes += layout->tasks[i].nodes;
        placer.cost += layout->tasks[i].cost;
    }
    double area = rt_box_half_area(rt_tree_box(layout->tree, layout->tree->root));
    layout->self->node_count = placer.nodes;
    layout->self->cost = area > 0 ? placer.cost / area : NAN;
    return RT_OK;
}

/* ---- the whole tree ---- */

static RtStatus refuse(uint64_t bytes, uint64_t limit, RtError *error) {
    uint64_t most = limit < RT_WIDE_MAX_BYTES ? limit : RT_WIDE_MAX_BYTES;
    return rt_fail(
        error, RT_BAD_INPUT,
        "wide would take %.0f MB for this scene, more than %.0f MB: choose a larger max_leaf_size, or bvh",
        (double)bytes * 1e-6, (double)most * 1e-6);
}

RtStatus rt_wide_lay_out(RtWideTree *self, RtTree *tree, const RtGeometry *geometry, const RtWideLayout *how,
                         RtArena *memory, RtError *error) {
    RT_ARENA(work);
    const uint32_t count = rt_tree_leaf_count(tree);
    *self = (RtWideTree){.split_refs = tree->split_refs};
    if (count > MAX_REFERENCES)
        return refuse((uint64_t)count * sizeof(RtWideTriangles) / RT_WIDE_BLOCK, how->limit, error);
    Layout layout = {.self = self,
                     .tree = tree,
                     .geometry = geometry,
                     .how = how,
                     .scale = scale_for(tree),
                     .all_triangles = geometry->triangle_count == geometry->object_count,
                     .choices = rt_arena_alloc_unset(&work, tree->used, sizeof(Choice))};
    RT_TRY(rt_arena_check(&work, "the plan of a hierarchy", error));
    RT_TRY(make_plan(&layout, error));
    if (self->bytes > how->limit || self->bytes > RT_WIDE_MAX_BYTES)
        return refuse(self->bytes, how->limit, error);
    self->arena = how->huge_pages ? rt_arena_alloc_unset(memory, self->bytes, 1)
                                  : rt_arena_alloc(memory, self->bytes, 1);
    RT_TRY(rt_arena_check(memory, "a hierarchy", error));
    const RtStatus status = place_all(&layout, error);
    rt_free(layout.tasks);
    return status;
}
