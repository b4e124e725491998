/* SPDX-License-Identifier: Apache-2.0 */
/* Laying out a binary tree of references for tracing: which subtrees become leaves, which nodes are replaced
 * by their children in their parent; and describing, showing and validating hierarchies.
 *
 * Quality metrics beside the expected cost: end-point overlap and leaf-count variability (Aila, Karras &
 * Laine 2013, "On Quality Metrics of Bounding Volume Hierarchies").
 *
 * Both are means over samples. The samples are the same for every hierarchy over a scene, so the computation
 * is fast for any number of objects, and differences between hierarchies are more precise than the values.
 * End-point overlap is the area of the surface that lies in a node but does not belong to its subtree,
 * weighted by the cost of the node: the mean, over points of the surface, of the cost of all nodes that
 * contain the point but not its object. There is one point in each of POINTS parts of the surface of equal
 * area. The part of a split object that contains the point belongs to a node. Leaf-count variability is the
 * standard deviation of the number of leaves that a line meets, over those of LINES uniform lines that meet
 * the root. */
#include "accel/tree/hierarchy.h"

#include "core/base/parallel.h"
#include "core/base/random.h"
#include "core/shape/overlap.h"

#include <assert.h>

/* ---- laying out ---- */

/* The contents of a subtree, and its expected cost: area x (object tests + visits of inner nodes). */
typedef struct Cost {
    uint32_t references, leaves;
    double cost;
} Cost;

typedef struct Used {
    uint32_t nodes, ids;
} Used;

/* The place of a part in the hierarchy. */
typedef struct Part {
    uint32_t node; /* its root; all is 0 if the part is inside a leaf */
    Used used;     /* before it */
} Part;

typedef struct Layout {
    RtHierarchy *self;
    const RtTree *tree;
    bool *leaf; /* [tree->used] the node becomes a leaf, or is below one */
    RtReducedParts reduced;
    Part *parts; /* [reduced.count] */
    uint32_t next;
} Layout;

/* A subtree of at most max_leaf_size references becomes a leaf where that costs no more. */
static Cost cost_of_both(Layout *layout, uint32_t index, const Cost *left, const Cost *right) {
    double area = rt_box_half_area(layout->tree->nodes[index].box);
    Cost inner = {left->references + right->references, left->leaves + right->leaves,
                  layout->self->traversal_cost * area + left->cost + right->cost};
    Cost leaf = {inner.references, 1, area * inner.references};
    bool better = leaf.references <= layout->self->max_leaf_size && leaf.cost <= inner.cost;
    layout->leaf[index] = better;
    return better ? leaf : inner;
}

static bool reduce_subtree(void *context, uint32_t index, uint32_t levels, void *value) {
    Layout *layout = context;
    if (rt_tree_is_leaf(layout->tree, index)) {
        layout->leaf[index] = true;
        *(Cost *)value = (Cost){1, 1, rt_box_half_area(layout->tree->nodes[index].box)};
        return true;
    }
    const uint32_t *child = layout->tree->nodes[index].child;
    Cost left, right;
    if (levels == 0 || !reduce_subtree(layout, child[0], levels - 1, &left) ||
        !reduce_subtree(layout, child[1], levels - 1, &right))
        return false;
    *(Cost *)value = cost_of_both(layout, index, &left, &right);
    return true;
}

static void combine_children(void *context, uint32_t index, const void *const children[2], void *value) {
    *(Cost *)value = cost_of_both(context, index, children[0], children[1]);
}

/* The children of a wide node: the largest inner one is replaced by its children, until there are `width`. */
static uint32_t open_children(const Layout *layout, uint32_t index, uint32_t *children) {
    const RtTreeNode *nodes = layout->tree->nodes;
    uint32_t count = 2;
    for (int s = 0; s < 2; s++) children[s] = nodes[index].child[s];
    while (count < layout->self->width) {
        uint32_t best = count;
        double most = -1;
        for (uint32_t i = 0; i < count; i++) {
            double area = rt_box_half_area(nodes[children[i]].box);
            if (layout->leaf[children[i]] || !(area > most)) continue;
            most = area;
            best = i;
        }
        if (best == count) break;
        const uint32_t *opened = nodes[children[best]].child;
        children[best] = opened[0];
        children[count++] = opened[1];
    }
    return count;
}

