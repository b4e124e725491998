/* SPDX-License-Identifier: Apache-2.0 */
/* Geometry: all objects of a scene in flat arrays, one array per shape, and the functions that dispatch on
 * shape. Objects have dense ids 0..object_count-1 in the order in which they were added. Each shape's array
 * is in order of ids. RT_SHAPES is the one list of shapes. */
#ifndef RT_SHAPE_GEOMETRY_H
#define RT_SHAPE_GEOMETRY_H

#include "core/base/ray.h"
#include "core/base/status.h"
#include "core/shape/csg.h"
#include "core/shape/instance.h"
#include "core/shape/shape.h"

/* X(CONSTANT, name, Type): `name` in the singular; the array is called name##s. */
#define RT_SHAPES(X)                                                                                         \
    X(SPHERE, sphere, RtSphere)                                                                              \
    X(POLYGON, polygon, RtPolygon)                                                                           \
    X(TRIANGLE, triangle, RtTriangle)                                                                        \
    X(CONE, cone, RtCone)                                                                                    \
    X(CSG, csg, RtCsg)                                                                                       \
    X(INSTANCE, instance, RtInstance)

typedef enum RtShape {
#define RT_SHAPE_ENUM(CONSTANT, name, Type) RT_SHAPE_##CONSTANT,
    RT_SHAPES(RT_SHAPE_ENUM)
#undef RT_SHAPE_ENUM
        RT_SHAPE_COUNT
} RtShape;

/* "sphere", "polygon", ... */
const char *rt_shape_name(RtShape shape);

/* Shape in the upper bits, index into the shape's array below. */
typedef uint32_t RtRef;
#define RT_REF_INDEX_BITS 28
#define RT_MAX_OBJECTS    (UINT32_C(1) << RT_REF_INDEX_BITS)

static inline RtRef rt_ref(RtShape shape, uint32_t index) {
    return (uint32_t)shape << RT_REF_INDEX_BITS | index;
}

static inline RtShape rt_ref_shape(RtRef ref) {
    return (RtShape)(ref >> RT_REF_INDEX_BITS);
}

static inline uint32_t rt_ref_index(RtRef ref) {
    return ref & (RT_MAX_OBJECTS - 1);
}

/* Vertex normals of one triangle, of unit length. */
typedef struct RtVertexNormals {
    RtVec3 n[3];
} RtVertexNormals;

/* Owns its arrays; a zeroed struct is the empty geometry. Add objects, call rt_geometry_finish, then only
 * read. */
typedef struct RtGeometry {
    uint32_t object_count, object_capacity;
    RtRef *objects; /* [object_count] */

    /* Per shape: the objects and the id of each. */
#define RT_SHAPE_ARRAYS(CONSTANT, name, Type)                                                                \
    uint32_t name##_count, name##_capacity, name##_id_capacity;                                              \
    Type *name##s;        /* [name##_count] */                                                               \
    uint32_t *name##_ids; /* [name##_count], ascending */
    RT_SHAPES(RT_SHAPE_ARRAYS)
#undef RT_SHAPE_ARRAYS

    uint32_t polygon_vertex_count, polygon_vertex_capacity;
    RtVec3 *polygon_vertices;

    /* Index into vertex_normals per triangle, or RT_NO_NORMALS; NULL if no triangle has any. */
    uint32_t triangle_normal_capacity, vertex_normal_count, vertex_normal_capacity;
    uint32_t *triangle_normals; /* [triangle_count] or NULL */
    RtVertexNormals *vertex_normals;

    RtCsgForest forest; /* the CSG trees' parts */

    uint32_t nesting;        /* levels of instances */
    uint32_t part_crossings; /* of the largest CSG tree in the parts of its instances */

    /* Of a part: [RT_REACHES] owned: the largest dot product of its objects with
     * each (x, y, z) of -1, 0 and 1, at 9 (x + 1) + 3 (y + 1) + z + 1. */
    double *reach;

    /* Made by rt_geometry_finish. */
    RtBox *boxes; /* [object_count] own box of each object */
    RtBox box;    /* union of all; empty for an empty geometry */
} RtGeometry;

