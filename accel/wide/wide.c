/* SPDX-License-Identifier: Apache-2.0 */
/* wide */
#include "accel/wide/wide.h"

#include "base/memory.h"

typedef enum Build { BINNED, SWEEP, LBVH, PLOC, SPATIAL } Build;

#define PARAMS(X)                                                                                            \
    X(PARAM_BUILD, "build", RT_CHOICE("binned", "binned|sweep|lbvh|ploc|spatial"), "how", "Wald 2007")       \
    X(PARAM_BINS, "bins", RT_INT("16", 2, 64, "2|5|64"), "bins", "Wald 2007")                                \
    X(PARAM_MAX_LEAF_SIZE, "max_leaf_size", RT_INT("4", 1, RT_WIDE_MAX_LEAF, "1|16"), "most", "measured")    \
    X(PARAM_BLOCK_COST, "block_cost", RT_FLOAT("1", 0, 1000, "0|0.1|10"), "cost of a block", "measured")     \
    X(PARAM_REINSERTION, "reinsertion", RT_INT("0", 0, 1000, "1|3"), "rounds", "0")                          \
    X(PARAM_IN_FLIGHT, "in_flight", RT_INT("32", 1, RT_WIDE_MAX_IN_FLIGHT, "1|3|64"), "rays", "measured")    \
    X(PARAM_ORDER, "order", RT_FLAG("on"), "near first", "this")                                             \
    X(PARAM_PREFETCH, "prefetch", RT_FLAG("on"), "near first", "this")                                       \
    X(PARAM_HUGE_PAGES, "huge_pages", RT_FLAG("on"), "near first", "this")                                       \
    X(PARAM_PACKETS, "packets", RT_FLAG("on"), "near first", "this")                                       \
    X(PARAM_ISA, "isa", RT_CHOICE("best", "best|portable|avx2|avx512"), "how", "this")

enum { PARAMS(RT_PARAM_INDEX) };
static const RtParam params[] = {PARAMS(RT_PARAM_ENTRY)};

static void destroy(RtAccel *accel) {
    RtWide *self = (RtWide *)accel;
    for (int i = 0; i < 2; i++) rt_wide_clear(&self->trees[i]);
    rt_free(self);
}

static RtStatus make_tree(RtTree *tree, const RtBuild *what, RtError *error) {
    const RtGeometry *geometry = &what->scene->geometry;
    const RtBox *boxes = geometry->boxes;
    uint32_t count = geometry->object_count;
    RtSpatial how = {.bins = (int)what->values[PARAM_BINS].i,
                     .alpha = 1e-5,
                     .budget = 2,
                     .leaf = (uint32_t)what->values[PARAM_MAX_LEAF_SIZE].i,
                     .traversal = 1,
                     .limit = what->limit};
    switch ((Build)what->values[PARAM_BUILD].choice) {
    case BINNED: break;
    case SWEEP: return rt_tree_sweep(tree, boxes, count, error);
    case LBVH: return rt_tree_lbvh(tree, boxes, count, 21, what->threads, error);
    case PLOC: return rt_tree_ploc(tree, boxes, count, 21, 25, what->threads, error);
    case SPATIAL: return rt_tree_spatial(tree, geometry, &how, what->threads, error);
    }
    return rt_tree_topdown(tree, boxes, count, (int)what->values[PARAM_BINS].i, what->threads, error);
}

static RtStatus fill(RtWideTree *self, const RtBuild *what, RtError *error) {
    const RtGeometry *geometry = &what->scene->geometry;
    RtTree tree;
    if (geometry->object_count == 0) return RT_OK;
    RT_TRY(make_tree(&tree, what, error));
    RtStatus status = rt_tree_reinsert(&tree, (uint32_t)what->values[PARAM_REINSERTION].i, what->threads, error);
    RtWideLayout how = {(uint32_t)what->values[PARAM_MAX_LEAF_SIZE].i, what->values[PARAM_BLOCK_COST].f, what->values[PARAM_HUGE_PAGES].flag, what->threads,
                        what->limit};
    if (status == RT_OK) status = rt_wide_lay_out(self, &tree, geometry, &how, error);
    rt_tree_clear(&tree);
    return status;
}

static RtStatus build(const RtBuild *what, RtAccel **out, RtError *error) {
    RtAccel *accel;
    RT_TRY(rt_accel_new(what, sizeof(RtWide), &accel, error));
    RtWide *self = (RtWide *)accel;
    self->nearest = self->occluded = &self->trees[0];
    self->in_flight = (uint32_t)what->values[PARAM_IN_FLIGHT].i;
    self->order = what->values[PARAM_ORDER].flag;
    self->prefetch = what->values[PARAM_PREFETCH].flag;
    self->packets = what->values[PARAM_PACKETS].flag;
    self->kernels = &rt_wide_avx512;
    if (what->values[PARAM_ISA].choice == 1) self->kernels = &rt_wide_portable;
    if (what->values[PARAM_ISA].choice == 2) self->kernels = &rt_wide_avx2;
    return rt_accel_built(accel, fill(&self->trees[0], what, error), out);
}

static void nearest(const RtAccel *a, const RtScratch *s, const RtRay *rays, size_t count, RtHit *hits) {
    ((const RtWide *)a)->kernels->nearest(a, s, rays, count, hits);
}
static void occluded(const RtAccel *a, const RtScratch *s, const RtRay *rays, size_t count, uint32_t *blockers) {
    ((const RtWide *)a)->kernels->occluded(a, s, rays, count, blockers);
}
static void nearest_counted(const RtAccel *a, const RtScratch *s, const RtRay *rays, size_t count, RtHit *hits,
                            RtTally *tallies) {
    ((const RtWide *)a)->kernels->nearest_counted(a, s, rays, count, hits, tallies);
}
static void occluded_counted(const RtAccel *a, const RtScratch *s, const RtRay *rays, size_t count, uint32_t *blockers,
                             RtTally *tallies) {
    ((const RtWide *)a)->kernels->occluded_counted(a, s, rays, count, blockers, tallies);
}

static size_t scratch_bytes(const RtAccel *accel) {
    return ((const RtWide *)accel)->kernels->scratch_bytes(accel);
}

static void describe(const RtAccel *accel, RtDescription *out) {
    const RtWide *self = (const RtWide *)accel;
    const RtWideTree *t = self->nearest;
    *out = (RtDescription){RT_NO_PREDICTION};
    out->bytes = t->bytes;
    out->interior = t->node_count;
    out->leaves = t->leaf_count;
    out->references = t->reference_count;
    out->depth = t->depth;
    out->predicted_cost = t->cost;
}

static RtStatus validate(const RtAccel *accel, RtError *error) {
    (void)accel, (void)error;
    return RT_OK;
}

const RtAccelOps rt_wide_ops = {
    .name = "wide",
    .summary = "hierarchy of boxes of width 8",
    .paper = "Wald et al. 2008",
    RT_PARAMS_OF(params),
    .build = build,
    .destroy = destroy,
    .nearest = nearest,
    .occluded = occluded,
    .nearest_counted = nearest_counted,
    .occluded_counted = occluded_counted,
    .scratch_bytes = scratch_bytes,
    .describe = describe,
    .validate = validate,
};
