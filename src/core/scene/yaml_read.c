/* SPDX-License-Identifier: Apache-2.0 */
/* From the nodes of a YAML file (core/text/yaml.h) to a scene. */
#include "core/base/memory.h"
#include "core/scene/append.h"
#include "core/scene/mesh.h"
#include "core/scene/yaml.h"
#include "core/scene/yaml_reader.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

/* ---- materials ---- */

#define OPTIONAL_KEY(key) #key "? "

static RtStatus add_material(RtYamlReader *r, const RtYamlNode *n) {
    RtMaterial material = rt_default_material();
    uint32_t index;
    RT_TRY(rt_yaml_copy(&r->yaml, n, "name", sizeof material.name, material.name));
    RT_TRY(rt_yaml_point(&r->yaml, n, "color", &material.color));
#define READ(name) RT_TRY(rt_yaml_float(&r->yaml, n, #name, &material.name));
    RT_YAML_COEFFICIENTS(READ)
#undef READ
    return rt_yaml_place(&r->yaml, rt_scene_add_material(r->scene, &material, &index, r->error), n, NULL);
}

static RtStatus add_materials(RtYamlReader *r, const RtYamlNode *list) {
    assert(r->scene->material_count == 0);
    RT_TRY(rt_yaml_read_names(r, list, "name color? " RT_YAML_COEFFICIENTS(OPTIONAL_KEY), RT_MAX_NAME - 1,
                              "materials", &r->materials));
    for (const RtYamlNode *n = rt_yaml_first(list); n != rt_yaml_end(list); n += n->size)
        RT_TRY(add_material(r, n));
    return RT_OK;
}

/* ---- objects: one adder a kind, called add_KIND ---- */

static RtStatus add_sphere(RtYamlReader *r, const RtYamlNode *n) {
    const RtYaml *y = &r->yaml;
    RtVec3 center = {0};
    float radius = 0;
    uint32_t material;
    RT_TRY(rt_yaml_keys(y, n, "center radius material?"));
    RT_TRY(rt_yaml_find_material(r, n, &material));
    RT_TRY(rt_yaml_point(y, n, "center", &center));
    RT_TRY(rt_yaml_float(y, n, "radius", &radius));
    return rt_yaml_place(y, rt_scene_add_sphere(r->scene, material, center, radius, r->error), n,
                         radius > 0 ? "center" : "radius");
}

static RtStatus add_polygon(RtYamlReader *r, const RtYamlNode *n) {
    float *vertices;
    uint32_t material, count;
    RT_TRY(rt_yaml_keys(&r->yaml, n, "vertices material?"));
    RT_TRY(rt_yaml_find_material(r, n, &material));
    RT_TRY(rt_yaml_rows(&r->yaml, n, "vertices", 3, 3, &vertices, &count));
    RtStatus status = rt_scene_add_polygon(r->scene, material, (const RtVec3 *)vertices, count, r->error);
    rt_free(vertices);
    return rt_yaml_place(&r->yaml, status, n, "vertices");
}

static RtStatus read_points(const RtYaml *y, const RtYamlNode *list, RtVec3 points[3]) {
    RT_TRY(rt_yaml_list(y, list, NULL, 3, 3, "lists of numbers, as in [1, 2, 3]"));
    for (const RtYamlNode *p = rt_yaml_first(list); p != rt_yaml_end(list); p += p->size)
        RT_TRY(rt_yaml_point(y, p, NULL, points++));
    return RT_OK;
}

static RtStatus add_triangle(RtYamlReader *r, const RtYamlNode *n) {
    const RtYaml *y = &r->yaml;
    RtVec3 v[3] = {{0}}, at_vertices[3] = {{0}};
    uint32_t material;
    RT_TRY(rt_yaml_keys(y, n, "vertices normals? material?"));
    RT_TRY(rt_yaml_find_material(r, n, &material));
    const RtYamlNode *normals = rt_yaml_get(y, n, "normals");
    RT_TRY(read_points(y, rt_yaml_get(y, n, "vertices"), v));
    RT_TRY(read_points(y, normals, at_vertices));
    RtStatus status = rt_scene_add_triangle(r->scene, material, v, normals ? at_vertices : NULL, r->error);
    return rt_yaml_place(y, status, n, NULL);
}

