/* SPDX-License-Identifier: Apache-2.0 */
/* From the nodes of a YAML file (core/text/yaml.h) to a scene. The functions that add objects and solids
 * check the values; rt_yaml_place adds the position to their messages. A formula sees only the solids before
 * it, so no solid can contain itself. */
#include "core/base/file.h"
#include "core/base/memory.h"
#include "core/base/words.h"
#include "core/scene/formula.h"
#include "core/scene/load.h"
#include "core/scene/mesh.h"
#include "core/scene/yaml_values.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

typedef struct Named {
    const char *name;
    const RtYamlNode *node; /* the entry of the list */
    uint32_t index;         /* its position in the list */
} Named;

/* The entries of a list, sorted by name. */
typedef struct Names {
    Named *all; /* [count] */
    uint32_t count;
} Names;

typedef struct Reader {
    RtYaml yaml;
    RtSceneOpener *open_named;
    RtScene *scene; /* that objects are added to: `whole`, or a part of it */
    RtScene *whole;
    Names parts;          /* entry i is part i of the scene */
    Names materials;      /* entry i is material i of the scene */
    uint32_t standard;    /* index of the default material; UINT32_MAX until it is needed */
    RtCsgBuilder builder; /* holds the solids */
    Names solids;         /* entry i is terms[i] */
    RtCsgTerm *terms;
    uint32_t solids_known; /* solids read so far */
    RtArena memory;        /* of names and terms */
    RtError *error;
} Reader;

/* For a list X(name, function) of alternatives: their keys (rt_yaml_keys). */
#define ONE_OF(name, function) #name "| "

/* ---- names ---- */

static int by_name(const void *a, const void *b) {
    return strcmp(((const Named *)a)->name, ((const Named *)b)->name);
}

/* Checks the entries of `list` (NULL: none) against `keys`, and fills `names` with their names, of at most
 * `most` characters. Rejects duplicates; `what` describes the entries in messages. */
static RtStatus read_names(Reader *r, const RtYamlNode *list, const char *keys, size_t most, const char *what,
                           Names *names) {
    RT_TRY(rt_yaml_list(&r->yaml, list, NULL, 0, UINT32_MAX, what));
    uint32_t count = rt_yaml_count(list);
    Named *all = names->all = rt_arena_alloc(&r->memory, count, sizeof *all);
    RT_TRY(rt_arena_check(&r->memory, what, r->error));
    for (const RtYamlNode *n = rt_yaml_first(list); n != rt_yaml_end(list); n += n->size) {
        Named *named = &all[names->count];
        RT_TRY(rt_yaml_keys(&r->yaml, n, keys));
        RT_TRY(rt_yaml_text(&r->yaml, n, "name", most, &named->name));
        named->node = n;
        named->index = names->count++;
    }
    qsort(all, count, sizeof *all, by_name);
    for (uint32_t i = 1; i < count; i++) {
        if (strcmp(all[i - 1].name, all[i].name) != 0) continue;
        const Named *later = &all[all[i].index > all[i - 1].index ? i : i - 1];
        return rt_yaml_fail(&r->yaml, rt_yaml_get(&r->yaml, later->node, "name"),
                            "there are two %s '%s': rename one", what, later->name);
    }
    return RT_OK;
}

static const Named *find_name(const Names *names, const char *name) {
    Named wanted = {.name = name};
    return bsearch(&wanted, names->all, names->count, sizeof wanted, by_name);
}

/* ---- what objects and solids share ---- */

/* The default material, created on first use. */
static RtStatus need_default(Reader *r) {
    const RtMaterial material = rt_default_material();
    if (r->standard != UINT32_MAX) return RT_OK;
    return rt_scene_add_material(r->scene, &material, &r->standard, r->error);
}

/* The `material` of an object; without one, the default material. */
static RtStatus find_material(Reader *r, const RtYamlNode *object, uint32_t *index) {
    const RtYamlNode *node = rt_yaml_get(&r->yaml, object, "material");
    const char *name = "default";
    RT_TRY(rt_yaml_text(&r->yaml, object, "material", RT_MAX_NAME - 1, &name));
    const Named *found = find_name(&r->materials, name);
    if (node && !found)
        return rt_yaml_fail(&r->yaml, node, "there is no material '%s': add it to the list of materials",
                            name);
    if (!found) RT_TRY(need_default(r));
    *index = found ? found->index : r->standard;
    return RT_OK;
}

static const RtVec3d nowhere = {{0, 0, 0}};

