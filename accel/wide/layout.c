/* SPDX-License-Identifier: Apache-2.0 */
/* From a binary tree of references to nodes of eight children.
 *
 * Which subtrees become leaves, and which nodes are opened into their parents, is decided together, for the
 * least expected cost (Ylitie, Karras & Laine 2017, "Efficient Incoherent Ray Traversal on GPUs Through
 * Compressed Wide BVHs", section 2.3): let cost(n, k) be what the least costly forest of at most k subtrees
 * costs that holds what is below n. Then
 *
 *     cost(n, 1) = min(leaf(n), area(n) + split(n, 8)),
 *     cost(n, k) = min(cost(n, k - 1), split(n, k)),       split(n, k) = min over i of cost(left, i) +
 * cost(right, k - i),
 *
 * and the choices that were made lead from the root down. */
#include "accel/wide/wide.h"

#include "base/memory.h"

#include <assert.h>
#include <string.h>

/* choice[k - 1]: how many of k subtrees the left child gets; FEWER: k - 1 will do; for k = 1 LEAF or what of
 * eight the left child gets. */
enum { FEWER = 0, LEAF = 255 };

typedef struct Plan {
    uint8_t choice[RT_WIDE];
} Plan;

typedef struct Layout {
    RtWideTree *self;
    const RtTree *tree;
    const RtGeometry *geometry;
    const RtWideLayout *how;
    Plan *plans; /* [tree->used] */
} Layout;

/* What a subtree holds, and what it costs as a forest of at most k + 1 subtrees. */
typedef struct Weight {
    double cost[RT_WIDE];
    uint32_t references;
    uint32_t shapes; /* bits 1 << RtShape */
} Weight;

static double leaf_cost(const Layout *layout, const Weight *weight) {
    bool blocks = weight->shapes == 1u << RT_SHAPE_TRIANGLE;
    uint32_t tests = blocks ? (weight->references + RT_WIDE_BLOCK - 1) / RT_WIDE_BLOCK : weight->references;
    return layout->how->block_cost * tests;
}

static Weight weigh(const Layout *layout, uint32_t index) {
    const RtTreeNode *node = &layout->tree->nodes[index];
    Plan *plan = &layout->plans[index];
    double area = rt_box_half_area(node->box);
    Weight own = {.references = 1};
    memset(plan, 0, sizeof *plan);
    if (rt_tree_is_leaf(layout->tree, index)) {
        own.shapes = 1u << rt_ref_shape(layout->geometry->objects[node->child[1]]);
        plan->choice[0] = LEAF;
        for (int k = 0; k < RT_WIDE; k++) own.cost[k] = area * leaf_cost(layout, &own);
        return own;
    }
    Weight left = weigh(layout, node->child[0]), right = weigh(layout, node->child[1]);
    own.references = left.references + right.references;
    own.shapes = left.shapes | right.shapes;
    double split[RT_WIDE];
    for (int k = 1; k < RT_WIDE; k++) { /* k + 1 subtrees */
        split[k] = INFINITY;
        for (int i = 0; i < k; i++) { /* i + 1 of them to the left, k - i to the right */
            double cost = left.cost[i] + right.cost[k - 1 - i];
            if (!(cost < split[k])) continue;
            split[k] = cost;
            plan->choice[k] = (uint8_t)(i + 1);
        }
    }
    own.cost[0] = area + split[RT_WIDE - 1];
    plan->choice[0] = plan->choice[RT_WIDE - 1];
    if (own.references <= layout->how->leaf_limit) {
        double leaf = area * leaf_cost(layout, &own);
        if (leaf <= own.cost[0]) {
            own.cost[0] = leaf;
            plan->choice[0] = LEAF;
        }
    }
    for (int k = 1; k < RT_WIDE; k++) {
        own.cost[k] = split[k];
        if (split[k] < own.cost[k - 1]) continue;
        own.cost[k] = own.cost[k - 1];
        plan->choice[k] = FEWER;
    }
    return own;
}

