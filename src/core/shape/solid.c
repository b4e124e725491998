/* SPDX-License-Identifier: Apache-2.0 */
/* Sets of solids: the dispatch on the kind, and moving. What a kind is, and how one is added, stands in its
 * own file, solid_KIND.c. */
#include "core/shape/solid.h"

#include "core/base/memory.h"
#include "core/shape/solid_parts.h"

#include <assert.h>

static const char *const kind_names[RT_SOLID_KIND_COUNT] = {
#define NAME(CONSTANT, name) #name,
    RT_SOLID_KINDS(NAME)
#undef NAME
};

const char *rt_solid_kind_name(RtSolidKind kind) {
    assert(kind < RT_SOLID_KIND_COUNT);
    return kind_names[kind];
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
    switch (solid->kind) {
    case RT_SOLID_TORUS: return 4;
    case RT_SOLID_MESH: return solid->count;
    default: return 2;
    }
}

uint32_t rt_solid_crossings(const RtSolidSet *set, uint32_t index, const RtSolidRay *ray, float near,
                            float far, RtCrossing *out) {
    switch (set->solids[index].kind) {
#define CROSSINGS(CONSTANT, name)                                                                            \
    case RT_SOLID_##CONSTANT: return rt_solid_##name##_crossings(set, index, ray, near, far, out);
        RT_SOLID_KINDS(CROSSINGS)
#undef CROSSINGS
    case RT_SOLID_KIND_COUNT: break;
    }
    return 0;
}

RtVec3d rt_solid_normal(const RtSolidSet *set, uint32_t index, uint32_t face, RtVec3d point) {
    const RtSolid *solid = &set->solids[index];
    switch (solid->kind) {
#define NORMAL(CONSTANT, name)                                                                               \
    case RT_SOLID_##CONSTANT: return rt_solid_##name##_normal(set, solid, face, point);
        RT_SOLID_KINDS(NORMAL)
#undef NORMAL
    case RT_SOLID_KIND_COUNT: break;
    }
    return rt_vec3d(0, 0, 0);
}

static double support(const RtSolidSet *set, const RtSolid *solid, RtVec3d direction) {
    switch (solid->kind) {
#define SUPPORT(CONSTANT, name)                                                                              \
    case RT_SOLID_##CONSTANT: return rt_solid_##name##_support(set, solid, direction);
        RT_SOLID_KINDS(SUPPORT)
#undef SUPPORT
    case RT_SOLID_KIND_COUNT: break;
    }
    return INFINITY;
}

double rt_solid_support(const RtSolidSet *set, uint32_t index, RtVec3d direction) {
    return support(set, &set->solids[index], direction);
}

RtBall rt_solid_ball(const RtSolidSet *set, uint32_t index) {
    const RtSolid *solid = &set->solids[index];
    switch (solid->kind) {
#define BALL(CONSTANT, name)                                                                                 \
    case RT_SOLID_##CONSTANT: return rt_solid_##name##_ball(set, solid);
        RT_SOLID_KINDS(BALL)
#undef BALL
    case RT_SOLID_KIND_COUNT: break;
    }
    return (RtBall){{{0, 0, 0}}, INFINITY};
}

/* ---- moving ---- */

/* Puts the moved planes of a solid of `source` behind those of the set. */
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

/* What moving does to a solid besides, now that its planes or triangles are where they go. */
static RtStatus settle(const RtSolidSet *set, RtSolid *solid, const RtTransform *move, RtError *error) {
    switch (solid->kind) {
    case RT_SOLID_MESH: return rt_solid_check_volume(set->triangles + solid->first, solid->count, error);
    case RT_SOLID_POLYHEDRON: return rt_solid_check_inside(set->planes + solid->first, solid->count, error);
    default: solid->place = rt_transform_compose(&solid->place, move);
    }
    if (solid->kind == RT_SOLID_CONE) rt_solid_cone_to_caps(set, solid);
    return RT_OK;
}

RtStatus rt_solid_add_moved(RtSolidSet *set, const RtSolidSet *source, uint32_t from, const RtTransform *move,
                            uint32_t *index, RtError *error) {
    RtSolid solid = source->solids[from];
    if (move) RT_TRY(rt_solid_check_place(move, error));
    if (solid.kind == RT_SOLID_MESH) {
        RT_TRY(move_triangles(set, source, &solid, move, error));
    } else {
        RT_TRY(move_planes(set, source, &solid, move, error));
    }
    if (move) RT_TRY(settle(set, &solid, move, error));
    if (solid.kind == RT_SOLID_MESH) RT_TRY(rt_solid_mesh_boxes(set, &solid, error));
    return rt_solid_finish(set, &solid, support, index, error);
}
