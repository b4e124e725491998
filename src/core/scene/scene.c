/* SPDX-License-Identifier: Apache-2.0 */
#include "core/scene/scene.h"

#include "core/base/elementary.h"
#include "core/base/memory.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

/* Keeps the state on the stack, so that no allocation can fail. */
#define XXH_INLINE_ALL
#include <xxhash.h>

void rt_scene_init(RtScene *scene) {
    *scene = (RtScene){
        .ambient = {1, 1, 1},
        .background = {0.078f, 0.361f, 0.753f}, /* SPD's sky */
        .camera = {.up = {0, 0, 1}, .fov = 45, .width = 512, .height = 512},
    };
}

RtMaterial rt_default_material(void) {
    return (RtMaterial){.name = "default",
                        .color = {0.8f, 0.8f, 0.8f},
                        .ambient = 0.1f,
                        .diffuse = 0.9f,
                        .shine = 1,
                        .ior = 1};
}

static RtStatus check_range(const char *material, const char *what, float value, float lo, float hi,
                            RtError *error) {
    if (value >= lo && value <= hi) return RT_OK;
    return rt_fail(error, RT_BAD_INPUT, "material '%s': %s is %g: expected %g..%g", material, what,
                   (double)value, (double)lo, (double)hi);
}

static RtStatus check_texture(const char *material, const RtTexture *texture, RtError *error) {
    if (texture->kind == RT_TEXTURE_NONE) return RT_OK;
    for (int channel = 0; channel < 3; channel++)
        RT_TRY(check_range(material, "a colour of the checker", texture->color.at[channel], 0, 1e6f, error));
    if (!rt_finite(texture->origin))
        return rt_fail(error, RT_BAD_INPUT, "material '%s': the origin of its texture is not finite",
                       material);
    return check_range(material, "the size of the texture", texture->size, 1e-6f, 1e6f, error);
}

RtStatus rt_scene_add_material(RtScene *scene, const RtMaterial *material, uint32_t *index, RtError *error) {
    const RtMaterial *m = material;
    const float color_max = 1e6f;
    RT_TRY(check_range(m->name, "the red of the colour", m->color.x, 0, color_max, error));
    RT_TRY(check_range(m->name, "the green of the colour", m->color.y, 0, color_max, error));
    RT_TRY(check_range(m->name, "the blue of the colour", m->color.z, 0, color_max, error));
    RT_TRY(check_range(m->name, "ambient", m->ambient, 0, 1e6f, error));
    RT_TRY(check_range(m->name, "diffuse", m->diffuse, 0, 1e6f, error));
    RT_TRY(check_range(m->name, "specular", m->specular, 0, 1e6f, error));
    RT_TRY(check_range(m->name, "shine", m->shine, 0, 1e6f, error));
    RT_TRY(check_range(m->name, "reflection", m->reflection, 0, 1, error));
    RT_TRY(check_range(m->name, "transmission", m->transmission, 0, 1, error));
    RT_TRY(check_range(m->name, "ior", m->ior, 1e-3f, 1e3f, error));
    RT_TRY(check_texture(m->name, &m->texture, error));
    *index = scene->material_count;
    RT_TRY(rt_append(&scene->materials, &scene->material_count, &scene->material_capacity, material,
                     sizeof *material, error));
    rt_texels_share(m->texture.texels);
    return RT_OK;
}

RtStatus rt_scene_share_material(RtScene *scene, const RtMaterial *material, uint32_t *index,
                                 RtError *error) {
    for (*index = 0; *index < scene->material_count; ++*index) {
        if (memcmp(&scene->materials[*index], material, sizeof *material) == 0) return RT_OK;
    }
    return rt_scene_add_material(scene, material, index, error);
}

RtStatus rt_scene_load_texels(const RtScene *scene, const char *path, RtTexels **texels, RtError *error) {
    char absolute[RT_MAX_PATH];
    const bool found = realpath(path, absolute);
    for (uint32_t i = 0; i < scene->material_count && found; i++) {
        *texels = scene->materials[i].texture.texels;
        if (!*texels || strcmp((*texels)->path, absolute) != 0) continue;
        rt_texels_share(*texels);
        return RT_OK;
    }
    *texels = NULL;
    return rt_texels_load(path, texels, error);
}