/* Whether the scene is to be moved, which needs doubles. */
static bool has_offset(const Reader *r) {
    return rt_dotd(r->scene->offset, r->scene->offset) > 0;
}

static RtStatus read_transform(const Reader *r, const RtYamlNode *object, RtVec3d offset,
                               RtTransform *transform, const RtTransform **given) {
    return rt_yaml_transform(&r->yaml, object, offset, has_offset(r), transform, given);
}

/* The path of a file that the scene names as `key`, relative to the scene's own. */
static RtStatus get_path(Reader *r, const RtYamlNode *n, const char *key, char path[RT_MAX_PATH]) {
    char folder[RT_MAX_PATH];
    const char *name = "";
    RT_TRY(rt_yaml_text(&r->yaml, n, key, RT_MAX_PATH - 1, &name));
    rt_path_folder(r->yaml.path, folder);
    return rt_yaml_place(&r->yaml, rt_path_join(folder, name, path, r->error), n, key);
}

/* Adds the triangles of the file at the `path` of an object to `scene`, moved by its `transform`. */
static RtStatus append_mesh(Reader *r, const RtYamlNode *object, uint32_t material, RtScene *scene) {
    RtTransform transform;
    const RtTransform *given;
    char path[RT_MAX_PATH];
    RT_TRY(read_transform(r, object, nowhere, &transform, &given));
    RT_TRY(get_path(r, object, "path", path));
    RtStatus status = rt_mesh_append(scene, path, material, given, false, r->error);
    return rt_yaml_place(&r->yaml, status, object, "path");
}

/* ---- materials ---- */

#define OPTIONAL_KEY(key) #key "? "

/* The caller releases its texels. */
static RtStatus read_texture(Reader *r, const RtYamlNode *n, RtTexture *texture) {
    const RtYaml *y = &r->yaml;
    const bool image = rt_yaml_get(y, n, "image");
    char path[RT_MAX_PATH];
    *texture = (RtTexture){.kind = image ? RT_TEXTURE_IMAGE : RT_TEXTURE_CHECKER,
                           .size = 1,
                           .origin = rt_narrow(rt_subd(nowhere, r->scene->offset))};
    RT_TRY(rt_yaml_keys(y, n, image ? "image size? origin?" : "checker color? origin?"));
    RT_TRY(rt_yaml_float(y, n, image ? "size" : "checker", &texture->size));
    RT_TRY(rt_yaml_point(y, n, "color", &texture->color));
    RT_TRY(rt_yaml_position(y, n, "origin", &texture->origin));
    if (!image) return RT_OK;
    RT_TRY(get_path(r, n, "image", path));
    return rt_yaml_place(y, rt_scene_load_texels(r->scene, path, &texture->texels, r->error), n, "image");
}

static RtStatus add_material(Reader *r, const RtYamlNode *n) {
    RtMaterial material = rt_default_material();
    const RtYamlNode *texture = rt_yaml_get(&r->yaml, n, "texture");
    uint32_t index;
    RT_TRY(rt_yaml_copy(&r->yaml, n, "name", sizeof material.name, material.name));
    RT_TRY(rt_yaml_point(&r->yaml, n, "color", &material.color));
#define READ(name) RT_TRY(rt_yaml_float(&r->yaml, n, #name, &material.name));
    RT_YAML_COEFFICIENTS(READ)
#undef READ
    if (texture) RT_TRY(read_texture(r, texture, &material.texture));
    RtStatus status = rt_scene_add_material(r->scene, &material, &index, r->error);
    rt_texels_release(material.texture.texels);
    return rt_yaml_place(&r->yaml, status, n, NULL);
}

static RtStatus add_materials(Reader *r, const RtYamlNode *list) {
    assert(r->scene->material_count == 0);
    RT_TRY(read_names(r, list, "name color? texture? " RT_YAML_COEFFICIENTS(OPTIONAL_KEY), RT_MAX_NAME - 1,
                      "materials", &r->materials));
    for (const RtYamlNode *n = rt_yaml_first(list); n != rt_yaml_end(list); n += n->size)
        RT_TRY(add_material(r, n));
    return RT_OK;
}

/* ---- solids: each solid_... adds one and returns its index in the set ---- */

