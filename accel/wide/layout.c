/* SPDX-License-Identifier: Apache-2.0 */
/* From a binary tree of references to nodes of eight children.
 *
 * Which subtrees become leaves, and which nodes are opened into their parents, is decided together, for the
 * least expected cost (Ylitie, Karras & Laine 2017, "Efficient Incoherent Ray Traversal on GPUs Through
 * Compressed Wide BVHs", section 2.3): let cost(n, k) be what the least costly forest of at most k subtrees
 * costs that holds what is below n. Then
 *
 *     cost(n, 1) = min(leaf(n), area(n) + split(n, 8)),
 *     cost(n, k) = min(cost(n, k - 1), split(n, k)),
 *     split(n, k) = min over i of cost(left, i) + cost(right, k - i),
 *
 * and the choices that were made lead from the root down.
 *
 * In the arena a node is followed by its leaves, side by side, and these by what is below its inner children,
 * one after the other. How much room each forest takes is found together with its cost, so that every subtree
 * has its place before any is there: subtrees are weighed, and placed, by whichever thread comes first, and
 * the arena is that of one thread. */
#include "accel/wide/wide.h"

#include "base/memory.h"
#include "base/parallel.h"

#include <assert.h>
#include <string.h>

/* choice[k - 1]: how many of k subtrees the left child gets; FEWER: k - 1 will do; for k = 1 LEAF or what of
 * eight the left child gets. */
enum { FEWER = 0, LEAF = 255 };

/* The top of the binary tree goes so far down; what hangs below is weighed by one thread each. */
enum { TOP_LEVELS = 9, MAX_PARTS = 1 << TOP_LEVELS };

/* Subtrees that take no more than such a part of the arena are placed by one thread each. */
enum { SHARES = 256 };

enum { NODE_UNITS = sizeof(RtWideNode) / RT_WIDE_UNIT, BLOCK_UNITS = sizeof(RtWideTriangles) / RT_WIDE_UNIT };

/* What a lane without a triangle costs, of a block. A block costs the same however full it is, so the least
 * cost alone would leave 2.8 triangles in a block of four where 3.0 cost as many steps: the dragon takes 75.6
 * bytes a triangle at 0, 73.1 at 0.05, 71.7 at 0.1 and 71.1 at 0.2, with 13.2 steps of a diffuse ray at each
 * and 3 % more triangles in the blocks at 0.1. A part of the area at hand, it does not know how large the
 * scene is around. */
#define EMPTY_LANE 0.1f

/* More references do not fit into an arena, be they of triangles; the units of as many fit into 32 bits. */
enum { MAX_REFERENCES = RT_MAX_OBJECTS };
static_assert(MAX_REFERENCES * (uint64_t)(NODE_UNITS + BLOCK_UNITS) <= UINT32_MAX,
              "units are counted in 32 bits");
static_assert(MAX_REFERENCES * sizeof(RtWideTriangles) / RT_WIDE_BLOCK >= RT_WIDE_MAX_BYTES,
              "as MAX_REFERENCES says");

/* What became of an inner node of the binary tree. */
typedef struct Plan {
    uint8_t choice[RT_WIDE];
    uint32_t units; /* of the arena, if it is a child */
} Plan;

/* What a subtree holds, and what it costs, and takes, as a forest of at most k + 1 subtrees. */
typedef struct Weight {
    float cost[RT_WIDE];
    uint32_t units[RT_WIDE];
    uint32_t references;
    uint32_t shapes; /* bits 1 << RtShape */
    bool too_deep;   /* it reaches below RT_TREE_MAX_DEPTH; the rest is not known then */
} Weight;

/* A subtree below the top. */
typedef struct Part {
    uint32_t index, levels; /* its root; and how many more there may be below it */
    Weight weight;
} Part;

/* A subtree that is to be placed: the node of the binary tree, and where its own will be. */
typedef struct Task {
    uint32_t index, at;
    uint32_t nodes; /* then: that were made */
    double cost;    /* and what they cost, times the area of the root */
} Task;

typedef struct Layout {
    RtWideTree *self;
    const RtTree *tree;
    const RtGeometry *geometry;
    const RtWideLayout *how;
    Plan *plans; /* [tree->used] of inner nodes */
    Part *parts; /* [part_count] from left to right */
    uint32_t part_count, next;
    Task *tasks; /* [task_count] */
    uint32_t task_count, task_capacity;
    uint32_t task_units; /* of a task at most */
    bool all_triangles;
} Layout;

