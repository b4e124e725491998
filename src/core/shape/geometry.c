/* SPDX-License-Identifier: Apache-2.0 */
#include "core/shape/geometry.h"

#include "core/base/memory.h"

#include <assert.h>
#include <string.h>

const char *rt_shape_name(RtShape shape) {
    static const char *const names[RT_SHAPE_COUNT] = {
#define NAME(CONSTANT, name, Type) #name,
        RT_SHAPES(NAME)
#undef NAME
    };
    assert(shape < RT_SHAPE_COUNT);
    return names[shape];
}

/* ---- adding objects ---- */

static RtStatus check_point(RtVec3 p, RtError *error) {
    if (!rt_finite(p))
        return rt_fail(error, RT_BAD_INPUT, "a coordinate is not a finite number: (%g, %g, %g)", (double)p.x,
                       (double)p.y, (double)p.z);
    float most = rt_maxf(fabsf(p.x), rt_maxf(fabsf(p.y), fabsf(p.z)));
    if (most > RT_MAX_COORDINATE)
        return rt_fail(error, RT_BAD_INPUT, "a coordinate of %g exceeds %g: scale the scene down",
                       (double)most, (double)RT_MAX_COORDINATE);
    return RT_OK;
}

static RtStatus check_radius(float radius, RtError *error) {
    if (isfinite(radius) && radius <= RT_MAX_COORDINATE) return RT_OK;
    return rt_fail(error, RT_BAD_INPUT, "a radius of %g is not between 0 and %g", (double)radius,
                   (double)RT_MAX_COORDINATE);
}

/* Makes space for one more entry in the table of objects. */
static RtStatus reserve_object(RtGeometry *g, RtError *error) {
    if (g->object_count >= RT_MAX_OBJECTS)
        return rt_fail(error, RT_BAD_INPUT, "a scene holds at most %u objects", RT_MAX_OBJECTS);
    return rt_reserve(&g->objects, &g->object_capacity, (uint64_t)g->object_count + 1, sizeof(RtRef), error);
}

/* Two functions per shape: one makes all the space that an object needs, before anything changes; the
 * other also appends a checked object. */
