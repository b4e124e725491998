/* From a file that fits the schema (base/yaml_file.h, yaml_schema.h) to a scene. */
#include "base/memory.h"
#include "scene/append.h"
#include "scene/mesh.h"
#include "scene/yaml.h"
#include "scene/yaml_reader.h"

#include <stdlib.h>
#include <string.h>

RtStatus rt_yaml_place(const RtYamlReader *r, RtStatus status, const char *list, uint32_t i,
                       const char *below) {
    if (status == RT_OK) return RT_OK;
    char where[128];
    snprintf(where, sizeof where, "%s[%u]%s", list, i, below);
    return rt_yaml_file_place(r->file, status, where, r->error);
}

/* ---- names ---- */

static int by_name(const void *a, const void *b) {
    return strcmp(((const RtYamlNamed *)a)->name, ((const RtYamlNamed *)b)->name);
}

RtStatus rt_yaml_sort_names(const RtYamlReader *r, RtYamlNamed *names, uint32_t count, const char *what,
                            const char *list) {
    qsort(names, count, sizeof *names, by_name);
    for (uint32_t i = 1; i < count; i++) {
        if (strcmp(names[i - 1].name, names[i].name) != 0) continue;
        uint32_t a = names[i - 1].index, b = names[i].index;
        RtStatus status =
            rt_fail(r->error, RT_BAD_INPUT, "there are two %s '%s': rename one", what, names[i].name);
        return rt_yaml_place(r, status, list, a > b ? a : b, ".name");
    }
    return RT_OK;
}

const RtYamlNamed *rt_yaml_find_name(const RtYamlNamed *names, uint32_t count, const char *name) {
    RtYamlNamed wanted = {name, 0};
    return bsearch(&wanted, names, count, sizeof *names, by_name);
}

/* ---- materials ---- */

/* The scene is empty before: entry i becomes material i. */
static RtStatus add_materials(RtYamlReader *r) {
    uint32_t count = r->yaml->materials_count;
    for (uint32_t i = 0; i < count; i++) {
        const RtYamlMaterial *given = &r->yaml->materials[i];
        RtMaterial material = rt_default_material();
        memcpy(material.name, given->name, sizeof material.name);
        if (given->color) material.color = *given->color;
#define SET(name)                                                                                            \
    if (given->name) material.name = *given->name;
        RT_YAML_COEFFICIENTS(SET)
#undef SET
        r->materials[i].name = given->name;
        RtStatus status = rt_scene_add_material(r->scene, &material, &r->materials[i].index, r->error);
        RT_TRY(rt_yaml_place(r, status, "materials", i, ""));
    }
    return rt_yaml_sort_names(r, r->materials, count, "materials", "materials");
}

RtStatus rt_yaml_find_material(RtYamlReader *r, const char *name, uint32_t *index) {
    rt_yaml_at(r, "material");
    const RtYamlNamed *found =
        rt_yaml_find_name(r->materials, r->yaml->materials_count, name[0] ? name : "default");
    if (found) {
        *index = found->index;
        return RT_OK;
    }
    if (name[0]) {
        return rt_fail(r->error, RT_BAD_INPUT, "there is no material '%s': add it to the list of materials",
                       name);
    }
    if (r->standard == UINT32_MAX) {
        RtMaterial material = rt_default_material();
        RT_TRY(rt_scene_add_material(r->scene, &material, &r->standard, r->error));
    }
    *index = r->standard;
    return RT_OK;
}

/* ---- transforms ---- */

static RtStatus add_step(RtTransform *transform, const RtYamlStep *step, RtError *error) {
    int given = !!step->scale + !!step->stretch + !!step->rotate + !!step->translate;
    if (given != 1) {
        return rt_fail(error, RT_BAD_INPUT,
                       "a step is one of scale, stretch, rotate, translate, this one has %d of them: write "
                       "one step an entry, in the order in which they are to happen",
                       given);
    }
    if (step->scale) {
        return rt_transform_scale(transform, rt_vec3(*step->scale, *step->scale, *step->scale), error);
    }
    if (step->stretch) return rt_transform_scale(transform, *step->stretch, error);
    if (step->translate) return rt_transform_translate(transform, *step->translate, error);
    return rt_transform_rotate(transform, step->rotate->axis, (double)step->rotate->degrees, error);
}

RtStatus rt_yaml_make_transform(RtYamlReader *r, const RtYamlStep *steps, uint32_t count,
                                RtTransform *transform) {
    *transform = rt_transform_identity();
    for (uint32_t i = 0; i < count; i++) {
        snprintf(r->at, sizeof r->at, ".transform[%u]", i);
        RT_TRY(add_step(transform, &steps[i], r->error));
    }
    return RT_OK;
}

/* ---- objects: one adder a kind, called add_KIND ---- */

static RtStatus add_sphere(RtYamlReader *r, const RtYamlSphere *sphere) {
    uint32_t material;
    RT_TRY(rt_yaml_find_material(r, sphere->material, &material));
    rt_yaml_at(r, sphere->radius > 0 ? "center" : "radius");
    return rt_scene_add_sphere(r->scene, material, sphere->center, sphere->radius, r->error);
}

