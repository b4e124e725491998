/* A scene to YAML by libyaml's emitter, which takes care of quoting. Numbers are written with as many
 * significant digits as give the float32 back bit for bit: 9 always do, 6 often. */
#include "base/memory.h"
#include "scene/formula.h"
#include "scene/yaml.h"

#include <stdlib.h>
#include <string.h>
#include <yaml.h>

typedef struct Writer {
    const RtScene *scene;
    const char **names; /* [material_count]; borrowed from the materials */
    bool numbered;      /* the names will not do: m0, m1 ... */
    yaml_emitter_t emitter;
    bool failed; /* sticky: later events are dropped */
} Writer;

/* ---- events ---- */

static void emit(Writer *w, yaml_event_t *event, int made) {
    if (made && w->failed) {
        yaml_event_delete(event);
    } else if (!made || !yaml_emitter_emit(&w->emitter, event)) {
        w->failed = true;
    }
}

static void scalar(Writer *w, const char *text, bool quoted) {
    yaml_event_t event;
    emit(w, &event,
         yaml_scalar_event_initialize(&event, NULL, NULL, (const yaml_char_t *)text, (int)strlen(text),
                                      !quoted, quoted, YAML_ANY_SCALAR_STYLE));
}

static void key(Writer *w, const char *name) {
    scalar(w, name, false);
}

static void begin_list(Writer *w, yaml_sequence_style_t style) {
    yaml_event_t event;
    emit(w, &event, yaml_sequence_start_event_initialize(&event, NULL, NULL, 1, style));
}

static void end_list(Writer *w) {
    yaml_event_t event;
    emit(w, &event, yaml_sequence_end_event_initialize(&event));
}

static void begin_mapping(Writer *w, yaml_mapping_style_t style) {
    yaml_event_t event;
    emit(w, &event, yaml_mapping_start_event_initialize(&event, NULL, NULL, 1, style));
}

static void end_mapping(Writer *w) {
    yaml_event_t event;
    emit(w, &event, yaml_mapping_end_event_initialize(&event));
}

/* ---- values ---- */

static void number(Writer *w, float value) {
    char text[32];
    for (int digits = 6; digits <= 9; digits++) {
        snprintf(text, sizeof text, "%.*g", digits, (double)value);
        if (strtof(text, NULL) == value) break;
    }
    scalar(w, text, false);
}

static void wide_number(Writer *w, double value) {
    char text[32];
    for (int digits = 15; digits <= 17; digits++) {
        snprintf(text, sizeof text, "%.*g", digits, value);
        if (strtod(text, NULL) == value) break;
    }
    scalar(w, text, false);
}

static void wide_numbers(Writer *w, const double *values, int count) {
    begin_list(w, YAML_FLOW_SEQUENCE_STYLE);
    for (int i = 0; i < count; i++) wide_number(w, values[i]);
    end_list(w);
}

static void point(Writer *w, RtVec3 p) {
    begin_list(w, YAML_FLOW_SEQUENCE_STYLE);
    for (int a = 0; a < 3; a++) number(w, p.at[a]);
    end_list(w);
}

static void points(Writer *w, const RtVec3 *p, uint32_t count) {
    begin_list(w, YAML_FLOW_SEQUENCE_STYLE);
    for (uint32_t i = 0; i < count; i++) point(w, p[i]);
    end_list(w);
}

static void number_key(Writer *w, const char *name, float value) {
    key(w, name);
    number(w, value);
}

static void point_key(Writer *w, const char *name, RtVec3 p) {
    key(w, name);
    point(w, p);
}

static void points_key(Writer *w, const char *name, const RtVec3 *p, uint32_t count) {
    key(w, name);
    points(w, p, count);
}

static void material_name(Writer *w, const char *name_of_key, uint32_t index) {
    char text[RT_MAX_NAME];
    snprintf(text, sizeof text, "m%u", index);
    key(w, name_of_key);
    scalar(w, w->numbered ? text : w->scene->materials[index].name, true);
}

/* ---- the parts of a scene ---- */

static void write_camera(Writer *w, const RtCamera *camera) {
    char text[32];
    key(w, "camera");
    begin_mapping(w, YAML_FLOW_MAPPING_STYLE);
    point_key(w, "from", camera->from);
    point_key(w, "at", camera->at);
    point_key(w, "up", camera->up);
    number_key(w, "fov", camera->fov);
    number_key(w, "near", camera->near);
    key(w, "size");
    begin_list(w, YAML_FLOW_SEQUENCE_STYLE);
    snprintf(text, sizeof text, "%u", camera->width);
    scalar(w, text, false);
    snprintf(text, sizeof text, "%u", camera->height);
    scalar(w, text, false);
    end_list(w);
    end_mapping(w);
}