/* Appends the objects of a subtree to the leaf whose ids begin at `first`, each object once. */
static void append_ids(const Layout *layout, uint32_t first, uint32_t index, Used *used) {
    RtHierarchy *self = layout->self;
    const uint32_t *child = layout->tree->nodes[index].child;
    if (rt_tree_is_leaf(layout->tree, index)) {
        for (uint32_t i = first; i < used->ids && self->split_refs; i++) {
            if (self->ids[i] == child[1]) return;
        }
        self->ids[used->ids++] = child[1];
        return;
    }
    for (int s = 0; s < 2; s++) append_ids(layout, first, child[s], used);
}

/* Passes the parts below a node of the top. */
static void skip_parts(Layout *layout, uint32_t index, uint32_t depth) {
    const uint32_t *child = layout->tree->nodes[index].child;
    bool top = rt_reduction_is_top(layout->tree, index, depth);
    layout->next += !top;
    for (int s = 0; s < 2 && top; s++) skip_parts(layout, child[s], depth + 1);
}

/* Lays out the subtree of a node; if `top`, leaves out the parts, whose sizes are known: nodes are binary,
 * and no references split. */
static void lay_out_subtree(Layout *layout, uint32_t node_index, uint32_t index, bool top, uint32_t depth,
                            Used *used) {
    if (top && !rt_reduction_is_top(layout->tree, index, depth)) {
        const Cost *cost = (const Cost *)(const void *)layout->reduced.values + layout->next;
        layout->parts[layout->next++] = (Part){node_index, *used};
        used->nodes += 2 * cost->leaves - 2;
        used->ids += cost->references;
        return;
    }
    RtNode *node = &layout->self->nodes[node_index];
    node->box = layout->tree->nodes[index].box;
    if (layout->leaf[index]) {
        node->first = used->ids;
        append_ids(layout, node->first, index, used);
        node->count = RT_NODE_LEAF | (used->ids - node->first);
        if (top) skip_parts(layout, index, depth);
        return;
    }
    uint32_t children[RT_NODE_MAX_WIDTH] = {0};
    node->count = open_children(layout, index, children);
    node->first = used->nodes;
    used->nodes += node->count; /* the children are adjacent */
    for (uint32_t i = 0; i < node->count; i++)
        lay_out_subtree(layout, node->first + i, children[i], top, depth + 1, used);
}

static void lay_out_part(void *context, size_t item) {
    Layout *layout = context;
    const Part *part = &layout->parts[item];
    Used used = part->used;
    if (used.nodes > 0) lay_out_subtree(layout, part->node, layout->reduced.index[item], false, 0, &used);
}

static RtStatus lay_out(RtHierarchy *self, RtArena *memory, RtTree *tree, int threads, RtError *error) {
    RT_ARENA(arena);
    Layout layout = {.self = self,
                     .tree = tree,
                     .leaf = rt_arena_alloc_unset(&arena, tree->used, sizeof(bool)),
                     .parts = rt_arena_alloc(&arena, RT_REDUCTION_MAX_PARTS, sizeof(Part))};
    const RtReduction reduction = {sizeof(Cost), reduce_subtree, combine_children, &layout};
    Cost whole;
    assert(self->width >= 2 && self->width <= RT_NODE_MAX_WIDTH);
    RT_TRY(rt_arena_check(&arena, "the leaves of a hierarchy", error));
    RT_TRY(rt_tree_reduce(tree, &reduction, &arena, threads, &layout.reduced, &whole, error));
    self->nodes = rt_arena_alloc_unset(memory, 2 * (size_t)whole.leaves - 1, sizeof(RtNode));
    self->ids = rt_arena_alloc_unset(memory, whole.references, sizeof(uint32_t));
    self->split_refs = tree->split_refs;
    RT_TRY(rt_arena_check(memory, "the nodes of a hierarchy", error));
    const bool top = self->width == 2 && !self->split_refs;
    Used used = {1, 0};
    lay_out_subtree(&layout, 0, tree->root, top, 0, &used);
    if (top) RT_TRY(rt_parallel_each(layout.reduced.count, threads, lay_out_part, &layout, error));
    self->node_count = used.nodes;
    self->id_count = used.ids;
    return RT_OK;
}

