/* SPDX-License-Identifier: Apache-2.0 */
/* Lays out nodes of eight children and their leaves by a plan (plan.h).
 *
 * In the arena a node is followed by its leaves, and these by the subtrees of its inner children. The offset
 * of every subtree is known in advance. So threads place subtrees in any order, and the arena is the same as
 * by one thread. */
#include "accel/wide/plan.h"

#include "core/base/memory.h"
#include "core/base/parallel.h"

#include <assert.h>

/* A subtree that takes at most this fraction (1 / SHARES) of the arena is placed by one thread. */
enum { SHARES = 256 };

/* No arena holds more references, and their units fit into 32 bits. */
enum { MAX_REFERENCES = RT_MAX_OBJECTS };
static_assert(MAX_REFERENCES * (uint64_t)(RT_WIDE_NODE_UNITS + RT_WIDE_BLOCK_UNITS) <= UINT32_MAX,
              "units are counted in 32 bits");
static_assert(MAX_REFERENCES * sizeof(RtWideTriangles) / RT_WIDE_BLOCK >= RT_WIDE_MAX_BYTES,
              "no arena holds more");

/* A subtree to be placed: the node of the binary tree, and its offset in the arena, in units. */
typedef struct Task {
    uint32_t index, at;
    uint32_t nodes; /* result: nodes made */
    double cost;    /* result: their cost, times the area of the root */
} Task;

typedef struct Layout {
    RtWideTree *self;
    RtWidePlan plan;
    Task *tasks; /* [task_count] */
    uint32_t task_count, task_capacity;
    uint32_t task_units; /* largest subtree that is a task */
} Layout;

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
    const RtGeometry *g = layout->plan.geometry;
    return &g->triangles[layout->plan.all_triangles ? id : rt_ref_index(g->objects[id])];
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
    const RtGeometry *g = layout->plan.geometry;
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
    rt_wide_collect(layout->plan.tree, index, leaf->ids, &leaf->count);
    for (uint32_t i = 0; i < leaf->count; i++) shapes |= 1u << rt_wide_shape_of(&layout->plan, leaf->ids[i]);
    RtWideLeafSize size = rt_wide_leaf_size(leaf->count, shapes);
    leaf->kind = size.kind;
    for (uint32_t i = 0; i < leaf->count && leaf->kind == RT_WIDE_TRIANGLES; i++) {
        const RtTriangle *triangle = triangle_of(layout, leaf->ids[i]);
        __builtin_prefetch(triangle);
        __builtin_prefetch((const char *)(triangle + 1) - 1);
    }
    leaf->at = *at;
    placer->cost +=
        rt_box_half_area(rt_tree_box(layout->plan.tree, index)) * layout->plan.how->block_cost * size.tests;
    *at += size.units;
    const uint32_t one = leaf->kind == RT_WIDE_TRIANGLES ? RT_WIDE_BLOCK : 1;
    return rt_wide_ref(leaf->at, leaf->kind, leaf->count > one);
}

static void put_box(RtWideNode *node, uint32_t lane, RtBox box) {
    for (int p = 0; p < 6; p++) node->plane[p][lane] = (p % 2 ? box.hi : box.lo).at[p / 2];
}

static void place_node(Placer *placer, uint32_t at, uint32_t index);

/* Places the subtree of an inner child, or makes it a task. */
static void place_below(Placer *placer, uint32_t at, uint32_t index) {
    Layout *layout = placer->layout;
    if (!placer->top || layout->plan.choices[index].units > layout->task_units) {
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
    uint32_t children[RT_WIDE] = {0}, count = rt_wide_children_of(&layout->plan, index, children);
    *node = (RtWideNode){.count = count};
    placer->nodes++;
    placer->cost += rt_box_half_area(rt_tree_box(layout->plan.tree, index));
    at += RT_WIDE_NODE_UNITS;
    for (uint32_t i = 0; i < RT_WIDE; i++) {
        put_box(node, i, i < count ? rt_tree_box(layout->plan.tree, children[i]) : RT_EMPTY_BOX);
        node->child[i] = RT_WIDE_DONE;
        if (i < count && rt_wide_becomes_leaf(&layout->plan, children[i]))
            node->child[i] = place_leaf(placer, children[i], &at);
    }
    for (uint32_t i = 0; i < count; i++) {
        if (node->child[i] != RT_WIDE_DONE) continue;
        node->child[i] = rt_wide_ref(at, RT_WIDE_NODE, false);
        place_below(placer, at, children[i]);
        at += layout->plan.choices[children[i]].units;
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
    place_node(&placer, 0, layout->plan.tree->root);
    fill_waiting(&placer, 0);
    RT_TRY(placer.status);
    RT_TRY(rt_parallel_each(layout->task_count, layout->plan.how->threads, place_task, layout, error));
    for (uint32_t i = 0; i < layout->task_count; i++) {
        placer.nodes += layout->tasks[i].nodes;
        placer.cost += layout->tasks[i].cost;
    }
    double area = rt_box_half_area(rt_tree_box(layout->plan.tree, layout->plan.tree->root));
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

static RtStatus lay_out(Layout *layout, RtTree *tree, const RtGeometry *geometry, const RtWideLayout *how,
                        RtError *error) {
    RtWideTree *self = layout->self;
    RT_TRY(rt_wide_plan_init(&layout->plan, tree, geometry, how, error));
    self->bytes = (uint64_t)layout->plan.units * RT_WIDE_UNIT;
    self->split_refs = tree->split_refs;
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
    Layout layout = {.self = self};
    RtStatus status = lay_out(&layout, tree, geometry, how, error);
    rt_wide_plan_clear(&layout.plan);
    rt_free(layout.tasks);
    if (status != RT_OK) rt_wide_clear(self);
    return status;
}

void rt_wide_clear(RtWideTree *self) {
    rt_free(self->arena);
    *self = (RtWideTree){0};
}
