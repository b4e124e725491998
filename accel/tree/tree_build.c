/* SPDX-License-Identifier: Apache-2.0 */
/* Dispatch to the builder of each method. The default, binned SAH, is the one without a case of its own. */
#include "accel/tree/tree_build.h"

static RtStatus make(RtTree *tree, const RtGeometry *geometry, const RtTreeOptions *options, int threads,
                     RtError *error) {
    const RtBox *boxes = geometry->boxes;
    uint32_t count = geometry->object_count;
    switch (options->method) {
    case RT_TREE_BINNED: break;
    case RT_TREE_SWEEP: return rt_tree_sweep(tree, boxes, count, error);
    case RT_TREE_LBVH: return rt_tree_lbvh(tree, boxes, count, options->bits, threads, error);
    case RT_TREE_PLOC:
        return rt_tree_ploc(tree, boxes, count, options->bits, options->radius, threads, error);
    case RT_TREE_SPATIAL: return rt_tree_spatial(tree, geometry, &options->spatial, threads, error);
    case RT_TREE_AGGLOMERATIVE: return rt_tree_agglomerative(tree, boxes, count, error);
    case RT_TREE_INSERTION: return rt_tree_insertion(tree, boxes, count, &options->insertion, error);
    case RT_TREE_MEDIAN: return rt_tree_topdown(tree, boxes, count, 0, threads, error);
    }
    return rt_tree_topdown(tree, boxes, count, options->spatial.bins, threads, error);
}

RtStatus rt_tree_build(RtTree *tree, const RtGeometry *geometry, const RtTreeOptions *options, int threads,
                       RtError *error) {
    RT_TRY(make(tree, geometry, options, threads, error));
    RtStatus status = rt_tree_reinsert(tree, options->reinsertion, options->batch, threads, error);
    if (status != RT_OK) rt_tree_clear(tree);
    return status;
}

RtStatus rt_hierarchy_build(RtHierarchy *self, const RtGeometry *geometry, const RtTreeOptions *options,
                            int threads, RtError *error) {
    RtTree tree;
    if (geometry->object_count == 0) return RT_OK;
    RT_TRY(rt_tree_build(&tree, geometry, options, threads, error));
    RtStatus status = rt_hierarchy_lay_out(self, &tree, threads, error);
    rt_tree_clear(&tree);
    return status;
}
