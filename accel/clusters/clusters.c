/* SPDX-License-Identifier: Apache-2.0 */
/* clusters: a hierarchy of extents of any kind, made by clustering objects.
 *
 * Papers: Rubin & Whitted 1980 (hierarchies of bounding volumes), Goldsmith & Salmon 1987, Walter et al.
 * 2008, Meister & Bittner 2018 (clustering; accel/tree/tree.h). All methods cluster boxes by their surface
 * area. Extents of the chosen kind are fitted to the objects of each node afterwards, not to the extents
 * below.
 *
 * Layout: that of accel/tree/hierarchy.h, with one extent per node. Exact by accel/extent.h: a ray that
 * misses the extent of a group misses its objects, and a node is skipped only if its box begins beyond the
 * best hit, so ties survive. RT_TREE_MAX_DEPTH bounds the stack.
 *
 * Counting: a step per node visited. With traversal_order=fixed children are visited in stored order, and the
 * extent of a node is tested when it is popped (Rubin & Whitted). With nearest the extents of all children
 * are tested when their parent is visited, and children are visited in the order in which the ray enters
 * them. */
#include "accel/clusters/clusters.h"

#define PARAMS(X)                                                                                            \
    X(PARAM_METHOD, "method",                                                                                \
      RT_CHOICE("agglomerative", "agglomerative|ploc|goldsmith-salmon|rubin-whitted|sah"),                   \
      "nearest pairs; nearest neighbours in Morton order; insertion; medians; SAH in 16 bins",               \
      "Walter et al. 2008")                                                                                  \
    X(PARAM_EXTENT, "extent", RT_CHOICE("box", RT_EXTENT_KINDS),                                             \
      "extents of nodes: axis-aligned boxes, spheres, oriented boxes or slabs", "the cheapest test")         \
    X(PARAM_SLABS, "slabs", RT_INT("7", 3, RT_MAX_SLABS, "3|13"),                                            \
      "extent=slabs: plane sets, first 3 axes, then 4 diagonals of a cube, then 6 of its faces",             \
      "Kay & Kajiya 1986")                                                                                   \
    X(PARAM_WIDTH, "width", RT_INT("4", 2, RT_NODE_MAX_WIDTH, "2|3|16"),                                     \
      "maximum number of children of a node; the largest child is replaced by its children",                 \
      "measured: 0.82 of the time of 2 in the mean")                                                         \
    X(PARAM_MAX_LEAF_SIZE, "max_leaf_size", RT_INT("1", 1, 1024, "2|8|64"),                                  \
      "maximum number of objects in a leaf; objects share a leaf if that costs no more by SAH",              \
      "an extent around every object")                                                                       \
    X(PARAM_TRAVERSAL_ORDER, "traversal_order", RT_CHOICE("nearest", "fixed|nearest"),                       \
      "children visited in stored order, or in the order in which the ray enters them", "Kay & Kajiya 1986") \
    X(PARAM_RADIUS, "radius", RT_INT("25", 1, 1024, "1|100"),                                                \
      "method=ploc: neighbours searched on either side", "Meister & Bittner 2018")                           \
    X(PARAM_ORDER, "order", RT_CHOICE("random", "given|random"),                                             \
      "method=goldsmith-salmon: insertion in the order of ids, or in random order",                          \
      "Goldsmith & Salmon 1987")                                                                             \
    X(PARAM_PERMUTATIONS, "permutations", RT_INT("1", 1, 1000, "3"),                                         \
      "method=goldsmith-salmon: orders tried, all but the first random; the cheapest tree is kept",          \
      "Goldsmith & Salmon 1987")                                                                             \
    X(PARAM_SEED, "seed", RT_INT("1", 0, 1e9, "2"), "method=goldsmith-salmon: seed of the random orders",    \
      "arbitrary")

enum { PARAMS(RT_PARAM_INDEX) };
static const RtParam params[] = {PARAMS(RT_PARAM_ENTRY)};

/* ---- build ---- */