RtStatus rt_scene_add_light(RtScene *scene, RtVec3 position, RtVec3 intensity, RtError *error) {
    if (!rt_finite(position) || !rt_finite(intensity))
        return rt_fail(error, RT_BAD_INPUT, "a light's position or intensity is not finite");
    if (rt_maxf(fabsf(position.x), rt_maxf(fabsf(position.y), fabsf(position.z))) > RT_MAX_COORDINATE)
        return rt_fail(error, RT_BAD_INPUT, "a light is farther than %g from the origin: move it nearer",
                       (double)RT_MAX_COORDINATE);
    if (intensity.x < 0 || intensity.y < 0 || intensity.z < 0)
        return rt_fail(error, RT_BAD_INPUT, "a light's intensity is negative");
    const RtLight light = {position, intensity};
    return rt_append(&scene->lights, &scene->light_count, &scene->light_capacity, &light, sizeof light,
                     error);
}

/* Stores the material of the next object, before the object is added. */
static RtStatus reserve_material_of(RtScene *scene, uint32_t material, RtError *error) {
    assert(material < scene->material_count || material == RT_OWN_MATERIALS);
    RT_TRY(rt_reserve(&scene->material_of, &scene->material_of_capacity,
                      (uint64_t)scene->geometry.object_count + 1, sizeof(uint32_t), error));
    scene->material_of[scene->geometry.object_count] = material;
    return RT_OK;
}

RtStatus rt_scene_add_sphere(RtScene *scene, uint32_t material, RtVec3 center, float radius, RtError *error) {
    RT_TRY(reserve_material_of(scene, material, error));
    return rt_geometry_add_sphere(&scene->geometry, center, radius, error);
}

RtStatus rt_scene_add_polygon(RtScene *scene, uint32_t material, const RtVec3 *vertices, uint32_t count,
                              RtError *error) {
    RT_TRY(reserve_material_of(scene, material, error));
    return rt_geometry_add_polygon(&scene->geometry, vertices, count, error);
}

RtStatus rt_scene_add_triangle(RtScene *scene, uint32_t material, const RtVec3 vertices[3],
                               const RtVec3 *normals, RtError *error) {
    RT_TRY(reserve_material_of(scene, material, error));
    return rt_geometry_add_triangle(&scene->geometry, vertices, normals, error);
}

RtStatus rt_scene_add_cone(RtScene *scene, uint32_t material, RtVec3 base, float base_radius, RtVec3 apex,
                           float apex_radius, RtError *error) {
    RT_TRY(reserve_material_of(scene, material, error));
    return rt_geometry_add_cone(&scene->geometry, base, base_radius, apex, apex_radius, error);
}

RtStatus rt_scene_add_instance(RtScene *to, const RtScene *of, uint32_t part, const RtTransform *to_world,
                               uint32_t material, RtError *error) {
    RT_TRY(reserve_material_of(to, material, error));
    return rt_geometry_add_instance(&to->geometry, &of->parts[part]->geometry, part, to_world, error);
}

void rt_scene_place(const RtScene *scene, uint32_t id, const RtRay *ray, RtPlace *place) {
    *place = (RtPlace){.scene = scene, .object = id, .to_world = rt_transform_identity(), .ray = *ray};
    for (;;) {
        const RtGeometry *g = &place->scene->geometry;
        const uint32_t object = rt_geometry_holder(g, place->object);
        if (!rt_is_instance(g, object)) return;
        const RtInstance *instance = rt_instance_of(g, object);
        const uint32_t material = place->scene->material_of[object];
        if (!place->material && material != RT_OWN_MATERIALS) place->material = &scene->materials[material];
        rt_instance_enter(instance, &place->ray, &place->ray);
        place->to_world = rt_transform_compose(&instance->to_world, &place->to_world);
        place->object -= instance->first;
        place->scene = scene->parts[instance->part];
    }
}

