/* SPDX-License-Identifier: Apache-2.0 */
#include "accel/tree/recipe.h"

static RtStatus make(RtTree *tree, const RtGeometry *geometry, const RtTreeRecipe *recipe, int threads,
                     RtError *error) {
    const RtBox *boxes = geometry->boxes;
    uint32_t count = geometry->object_count;
    switch (recipe->method) {
    case RT_TREE_BINNED: break;
    case RT_TREE_SWEEP: return rt_tree_sweep(tree, boxes, count, error);
    case RT_TREE_LBVH: return rt_tree_lbvh(tree, boxes, count, recipe->bits, threads, error);
    case RT_TREE_PLOC: return rt_tree_ploc(tree, boxes, count, recipe->bits, recipe->radius, threads, error);
    case RT_TREE_SPATIAL: return rt_tree_spatial(tree, geometry, &recipe->spatial, threads, error);
    }
    return rt_tree_topdown(tree, boxes, count, recipe->spatial.bins, threads, error);
}

RtStatus rt_tree_make(RtTree *tree, const RtGeometry *geometry, const RtTreeRecipe *recipe, int threads,
                      RtError *error) {
    RT_TRY(make(tree, geometry, recipe, threads, error));
    RtStatus status = rt_tree_reinsert(tree, recipe->reinsertion, threads, error);
    if (status != RT_OK) rt_tree_clear(tree);
    return status;
}
