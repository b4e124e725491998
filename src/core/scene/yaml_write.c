/* SPDX-License-Identifier: Apache-2.0 */
/* Writing a scene as YAML. Numbers have as many significant digits as restore the float32 bit for bit: 9
 * always suffice, 6 often. The solids of parts come before those of the scene. */
#include "core/base/versions.h"
#include "core/scene/formula.h"
#include "core/scene/load.h"
#include "core/text/yaml.h"

#include <stdlib.h>
#include <string.h>

typedef struct Writer {
    const RtScene *whole, *scene; /* `scene`: the whole, or one of its parts */
    FILE *out;
    bool numbered;       /* material names are not usable: m0, m1 ... */
    bool parts_numbered; /* those of parts: p0, p1 ... */
    uint32_t solids;     /* of the scenes before */
} Writer;

/* ---- values ---- */

/* Writes the fewest digits that restore the value, as a float32 or a double. */
static void number(Writer *w, double value, bool wide) {
    char text[32];
    for (int digits = wide ? 15 : 6; digits <= (wide ? 17 : 9); digits++) {
        snprintf(text, sizeof text, "%.*g", digits, value);
        if ((wide ? strtod(text, NULL) : (double)strtof(text, NULL)) == value) break;
    }
    fputs(text, w->out);
}

/* A list of float32 or, if `wide`, double values. */
static void numbers(Writer *w, const void *values, int count, bool wide) {
    for (int i = 0; i < count; i++) {
        fputs(i ? ", " : "[", w->out);
        number(w, wide ? ((const double *)values)[i] : (double)((const float *)values)[i], wide);
    }
    fputc(']', w->out);
}

/* A list of lists of `width` values each. */
static void rows(Writer *w, const void *values, uint32_t count, int width, bool wide) {
    size_t bytes = (size_t)width * (wide ? sizeof(double) : sizeof(float));
    for (uint32_t i = 0; i < count; i++) {
        fputs(i ? ", " : "[", w->out);
        numbers(w, (const char *)values + i * bytes, width, wide);
    }
    fputc(']', w->out);
}

/* Keys include the text around them: "{center: ", ", radius: ". */

static void number_key(Writer *w, const char *key, float value) {
    fputs(key, w->out);
    number(w, (double)value, false);
}

static void point_key(Writer *w, const char *key, RtVec3 p) {
    fputs(key, w->out);
    numbers(w, p.at, 3, false);
}

static void points_key(Writer *w, const char *key, const RtVec3 *p, uint32_t count) {
    fputs(key, w->out);
    rows(w, p, count, 3, false);
}

/* Writes to out[0..2 * strlen(name) + 3). Inside single quotes only quotes need escaping. */
static void quote(const char *name, char *out) {
    *out++ = '\'';
    for (; *name; name++) {
        if (*name == '\'') *out++ = '\'';
        *out++ = *name;
    }
    strcpy(out, "'");
}

/* Writes the name, or if they are numbered, a letter and the index. */
static void name_key(Writer *w, const char *key, const char *name, bool numbered, char letter,
                     uint32_t index) {
    char text[2 * RT_MAX_NAME + 2];
    if (numbered)
        snprintf(text, sizeof text, "'%c%u'", letter, index);
    else
        quote(name, text);
    fprintf(w->out, "%s%s", key, text);
}

static void material_name(Writer *w, const char *key, uint32_t index) {
    name_key(w, key, w->whole->materials[index].name, w->numbered, 'm', index);
}

static void part_name(Writer *w, const char *key, uint32_t index) {
    name_key(w, key, w->whole->parts[index]->name, w->parts_numbered, 'p', index);
}

/* ---- camera, lights, materials ---- */

static void write_camera(Writer *w, const RtCamera *camera) {
    point_key(w, "camera: {from: ", camera->from);
    point_key(w, ", at: ", camera->at);
    point_key(w, ", up: ", camera->up);
    number_key(w, ", fov: ", camera->fov);
    number_key(w, ", near: ", camera->near);
    fprintf(w->out, ", size: [%u, %u]}\n", camera->width, camera->height);
}

static void write_lights(Writer *w) {
    fputs(w->scene->light_count ? "lights:\n" : "lights: []\n", w->out);
    for (uint32_t i = 0; i < w->scene->light_count; i++) {
        point_key(w, "- {position: ", w->scene->lights[i].position);
        point_key(w, ", intensity: ", w->scene->lights[i].intensity);
        fputs("}\n", w->out);
    }
}

