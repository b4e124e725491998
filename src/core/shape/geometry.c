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
static RtStatus reserve_object(RtGeometry *g, RtShape shape, RtError *error) {
    if (g->instance_count > 0 && shape != RT_SHAPE_INSTANCE)
        return rt_fail(error, RT_BAD_INPUT, "instances come after all other objects");
    if (g->object_count >= RT_MAX_OBJECTS)
        return rt_fail(error, RT_BAD_INPUT, "a scene holds at most %u objects", RT_MAX_OBJECTS);
    return rt_reserve(&g->objects, &g->object_capacity, (uint64_t)g->object_count + 1, sizeof(RtRef), error);
}

/* Two functions per shape: one makes all the space that an object needs, before anything changes; the
 * other also appends a checked object. */
#define DEFINE_APPEND(CONSTANT, name, Type)                                                                  \
    static RtStatus reserve_##name(RtGeometry *g, RtError *error) {                                          \
        uint64_t needed = (uint64_t)g->name##_count + 1;                                                     \
        RT_TRY(reserve_object(g, RT_SHAPE_##CONSTANT, error));                                               \
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

/* Newell's normal: twice the area of the polygon along its normal, about vertex 0 for precision. */
static RtVec3d newell(const RtVec3 *vertices, uint32_t count) {
    RtVec3d sum = {0, 0, 0}, origin = rt_widen(vertices[0]);
    for (uint32_t i = 1; i + 1 < count; i++)
        sum = rt_addd(sum, rt_area_vector(origin, rt_widen(vertices[i]), rt_widen(vertices[i + 1])));
    return sum;
}

/* Of vertices[0..count): its plane and projection. */
static RtStatus make_polygon(const RtVec3 *vertices, uint32_t first, uint32_t count, RtPolygon *polygon,
                             RtError *error) {
    if (count < 3)
        return rt_fail(error, RT_BAD_INPUT, "a polygon needs at least 3 vertices, this one has %u", count);
    RtVec3d sum = newell(vertices, count), first_vertex = rt_widen(vertices[0]), offset = {0, 0, 0};
    RtBox box = RT_EMPTY_BOX;
    for (uint32_t i = 0; i < count; i++) {
        offset = rt_addd(offset, rt_subd(rt_widen(vertices[i]), first_vertex));
        box = rt_box_add_point(box, vertices[i]);
    }
    RtVec3d center = rt_add_scaledd(first_vertex, offset, 1.0 / count);
    double size = rt_lengthd(rt_widen(rt_box_size(box)));
    double area = rt_lengthd(sum) / 2;
    if (!(area > 1e-12 * size * size))
        return rt_fail(error, RT_BAD_INPUT,
                       "the polygon has no area: its vertices lie on a line or in a point; remove it");
    RtVec3d normal = rt_normalized(sum);
    double warp = 0;
    for (uint32_t i = 0; i < count; i++) {
        double off = fabs(rt_dotd(normal, rt_subd(rt_widen(vertices[i]), center)));
        if (off > warp) warp = off; /* gcc 12 for ARM fails to compile fmax here, and below */
    }
    if (warp > RT_POLYGON_MAX_WARP * size)
        return rt_fail(
            error, RT_BAD_INPUT,
            "the polygon is not planar: a vertex is %.3g off the plane of the others; split it into "
            "triangles",
            warp);
    int dropped = rt_major_axis(rt_narrow(normal));
    *polygon = (RtPolygon){.normal = normal,
                           .center = center,
                           .first = first,
                           .count = count,
                           .u = dropped == 0 ? 1 : 0,
                           .v = dropped == 2 ? 1 : 2,
                           .warp = rt_float_above(warp / fabs(normal.at[dropped]))};
    return RT_OK;
}

RtStatus rt_geometry_add_polygon(RtGeometry *geometry, const RtVec3 *vertices, uint32_t count,
                                 RtError *error) {
    for (uint32_t i = 0; i < count; i++) RT_TRY(check_point(vertices[i], error));
    RtPolygon polygon;
    uint32_t first = geometry->polygon_vertex_count;
    RT_TRY(make_polygon(vertices, first, count, &polygon, error));
    RT_TRY(rt_reserve(&geometry->polygon_vertices, &geometry->polygon_vertex_capacity,
                      (uint64_t)first + count, sizeof(RtVec3), error));
    RT_TRY(append_polygon(geometry, &polygon, error));
    memcpy(geometry->polygon_vertices + first, vertices, count * sizeof(RtVec3));
    geometry->polygon_vertex_count += count;
    return RT_OK;
}

RtStatus rt_cone_init(RtCone *cone, RtVec3 base, float base_radius, RtVec3 apex, float apex_radius,
                      RtError *error) {
    if (!(base_radius >= 0) || !(apex_radius >= 0) || (base_radius == 0 && apex_radius == 0))
        return rt_fail(error, RT_BAD_INPUT,
                       "a cone needs radii of at least 0, one of them above 0; these are %g and %g",
                       (double)base_radius, (double)apex_radius);
    RtVec3d axis = rt_subd(rt_widen(apex), rt_widen(base));
    double height = rt_lengthd(axis);
    if (!(height > 0))
        return rt_fail(error, RT_BAD_INPUT, "the two ends of the cone are the same point: move one of them");
    *cone = (RtCone){.base = base,
                     .apex = apex,
                     .base_radius = base_radius,
                     .apex_radius = apex_radius,
                     .axis = rt_normalized(axis),
                     .middle = rt_scaled(rt_addd(rt_widen(base), rt_widen(apex)), 0.5),
                     .height = height,
                     .slope = ((double)apex_radius - (double)base_radius) / height};
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

uint32_t rt_geometry_id_count(const RtGeometry *geometry) {
    if (geometry->instance_count == 0) return geometry->object_count;
    const RtInstance *last = &geometry->instances[geometry->instance_count - 1];
    return last->first + rt_geometry_id_count(last->geometry);
}

uint32_t rt_geometry_holder(const RtGeometry *geometry, uint32_t id) {
    uint32_t plain = geometry->object_count - geometry->instance_count, low = 0,
             high = geometry->instance_count;
    if (id < plain) return id;
    while (high - low > 1) { /* the last that begins at or before it */
        const uint32_t middle = low + (high - low) / 2;
        if (geometry->instances[middle].first <= id)
            low = middle;
        else
            high = middle;
    }
    return plain + low;
}

RtShape rt_geometry_shape(const RtGeometry *geometry, uint32_t id) {
    const uint32_t object = rt_geometry_holder(geometry, id);
    if (!rt_is_instance(geometry, object)) return rt_ref_shape(geometry->objects[object]);
    const RtInstance *instance = rt_instance_of(geometry, object);
    return rt_geometry_shape(instance->geometry, id - instance->first);
}

/* Of a ray with the largest CSG tree of a geometry and its parts. */
static uint32_t most_crossings(const RtGeometry *geometry) {
    uint32_t most = geometry->part_crossings;
    for (uint32_t i = 0; i < geometry->csg_count; i++) {
        if (geometry->csgs[i].most_crossings > most) most = geometry->csgs[i].most_crossings;
    }
    return most;
}

RtStatus rt_geometry_measure_reach(RtGeometry *part, RtError *error) {
    part->reach = rt_alloc(RT_REACHES, sizeof *part->reach);
    if (!part->reach) return rt_fail_memory(error, "the reach of a part", RT_REACHES * sizeof *part->reach);
    for (int i = 0; i < RT_REACHES; i++) {
        const int x = i / 9 - 1, y = i / 3 % 3 - 1, z = i % 3 - 1;
        const RtVec3d direction = {{x, y, z}};
        part->reach[i] = -(double)INFINITY;
        for (uint32_t id = 0; id < part->object_count; id++)
            part->reach[i] = fmax(part->reach[i], rt_object_support(part, id, direction));
    }
    return RT_OK;
}

RtStatus rt_geometry_add_instance(RtGeometry *geometry, const RtGeometry *part, uint32_t part_index,
                                  const RtTransform *to_world, RtError *error) {
    const uint64_t ids = (uint64_t)rt_geometry_id_count(geometry) + rt_geometry_id_count(part);
    RtInstance instance = {
        .to_world = *to_world, .geometry = part, .part = part_index, .first = rt_geometry_id_count(geometry)};
    assert(part->boxes);
    if (ids > UINT32_MAX - 2)
        return rt_fail(error, RT_BAD_INPUT, "the instances amount to more than 4e9 objects");
    if (part->nesting >= RT_MAX_NESTING)
        return rt_fail(error, RT_BAD_INPUT, "instances are nested in more than %d levels", RT_MAX_NESTING);
    RtTransform to_part;
    RT_TRY(rt_transform_invert(to_world, &to_part, error));
    for (int column = 0; column < 4; column++) {
        for (int row = 0; row < 3; row++) instance.columns[column][row] = to_part.m[row][column];
    }
    if (part->object_count == 0) return RT_OK; /* it would have no box */
    const RtBox box = rt_moved_box(&part->box, to_world);
    RT_TRY(check_point(box.lo, error));
    RT_TRY(check_point(box.hi, error));
    RT_TRY(append_instance(geometry, &instance, error));
    const uint32_t crossings = most_crossings(part);
    if (part->nesting + 1 > geometry->nesting) geometry->nesting = part->nesting + 1;
    if (crossings > geometry->part_crossings) geometry->part_crossings = crossings;
    return RT_OK;
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

/* X(array, count, capacity) for each growing array but those of the forest. */
#define OF_SHAPE(CONSTANT, name, Type)                                                                       \
    X(name##s, name##_count, name##_capacity)                                                                \
    X(name##_ids, name##_count, name##_id_capacity)
#define ARRAYS                                                                                               \
    X(objects, object_count, object_capacity)                                                                \
    RT_SHAPES(OF_SHAPE)                                                                                      \
    X(polygon_vertices, polygon_vertex_count, polygon_vertex_capacity)                                       \
    X(triangle_normals, triangle_count, triangle_normal_capacity)                                            \
    X(vertex_normals, vertex_normal_count, vertex_normal_capacity)

/* Scenes are kept for long, and accelerators need the memory. */
static void trim_arrays(RtGeometry *g) {
#define X(array, count, capacity)                                                                            \
    if (g->array) rt_trim(&g->array, g->count, &g->capacity, sizeof *g->array);
    ARRAYS
#undef X
}

RtStatus rt_geometry_finish(RtGeometry *geometry, RtError *error) {
    assert(!geometry->boxes);
    trim_arrays(geometry);
    geometry->boxes = rt_alloc_unset(geometry->object_count, sizeof(RtBox));
    if (!geometry->boxes)
        return rt_fail_memory(error, "the boxes of the objects", geometry->object_count * sizeof(RtBox));
    geometry->box = RT_EMPTY_BOX;
    for (uint32_t id = 0; id < geometry->object_count; id++) {
        geometry->boxes[id] = rt_object_box(geometry, id);
        geometry->box = rt_box_union(geometry->box, geometry->boxes[id]);
    }
    return RT_OK;
}

uint64_t rt_geometry_bytes(const RtGeometry *g) {
    uint64_t bytes = rt_csg_forest_bytes(&g->forest);
    if (g->boxes) bytes += (uint64_t)g->object_count * sizeof *g->boxes;
#define X(array, count, capacity) bytes += (uint64_t)g->capacity * sizeof *g->array;
    ARRAYS
#undef X
    return bytes;
}

void rt_geometry_clear(RtGeometry *g) {
#define X(array, count, capacity) rt_free(g->array);
    ARRAYS
#undef X
    rt_csg_forest_clear(&g->forest);
    rt_free(g->boxes);
    rt_free(g->reach);
    *g = (RtGeometry){0};
}

/* ---- scratch memory of hit functions ---- */

RtStatus rt_hit_memory_alloc(const RtGeometry *geometry, RtHitMemory **hit_memory, RtError *error) {
    const uint32_t most = most_crossings(geometry);
    const uint64_t bytes = sizeof(RtHitMemory) + (uint64_t)most * sizeof(RtCrossing);
    *hit_memory = NULL;
    if (geometry->csg_count == 0 && geometry->instance_count == 0) return RT_OK;
    if (most < UINT32_MAX) *hit_memory = rt_alloc(bytes, 1);
    if (*hit_memory) return RT_OK;
    return rt_fail_memory(error, "the crossings of a ray with a CSG tree", bytes);
}
