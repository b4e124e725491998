/* SPDX-License-Identifier: Apache-2.0 */
/* Putting terms together: a growing array of nodes whose operands come before them. */
#include "core/shape/csg.h"

#include "core/base/memory.h"

#include <assert.h>

void rt_csg_builder_clear(RtCsgBuilder *builder) {
    rt_solid_set_clear(&builder->set);
    rt_free(builder->nodes);
    *builder = (RtCsgBuilder){0};
}

static RtStatus add_node(RtCsgBuilder *builder, const RtCsgNode *node, RtCsgTerm *out, RtError *error) {
    RtCsgNode copy = *node; /* of what may lie in the array that now grows */
    RT_TRY(rt_reserve(&builder->nodes, &builder->node_capacity, (uint64_t)builder->node_count + 1,
                      sizeof(RtCsgNode), error));
    *out = builder->node_count;
    builder->nodes[builder->node_count++] = copy;
    return RT_OK;
}

RtStatus rt_csg_solid(RtCsgBuilder *builder, uint32_t solid, uint32_t material, RtCsgTerm *out,
                      RtError *error) {
    assert(solid < builder->set.solid_count);
    RtCsgNode node = {.kind = RT_CSG_SOLID, .left = solid, .size = 1};
    RT_TRY(add_node(builder, &node, out, error));
    builder->set.solids[solid].material = material;
    return RT_OK;
}

RtStatus rt_csg_combine(RtCsgBuilder *builder, RtCsgOp op, RtCsgTerm left, RtCsgTerm right, RtCsgTerm *out,
                        RtError *error) {
    assert(left < builder->node_count && right < builder->node_count);
    uint32_t size = builder->nodes[left].size + builder->nodes[right].size;
    if (size > RT_CSG_MAX_SOLIDS) {
        return rt_fail(error, RT_BAD_INPUT,
                       "a tree of %u solids, those of named parts counted at each use: at most %u can be in "
                       "one tree",
                       size, RT_CSG_MAX_SOLIDS);
    }
    RtCsgNode node = {.kind = RT_CSG_COMBINE, .op = op, .left = left, .right = right, .size = size};
    return add_node(builder, &node, out, error);
}

/* Moves of moves are made one, so that a tree has no more moves than twice its solids. */
RtStatus rt_csg_move(RtCsgBuilder *builder, RtCsgTerm term, const RtTransform *move, RtCsgTerm *out,
                     RtError *error) {
    assert(term < builder->node_count);
    const RtCsgNode *moved = &builder->nodes[term];
    RtCsgNode node = {.kind = RT_CSG_MOVE, .left = term, .move = *move, .size = moved->size};
    if (moved->kind == RT_CSG_MOVE) {
        node.left = moved->left;
        node.move = rt_transform_compose(&moved->move, move);
    }
    return add_node(builder, &node, out, error);
}