static RtStatus solid_sphere(Reader *r, const RtYamlNode *n, uint32_t *index) {
    const RtYaml *y = &r->yaml;
    RtVec3 center;
    float radius;
    RT_TRY(rt_yaml_sphere(y, n, &center, &radius));
    if (!(radius > 0))
        return rt_yaml_fail(y, rt_yaml_get(y, n, "radius"),
                            "a sphere needs a radius above 0, this one has %g", (double)radius);
    RtVec3 radii = rt_vec3(radius, radius, radius);
    return rt_yaml_place(y, rt_solid_add_ellipsoid(&r->builder.set, center, radii, index, r->error), n,
                         "center");
}

/* Solids given by two points or vectors. */
static const struct Pair {
    const char *kind, *keys, *first, *second;
    RtStatus (*add)(RtSolidSet *set, RtVec3 first, RtVec3 second, uint32_t *index, RtError *error);
} pairs[] = {{"ellipsoid", "center radii material?", "center", "radii", rt_solid_add_ellipsoid},
             {"box", "lo hi material?", "lo", "hi", rt_solid_add_box},
             {"half_space", "point normal material?", "point", "normal", rt_solid_add_half_space}};

static RtStatus solid_pair(Reader *r, const RtYamlNode *n, uint32_t *index) {
    const struct Pair *pair = pairs;
    RtVec3 first = {0}, second = {0};
    while (strcmp(pair->kind, rt_yaml_key_of(&r->yaml, n)) != 0) pair++;
    RT_TRY(rt_yaml_keys(&r->yaml, n, pair->keys));
    RT_TRY(rt_yaml_position(&r->yaml, n, pair->first, &first));
    RT_TRY(pair->add == rt_solid_add_box ? rt_yaml_position(&r->yaml, n, pair->second, &second)
                                         : rt_yaml_point(&r->yaml, n, pair->second, &second));
    return rt_yaml_place(&r->yaml, pair->add(&r->builder.set, first, second, index, r->error), n, NULL);
}

static RtStatus solid_round(Reader *r, const RtYamlNode *n, uint32_t *index) {
    RtCone c;
    RT_TRY(rt_yaml_cone(&r->yaml, n, &c));
    RtStatus status =
        rt_solid_add_frustum(&r->builder.set, c.base, c.base_radius, c.apex, c.apex_radius, index, r->error);
    return rt_yaml_place(&r->yaml, status, n, NULL);
}

static RtStatus solid_torus(Reader *r, const RtYamlNode *n, uint32_t *index) {
    const RtYaml *y = &r->yaml;
    RtVec3 center = {0}, axis = rt_vec3(0, 0, 1);
    float major = 0, minor = 0;
    RT_TRY(rt_yaml_keys(y, n, "center axis? major minor material?"));
    RT_TRY(rt_yaml_position(y, n, "center", &center));
    RT_TRY(rt_yaml_point(y, n, "axis", &axis));
    RT_TRY(rt_yaml_float(y, n, "major", &major));
    RT_TRY(rt_yaml_float(y, n, "minor", &minor));
    RtStatus status = rt_solid_add_ring(&r->builder.set, center, axis, major, minor, index, r->error);
    return rt_yaml_place(y, status, n, NULL);
}

/* The planes of a list, at most `most`: [nx, ny, nz, d] each. */
static RtStatus read_planes(Reader *r, const RtYamlNode *list, uint32_t most, RtArena *memory,
                            RtPlane **planes) {
    RT_TRY(rt_yaml_list(&r->yaml, list, NULL, 1, most, "planes, as in [[0, 0, 1, 2]]"));
    RtPlane *plane = *planes = rt_arena_alloc(memory, rt_yaml_count(list), sizeof *plane);
    RT_TRY(rt_arena_check(memory, "planes", r->error));
    for (const RtYamlNode *n = list + 1; n != rt_yaml_end(list); n += n->size) {
        double p[4] = {0};
        RT_TRY(rt_yaml_doubles(&r->yaml, n, NULL, 4, p));
        *plane++ = (RtPlane){rt_vec3d(p[0], p[1], p[2]), p[3]};
    }
    return RT_OK;
}

static RtStatus solid_polyhedron(Reader *r, const RtYamlNode *n, uint32_t *index) {
    RT_ARENA(memory);
    RtSolidSet *set = &r->builder.set;
    RtPlane *planes;
    float *vertices;
    uint32_t count;
    RT_TRY(rt_yaml_keys(&r->yaml, n, "vertices| planes| material?"));
    const RtYamlNode *list = rt_yaml_get(&r->yaml, n, "planes");
    if (list) {
        RT_TRY(read_planes(r, list, UINT32_MAX, &memory, &planes));
        return rt_yaml_place(&r->yaml,
                             rt_solid_add_polyhedron(set, planes, rt_yaml_count(list), NULL, index, r->error),
                             list, NULL);
    }
    RT_TRY(rt_yaml_rows(&r->yaml, n, "vertices", 4, 3, &memory, &vertices, &count));
    RtStatus status = rt_solid_add_hull(set, (const RtVec3 *)vertices, count, index, r->error);
    return rt_yaml_place(&r->yaml, status, n, "vertices");
}