/* The roots of the forest of at most `most` subtrees below `index`, appended to children[0..*count). */
static void open_children(const Layout *layout, uint32_t index, uint32_t most, uint32_t *children,
                          uint32_t *count) {
    const Plan *plan = &layout->plans[index];
    while (most > 1 && plan->choice[most - 1] == FEWER) most--;
    if (most == 1) {
        children[(*count)++] = index;
        return;
    }
    const uint32_t *child = layout->tree->nodes[index].child;
    uint32_t left = plan->choice[most - 1];
    open_children(layout, child[0], left, children, count);
    open_children(layout, child[1], most - left, children, count);
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

static void put_triangle(const Layout *layout, RtWideTriangles *block, uint32_t lane, uint32_t id) {
    const RtGeometry *g = layout->geometry;
    for (int v = 0; v < 3; v++) {
        for (int a = 0; a < 3; a++) {
            bool none = id == RT_NO_OBJECT;
            block->v[v][a][lane] = none ? NAN : g->triangles[rt_ref_index(g->objects[id])].v[v].at[a];
        }
    }
    block->id[lane] = id;
}

/* What a leaf of these objects is, and its bytes. */
static RtWideKind kind_of(const Layout *layout, const uint32_t *ids, uint32_t count, uint32_t *bytes) {
    uint32_t shapes = 0, blocks = (count + RT_WIDE_BLOCK - 1) / RT_WIDE_BLOCK;
    for (uint32_t i = 0; i < count; i++) shapes |= 1u << rt_ref_shape(layout->geometry->objects[ids[i]]);
    if (shapes == 1u << RT_SHAPE_TRIANGLE) {
        *bytes = blocks * (uint32_t)sizeof(RtWideTriangles);
        return RT_WIDE_TRIANGLES;
    }
    *bytes = sizeof(RtWideList);
    return RT_WIDE_OBJECTS;
}

static RtWideRef place_leaf(const Layout *layout, uint32_t index) {
    RtWideTree *self = layout->self;
    uint32_t ids[RT_WIDE_MAX_LEAF], count = 0, bytes;
    collect(layout, index, ids, &count);
    RtWideKind kind = kind_of(layout, ids, count, &bytes);
    bool triangles = kind == RT_WIDE_TRIANGLES;
    uint32_t at = (uint32_t)self->bytes,
             lanes = triangles && count <= RT_WIDE_BLOCK ? RT_WIDE_BLOCK : RT_WIDE_MAX_LEAF;
    char *place = self->arena + at;
    self->bytes += bytes;
    for (uint32_t i = 0; i < lanes; i++) {
        uint32_t id = i < count ? ids[i] : RT_NO_OBJECT, block = i / RT_WIDE_BLOCK, lane = i % RT_WIDE_BLOCK;
        if (triangles)
            put_triangle(layout, (RtWideTriangles *)(void *)place + block, lane, id);
        else
            ((RtWideList *)(void *)place)->id[i] = id;
    }
    return rt_wide_leaf(kind, at, count);
}

static void place_node(const Layout *layout, uint32_t at, uint32_t index);

static RtWideRef place(const Layout *layout, uint32_t index) {
    if (layout->plans[index].choice[0] == LEAF) return place_leaf(layout, index);
    uint32_t at = (uint32_t)layout->self->bytes;
    layout->self->bytes += sizeof(RtWideNode);
    place_node(layout, at, index);
    return at;
}

static void put_box(RtWideNode *node, uint32_t lane, RtBox box) {
    for (size_t a = 0; a < 3; a++) {
        node->plane[2 * a][lane] = box.lo.at[a];
        node->plane[2 * a + 1][lane] = box.hi.at[a];
    }
}

static void place_node(const Layout *layout, uint32_t at, uint32_t index) {
    uint32_t children[RT_WIDE], count = 0;
    const Plan *plan = &layout->plans[index];
    if (plan->choice[0] == LEAF) {
        children[count++] = index;
    } else {
        const uint32_t *child = layout->tree->nodes[index].child;
        open_children(layout, child[0], plan->choice[0], children, &count);
        open_children(layout, child[1], RT_WIDE - plan->choice[0], children, &count);
    }
    RtWideNode *node = (RtWideNode *)(layout->self->arena + at);
    layout->self->node_count++;
    node->count = count;
    memset(node->unused, 0, sizeof node->unused); /* the arena need not have been set */
    for (uint32_t i = 0; i < RT_WIDE; i++) {
        put_box(node, i, i < count ? layout->tree->nodes[children[i]].box : RT_EMPTY_BOX);
        node->child[i] = i < count ? place(layout, children[i]) : RT_WIDE_DONE;
    }
}

/* The bytes that the arena takes, as the plans say, without the root's where that is a leaf. */
static uint64_t count_bytes(const Layout *layout, uint32_t index) {
    if (layout->plans[index].choice[0] != LEAF) {
        uint32_t children[RT_WIDE], count = 0;
        const uint32_t *child = layout->tree->nodes[index].child;
        uint32_t left = layout->plans[index].choice[0];
        uint64_t bytes = sizeof(RtWideNode);
        open_children(layout, child[0], left, children, &count);
        open_children(layout, child[1], RT_WIDE - left, children, &count);
        for (uint32_t i = 0; i < count; i++) bytes += count_bytes(layout, children[i]);
        return bytes;
    }
    uint32_t ids[RT_WIDE_MAX_LEAF], count = 0, bytes;
    collect(layout, index, ids, &count);
    kind_of(layout, ids, count, &bytes);
    return bytes;
}

static RtStatus refuse(uint64_t bytes, uint64_t limit, RtError *error) {
    uint64_t most = limit < RT_WIDE_MAX_BYTES ? limit : RT_WIDE_MAX_BYTES;
    return rt_fail(
        error, RT_BAD_INPUT,
        "wide would take %.0f MB for this scene, the most is %.0f MB: take a larger max_leaf_size or bvh",
        (double)bytes * 1e-6, (double)most * 1e-6);
}

RtStatus rt_wide_lay_out(RtWideTree *self, RtTree *tree, const RtGeometry *geometry, const RtWideLayout *how,
                         RtError *error) {
    *self = (RtWideTree){0};
    RT_TRY(rt_tree_limit_depth(tree, error));
    Layout layout = {self, tree, geometry, how, rt_alloc(tree->used, sizeof(Plan))};
    if (!layout.plans) return rt_fail_memory(error, "the plan of a hierarchy", tree->used * sizeof(Plan));
    Weight whole = weigh(&layout, tree->root);
    double area = rt_box_half_area(tree->nodes[tree->root].box);
    uint64_t bytes = count_bytes(&layout, tree->root);
    if (layout.plans[tree->root].choice[0] == LEAF) bytes += sizeof(RtWideNode);
    if (bytes > how->limit || bytes > RT_WIDE_MAX_BYTES) {
        rt_free(layout.plans);
        return refuse(bytes, how->limit, error);
    }
    self->arena = how->huge_pages ? rt_alloc_unset(bytes, 1) : rt_alloc(bytes, 1);
    self->divided = tree->divided;
    self->cost = area > 0 ? whole.cost[0] / area : NAN;
    self->bytes = sizeof(RtWideNode);
    if (self->arena) place_node(&layout, 0, tree->root);
    rt_free(layout.plans);
    return self->arena ? RT_OK : rt_fail_memory(error, "a hierarchy", bytes);
}

void rt_wide_clear(RtWideTree *self) {
    rt_free(self->arena);
    *self = (RtWideTree){0};
}