static void write_texture(Writer *w, const RtTexture *texture) {
    char path[2 * RT_MAX_PATH + 2];
    if (texture->kind == RT_TEXTURE_NONE) return;
    if (texture->texels) {
        quote(texture->texels->path, path);
        fprintf(w->out, ", texture: {image: %s", path);
        number_key(w, ", size: ", texture->size);
    } else {
        number_key(w, ", texture: {checker: ", texture->size);
        point_key(w, ", color: ", texture->color);
    }
    point_key(w, ", origin: ", texture->origin);
    fputc('}', w->out);
}

static void write_materials(Writer *w) {
    fputs("materials:\n", w->out);
    for (uint32_t i = 0; i < w->scene->material_count; i++) {
        const RtMaterial *m = &w->scene->materials[i];
        material_name(w, "- {name: ", i);
        point_key(w, ", color: ", m->color);
#define WRITE(key) number_key(w, ", " #key ": ", m->key);
        RT_YAML_COEFFICIENTS(WRITE)
#undef WRITE
        write_texture(w, &m->texture);
        fputs("}\n", w->out);
    }
}

/* ---- solids ---- */

static void write_solids(Writer *w) {
    const RtSolidSet *set = &w->scene->geometry.forest.set;
    if (set->solid_count > 0 && w->solids == 0) fputs("solids:\n", w->out);
    for (uint32_t i = 0; i < set->solid_count; i++) {
        const RtSolid *solid = &set->solids[i];
        fprintf(w->out, "- {name: s%u, ", w->solids + i);
        if (solid->kind == RT_SOLID_POLYHEDRON) {
            fputs("polyhedron: {planes: ", w->out);
            rows(w, set->planes + solid->first, solid->count, 4, true);
        } else if (solid->kind == RT_SOLID_MESH) {
            fputs("facets: {triangles: ", w->out);
            rows(w, set->triangles + solid->first, solid->count, 9, false);
        } else {
            fprintf(w->out, "standard: {kind: %s, ratio: ", rt_solid_kind_name(solid->kind));
            number(w, solid->ratio, true);
            fputs(", place: ", w->out);
            numbers(w, solid->to_world.m, 12, true);
            if (solid->count > 0) fputs(", caps: ", w->out);
            if (solid->count > 0) rows(w, set->planes + solid->first, solid->count, 4, true);
        }
        material_name(w, ", material: ", solid->material);
        fputs("}}\n", w->out);
    }
    w->solids += set->solid_count;
}

/* ---- objects ---- */

static RtStatus write_csg(Writer *w, const RtCsg *tree, RtError *error) {
    char *formula;
    RT_TRY(rt_formula_write(&w->scene->geometry.forest, tree, w->solids, &formula, error));
    fprintf(w->out, "formula: '%s', extents: '%s'", formula, tree->extents ? "on" : "off");
    rt_free(formula);
    return RT_OK;
}

static RtStatus write_shape(Writer *w, RtShape shape, uint32_t index, RtError *error) {
    const RtGeometry *g = &w->scene->geometry;
    const RtTriangleTexture *texture;
    switch (shape) {
    case RT_SHAPE_SPHERE:
        point_key(w, "center: ", g->spheres[index].center);
        number_key(w, ", radius: ", g->spheres[index].radius);
        break;
    case RT_SHAPE_POLYGON:
        points_key(w, "vertices: ", rt_polygon_vertices(g, index), g->polygons[index].count);
        break;
    case RT_SHAPE_TRIANGLE:
        points_key(w, "vertices: ", g->triangles[index].v, 3);
        if (g->triangle_normals && g->triangle_normals[index] != RT_NO_NORMALS)
            points_key(w, ", normals: ", g->vertex_normals[g->triangle_normals[index]].n, 3);
        if (!(texture = rt_scene_triangle_texture(w->scene, index))) break;
        fputs(", uv: ", w->out);
        rows(w, texture->at, 3, 2, false);
        break;
    case RT_SHAPE_CONE:
        point_key(w, "base: ", g->cones[index].base);
        number_key(w, ", base_radius: ", g->cones[index].base_radius);
        point_key(w, ", apex: ", g->cones[index].apex);
        number_key(w, ", apex_radius: ", g->cones[index].apex_radius);
        break;
    case RT_SHAPE_CSG: return write_csg(w, &g->csgs[index], error);
    case RT_SHAPE_INSTANCE: /* write_instances */
    case RT_SHAPE_COUNT: break;
    }
    return RT_OK;
}

static void write_instances(Writer *w, const char *indent) {
    const RtGeometry *g = &w->scene->geometry;
    if (g->instance_count) fprintf(w->out, "%sinstances:\n", indent);
    for (uint32_t i = 0; i < g->instance_count; i++) {
        const uint32_t material = w->scene->material_of[g->instance_ids[i]];
        fprintf(w->out, "%s- ", indent);
        part_name(w, "{part: ", g->instances[i].part);
        fputs(", place: ", w->out);
        numbers(w, g->instances[i].to_world.m, 12, true);
        if (material != RT_OWN_MATERIALS) material_name(w, ", material: ", material);
        fputs("}\n", w->out);
    }
}

