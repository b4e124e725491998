/* SPDX-License-Identifier: Apache-2.0 */
/* Making mesh solids: is the mesh closed and turned outward, and in which order do its triangles stand?
 *
 * They are leaves of a complete binary tree, RT_SOLID_LEAF to a leaf: the half of the leaves of a node that
 * lies lower along the longest side of its triangles' box goes left. So the tree is its boxes alone, from the
 * root on (node 1, of children 2 and 3), and a moved copy needs new boxes but no new order. */
#include "core/base/memory.h"
#include "core/shape/solid_parts.h"

#include <stdlib.h>

/* ---- is it closed? ---- */

/* An edge with its ends in order; `turned` is 1 where the triangle has it so, -1 where it has the reverse. */
typedef struct Edge {
    RtVec3 ends[2];
    int turned;
} Edge;

static int compare_points(RtVec3 a, RtVec3 b) {
    for (int i = 0; i < 3; i++) {
        if (a.at[i] != b.at[i]) return a.at[i] < b.at[i] ? -1 : 1;
    }
    return 0;
}

static int compare_edges(const void *a, const void *b) {
    const Edge *e = a, *f = b;
    int order = compare_points(e->ends[0], f->ends[0]);
    return order ? order : compare_points(e->ends[1], f->ends[1]);
}

static Edge edge_of(RtVec3 from, RtVec3 to) {
    return compare_points(from, to) <= 0 ? (Edge){{from, to}, 1} : (Edge){{to, from}, -1};
}

/* Sorts the edges, and looks at those that are the same together. An edge from a point to itself is none. */
static RtStatus check_edges(Edge *edges, size_t count, RtError *error) {
    qsort(edges, count, sizeof *edges, compare_edges);
    for (size_t i = 0, next; i < count; i = next) {
        int64_t sum = 0;
        for (next = i; next < count && compare_edges(&edges[i], &edges[next]) == 0; next++)
            sum += edges[next].turned;
        RtVec3 a = edges[i].ends[0], b = edges[i].ends[1];
        if (sum == 0 || compare_points(a, b) == 0) continue;
        return rt_fail(
            error, RT_BAD_INPUT,
            "the mesh is not closed: at the edge from (%g, %g, %g) to (%g, %g, %g) triangles on one "
            "side have no neighbour that is turned alike; close the hole there, or turn them round",
            (double)a.x, (double)a.y, (double)a.z, (double)b.x, (double)b.y, (double)b.z);
    }
    return RT_OK;
}

static RtStatus check_closed(const RtTriangle *triangles, uint32_t count, RtError *error) {
    size_t edge_count = 3 * (size_t)count;
    Edge *edges = rt_alloc(edge_count, sizeof *edges);
    if (!edges) return rt_fail_memory(error, "the edges of a mesh", edge_count * sizeof *edges);
    for (uint32_t i = 0; i < count; i++) {
        const RtVec3 *v = triangles[i].v;
        for (uint32_t k = 0; k < 3; k++) edges[3 * (size_t)i + k] = edge_of(v[k], v[(k + 1) % 3]);
    }
    RtStatus status = check_edges(edges, edge_count, error);
    rt_free(edges);
    return status;
}

/* The volume is that of the tetrahedra from one vertex to all triangles. */
RtStatus rt_solid_check_volume(const RtTriangle *triangles, uint32_t count, RtError *error) {
    RtVec3d origin = rt_widen(triangles[0].v[0]);
    double volume = 0;
    for (uint32_t i = 0; i < count; i++) {
        RtVec3d v[3];
        for (int k = 0; k < 3; k++) v[k] = rt_subd(rt_widen(triangles[i].v[k]), origin);
        volume += rt_dotd(v[0], rt_crossd(v[1], v[2])) / 6;
    }
    if (volume > 0) return RT_OK;
    return rt_fail(
        error, RT_BAD_INPUT,
        "the volume in the mesh is %g: expected a value above 0; if it is turned inside out, turn its "
        "triangles round (counter-clockwise seen from outside)",
        volume);
}

/* ---- order and boxes ---- */

/* A triangle by its place along an axis, and by its number where two are at one place. */
typedef struct Placed {
    float place;
    uint32_t number;
    RtTriangle triangle;
} Placed;

static int compare_placed(const void *a, const void *b) {
    const Placed *p = a, *q = b;
    if (p->place != q->place) return p->place < q->place ? -1 : 1;
    return p->number < q->number ? -1 : 1;
}