RtStatus rt_scene_set_triangle_texture(RtScene *scene, const RtUv at[3], RtError *error) {
    const uint32_t material = scene->material_of[scene->geometry.object_count - 1];
    RtTriangleTexture texture = {.triangle = scene->geometry.triangle_count - 1};
    bool finite = true;
    memcpy(texture.at, at, sizeof texture.at);
    for (int i = 0; i < 3; i++) finite = finite && isfinite(at[i].u) && isfinite(at[i].v);
    if (scene->materials[material].texture.kind == RT_TEXTURE_NONE || !finite) return RT_OK;
    return rt_append(&scene->triangle_textures, &scene->triangle_texture_count,
                     &scene->triangle_texture_capacity, &texture, sizeof texture, error);
}

static int by_triangle(const void *a, const void *b) {
    const uint32_t first = ((const RtTriangleTexture *)a)->triangle,
                   second = ((const RtTriangleTexture *)b)->triangle;
    return (first > second) - (first < second);
}

const RtTriangleTexture *rt_scene_triangle_texture(const RtScene *scene, uint32_t index) {
    const RtTriangleTexture wanted = {.triangle = index};
    if (scene->triangle_texture_count == 0) return NULL;
    return bsearch(&wanted, scene->triangle_textures, scene->triangle_texture_count, sizeof wanted,
                   by_triangle);
}

/* The tree just added has the material of its first solid. */
static void set_csg_material(RtScene *scene) {
    const RtGeometry *g = &scene->geometry;
    const RtSolid *solids = g->forest.set.solids + g->csgs[g->csg_count - 1].first_solid;
    scene->material_of[g->object_count - 1] = solids[0].material;
}

RtStatus rt_scene_add_csg(RtScene *scene, const RtCsgBuilder *builder, RtCsgTerm root, bool extents,
                          RtError *error) {
    RT_TRY(reserve_material_of(scene, 0, error));
    RT_TRY(rt_geometry_add_csg(&scene->geometry, builder, root, extents, error));
    set_csg_material(scene);
    return RT_OK;
}

void rt_scene_paint_csg(RtScene *scene, uint32_t material) {
    const RtGeometry *g = &scene->geometry;
    const RtCsg *tree = &g->csgs[g->csg_count - 1];
    for (uint32_t i = 0; i < tree->solid_count; i++)
        g->forest.set.solids[tree->first_solid + i].material = material;
    set_csg_material(scene);
}

/* The nearest point that is a valid ray origin. */
static RtVec3 within_bounds(RtVec3d p) {
    RtVec3 q;
    for (int a = 0; a < 3; a++)
        q.at[a] = rt_maxf(-RT_MAX_COORDINATE, rt_minf((float)p.at[a], RT_MAX_COORDINATE));
    return q;
}

/* From the front, slightly right and above, at a distance where the bounding sphere fills the view. */
static void place_camera(RtCamera *camera, const RtBox *box) {
    RtVec3d center = {0, 0, 0};
    double radius = 1;
    if (!rt_box_is_empty(*box)) {
        center = rt_widen(rt_box_center(*box));
        radius = rt_lengthd(rt_subd(rt_widen(box->hi), center));
        /* A point has no size, but `from` and `at` must differ in float32. */
        radius = fmax(radius, fmax(1e-5 * rt_lengthd(center), 1e-30));
    }
    RtVec3d up = rt_normalized(rt_widen(camera->up));
    /* Two directions perpendicular to `up`. */
    RtVec3d side = fabs(up.x) < 0.5 ? rt_vec3d(1, 0, 0) : rt_vec3d(0, 1, 0);
    RtVec3d front = rt_normalized(rt_crossd(side, up));
    RtVec3d towards = rt_addd(rt_scaled(front, 1), rt_addd(rt_scaled(side, 0.4), rt_scaled(up, 0.3)));
    double distance = 1.05 * radius / rt_turn((double)camera->fov / 2).sine;
    camera->at = rt_narrow(center);
    camera->from = within_bounds(rt_add_scaledd(center, rt_normalized(towards), distance));
}

