/* SPDX-License-Identifier: Apache-2.0 */
/* The solids of a YAML scene, and the trees that its formulas make of them. A formula sees only the solids
 * before it, so no solid can contain itself. */
#include "core/base/memory.h"
#include "core/base/words.h"
#include "core/scene/mesh.h"
#include "core/scene/yaml_reader.h"

#include <string.h>

/* ---- solids: add_KIND adds one kind and returns its index in the set ---- */

static RtStatus add_sphere(RtYamlReader *r, const RtYamlNode *n, uint32_t *index) {
    const RtYaml *y = &r->yaml;
    RtVec3 center = {0};
    float radius = 0;
    RT_TRY(rt_yaml_keys(y, n, "center radius material?"));
    RT_TRY(rt_yaml_point(y, n, "center", &center));
    RT_TRY(rt_yaml_float(y, n, "radius", &radius));
    if (!(radius > 0))
        return rt_yaml_fail(y, rt_yaml_get(y, n, "radius"),
                            "a sphere needs a radius above 0, this one has %g", (double)radius);
    RtVec3 radii = rt_vec3(radius, radius, radius);
    return rt_yaml_place(y, rt_solid_add_ellipsoid(&r->builder.set, center, radii, index, r->error), n,
                         "center");
}

typedef RtStatus AddPair(RtSolidSet *set, RtVec3 first, RtVec3 second, uint32_t *index, RtError *error);

/* Adds a solid given by two points or vectors. */
static RtStatus add_pair(RtYamlReader *r, const RtYamlNode *n, const char *first, const char *second,
                         AddPair *add, uint32_t *index) {
    char keys[64];
    RtVec3 pair[2] = {{0}};
    snprintf(keys, sizeof keys, "%s %s material?", first, second);
    RT_TRY(rt_yaml_keys(&r->yaml, n, keys));
    RT_TRY(rt_yaml_point(&r->yaml, n, first, &pair[0]));
    RT_TRY(rt_yaml_point(&r->yaml, n, second, &pair[1]));
    return rt_yaml_place(&r->yaml, add(&r->builder.set, pair[0], pair[1], index, r->error), n, NULL);
}

static RtStatus add_ellipsoid(RtYamlReader *r, const RtYamlNode *n, uint32_t *index) {
    return add_pair(r, n, "center", "radii", rt_solid_add_ellipsoid, index);
}

static RtStatus add_box(RtYamlReader *r, const RtYamlNode *n, uint32_t *index) {
    return add_pair(r, n, "lo", "hi", rt_solid_add_box, index);
}

static RtStatus add_half_space(RtYamlReader *r, const RtYamlNode *n, uint32_t *index) {
    return add_pair(r, n, "point", "normal", rt_solid_add_half_space, index);
}

static RtStatus add_round(RtYamlReader *r, const RtYamlNode *n, bool cylinder, uint32_t *index) {
    RtCone c;
    RT_TRY(rt_yaml_read_cone(&r->yaml, n, cylinder, &c));
    RtStatus status =
        rt_solid_add_frustum(&r->builder.set, c.base, c.base_radius, c.apex, c.apex_radius, index, r->error);
    return rt_yaml_place(&r->yaml, status, n, NULL);
}

static RtStatus add_cone(RtYamlReader *r, const RtYamlNode *n, uint32_t *index) {
    return add_round(r, n, false, index);
}

static RtStatus add_cylinder(RtYamlReader *r, const RtYamlNode *n, uint32_t *index) {
    return add_round(r, n, true, index);
}

static RtStatus add_torus(RtYamlReader *r, const RtYamlNode *n, uint32_t *index) {
    const RtYaml *y = &r->yaml;
    RtVec3 center = {0}, axis = rt_vec3(0, 0, 1);
    float major = 0, minor = 0;
    RT_TRY(rt_yaml_keys(y, n, "center axis? major minor material?"));
    RT_TRY(rt_yaml_point(y, n, "center", &center));
    RT_TRY(rt_yaml_point(y, n, "axis", &axis));
    RT_TRY(rt_yaml_float(y, n, "major", &major));
    RT_TRY(rt_yaml_float(y, n, "minor", &minor));
    RtStatus status = rt_solid_add_ring(&r->builder.set, center, axis, major, minor, index, r->error);
    return rt_yaml_place(y, status, n, NULL);
}

