/* The solids of a YAML scene, and the trees that its formulas make of them. A formula sees the solids that
 * stand before it, so none can contain itself. */
#include "base/memory.h"
#include "base/words.h"
#include "scene/mesh.h"
#include "scene/yaml_reader.h"

#include <string.h>

/* ---- solids: one adder a kind, called add_KIND, which gives the index in the set ---- */

static RtStatus add_sphere(RtYamlReader *r, const RtYamlSphere *sphere, uint32_t *index) {
    float radius = sphere->radius;
    rt_yaml_at(r, radius > 0 ? "center" : "radius");
    if (!(radius > 0)) {
        return rt_fail(r->error, RT_BAD_INPUT, "a sphere needs a radius above 0, this one has %g",
                       (double)radius);
    }
    return rt_solid_add_ellipsoid(&r->builder.set, sphere->center, rt_vec3(radius, radius, radius), index,
                                  r->error);
}

static RtStatus add_ellipsoid(RtYamlReader *r, const RtYamlEllipsoid *e, uint32_t *index) {
    return rt_solid_add_ellipsoid(&r->builder.set, e->center, e->radii, index, r->error);
}

static RtStatus add_box(RtYamlReader *r, const RtYamlBox *box, uint32_t *index) {
    return rt_solid_add_box(&r->builder.set, box->lo, box->hi, index, r->error);
}

static RtStatus add_cone(RtYamlReader *r, const RtYamlCone *cone, uint32_t *index) {
    return rt_solid_add_frustum(&r->builder.set, cone->base, cone->base_radius, cone->apex, cone->apex_radius,
                                index, r->error);
}

static RtStatus add_cylinder(RtYamlReader *r, const RtYamlCylinder *c, uint32_t *index) {
    return rt_solid_add_frustum(&r->builder.set, c->base, c->radius, c->apex, c->radius, index, r->error);
}

static RtStatus add_torus(RtYamlReader *r, const RtYamlTorus *torus, uint32_t *index) {
    RtVec3 axis = torus->axis ? *torus->axis : rt_vec3(0, 0, 1);
    return rt_solid_add_ring(&r->builder.set, torus->center, axis, torus->major, torus->minor, index,
                             r->error);
}

static RtStatus add_half_space(RtYamlReader *r, const RtYamlHalfSpace *half, uint32_t *index) {
    return rt_solid_add_half_space(&r->builder.set, half->point, half->normal, index, r->error);
}

static RtStatus add_planes(RtYamlReader *r, const RtYamlPolyhedron *p, uint32_t *index) {
    RtPlane *planes = rt_alloc(p->planes_count, sizeof *planes);
    if (!planes)
        return rt_fail_memory(r->error, "the planes of a polyhedron", p->planes_count * sizeof *planes);
    for (uint32_t i = 0; i < p->planes_count; i++) {
        const double *given = p->planes[i];
        planes[i] = (RtPlane){rt_vec3d(given[0], given[1], given[2]), given[3]};
    }
    RtTransform here = rt_transform_identity();
    RtStatus status =
        rt_solid_add_polyhedron(&r->builder.set, planes, p->planes_count, &here, index, r->error);
    rt_free(planes);
    return status;
}

static RtStatus add_polyhedron(RtYamlReader *r, const RtYamlPolyhedron *p, uint32_t *index) {
    if (!p->vertices == !p->planes) {
        return rt_fail(
            r->error, RT_BAD_INPUT,
            "a polyhedron is the hull of its vertices or what its planes enclose: give one of the two");
    }
    if (p->planes) return add_planes(r, p, index);
    return rt_solid_add_hull(&r->builder.set, p->vertices, p->vertices_count, index, r->error);
}

