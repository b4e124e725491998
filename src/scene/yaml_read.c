/* From a file that fits the schema (base/yaml_file.h, yaml_schema.h) to a scene. What is wrong with the
 * values themselves is found by the functions that add them; here it gets its place: each adder leaves in
 * reader->at the key under which it was when it failed. */
#include "base/memory.h"
#include "scene/append.h"
#include "scene/mesh.h"
#include "scene/yaml.h"
#include "scene/yaml_schema.h"
#include "scenes/builtin.h"

#include <stdlib.h>
#include <string.h>

typedef struct NamedMaterial {
    const char *name;
    uint32_t index;
} NamedMaterial;

typedef struct Reader {
    const RtYamlFile *file;
    const RtYamlScene *yaml;
    RtScene *scene;
    NamedMaterial *names; /* [yaml->materials_count], sorted by name */
    uint32_t standard;    /* index of the default material; UINT32_MAX until an object wants it */
    char at[64];          /* ".radius", ".transform[2].scale": below the object, for messages */
    RtError *error;
} Reader;

static void set_at(Reader *r, const char *key) {
    snprintf(r->at, sizeof r->at, ".%s", key);
}

/* Gives a failure the place of entry `i` of `list`, or of what is below it. */
static RtStatus place(const Reader *r, RtStatus status, const char *list, uint32_t i, const char *below) {
    if (status == RT_OK) return RT_OK;
    char where[128];
    snprintf(where, sizeof where, "%s[%u]%s", list, i, below);
    return rt_yaml_file_place(r->file, status, where, r->error);
}

/* ---- materials ---- */

static int by_name(const void *a, const void *b) {
    return strcmp(((const NamedMaterial *)a)->name, ((const NamedMaterial *)b)->name);
}

static RtStatus add_materials(Reader *r) {
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
        r->names[i].name = given->name;
        RtStatus status = rt_scene_add_material(r->scene, &material, &r->names[i].index, r->error);
        RT_TRY(place(r, status, "materials", i, ""));
    }
    qsort(r->names, count, sizeof *r->names, by_name);
    for (uint32_t i = 1; i < count; i++) {
        if (strcmp(r->names[i - 1].name, r->names[i].name) != 0) continue;
        uint32_t a = r->names[i - 1].index, b = r->names[i].index;
        RtStatus status =
            rt_fail(r->error, RT_BAD_INPUT, "there are two materials '%s': rename one", r->names[i].name);
        return place(r, status, "materials", a > b ? a : b, ".name");
    }
    return RT_OK;
}

/* The material called `name`; "" is the default one, made when first wanted. */
static RtStatus find_material(Reader *r, const char *name, uint32_t *index) {
    set_at(r, "material");
    NamedMaterial wanted = {name[0] ? name : "default", 0};
    const NamedMaterial *found =
        bsearch(&wanted, r->names, r->yaml->materials_count, sizeof *r->names, by_name);
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

static RtStatus make_transform(Reader *r, const RtYamlStep *steps, uint32_t count, RtTransform *transform) {
    *transform = rt_transform_identity();
    for (uint32_t i = 0; i < count; i++) {
        snprintf(r->at, sizeof r->at, ".transform[%u]", i);
        RT_TRY(add_step(transform, &steps[i], r->error));
    }
    return RT_OK;
}

/* ---- objects: one adder a kind, called add_KIND ---- */

static RtStatus add_sphere(Reader *r, const RtYamlSphere *sphere) {
    uint32_t material;
    RT_TRY(find_material(r, sphere->material, &material));
    set_at(r, sphere->radius > 0 ? "center" : "radius");
    return rt_scene_add_sphere(r->scene, material, sphere->center, sphere->radius, r->error);
}

static RtStatus add_polygon(Reader *r, const RtYamlPolygon *polygon) {
    uint32_t material;
    RT_TRY(find_material(r, polygon->material, &material));
    set_at(r, "vertices");
    return rt_scene_add_polygon(r->scene, material, polygon->vertices, polygon->vertices_count, r->error);
}

static RtStatus add_triangle(Reader *r, const RtYamlTriangle *triangle) {
    uint32_t material;
    RT_TRY(find_material(r, triangle->material, &material));
    r->at[0] = '\0';
    return rt_scene_add_triangle(r->scene, material, triangle->vertices, triangle->normals, r->error);
}

static RtStatus add_cone(Reader *r, const RtYamlCone *cone) {
    uint32_t material;
    RT_TRY(find_material(r, cone->material, &material));
    r->at[0] = '\0';
    return rt_scene_add_cone(r->scene, material, cone->base, cone->base_radius, cone->apex, cone->apex_radius,
                             r->error);
}

static RtStatus add_cylinder(Reader *r, const RtYamlCylinder *cylinder) {
    uint32_t material;
    RT_TRY(find_material(r, cylinder->material, &material));
    r->at[0] = '\0';
    return rt_scene_add_cone(r->scene, material, cylinder->base, cylinder->radius, cylinder->apex,
                             cylinder->radius, r->error);
}

/* A relative path starts in the folder of the scene file. */
static RtStatus add_mesh(Reader *r, const RtYamlMesh *mesh) {
    uint32_t material;
    RtTransform transform;
    RT_TRY(find_material(r, mesh->material, &material));
    RT_TRY(make_transform(r, mesh->transform, mesh->transform_count, &transform));
    set_at(r, "path");
    char folder[RT_MAX_PATH], path[RT_MAX_PATH];
    rt_path_folder(r->file->path, folder);
    RT_TRY(rt_path_join(folder, mesh->path, path, r->error));
    return rt_mesh_append(r->scene, path, material, mesh->transform_count ? &transform : NULL, r->error);
}

static RtStatus add_builtin(Reader *r, const RtYamlBuiltin *builtin) {
    RtTransform transform;
    RT_TRY(make_transform(r, builtin->transform, builtin->transform_count, &transform));
    set_at(r, "name");
    RtScene scene;
    RT_TRY(rt_builtin_open(builtin->name, &scene, r->error));
    set_at(r, "transform");
    RtStatus status =
        rt_scene_append(r->scene, &scene, builtin->transform_count ? &transform : NULL, r->error);
    rt_scene_clear(&scene);
    return status;
}

static RtStatus add_object(Reader *r, uint32_t i) {
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
        return place(r, status, "objects", i, "");
    }
#define ADD(name, Type)                                                                                      \
    if (object->name) status = add_##name(r, object->name);
    RT_YAML_OBJECTS(ADD)
#undef ADD
    char below[sizeof r->at + 16];
    snprintf(below, sizeof below, ".%s%s", kind, r->at);
    return place(r, status, "objects", i, below);
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
           : !(camera->hither >= 0)                ? "camera.hither"
           : rt_dot(gap, gap) > 0                  ? "camera.up"
                                                   : "camera.at";
    RtView view;
    return rt_view_init(&view, &tried, sampling, error);
}