static RtStatus add_polygon(RtYamlReader *r, const RtYamlPolygon *polygon) {
    uint32_t material;
    RT_TRY(rt_yaml_find_material(r, polygon->material, &material));
    rt_yaml_at(r, "vertices");
    return rt_scene_add_polygon(r->scene, material, polygon->vertices, polygon->vertices_count, r->error);
}

static RtStatus add_triangle(RtYamlReader *r, const RtYamlTriangle *triangle) {
    uint32_t material;
    RT_TRY(rt_yaml_find_material(r, triangle->material, &material));
    r->at[0] = '\0';
    return rt_scene_add_triangle(r->scene, material, triangle->vertices, triangle->normals, r->error);
}

static RtStatus add_cone(RtYamlReader *r, const RtYamlCone *cone) {
    uint32_t material;
    RT_TRY(rt_yaml_find_material(r, cone->material, &material));
    r->at[0] = '\0';
    return rt_scene_add_cone(r->scene, material, cone->base, cone->base_radius, cone->apex, cone->apex_radius,
                             r->error);
}

static RtStatus add_cylinder(RtYamlReader *r, const RtYamlCylinder *cylinder) {
    uint32_t material;
    RT_TRY(rt_yaml_find_material(r, cylinder->material, &material));
    r->at[0] = '\0';
    return rt_scene_add_cone(r->scene, material, cylinder->base, cylinder->radius, cylinder->apex,
                             cylinder->radius, r->error);
}

RtStatus rt_yaml_path(const RtYamlReader *r, const char *name, char path[RT_MAX_PATH]) {
    char folder[RT_MAX_PATH];
    rt_path_folder(r->file->path, folder);
    return rt_path_join(folder, name, path, r->error);
}

static RtStatus add_mesh(RtYamlReader *r, const RtYamlMesh *mesh) {
    uint32_t material;
    RtTransform transform;
    RT_TRY(rt_yaml_find_material(r, mesh->material, &material));
    RT_TRY(rt_yaml_make_transform(r, mesh->transform, mesh->transform_count, &transform));
    rt_yaml_at(r, "path");
    char path[RT_MAX_PATH];
    RT_TRY(rt_yaml_path(r, mesh->path, path));
    return rt_mesh_append(r->scene, path, material, mesh->transform_count ? &transform : NULL, r->error);
}

static RtStatus add_csg(RtYamlReader *r, const RtYamlCsg *csg) {
    return rt_yaml_add_csg(r, csg);
}

static RtStatus add_builtin(RtYamlReader *r, const RtYamlBuiltin *builtin) {
    RtTransform transform;
    RT_TRY(rt_yaml_make_transform(r, builtin->transform, builtin->transform_count, &transform));
    rt_yaml_at(r, "name");
    RtScene scene;
    RT_TRY(r->open_named(builtin->name, &scene, r->error));
    rt_yaml_at(r, "transform");
    RtStatus status =
        rt_scene_append(r->scene, &scene, builtin->transform_count ? &transform : NULL, r->error);
    rt_scene_clear(&scene);
    return status;
}

static RtStatus add_object(RtYamlReader *r, uint32_t i) {
    const RtYamlObject *object = &r->yaml->objects[i];
    const char *kind = NULL;
    int given = 0;
#define COUNT(name, Type)                                                                                    \
    if (object->name) {                                                                                      \
        kind = #name;                                                                                        \
        given++;                                                                                             \
    }
    RT_YAML_OBJECTS(COUNT)
#undef COUNT
    RtStatus status = RT_OK;
    if (given != 1) {
#define LIST(name, Type) " " #name
        status = rt_fail(r->error, RT_BAD_INPUT,
                         "an object is one of:" RT_YAML_OBJECTS(LIST) "; this entry has %d of them: write "
                                                                      "one an entry",
                         given);
#undef LIST
        return rt_yaml_place(r, status, "objects", i, "");
    }
#define ADD(name, Type)                                                                                      \
    if (object->name) status = add_##name(r, object->name);
    RT_YAML_OBJECTS(ADD)
#undef ADD
    char below[sizeof r->at + 16];
    snprintf(below, sizeof below, ".%s%s", kind, r->at);
    return rt_yaml_place(r, status, "objects", i, below);
}

/* ---- camera, light ---- */

static bool is_far(RtVec3 p) {
    return rt_maxf(fabsf(p.x), rt_maxf(fabsf(p.y), fabsf(p.z))) > RT_MAX_COORDINATE;
}

