/* SPDX-License-Identifier: Apache-2.0 */
/* Whether the boxes of the leaves that list an object contain all of its surface. rt_object_part computes the
 * part of the surface in a box. If no single leaf contains that part, the box is split at a side of a leaf
 * that runs through it, recursively, until a leaf contains it or no side is left.
 *
 * The tree and this check clip boxes in different ways and round outward differently, so leaves are enlarged
 * here by a few roundings, less than the thickness of rays. */
#include "accel/tree/hierarchy.h"
#include "core/base/memory.h"
#include "core/shape/overlap.h"

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

RtStatus rt_hierarchy_check_coverage(const RtHierarchy *self, const RtGeometry *geometry, const char *name,
                                     RtError *error) {
    uint32_t objects = geometry->object_count;
    Parts parts = {self, geometry, rt_alloc((size_t)objects + 1, sizeof(uint32_t)),
                   rt_alloc(self->id_count, sizeof(uint32_t)), rt_tree_part_margin(&geometry->box)};
    RtStatus status = RT_OK;
    if (parts.first && parts.leaves) {
        list_leaves(&parts);
        for (uint32_t id = 0; id < objects && status == RT_OK; id++) {
            uint32_t first = parts.first[id], count = parts.first[id + 1] - first;
            if (is_covered(&parts, id, parts.leaves + first, count, geometry->boxes[id])) continue;
            status = rt_fail(error, RT_MISMATCH, "%s: part of object %u is in none of its %u leaves", name,
                             id, count);
        }
    } else {
        status = rt_fail_memory(error, "the leaves of each object", self->id_count * sizeof(uint32_t));
    }
    rt_free(parts.first);
    rt_free(parts.leaves);
    return status;
}