static RtStatus add_planes(RtYamlReader *r, const RtYamlNode *list, uint32_t *index) {
    RT_TRY(rt_yaml_list(&r->yaml, list, NULL, 1, UINT32_MAX, "planes, as in [[0, 0, 1, 2]]"));
    uint32_t count = rt_yaml_count(list), i = 0;
    RtPlane *planes = rt_alloc(count, sizeof *planes);
    if (!planes) return rt_fail_memory(r->error, "the planes of a polyhedron", count * sizeof *planes);
    RtTransform here = rt_transform_identity();
    RtStatus status = RT_OK;
    for (const RtYamlNode *n = list + 1; n != rt_yaml_end(list) && status == RT_OK; n += n->size) {
        double p[4] = {0};
        status = rt_yaml_doubles(&r->yaml, n, NULL, 4, p);
        planes[i++] = (RtPlane){rt_vec3d(p[0], p[1], p[2]), p[3]};
    }
    if (status == RT_OK) {
        status = rt_solid_add_polyhedron(&r->builder.set, planes, count, &here, index, r->error);
        status = rt_yaml_place(&r->yaml, status, list, NULL);
    }
    rt_free(planes);
    return status;
}

static RtStatus add_polyhedron(RtYamlReader *r, const RtYamlNode *n, uint32_t *index) {
    float *vertices;
    uint32_t count;
    RT_TRY(rt_yaml_keys(&r->yaml, n, "vertices| planes| material?"));
    const RtYamlNode *planes = rt_yaml_get(&r->yaml, n, "planes");
    if (planes) return add_planes(r, planes, index);
    RT_TRY(rt_yaml_rows(&r->yaml, n, "vertices", 4, 3, &vertices, &count));
    RtStatus status = rt_solid_add_hull(&r->builder.set, (const RtVec3 *)vertices, count, index, r->error);
    rt_free(vertices);
    return rt_yaml_place(&r->yaml, status, n, "vertices");
}

/* Reads the triangles of a file through a temporary scene. */
static RtStatus add_mesh(RtYamlReader *r, const RtYamlNode *n, uint32_t *index) {
    RtTransform here = rt_transform_identity();
    RtMaterial standard = rt_default_material();
    RtScene scene;
    uint32_t material;
    RT_TRY(rt_yaml_keys(&r->yaml, n, "path material? transform?"));
    rt_scene_init(&scene);
    RtStatus status = rt_scene_add_material(&scene, &standard, &material, r->error);
    if (status == RT_OK) status = rt_yaml_append_mesh(r, n, material, &scene);
    if (status == RT_OK) {
        const RtGeometry *g = &scene.geometry;
        status = rt_solid_add_mesh(&r->builder.set, g->triangles, g->triangle_count, &here, index, r->error);
        status = rt_yaml_place(&r->yaml, status, n, "path");
    }
    rt_scene_clear(&scene);
    return status;
}

_Static_assert(sizeof(RtTriangle) == 9 * sizeof(float), "a facet is a row of 9");

static RtStatus add_facets(RtYamlReader *r, const RtYamlNode *n, uint32_t *index) {
    RtTransform here = rt_transform_identity();
    float *rows;
    uint32_t count;
    RT_TRY(rt_yaml_keys(&r->yaml, n, "triangles material?"));
    RT_TRY(rt_yaml_rows(&r->yaml, n, "triangles", 4, 9, &rows, &count));
    RtStatus status =
        rt_solid_add_mesh(&r->builder.set, (const RtTriangle *)rows, count, &here, index, r->error);
    rt_free(rows);
    return rt_yaml_place(&r->yaml, status, n, "triangles");
}

static RtStatus set_caps(RtYamlReader *r, const RtYamlNode *list, uint32_t index) {
    RtPlane caps[2];
    uint32_t count = 0;
    RT_TRY(rt_yaml_list(&r->yaml, list, NULL, 1, 2, "planes, as in [[0, 0, 1, 2]]"));
    for (const RtYamlNode *n = rt_yaml_first(list); n != rt_yaml_end(list); n += n->size) {
        double p[4] = {0};
        RT_TRY(rt_yaml_doubles(&r->yaml, n, NULL, 4, p));
        caps[count++] = (RtPlane){rt_vec3d(p[0], p[1], p[2]), p[3]};
    }
    return rt_yaml_place(&r->yaml, rt_solid_set_caps(&r->builder.set, index, caps, count, r->error), list,
                         NULL);
}

/* A solid as raytally writes it: in object space (solid.h), with its transform. */
static RtStatus add_standard(RtYamlReader *r, const RtYamlNode *n, uint32_t *index) {
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
    return caps ? set_caps(r, caps, *index) : RT_OK;
}

