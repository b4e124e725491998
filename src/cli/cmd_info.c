/* SPDX-License-Identifier: Apache-2.0 */
/* raytally info: what is in a scene. */
#include "cli/cli.h"
#include "core/base/words.h"
#include "measure/extents_table.h"
#include "measure/node_file.h"
#include "scenes/open.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

typedef struct Options {
    const char *scene, *accel, *nodes;
    bool json, extents, every_slabs;
    uint64_t rays, seed;
} Options;

typedef struct Counts {
    uint32_t of_shape[RT_SHAPE_COUNT];
    uint32_t zero_area;  /* triangles */
    double area, volume; /* of all triangles; the volume that they enclose if they are closed,
                          * counter-clockwise from outside */
    uint64_t instances;  /* of the scene and of its parts */
    uint64_t *copies;    /* [part_count] of each part, in the flattened scene; owned */
    uint64_t flat_bytes; /* estimate for it */
    char fingerprint[17];
} Counts;

static void clear_counts(Counts *counts) {
    rt_free(counts->copies);
}

static void take_extents(void *options, const char *text, struct argp_state *state) {
    Options *o = options;
    o->extents = true;
    o->every_slabs = text != NULL;
    if (text && strcmp(text, "all") != 0)
        argp_error(state, "--extents: invalid value '%s': expected --extents or --extents=all", text);
}

static void finish(void *options, struct argp_state *state) {
    const Options *o = options;
    if (!o->accel != !o->nodes) argp_error(state, "--accel SPEC and --nodes FILE.csv belong together");
}

static const RtOption options[] = {
    {"extents", 'e', "all", RT_TO_TAKE_OPTIONAL(take_extents),
     "Also measure how tight the objects' extents are and what their tests cost: boxes, spheres, oriented "
     "boxes, 3, 7 and 13 slabs; with =all every number of slabs"},
    {"accel", 'a', "SPEC", RT_TO_TEXT(accel), "The accelerator of --nodes"},
    {"nodes", 0, "FILE.csv", RT_TO_PATH(nodes, ".csv"),
     "Write the nodes or voxels of --accel, a row each: node, parent, level, leaf, children, objects in a "
     "leaf's list, and the corners of the box"},
    {"rays", 'n', "N", RT_TO_INTEGER(rays, 1, 1000000000), "Random lines per shape for --extents (100000)"},
    {"seed", 's', "S", RT_TO_INTEGER(seed, 0, INT64_MAX), "Seed of these lines (1)"},
    RT_STRICT_OPTION,
    RT_LIMIT_OPTIONS,
    {"json", 'j', NULL, RT_TO_FLAG(json), "One JSON document on stdout"},
    {0}};

static RtStatus save_nodes(const Options *o, const RtScene *scene, RtError *error) {
    RT_OWNED(RtAccel *, accel, rt_accel_destroy_at);
    uint32_t count;
    RT_TRY(rt_accel_open(o->accel, scene, &accel, error));
    RT_TRY(rt_nodes_save(accel, o->nodes, &count, error));
    if (!o->json) printf("%s: %u node%s of %s\n\n", o->nodes, count, rt_plural(count), o->accel);
    return RT_OK;
}

/* Parts contain earlier parts only: the copies of one are known before those in it. */
static RtStatus count_copies(const RtScene *scene, Counts *counts, RtError *error) {
    const uint32_t parts = scene->part_count;
    counts->copies = rt_alloc(parts, sizeof *counts->copies);
    if (!counts->copies) return rt_fail_memory(error, "counts of parts", parts * sizeof *counts->copies);
    counts->flat_bytes = rt_scene_bytes(scene);
    for (uint32_t i = parts + 1; i-- > 0;) {
        const RtScene *from = i == parts ? scene : scene->parts[i];
        const uint64_t copies = i == parts ? 1 : counts->copies[i];
        counts->instances += from->geometry.instance_count;
        for (uint32_t k = 0; k < from->geometry.instance_count; k++)
            counts->copies[from->geometry.instances[k].part] += copies;
        if (i < parts) counts->flat_bytes += (copies - 1) * rt_scene_bytes(from);
    }
    return RT_OK;
}

static Counts count(const RtScene *scene) {
    const RtGeometry *g = &scene->geometry;
    Counts counts = {.of_shape = {
#define COUNT(CONSTANT, name, Type) g->name##_count,
                         RT_SHAPES(COUNT)
#undef COUNT
                     }};
    const RtVec3d center = rt_scaled(rt_addd(rt_widen(g->box.lo), rt_widen(g->box.hi)), 0.5);
    for (uint32_t i = 0; i < g->triangle_count; i++) {
        const RtTriangle *t = &g->triangles[i];
        const RtVec3d corner = rt_widen(t->v[0]);
        const RtVec3d area = rt_area_vector(corner, rt_widen(t->v[1]), rt_widen(t->v[2])); /* twice it */
        counts.zero_area += rt_lengthd(rt_triangle_normal(t)) == 0;
        counts.area += rt_lengthd(area) / 2;
        counts.volume += rt_dotd(area, rt_subd(corner, center)) / 6;
    }
    snprintf(counts.fingerprint, sizeof counts.fingerprint, "%016" PRIx64, rt_scene_fingerprint(scene));
    return counts;
}

