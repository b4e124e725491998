/* SPDX-License-Identifier: Apache-2.0 */
/* wide: a hierarchy of boxes eight children wide, traced in vectors, many rays at once.
 *
 * Papers: Wald, Benthin & Boulos 2008, "Getting Rid of Packets: Efficient SIMD Single-Ray Traversal using
 * Multi-branching BVHs" (nodes of many children, tested at once); and those named in layout.c,
 * wide_kernels.c and packet.h. The layout and its invariants are in wide.h. The tree of references is built
 * by the methods of accel/tree/tree.h, as for `bvh`.
 *
 * Exact, because boxes are tested by the operations of rt_box_hit, triangles and spheres by those of
 * rt_triangle_hit and rt_sphere_hit, lane by lane. A child that a beam's interval misses is missed by each of
 * its rays (packet.h). The order of visits changes no answer.
 *
 * Counting: an extent test per child of a visited node, a step per node and per leaf, an object test per
 * triangle of a leaf. Rays are counted as if traced alone, with the same counts for all instruction sets and
 * any number of rays in flight. */
#include "accel/wide/wide.h"

#define PARAMS(X)                                                                                            \
    X(PARAM_BUILD, "build", RT_CHOICE("binned", RT_TREE_METHODS),                                            \
      "builder of the binary tree, as for bvh; its nodes are then merged into nodes of eight", "Wald 2007")  \
    X(PARAM_BINS, "bins", RT_INT("64", 2, RT_MAX_BINS, "2|16"),                                              \
      "build=binned, spatial: SAH bins along each axis; for fewer than 1024 objects, 16 at most",            \
      "measured")                                                                                            \
    X(PARAM_ALPHA, "alpha", RT_FLOAT("1e-05", 0, 1, "0|0.01"),                                               \
      "build=spatial: spatial splits are tried where the sides overlap by more than this part of the "       \
      "root's area",                                                                                         \
      "Stich et al. 2009")                                                                                   \
    X(PARAM_BUDGET, "budget", RT_FLOAT("2", 1, 16, "1|16"),                                                  \
      "build=spatial: maximum average number of references per object", "as for bvh")                        \
    X(PARAM_WHOLE, "whole", RT_FLAG("off"),                                                                  \
      "build=spatial: any-hit rays use a second tree, binned, which splits no objects",                      \
      "measured: spatial splits help nearest-hit rays and may slow down any-hit rays")                       \
    X(PARAM_MAX_LEAF_SIZE, "max_leaf_size", RT_INT("4", 1, RT_WIDE_MAX_LEAF, "1|8"),                         \
      "maximum number of objects in a leaf; four triangles are tested at once", "measured")                  \
    X(PARAM_BLOCK_COST, "block_cost", RT_FLOAT("1", 0, 1000, "0|0.1|10"),                                    \
      "cost of testing four triangles, or one other object, in visits of a node", "measured")                \
    X(PARAM_REINSERTION, "reinsertion", RT_INT("2", 0, 1000, "0|1"),                                         \
      "rounds in which subtrees of the binary tree move to cheaper places; 0: the tree as built",            \
      "measured")                                                                                            \
    X(PARAM_BATCH, "batch", RT_FLOAT("0.01", 1e-6, 1, "0.001|1"),                                            \
      "reinsertion: part of the nodes, those with the largest boxes, that may move in a round",              \
      "Bittner et al. 2013")                                                                                 \
    X(PARAM_IN_FLIGHT, "in_flight", RT_INT("32", 1, RT_WIDE_MAX_IN_FLIGHT, "1|3|64"),                        \
      "rays of a stream traced at once on a thread; 1: one after the other", "measured")                     \
    X(PARAM_ORDER, "order", RT_FLAG("on"), "visit the nearest child first; off: the last one",               \
      "this program")                                                                                        \
    X(PARAM_PREFETCH, "prefetch", RT_FLAG("on"), "prefetch the node or leaf that a ray visits next",         \
      "measured")                                                                                            \
    X(PARAM_PACKETS, "packets", RT_INT("8", 0, RT_WIDE_MAX_PACKETS, "0|1|16"),                               \
      "packets traced at once on a thread, each of up to 64 rays that visit nodes together; 0: none",        \
      "measured")                                                                                            \
    X(PARAM_SHARING, "sharing", RT_FLOAT("5", 0, 64, "0|8"),                                                 \
      "packets are made only if this many rays, half as many over instances, share the visit of a node, on " \
      "average; 0: always",                                                                                  \
      "measured")                                                                                            \
    X(PARAM_HUGE_PAGES, "huge_pages", RT_FLAG("on"), "request large pages from the system", "measured")      \
    X(PARAM_ISA, RT_ISA_PARAM)