#define DEFINE_APPEND(CONSTANT, name, Type)                                                                  \
    static RtStatus reserve_##name(RtGeometry *g, RtError *error) {                                          \
        uint64_t needed = (uint64_t)g->name##_count + 1;                                                     \
        RT_TRY(reserve_object(g, error));                                                                    \
        RT_TRY(rt_reserve(&g->name##s, &g->name##_capacity, needed, sizeof(Type), error));                   \
        return rt_reserve(&g->name##_ids, &g->name##_id_capacity, needed, sizeof(uint32_t), error);          \
    }                                                                                                        \
    static RtStatus append_##name(RtGeometry *g, const Type *object, RtError *error) {                       \
        RT_TRY(reserve_##name(g, error));                                                                    \
        g->objects[g->object_count] = rt_ref(RT_SHAPE_##CONSTANT, g->name##_count);                          \
        g->name##_ids[g->name##_count] = g->object_count++;                                                  \
        g->name##s[g->name##_count++] = *object;                                                             \
        return RT_OK;                                                                                        \
    }
RT_SHAPES(DEFINE_APPEND)
#undef DEFINE_APPEND

RtStatus rt_geometry_add_sphere(RtGeometry *geometry, RtVec3 center, float radius, RtError *error) {
    RT_TRY(check_point(center, error));
    RT_TRY(check_radius(radius, error));
    if (!(radius > 0))
        return rt_fail(error, RT_BAD_INPUT, "a sphere needs a radius above 0, this one has %g",
                       (double)radius);
    return append_sphere(geometry, &(RtSphere){center, radius}, error);
}

RtStatus rt_geometry_add_polygon(RtGeometry *geometry, const RtVec3 *vertices, uint32_t count,
                                 RtError *error) {
    for (uint32_t i = 0; i < count; i++) RT_TRY(check_point(vertices[i], error));
    RtPolygon polygon;
    uint32_t first = geometry->polygon_vertex_count;
    RT_TRY(rt_polygon_init(&polygon, vertices, first, count, error));
    RT_TRY(rt_reserve(&geometry->polygon_vertices, &geometry->polygon_vertex_capacity,
                      (uint64_t)first + count, sizeof(RtVec3), error));
    RT_TRY(append_polygon(geometry, &polygon, error));
    memcpy(geometry->polygon_vertices + first, vertices, count * sizeof(RtVec3));
    geometry->polygon_vertex_count += count;
    return RT_OK;
}

RtStatus rt_geometry_add_cone(RtGeometry *geometry, RtVec3 base, float base_radius, RtVec3 apex,
                              float apex_radius, RtError *error) {
    RT_TRY(check_point(base, error));
    RT_TRY(check_point(apex, error));
    RT_TRY(check_radius(base_radius, error));
    RT_TRY(check_radius(apex_radius, error));
    RtCone cone;
    RT_TRY(rt_cone_init(&cone, base, base_radius, apex, apex_radius, error));
    return append_cone(geometry, &cone, error);
}

RtStatus rt_geometry_add_csg(RtGeometry *geometry, const RtCsgBuilder *builder, RtCsgTerm root, bool extents,
                             RtError *error) {
    RtCsg tree;
    RT_TRY(reserve_csg(geometry, error));
    RT_TRY(rt_csg_compile(&geometry->forest, builder, root, extents, &tree, error));
    return append_csg(geometry, &tree, error);
}

RtStatus rt_geometry_copy_csg(RtGeometry *geometry, const RtGeometry *from, uint32_t index,
                              const RtTransform *move, RtError *error) {
    RtCsg tree;
    RT_TRY(reserve_csg(geometry, error));
    RT_TRY(rt_csg_copy(&geometry->forest, &from->forest, &from->csgs[index], move, &tree, error));
    return append_csg(geometry, &tree, error);
}

/* Makes triangle_normals as long as the array of triangles; new entries are RT_NO_NORMALS. */
static RtStatus reserve_triangle_normals(RtGeometry *g, uint64_t needed, RtError *error) {
    uint32_t before = g->triangle_normal_capacity;
    RT_TRY(rt_reserve(&g->triangle_normals, &g->triangle_normal_capacity, needed, sizeof(uint32_t), error));
    for (uint32_t i = before; i < g->triangle_normal_capacity; i++) g->triangle_normals[i] = RT_NO_NORMALS;
    return RT_OK;
}

/* Keeps a unit normal bit for bit, so that scenes survive saving and loading. */
static RtVec3 unit_normal(RtVec3 normal) {
    RtVec3d n = rt_widen(normal);
    return fabs(rt_dotd(n, n) - 1) <= 0x1p-22 ? normal : rt_narrow(rt_normalized(n));
}

RtStatus rt_geometry_add_triangle(RtGeometry *geometry, const RtVec3 vertices[3], const RtVec3 *normals,
                                  RtError *error) {
    for (int i = 0; i < 3; i++) RT_TRY(check_point(vertices[i], error));
    RtTriangle triangle = {{vertices[0], vertices[1], vertices[2]}};
    uint32_t index = geometry->triangle_count;
    RtVertexNormals unit = {{{0, 0, 0}, {0, 0, 0}, {0, 0, 0}}};
    for (int i = 0; normals && i < 3; i++) {
        if (!rt_finite(normals[i]) || rt_lengthd(rt_widen(normals[i])) == 0)
            return rt_fail(error, RT_BAD_INPUT, "vertex normal %d is zero or not finite: (%g, %g, %g)", i,
                           (double)normals[i].x, (double)normals[i].y, (double)normals[i].z);
        unit.n[i] = unit_normal(normals[i]);
    }
    if (normals || geometry->triangle_normals)
        RT_TRY(reserve_triangle_normals(geometry, (uint64_t)index + 1, error));
    if (normals)
        RT_TRY(rt_reserve(&geometry->vertex_normals, &geometry->vertex_normal_capacity,
                          (uint64_t)geometry->vertex_normal_count + 1, sizeof(RtVertexNormals), error));
    RT_TRY(append_triangle(geometry, &triangle, error));
    if (normals) {
        geometry->triangle_normals[index] = geometry->vertex_normal_count;
        geometry->vertex_normals[geometry->vertex_normal_count++] = unit;
    }
    return RT_OK;
}

/* ---- finishing and clearing ---- */

static RtBox object_box(const RtGeometry *g, RtRef ref) {
    uint32_t index = rt_ref_index(ref);
    switch (rt_ref_shape(ref)) {
    case RT_SHAPE_SPHERE: return rt_sphere_box(&g->spheres[index]);
    case RT_SHAPE_POLYGON: return rt_polygon_box(&g->polygons[index], rt_polygon_vertices(g, index));
    case RT_SHAPE_TRIANGLE: return rt_triangle_box(&g->triangles[index]);
    case RT_SHAPE_CONE: return rt_cone_box(&g->cones[index]);
    case RT_SHAPE_CSG: return g->csgs[index].box;
    case RT_SHAPE_COUNT: break;
    }
    assert(false && "no such shape");
    return RT_EMPTY_BOX;
}

/* Scenes are kept for long, and accelerators need the memory. */
static void trim_arrays(RtGeometry *g) {
    rt_trim(&g->objects, g->object_count, &g->object_capacity, sizeof(RtRef));
#define TRIM(CONSTANT, name, Type)                                                                           \
    rt_trim(&g->name##s, g->name##_count, &g->name##_capacity, sizeof(Type));                                \
    rt_trim(&g->name##_ids, g->name##_count, &g->name##_id_capacity, sizeof(uint32_t));
    RT_SHAPES(TRIM)
#undef TRIM
    rt_trim(&g->polygon_vertices, g->polygon_vertex_count, &g->polygon_vertex_capacity, sizeof(RtVec3));
    if (g->triangle_normals)
        rt_trim(&g->triangle_normals, g->triangle_count, &g->triangle_normal_capacity, sizeof(uint32_t));
    rt_trim(&g->vertex_normals, g->vertex_normal_count, &g->vertex_normal_capacity, sizeof(RtVertexNormals));
}

RtStatus rt_geometry_finish(RtGeometry *geometry, RtError *error) {
    assert(!geometry->boxes);
    trim_arrays(geometry);
    geometry->boxes = rt_alloc(geometry->object_count, sizeof(RtBox));
    if (!geometry->boxes)
        return rt_fail_memory(error, "the boxes of the objects", geometry->object_count * sizeof(RtBox));
    geometry->box = RT_EMPTY_BOX;
    for (uint32_t id = 0; id < geometry->object_count; id++) {
        geometry->boxes[id] = object_box(geometry, geometry->objects[id]);
        geometry->box = rt_box_union(geometry->box, geometry->boxes[id]);
    }
    return RT_OK;
}

uint64_t rt_geometry_bytes(const RtGeometry *geometry) {
    const RtGeometry *g = geometry;
    uint64_t bytes = (uint64_t)g->object_capacity * sizeof *g->objects;
#define ADD_BYTES(CONSTANT, name, Type)                                                                      \
    bytes += (uint64_t)g->name##_capacity * sizeof(Type);                                                    \
    bytes += (uint64_t)g->name##_id_capacity * sizeof(uint32_t);
    RT_SHAPES(ADD_BYTES)
#undef ADD_BYTES
    bytes += (uint64_t)g->polygon_vertex_capacity * sizeof *g->polygon_vertices;
    bytes += (uint64_t)g->triangle_normal_capacity * sizeof *g->triangle_normals;
    bytes += (uint64_t)g->vertex_normal_capacity * sizeof *g->vertex_normals;
    bytes += rt_csg_forest_bytes(&g->forest);
    return bytes + (g->boxes ? (uint64_t)g->object_count * sizeof *g->boxes : 0);
}

void rt_geometry_clear(RtGeometry *geometry) {
    rt_free(geometry->objects);
#define FREE_ARRAYS(CONSTANT, name, Type)                                                                    \
    rt_free(geometry->name##s);                                                                              \
    rt_free(geometry->name##_ids);
    RT_SHAPES(FREE_ARRAYS)
#undef FREE_ARRAYS
    rt_free(geometry->polygon_vertices);
    rt_free(geometry->triangle_normals);
    rt_free(geometry->vertex_normals);
    rt_csg_forest_clear(&geometry->forest);
    rt_free(geometry->boxes);
    *geometry = (RtGeometry){0};
}

/* ---- scratch memory of hit functions ---- */

RtStatus rt_crossings_alloc(const RtGeometry *geometry, RtCrossing **crossings, RtError *error) {
    uint32_t most = 0;
    *crossings = NULL;
    for (uint32_t i = 0; i < geometry->csg_count; i++) {
        if (geometry->csgs[i].most_crossings > most) most = geometry->csgs[i].most_crossings;
    }
    if (geometry->csg_count > 0 && most < UINT32_MAX) *crossings = rt_alloc(most, sizeof(RtCrossing));
    if (geometry->csg_count == 0 || *crossings) return RT_OK;
    return rt_fail_memory(error, "the crossings of a ray with a CSG tree", most * sizeof(RtCrossing));
}

/* ---- normals and extents ---- */

static RtVec3d interpolated_normal(const RtGeometry *g, uint32_t index, RtVec3d point, RtVec3d geometric) {
    uint32_t entry = g->triangle_normals ? g->triangle_normals[index] : RT_NO_NORMALS;
    if (entry == RT_NO_NORMALS) return geometric;
    const RtVec3 *n = g->vertex_normals[entry].n;
    RtVec3d w = rt_triangle_weights(&g->triangles[index], point);
    RtVec3d sum = rt_scaled(rt_widen(n[0]), w.x);
    sum = rt_add_scaledd(sum, rt_widen(n[1]), w.y);
    sum = rt_add_scaledd(sum, rt_widen(n[2]), w.z);
    return rt_lengthd(sum) > 0 ? rt_normalized(sum) : geometric;
}

static RtNormals csg_normals(const RtGeometry *g, uint32_t index, const RtRay *ray, float t,
                             RtCrossing *crossings) {
    RtPreparedRay prepared;
    rt_hit_ray(&prepared, g, ray, crossings);
    RtCsgFacet facet = rt_csg_facet(&g->forest, &g->csgs[index], &prepared, t);
    return (RtNormals){facet.normal, facet.normal, facet.solid};
}

RtNormals rt_object_normals(const RtGeometry *geometry, uint32_t id, const RtRay *ray, float t,
                            RtCrossing *crossings) {
    uint32_t index = rt_ref_index(geometry->objects[id]);
    RtVec3d point = rt_ray_point(ray, t), normal = {0, 0, 0};
    switch (rt_ref_shape(geometry->objects[id])) {
    case RT_SHAPE_SPHERE: normal = rt_sphere_normal(&geometry->spheres[index], point); break;
    case RT_SHAPE_POLYGON: normal = geometry->polygons[index].normal; break;
    case RT_SHAPE_CONE: normal = rt_cone_normal(&geometry->cones[index], point); break;
    case RT_SHAPE_TRIANGLE:
        normal = rt_triangle_normal(&geometry->triangles[index]);
        return (RtNormals){normal, interpolated_normal(geometry, index, point, normal), RT_NO_SOLID};
    case RT_SHAPE_CSG: return csg_normals(geometry, index, ray, t, crossings);
    case RT_SHAPE_COUNT: break;
    }
    return (RtNormals){normal, normal, RT_NO_SOLID};
}

RtBall rt_object_ball(const RtGeometry *geometry, uint32_t id) {
    uint32_t index = rt_ref_index(geometry->objects[id]);
    switch (rt_ref_shape(geometry->objects[id])) {
    case RT_SHAPE_SPHERE: return rt_sphere_ball(&geometry->spheres[index]);
    case RT_SHAPE_POLYGON:
        return rt_polygon_ball(&geometry->polygons[index], rt_polygon_vertices(geometry, index));
    case RT_SHAPE_TRIANGLE: return rt_triangle_ball(&geometry->triangles[index]);
    case RT_SHAPE_CONE: return rt_cone_ball(&geometry->cones[index]);
    case RT_SHAPE_CSG: return geometry->csgs[index].ball;
    case RT_SHAPE_COUNT: break;
    }
    assert(false && "no such shape");
    return (RtBall){{0, 0, 0}, 0};
}

double rt_object_support(const RtGeometry *geometry, uint32_t id, RtVec3d direction) {
    uint32_t index = rt_ref_index(geometry->objects[id]);
    switch (rt_ref_shape(geometry->objects[id])) {
    case RT_SHAPE_SPHERE: return rt_sphere_support(&geometry->spheres[index], direction);
    case RT_SHAPE_POLYGON:
        return rt_polygon_support(&geometry->polygons[index], rt_polygon_vertices(geometry, index),
                                  direction);
    case RT_SHAPE_TRIANGLE: return rt_triangle_support(&geometry->triangles[index], direction);
    case RT_SHAPE_CONE: return rt_cone_support(&geometry->cones[index], direction);
    case RT_SHAPE_CSG: return rt_csg_support(&geometry->forest, &geometry->csgs[index], direction);
    case RT_SHAPE_COUNT: break;
    }
    assert(false && "no such shape");
    return 0;
}

/* The longest edge of a closed chain of vertices. */
static RtVec3d longest_edge(const RtVec3 *vertices, uint32_t count) {
    RtVec3d best = {0, 0, 0};
    for (uint32_t i = 0; i < count; i++) {
        RtVec3d edge = rt_subd(rt_widen(vertices[(i + 1) % count]), rt_widen(vertices[i]));
        if (rt_dotd(edge, edge) > rt_dotd(best, best)) best = edge;
    }
    return best;
}

/* The longest axis of a tree's largest solid, and another one; of a polyhedron, two normals. */
static void csg_axes(const RtGeometry *g, const RtCsg *tree, RtVec3d *main, RtVec3d *normal) {
    const RtSolidSet *set = &g->forest.set;
    double largest = -1;
    for (uint32_t i = 0; i < tree->solid_count; i++) {
        const RtSolid *solid = &set->solids[tree->first_solid + i];
        double area = rt_box_half_area(solid->box);
        if (solid->subtracted || !isfinite(area) || area <= largest) continue;
        largest = area;
        if (solid->kind == RT_SOLID_POLYHEDRON) {
            *main = set->planes[solid->first].normal;
            *normal = set->planes[solid->first + solid->count - 1].normal;
            continue;
        }
        *main = *normal = rt_vec3d(0, 0, 0);
        for (int a = 0; a < 3; a++) {
            RtVec3d axis = rt_transform_column(&solid->to_world, a);
            bool longer = rt_dotd(axis, axis) > rt_dotd(*main, *main);
            *normal = rt_normalized(longer ? *main : axis);
            if (longer) *main = axis;
        }
    }
}

void rt_object_frame(const RtGeometry *geometry, uint32_t id, RtVec3d axes[3]) {
    uint32_t index = rt_ref_index(geometry->objects[id]);
    RtVec3d main = {1, 0, 0}, normal = {0, 0, 1};
    switch (rt_ref_shape(geometry->objects[id])) {
    case RT_SHAPE_TRIANGLE:
        main = longest_edge(geometry->triangles[index].v, 3);
        normal = rt_triangle_normal(&geometry->triangles[index]);
        break;
    case RT_SHAPE_POLYGON: {
        const RtPolygon *polygon = &geometry->polygons[index];
        main = longest_edge(rt_polygon_vertices(geometry, index), polygon->count);
        normal = polygon->normal;
        break;
    }
    case RT_SHAPE_CONE: main = geometry->cones[index].axis; break;
    case RT_SHAPE_CSG: csg_axes(geometry, &geometry->csgs[index], &main, &normal); break;
    case RT_SHAPE_SPHERE:
    case RT_SHAPE_COUNT: break;
    }
    if (rt_dotd(main, main) == 0) main = rt_vec3d(1, 0, 0);
    main = rt_normalized(main);
    /* Gram-Schmidt, starting from a candidate that is not along the main axis. */
    RtVec3d candidates[4] = {normal, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    for (int i = 0; i < 4; i++) {
        RtVec3d rest = rt_add_scaledd(candidates[i], main, -rt_dotd(candidates[i], main));
        if (rt_lengthd(rest) < 0.5) continue;
        axes[0] = main;
        axes[1] = rt_normalized(rest);
        axes[2] = rt_crossd(axes[0], axes[1]);
        return;
    }
    assert(false && "one of three axes is always far enough from any direction");
}
