/* SPDX-License-Identifier: Apache-2.0 */
#include "core/scene/append.h"

#include "core/base/memory.h"

#include <string.h>

typedef struct Append {
    RtScene *to;
    const RtScene *from;
    const RtTransform *transform; /* or NULL */
    double scale;                 /* the uniform scale, 0 if uneven */
    uint32_t *materials;          /* [from->material_count] index in `to` */
    RtVec3 *vertices;             /* [from->geometry.polygon_vertex_count] moved */
    RtError *error;
} Append;

static RtVec3 move_point(const Append *a, RtVec3 p) {
    return a->transform ? rt_transform_point(a->transform, p) : p;
}

static RtStatus fail_uneven(const Append *a, const char *shape) {
    return rt_fail(a->error, RT_BAD_INPUT,
                   "the transform scales unevenly, which would deform a %s of the scene: use one "
                   "factor for all axes",
                   shape);
}

static RtStatus append_sphere(const Append *a, uint32_t material, const RtSphere *sphere) {
    if (a->scale == 0) return fail_uneven(a, "sphere");
    return rt_scene_add_sphere(a->to, material, move_point(a, sphere->center),
                               (float)((double)sphere->radius * a->scale), a->error);
}

static RtStatus append_cone(const Append *a, uint32_t material, const RtCone *cone) {
    if (a->scale == 0) return fail_uneven(a, "cone");
    return rt_scene_add_cone(a->to, material, move_point(a, cone->base),
                             (float)((double)cone->base_radius * a->scale), move_point(a, cone->apex),
                             (float)((double)cone->apex_radius * a->scale), a->error);
}

static RtStatus append_triangle(const Append *a, uint32_t material, uint32_t index) {
    const RtGeometry *g = &a->from->geometry;
    uint32_t entry = g->triangle_normals ? g->triangle_normals[index] : RT_NO_NORMALS;
    RtVec3 vertices[3], normals[3];
    for (int i = 0; i < 3; i++) {
        vertices[i] = move_point(a, g->triangles[index].v[i]);
        if (entry == RT_NO_NORMALS) continue;
        RtVec3 n = g->vertex_normals[entry].n[i];
        normals[i] = a->transform ? rt_transform_normal(a->transform, n) : n;
    }
    return rt_scene_add_triangle(a->to, material, vertices, entry == RT_NO_NORMALS ? NULL : normals,
                                 a->error);
}

static RtStatus append_object(const Append *a, uint32_t id) {
    const RtGeometry *g = &a->from->geometry;
    uint32_t index = rt_ref_index(g->objects[id]), material = a->materials[a->from->material_of[id]];
    switch (rt_ref_shape(g->objects[id])) {
    case RT_SHAPE_SPHERE: return append_sphere(a, material, &g->spheres[index]);
    case RT_SHAPE_POLYGON:
        return rt_scene_add_polygon(a->to, material, a->vertices + g->polygons[index].first,
                                    g->polygons[index].count, a->error);
    case RT_SHAPE_TRIANGLE: return append_triangle(a, material, index);
    case RT_SHAPE_CONE: return append_cone(a, material, &g->cones[index]);
    case RT_SHAPE_CSG: return rt_scene_copy_csg(a->to, a->from, index, a->materials, a->transform, a->error);
    case RT_SHAPE_COUNT: break;
    }
    return RT_OK;
}

static RtStatus append_materials(const Append *a) {
    for (uint32_t i = 0; i < a->from->material_count; i++) {
        const RtMaterial *material = &a->from->materials[i];
        uint32_t known = rt_scene_find_material(a->to, material->name);
        if (known != UINT32_MAX && memcmp(&a->to->materials[known], material, sizeof *material) == 0)
            a->materials[i] = known;
        else
            RT_TRY(rt_scene_add_material(a->to, material, &a->materials[i], a->error));
    }
    return RT_OK;
}

/* The objects ids[0..count), or with NULL the first `count`. */
static RtStatus append(RtScene *to, const RtScene *from, const uint32_t *ids, uint32_t count,
                       const RtTransform *transform, RtError *error) {
    RT_ARENA(memory);
    const RtGeometry *g = &from->geometry;
    const Append a = {.to = to,
                      .from = from,
                      .transform = transform,
                      .scale = transform ? rt_transform_uniform_scale(transform) : 1,
                      .materials = rt_arena_alloc(&memory, from->material_count, sizeof(uint32_t)),
                      .vertices = rt_arena_alloc(&memory, g->polygon_vertex_count, sizeof(RtVec3)),
                      .error = error};
    RT_TRY(rt_arena_check(&memory, "appending a scene", error));
    RT_TRY(append_materials(&a));
    for (uint32_t i = 0; i < g->polygon_vertex_count; i++)
        a.vertices[i] = move_point(&a, g->polygon_vertices[i]);
    for (uint32_t i = 0; i < count; i++) RT_TRY(append_object(&a, ids ? ids[i] : i));
    return RT_OK;
}

RtStatus rt_scene_append(RtScene *to, const RtScene *from, const RtTransform *transform, RtError *error) {
    return append(to, from, NULL, from->geometry.object_count, transform, error);
}

static RtStatus fill_subset(RtScene *to, const RtScene *from, const uint32_t *ids, uint32_t count,
                            RtError *error) {
    to->ambient = from->ambient;
    to->background = from->background;
    to->camera = from->camera;
    for (uint32_t i = 0; i < from->light_count; i++)
        RT_TRY(rt_scene_add_light(to, from->lights[i].position, from->lights[i].intensity, error));
    RT_TRY(append(to, from, ids, count, NULL, error));
    RT_TRY(rt_scene_finish(to, error));
    to->sampling = from->sampling;
    return RT_OK;
}

RtStatus rt_scene_subset(const RtScene *from, const uint32_t *ids, uint32_t count, RtScene *to,
                         RtError *error) {
    rt_scene_init(to);
    memcpy(to->name, from->name, sizeof to->name);
    RtStatus status = fill_subset(to, from, ids, count, error);
    if (status != RT_OK) rt_scene_clear(to);
    return status;
}