/* ---- as text ---- */

static void print_vector(const char *what, RtVec3 v) {
    printf("  %-13s %.6g %.6g %.6g\n", what, (double)v.x, (double)v.y, (double)v.z);
}

/* "checker", or the path of an image; NULL without a texture. */
static const char *texture_of(const RtMaterial *m) {
    return m->texture.texels ? m->texture.texels->path : m->texture.kind ? "checker" : NULL;
}

static void print_material(const RtMaterial *m) {
    printf("  %-13s color %.3g %.3g %.3g, ambient %.3g, diffuse %.3g, specular %.3g, shine %.4g,\n"
           "  %-13s reflection %.3g, transmission %.3g, ior %.3g\n",
           m->name, (double)m->color.x, (double)m->color.y, (double)m->color.z, (double)m->ambient,
           (double)m->diffuse, (double)m->specular, (double)m->shine, "", (double)m->reflection,
           (double)m->transmission, (double)m->ior);
    if (texture_of(m)) printf("  %-13s texture %s, size %.4g\n", "", texture_of(m), (double)m->texture.size);
}

enum { SHOWN = 8 }; /* parts, materials and lights */

static void print_parts(const RtScene *scene, const Counts *counts) {
    if (scene->part_count == 0) return;
    printf("parts: %u; instances: %" PRIu64 ", nested in %u level%s; memory as copies: about %.1f MB\n",
           scene->part_count, counts->instances, scene->geometry.nesting, rt_plural(scene->geometry.nesting),
           (double)counts->flat_bytes / 1e6);
    for (uint32_t i = 0; i < scene->part_count && i < SHOWN; i++) {
        const uint32_t objects = rt_geometry_id_count(&scene->parts[i]->geometry);
        printf("  %-13s %u object%s, %" PRIu64 " cop%s\n", scene->parts[i]->name, objects, rt_plural(objects),
               counts->copies[i], counts->copies[i] == 1 ? "y" : "ies");
    }
    if (scene->part_count > SHOWN) printf("  ... (--json lists all)\n");
}

static void print_info(const RtScene *scene, const Counts *counts) {
    const RtGeometry *g = &scene->geometry;
    printf("%s\n\nobjects: %u\n", scene->name, rt_geometry_id_count(g));
    for (int i = 0; i < RT_SHAPE_COUNT; i++) {
        if (counts->of_shape[i]) printf("  %-13s %u\n", rt_shape_name((RtShape)i), counts->of_shape[i]);
    }
    if (g->csg_count) printf("  made of solids: %u\n", g->forest.set.solid_count);
    if (g->vertex_normal_count)
        printf("  with vertex normals: %u triangle%s\n", g->vertex_normal_count,
               rt_plural(g->vertex_normal_count));
    if (g->triangle_count)
        printf("  area of triangles: %.6g; volume in them, if closed: %.6g\n", counts->area, counts->volume);
    if (counts->zero_area)
        printf("  without area, never hit: %u triangle%s\n", counts->zero_area, rt_plural(counts->zero_area));
    print_parts(scene, counts);
    printf(g->object_count > 0 ? "bounds:\n" : "bounds: none\n");
    if (g->object_count > 0) {
        print_vector("from", g->box.lo);
        print_vector("to", g->box.hi);
    }
    printf("materials: %u\n", scene->material_count);
    for (uint32_t i = 0; i < scene->material_count && i < SHOWN; i++) print_material(&scene->materials[i]);
    if (scene->material_count > SHOWN) printf("  ... (--json lists all)\n");
    printf("lights: %u\n", scene->light_count);
    for (uint32_t i = 0; i < scene->light_count && i < SHOWN; i++)
        print_vector("at", scene->lights[i].position);
    if (scene->light_count > SHOWN) printf("  ... (--json lists all)\n");
    const RtCamera *camera = &scene->camera;
    printf("camera:\n");
    print_vector("from", camera->from);
    print_vector("at", camera->at);
    print_vector("up", camera->up);
    printf("  %-13s %.4g degrees, %u x %u pixels, near %.4g\n", "view", (double)camera->fov, camera->width,
           camera->height, (double)camera->near);
    printf("memory: %.1f MB\nfingerprint: %s\n", (double)rt_scene_bytes(scene) / 1e6, counts->fingerprint);
}

/* ---- as JSON ---- */

static json_t *material_json(const RtMaterial *m) {
    return json_pack("{s:s, s:o, s:f, s:f, s:f, s:f, s:f, s:f, s:f, s:s?}", "name", m->name, "color",
                     rt_cli_vector_json(m->color), "ambient", (double)m->ambient, "diffuse",
                     (double)m->diffuse, "specular", (double)m->specular, "shine", (double)m->shine,
                     "reflection", (double)m->reflection, "transmission", (double)m->transmission, "ior",
                     (double)m->ior, "texture", texture_of(m));
}

