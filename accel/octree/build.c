/* SPDX-License-Identifier: Apache-2.0 */
/* Building an octree, level by level: a leaf's list goes to the array of all lists, an inner node's is dealt
 * to the lists of its eight children (divide.c), the next level, as long as it seems to fit (limit.c). */
#include "accel/octree/octree.h"

#include "core/base/memory.h"

const RtParam rt_octree_params[RT_OCTREE_PARAM_COUNT] = {RT_OCTREE_PARAMS(RT_PARAM_ENTRY)};

/* ---- levels ---- */

/* Two more than the least depth at which there are as many cells as objects. */
static uint32_t usual_depth(uint32_t objects) {
    uint32_t depth = 2;
    for (uint64_t cells = 1; cells < objects; cells *= 8) depth++;
    return depth;
}

static RtStatus build_level(RtOctreeBuilder *b, uint32_t from, uint32_t to, RtError *error) {
    RtOctree *tree = b->tree;
    for (uint32_t index = from; index < to; index++) {
        uint32_t count = tree->nodes[index].count;
        const uint32_t *ids = b->list + tree->nodes[index].first;
        if (rt_octree_divides(b, &tree->boxes[index], ids, count)) {
            RT_TRY(rt_octree_divide(b, index, ids, count, error));
        } else {
            RT_TRY(rt_octree_make_leaf(b, index, ids, count, error));
        }
    }
    return RT_OK;
}

static RtStatus build_levels(RtOctreeBuilder *b, RtBox root, uint32_t object_count, RtError *error) {
    RtOctree *tree = b->tree;
    b->list = rt_alloc(object_count, sizeof(uint32_t));
    if (!b->list) {
        return rt_fail_memory(error, "building an octree", object_count * sizeof(uint32_t));
    }
    for (uint32_t i = 0; i < object_count; i++) b->list[i] = i;
    RT_TRY(rt_octree_begin(b, root, object_count, error));
    for (uint32_t from = 0, to = 1; from < to; from = to, to = tree->node_count) {
        RT_TRY(rt_octree_check_limit(b, from, to, error));
        RT_TRY(build_level(b, from, to, error));
        rt_octree_next_level(b);
    }
    return RT_OK;
}

void rt_octree_destroy(RtAccel *accel) {
    RtOctree *tree = (RtOctree *)accel;
    rt_free(tree->nodes);
    rt_free(tree->boxes);
    rt_free(tree->ids);
    rt_free(tree);
}

RtStatus rt_octree_build(const RtBuild *what, RtAccel **out, RtError *error) {
    const RtValue *values = what->values;
    const RtGeometry *g = &what->scene->geometry;
    int64_t depth = values[RT_OCTREE_MAX_DEPTH].i;
    RtAccel *accel;
    RT_TRY(rt_accel_new(what, sizeof(RtOctree), &accel, error));
    RtOctree *tree = (RtOctree *)accel;
    tree->max_leaf_size = (uint32_t)values[RT_OCTREE_MAX_LEAF_SIZE].i;
    tree->max_depth = depth < 0 ? usual_depth(g->object_count) : (uint32_t)depth;
    tree->split = values[RT_OCTREE_SPLIT].choice;
    tree->traversal = values[RT_OCTREE_TRAVERSAL].choice;
    tree->slack = values[RT_OCTREE_SLACK].f;
    tree->flat = values[RT_OCTREE_FLAT].f;
    tree->cut_filled = values[RT_OCTREE_CUT_FILLED].flag;
    tree->mailbox = values[RT_OCTREE_MAILBOX].flag;
    RtOctreeBuilder builder = {.tree = tree, .objects = g->boxes, .limit = what->limit};
    RtStatus status = RT_OK;
    if (g->object_count > 0) {
        RtBox root = g->box;
        for (uint32_t i = 0; i < g->object_count; i++) {
            root = rt_box_union(root, rt_octree_grown(tree, g->boxes[i]));
        }
        root = rt_box_widened(root, values[RT_OCTREE_MARGIN].f);
        status = build_levels(&builder, root, g->object_count, error);
    }
    rt_free(builder.list);
    rt_free(builder.next);
    return rt_accel_built(accel, status, out);
}