static void clear_materials(RtScene *scene) {
    for (uint32_t i = 0; i < scene->material_count; i++)
        rt_texels_release(scene->materials[i].texture.texels);
    rt_free(scene->materials);
    scene->materials = NULL;
    scene->material_count = scene->material_capacity = 0;
}

/* Computes the boxes. */
static RtStatus finish_objects(RtScene *scene, RtError *error) {
    rt_trim(&scene->material_of, scene->geometry.object_count, &scene->material_of_capacity,
            sizeof(uint32_t));
    if (scene->triangle_textures)
        rt_trim(&scene->triangle_textures, scene->triangle_texture_count, &scene->triangle_texture_capacity,
                sizeof(RtTriangleTexture));
    return rt_geometry_finish(&scene->geometry, error);
}

/* Moves the materials of a part to the scene. */
static RtStatus move_materials(RtScene *scene, RtScene *part, RtError *error) {
    RT_ARENA(memory);
    const RtGeometry *g = &part->geometry;
    uint32_t *moved = rt_arena_alloc(&memory, part->material_count, sizeof *moved);
    RT_TRY(rt_arena_check(&memory, "the materials of a part", error));
    for (uint32_t i = 0; i < part->material_count; i++)
        RT_TRY(rt_scene_share_material(scene, &part->materials[i], &moved[i], error));
    for (uint32_t i = 0; i < g->object_count; i++) {
        if (part->material_of[i] != RT_OWN_MATERIALS) part->material_of[i] = moved[part->material_of[i]];
    }
    for (uint32_t i = 0; i < g->forest.set.solid_count; i++)
        g->forest.set.solids[i].material = moved[g->forest.set.solids[i].material];
    clear_materials(part);
    return RT_OK;
}

RtStatus rt_scene_add_part(RtScene *scene, RtScene *part, RtError *error) {
    RtScene *kept = rt_alloc(1, sizeof *kept);
    RtStatus status = kept ? finish_objects(part, error) : rt_fail_memory(error, "a part", sizeof *kept);
    if (status == RT_OK) status = rt_geometry_measure_reach(&part->geometry, error);
    if (status == RT_OK) status = move_materials(scene, part, error);
    if (status == RT_OK)
        status =
            rt_append(&scene->parts, &scene->part_count, &scene->part_capacity, &kept, sizeof(void *), error);
    if (status == RT_OK) {
        *kept = *part;
        *part = (RtScene){0};
        return RT_OK;
    }
    rt_scene_clear(part);
    rt_free(kept);
    return status;
}

RtStatus rt_scene_finish(RtScene *scene, RtError *error) {
    RT_TRY(finish_objects(scene, error));
    RtCamera *camera = &scene->camera;
    const RtVec3 from = camera->from, at = camera->at;
    if (from.x == at.x && from.y == at.y && from.z == at.z) place_camera(camera, &scene->geometry.box);
    if (scene->light_count == 0) {
        RtVec3d above = rt_scaled(rt_widen(camera->up),
                                  0.5 * rt_lengthd(rt_subd(rt_widen(camera->from), rt_widen(camera->at))));
        RtVec3 position = within_bounds(rt_addd(rt_widen(camera->from), above));
        RT_TRY(rt_scene_add_light(scene, position, rt_vec3(1, 1, 1), error));
    }
    return rt_scene_sample(scene, 0, 0, 1, false, error);
}

RtStatus rt_scene_sample(RtScene *scene, uint32_t width, uint32_t height, uint32_t samples, bool corners,
                         RtError *error) {
    return rt_sampling_init(&scene->sampling, width ? width : scene->camera.width,
                            height ? height : scene->camera.height, samples, corners, error);
}

/* ---- copies ---- */