static RtTreeBuild *const methods[RT_TREE_METHOD_COUNT] = {
    [RT_TREE_BINNED] = rt_tree_topdown,      [RT_TREE_SWEEP] = rt_tree_sweep,
    [RT_TREE_LBVH] = rt_tree_lbvh,           [RT_TREE_PLOC] = rt_tree_ploc,
    [RT_TREE_SPATIAL] = rt_tree_spatial,     [RT_TREE_AGGLOMERATIVE] = rt_tree_agglomerative,
    [RT_TREE_INSERTION] = rt_tree_insertion, [RT_TREE_MEDIAN] = rt_tree_topdown,
};

RtStatus rt_tree_build(RtTree *tree, const RtGeometry *geometry, const RtTreeOptions *options, int threads,
                       RtError *error) {
    *tree = (RtTree){.nodes = NULL};
    RtStatus status = methods[options->method](tree, geometry, options, threads, error);
    if (status == RT_OK)
        status = rt_tree_reinsert(tree, options->reinsertion, options->batch, threads, error);
    if (status != RT_OK) rt_tree_clear(tree);
    return status;
}

RtStatus rt_hierarchy_build(RtHierarchy *self, RtArena *memory, const RtGeometry *geometry,
                            const RtTreeOptions *options, int threads, RtError *error) {
    RtTree tree;
    if (geometry->object_count == 0) return RT_OK;
    RT_TRY(rt_tree_build(&tree, geometry, options, threads, error));
    RtStatus status = lay_out(self, memory, &tree, threads, error);
    rt_tree_clear(&tree);
    return status;
}

/* ---- describing ---- */

enum { POINTS = 4096, LINES = 8192, POINT_SEED = 1, LINE_SEED = 2 };

static void show_node(const RtHierarchy *self, const struct RtExtentSet *extents, uint32_t index,
                      uint32_t depth, RtBoxViewer viewer) {
    const RtNode *node = &self->nodes[index];
    uint32_t fanout = rt_node_fanout(node);
    bool leaf = rt_node_is_leaf(node);
    viewer.show(viewer.context, &(RtBoxView){&node->box, depth, leaf, extents, index,
                                             .objects = leaf ? fanout : 0, .children = leaf ? 0 : fanout});
    for (uint32_t i = 0; i < fanout && !leaf; i++)
        show_node(self, extents, node->first + i, depth + 1, viewer);
}

void rt_hierarchy_each_box(const RtHierarchy *self, const struct RtExtentSet *extents, RtBoxViewer viewer) {
    if (self->node_count > 0) show_node(self, extents, 0, 0, viewer);
}

/* ---- end-point overlap ---- */

static bool lists(const RtHierarchy *self, const RtNode *leaf, uint32_t id) {
    for (uint32_t i = 0; i < rt_node_fanout(leaf); i++) {
        if (self->ids[leaf->first + i] == id) return true;
    }
    return false;
}

/* Whether a leaf below lists the object and contains the point; adds to *cost the cost of the nodes that
 * contain the point without such a leaf. */
static bool add_overlap(const RtHierarchy *self, uint32_t index, RtVec3 point, uint32_t id, double *cost) {
    const RtNode *node = &self->nodes[index];
    uint32_t fanout = rt_node_fanout(node);
    bool leaf = rt_node_is_leaf(node), below = leaf && lists(self, node, id);
    if (!rt_box_contains(node->box, (RtBox){point, point})) return false;
    for (uint32_t i = 0; i < fanout && !leaf; i++)
        below |= add_overlap(self, node->first + i, point, id, cost);
    if (!below) *cost += leaf ? (double)fanout : self->traversal_cost;
    return below;
}

static double area_of(const RtTriangle *triangle) {
    RtVec3d a = rt_widen(triangle->v[0]);
    RtVec3d u = rt_subd(rt_widen(triangle->v[1]), a), v = rt_subd(rt_widen(triangle->v[2]), a);
    return rt_lengthd(rt_crossd(u, v)) / 2;
}

/* Uniform on the triangle, and in its box. */
static RtVec3 point_of(const RtTriangle *triangle, const RtBox *box, RtRandom *random) {
    double u = (double)rt_random_unit(random), v = (double)rt_random_unit(random);
    RtVec3d a = rt_widen(triangle->v[0]);
    RtVec3d ab = rt_subd(rt_widen(triangle->v[1]), a), ac = rt_subd(rt_widen(triangle->v[2]), a);
    bool over = u + v > 1;
    RtVec3 p = rt_narrow(rt_add_scaledd(rt_add_scaledd(a, ab, over ? 1 - u : u), ac, over ? 1 - v : v));
    return rt_vec_max(box->lo, rt_vec_min(box->hi, p));
}

