/* SPDX-License-Identifier: Apache-2.0 */
/* Sets of solids: dispatch on the kind, and moving. */
#include "core/shape/solid.h"

#include "core/base/memory.h"
#include "core/shape/solid_parts.h"

#include <assert.h>

/* The functions of each kind. */
static const struct {
    const char *name;
    uint32_t (*crossings)(const RtSolidSet *set, uint32_t index, const RtSolidRay *ray, float near, float far,
                          RtCrossing *out);
    RtVec3d (*normal)(const RtSolidSet *set, const RtSolid *solid, uint32_t face, RtVec3d point);
    RtSolidSupport *support;
    RtBall (*ball)(const RtSolidSet *set, const RtSolid *solid);
} kinds[] = {
#define KIND(CONSTANT, name)                                                                                 \
    {#name, rt_solid_##name##_crossings, rt_solid_##name##_normal, rt_solid_##name##_support,                \
     rt_solid_##name##_ball},
    RT_SOLID_KINDS(KIND)
#undef KIND
};

const char *rt_solid_kind_name(RtSolidKind kind) {
    assert(kind < RT_SOLID_KIND_COUNT);
    return kinds[kind].name;
}

void rt_solid_set_clear(RtSolidSet *set) {
    rt_free(set->solids);
    rt_free(set->planes);
    rt_free(set->triangles);
    rt_free(set->boxes);
    *set = (RtSolidSet){0};
}

uint64_t rt_solid_set_bytes(const RtSolidSet *set) {
    return (uint64_t)set->solid_capacity * sizeof(RtSolid) + (uint64_t)set->plane_capacity * sizeof(RtPlane) +
           (uint64_t)set->triangle_capacity * sizeof(RtTriangle) +
           (uint64_t)set->box_capacity * sizeof(RtBox);
}

/* ---- by kind ---- */

uint32_t rt_solid_most_crossings(const RtSolid *solid) {
    return solid->kind == RT_SOLID_TORUS ? 4 : solid->kind == RT_SOLID_MESH ? solid->count : 2;
}

uint32_t rt_solid_crossings(const RtSolidSet *set, uint32_t index, const RtSolidRay *ray, float near,
                            float far, RtCrossing *out) {
    return kinds[set->solids[index].kind].crossings(set, index, ray, near, far, out);
}

RtVec3d rt_solid_normal(const RtSolidSet *set, uint32_t index, uint32_t face, RtVec3d point) {
    return kinds[set->solids[index].kind].normal(set, &set->solids[index], face, point);
}

double rt_solid_support(const RtSolidSet *set, uint32_t index, RtVec3d direction) {
    return kinds[set->solids[index].kind].support(set, &set->solids[index], direction);
}

RtBall rt_solid_ball(const RtSolidSet *set, uint32_t index) {
    return kinds[set->solids[index].kind].ball(set, &set->solids[index]);
}

/* ---- moving ---- */

/* Appends the moved planes of a solid of `source` behind those of the set. */
static RtStatus move_planes(RtSolidSet *set, const RtSolidSet *source, RtSolid *solid,
                            const RtTransform *move, RtError *error) {
    RT_TRY(rt_reserve(&set->planes, &set->plane_capacity, (uint64_t)set->plane_count + solid->count,
                      sizeof(RtPlane), error));
    for (uint32_t i = 0; i < solid->count; i++) {
        const RtPlane *plane = &source->planes[solid->first + i];
        set->planes[set->plane_count + i] = move ? rt_plane_moved(plane, move) : *plane;
    }
    solid->first = set->plane_count;
    return RT_OK;
}

static RtStatus move_triangles(RtSolidSet *set, const RtSolidSet *source, RtSolid *solid,
                               const RtTransform *move, RtError *error) {
    RT_TRY(rt_reserve(&set->triangles, &set->triangle_capacity, (uint64_t)set->triangle_count + solid->count,
                      sizeof(RtTriangle), error));
    for (uint32_t i = 0; i < solid->count; i++) {
        RtTriangle triangle = source->triangles[solid->first + i];
        for (int v = 0; move && v < 3; v++) triangle.v[v] = rt_transform_point(move, triangle.v[v]);
        set->triangles[set->triangle_count + i] = triangle;
    }
    solid->first = set->triangle_count;
    return RT_OK;
}

/* Completes a moved solid, whose planes or triangles have been appended. */
static RtStatus settle(const RtSolidSet *set, RtSolid *solid, const RtTransform *move, RtError *error) {
    switch (solid->kind) {
    case RT_SOLID_MESH: return rt_solid_check_volume(set->triangles + solid->first, solid->count, error);
    case RT_SOLID_POLYHEDRON: return rt_solid_check_inside(set->planes + solid->first, solid->count, error);
    default: solid->to_world = rt_transform_compose(&solid->to_world, move);
    }
    if (solid->kind == RT_SOLID_CONE) rt_solid_cone_to_caps(set, solid);
    return RT_OK;
}

RtStatus rt_solid_add_moved(RtSolidSet *set, const RtSolidSet *source, uint32_t from, const RtTransform *move,
                            uint32_t *index, RtError *error) {
    RtSolid solid = source->solids[from];
    if (move) RT_TRY(rt_solid_check_transform(move, error));
    if (solid.kind == RT_SOLID_MESH)
        RT_TRY(move_triangles(set, source, &solid, move, error));
    else
        RT_TRY(move_planes(set, source, &solid, move, error));
    if (move) RT_TRY(settle(set, &solid, move, error));
    if (solid.kind == RT_SOLID_MESH) RT_TRY(rt_solid_mesh_boxes(set, &solid, error));
    return rt_solid_finish(set, &solid, kinds[solid.kind].support, index, error);
}