/* ---- formulas ---- */

static RtStatus look_up(void *context, const char *name, RtCsgTerm *term, RtError *error) {
    RtYamlReader *r = context;
    const RtYamlNamed *found = rt_yaml_find_name(&r->solids, name);
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

static RtStatus read_formula(RtYamlReader *r, const RtYamlNode *n, RtCsgTerm *term) {
    const char *formula = "";
    RT_TRY(rt_yaml_text(&r->yaml, n, "formula", RT_YAML_MAX_BYTES, &formula));
    RtStatus status = rt_formula_read(formula, &r->builder, look_up, r, term, r->error);
    return rt_yaml_place(&r->yaml, status, n, "formula");
}

static RtStatus move(RtYamlReader *r, const RtYamlNode *n, RtCsgTerm *term) {
    RtTransform transform;
    const RtTransform *given;
    RT_TRY(rt_yaml_read_transform(r, n, &transform, &given));
    if (!given) return RT_OK;
    return rt_yaml_place(&r->yaml, rt_csg_move(&r->builder, *term, given, term, r->error), n, "transform");
}

/* ---- the list ---- */

#define SOLIDS(X)                                                                                            \
    X(sphere)                                                                                                \
    X(ellipsoid) X(box) X(cylinder) X(cone) X(torus) X(half_space) X(polyhedron) X(mesh) X(facets) X(standard)

/* Adds a solid of any kind. */
static RtStatus add_kind(RtYamlReader *r, const RtYamlNode *entry, RtCsgTerm *term) {
    uint32_t index = 0, material = 0;
    const RtYamlNode *n;
    if (rt_yaml_get(&r->yaml, entry, "formula")) return read_formula(r, entry, term);
#define ADD(kind)                                                                                            \
    if ((n = rt_yaml_get(&r->yaml, entry, #kind))) {                                                         \
        RT_TRY(rt_yaml_find_material(r, n, &material));                                                      \
        RT_TRY(add_##kind(r, n, &index));                                                                    \
    }
    SOLIDS(ADD)
#undef ADD
    return rt_csg_solid(&r->builder, index, material, term, r->error);
}

static RtStatus add_solid(RtYamlReader *r, const RtYamlNode *entry, RtCsgTerm *term) {
    const char *name = "";
    RT_TRY(rt_yaml_text(&r->yaml, entry, "name", RT_FORMULA_MAX_NAME - 1, &name));
    if (!rt_formula_is_name(name))
        return rt_yaml_fail(&r->yaml, rt_yaml_get(&r->yaml, entry, "name"),
                            "'%s' is not a valid name in a formula: a name is a letter or _, then letters, "
                            "digits and _",
                            name);
    RT_TRY(add_kind(r, entry, term));
    return move(r, entry, term);
}

RtStatus rt_yaml_add_solids(RtYamlReader *r, const RtYamlNode *list) {
    uint32_t count = rt_yaml_count(list);
    RT_TRY(rt_yaml_read_names(r, list, "name formula| " SOLIDS(RT_YAML_ONE_OF) "transform?",
                              RT_FORMULA_MAX_NAME - 1, "solids", &r->solids));
    r->terms = rt_alloc(count, sizeof *r->terms);
    if (!r->terms) return rt_fail_memory(r->error, "the solids", count * sizeof *r->terms);
    for (const RtYamlNode *n = rt_yaml_first(list); n != rt_yaml_end(list); n += n->size) {
        RT_TRY(add_solid(r, n, &r->terms[r->solids_known]));
        r->solids_known++;
    }
    return RT_OK;
}

/* ---- an object ---- */

RtStatus rt_yaml_add_csg(RtYamlReader *r, const RtYamlNode *csg) {
    const RtYaml *y = &r->yaml;
    RtCsgTerm term;
    uint32_t extents = 0, material;
    RT_TRY(rt_yaml_keys(y, csg, "formula material? extents? transform?"));
    RT_TRY(rt_yaml_word(y, csg, "extents", "on off", &extents));
    RT_TRY(read_formula(r, csg, &term));
    RT_TRY(move(r, csg, &term));
    RtStatus status = rt_scene_add_csg(r->scene, &r->builder, term, extents == 0, r->error);
    RT_TRY(rt_yaml_place(y, status, csg, "formula"));
    if (!rt_yaml_get(y, csg, "material")) return RT_OK;
    RT_TRY(rt_yaml_find_material(r, csg, &material));
    rt_scene_paint_csg(r->scene, material);
    return RT_OK;
}