static RtBox box_about(const RtTriangle *triangles, uint32_t count) {
    RtBox box = RT_EMPTY_BOX;
    for (uint32_t i = 0; i < count; i++) box = rt_box_union(box, rt_triangle_box(&triangles[i]));
    return box;
}

/* Brings the triangles of a node with so many leaves into order. */
static void put_in_order(RtTriangle *triangles, uint32_t count, uint32_t leaves, Placed *scratch) {
    if (count <= RT_SOLID_LEAF) return;
    uint32_t left = leaves / 2 * RT_SOLID_LEAF;
    if (left < count) {
        int axis = rt_major_axis(rt_box_size(box_about(triangles, count)));
        for (uint32_t i = 0; i < count; i++) {
            float place = rt_box_center(rt_triangle_box(&triangles[i])).at[axis];
            scratch[i] = (Placed){place, i, triangles[i]};
        }
        qsort(scratch, count, sizeof *scratch, compare_placed);
        for (uint32_t i = 0; i < count; i++) triangles[i] = scratch[i].triangle;
        put_in_order(triangles + left, count - left, leaves / 2, scratch);
    }
    put_in_order(triangles, left < count ? left : count, leaves / 2, scratch);
}

static uint32_t leaves_for(uint32_t count) {
    uint32_t leaves = 1;
    while ((uint64_t)leaves * RT_SOLID_LEAF < count) leaves *= 2;
    return leaves;
}

RtStatus rt_solid_mesh_boxes(RtSolidSet *set, RtSolid *solid, RtError *error) {
    uint32_t leaves = leaves_for(solid->count);
    RT_TRY(rt_reserve(&set->boxes, &set->box_capacity, (uint64_t)set->box_count + 2 * (uint64_t)leaves - 1,
                      sizeof(RtBox), error));
    RtBox *boxes = set->boxes + set->box_count;
    for (uint32_t i = 0; i < leaves; i++) {
        uint32_t first = i * RT_SOLID_LEAF, last = first + RT_SOLID_LEAF;
        if (last > solid->count) last = solid->count;
        boxes[leaves - 1 + i] = RT_EMPTY_BOX;
        if (first < last)
            boxes[leaves - 1 + i] = box_about(set->triangles + solid->first + first, last - first);
    }
    for (size_t node = leaves - 1; node > 0; node--)
        boxes[node - 1] = rt_box_union(boxes[2 * node - 1], boxes[2 * node]);
    solid->first_box = set->box_count;
    solid->leaves = leaves;
    return RT_OK;
}

/* ---- adding ---- */

static RtStatus check_and_order(RtTriangle *triangles, uint32_t count, RtError *error) {
    RT_TRY(check_closed(triangles, count, error));
    RT_TRY(rt_solid_check_volume(triangles, count, error));
    Placed *scratch = rt_alloc(count, sizeof *scratch);
    if (!scratch) return rt_fail_memory(error, "the order of a mesh", count * sizeof *scratch);
    put_in_order(triangles, count, leaves_for(count), scratch);
    rt_free(scratch);
    return RT_OK;
}

RtStatus rt_solid_add_mesh(RtSolidSet *set, const RtTriangle *triangles, uint32_t count,
                           const RtTransform *place, uint32_t *index, RtError *error) {
    if (count < 4) {
        return rt_fail(error, RT_BAD_INPUT, "a closed mesh has at least 4 triangles; this one has %u", count);
    }
    RT_TRY(rt_solid_check_place(place, error));
    RT_TRY(rt_reserve(&set->triangles, &set->triangle_capacity, (uint64_t)set->triangle_count + count,
                      sizeof(RtTriangle), error));
    RtTriangle *own = set->triangles + set->triangle_count;
    for (uint32_t i = 0; i < count; i++) {
        for (int v = 0; v < 3; v++) {
            own[i].v[v] = rt_transform_point(place, triangles[i].v[v]);
            if (!rt_finite(own[i].v[v])) {
                return rt_fail(error, RT_BAD_INPUT, "vertex %d of triangle %u of the mesh is not finite", v,
                               i);
            }
        }
    }
    RT_TRY(check_and_order(own, count, error));
    RtSolid solid = {.kind = RT_SOLID_MESH,
                     .first = set->triangle_count,
                     .count = count,
                     .place = rt_transform_identity()};
    RT_TRY(rt_solid_mesh_boxes(set, &solid, error));
    return rt_solid_finish(set, &solid, rt_solid_mesh_support, index, error);
}