static uint32_t shape_of(const Layout *layout, uint32_t id) {
    return layout->all_triangles ? RT_SHAPE_TRIANGLE : rt_ref_shape(layout->geometry->objects[id]);
}

static uint32_t blocks_of(uint32_t count) {
    return (count + RT_WIDE_BLOCK - 1) / RT_WIDE_BLOCK;
}

/* ids[0..*count): the objects of a subtree, each once. */
static void collect(const Layout *layout, uint32_t index, uint32_t *ids, uint32_t *count) {
    const uint32_t *child = layout->tree->nodes[index].child;
    if (rt_tree_is_leaf(layout->tree, index)) {
        for (uint32_t i = 0; i < *count && layout->tree->divided; i++) {
            if (ids[i] == child[1]) return;
        }
        ids[(*count)++] = child[1];
        return;
    }
    for (int s = 0; s < 2; s++) collect(layout, child[s], ids, count);
}

/* ---- what is best ---- */

/* A leaf of `count` objects: its tests, what it takes, and lanes that stay empty. */
typedef struct LeafSize {
    uint32_t tests, units, empty;
} LeafSize;

static LeafSize leaf_size(uint32_t count, uint32_t shapes) {
    uint32_t blocks = blocks_of(count);
    bool triangles = shapes == 1u << RT_SHAPE_TRIANGLE;
    return triangles ? (LeafSize){blocks, blocks * BLOCK_UNITS, blocks * RT_WIDE_BLOCK - count}
                     : (LeafSize){count, sizeof(RtWideList) / RT_WIDE_UNIT, 0};
}

static float leaf_cost(const Layout *layout, float area, LeafSize size) {
    return area * (float)layout->how->block_cost * ((float)size.tests + EMPTY_LANE * (float)size.empty);
}

static float area_of(const Layout *layout, uint32_t index) {
    return (float)rt_box_half_area(layout->tree->nodes[index].box);
}

static void weigh_reference(const Layout *layout, uint32_t index, Weight *own) {
    own->references = 1;
    own->shapes = 1u << shape_of(layout, layout->tree->nodes[index].child[1]);
    own->too_deep = false;
    LeafSize size = leaf_size(1, own->shapes);
    float cost = leaf_cost(layout, area_of(layout, index), size);
    for (int k = 0; k < RT_WIDE; k++) {
        own->cost[k] = cost;
        own->units[k] = size.units;
    }
}

/* split[k], left[k]: the least cost of k + 1 subtrees, of which so many are left. */
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

/* Where a subtree of few enough references costs no more as a leaf, it is one. */
static void consider_leaf(const Layout *layout, uint32_t index, float area, Weight *own, Plan *plan) {
    uint32_t count = own->references;
    if (count > layout->how->leaf_limit) return;
    if (layout->tree->divided) {
        uint32_t ids[RT_WIDE_MAX_LEAF];
        count = 0;
        collect(layout, index, ids, &count);
    }
    LeafSize size = leaf_size(count, own->shapes);
    float cost = leaf_cost(layout, area, size);
    if (!(cost <= own->cost[0])) return;
    own->cost[0] = cost;
    own->units[0] = size.units;
    plan->choice[0] = LEAF;
}

static void weigh_both(const Layout *layout, uint32_t index, const Weight *sides[2], Weight *own) {
    Plan *plan = &layout->plans[index];
    float area = area_of(layout, index), split[RT_WIDE];
    int32_t left[RT_WIDE];
    own->references = sides[0]->references + sides[1]->references;
    own->shapes = sides[0]->shapes | sides[1]->shapes;
    own->too_deep = sides[0]->too_deep || sides[1]->too_deep;
    if (own->too_deep) return;
    split_costs(sides, split, left);
    int all = left[RT_WIDE - 1];
    memset(plan, 0, sizeof *plan);
    plan->choice[0] = (uint8_t)all;
    own->cost[0] = area + split[RT_WIDE - 1];
    own->units[0] = NODE_UNITS + sides[0]->units[all - 1] + sides[1]->units[RT_WIDE - all - 1];
    consider_leaf(layout, index, area, own, plan);
    for (int k = 1; k < RT_WIDE; k++) {
        bool fewer = !(split[k] < own->cost[k - 1]);
        own->cost[k] = fewer ? own->cost[k - 1] : split[k];
        own->units[k] =
            fewer ? own->units[k - 1] : sides[0]->units[left[k] - 1] + sides[1]->units[k - left[k]];
        plan->choice[k] = fewer ? FEWER : (uint8_t)left[k];
    }
    plan->units = own->units[0];
}

