/* SPDX-License-Identifier: Apache-2.0 */
/* wide: a hierarchy of boxes eight children wide, traced in vectors, many rays at once.
 *
 * Papers: Wald, Benthin & Boulos 2008, "Getting Rid of Packets: Efficient SIMD Single-Ray Traversal using
 * Multi-branching BVHs" (nodes of many children, tested at once); and those named in plan.h, plan.c,
 * stream.h and packet.h. The layout and its invariants are in wide.h. The tree of references is built by the
 * methods of accel/tree/tree.h, as for `bvh`.
 *
 * Exact, because boxes are tested by the operations of rt_box_hit, triangles and spheres by those of
 * rt_triangle_hit and rt_sphere_hit, lane by lane. A child that a beam's interval misses is missed by each of
 * its rays (packet.h). The order of visits changes no answer.
 *
 * Counting: an extent test per child of a visited node, a step per node and per leaf, an object test per
 * triangle of a leaf. Rays are counted as if traced alone, with the same counts for all instruction sets and
 * any number of rays in flight. */
#include "accel/wide/wide.h"

/* Parameters of `bvh` that are constants here. */
enum { MORTON_BITS = 21, PLOC_RADIUS = 25 };

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
      "packets are made only if this many rays share the visit of a node, on average; 0: always",            \
      "measured")                                                                                            \
    X(PARAM_HUGE_PAGES, "huge_pages", RT_FLAG("on"), "request large pages from the system", "measured")      \
    X(PARAM_ISA, RT_ISA_PARAM)

enum { PARAMS(RT_PARAM_INDEX) };
static const RtParam params[] = {PARAMS(RT_PARAM_ENTRY)};

/* From so many objects on, leaves have no nodes while the tree is laid out: it takes 2 % more instructions,
 * and 48 bytes an object less. */
enum { MANY_OBJECTS = 1 << 20 };

/* ---- build ---- */

static void destroy(RtAccel *accel) {
    for (int i = 0; i < 2; i++) rt_wide_clear(&((RtWide *)accel)->trees[i]);
}

static RtTreeOptions options_of(const RtBuild *what, RtTreeMethod method) {
    const RtValue *values = what->values;
    return (RtTreeOptions){.method = method,
                           .bits = MORTON_BITS,
                           .radius = PLOC_RADIUS,
                           .spatial = {.bins = (int)values[PARAM_BINS].i,
                                       .alpha = values[PARAM_ALPHA].f,
                                       .budget = values[PARAM_BUDGET].f,
                                       .leaf = (uint32_t)values[PARAM_MAX_LEAF_SIZE].i,
                                       .traversal = 1,
                                       .limit = what->limit},
                           .reinsertion = (uint32_t)values[PARAM_REINSERTION].i,
                           .batch = values[PARAM_BATCH].f};
}

static RtStatus fill(RtWideTree *self, const RtBuild *what, RtTreeMethod method, RtError *error) {
    const RtGeometry *geometry = &what->scene->geometry;
    const RtValue *values = what->values;
    RtWideLayout how = {.leaf_limit = (uint32_t)values[PARAM_MAX_LEAF_SIZE].i,
                        .block_cost = values[PARAM_BLOCK_COST].f,
                        .huge_pages = values[PARAM_HUGE_PAGES].flag,
                        .threads = what->threads,
                        .limit = what->limit};
    RtTreeOptions options = options_of(what, method);
    RtTree tree;
    if (geometry->object_count == 0) return RT_OK;
    RT_TRY(rt_tree_build(&tree, geometry, &options, what->threads, error));
    RtStatus status = RT_OK;
    if (geometry->object_count >= MANY_OBJECTS) status = rt_tree_drop_leaves(&tree, geometry->boxes, error);
    if (status == RT_OK) status = rt_wide_lay_out(self, &tree, geometry, &how, error);
    rt_tree_clear(&tree);
    return status;
}

static RtStatus available(const RtValue *values, RtError *error) {
    return rt_isa_available(values[PARAM_ISA], error);
}

static RtStatus build(RtAccel *accel, const RtBuild *what, RtError *error) {
    const RtValue *values = what->values;
    const RtTreeMethod method = (RtTreeMethod)values[PARAM_BUILD].choice;
    const bool two = method == RT_TREE_SPATIAL && values[PARAM_WHOLE].flag;
    RtWide *self = (RtWide *)accel;
    self->occluded = &self->trees[two ? 1 : 0];
    rt_isa_use(accel, RT_KERNELS_FOR(wide, rt_isa_asked(values[PARAM_ISA])));
    self->in_flight = (uint32_t)values[PARAM_IN_FLIGHT].i;
    self->order = values[PARAM_ORDER].flag;
    self->prefetch = values[PARAM_PREFETCH].flag;
    self->sharing = (float)values[PARAM_SHARING].f;
    self->packets = (uint32_t)values[PARAM_PACKETS].i;
    RT_TRY(fill(&self->trees[0], what, method, error));
    return two ? fill(&self->trees[1], what, RT_TREE_BINNED, error) : RT_OK;
}

/* ---- describe and validate ---- */

/* Describes the tree for nearest hits; `bytes` counts both trees. */
static void describe(const RtAccel *accel, RtDescription *out) {
    const RtWide *self = (const RtWide *)accel;
    rt_wide_describe(&self->trees[0], &accel->scene->geometry, out);
    out->bytes = self->trees[0].bytes + self->trees[1].bytes;
}

static RtStatus validate(const RtAccel *accel, RtError *error) {
    const RtWide *self = (const RtWide *)accel;
    const RtGeometry *g = &accel->scene->geometry;
    RT_TRY(rt_wide_validate(&self->trees[0], g, error));
    return self->occluded == &self->trees[0] ? RT_OK : rt_wide_validate(self->occluded, g, error);
}

static void each_box(const RtAccel *accel, RtBoxViewer viewer) {
    rt_wide_each_box(&((const RtWide *)accel)->trees[0], viewer);
}

const RtAccelOps rt_wide_ops = {
    .name = "wide",
    .summary = "hierarchy of boxes eight wide, SIMD traversal, many rays at once: our fastest",
    .paper = "Wald, Benthin & Boulos 2008, Getting Rid of Packets: Efficient SIMD Single-Ray Traversal using "
             "Multi-branching BVHs, RT'08",
    RT_PARAMS_OF(params),
    .trial = "wide:sharing=0", /* scattered rays make no packets where they need not */
    .bytes = sizeof(RtWide),
    .build = build,
    .destroy = destroy,
    RT_ISA_OPS,
    .describe = describe,
    .validate = validate,
    .each_box = each_box,
    .shows_lists = true,
    .available = available,
};