/* Triangles only. */
static double end_point_overlap(const RtHierarchy *self, const RtGeometry *g) {
    double total = 0, passed = 0, cost = 0;
    uint32_t points = 0, held = 0;
    if (g->triangle_count != g->object_count) return NAN;
    for (uint32_t i = 0; i < g->triangle_count; i++) total += area_of(&g->triangles[i]);
    RtRandom random = rt_random(POINT_SEED, 0);
    double next = (double)rt_random_unit(&random) * total / POINTS;
    for (uint32_t i = 0; i < g->triangle_count; i++) {
        passed += area_of(&g->triangles[i]);
        while (points < POINTS && next < passed) {
            double own = 0;
            RtVec3 point = point_of(&g->triangles[i], &g->boxes[i], &random);
            bool found =
                add_overlap(self, 0, point, i, &own); /* rounding may move it out of the box of a part */
            held += found;
            cost += found ? own : 0;
            random = rt_random(POINT_SEED, ++points);
            next = (points + (double)rt_random_unit(&random)) * total / POINTS;
        }
    }
    return held > 0 ? cost / held : NAN;
}

/* ---- leaf-count variability ---- */

static uint32_t leaves_met(const RtHierarchy *self, uint32_t index, const RtPreparedRay *line) {
    const RtNode *node = &self->nodes[index];
    float enter;
    uint32_t sum = 0;
    if (!rt_box_hit(&node->box, line, INFINITY, &enter)) return 0;
    if (rt_node_is_leaf(node)) return 1;
    for (uint32_t i = 0; i < node->count; i++) sum += leaves_met(self, node->first + i, line);
    return sum;
}

/* A line through two uniform points of the sphere around a box. */
static RtRay line_about(const RtBox *box, RtRandom *random) {
    RtVec3d lo = rt_widen(box->lo), half = rt_scaled(rt_subd(rt_widen(box->hi), lo), 0.5);
    RtVec3d center = rt_addd(lo, half);
    RtVec3d from = rt_scaled(rt_random_direction(random), rt_lengthd(half));
    RtVec3d to = rt_scaled(rt_random_direction(random), rt_lengthd(half));
    return (RtRay){.org = rt_narrow(rt_addd(center, from)),
                   .dir = rt_narrow(rt_subd(to, from)),
                   .tmax = INFINITY,
                   .kind = RT_RAY_RANDOM};
}

static double leaf_count_variability(const RtHierarchy *self, const RtGeometry *g) {
    double lines = 0, sum = 0, squares = 0;
    for (uint32_t i = 0; i < LINES; i++) {
        RtRandom random = rt_random(LINE_SEED, i);
        RtRay ray = line_about(&self->nodes[0].box, &random);
        if (!rt_ray_is_valid(&ray)) continue;
        RtPreparedRay line = rt_ray_prepare(&ray, &g->box);
        float enter;
        if (!rt_box_hit(&self->nodes[0].box, &line, INFINITY, &enter)) continue;
        double leaves = leaves_met(self, 0, &line);
        lines += 1;
        sum += leaves;
        squares += leaves * leaves;
    }
    return lines > 0 ? sqrt(fmax(squares * lines - sum * sum, 0)) / lines : NAN;
}

void rt_hierarchy_describe(const RtHierarchy *self, const RtGeometry *geometry, RtDescription *out) {
    RtBoxSums sums = {.out = out};
    *out = (RtDescription){.bytes = self->node_count * sizeof(RtNode) + self->id_count * sizeof(uint32_t),
                           RT_NO_PREDICTION};
    if (self->node_count == 0) return;
    rt_hierarchy_each_box(self, NULL, (RtBoxViewer){rt_box_sums_add, &sums});
    out->end_point_overlap = end_point_overlap(self, geometry);
    out->leaf_count_variability = leaf_count_variability(self, geometry);
    rt_box_sums_predict(&sums, &self->nodes[0].box, self->traversal_cost);
}

/* ---- the coverage of objects ---- */

