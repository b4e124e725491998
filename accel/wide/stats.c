/* SPDX-License-Identifier: Apache-2.0 */
/* Describes, draws and checks wide hierarchies. Most of it is done on a copy in the plain form of
 * accel/tree/hierarchy.h; this file checks what only the wide form has. */
#include "accel/wide/wide.h"

#include "core/base/memory.h"

/* ---- the plain form ---- */

/* The size of a subtree. */
typedef struct Sizes {
    uint32_t nodes, ids;
} Sizes;

static void measure(const RtWideTree *self, RtWideRef ref, Sizes *sum) {
    sum->nodes++;
    if (rt_wide_kind(ref) != RT_WIDE_NODE) {
        sum->ids += rt_wide_count(self, ref);
        return;
    }
    const RtWideNode *node = rt_wide_node(self, ref);
    for (uint32_t i = 0; i < node->count; i++) measure(self, node->child[i], sum);
}

/* Copies a subtree to node `at`, whose box is set. */
static void copy(const RtWideTree *self, RtHierarchy *to, uint32_t at, RtWideRef ref) {
    if (rt_wide_kind(ref) != RT_WIDE_NODE) {
        uint32_t count = rt_wide_count(self, ref);
        to->nodes[at].first = to->id_count;
        to->nodes[at].count = RT_NODE_LEAF | count;
        for (uint32_t i = 0; i < count; i++) to->ids[to->id_count++] = rt_wide_leaf_object(self, ref, i);
        return;
    }
    const RtWideNode *node = rt_wide_node(self, ref);
    uint32_t first = to->node_count;
    to->nodes[at].first = first;
    to->nodes[at].count = node->count;
    to->node_count += node->count;
    for (uint32_t i = 0; i < node->count; i++) {
        to->nodes[first + i].box = rt_wide_child_box(node, i);
        copy(self, to, first + i, node->child[i]);
    }
}

/* The root in plain form: the first node, or the leaf that is its only child. */
static RtWideRef root_of(const RtWideTree *self) {
    const RtWideNode *root = rt_wide_node(self, 0);
    return root->count == 1 ? root->child[0] : 0;
}

static RtBox root_box(const RtWideTree *self) {
    return rt_wide_children_box(rt_wide_node(self, 0));
}

/* The same hierarchy in plain form. */
static RtStatus flatten(const RtWideTree *self, RtArena *memory, RtHierarchy *to, RtError *error) {
    RtWideRef top = root_of(self);
    Sizes sizes = {0, 0};
    measure(self, top, &sizes);
    *to = (RtHierarchy){.width = RT_WIDE,
                        .leaf_limit = RT_WIDE_MAX_LEAF,
                        .traversal_cost = 1,
                        .split_refs = self->split_refs,
                        .nodes = rt_arena_alloc(memory, sizes.nodes, sizeof(RtNode)),
                        .ids = rt_arena_alloc(memory, sizes.ids, sizeof(uint32_t)),
                        .node_count = 1};
    RT_TRY(rt_arena_check(memory, "the plain form of a hierarchy", error));
    to->nodes[0].box = root_box(self);
    copy(self, to, 0, top);
    return RT_OK;
}

/* ---- for the table of operations ---- */

/* The quality figures are those of the plain hierarchy, whose leaves cost one test per object. */
void rt_wide_describe(const RtWideTree *self, const RtGeometry *geometry, RtDescription *out) {
    RT_ARENA(arena);
    RtHierarchy plain;
    *out = (RtDescription){.bytes = self->bytes, RT_NO_PREDICTION};
    if (self->node_count == 0 || flatten(self, &arena, &plain, NULL) != RT_OK) return;
    rt_hierarchy_describe(&plain, geometry, out);
    out->bytes = self->bytes;
    out->predicted_cost = self->cost;
}

static void show(const RtWideTree *self, RtWideRef ref, RtBox box, uint32_t depth, RtBoxViewer viewer) {
    bool leaf = rt_wide_kind(ref) != RT_WIDE_NODE;
    viewer.show(viewer.context, &(RtBoxView){.box = &box,
                                             .depth = depth,
                                             .leaf = leaf,
                                             .objects = leaf ? rt_wide_count(self, ref) : 0});
    if (leaf) return;
    const RtWideNode *node = rt_wide_node(self, ref);
    for (uint32_t i = 0; i < node->count; i++)
        show(self, node->child[i], rt_wide_child_box(node, i), depth + 1, viewer);
}

void rt_wide_each_box(const RtWideTree *self, RtBoxViewer viewer) {
    if (self->node_count > 0) show(self, root_of(self), root_box(self), 0, viewer);
}

/* ---- checking ---- */

typedef struct Check {
    const RtWideTree *self;
    const RtGeometry *geometry;
    RtError *error;
    uint32_t nodes;
} Check;

#define BROKEN(check, ...) rt_fail((check)->error, RT_MISMATCH, "wide: " __VA_ARGS__)

static bool is_shape(const RtGeometry *g, uint32_t id, RtShape shape) {
    return id < g->object_count && rt_ref_shape(g->objects[id]) == shape;
}

static bool is_inside(const RtWideTree *self, RtWideRef ref, uint64_t bytes) {
    return (uint64_t)rt_wide_place(ref) * RT_WIDE_UNIT + bytes <= self->bytes;
}