static void weigh(const Layout *layout, uint32_t index, uint32_t levels, Weight *own) {
    if (rt_tree_is_leaf(layout->tree, index)) {
        weigh_reference(layout, index, own);
        return;
    }
    own->too_deep = true;
    if (levels == 0) return;
    const uint32_t *child = layout->tree->nodes[index].child;
    Weight below[2];
    for (int s = 0; s < 2; s++) weigh(layout, child[s], levels - 1, &below[s]);
    weigh_both(layout, index, (const Weight *[2]){&below[0], &below[1]}, own);
}

static RtStatus weigh_part(void *context, size_t item, int thread, RtError *error) {
    Layout *layout = context;
    Part *part = &layout->parts[item];
    (void)thread;
    (void)error;
    weigh(layout, part->index, part->levels, &part->weight);
    return RT_OK;
}

static bool is_top(const Layout *layout, uint32_t index, uint32_t depth) {
    return depth < TOP_LEVELS && !rt_tree_is_leaf(layout->tree, index);
}

static void list_parts(Layout *layout, uint32_t index, uint32_t depth) {
    const uint32_t *child = layout->tree->nodes[index].child;
    if (!is_top(layout, index, depth)) {
        layout->parts[layout->part_count++] = (Part){.index = index, .levels = RT_TREE_MAX_DEPTH - depth};
        return;
    }
    for (int s = 0; s < 2; s++) list_parts(layout, child[s], depth + 1);
}

/* Of the parts in turn. */
static void weigh_top(Layout *layout, uint32_t index, uint32_t depth, Weight *own) {
    if (!is_top(layout, index, depth)) {
        *own = layout->parts[layout->next++].weight;
        return;
    }
    const uint32_t *child = layout->tree->nodes[index].child;
    Weight below[2];
    for (int s = 0; s < 2; s++) weigh_top(layout, child[s], depth + 1, &below[s]);
    weigh_both(layout, index, (const Weight *[2]){&below[0], &below[1]}, own);
}

static RtStatus weigh_all(Layout *layout, Weight *whole, RtError *error) {
    layout->part_count = layout->next = 0;
    list_parts(layout, layout->tree->root, 0);
    RT_TRY(rt_parallel_for(layout->part_count, layout->how->threads, weigh_part, layout, error));
    weigh_top(layout, layout->tree->root, 0, whole);
    return RT_OK;
}

/* ---- what was chosen ---- */

static bool becomes_leaf(const Layout *layout, uint32_t index) {
    return rt_tree_is_leaf(layout->tree, index) || layout->plans[index].choice[0] == LEAF;
}

/* The roots of the forest of at most `most` subtrees below `index`, appended to children[0..*count). */
static void open_children(const Layout *layout, uint32_t index, uint32_t most, uint32_t *children,
                          uint32_t *count) {
    const Plan *plan = &layout->plans[index];
    bool whole = rt_tree_is_leaf(layout->tree, index);
    while (!whole && most > 1 && plan->choice[most - 1] == FEWER) most--;
    if (whole || most == 1) {
        children[(*count)++] = index;
        return;
    }
    const uint32_t *child = layout->tree->nodes[index].child;
    uint32_t left = plan->choice[most - 1];
    open_children(layout, child[0], left, children, count);
    open_children(layout, child[1], most - left, children, count);
}

/* The children of a node; of the root that is a leaf, itself. */
static uint32_t children_of(const Layout *layout, uint32_t index, uint32_t children[RT_WIDE]) {
    uint32_t count = 0;
    if (becomes_leaf(layout, index)) {
        children[count++] = index;
        return count;
    }
    const uint32_t *child = layout->tree->nodes[index].child;
    uint32_t left = layout->plans[index].choice[0];
    open_children(layout, child[0], left, children, &count);
    open_children(layout, child[1], RT_WIDE - left, children, &count);
    return count;
}