/* Checks whether the boxes of the leaves that list an object contain all of its surface. rt_object_part
 * computes the part of the surface in a box. If no single leaf contains that part, the box is split at a side
 * of a leaf that runs through it, recursively, until a leaf contains it or no side is left.
 *
 * The tree and this check clip boxes in different ways and round outward differently, so leaves are enlarged
 * here by a few roundings, less than the thickness of rays. */
typedef struct Parts {
    const RtHierarchy *self;
    const RtGeometry *geometry;
    uint32_t *first;  /* [objects + 1] where the leaves of each object begin */
    uint32_t *leaves; /* [ids] nodes, object after object */
    double margin;    /* for rt_object_part */
} Parts;

/* The side of a leaf that runs through `box` nearest to its middle; false if there is none. */
static bool find_side(const Parts *parts, const uint32_t *leaves, uint32_t count, const RtBox *box, int *axis,
                      float *at) {
    double least = INFINITY;
    for (uint32_t i = 0; i < count; i++) {
        const RtBox *leaf = &parts->self->nodes[leaves[i]].box;
        for (int side = 0; side < 6; side++) {
            int a = side % 3;
            float plane = side < 3 ? leaf->lo.at[a] : leaf->hi.at[a];
            double lo = (double)box->lo.at[a], hi = (double)box->hi.at[a];
            double off = fabs((double)plane - (lo + hi) / 2) / (hi - lo);
            if (!(plane > box->lo.at[a] && plane < box->hi.at[a]) || !(off < least)) continue;
            least = off;
            *axis = a;
            *at = plane;
        }
    }
    return least < INFINITY;
}

/* Whether leaves[0..count) contain the part of the object in `box`; reorders the leaves. */
static bool is_covered(const Parts *parts, uint32_t id, uint32_t *leaves, uint32_t count, RtBox box) {
    RtBox rest;
    if (!rt_object_part(parts->geometry, id, &box, parts->margin, &rest)) return true;
    uint32_t near = 0;
    for (uint32_t i = 0; i < count; i++) {
        RtBox leaf = parts->self->nodes[leaves[i]].box, wide = leaf;
        for (int a = 0; a < 3; a++) {
            float most = rt_maxf(fabsf(leaf.lo.at[a]), fabsf(leaf.hi.at[a])), slack = most * 0x1p-21f;
            wide.lo.at[a] -= slack;
            wide.hi.at[a] += slack;
        }
        if (rt_box_contains(wide, rest)) return true;
        if (rt_box_is_empty(rt_box_common(leaf, rest))) continue;
        uint32_t kept = leaves[i];
        leaves[i] = leaves[near];
        leaves[near++] = kept;
    }
    int axis = 0;
    float at = 0;
    if (!find_side(parts, leaves, near, &rest, &axis, &at)) return false;
    RtBox lower = rest, upper = rest;
    lower.hi.at[axis] = upper.lo.at[axis] = at;
    return is_covered(parts, id, leaves, near, lower) && is_covered(parts, id, leaves, near, upper);
}

/* Lists the leaves by object: count pass, fill pass. */
static void list_leaves(Parts *parts) {
    const RtHierarchy *self = parts->self;
    uint32_t objects = parts->geometry->object_count;
    for (uint32_t i = 0; i < self->id_count; i++) parts->first[self->ids[i] + 1]++;
    for (uint32_t id = 0; id < objects; id++) parts->first[id + 1] += parts->first[id];
    for (uint32_t n = 0; n < self->node_count; n++) {
        const RtNode *node = &self->nodes[n];
        for (uint32_t i = 0; i < rt_node_fanout(node) && rt_node_is_leaf(node); i++)
            parts->leaves[parts->first[self->ids[node->first + i]]++] = n;
    }
    for (uint32_t id = objects; id > 0; id--) parts->first[id] = parts->first[id - 1];
    parts->first[0] = 0;
}

static RtStatus check_coverage(const RtHierarchy *self, const RtGeometry *geometry, const char *name,
                               RtError *error) {
    const uint32_t objects = geometry->object_count;
    RT_ARENA(arena);
    Parts parts = {self, geometry, rt_arena_alloc(&arena, (size_t)objects + 1, sizeof(uint32_t)),
                   rt_arena_alloc(&arena, self->id_count, sizeof(uint32_t)),
                   rt_tree_part_margin(&geometry->box)};
    RT_TRY(rt_arena_check(&arena, "the leaves of each object", error));
    list_leaves(&parts);
    for (uint32_t id = 0; id < objects; id++) {
        uint32_t first = parts.first[id], count = parts.first[id + 1] - first;
        if (is_covered(&parts, id, parts.leaves + first, count, geometry->boxes[id])) continue;
        return rt_fail(error, RT_MISMATCH, "%s: part of object %u is in none of its %u leaves", name, id,
                       count);
    }
    return RT_OK;
}

