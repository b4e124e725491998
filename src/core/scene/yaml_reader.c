/* SPDX-License-Identifier: Apache-2.0 */
/* Elements that scenes have in several places: names, materials, transforms, cones, meshes. */
#include "core/scene/yaml_reader.h"

#include "core/base/memory.h"
#include "core/scene/mesh.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

/* ---- names ---- */

static int by_name(const void *a, const void *b) {
    return strcmp(((const RtYamlNamed *)a)->name, ((const RtYamlNamed *)b)->name);
}

RtStatus rt_yaml_read_names(RtYamlReader *r, const RtYamlNode *list, const char *keys, size_t most,
                            const char *what, RtYamlNames *names) {
    RT_TRY(rt_yaml_list(&r->yaml, list, NULL, 0, UINT32_MAX, what));
    uint32_t count = rt_yaml_count(list);
    RtYamlNamed *all = names->all = rt_alloc(count, sizeof *all);
    if (!all) return rt_fail_memory(r->error, what, count * sizeof *all);
    for (const RtYamlNode *n = rt_yaml_first(list); n != rt_yaml_end(list); n += n->size) {
        RtYamlNamed *named = &all[names->count];
        RT_TRY(rt_yaml_keys(&r->yaml, n, keys));
        RT_TRY(rt_yaml_text(&r->yaml, n, "name", most, &named->name));
        named->node = n;
        named->index = names->count++;
    }
    qsort(all, count, sizeof *all, by_name);
    for (uint32_t i = 1; i < count; i++) {
        if (strcmp(all[i - 1].name, all[i].name) != 0) continue;
        const RtYamlNamed *later = &all[all[i].index > all[i - 1].index ? i : i - 1];
        return rt_yaml_fail(&r->yaml, rt_yaml_get(&r->yaml, later->node, "name"),
                            "there are two %s '%s': rename one", what, later->name);
    }
    return RT_OK;
}

const RtYamlNamed *rt_yaml_find_name(const RtYamlNames *names, const char *name) {
    RtYamlNamed wanted = {.name = name};
    return bsearch(&wanted, names->all, names->count, sizeof wanted, by_name);
}

/* ---- what objects and solids share ---- */

RtStatus rt_yaml_find_material(RtYamlReader *r, const RtYamlNode *object, uint32_t *index) {
    const RtYamlNode *node = rt_yaml_get(&r->yaml, object, "material");
    const char *name = "default";
    RT_TRY(rt_yaml_text(&r->yaml, object, "material", RT_MAX_NAME - 1, &name));
    const RtYamlNamed *found = rt_yaml_find_name(&r->materials, name);
    if (node && !found)
        return rt_yaml_fail(&r->yaml, node, "there is no material '%s': add it to the list of materials",
                            name);
    if (!found && r->standard == UINT32_MAX) {
        RtMaterial material = rt_default_material();
        RT_TRY(rt_scene_add_material(r->scene, &material, &r->standard, r->error));
    }
    *index = found ? found->index : r->standard;
    return RT_OK;
}

static RtStatus add_rotation(RtYamlReader *r, const RtYamlNode *n, RtTransform *transform) {
    RtVec3 axis = {0};
    float degrees = 0;
    RT_TRY(rt_yaml_keys(&r->yaml, n, "axis degrees"));
    RT_TRY(rt_yaml_point(&r->yaml, n, "axis", &axis));
    RT_TRY(rt_yaml_float(&r->yaml, n, "degrees", &degrees));
    RtStatus status = rt_transform_rotate(transform, axis, (double)degrees, r->error);
    return rt_yaml_place(&r->yaml, status, n, NULL);
}

static RtStatus add_step(RtYamlReader *r, const RtYamlNode *step, RtTransform *transform) {
    const RtYaml *y = &r->yaml;
    float scale = 1;
    RtVec3 stretch, move = {0};
    RT_TRY(rt_yaml_keys(y, step, "scale| stretch| rotate| translate|"));
    const RtYamlNode *rotate = rt_yaml_get(y, step, "rotate");
    if (rotate) return add_rotation(r, rotate, transform);
    RT_TRY(rt_yaml_float(y, step, "scale", &scale));
    stretch = rt_vec3(scale, scale, scale);
    RT_TRY(rt_yaml_point(y, step, "stretch", &stretch));
    RT_TRY(rt_yaml_point(y, step, "translate", &move));
    RtStatus status = rt_yaml_get(y, step, "translate") ? rt_transform_translate(transform, move, r->error)
                                                        : rt_transform_scale(transform, stretch, r->error);
    return rt_yaml_place(y, status, step, NULL);
}

RtStatus rt_yaml_read_transform(RtYamlReader *r, const RtYamlNode *object, RtTransform *transform,
                                const RtTransform **given) {
    const RtYamlNode *steps = rt_yaml_get(&r->yaml, object, "transform");
    *transform = rt_transform_identity();
    RT_TRY(rt_yaml_list(&r->yaml, steps, NULL, 0, UINT32_MAX, "steps"));
    for (const RtYamlNode *n = rt_yaml_first(steps); n != rt_yaml_end(steps); n += n->size)
        RT_TRY(add_step(r, n, transform));
    *given = rt_yaml_count(steps) ? transform : NULL;
    return RT_OK;
}

RtStatus rt_yaml_read_cone(const RtYaml *y, const RtYamlNode *n, bool cylinder, RtCone *cone) {
    *cone = (RtCone){0};
    RT_TRY(rt_yaml_keys(
        y, n, cylinder ? "base apex radius material?" : "base base_radius apex apex_radius material?"));
    RT_TRY(rt_yaml_point(y, n, "base", &cone->base));
    RT_TRY(rt_yaml_point(y, n, "apex", &cone->apex));
    RT_TRY(rt_yaml_float(y, n, cylinder ? "radius" : "base_radius", &cone->base_radius));
    return rt_yaml_float(y, n, cylinder ? "radius" : "apex_radius", &cone->apex_radius);
}

RtStatus rt_yaml_append_mesh(RtYamlReader *r, const RtYamlNode *object, uint32_t material, RtScene *scene) {
    RtTransform transform;
    const RtTransform *given;
    char folder[RT_MAX_PATH], path[RT_MAX_PATH];
    const char *name = "";
    RT_TRY(rt_yaml_read_transform(r, object, &transform, &given));
    RT_TRY(rt_yaml_text(&r->yaml, object, "path", RT_MAX_PATH - 1, &name));
    rt_path_folder(r->yaml.path, folder);
    RtStatus status = rt_path_join(folder, name, path, r->error);
    if (status == RT_OK) status = rt_mesh_append(scene, path, material, given, r->error);
    return rt_yaml_place(&r->yaml, status, object, "path");
}