/* Tries the camera as rendering will; where it is to be placed later, with a line of sight across `up`. */
static RtStatus check_camera(const RtCamera *camera, bool placed, const char **key, RtError *error) {
    *key = "camera.size";
    RtSampling sampling;
    RT_TRY(rt_sampling_init(&sampling, camera->width, camera->height, 1, false, error));
    *key = is_far(camera->from) ? "camera.from" : "camera.at";
    if (is_far(camera->from) || is_far(camera->at)) {
        return rt_fail(error, RT_BAD_INPUT, "the camera is beyond %g: bring it nearer",
                       (double)RT_MAX_COORDINATE);
    }
    RtCamera tried = *camera;
    if (!placed) tried.at.at[(rt_major_axis(camera->up) + 1) % 3] = 1;
    RtVec3 gap = rt_sub(tried.at, tried.from);
    *key = !(camera->fov > 0 && camera->fov < 180) ? "camera.fov"
           : !(camera->near >= 0)                  ? "camera.near"
           : rt_dot(gap, gap) > 0                  ? "camera.up"
                                                   : "camera.at";
    RtView view;
    return rt_view_init(&view, &tried, sampling, error);
}

static RtStatus set_camera(RtYamlReader *r, const RtYamlCamera *given) {
    RtCamera *camera = &r->scene->camera;
    if (!given->from != !given->at) {
        RtStatus status = rt_fail(r->error, RT_BAD_INPUT,
                                  "`from` and `at` belong together: give both, or neither for a camera that "
                                  "sees the whole scene");
        return rt_yaml_file_place(r->file, status, "camera", r->error);
    }
    if (given->from) camera->from = *given->from;
    if (given->at) camera->at = *given->at;
    if (given->up) camera->up = *given->up;
    if (given->fov) camera->fov = *given->fov;
    if (given->near) camera->near = *given->near;
    if (given->size) {
        camera->width = given->size[0];
        camera->height = given->size[1];
    }
    const char *key;
    RtStatus status = check_camera(camera, given->from != NULL, &key, r->error);
    return rt_yaml_file_place(r->file, status, key, r->error);
}

static RtStatus set_color(RtYamlReader *r, const RtVec3 *given, const char *key, RtVec3 *color) {
    if (!given) return RT_OK;
    *color = *given;
    if (given->x >= 0 && given->y >= 0 && given->z >= 0) return RT_OK;
    RtStatus status = rt_fail(r->error, RT_BAD_INPUT, "a colour has no negative parts: [red, green, blue]");
    return rt_yaml_file_place(r->file, status, key, r->error);
}

static RtStatus add_lights(RtYamlReader *r) {
    for (uint32_t i = 0; i < r->yaml->lights_count; i++) {
        const RtYamlLight *light = &r->yaml->lights[i];
        RtVec3 intensity = light->intensity ? *light->intensity : rt_vec3(1, 1, 1);
        RtStatus status = rt_scene_add_light(r->scene, light->position, intensity, r->error);
        RT_TRY(rt_yaml_place(r, status, "lights", i, ""));
    }
    return RT_OK;
}

/* ---- the scene ---- */

static RtStatus build(RtYamlReader *r) {
    if (r->yaml->camera) RT_TRY(set_camera(r, r->yaml->camera));
    RT_TRY(set_color(r, r->yaml->background, "background", &r->scene->background));
    RT_TRY(set_color(r, r->yaml->ambient, "ambient", &r->scene->ambient));
    RT_TRY(add_lights(r));
    RT_TRY(add_materials(r));
    RT_TRY(rt_yaml_add_solids(r));
    for (uint32_t i = 0; i < r->yaml->objects_count; i++) RT_TRY(add_object(r, i));
    return RT_OK;
}

/* Closes the file. */
static RtStatus load(RtYamlFile *file, RtSceneOpener *open_named, RtScene *scene, RtError *error) {
    RtYamlReader r = {.file = file,
                      .yaml = file->data,
                      .open_named = open_named,
                      .scene = scene,
                      .standard = UINT32_MAX,
                      .error = error};
    uint32_t materials = r.yaml->materials_count, solids = r.yaml->solids_count;
    r.materials = rt_alloc(materials, sizeof *r.materials);
    r.solids = rt_alloc(solids, sizeof *r.solids);
    r.terms = rt_alloc(solids, sizeof *r.terms);
    RtStatus status = r.materials && r.solids && r.terms
                          ? build(&r)
                          : rt_fail_memory(error, "the names of materials and solids",
                                           (size_t)materials * sizeof *r.materials +
                                               (size_t)solids * (sizeof *r.solids + sizeof *r.terms));
    rt_csg_builder_clear(&r.builder);
    rt_free(r.materials);
    rt_free(r.solids);
    rt_free(r.terms);
    rt_yaml_file_close(file);
    return status;
}

RtStatus rt_yaml_load(const char *path, RtSceneOpener *open_named, RtScene *scene, RtError *error) {
    RtYamlFile file;
    RT_TRY(rt_yaml_file_open(&file, path, &rt_yaml_scene_schema, error));
    return load(&file, open_named, scene, error);
}

RtStatus rt_yaml_load_text(const char *name, const char *text, RtSceneOpener *open_named, RtScene *scene,
                           RtError *error) {
    RtYamlFile file;
    size_t length = strlen(text);
    char *copy = rt_alloc(length + 1, 1);
    if (!copy) return rt_fail_memory(error, name, length + 1);
    memcpy(copy, text, length + 1);
    RT_TRY(rt_yaml_file_take(&file, name, copy, length, &rt_yaml_scene_schema, error));
    return load(&file, open_named, scene, error);
}