#define RT_NO_NORMALS UINT32_MAX

/* The vertices of polygon `index`. */
static inline const RtVec3 *rt_polygon_vertices(const RtGeometry *geometry, uint32_t index) {
    return geometry->polygon_vertices + geometry->polygons[index].first;
}

/* Each adds one object with the next id. They reject values that are not finite, beyond RT_MAX_COORDINATE or
 * degenerate (a radius of 0, a polygon without area); then nothing changes. Triangles without area are
 * accepted, since meshes contain them; they are never hit. */
RtStatus rt_geometry_add_sphere(RtGeometry *geometry, RtVec3 center, float radius, RtError *error);
RtStatus rt_geometry_add_polygon(RtGeometry *geometry, const RtVec3 *vertices, uint32_t count,
                                 RtError *error);
RtStatus rt_geometry_add_cone(RtGeometry *geometry, RtVec3 base, float base_radius, RtVec3 apex,
                              float apex_radius, RtError *error);
/* `normals`: 3 vertex normals of any length but 0, or NULL. */
RtStatus rt_geometry_add_triangle(RtGeometry *geometry, const RtVec3 vertices[3], const RtVec3 *normals,
                                  RtError *error);

/* Adds the tree below `root` as one object, with or without tests of inner nodes. `builder` is not kept. */
RtStatus rt_geometry_add_csg(RtGeometry *geometry, const RtCsgBuilder *builder, RtCsgTerm root, bool extents,
                             RtError *error);

/* Makes `reach` of a finished geometry. Call it once, before there are instances of it. */
RtStatus rt_geometry_measure_reach(RtGeometry *part, RtError *error);

/* Adds an instance of a part, which must be finished and outlive the geometry; after it, only instances may
 * be added. One of a part without objects is left out. Rejects a matrix that rounding would spoil
 * (rt_transform_invert), a box beyond RT_MAX_COORDINATE, and too many objects or levels. */
RtStatus rt_geometry_add_instance(RtGeometry *geometry, const RtGeometry *part, uint32_t part_index,
                                  const RtTransform *to_world, RtError *error);

/* Objects in the flattened order; object_count counts an instance as one. */
uint32_t rt_geometry_id_count(const RtGeometry *geometry);

/* The object 0..object_count-1 that is, or contains, the one with this id. */
uint32_t rt_geometry_holder(const RtGeometry *geometry, uint32_t id);

/* The shape of the object with this id, also inside instances. */
RtShape rt_geometry_shape(const RtGeometry *geometry, uint32_t id);

static inline bool rt_is_instance(const RtGeometry *geometry, uint32_t object) {
    return rt_ref_shape(geometry->objects[object]) == RT_SHAPE_INSTANCE;
}

static inline const RtInstance *rt_instance_of(const RtGeometry *geometry, uint32_t object) {
    return &geometry->instances[rt_ref_index(geometry->objects[object])];
}

/* Computes the boxes. Call it once, after the last object. */
RtStatus rt_geometry_finish(RtGeometry *geometry, RtError *error);

uint64_t rt_geometry_bytes(const RtGeometry *geometry); /* of memory that the arrays hold */
void rt_geometry_clear(RtGeometry *geometry);

#define RT_NO_SOLID UINT32_MAX

/* Allocates the memory of hit functions; NULL if there are neither CSG trees nor instances. It serves one
 * thread at a time; free it with rt_free. */
RtStatus rt_hit_memory_alloc(const RtGeometry *geometry, RtHitMemory **hit_memory, RtError *error);

/* Prepares *prepared for box tests and for the hit functions of this geometry; `hit_memory` is borrowed.
 * Returning the struct by value makes traversals many per cent slower. */
static inline void rt_hit_ray(RtPreparedRay *prepared, const RtGeometry *geometry, const RtRay *ray,
                              RtHitMemory *hit_memory) {
    rt_ray_prepare_in(prepared, ray, &geometry->box, hit_memory);
}