enum { PARAMS(RT_PARAM_INDEX) };
static const RtParam params[] = {PARAMS(RT_PARAM_ENTRY)};

/* From so many objects on, leaves have no nodes while the tree is laid out: it takes 2 % more instructions,
 * and 48 bytes an object less. */
enum { MANY_OBJECTS = 1 << 20 };

/* ---- build ---- */

static RtStatus fill(RtWide *self, int place, const RtBuild *what, RtTreeMethod method, RtError *error) {
    const RtGeometry *geometry = &what->scene->geometry;
    const RtValue *values = what->values;
    const RtTreeOptions options = {.method = method,
                                   .bits = RT_MAX_MORTON_BITS,
                                   .radius = 25, /* the default of `bvh` */
                                   .spatial = {.bins = (int)values[PARAM_BINS].i,
                                               .alpha = values[PARAM_ALPHA].f,
                                               .budget = values[PARAM_BUDGET].f,
                                               .max_leaf_size = (uint32_t)values[PARAM_MAX_LEAF_SIZE].i,
                                               .traversal = 1,
                                               .limit = what->limit},
                                   .reinsertion = (uint32_t)values[PARAM_REINSERTION].i,
                                   .batch = values[PARAM_BATCH].f};
    const RtWideLayout how = {.max_leaf_size = options.spatial.max_leaf_size,
                              .block_cost = values[PARAM_BLOCK_COST].f,
                              .huge_pages = values[PARAM_HUGE_PAGES].flag,
                              .threads = what->threads,
                              .limit = what->limit};
    RtTree tree;
    if (geometry->object_count == 0) return RT_OK;
    RT_TRY(rt_tree_build(&tree, geometry, &options, what->threads, error));
    RtStatus status = RT_OK;
    if (geometry->object_count >= MANY_OBJECTS) status = rt_tree_drop_leaves(&tree, geometry->boxes, error);
    if (status == RT_OK)
        status = rt_wide_lay_out(&self->trees[place], &tree, geometry, &how, &self->base.memory, error);
    rt_tree_clear(&tree);
    return status;
}

static RtStatus available(const RtValue *values, RtError *error) {
    return rt_isa_available(values[PARAM_ISA], error);
}

/* Is it a scene of fused box tests (ray.h)? */
static bool may_fuse(const RtGeometry *g) {
    float side = 0, farthest = 0;
    for (int a = 0; a < 3; a++) {
        side = rt_maxf(g->box.hi.at[a] - g->box.lo.at[a], side);
        farthest = rt_maxf(rt_maxf(-g->box.lo.at[a], g->box.hi.at[a]), farthest);
    }
    return g->triangle_count == g->object_count && side >= 0x1p-29f && farthest <= 0x1p20f * side;
}

static RtStatus build(RtAccel *accel, const RtBuild *what, RtError *error) {
    const RtValue *values = what->values;
    const RtTreeMethod method = (RtTreeMethod)values[PARAM_BUILD].choice;
    const bool two = method == RT_TREE_SPATIAL && values[PARAM_WHOLE].flag;
    RtWide *self = (RtWide *)accel;
    self->occluded = &self->trees[two ? 1 : 0];
    rt_isa_use(accel, RT_KERNELS_FOR(wide, rt_isa_asked(values[PARAM_ISA])));
    self->in_flight = (uint32_t)values[PARAM_IN_FLIGHT].i;
    accel->scratch_bytes += (size_t)self->in_flight * RT_WIDE_STATE_BYTES;
    self->order = values[PARAM_ORDER].flag;
    self->prefetch = values[PARAM_PREFETCH].flag;
    self->fused = may_fuse(&what->scene->geometry);
    self->sharing = (float)values[PARAM_SHARING].f;
    /* Over instances packets pay earlier: they hand streams to the parts, rays in flight one ray each. */
    if (what->scene->geometry.instance_count > 0) self->sharing /= 2;
    self->packets = (uint32_t)values[PARAM_PACKETS].i;
    RT_TRY(fill(self, 0, what, method, error));
    return two ? fill(self, 1, what, RT_TREE_BINNED, error) : RT_OK;
}