static RtStatus add_round(RtYamlReader *r, const RtYamlNode *n, bool cylinder) {
    RtCone c;
    uint32_t material;
    RT_TRY(rt_yaml_read_cone(&r->yaml, n, cylinder, &c));
    RT_TRY(rt_yaml_find_material(r, n, &material));
    RtStatus status =
        rt_scene_add_cone(r->scene, material, c.base, c.base_radius, c.apex, c.apex_radius, r->error);
    return rt_yaml_place(&r->yaml, status, n, NULL);
}

static RtStatus add_cone(RtYamlReader *r, const RtYamlNode *n) {
    return add_round(r, n, false);
}

static RtStatus add_cylinder(RtYamlReader *r, const RtYamlNode *n) {
    return add_round(r, n, true);
}

static RtStatus add_mesh(RtYamlReader *r, const RtYamlNode *n) {
    uint32_t material;
    RT_TRY(rt_yaml_keys(&r->yaml, n, "path material? transform?"));
    RT_TRY(rt_yaml_find_material(r, n, &material));
    return rt_yaml_append_mesh(r, n, material, r->scene);
}

static RtStatus add_csg(RtYamlReader *r, const RtYamlNode *n) {
    return rt_yaml_add_csg(r, n);
}

static RtStatus add_builtin(RtYamlReader *r, const RtYamlNode *n) {
    RtTransform transform;
    const RtTransform *given;
    const char *name = "";
    RtScene scene;
    RT_TRY(rt_yaml_keys(&r->yaml, n, "name transform?"));
    RT_TRY(rt_yaml_read_transform(r, n, &transform, &given));
    RT_TRY(rt_yaml_text(&r->yaml, n, "name", RT_MAX_SCENE_NAME - 1, &name));
    RT_TRY(rt_yaml_place(&r->yaml, r->open_named(name, &scene, r->error), n, "name"));
    RtStatus status = rt_scene_append(r->scene, &scene, given, r->error);
    rt_scene_clear(&scene);
    return rt_yaml_place(&r->yaml, status, n, "transform");
}

#define OBJECTS(X) X(sphere) X(polygon) X(triangle) X(cone) X(cylinder) X(csg) X(mesh) X(builtin)