/* The surface of object `id` at `t`, one of the ray's hits: two unit normals, geometric (oriented by the
 * shape) and shading (interpolated if a triangle has vertex normals, otherwise the geometric one), and for
 * a CSG tree the solid that was hit (in geometry->forest), else RT_NO_SOLID. `hit_memory` comes from
 * rt_hit_memory_alloc. */
typedef struct RtNormals {
    RtVec3d geometric, shading;
    uint32_t solid;
} RtNormals;
RtNormals rt_object_normals(const RtGeometry *geometry, uint32_t id, const RtRay *ray, float t,
                            RtHitMemory *hit_memory);

/* Barycentric weights of v[0], v[1], v[2] at `point` in the plane of the triangle; they sum to 1. */
RtVec3d rt_triangle_weights(const RtTriangle *triangle, RtVec3d point);

/* Extents of object `id`: its box, which geometry->boxes[id] is; a ball; and the support function, which is
 * the largest dot product with `direction` (for slabs and oriented boxes). */
RtBox rt_object_box(const RtGeometry *geometry, uint32_t id);
RtBall rt_object_ball(const RtGeometry *geometry, uint32_t id);
double rt_object_support(const RtGeometry *geometry, uint32_t id, RtVec3d direction);

/* At least the largest dot product of a part's objects with `direction`, from its reach: a direction is a sum
 * of three that are known. Of a ball, 13 % more at most. */
enum { RT_REACHES = 27 };
double rt_reach(const double reach[RT_REACHES], RtVec3d direction);

/* The box of a box that is moved, which is not empty. */
RtBox rt_moved_box(const RtBox *box, const RtTransform *transform);

/* Three orthonormal axes that suit an oriented box of object `id`: along its longest edge or axis and its
 * normal; for a CSG tree, those of its largest solid. */
void rt_object_frame(const RtGeometry *geometry, uint32_t id, RtVec3d axes[3]);

/* All shapes but triangles and spheres: out of line, because their hit functions use many registers. */
static __attribute__((noinline)) bool rt_rarer_hit(const RtGeometry *geometry, uint32_t id,
                                                   const RtPreparedRay *ray, float *t, RtTally *tally) {
    RtRef ref = geometry->objects[id];
    uint32_t index = rt_ref_index(ref);
    const RtBox *own = &geometry->boxes[id];
    switch (rt_ref_shape(ref)) {
    case RT_SHAPE_POLYGON:
        return rt_polygon_hit(&geometry->polygons[index], rt_polygon_vertices(geometry, index), own, ray, t);
    case RT_SHAPE_CONE: return rt_cone_hit(&geometry->cones[index], own, ray, t);
    case RT_SHAPE_CSG: return rt_csg_hit(&geometry->forest, &geometry->csgs[index], ray, t, tally);
    case RT_SHAPE_TRIANGLE:
    case RT_SHAPE_SPHERE:
    case RT_SHAPE_INSTANCE:
    case RT_SHAPE_COUNT: break;
    }
    return false;
}

/* The hit function of every object but instances (accel/instance.c): true if the ray (from rt_hit_ray) hits
 * object `id` in [tmin, tmax]; *t is the first hit. The result has the same bits for the same ray and object,
 * whatever was found before. `tally` may be NULL; it counts tests inside CSG trees. */
static inline __attribute__((always_inline)) bool
rt_object_hit(const RtGeometry *geometry, uint32_t id, const RtPreparedRay *ray, float *t, RtTally *tally) {
    RtRef ref = geometry->objects[id];
    uint32_t index = rt_ref_index(ref);
    if (rt_ref_shape(ref) == RT_SHAPE_TRIANGLE) return rt_triangle_hit(&geometry->triangles[index], ray, t);
    if (rt_ref_shape(ref) == RT_SHAPE_SPHERE)
        return rt_sphere_hit(&geometry->spheres[index], &geometry->boxes[id], ray, t);
    return rt_rarer_hit(geometry, id, ray, t, tally);
}

#endif