typedef struct Append {
    RtScene *to;
    const RtScene *of; /* that owns the parts and materials */
    const RtScene *from;
    const RtTransform *transform; /* or NULL */
    double scale;                 /* the uniform scale, 0 if uneven */
    bool mirror;                  /* reverse the order of vertices */
    uint32_t painted;             /* index in `to` of the material of all objects, or RT_OWN_MATERIALS */
    uint32_t *materials;          /* [of->material_count] index in `to` */
    RtVec3 *vertices;             /* [from->geometry.polygon_vertex_count] of a polygon that is moved */
    bool textures;                /* keep them */
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
    const RtTriangleTexture *texture = rt_scene_triangle_texture(a->from, index);
    RtVec3 vertices[3], normals[3];
    RtUv uv[3];
    for (int i = 0; i < 3; i++) {
        const int k = a->mirror ? 2 - i : i;
        vertices[k] = move_point(a, g->triangles[index].v[i]);
        if (texture) uv[k] = texture->at[i];
        if (entry == RT_NO_NORMALS) continue;
        RtVec3 n = g->vertex_normals[entry].n[i];
        normals[k] = a->transform ? rt_transform_normal(a->transform, n) : n;
    }
    RT_TRY(
        rt_scene_add_triangle(a->to, material, vertices, entry == RT_NO_NORMALS ? NULL : normals, a->error));
    return texture ? rt_scene_set_triangle_texture(a->to, uv, a->error) : RT_OK;
}

static RtStatus append_polygon(const Append *a, uint32_t material, const RtPolygon *polygon) {
    const uint32_t last = polygon->count - 1;
    for (uint32_t i = 0; i <= last; i++)
        a->vertices[a->mirror ? last - i : i] =
            move_point(a, a->from->geometry.polygon_vertices[polygon->first + i]);
    return rt_scene_add_polygon(a->to, material, a->vertices, polygon->count, a->error);
}

static RtStatus append_objects(Append a, const uint32_t *ids, uint32_t count);

static RtStatus append_csg(const Append *a, const RtCsg *tree) {
    RtCsgBuilder builder = {0};
    RtCsgTerm root = 0;
    if (a->mirror) return rt_fail(a->error, RT_BAD_INPUT, "a CSG tree has no mirrored copies");
    RtStatus status = rt_csg_recover(&builder, &a->from->geometry.forest, tree, &root, a->error);
    for (uint32_t i = 0; i < builder.set.solid_count && status == RT_OK; i++) {
        const uint32_t own = a->materials[builder.set.solids[i].material];
        builder.set.solids[i].material = a->painted == RT_OWN_MATERIALS ? own : a->painted;
    }
    if (status == RT_OK && a->transform) status = rt_csg_move(&builder, root, a->transform, &root, a->error);
    if (status == RT_OK) status = rt_scene_add_csg(a->to, &builder, root, tree->extents, a->error);
    rt_csg_builder_clear(&builder);
    return status;
}

static RtStatus append_instance(const Append *a, uint32_t painted, const RtInstance *instance) {
    const RtScene *part = a->of->parts[instance->part];
    RtTransform moved = instance->to_world;
    Append below = *a;
    if (a->transform) moved = rt_transform_compose(&moved, a->transform);
    below.from = part;
    below.transform = &moved;
    below.painted = painted;
    return append_objects(below, NULL, part->geometry.object_count);
}

static RtStatus append_object(const Append *a, uint32_t id) {
    const RtGeometry *g = &a->from->geometry;
    const uint32_t index = rt_ref_index(g->objects[id]), own = a->from->material_of[id];
    const bool paints = a->painted == RT_OWN_MATERIALS && own != RT_OWN_MATERIALS;
    const uint32_t material = paints ? a->materials[own] : a->painted;
    switch (rt_ref_shape(g->objects[id])) {
    case RT_SHAPE_SPHERE: return append_sphere(a, material, &g->spheres[index]);
    case RT_SHAPE_POLYGON: return append_polygon(a, material, &g->polygons[index]);
    case RT_SHAPE_TRIANGLE: return append_triangle(a, material, index);
    case RT_SHAPE_CONE: return append_cone(a, material, &g->cones[index]);
    case RT_SHAPE_CSG: return append_csg(a, &g->csgs[index]);
    case RT_SHAPE_INSTANCE: return append_instance(a, material, &g->instances[index]);
    case RT_SHAPE_COUNT: break;
    }
    return RT_OK;
}