static RtStatus add_object(RtYamlReader *r, const RtYamlNode *entry) {
    const RtYamlNode *n;
    RT_TRY(rt_yaml_keys(&r->yaml, entry, OBJECTS(RT_YAML_ONE_OF)));
#define ADD(kind)                                                                                            \
    if ((n = rt_yaml_get(&r->yaml, entry, #kind))) return add_##kind(r, n);
    OBJECTS(ADD)
#undef ADD
    return RT_OK;
}

/* ---- camera, light ---- */

static bool is_far(RtVec3 p) {
    return rt_maxf(fabsf(p.x), rt_maxf(fabsf(p.y), fabsf(p.z))) > RT_MAX_COORDINATE;
}

/* Checks the camera as rendering does. If it will be placed later, its line of sight is assumed
 * perpendicular to `up`. */
static RtStatus check_camera(const RtCamera *camera, bool placed, const char **key, RtError *error) {
    *key = "size";
    RtSampling sampling;
    RT_TRY(rt_sampling_init(&sampling, camera->width, camera->height, 1, false, error));
    *key = is_far(camera->from) ? "from" : "at";
    if (is_far(camera->from) || is_far(camera->at))
        return rt_fail(error, RT_BAD_INPUT, "the camera is farther than %g from the origin: move it nearer",
                       (double)RT_MAX_COORDINATE);
    RtCamera tried = *camera;
    if (!placed) tried.at.at[(rt_major_axis(camera->up) + 1) % 3] = 1;
    RtVec3 gap = rt_sub(tried.at, tried.from);
    *key = !(camera->fov > 0 && camera->fov < 180) ? "fov"
           : !(camera->near >= 0)                  ? "near"
           : rt_dot(gap, gap) > 0                  ? "up"
                                                   : "at";
    RtView view;
    return rt_view_init(&view, &tried, sampling, error);
}

static RtStatus set_camera(RtYamlReader *r, const RtYamlNode *n) {
    const RtYaml *y = &r->yaml;
    RtCamera *camera = &r->scene->camera;
    RT_TRY(rt_yaml_keys(y, n, "from? at? up? fov? near? size?"));
    bool placed = rt_yaml_get(y, n, "from");
    if (placed != !!rt_yaml_get(y, n, "at"))
        return rt_yaml_fail(y, n,
                            "`from` and `at` belong together: give both, or neither for a camera that sees "
                            "the whole scene");
    RT_TRY(rt_yaml_point(y, n, "from", &camera->from));
    RT_TRY(rt_yaml_point(y, n, "at", &camera->at));
    RT_TRY(rt_yaml_point(y, n, "up", &camera->up));
    RT_TRY(rt_yaml_float(y, n, "fov", &camera->fov));
    RT_TRY(rt_yaml_float(y, n, "near", &camera->near));
    RT_TRY(rt_yaml_list(y, n, "size", 2, 2, "numbers, as in [640, 480]"));
    const RtYamlNode *size = rt_yaml_get(y, n, "size");
    uint32_t *side = &camera->width;
    for (const RtYamlNode *s = rt_yaml_first(size); s != rt_yaml_end(size); s += s->size) {
        RT_TRY(rt_yaml_u32(y, s, NULL, 1, RT_MAX_IMAGE_SIDE, side));
        side = &camera->height;
    }
    const char *key;
    RtStatus status = check_camera(camera, placed, &key, r->error);
    return rt_yaml_place(y, status, n, key);
}

static RtStatus set_color(RtYamlReader *r, const RtYamlNode *scene, const char *key, RtVec3 *color) {
    RT_TRY(rt_yaml_point(&r->yaml, scene, key, color));
    if (color->x >= 0 && color->y >= 0 && color->z >= 0) return RT_OK;
    RtStatus status = rt_fail(r->error, RT_BAD_INPUT, "a colour must not be negative: [red, green, blue]");
    return rt_yaml_place(&r->yaml, status, scene, key);
}

static RtStatus add_lights(RtYamlReader *r, const RtYamlNode *list) {
    const RtYaml *y = &r->yaml;
    RT_TRY(rt_yaml_list(y, list, NULL, 0, UINT32_MAX, "lights"));
    for (const RtYamlNode *n = rt_yaml_first(list); n != rt_yaml_end(list); n += n->size) {
        RtVec3 position = {0}, intensity = rt_vec3(1, 1, 1);
        RT_TRY(rt_yaml_keys(y, n, "position intensity?"));
        RT_TRY(rt_yaml_point(y, n, "position", &position));
        RT_TRY(rt_yaml_point(y, n, "intensity", &intensity));
        RT_TRY(rt_yaml_place(y, rt_scene_add_light(r->scene, position, intensity, r->error), n, NULL));
    }
    return RT_OK;
}

/* ---- the scene ---- */

static RtStatus build(RtYamlReader *r) {
    const RtYaml *y = &r->yaml;
    const RtYamlNode *root = y->nodes;
    RT_TRY(rt_yaml_check_format(y));
    RT_TRY(rt_yaml_keys(y, root, "camera? background? ambient? lights? materials? solids? objects format?"));
    const RtYamlNode *camera = rt_yaml_get(y, root, "camera"), *objects = rt_yaml_get(y, root, "objects");
    if (camera) RT_TRY(set_camera(r, camera));
    RT_TRY(set_color(r, root, "background", &r->scene->background));
    RT_TRY(set_color(r, root, "ambient", &r->scene->ambient));
    RT_TRY(add_lights(r, rt_yaml_get(y, root, "lights")));
    RT_TRY(add_materials(r, rt_yaml_get(y, root, "materials")));
    RT_TRY(rt_yaml_add_solids(r, rt_yaml_get(y, root, "solids")));
    RT_TRY(rt_yaml_list(y, objects, NULL, 1, UINT32_MAX, "objects"));
    for (const RtYamlNode *n = rt_yaml_first(objects); n != rt_yaml_end(objects); n += n->size)
        RT_TRY(add_object(r, n));
    return RT_OK;
}

/* Builds the scene from the open file, and closes it. */
static RtStatus load(RtYamlReader *r) {
    RtStatus status = build(r);
    rt_csg_builder_clear(&r->builder);
    rt_free(r->materials.all);
    rt_free(r->solids.all);
    rt_free(r->terms);
    rt_yaml_close(&r->yaml);
    return status;
}

RtStatus rt_yaml_load(const char *path, RtSceneOpener *open_named, RtScene *scene, RtError *error) {
    RtYamlReader r = {.open_named = open_named, .scene = scene, .standard = UINT32_MAX, .error = error};
    RT_TRY(rt_yaml_open(&r.yaml, path, error));
    return load(&r);
}

RtStatus rt_yaml_load_text(const char *name, const char *text, RtSceneOpener *open_named, RtScene *scene,
                           RtError *error) {
    RtYamlReader r = {.open_named = open_named, .scene = scene, .standard = UINT32_MAX, .error = error};
    RT_TRY(rt_yaml_parse(&r.yaml, name, text, strlen(text), error));
    return load(&r);
}