/* The triangles of a file, by way of a scene that holds nothing else. */
static RtStatus add_mesh(RtYamlReader *r, const RtYamlMesh *mesh, uint32_t *index) {
    char path[RT_MAX_PATH];
    RtTransform here = rt_transform_identity(), transform;
    RT_TRY(rt_yaml_make_transform(r, mesh->transform, mesh->transform_count, &transform));
    rt_yaml_at(r, "path");
    RT_TRY(rt_yaml_path(r, mesh->path, path));
    RtScene scene;
    uint32_t material;
    rt_scene_init(&scene);
    RtMaterial standard = rt_default_material();
    RtStatus status = rt_scene_add_material(&scene, &standard, &material, r->error);
    if (status == RT_OK) status = rt_mesh_append(&scene, path, material, &transform, r->error);
    if (status == RT_OK) {
        const RtGeometry *g = &scene.geometry;
        status = rt_solid_add_mesh(&r->builder.set, g->triangles, g->triangle_count, &here, index, r->error);
    }
    rt_scene_clear(&scene);
    return status;
}

static RtStatus add_facets(RtYamlReader *r, const RtYamlFacets *f, uint32_t *index) {
    RtTransform here = rt_transform_identity();
    RtTriangle *triangles = rt_alloc(f->triangles_count, sizeof *triangles);
    if (!triangles)
        return rt_fail_memory(r->error, "the triangles of a solid", f->triangles_count * sizeof *triangles);
    for (uint32_t i = 0; i < f->triangles_count; i++) {
        for (int k = 0; k < 9; k++) triangles[i].v[k / 3].at[k % 3] = f->triangles[i][k];
    }
    RtStatus status =
        rt_solid_add_mesh(&r->builder.set, triangles, f->triangles_count, &here, index, r->error);
    rt_free(triangles);
    return status;
}

static RtStatus add_standard(RtYamlReader *r, const RtYamlStandard *given, uint32_t *index) {
    RtTransform place;
    double ratio = given->ratio ? *given->ratio : 1;
    memcpy(place.m, given->place, sizeof place.m);
    if (strcmp(given->kind, "sphere") == 0) {
        return rt_solid_add_sphere(&r->builder.set, &place, index, r->error);
    }
    if (strcmp(given->kind, "cone") == 0) {
        return rt_solid_add_cone(&r->builder.set, ratio, &place, index, r->error);
    }
    if (strcmp(given->kind, "torus") == 0) {
        return rt_solid_add_torus(&r->builder.set, ratio, &place, index, r->error);
    }
    rt_yaml_at(r, "kind");
    return rt_fail(r->error, RT_BAD_INPUT, "there is no standard '%s': they are sphere, cone, torus",
                   given->kind);
}

/* ---- formulas ---- */

static RtStatus look_up(void *context, const char *name, RtCsgTerm *term, RtError *error) {
    RtYamlReader *r = context;
    const RtYamlNamed *found = rt_yaml_find_name(r->solids, r->yaml->solids_count, name);
    if (found && found->index < r->solids_known) {
        *term = r->terms[found->index];
        return RT_OK;
    }
    if (found && found->index == r->solids_known) {
        return rt_fail(error, RT_BAD_INPUT,
                       "the solid '%s' cannot contain itself: give the part a name of its own", name);
    }
    if (found) {
        return rt_fail(error, RT_BAD_INPUT,
                       "the solid '%s' comes after this formula: formulas use what stands before them", name);
    }
    const char *names[64];
    uint32_t count = 0;
    for (; count < r->solids_known && count < 64; count++) names[count] = r->yaml->solids[count].name;
    char suggestion[RT_MAX_SUGGESTION];
    rt_suggest(name, names, count, suggestion);
    return rt_fail(error, RT_BAD_INPUT, "there is no solid '%s'%s%s", name, suggestion,
                   *suggestion ? "" : ": add it to the list of solids");
}

static RtStatus read_formula(RtYamlReader *r, const char *formula, RtCsgTerm *term) {
    rt_yaml_at(r, "formula");
    return rt_formula_read(formula, &r->builder, look_up, r, term, r->error);
}

static RtStatus move(RtYamlReader *r, const RtYamlStep *steps, uint32_t count, RtCsgTerm *term) {
    RtTransform transform;
    if (count == 0) return RT_OK;
    RT_TRY(rt_yaml_make_transform(r, steps, count, &transform));
    rt_yaml_at(r, "transform");
    return rt_csg_move(&r->builder, *term, &transform, term, r->error);
}