/* In the order of the choices of `method`. */
static const RtTreeMethod methods[] = {RT_TREE_AGGLOMERATIVE, RT_TREE_PLOC, RT_TREE_INSERTION, RT_TREE_MEDIAN,
                                       RT_TREE_BINNED};

/* The objects below node `index`, a run of ids. */
static RtGroup group_of(const RtClusters *self, uint32_t index) {
    const RtHierarchy *hierarchy = &self->hierarchy;
    const RtNode *first = &hierarchy->nodes[index], *last = first;
    while (!rt_node_is_leaf(first)) first = &hierarchy->nodes[first->first];
    while (!rt_node_is_leaf(last)) last = &hierarchy->nodes[last->first + rt_node_fanout(last) - 1];
    return (RtGroup){&self->base.scene->geometry, hierarchy->ids + first->first,
                     last->first + rt_node_fanout(last) - first->first, hierarchy->nodes[index].box};
}

static RtStatus build(RtAccel *accel, const RtBuild *what, RtError *error) {
    const RtValue *values = what->values;
    const RtTreeOptions options = {.method = methods[values[PARAM_METHOD].choice],
                                   .bits = RT_MAX_MORTON_BITS,
                                   .radius = (uint32_t)values[PARAM_RADIUS].i,
                                   .spatial = {.bins = 16},
                                   .insertion = {values[PARAM_ORDER].choice == 1,
                                                 (uint32_t)values[PARAM_PERMUTATIONS].i,
                                                 (uint64_t)values[PARAM_SEED].i}};
    RtClusters *self = (RtClusters *)accel;
    RtHierarchy *hierarchy = &self->hierarchy;
    *hierarchy = (RtHierarchy){.width = (uint32_t)values[PARAM_WIDTH].i,
                               .max_leaf_size = (uint32_t)values[PARAM_MAX_LEAF_SIZE].i,
                               .traversal_cost = 1};
    self->nearest_first = values[PARAM_TRAVERSAL_ORDER].choice == 1;
    RT_TRY(rt_hierarchy_build(hierarchy, &accel->memory, &what->scene->geometry, &options, what->threads,
                              error));
    RT_TRY(rt_extent_set_init(&self->set, &accel->memory, (RtExtentKind)values[PARAM_EXTENT].choice,
                              (uint32_t)values[PARAM_SLABS].i, hierarchy->node_count, error));
    for (uint32_t index = 0; index < hierarchy->node_count; index++) {
        RtGroup group = group_of(self, index);
        rt_extent_fit(&self->set, index, &group);
    }
    return RT_OK;
}

/* ---- queries ---- */

typedef struct StackEntry {
    uint32_t node;
    float enter; /* a lower bound on t of hits below */
} StackEntry;

/* Each level pushes at most all children but one. */
enum { STACK_SIZE = RT_TREE_MAX_DEPTH * (RT_NODE_MAX_WIDTH - 1) + 1 };

/* Inserts `entry` into stack[bottom..top): the entry with the least t on top, equal ones in the order of
 * insertion. */
static inline void push_by_entry(StackEntry *stack, uint32_t bottom, uint32_t top, StackEntry entry) {
    for (; top > bottom && stack[top - 1].enter <= entry.enter; top--) stack[top] = stack[top - 1];
    stack[top] = entry;
}

/* One extent test. `kind` is a constant after inlining, here and below. */
RT_KERNEL bool meets(RtExtentKind kind, const RtClusters *self, uint32_t index, const RtPreparedRay *ray,
                     const RtLine *line, float limit, float *enter, RtTally *tally) {
    const RtBox *box = &self->hierarchy.nodes[index].box;
    RT_COUNT(tally, extent_tests, 1);
    bool met = rt_extent_hit(&self->set, kind, index, box, ray, line, limit, enter);
    RT_OBSERVE(tally, .kind = RT_TRACED_EXTENT_TEST, .what = "node", .index = index, .box = box,
               .ball = rt_extent_ball(&self->set, kind, index), .met = met);
    return met;
}