static RtStatus append_materials(const Append *a) {
    for (uint32_t i = 0; i < a->of->material_count; i++) {
        RtMaterial material = a->of->materials[i];
        if (!a->textures) material.texture = (RtTexture){0};
        RT_TRY(rt_scene_share_material(a->to, &material, &a->materials[i], a->error));
    }
    return RT_OK;
}

/* The objects ids[0..count), or with NULL the first `count`. */
static RtStatus append_objects(Append a, const uint32_t *ids, uint32_t count) {
    RT_ARENA(memory);
    const RtGeometry *g = &a.from->geometry;
    a.scale = a.transform ? rt_transform_uniform_scale(a.transform) : 1;
    a.mirror = a.transform && rt_transform_mirrors(a.transform);
    a.vertices = rt_arena_alloc(&memory, g->polygon_vertex_count, sizeof(RtVec3));
    RT_TRY(rt_arena_check(&memory, "appending a scene", a.error));
    for (uint32_t i = 0; i < count; i++) RT_TRY(append_object(&a, ids ? ids[i] : i));
    return RT_OK;
}

/* With NULL, textures too. */
static RtStatus append(RtScene *to, const RtScene *from, const uint32_t *ids, uint32_t count,
                       const RtTransform *transform, RtError *error) {
    RT_ARENA(memory);
    const Append a = {.to = to,
                      .of = from,
                      .from = from,
                      .transform = transform,
                      .painted = RT_OWN_MATERIALS,
                      .materials = rt_arena_alloc(&memory, from->material_count, sizeof(uint32_t)),
                      .textures = !ids,
                      .error = error};
    RT_TRY(rt_arena_check(&memory, "appending a scene", error));
    RT_TRY(append_materials(&a));
    return append_objects(a, ids, count);
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

RtStatus rt_scene_flatten(const RtScene *from, RtScene *to, RtError *error) {
    return rt_scene_subset(from, NULL, from->geometry.object_count, to, error);
}

/* ---- the fingerprint ---- */

/* The bytes of these are hashed, so they have no padding. */
_Static_assert(sizeof(RtSphere) == 4 * sizeof(float), "a sphere has no padding");
_Static_assert(sizeof(RtCone) == 8 * sizeof(float) + 8 * sizeof(double), "a cone has no padding");
_Static_assert(sizeof(RtMaterial) == RT_MAX_NAME + 10 * sizeof(float) + sizeof(RtTexture) &&
                   sizeof(RtTexture) == sizeof(RtTexels *) + 8 * sizeof(float),
               "a material has no padding");
_Static_assert(sizeof(RtTriangleTexture) == 7 * sizeof(float), "texture coordinates have no padding");
_Static_assert(sizeof(RtLight) == 6 * sizeof(float), "a light has no padding");
_Static_assert(sizeof(RtCamera) == 11 * sizeof(float) + 2 * sizeof(uint32_t), "a camera has no padding");

_Static_assert(sizeof(RtPlane) == 4 * sizeof(double), "a plane has no padding");
_Static_assert(sizeof(RtTransform) == 12 * sizeof(double), "a transform has no padding");

#define ADD(array, count) XXH3_64bits_update(state, array, (size_t)(count) * sizeof *(array))

/* Solids and operations only: boxes follow from them, and box tests change no answer. */
static void add_forest(XXH3_state_t *state, const RtCsgForest *forest) {
    const RtSolidSet *set = &forest->set;
    for (uint32_t i = 0; i < set->solid_count; i++) {
        const RtSolid *s = &set->solids[i];
        const uint32_t numbers[4] = {(uint32_t)s->kind, s->material, s->subtracted, s->count};
        ADD(numbers, 4);
        ADD(&s->ratio, 1);
        ADD(&s->to_world, 1);
    }
    ADD(set->planes, set->plane_count);
    ADD(set->triangles, set->triangle_count);
    for (uint32_t i = 0; i < forest->instruction_count; i++) {
        RtCsgInstruction instruction = forest->instructions[i];
        if (instruction.code != RT_CSG_PUSH && instruction.code != RT_CSG_APPLY) continue;
        const uint32_t numbers[3] = {instruction.code, instruction.reversed, instruction.operand};
        ADD(numbers, 3);
    }
}

/* Nothing, for a material without one. */
static void add_texture(XXH3_state_t *state, const RtTexture *texture) {
    const RtTexels *texels = texture->texels;
    if (texture->kind == RT_TEXTURE_NONE) return;
    XXH3_64bits_update(state, &texture->kind, sizeof *texture - offsetof(RtTexture, kind));
    if (!texels) return;
    const uint32_t sides[2] = {texels->width, texels->height};
    ADD(sides, 2);
    ADD(texels->rgb, 3 * (size_t)texels->width * texels->height);
}

static void add_objects(XXH3_state_t *state, const RtScene *scene) {
    const RtGeometry *g = &scene->geometry;
    ADD(g->objects, g->object_count);
    ADD(scene->material_of, g->object_count);
    ADD(g->spheres, g->sphere_count);
    ADD(g->triangles, g->triangle_count);
    ADD(g->polygon_vertices, g->polygon_vertex_count);
    for (uint32_t i = 0; i < g->polygon_count; i++) ADD(&g->polygons[i].count, 1);
    ADD(g->cones, g->cone_count);
    if (g->csg_count) add_forest(state, &g->forest);
    ADD(g->vertex_normals, g->vertex_normal_count);
    /* Which triangles they belong to, unless all have some. */
    bool some = g->vertex_normal_count > 0 && g->vertex_normal_count < g->triangle_count;
    if (some) ADD(g->triangle_normals, g->triangle_count);
    ADD(scene->triangle_textures, scene->triangle_texture_count);
    for (uint32_t i = 0; i < g->instance_count; i++) {
        ADD(&g->instances[i].to_world, 1);
        ADD(&g->instances[i].part, 1);
    }
}

uint64_t rt_scene_fingerprint(const RtScene *scene) {
    XXH3_state_t whole, *state = &whole;
    XXH3_64bits_reset(state);
    add_objects(state, scene);
    for (uint32_t i = 0; i < scene->part_count; i++) add_objects(state, scene->parts[i]);
    for (uint32_t i = 0; i < scene->material_count; i++) { /* all but the name */
        XXH3_64bits_update(state, &scene->materials[i].color,
                           offsetof(RtMaterial, texture) - offsetof(RtMaterial, color));
        add_texture(state, &scene->materials[i].texture);
    }
    ADD(scene->lights, scene->light_count);
    ADD(&scene->ambient, 1);
    ADD(&scene->background, 1);
    ADD(&scene->camera, 1);
    return XXH3_64bits_digest(state);
}
#undef ADD

uint64_t rt_scene_bytes(const RtScene *scene) {
    uint64_t below = 0;
    for (uint32_t i = 0; i < scene->part_count; i++) below += rt_scene_bytes(scene->parts[i]);
    for (uint32_t i = 0; i < scene->material_count; i++) {
        const RtTexels *image = scene->materials[i].texture.texels;
        if (image) below += 3 * (uint64_t)image->width * image->height;
    }
    return below + (uint64_t)scene->triangle_texture_capacity * sizeof(RtTriangleTexture) +
           rt_geometry_bytes(&scene->geometry) + (uint64_t)scene->material_of_capacity * sizeof(uint32_t) +
           (uint64_t)scene->material_capacity * sizeof(RtMaterial) +
           (uint64_t)scene->light_capacity * sizeof(RtLight);
}

void rt_scene_clear(RtScene *scene) {
    rt_geometry_clear(&scene->geometry);
    clear_materials(scene);
    for (uint32_t i = 0; i < scene->part_count; i++) {
        rt_scene_clear(scene->parts[i]);
        rt_free(scene->parts[i]);
    }
    rt_free(scene->parts);
    rt_free(scene->material_of);
    rt_free(scene->triangle_textures);
    rt_free(scene->lights);
    rt_warnings_clear(&scene->warnings);
    *scene = (RtScene){0};
}
