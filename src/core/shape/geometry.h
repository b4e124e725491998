/* SPDX-License-Identifier: Apache-2.0 */
/* Geometry: all objects of a scene in flat arrays, one array per shape, and the one entry point that
 * dispatches on shape.
 *
 * Objects have dense ids 0..object_count-1 in the order they were added. An object is a reference (shape and
 * index into that shape's array); the arrays of a shape keep the order of ids, so a loop over a shape meets
 * ids in ascending order. This is the one place that lists the shapes: RT_SHAPES. */
#ifndef RT_SHAPE_GEOMETRY_H
#define RT_SHAPE_GEOMETRY_H

#include "core/base/ray.h"
#include "core/base/status.h"
#include "core/shape/cone.h"
#include "core/shape/csg.h"
#include "core/shape/polygon.h"
#include "core/shape/sphere.h"
#include "core/shape/triangle.h"

/* X(CONSTANT, name, Type): `name`s in the singular; the geometry's array is called name##s. */
#define RT_SHAPES(X)                                                                                         \
    X(SPHERE, sphere, RtSphere)                                                                              \
    X(POLYGON, polygon, RtPolygon)                                                                           \
    X(TRIANGLE, triangle, RtTriangle)                                                                        \
    X(CONE, cone, RtCone)                                                                                    \
    X(CSG, csg, RtCsg)

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

/* Vertex normals of one triangle, unit length. */
typedef struct RtVertexNormals {
    RtVec3 n[3];
} RtVertexNormals;

/* Owns all its arrays; a zeroed struct is the empty geometry. Add objects, then rt_geometry_finish, then
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

    RtCsgForest forest; /* what the CSG trees are made of */

    /* Made by rt_geometry_finish. */
    RtBox *boxes; /* [object_count] own box of each object */
    RtBox box;    /* union of all; empty for an empty geometry */
} RtGeometry;

#define RT_NO_NORMALS UINT32_MAX

/* The vertices of polygon `index`. */
static inline const RtVec3 *rt_polygon_vertices(const RtGeometry *geometry, uint32_t index) {
    return geometry->polygon_vertices + geometry->polygons[index].first;
}

/* Each adds one object and gives it the next id. They refuse what is not finite, beyond RT_MAX_COORDINATE or
 * degenerate (a radius of 0, a polygon without area), with a message without a place, and then change
 * nothing. A triangle without area is let in: meshes have them; it is never hit. */
RtStatus rt_geometry_add_sphere(RtGeometry *geometry, RtVec3 center, float radius, RtError *error);
RtStatus rt_geometry_add_polygon(RtGeometry *geometry, const RtVec3 *vertices, uint32_t count,
                                 RtError *error);
RtStatus rt_geometry_add_cone(RtGeometry *geometry, RtVec3 base, float base_radius, RtVec3 apex,
                              float apex_radius, RtError *error);
/* `normals`: 3 vertex normals of any length but 0, or NULL. */
RtStatus rt_geometry_add_triangle(RtGeometry *geometry, const RtVec3 vertices[3], const RtVec3 *normals,
                                  RtError *error);

/* The tree below `root` as one object, with or without tests of inner nodes. Nothing of `builder` is kept. */
RtStatus rt_geometry_add_csg(RtGeometry *geometry, const RtCsgBuilder *builder, RtCsgTerm root, bool extents,
                             RtError *error);
/* Tree `index` of another geometry, moved by `move`, which may be NULL. */
RtStatus rt_geometry_copy_csg(RtGeometry *geometry, const RtGeometry *from, uint32_t index,
                              const RtTransform *move, RtError *error);

/* Computes the boxes. To be called once, after the last object. */
RtStatus rt_geometry_finish(RtGeometry *geometry, RtError *error);

/* Bytes of memory that the arrays hold. */
uint64_t rt_geometry_bytes(const RtGeometry *geometry);

/* Frees everything and leaves the empty geometry. */
void rt_geometry_clear(RtGeometry *geometry);

#define RT_NO_SOLID UINT32_MAX

/* Room for what hit functions write down while they work, the crossings of a ray with the largest CSG tree:
 * to *room, to be freed with rt_free, and NULL where there is no tree. It serves one thread at a time.
 * Whoever asks for hits has it made beforehand, so that nothing is allocated while tracing. */
RtStatus rt_hit_room(const RtGeometry *geometry, RtCrossing **room, RtError *error);

/* The ray, prepared for tests of boxes and for hit functions of this geometry, to *prepared; `room` is
 * borrowed. Traversals are many per cent slower where it is returned and copied. */
static inline void rt_hit_ray(RtPreparedRay *prepared, const RtGeometry *geometry, const RtRay *ray,
                              RtCrossing *room) {
    rt_ray_prepare_in(prepared, ray, &geometry->box, room);
}

/* What `ray` meets at `t`, one of its hits on object `id`: normals, both unit, the geometric one by the
 * shape's own orientation, the shading one interpolated where a triangle has vertex normals and equal to the
 * geometric one elsewhere; and for a CSG tree the solid that was met (of geometry->forest), else
 * RT_NO_SOLID. `room` is of rt_hit_room. */
typedef struct RtNormals {
    RtVec3d geometric, shading;
    uint32_t solid;
} RtNormals;
RtNormals rt_object_normals(const RtGeometry *geometry, uint32_t id, const RtRay *ray, float t,
                            RtCrossing *room);

/* Extents of object `id` besides geometry->boxes[id]: a ball, and the largest dot product with `direction`
 * (the support function: what slabs and oriented boxes are made from). */
RtBall rt_object_ball(const RtGeometry *geometry, uint32_t id);
double rt_object_support(const RtGeometry *geometry, uint32_t id, RtVec3d direction);

/* Three orthonormal axes that suit an oriented box of object `id`: along its longest edge or axis and its
 * normal; those of its largest solid for a CSG tree. */
void rt_object_frame(const RtGeometry *geometry, uint32_t id, RtVec3d axes[3]);

/* The hit functions of what is neither triangle nor sphere: out of line, for they take many registers. */
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
    case RT_SHAPE_COUNT: break;
    }
    return false;
}

/* The hit function of every object: true if the ray (of rt_hit_ray) meets object `id` at some t in [tmin,
 * tmax], the first of which goes to *t. The same bits of t for the same ray and object, whatever was found
 * before. `tally` may be NULL; it counts what is tested inside of CSG trees. */
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