/* ---- checking ---- */

typedef struct Check {
    const RtHierarchy *self;
    const RtGeometry *geometry;
    const char *name;
    RtError *error;
    uint32_t *seen;   /* [objects] how often each is in a leaf */
    uint32_t reached; /* nodes */
    uint32_t ended;   /* where the ids of the leaves so far end */
} Check;

#define BROKEN(check, what, ...) rt_fail((check)->error, RT_MISMATCH, "%s: " what, (check)->name, __VA_ARGS__)

static RtStatus check_leaf(Check *check, uint32_t index) {
    const RtHierarchy *self = check->self;
    const RtNode *node = &self->nodes[index];
    uint64_t end = (uint64_t)node->first + rt_node_fanout(node);
    for (uint64_t i = node->first; i < end; i++) {
        uint32_t id = i < self->id_count ? self->ids[i] : RT_NO_OBJECT;
        if (id >= check->geometry->object_count) return BROKEN(check, "leaf %u holds no object", index);
        check->seen[id]++;
        for (uint64_t j = node->first; j < i && self->split_refs; j++) {
            if (self->ids[j] != id) continue;
            return BROKEN(check, "object %u is in leaf %u twice", id, index);
        }
        if (self->split_refs || rt_box_contains(node->box, check->geometry->boxes[id])) continue;
        return BROKEN(check, "leaf %u does not contain its object %u", index, id);
    }
    if (node->first != check->ended)
        return BROKEN(check, "the ids of leaf %u begin at %u, not at %u", index, node->first, check->ended);
    check->ended += rt_node_fanout(node);
    return RT_OK;
}

static RtStatus check_node(Check *check, uint32_t index, uint32_t depth) {
    const RtHierarchy *self = check->self;
    const RtNode *node = &self->nodes[index];
    uint32_t fanout = rt_node_fanout(node), first = node->first;
    bool leaf = rt_node_is_leaf(node);
    if (depth > RT_TREE_MAX_DEPTH) return BROKEN(check, "node %u is too deep", index);
    if (++check->reached > self->node_count) return BROKEN(check, "node %u has two parents", index);
    uint32_t least = leaf ? 1 : 2, most = leaf ? self->max_leaf_size : self->width;
    if (fanout < least || fanout > most)
        return BROKEN(check, "node %u has %u %s, not %u to %u", index, fanout, leaf ? "objects" : "children",
                      least, most);
    if (leaf) return check_leaf(check, index);
    if (first <= index || (uint64_t)first + fanout > self->node_count)
        return BROKEN(check, "node %u has children that are not there", index);
    for (uint32_t child = first; child < first + fanout; child++) {
        RT_TRY(check_node(check, child, depth + 1));
        if (rt_box_contains(node->box, self->nodes[child].box)) continue;
        return BROKEN(check, "node %u does not contain its child %u", index, child);
    }
    return RT_OK;
}

RtStatus rt_hierarchy_validate(const RtHierarchy *self, const RtGeometry *geometry, const char *name,
                               RtError *error) {
    RT_ARENA(arena);
    const uint32_t count = geometry->object_count, nodes = self->node_count;
    if (count == 0) return RT_OK;
    Check check = {self, geometry, name, error, rt_arena_alloc(&arena, count, sizeof(uint32_t)), 0, 0};
    RT_TRY(rt_arena_check(&arena, "validating a hierarchy", error));
    RT_TRY(check_node(&check, 0, 0));
    for (uint32_t id = 0; id < count; id++) {
        if (check.seen[id] == 1 || (self->split_refs && check.seen[id] > 1)) continue;
        return BROKEN(&check, "object %u is in %u leaves, not in one", id, check.seen[id]);
    }
    if (check.reached != nodes) return BROKEN(&check, "%u of %u nodes are in the tree", check.reached, nodes);
    return self->split_refs ? check_coverage(self, geometry, name, error) : RT_OK;
}