static void write_lights(Writer *w) {
    key(w, "lights");
    begin_list(w, YAML_BLOCK_SEQUENCE_STYLE);
    for (uint32_t i = 0; i < w->scene->light_count; i++) {
        begin_mapping(w, YAML_FLOW_MAPPING_STYLE);
        point_key(w, "position", w->scene->lights[i].position);
        point_key(w, "intensity", w->scene->lights[i].intensity);
        end_mapping(w);
    }
    end_list(w);
}

static void write_materials(Writer *w) {
    key(w, "materials");
    begin_list(w, YAML_BLOCK_SEQUENCE_STYLE);
    for (uint32_t i = 0; i < w->scene->material_count; i++) {
        const RtMaterial *m = &w->scene->materials[i];
        begin_mapping(w, YAML_FLOW_MAPPING_STYLE);
        material_name(w, "name", i);
        point_key(w, "color", m->color);
        number_key(w, "ambient", m->ambient);
        number_key(w, "diffuse", m->diffuse);
        number_key(w, "specular", m->specular);
        number_key(w, "shine", m->shine);
        number_key(w, "reflection", m->reflection);
        number_key(w, "transmission", m->transmission);
        number_key(w, "ior", m->ior);
        end_mapping(w);
    }
    end_list(w);
}

/* ---- solids ---- */

static void write_planes(Writer *w, const RtPlane *planes, uint32_t count) {
    key(w, "planes");
    begin_list(w, YAML_FLOW_SEQUENCE_STYLE);
    for (uint32_t i = 0; i < count; i++) {
        RtVec3d n = planes[i].normal;
        wide_numbers(w, (const double[4]){n.x, n.y, n.z, planes[i].offset}, 4);
    }
    end_list(w);
}

static void write_facets(Writer *w, const RtTriangle *triangles, uint32_t count) {
    key(w, "triangles");
    begin_list(w, YAML_FLOW_SEQUENCE_STYLE);
    for (uint32_t i = 0; i < count; i++) {
        begin_list(w, YAML_FLOW_SEQUENCE_STYLE);
        for (int k = 0; k < 9; k++) number(w, triangles[i].v[k / 3].at[k % 3]);
        end_list(w);
    }
    end_list(w);
}

static void write_solid(Writer *w, const RtSolid *solid) {
    const RtSolidSet *set = &w->scene->geometry.forest.set;
    bool flat = solid->kind == RT_SOLID_POLYHEDRON, mesh = solid->kind == RT_SOLID_MESH;
    key(w, flat ? "polyhedron" : mesh ? "facets" : "standard");
    begin_mapping(w, YAML_FLOW_MAPPING_STYLE);
    if (flat) {
        write_planes(w, set->planes + solid->first, solid->count);
    } else if (mesh) {
        write_facets(w, set->triangles + solid->first, solid->count);
    } else {
        key(w, "kind");
        scalar(w, rt_solid_kind_name(solid->kind), false);
        key(w, "ratio");
        wide_number(w, solid->ratio);
        key(w, "place");
        wide_numbers(w, &solid->place.m[0][0], 12);
    }
    material_name(w, "material", solid->material);
    end_mapping(w);
}

static void write_solids(Writer *w) {
    const RtSolidSet *set = &w->scene->geometry.forest.set;
    if (set->solid_count == 0) return;
    key(w, "solids");
    begin_list(w, YAML_BLOCK_SEQUENCE_STYLE);
    for (uint32_t i = 0; i < set->solid_count && !w->failed; i++) {
        char name[16];
        snprintf(name, sizeof name, "s%u", i);
        begin_mapping(w, YAML_FLOW_MAPPING_STYLE);
        key(w, "name");
        scalar(w, name, false);
        write_solid(w, &set->solids[i]);
        end_mapping(w);
    }
    end_list(w);
}

static void write_csg(Writer *w, const RtCsg *tree) {
    RtError error;
    char *formula;
    if (rt_formula_write(&w->scene->geometry.forest, tree, &formula, &error) != RT_OK) {
        w->failed = true; /* for want of memory, like all failures of the emitter */
        return;
    }
    key(w, "formula");
    scalar(w, formula, true);
    key(w, "extents");
    scalar(w, tree->extents ? "on" : "off", true);
    rt_free(formula);
}

/* ---- objects ---- */

static void write_shape(Writer *w, RtShape shape, uint32_t index) {
    const RtGeometry *g = &w->scene->geometry;
    switch (shape) {
    case RT_SHAPE_SPHERE:
        point_key(w, "center", g->spheres[index].center);
        number_key(w, "radius", g->spheres[index].radius);
        break;
    case RT_SHAPE_POLYGON:
        points_key(w, "vertices", g->polygon_vertices + g->polygons[index].first, g->polygons[index].count);
        break;
    case RT_SHAPE_TRIANGLE:
        points_key(w, "vertices", g->triangles[index].v, 3);
        if (g->triangle_normals && g->triangle_normals[index] != RT_NO_NORMALS) {
            points_key(w, "normals", g->vertex_normals[g->triangle_normals[index]].n, 3);
        }
        break;
    case RT_SHAPE_CONE:
        point_key(w, "base", g->cones[index].base);
        number_key(w, "base_radius", g->cones[index].base_radius);
        point_key(w, "apex", g->cones[index].apex);
        number_key(w, "apex_radius", g->cones[index].apex_radius);
        break;
    case RT_SHAPE_CSG: write_csg(w, &g->csgs[index]); break;
    case RT_SHAPE_COUNT: break;
    }
}