/* ---- placing ---- */

/* Leaves wait until what is in them has come from memory. */
enum { WAITING = 16 };

typedef struct Leaf {
    uint32_t ids[RT_WIDE_MAX_LEAF], count, at;
    bool triangles;
} Leaf;

/* One thread's. */
typedef struct Placer {
    Layout *layout;
    Leaf leaves[WAITING]; /* in turns: the last `waiting` before `turn` */
    uint32_t turn, waiting;
    uint32_t nodes; /* made */
    double cost;    /* of these: visits of nodes and tests of blocks, times area */
    bool top;       /* what is small is left as a task */
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

static void fill_leaf(const Layout *layout, const Leaf *leaf) {
    void *place = layout->self->arena + leaf->at;
    RtWideList *list = place;
    RtWideTriangles *blocks = place;
    if (!leaf->triangles) {
        for (uint32_t i = 0; i < RT_WIDE_MAX_LEAF; i++)
            list->id[i] = i < leaf->count ? leaf->ids[i] : RT_NO_OBJECT;
        return;
    }
    for (uint32_t i = 0; i < leaf->count; i += RT_WIDE_BLOCK)
        fill_block(layout, blocks++, leaf->ids + i, leaf->count - i);
}

static void fill_waiting(Placer *placer, uint32_t most) {
    for (; placer->waiting > most; placer->waiting--)
        fill_leaf(placer->layout, &placer->leaves[(placer->turn - placer->waiting) % WAITING]);
}

/* Makes a leaf at *at, which goes on to where it ends. */
static RtWideRef place_leaf(Placer *placer, uint32_t index, uint32_t *at) {
    const Layout *layout = placer->layout;
    fill_waiting(placer, WAITING - 1);
    Leaf *leaf = &placer->leaves[placer->turn++ % WAITING];
    uint32_t shapes = 0;
    placer->waiting++;
    leaf->count = 0;
    collect(layout, index, leaf->ids, &leaf->count);
    for (uint32_t i = 0; i < leaf->count; i++) shapes |= 1u << shape_of(layout, leaf->ids[i]);
    leaf->triangles = shapes == 1u << RT_SHAPE_TRIANGLE;
    for (uint32_t i = 0; i < leaf->count && leaf->triangles; i++) {
        const RtTriangle *triangle = triangle_of(layout, leaf->ids[i]);
        __builtin_prefetch(triangle);
        __builtin_prefetch((const char *)(triangle + 1) - 1);
    }
    leaf->at = *at;
    LeafSize size = leaf_size(leaf->count, shapes);
    placer->cost += rt_box_half_area(layout->tree->nodes[index].box) * layout->how->block_cost * size.tests;
    *at += size.units * RT_WIDE_UNIT;
    return rt_wide_leaf(leaf->triangles ? RT_WIDE_TRIANGLES : RT_WIDE_OBJECTS, leaf->at, leaf->count);
}

static void put_box(RtWideNode *node, uint32_t lane, RtBox box) {
    for (int p = 0; p < 6; p++) node->plane[p][lane] = (p % 2 ? box.hi : box.lo).at[p / 2];
}

static void place_node(Placer *placer, uint32_t at, uint32_t index);

/* What is below an inner child: now, or later by another thread. */
static void place_below(Placer *placer, uint32_t at, uint32_t index) {
    Layout *layout = placer->layout;
    if (!placer->top || layout->plans[index].units > layout->task_units) {
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
    RtWideNode *node = (RtWideNode *)(void *)(layout->self->arena + at);
    uint32_t children[RT_WIDE] = {0}, count = children_of(layout, index, children);
    *node = (RtWideNode){.count = count};
    placer->nodes++;
    placer->cost += rt_box_half_area(layout->tree->nodes[index].box);
    at += sizeof(RtWideNode);
    for (uint32_t i = 0; i < RT_WIDE; i++) {
        put_box(node, i, i < count ? layout->tree->nodes[children[i]].box : RT_EMPTY_BOX);
        node->child[i] = RT_WIDE_DONE;
        if (i < count && becomes_leaf(layout, children[i]))
            node->child[i] = place_leaf(placer, children[i], &at);
    }
    for (uint32_t i = 0; i < count; i++) {
        if (node->child[i] != RT_WIDE_DONE) continue;
        node->child[i] = at;
        place_below(placer, at, children[i]);
        at += layout->plans[children[i]].units * RT_WIDE_UNIT;
    }
}

static RtStatus place_task(void *context, size_t item, int thread, RtError *error) {
    Layout *layout = context;
    Task *task = &layout->tasks[item];
    Placer placer = {.layout = layout, .error = error};
    (void)thread;
    place_node(&placer, task->at, task->index);
    fill_waiting(&placer, 0);
    task->nodes = placer.nodes;
    task->cost = placer.cost;
    return RT_OK;
}

static RtStatus place_all(Layout *layout, RtError *error) {
    Placer placer = {.layout = layout, .top = true, .error = error};
    layout->task_units = (uint32_t)(layout->self->bytes / RT_WIDE_UNIT / SHARES);
    place_node(&placer, 0, layout->tree->root);
    fill_waiting(&placer, 0);
    RT_TRY(placer.status);
    RT_TRY(rt_parallel_for(layout->task_count, layout->how->threads, place_task, layout, error));
    for (uint32_t i = 0; i < layout->task_count; i++) {
        placer.nodes += layout->tasks[i].nodes;
        placer.cost += layout->tasks[i].cost;
    }
    double area = rt_box_half_area(layout->tree->nodes[layout->tree->root].box);
    layout->self->node_count = placer.nodes;
    layout->self->cost = area > 0 ? placer.cost / area : NAN;
    return RT_OK;
}

/* ---- all of it ---- */

static RtStatus refuse(uint64_t bytes, uint64_t limit, RtError *error) {
    uint64_t most = limit < RT_WIDE_MAX_BYTES ? limit : RT_WIDE_MAX_BYTES;
    return rt_fail(
        error, RT_BAD_INPUT,
        "wide would take %.0f MB for this scene, the most is %.0f MB: take a larger max_leaf_size or bvh",
        (double)bytes * 1e-6, (double)most * 1e-6);
}

static RtStatus lay_out(Layout *layout, RtTree *tree, RtError *error) {
    RtWideTree *self = layout->self;
    const RtWideLayout *how = layout->how;
    Weight whole = {0};
    RT_TRY(weigh_all(layout, &whole, error));
    if (whole.too_deep) {
        RT_TRY(rt_tree_limit_depth(tree, error));
        RT_TRY(weigh_all(layout, &whole, error));
    }
    bool leaf = becomes_leaf(layout, tree->root);
    self->bytes = ((uint64_t)whole.units[0] + (leaf ? NODE_UNITS : 0)) * RT_WIDE_UNIT;
    self->divided = tree->divided;
    if (self->bytes > how->limit || self->bytes > RT_WIDE_MAX_BYTES)
        return refuse(self->bytes, how->limit, error);
    self->arena = how->huge_pages ? rt_alloc_unset(self->bytes, 1) : rt_alloc(self->bytes, 1);
    return self->arena ? place_all(layout, error) : rt_fail_memory(error, "a hierarchy", self->bytes);
}

RtStatus rt_wide_lay_out(RtWideTree *self, RtTree *tree, const RtGeometry *geometry, const RtWideLayout *how,
                         RtError *error) {
    uint32_t count = rt_tree_leaf_count(tree);
    *self = (RtWideTree){0};
    if (count > MAX_REFERENCES)
        return refuse((uint64_t)count * sizeof(RtWideTriangles) / RT_WIDE_BLOCK, how->limit, error);
    Layout layout = {.self = self,
                     .tree = tree,
                     .geometry = geometry,
                     .how = how,
                     .plans = rt_alloc_unset(tree->used, sizeof(Plan)),
                     .parts = rt_alloc(MAX_PARTS, sizeof(Part)),
                     .all_triangles = geometry->triangle_count == geometry->object_count};
    RtStatus status = layout.plans && layout.parts
                          ? lay_out(&layout, tree, error)
                          : rt_fail_memory(error, "the plan of a hierarchy", tree->used * sizeof(Plan));
    rt_free(layout.plans);
    rt_free(layout.parts);
    rt_free(layout.tasks);
    if (status != RT_OK) rt_wide_clear(self);
    return status;
}

void rt_wide_clear(RtWideTree *self) {
    rt_free(self->arena);
    *self = (RtWideTree){0};
}