/* Reads the triangles of a file through a temporary scene. */
static RtStatus solid_mesh(Reader *r, const RtYamlNode *n, uint32_t *index) {
    RtMaterial standard = rt_default_material();
    RtScene scene;
    uint32_t material;
    RT_TRY(rt_yaml_keys(&r->yaml, n, "path material? transform?"));
    rt_scene_init(&scene);
    scene.warnings = r->scene->warnings; /* lent */
    RtStatus status = rt_scene_add_material(&scene, &standard, &material, r->error);
    if (status == RT_OK) status = append_mesh(r, n, material, &scene);
    if (status == RT_OK) {
        const RtGeometry *g = &scene.geometry;
        status = rt_solid_add_mesh(&r->builder.set, g->triangles, g->triangle_count, NULL, index, r->error);
        status = rt_yaml_place(&r->yaml, status, n, "path");
    }
    r->scene->warnings = scene.warnings;
    scene.warnings = (RtWarnings){0};
    rt_scene_clear(&scene);
    return status;
}

_Static_assert(sizeof(RtTriangle) == 9 * sizeof(float), "a facet is a row of 9");

static RtStatus solid_facets(Reader *r, const RtYamlNode *n, uint32_t *index) {
    RT_ARENA(memory);
    float *rows;
    uint32_t count;
    RT_TRY(rt_yaml_keys(&r->yaml, n, "triangles material?"));
    RT_TRY(rt_yaml_rows(&r->yaml, n, "triangles", 4, 9, &memory, &rows, &count));
    const RtTriangle *facets = (const RtTriangle *)rows;
    RtStatus status = rt_solid_add_mesh(&r->builder.set, facets, count, NULL, index, r->error);
    return rt_yaml_place(&r->yaml, status, n, "triangles");
}

/* A solid as raytally writes it: in object space (solid.h), with its transform. */
static RtStatus solid_standard(Reader *r, const RtYamlNode *n, uint32_t *index) {
    RT_ARENA(memory);
    RtPlane *planes;
    const RtYaml *y = &r->yaml;
    RtSolidSet *set = &r->builder.set;
    RtTransform place = rt_transform_identity();
    double ratio = 1;
    uint32_t kind = 0;
    RT_TRY(rt_yaml_keys(y, n, "kind ratio? place caps? material?"));
    RT_TRY(rt_yaml_word(y, n, "kind", "sphere cone torus", &kind));
    RT_TRY(rt_yaml_double(y, n, "ratio", &ratio));
    RT_TRY(rt_yaml_doubles(y, n, "place", 12, &place.m[0][0]));
    RtStatus status = kind == 0   ? rt_solid_add_sphere(set, &place, index, r->error)
                      : kind == 1 ? rt_solid_add_cone(set, ratio, &place, index, r->error)
                                  : rt_solid_add_torus(set, ratio, &place, index, r->error);
    RT_TRY(rt_yaml_place(y, status, n, NULL));
    const RtYamlNode *caps = rt_yaml_get(y, n, "caps");
    if (!caps) return RT_OK;
    RT_TRY(read_planes(r, caps, 2, &memory, &planes));
    status = rt_solid_set_caps(set, *index, planes, rt_yaml_count(caps), r->error);
    return rt_yaml_place(y, status, caps, NULL);
}

/* ---- formulas ---- */

static RtStatus look_up(void *context, const char *name, RtCsgTerm *term, RtError *error) {
    Reader *r = context;
    const Named *found = find_name(&r->solids, name);
    if (found && found->index < r->solids_known) {
        *term = r->terms[found->index];
        return RT_OK;
    }
    if (found && found->index == r->solids_known)
        return rt_fail(error, RT_BAD_INPUT,
                       "the solid '%s' cannot contain itself: give the part another name", name);
    if (found)
        return rt_fail(error, RT_BAD_INPUT,
                       "the solid '%s' comes after this formula, which can use only earlier solids", name);
    const char *names[64];
    uint32_t count = 0;
    for (uint32_t i = 0; i < r->solids.count && count < 64; i++) {
        if (r->solids.all[i].index < r->solids_known) names[count++] = r->solids.all[i].name;
    }
    char suggestion[RT_MAX_SUGGESTION];
    rt_suggest(name, names, count, suggestion);
    return rt_fail(error, RT_BAD_INPUT, "there is no solid '%s'%s%s", name, suggestion,
                   *suggestion ? "" : ": add it to the list of solids");
}