static json_t *parts_json(const RtScene *scene, const Counts *counts) {
    json_t *parts = json_array();
    for (uint32_t i = 0; i < scene->part_count; i++) {
        const RtGeometry *g = &scene->parts[i]->geometry;
        json_array_append_new(parts, json_pack("{s:s, s:I, s:I, s:I}", "name", scene->parts[i]->name,
                                               "objects", (json_int_t)rt_geometry_id_count(g), "instances",
                                               (json_int_t)g->instance_count, "copies",
                                               (json_int_t)counts->copies[i]));
    }
    return parts;
}

static json_t *info_json(const RtScene *scene, const Counts *counts) {
    const RtGeometry *g = &scene->geometry;
    json_t *shapes = json_object(), *materials = json_array(), *lights = json_array();
    for (int i = 0; i < RT_SHAPE_COUNT; i++)
        json_object_set_new(shapes, rt_shape_name((RtShape)i), json_integer(counts->of_shape[i]));
    for (uint32_t i = 0; i < scene->material_count; i++)
        json_array_append_new(materials, material_json(&scene->materials[i]));
    for (uint32_t i = 0; i < scene->light_count; i++) {
        const RtLight *light = &scene->lights[i];
        json_array_append_new(lights, json_pack("{s:o, s:o}", "position", rt_cli_vector_json(light->position),
                                                "intensity", rt_cli_vector_json(light->intensity)));
    }
    const RtCamera *camera = &scene->camera;
    json_t *bounds = g->object_count == 0 ? json_null()
                                          : json_pack("{s:o, s:o}", "lo", rt_cli_vector_json(g->box.lo), "hi",
                                                      rt_cli_vector_json(g->box.hi));
    json_t *warnings = json_array();
    for (uint32_t i = 0; i < scene->warnings.count; i++) {
        char text[RT_WARNING_TEXT];
        json_array_append_new(warnings, json_string(rt_warning_text(&scene->warnings.list[i], text)));
    }
    return json_pack(
        "{s:s, s:s, s:I, s:o, s:I, s:I, s:I, s:f, s:f, s:o, s:o, s:o, s:o, s:o,"
        " s:{s:o, s:o, s:o, s:f, s:f, s:I, s:I}, s:o, s:I, s:I, s:I, s:I, s:o}",
        "scene", scene->name, "fingerprint", counts->fingerprint, "objects",
        (json_int_t)rt_geometry_id_count(g), "shapes", shapes, "solids",
        (json_int_t)g->forest.set.solid_count, "triangles_with_normals", (json_int_t)g->vertex_normal_count,
        "triangles_without_area", (json_int_t)counts->zero_area, "area", counts->area, "volume",
        counts->volume, "bounds", bounds, "materials", materials, "lights", lights, "ambient",
        rt_cli_vector_json(scene->ambient), "background", rt_cli_vector_json(scene->background), "camera",
        "from", rt_cli_vector_json(camera->from), "at", rt_cli_vector_json(camera->at), "up",
        rt_cli_vector_json(camera->up), "fov", (double)camera->fov, "near", (double)camera->near, "width",
        (json_int_t)camera->width, "height", (json_int_t)camera->height, "parts", parts_json(scene, counts),
        "instances", (json_int_t)counts->instances, "nesting", (json_int_t)g->nesting, "bytes",
        (json_int_t)rt_scene_bytes(scene), "estimated_bytes_of_copies", (json_int_t)counts->flat_bytes,
        "warnings", warnings);
}

/* ---- the command ---- */

const RtSyntax rt_info_syntax = {.options = options,
                                 RT_ONE_SCENE,
                                 .finish = finish,
                                 .help =
                                     "Show what is in a scene: objects by shape, bounds, materials, lights, "
                                     "the camera, memory, and a fingerprint of everything that affects hits. "
                                     "SCENE is a file or a built-in such as balls:size=5."};

RtStatus rt_command_info(int argc, char **argv, RtError *error) {
    Options o = {.rays = 100000, .seed = 1};
    RT_OWNED(RtScene, scene, rt_scene_clear);
    RtExtentsTable table;
    rt_cli_parse(&rt_info_syntax, argc, argv, &o);
    if (o.json) RT_TRY(rt_cli_check_json_name(o.scene, error));
    RT_TRY(rt_cli_open_scene(o.scene, &scene, error));
    RT_OWNED(Counts, counts, clear_counts);
    counts = count(&scene);
    RT_TRY(count_copies(&scene, &counts, error));
    if (o.nodes) RT_TRY(save_nodes(&o, &scene, error));
    if (o.extents && scene.geometry.instance_count > 0)
        return rt_fail(error, RT_BAD_INPUT,
                       "%s: --extents sees no objects inside instances: `raytally convert --flatten` first",
                       o.scene);
    if (o.extents) RT_TRY(rt_extents_table(&table, &scene, o.every_slabs, o.rays, o.seed, error));
    if (o.json) {
        json_t *info = info_json(&scene, &counts);
        if (o.extents) json_object_set_new(info, "extents", rt_extents_table_json(&table));
        rt_cli_print_json(info);
    } else {
        print_info(&scene, &counts);
        if (o.extents) rt_extents_table_print(&table, stdout);
    }
    return RT_OK;
}