/* With the instances. */
static RtStatus write_objects(Writer *w, const char *indent, RtError *error) {
    const RtGeometry *g = &w->scene->geometry;
    const uint32_t count = g->object_count - g->instance_count;
    fprintf(w->out, count ? "%sobjects:\n" : "%sobjects: []\n", indent);
    for (uint32_t id = 0; id < count && !ferror(w->out); id++) {
        RtShape shape = rt_ref_shape(g->objects[id]);
        fprintf(w->out, "%s- {%s: {", indent, rt_shape_name(shape));
        RT_TRY(write_shape(w, shape, rt_ref_index(g->objects[id]), error));
        if (shape != RT_SHAPE_CSG) material_name(w, ", material: ", w->scene->material_of[id]);
        fputs("}}\n", w->out);
    }
    write_instances(w, indent);
    w->solids += g->forest.set.solid_count;
    return RT_OK;
}

/* The solids, the parts and the objects. */
static RtStatus write_content(Writer *w, RtError *error) {
    const RtScene *whole = w->whole;
    for (uint32_t i = 0; i <= whole->part_count; i++) {
        w->scene = i < whole->part_count ? whole->parts[i] : whole;
        write_solids(w);
    }
    w->solids = 0;
    if (whole->part_count > 0) fputs("parts:\n", w->out);
    for (uint32_t i = 0; i < whole->part_count; i++) {
        w->scene = whole->parts[i];
        part_name(w, "- name: ", i);
        fputc('\n', w->out);
        RT_TRY(write_objects(w, "  ", error));
    }
    w->scene = whole;
    return write_objects(w, "", error);
}

/* ---- names ---- */

static int compare_names(const void *a, const void *b) {
    return strcmp(*(const char *const *)a, *(const char *const *)b);
}

/* Does reading restore the name? It must be non-empty UTF-8 without control characters. */
static RtStatus try_name(const char *name, bool *good, RtError *error) {
    char text[2 * RT_MAX_NAME + 2];
    RtYaml yaml;
    *good = strlen(name) < RT_MAX_NAME;
    if (!*good) return RT_OK;
    quote(name, text);
    RtStatus status = rt_yaml_parse(&yaml, "a name", text, strlen(text), error);
    *good = status == RT_OK && name[0] && strcmp(yaml.text, name) == 0;
    if (status == RT_OK) rt_yaml_close(&yaml);
    return status == RT_NO_MEMORY ? status : RT_OK;
}

/* Must the `count` names be numbers, because one cannot be read, or two are equal? Sorts them. */
static RtStatus try_names(const char **names, uint32_t count, bool *numbered, RtError *error) {
    bool good = true;
    for (uint32_t i = 0; i < count && good; i++) RT_TRY(try_name(names[i], &good, error));
    if (good) qsort(names, count, sizeof *names, compare_names);
    for (uint32_t i = 1; i < count && good; i++) good = strcmp(names[i - 1], names[i]) != 0;
    *numbered = !good;
    return RT_OK;
}

/* ---- saving ---- */

RtStatus rt_yaml_save(const RtScene *scene, FILE *out, RtError *error) {
    RT_ARENA(memory);
    Writer w = {.whole = scene, .scene = scene, .out = out};
    const char **materials = rt_arena_alloc(&memory, scene->material_count, sizeof *materials),
               **parts = rt_arena_alloc(&memory, scene->part_count, sizeof *parts);
    RT_TRY(rt_arena_check(&memory, "names", error));
    for (uint32_t i = 0; i < scene->material_count; i++) materials[i] = scene->materials[i].name;
    for (uint32_t i = 0; i < scene->part_count; i++) parts[i] = scene->parts[i]->name;
    RT_TRY(try_names(materials, scene->material_count, &w.numbered, error));
    RT_TRY(try_names(parts, scene->part_count, &w.parts_numbered, error));
    fprintf(out, "format: %d\n", RT_FILE_FORMAT);
    write_camera(&w, &scene->camera);
    point_key(&w, "background: ", scene->background);
    point_key(&w, "\nambient: ", scene->ambient);
    fputc('\n', out);
    write_lights(&w);
    write_materials(&w);
    RT_TRY(write_content(&w, error));
    if (!ferror(out)) return RT_OK;
    return rt_fail(error, RT_IO, "writing the scene failed: is the disk full?");
}