RT_KERNEL void traverse(RtExtentKind kind, const RtClusters *self, const RtPreparedRay *ray, bool any,
                        RtHit *best, RtTally *tally) {
    const RtGeometry *geometry = &self->base.scene->geometry;
    const RtNode *nodes = self->hierarchy.nodes;
    StackEntry stack[STACK_SIZE];
    uint32_t stacked = 0;
    float enter;
    if (self->hierarchy.node_count == 0) return;
    RtLine line = rt_line(&self->set, kind, geometry, ray);
    if (!meets(kind, self, 0, ray, &line, ray->tmax, &enter, tally)) return;
    stack[stacked++] = (StackEntry){0, enter};
    while (stacked > 0) {
        StackEntry at = stack[--stacked];
        const RtNode *node = &nodes[at.node];
        if (self->nearest_first) {
            if (at.enter > rt_limit(ray, best)) continue;
        } else if (at.node > 0) {
            if (!meets(kind, self, at.node, ray, &line, rt_limit(ray, best), &enter, tally)) continue;
        }
        RT_COUNT(tally, steps, 1);
        RT_OBSERVE(tally, .kind = RT_TRACED_STEP, .what = "node", .index = at.node, .box = &node->box,
                   .leaf = rt_node_is_leaf(node));
        uint32_t first = node->first, end = first + rt_node_fanout(node);
        if (rt_node_is_leaf(node)) {
            RT_COUNT(tally, leaf_steps, 1);
            for (uint32_t i = first; i < end; i++) {
                if (rt_test_object(geometry, self->hierarchy.ids[i], ray, any, best, tally)) return;
            }
        } else if (self->nearest_first) {
            uint32_t bottom = stacked;
            float limit = rt_limit(ray, best);
            for (uint32_t i = first; i < end; i++) {
                if (!meets(kind, self, i, ray, &line, limit, &enter, tally)) continue;
                push_by_entry(stack, bottom, stacked++, (StackEntry){i, enter});
            }
        } else {
            for (uint32_t i = end; i-- > first;) stack[stacked++] = (StackEntry){i, 0};
        }
    }
}

RT_KERNEL void search(const RtClusters *self, void *scratch, const RtPreparedRay *ray, bool any, RtHit *best,
                      RtTally *tally) {
    (void)scratch;
    RT_BY_EXTENT_KIND(self->set.kind, traverse, self, ray, any, best, tally);
}

RT_DEFINE_KERNELS(RtClusters, search)

/* ---- looking at it ---- */

static void describe(const RtAccel *accel, RtDescription *out) {
    const RtClusters *self = (const RtClusters *)accel;
    rt_hierarchy_describe(&self->hierarchy, &accel->scene->geometry, out);
    out->bytes += rt_extent_set_bytes(&self->set);
}

static RtStatus validate(const RtAccel *accel, RtError *error) {
    const RtClusters *self = (const RtClusters *)accel;
    RT_TRY(rt_hierarchy_validate(&self->hierarchy, &accel->scene->geometry, "clusters", error));
    for (uint32_t index = 0; index < self->hierarchy.node_count; index++) {
        RtGroup group = group_of(self, index);
        RT_TRY(rt_extent_check(&self->set, index, &group, "clusters", error));
    }
    return RT_OK;
}

static void each_box(const RtAccel *accel, RtBoxViewer viewer) {
    const RtClusters *self = (const RtClusters *)accel;
    rt_hierarchy_each_box(&self->hierarchy, &self->set, viewer);
}

const RtAccelOps rt_clusters_ops = {
    .name = "clusters",
    .summary =
        "hierarchy of extents of any kind, built by clustering objects bottom-up, top-down or one by one",
    .paper = "Walter, Bala, Kulkarni & Pingali 2008, Fast Agglomerative Clustering for Rendering, RT'08",
    RT_PARAMS_OF(params),
    RT_BEST("method=agglomerative|sah,max_leaf_size=1|4"),
    .bytes = sizeof(RtClusters),
    .build = build,
    .kernels = &kernels,
    .describe = describe,
    .validate = validate,
    .each_box = each_box,
    .shows_lists = true,
};