static void write_objects(Writer *w) {
    const RtGeometry *g = &w->scene->geometry;
    key(w, "objects");
    begin_list(w, YAML_BLOCK_SEQUENCE_STYLE);
    for (uint32_t id = 0; id < g->object_count && !w->failed; id++) {
        RtShape shape = rt_ref_shape(g->objects[id]);
        begin_mapping(w, YAML_FLOW_MAPPING_STYLE);
        key(w, rt_shape_name(shape));
        begin_mapping(w, YAML_FLOW_MAPPING_STYLE);
        write_shape(w, shape, rt_ref_index(g->objects[id]));
        if (shape != RT_SHAPE_CSG) material_name(w, "material", w->scene->material_of[id]);
        end_mapping(w);
        end_mapping(w);
    }
    end_list(w);
}

static void write_document(Writer *w) {
    yaml_event_t event;
    emit(w, &event, yaml_stream_start_event_initialize(&event, YAML_UTF8_ENCODING));
    emit(w, &event, yaml_document_start_event_initialize(&event, NULL, NULL, NULL, 1));
    begin_mapping(w, YAML_BLOCK_MAPPING_STYLE);
    write_camera(w, &w->scene->camera);
    point_key(w, "background", w->scene->background);
    point_key(w, "ambient", w->scene->ambient);
    write_lights(w);
    write_materials(w);
    write_solids(w);
    write_objects(w);
    end_mapping(w);
    emit(w, &event, yaml_document_end_event_initialize(&event, 1));
    emit(w, &event, yaml_stream_end_event_initialize(&event));
}

/* ---- names ---- */

static int compare_names(const void *a, const void *b) {
    return strcmp(*(const char *const *)a, *(const char *const *)b);
}

/* Can a reader tell it back? Not empty, no control characters, and UTF-8 (which libyaml checks). */
static bool is_writable_name(const char *name) {
    if (name[0] == '\0') return false;
    for (const char *c = name; *c; c++) {
        if ((unsigned char)*c < ' ' || *c == 0x7f) return false;
    }
    yaml_event_t event;
    if (!yaml_scalar_event_initialize(&event, NULL, NULL, (const yaml_char_t *)name, (int)strlen(name), 0, 1,
                                      YAML_ANY_SCALAR_STYLE)) {
        return false;
    }
    yaml_event_delete(&event);
    return true;
}

static bool names_will_do(Writer *w) {
    uint32_t count = w->scene->material_count;
    for (uint32_t i = 0; i < count; i++) {
        w->names[i] = w->scene->materials[i].name;
        if (!is_writable_name(w->names[i])) return false;
    }
    qsort(w->names, count, sizeof *w->names, compare_names);
    for (uint32_t i = 1; i < count; i++) {
        if (strcmp(w->names[i - 1], w->names[i]) == 0) return false;
    }
    return true;
}

/* ---- saving ---- */

static int write_bytes(void *out, unsigned char *bytes, size_t count) {
    return fwrite(bytes, 1, count, out) == count;
}

static RtStatus save(Writer *w, FILE *out, RtError *error) {
    if (!yaml_emitter_initialize(&w->emitter))
        return rt_fail_memory(error, "writing YAML", sizeof w->emitter);
    yaml_emitter_set_output(&w->emitter, write_bytes, out);
    yaml_emitter_set_unicode(&w->emitter, 1);
    yaml_emitter_set_width(&w->emitter, -1);
    write_document(w);
    RtStatus status = RT_OK;
    if (w->emitter.error == YAML_WRITER_ERROR) {
        status = rt_fail(error, RT_IO, "writing the scene failed: is the disk full?");
    } else if (w->failed) {
        status = rt_fail_memory(error, "writing YAML", sizeof w->emitter);
    }
    yaml_emitter_delete(&w->emitter);
    return status;
}

RtStatus rt_yaml_save(const RtScene *scene, FILE *out, RtError *error) {
    Writer w = {.scene = scene, .names = rt_alloc(scene->material_count, sizeof *w.names)};
    if (!w.names) {
        return rt_fail_memory(error, "the names of materials", scene->material_count * sizeof *w.names);
    }
    w.numbered = !names_will_do(&w);
    rt_free(w.names);
    return save(&w, out, error);
}