/* ---- the list ---- */

/* Adds a solid of the one kind that is given; *kind gets its name. */
static RtStatus add_kind(RtYamlReader *r, const RtYamlSolid *solid, const char **kind, RtCsgTerm *term) {
    uint32_t index = 0, material = 0;
    r->at[0] = '\0';
#define ADD(name, Type)                                                                                      \
    if (solid->name) {                                                                                       \
        *kind = #name;                                                                                       \
        RT_TRY(rt_yaml_find_material(r, solid->name->material, &material));                                  \
        r->at[0] = '\0';                                                                                     \
        RT_TRY(add_##name(r, solid->name, &index));                                                          \
    }
    RT_YAML_SOLIDS(ADD)
#undef ADD
    return rt_csg_solid(&r->builder, index, material, term, r->error);
}

static RtStatus check_solid(RtYamlReader *r, const RtYamlSolid *solid) {
    int given = solid->formula != NULL;
    r->at[0] = '\0';
#define COUNT(name, Type) given += solid->name != NULL;
    RT_YAML_SOLIDS(COUNT)
#undef COUNT
    if (given != 1) {
#define LIST(name, Type) " " #name
        return rt_fail(
            r->error, RT_BAD_INPUT,
            "a solid is one of:" RT_YAML_SOLIDS(LIST) " formula; this entry has %d of them: write one an "
                                                      "entry",
            given);
#undef LIST
    }
    if (rt_formula_is_name(solid->name)) return RT_OK;
    rt_yaml_at(r, "name");
    return rt_fail(
        r->error, RT_BAD_INPUT,
        "'%s' cannot be told apart in a formula: a name is a letter or _, then letters, digits and _",
        solid->name);
}

static RtStatus add_solid(RtYamlReader *r, uint32_t i) {
    const RtYamlSolid *solid = &r->yaml->solids[i];
    const char *kind = NULL;
    RtStatus status = check_solid(r, solid);
    if (status == RT_OK) {
        status = solid->formula ? read_formula(r, solid->formula, &r->terms[i])
                                : add_kind(r, solid, &kind, &r->terms[i]);
    }
    if (status == RT_OK) {
        kind = NULL;
        status = move(r, solid->transform, solid->transform_count, &r->terms[i]);
    }
    char below[sizeof r->at + 16];
    snprintf(below, sizeof below, "%s%s%s", kind ? "." : "", kind ? kind : "", r->at);
    return rt_yaml_place(r, status, "solids", i, below);
}

RtStatus rt_yaml_add_solids(RtYamlReader *r) {
    uint32_t count = r->yaml->solids_count;
    for (uint32_t i = 0; i < count; i++) r->solids[i] = (RtYamlNamed){r->yaml->solids[i].name, i};
    RT_TRY(rt_yaml_sort_names(r, r->solids, count, "solids", "solids"));
    for (; r->solids_known < count; r->solids_known++) RT_TRY(add_solid(r, r->solids_known));
    return RT_OK;
}

/* ---- an object ---- */

static RtStatus read_extents(RtYamlReader *r, const char *text, bool *extents) {
    rt_yaml_at(r, "extents");
    *extents = !text || strcmp(text, "on") == 0;
    if (*extents || strcmp(text, "off") == 0) return RT_OK;
    return rt_fail(r->error, RT_BAD_INPUT, "extents are on or off, not '%.60s'", text);
}

RtStatus rt_yaml_add_csg(RtYamlReader *r, const RtYamlCsg *csg) {
    RtCsgTerm term;
    bool extents;
    RT_TRY(read_extents(r, csg->extents, &extents));
    RT_TRY(read_formula(r, csg->formula, &term));
    RT_TRY(move(r, csg->transform, csg->transform_count, &term));
    rt_yaml_at(r, "formula");
    RT_TRY(rt_scene_add_csg(r->scene, &r->builder, term, extents, r->error));
    if (!csg->material[0]) return RT_OK;
    uint32_t material;
    RT_TRY(rt_yaml_find_material(r, csg->material, &material));
    rt_scene_paint_csg(r->scene, material);
    return RT_OK;
}