static RtStatus read_formula(Reader *r, const RtYamlNode *n, RtCsgTerm *term) {
    const char *formula = "";
    RT_TRY(rt_yaml_text(&r->yaml, n, "formula", RT_YAML_MAX_BYTES, &formula));
    RtStatus status = rt_formula_read(formula, &r->builder, look_up, r, term, r->error);
    return rt_yaml_place(&r->yaml, status, n, "formula");
}

static RtStatus move(Reader *r, const RtYamlNode *n, RtVec3d offset, RtCsgTerm *term) {
    RtTransform transform;
    const RtTransform *given;
    RT_TRY(read_transform(r, n, offset, &transform, &given));
    if (!given) return RT_OK;
    return rt_yaml_place(&r->yaml, rt_csg_move(&r->builder, *term, given, term, r->error), n, "transform");
}

/* ---- the list ---- */

#define SOLIDS(X)                                                                                            \
    X(ellipsoid, pair)                                                                                       \
    X(box, pair)                                                                                             \
    X(half_space, pair)                                                                                      \
    X(sphere, sphere)                                                                                        \
    X(cylinder, round)                                                                                       \
    X(cone, round)                                                                                           \
    X(torus, torus) X(polyhedron, polyhedron) X(mesh, mesh) X(facets, facets) X(standard, standard)

/* Adds a solid of any kind. In a scene with an offset, which trees subtract in the end, its points are read
 * relative to the first, and it is moved there in double. */