/* ---- the plain form of accel/tree/hierarchy.h, which does most of describing and checking ---- */

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

/* The same hierarchy in plain form, of blocks of `memory`. */
static RtStatus flatten(const RtWideTree *self, RtArena *memory, RtHierarchy *to, RtError *error) {
    RtWideRef top = root_of(self);
    Sizes sizes = {0, 0};
    measure(self, top, &sizes);
    *to = (RtHierarchy){.width = RT_WIDE,
                        .max_leaf_size = RT_WIDE_MAX_LEAF,
                        .traversal_cost = 1,
                        .split_refs = self->split_refs,
                        .nodes = rt_arena_alloc(memory, sizes.nodes, sizeof(RtNode)),
                        .ids = rt_arena_alloc(memory, sizes.ids, sizeof(uint32_t)),
                        .node_count = 1};
    RT_TRY(rt_arena_check(memory, "a hierarchy in plain form", error));
    to->nodes[0].box = rt_wide_children_box(rt_wide_node(self, 0));
    copy(self, to, 0, top);
    return RT_OK;
}

/* ---- describing and drawing ---- */

/* Describes the tree for nearest hits; `bytes` counts both trees. The quality figures are those of the plain
 * hierarchy, whose leaves cost one test per object. */
static void describe(const RtAccel *accel, RtDescription *out) {
    RT_ARENA(work);
    const RtWide *self = (const RtWide *)accel;
    const RtWideTree *tree = &self->trees[0];
    RtHierarchy plain;
    *out = (RtDescription){RT_NO_PREDICTION};
    if (tree->node_count > 0 && flatten(tree, &work, &plain, NULL) == RT_OK) {
        rt_hierarchy_describe(&plain, &accel->scene->geometry, out);
        out->predicted_cost = tree->cost;
    }
    out->bytes = tree->bytes + self->trees[1].bytes;
}

static void each_box(const RtAccel *accel, RtBoxViewer viewer) {
    RT_ARENA(work);
    const RtWideTree *tree = &((const RtWide *)accel)->trees[0];
    RtHierarchy plain;
    if (tree->node_count > 0 && flatten(tree, &work, &plain, NULL) == RT_OK)
        rt_hierarchy_each_box(&plain, NULL, viewer);
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
    RT_ARENA(work);
    if (geometry->object_count == 0) return RT_OK;
    Check check = {self, geometry, error, 0};
    RT_TRY(check_node(&check, 0, 0));
    if (check.nodes != self->node_count)
        return BROKEN(&check, "%u of %u nodes are in the tree", check.nodes, self->node_count);
    RtHierarchy plain;
    RT_TRY(flatten(self, &work, &plain, error));
    return rt_hierarchy_validate(&plain, geometry, "wide", error);
}

static RtStatus validate(const RtAccel *accel, RtError *error) {
    const RtWide *self = (const RtWide *)accel;
    const RtGeometry *g = &accel->scene->geometry;
    RT_TRY(rt_wide_validate(&self->trees[0], g, error));
    return self->occluded == &self->trees[0] ? RT_OK : rt_wide_validate(self->occluded, g, error);
}

const RtAccelOps rt_wide_ops = {
    .name = "wide",
    .summary = "hierarchy of boxes eight wide, SIMD traversal, many rays at once: our fastest",
    .paper = "Wald, Benthin & Boulos 2008, Getting Rid of Packets: Efficient SIMD Single-Ray Traversal using "
             "Multi-branching BVHs, RT'08",
    RT_PARAMS_OF(params),
    RT_BEST("build=binned|spatial,batch=0.01|1"),
    .trial = "wide:sharing=0", /* scattered rays make no packets where they need not */
    .bytes = sizeof(RtWide),
    .build = build,
    .describe = describe,
    .validate = validate,
    .each_box = each_box,
    .shows_lists = true,
    .available = available,
};