/* Checks a leaf of spheres. */
static RtStatus check_spheres(const Check *check, RtWideRef ref) {
    const RtGeometry *g = check->geometry;
    const RtWideSphere *only = rt_wide_leaf_at(check->self, ref);
    for (uint32_t i = 0; i < rt_wide_count(check->self, ref); i++) {
        if (is_shape(g, rt_wide_leaf_object(check->self, ref, i), RT_SHAPE_SPHERE)) continue;
        return BROKEN(check, "the leaf at %u holds an object that is no sphere", rt_wide_place(ref));
    }
    if (rt_wide_is_sphere(ref) &&
        memcmp(&only->sphere, &g->spheres[rt_ref_index(g->objects[only->id])], sizeof(RtSphere)) != 0)
        return BROKEN(check, "the leaf at %u is another sphere", rt_wide_place(ref));
    return RT_OK;
}

/* Checks block `b` of a leaf: its triangles come first, and are those of the scene. */
static RtStatus check_block(const Check *check, RtWideRef ref, uint32_t b, bool full) {
    const RtGeometry *g = check->geometry;
    const RtWideTriangles *block = (const RtWideTriangles *)rt_wide_leaf_at(check->self, ref) + b;
    const uint32_t count = full ? RT_WIDE_BLOCK : rt_wide_block_count(block);
    const uint32_t at = rt_wide_place(ref);
    for (uint32_t lane = 0; lane < RT_WIDE_BLOCK; lane++) {
        uint32_t id = block->id[lane], i = b * RT_WIDE_BLOCK + lane;
        bool there = is_shape(g, id, RT_SHAPE_TRIANGLE);
        if (lane < count ? !there : id != RT_NO_OBJECT)
            return BROKEN(check, "the leaf at %u holds no triangle in lane %u", at, i);
        for (int k = 0; k < 9; k++) {
            float x = block->v[k / 3][k % 3][lane];
            if (there ? x == g->triangles[rt_ref_index(g->objects[id])].v[k / 3].at[k % 3] : isnan(x))
                continue;
            return BROKEN(check, "lane %u of the leaf at %u is another triangle", i, at);
        }
    }
    return RT_OK;
}

/* Checks that a leaf is in the arena and holds objects, and that its triangles and spheres are those of the
 * scene. */
static RtStatus check_leaf(const Check *check, RtWideRef ref) {
    const uint32_t at = rt_wide_place(ref);
    const uint32_t blocks = rt_wide_has_more(ref) ? 2 : 1;
    const bool triangles = rt_wide_kind(ref) == RT_WIDE_TRIANGLES;
    const uint64_t bytes = triangles ? blocks * sizeof(RtWideTriangles) : sizeof(RtWideList);
    if (ref == RT_WIDE_DONE || !is_inside(check->self, ref, bytes))
        return BROKEN(check, "a leaf at %u is not in the arena", at);
    const uint32_t count = rt_wide_count(check->self, ref);
    for (uint32_t b = 0; triangles && b < blocks; b++) RT_TRY(check_block(check, ref, b, b + 1 < blocks));
    if (count <= (triangles && blocks == 2 ? RT_WIDE_BLOCK : 0))
        return BROKEN(check, "the leaf at %u is empty", at);
    for (uint32_t i = count; !triangles && !rt_wide_is_sphere(ref) && i < RT_WIDE_MAX_LEAF; i++) {
        if (rt_wide_leaf_object(check->self, ref, i) == RT_NO_OBJECT) continue;
        return BROKEN(check, "the leaf at %u has a gap between its objects", at);
    }
    return rt_wide_kind(ref) == RT_WIDE_SPHERES ? check_spheres(check, ref) : RT_OK;
}

static RtStatus check_node(Check *check, RtWideRef ref, uint32_t depth) {
    const RtWideTree *self = check->self;
    const uint32_t at = rt_wide_place(ref);
    if (depth > RT_TREE_MAX_DEPTH) return BROKEN(check, "node %u is too deep", at);
    if (rt_wide_has_more(ref) || !is_inside(self, ref, sizeof(RtWideNode)))
        return BROKEN(check, "a node at %u is not in the arena", at);
    const RtWideNode *node = rt_wide_node(self, ref);
    if (++check->nodes > self->node_count) return BROKEN(check, "node %u has two parents", at);
    bool lone = ref == 0 && rt_wide_kind(node->child[0]) != RT_WIDE_NODE; /* a root may hold a single leaf */
    if (node->count < (lone ? 1 : 2) || node->count > RT_WIDE)
        return BROKEN(check, "node %u has %u children", at, node->count);
    for (uint32_t i = node->count; i < RT_WIDE; i++) {
        for (size_t a = 0; a < 3; a++) {
            if (node->plane[2 * a][i] == INFINITY && node->plane[2 * a + 1][i] == -INFINITY) continue;
            return BROKEN(check, "lane %u of node %u has a box and no child", i, at);
        }
    }
    for (uint32_t i = 0; i < node->count; i++) {
        bool inner = rt_wide_kind(node->child[i]) == RT_WIDE_NODE;
        if (inner && node->child[i] <= ref) return BROKEN(check, "node %u has a child before it", at);
        RT_TRY(inner ? check_node(check, node->child[i], depth + 1) : check_leaf(check, node->child[i]));
    }
    return RT_OK;
}

RtStatus rt_wide_validate(const RtWideTree *self, const RtGeometry *geometry, RtError *error) {
    if (geometry->object_count == 0) return RT_OK;
    Check check = {self, geometry, error, 0};
    RT_TRY(check_node(&check, 0, 0));
    if (check.nodes != self->node_count)
        return rt_fail(error, RT_MISMATCH, "wide: %u of %u nodes are in the tree", check.nodes,
                       self->node_count);
    RT_ARENA(arena);
    RtHierarchy plain;
    RT_TRY(flatten(self, &arena, &plain, error));
    return rt_hierarchy_validate(&plain, geometry, "wide", error);
}