static RtStatus solid_kind(Reader *r, const RtYamlNode *entry, RtCsgTerm *term) {
    uint32_t index = 0, material = 0;
    const RtYamlNode *n;
    RtTransform place = rt_transform_identity();
    r->yaml.offset = nowhere;
    if (rt_yaml_get(&r->yaml, entry, "formula")) return read_formula(r, entry, term);
#define ADD(kind, function)                                                                                  \
    if ((n = rt_yaml_get(&r->yaml, entry, #kind))) {                                                         \
        RT_TRY(find_material(r, n, &material));                                                              \
        if (has_offset(r)) r->yaml.offset = rt_yaml_first_point(&r->yaml, n);                                \
        RT_TRY(solid_##function(r, n, &index));                                                              \
    }
    SOLIDS(ADD)
#undef ADD
    for (int a = 0; a < 3; a++) place.m[a][3] = r->yaml.offset.at[a];
    RT_TRY(rt_csg_solid(&r->builder, index, material, term, r->error));
    return has_offset(r) ? rt_csg_move(&r->builder, *term, &place, term, r->error) : RT_OK;
}

static RtStatus add_solid(Reader *r, const RtYamlNode *entry, RtCsgTerm *term) {
    const char *name = "";
    RT_TRY(rt_yaml_text(&r->yaml, entry, "name", RT_FORMULA_MAX_NAME - 1, &name));
    if (!rt_formula_is_name(name))
        return rt_yaml_fail(&r->yaml, rt_yaml_get(&r->yaml, entry, "name"),
                            "'%s' is not a valid name in a formula: a name is a letter or _, then letters, "
                            "digits and _",
                            name);
    RT_TRY(solid_kind(r, entry, term));
    return move(r, entry, nowhere, term);
}

static RtStatus add_solids(Reader *r, const RtYamlNode *list) {
    uint32_t count = rt_yaml_count(list);
    RT_TRY(read_names(r, list, "name formula| " SOLIDS(ONE_OF) "transform?", RT_FORMULA_MAX_NAME - 1,
                      "solids", &r->solids));
    r->terms = rt_arena_alloc(&r->memory, count, sizeof *r->terms);
    RT_TRY(rt_arena_check(&r->memory, "the solids", r->error));
    for (const RtYamlNode *n = rt_yaml_first(list); n != rt_yaml_end(list); n += n->size) {
        RT_TRY(add_solid(r, n, &r->terms[r->solids_known]));
        r->solids_known++;
    }
    return RT_OK;
}

/* A CSG tree as one object. */
static RtStatus object_csg(Reader *r, const RtYamlNode *csg) {
    const RtYaml *y = &r->yaml;
    RtCsgTerm term;
    uint32_t extents = 0, material;
    RT_TRY(rt_yaml_keys(y, csg, "formula material? extents? transform?"));
    RT_TRY(rt_yaml_word(y, csg, "extents", "on off", &extents));
    RT_TRY(read_formula(r, csg, &term));
    RT_TRY(move(r, csg, r->scene->offset, &term));
    RtStatus status = rt_scene_add_csg(r->scene, &r->builder, term, extents == 0, r->error);
    RT_TRY(rt_yaml_place(y, status, csg, "formula"));
    if (!rt_yaml_get(y, csg, "material")) return RT_OK;
    RT_TRY(find_material(r, csg, &material));
    rt_scene_paint_csg(r->scene, material);
    return RT_OK;
}

/* ---- objects: each object_... adds one ---- */

static RtStatus object_sphere(Reader *r, const RtYamlNode *n, uint32_t material) {
    RtVec3 center;
    float radius;
    RT_TRY(rt_yaml_sphere(&r->yaml, n, &center, &radius));
    return rt_yaml_place(&r->yaml, rt_scene_add_sphere(r->scene, material, center, radius, r->error), n,
                         radius > 0 ? "center" : "radius");
}

static RtStatus object_polygon(Reader *r, const RtYamlNode *n, uint32_t material) {
    RT_ARENA(memory);
    float *vertices;
    uint32_t count;
    RT_TRY(rt_yaml_keys(&r->yaml, n, "vertices material?"));
    RT_TRY(rt_yaml_rows(&r->yaml, n, "vertices", 3, 3, &memory, &vertices, &count));
    RtStatus status = rt_scene_add_polygon(r->scene, material, (const RtVec3 *)vertices, count, r->error);
    return rt_yaml_place(&r->yaml, status, n, "vertices");
}

static RtStatus object_triangle(Reader *r, const RtYamlNode *n, uint32_t material) {
    const RtYaml *y = &r->yaml;
    RtVec3 v[3] = {{0}}, at_vertices[3] = {{0}};
    RtUv corners[3] = {{0}};
    RT_TRY(rt_yaml_keys(y, n, "vertices normals? uv? material?"));
    const RtYamlNode *normals = rt_yaml_get(y, n, "normals"), *uv = rt_yaml_get(y, n, "uv");
    RT_TRY(rt_yaml_points(y, rt_yaml_get(y, n, "vertices"), false, v));
    RT_TRY(rt_yaml_points(y, normals, true, at_vertices));
    RT_TRY(rt_yaml_corners(y, uv, corners));
    RtStatus status = rt_scene_add_triangle(r->scene, material, v, normals ? at_vertices : NULL, r->error);
    if (status == RT_OK && uv) status = rt_scene_set_triangle_texture(r->scene, corners, r->error);
    return rt_yaml_place(y, status, n, NULL);
}

static RtStatus object_round(Reader *r, const RtYamlNode *n, uint32_t material) {
    RtCone c;
    RT_TRY(rt_yaml_cone(&r->yaml, n, &c));
    RtStatus status =
        rt_scene_add_cone(r->scene, material, c.base, c.base_radius, c.apex, c.apex_radius, r->error);
    return rt_yaml_place(&r->yaml, status, n, NULL);
}

static RtStatus object_mesh(Reader *r, const RtYamlNode *n, uint32_t material) {
    RT_TRY(rt_yaml_keys(&r->yaml, n, "path material? transform?"));
    return append_mesh(r, n, material, r->scene);
}

static RtStatus object_builtin(Reader *r, const RtYamlNode *n) {
    RtTransform transform;
    const RtTransform *given;
    const char *name = "";
    RtScene scene;
    RT_TRY(rt_yaml_keys(&r->yaml, n, "name transform?"));
    RT_TRY(read_transform(r, n, r->scene->offset, &transform, &given));
    RT_TRY(rt_yaml_text(&r->yaml, n, "name", RT_MAX_SCENE_NAME - 1, &name));
    RT_TRY(rt_yaml_place(&r->yaml, r->open_named(name, &scene, r->error), n, "name"));
    RtStatus status = rt_scene_append(r->scene, &scene, given, r->error);
    rt_scene_clear(&scene);
    return rt_yaml_place(&r->yaml, status, n, "transform");
}

/* Objects of one material; a tree may have one for each solid, and a built-in has its own. */
#define PAINTED(X)                                                                                           \
    X(sphere, sphere)                                                                                        \
    X(polygon, polygon) X(triangle, triangle) X(cone, round) X(cylinder, round) X(mesh, mesh)

static RtStatus add_object(Reader *r, const RtYamlNode *entry) {
    const RtYamlNode *n;
    uint32_t material;
    RT_TRY(rt_yaml_keys(&r->yaml, entry, PAINTED(ONE_OF) "csg| builtin|"));
    if ((n = rt_yaml_get(&r->yaml, entry, "csg"))) return object_csg(r, n);
    if ((n = rt_yaml_get(&r->yaml, entry, "builtin"))) return object_builtin(r, n);
#define ADD(kind, function)                                                                                  \
    if ((n = rt_yaml_get(&r->yaml, entry, #kind))) {                                                         \
        RT_TRY(find_material(r, n, &material));                                                              \
        return object_##function(r, n, material);                                                            \
    }
    PAINTED(ADD)
#undef ADD
    return RT_OK;
}

/* ---- parts and instances ---- */

static RtStatus find_part(Reader *r, const RtYamlNode *entry, uint32_t *part) {
    const char *name = "", *known[64];
    uint32_t count = 0;
    RT_TRY(rt_yaml_text(&r->yaml, entry, "part", RT_MAX_NAME - 1, &name));
    const Named *found = find_name(&r->parts, name);
    if (found && found->index < r->whole->part_count) {
        *part = found->index;
        return RT_OK;
    }
    const RtYamlNode *at = rt_yaml_get(&r->yaml, entry, "part");
    if (found)
        return rt_yaml_fail(&r->yaml, at,
                            "the part '%s' is not complete here: a part contains earlier parts only", name);
    for (uint32_t i = 0; i < r->parts.count && count < 64; i++) known[count++] = r->parts.all[i].name;
    char suggestion[RT_MAX_SUGGESTION];
    rt_suggest(name, known, count, suggestion);
    return rt_yaml_fail(&r->yaml, at, "there is no part '%s'%s%s", name, suggestion,
                        *suggestion ? "" : ": add it to the list of parts");
}

static RtStatus add_instance(Reader *r, const RtYamlNode *entry) {
    const RtYaml *y = &r->yaml;
    uint32_t part = 0, material = RT_OWN_MATERIALS;
    RtTransform transform;
    const RtTransform *given;
    RT_TRY(rt_yaml_keys(y, entry, "part transform? place? material?"));
    RT_TRY(find_part(r, entry, &part));
    if (rt_yaml_get(y, entry, "material")) RT_TRY(find_material(r, entry, &material));
    const RtYamlNode *place = rt_yaml_get(y, entry, "place");
    if (place && rt_yaml_get(y, entry, "transform"))
        return rt_yaml_fail(y, place,
                            "`place`, a matrix, and `transform`, a list of steps, say the same: give one");
    RT_TRY(read_transform(r, entry, r->scene->offset, &transform, &given));
    if (place) RT_TRY(rt_yaml_doubles(y, entry, "place", 12, &transform.m[0][0]));
    for (int a = 0; a < 3 && place; a++) transform.m[a][3] -= r->scene->offset.at[a];
    RtStatus status = rt_scene_add_instance(r->scene, r->whole, part, &transform, material, r->error);
    return rt_yaml_place(y, status, entry, place ? "place" : "transform");
}

/* The objects and instances of the scene, or of a part. */
static RtStatus add_content(Reader *r, const RtYamlNode *from) {
    const RtYamlNode *objects = rt_yaml_get(&r->yaml, from, "objects"),
                     *instances = rt_yaml_get(&r->yaml, from, "instances");
    r->yaml.offset = r->scene->offset;
    if (!objects && !instances)
        return rt_yaml_fail(&r->yaml, from,
                            "'objects' is missing: a scene and a part have objects, instances or both");
    RT_TRY(rt_yaml_list(&r->yaml, instances, NULL, rt_yaml_count(objects) ? 0 : 1, UINT32_MAX, "instances"));
    RT_TRY(rt_yaml_list(&r->yaml, objects, NULL, rt_yaml_count(instances) ? 0 : 1, UINT32_MAX, "objects"));
    for (const RtYamlNode *n = rt_yaml_first(objects); n != rt_yaml_end(objects); n += n->size)
        RT_TRY(add_object(r, n));
    for (const RtYamlNode *n = rt_yaml_first(instances); n != rt_yaml_end(instances); n += n->size)
        RT_TRY(add_instance(r, n));
    return RT_OK;
}

/* Gives a part the materials of the scene, at the same indices. Origins of textures do not move with the
 * scene: they are places in the part. */
static RtStatus add_materials_of(Reader *r, RtScene *part) {
    uint32_t same;
    r->yaml.offset = nowhere;
    for (uint32_t i = 0; i < r->whole->material_count; i++) {
        RtMaterial material = r->whole->materials[i];
        const Named *named = has_offset(r) ? find_name(&r->materials, material.name) : NULL;
        const RtYamlNode *texture = named ? rt_yaml_get(&r->yaml, named->node, "texture") : NULL;
        if (texture) material.texture.origin = rt_vec3(0, 0, 0);
        if (texture) RT_TRY(rt_yaml_position(&r->yaml, texture, "origin", &material.texture.origin));
        RT_TRY(rt_scene_add_material(part, &material, &same, r->error));
    }
    return RT_OK;
}

static RtStatus read_part(Reader *r, const RtYamlNode *entry, RtScene *part) {
    const char *name = "";
    RT_TRY(rt_yaml_text(&r->yaml, entry, "name", RT_MAX_NAME - 1, &name));
    memcpy(part->name, name, strlen(name) + 1);
    RT_TRY(add_materials_of(r, part));
    part->warnings = r->whole->warnings; /* lent */
    r->scene = part;
    RtStatus status = add_content(r, entry);
    r->scene = r->whole;
    r->whole->warnings = part->warnings;
    part->warnings = (RtWarnings){0};
    return status;
}

/* The default material comes before the parts, so that these share it. */
static RtStatus add_parts(Reader *r, const RtYamlNode *list) {
    RT_TRY(read_names(r, list, "name objects? instances?", RT_MAX_NAME - 1, "parts", &r->parts));
    if (r->parts.count > 0 && !find_name(&r->materials, "default")) RT_TRY(need_default(r));
    for (const RtYamlNode *n = rt_yaml_first(list); n != rt_yaml_end(list); n += n->size) {
        RtScene part = {0};
        RtStatus status = read_part(r, n, &part);
        if (status != RT_OK) {
            rt_scene_clear(&part);
            return status;
        }
        RT_TRY(rt_scene_add_part(r->whole, &part, r->error));
    }
    return RT_OK;
}

/* ---- the scene ---- */

static RtStatus build(Reader *r) {
    const RtYaml *y = &r->yaml;
    const RtYamlNode *root = y->nodes;
    RT_TRY(rt_yaml_check_format(y));
    RT_TRY(rt_yaml_keys(
        y, root,
        "camera? background? ambient? lights? materials? solids? parts? objects? instances? format?"));
    const RtYamlNode *camera = rt_yaml_get(y, root, "camera");
    r->yaml.offset = r->scene->offset;
    if (camera) RT_TRY(rt_yaml_camera(y, camera, &r->scene->camera));
    RT_TRY(rt_yaml_color(y, root, "background", &r->scene->background));
    RT_TRY(rt_yaml_color(y, root, "ambient", &r->scene->ambient));
    RT_TRY(rt_yaml_lights(y, rt_yaml_get(y, root, "lights"), r->scene));
    RT_TRY(add_materials(r, rt_yaml_get(y, root, "materials")));
    RT_TRY(add_solids(r, rt_yaml_get(y, root, "solids")));
    RT_TRY(add_parts(r, rt_yaml_get(y, root, "parts")));
    return add_content(r, root);
}

/* Builds the scene from the open file, and closes it. */
static RtStatus load(Reader *r) {
    RtStatus status = build(r);
    rt_csg_builder_clear(&r->builder);
    rt_arena_clear(&r->memory);
    rt_yaml_close(&r->yaml);
    return status;
}

RtStatus rt_yaml_load(const char *path, RtSceneOpener *open_named, RtScene *scene, RtError *error) {
    Reader r = {
        .open_named = open_named, .scene = scene, .whole = scene, .standard = UINT32_MAX, .error = error};
    RT_TRY(rt_yaml_open(&r.yaml, path, error));
    return load(&r);
}

RtStatus rt_yaml_load_text(const char *name, const char *text, RtSceneOpener *open_named, RtScene *scene,
                           RtError *error) {
    Reader r = {
        .open_named = open_named, .scene = scene, .whole = scene, .standard = UINT32_MAX, .error = error};
    RT_TRY(rt_yaml_parse(&r.yaml, name, text, strlen(text), error));
    return load(&r);
}