static RtStatus set_camera(Reader *r, const RtYamlCamera *given) {
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
    if (given->hither) camera->hither = *given->hither;
    if (given->size) {
        camera->width = given->size[0];
        camera->height = given->size[1];
    }
    const char *key;
    RtStatus status = check_camera(camera, given->from != NULL, &key, r->error);
    return rt_yaml_file_place(r->file, status, key, r->error);
}

static RtStatus set_color(Reader *r, const RtVec3 *given, const char *key, RtVec3 *color) {
    if (!given) return RT_OK;
    *color = *given;
    if (given->x >= 0 && given->y >= 0 && given->z >= 0) return RT_OK;
    RtStatus status = rt_fail(r->error, RT_BAD_INPUT, "a colour has no negative parts: [red, green, blue]");
    return rt_yaml_file_place(r->file, status, key, r->error);
}

static RtStatus add_lights(Reader *r) {
    for (uint32_t i = 0; i < r->yaml->lights_count; i++) {
        const RtYamlLight *light = &r->yaml->lights[i];
        RtVec3 intensity = light->intensity ? *light->intensity : rt_vec3(1, 1, 1);
        RtStatus status = rt_scene_add_light(r->scene, light->position, intensity, r->error);
        RT_TRY(place(r, status, "lights", i, ""));
    }
    return RT_OK;
}

/* ---- the scene ---- */

static RtStatus build(Reader *r) {
    if (r->yaml->camera) RT_TRY(set_camera(r, r->yaml->camera));
    RT_TRY(set_color(r, r->yaml->background, "background", &r->scene->background));
    RT_TRY(set_color(r, r->yaml->ambient, "ambient", &r->scene->ambient));
    RT_TRY(add_lights(r));
    RT_TRY(add_materials(r));
    for (uint32_t i = 0; i < r->yaml->objects_count; i++) RT_TRY(add_object(r, i));
    return RT_OK;
}

RtStatus rt_yaml_load(const char *path, RtScene *scene, RtError *error) {
    RtYamlFile file;
    RT_TRY(rt_yaml_file_open(&file, path, &rt_yaml_scene_schema, error));
    Reader r = {.file = &file, .yaml = file.data, .scene = scene, .standard = UINT32_MAX, .error = error};
    size_t count = r.yaml->materials_count;
    r.names = rt_alloc(count, sizeof *r.names);
    RtStatus status =
        r.names ? build(&r) : rt_fail_memory(error, "the names of materials", count * sizeof *r.names);
    rt_free(r.names);
    rt_yaml_file_close(&file);
    return status;
}
