/* SPDX-License-Identifier: Apache-2.0 */
/* Solids: the leaves of CSG trees. A ray's line meets a solid in closed intervals of t, its spans; two
 * crossings open and close each span.
 *
 * A solid is stored ready for rays: its flat faces as planes in world space, its curved face by a transform
 * from object space, where it is one of the shapes below. So two faces in one plane are met at the same bits
 * of t, whatever solids they belong to, if their numbers are the same up to sign.
 *
 *   sphere       the unit ball; under an uneven transform an ellipsoid
 *   cone         between two parallel caps: x^2 + y^2 <= (1 + (ratio - 1) z)^2, 0 <= z <= 1;
 *                ratio 1 is a cylinder, 0 a full cone
 *   torus        the points nearer than `ratio` to the unit circle of the xy plane, 0 < ratio < 1
 *   polyhedron   an intersection of half-spaces: half-space (1), box (6), any convex polyhedron
 *   mesh         the inside of a closed triangle mesh: where more of its surface has been entered than left
 *
 * Planes have unit normals. Across a coordinate axis they are exact: the offset is a float32, like all
 * coordinates of geometry.
 *
 * Rounding. t is computed in double, clamped to where the ray is within the box of the solid (for the thick
 * ray, core/base/ray.h), and rounded to float32; crossings of equal float32 t are one place. A span that
 * opens and closes at one place (a tangent, an edge) is dropped, and spans that touch are joined. A ray in
 * the plane of a flat face, or along a straight line of a curved one, is outside. A ray in the surface of a
 * mesh passes on one side of it. */
#ifndef RT_SHAPE_SOLID_H
#define RT_SHAPE_SOLID_H

#include "core/base/ray.h"
#include "core/base/status.h"
#include "core/base/transform.h"
#include "core/shape/shape.h"

/* X(CONSTANT, name) */
#define RT_SOLID_KINDS(X)                                                                                    \
    X(SPHERE, sphere)                                                                                        \
    X(CONE, cone)                                                                                            \
    X(TORUS, torus)                                                                                          \
    X(POLYHEDRON, polyhedron)                                                                                \
    X(MESH, mesh)

typedef enum RtSolidKind {
#define RT_SOLID_ENUM(CONSTANT, name) RT_SOLID_##CONSTANT,
    RT_SOLID_KINDS(RT_SOLID_ENUM)
#undef RT_SOLID_ENUM
        RT_SOLID_KIND_COUNT
} RtSolidKind;

/* "sphere", "cone", ... */
const char *rt_solid_kind_name(RtSolidKind kind);

/* The half-space normal . p <= offset; `normal` points outward and has any length but 0. */
typedef struct RtPlane {
    RtVec3d normal;
    double offset;
} RtPlane;

typedef struct RtSolid {
    RtSolidKind kind;
    uint32_t material;     /* of the scene; not used here */
    bool subtracted;       /* subtracted in its tree, so its faces look inward (csg.h); not used here */
    uint32_t first, count; /* cone: its caps (base first; none at the apex if ratio is 0), polyhedron: its
                            * faces, in `planes`; mesh: in `triangles` */
    uint32_t first_box, leaves; /* mesh: its tree of 2 * leaves - 1 boxes, in `boxes` */
    double ratio;               /* cone, torus */
    RtTransform to_world;       /* from object to world space; the identity for polyhedron and mesh */
    RtVec3d inverse[3];         /* rows of the inverse of its linear part */
    RtBox box;                  /* rounded outward; infinite where the solid is unbounded */
} RtSolid;

/* The solids of all trees of a geometry and their faces. Owns its arrays; a zeroed struct is empty. */
typedef struct RtSolidSet {
    uint32_t solid_count, solid_capacity;
    RtSolid *solids;
    uint32_t plane_count, plane_capacity;
    RtPlane *planes;
    uint32_t triangle_count, triangle_capacity;
    RtTriangle *triangles; /* in world space, counter-clockwise seen from outside */
    uint32_t box_count, box_capacity;
    RtBox *boxes; /* of the meshes' trees */
} RtSolidSet;

void rt_solid_set_clear(RtSolidSet *set);
uint64_t rt_solid_set_bytes(const RtSolidSet *set);

/* Each adds a solid, given in object space with its transform to world space (for a polyhedron or a mesh also
 * NULL: the same), and returns its index. They reject what is not finite, flat, empty, or beyond
 * RT_MAX_COORDINATE; then nothing changes. */
RtStatus rt_solid_add_sphere(RtSolidSet *set, const RtTransform *to_world, uint32_t *index, RtError *error);
RtStatus rt_solid_add_cone(RtSolidSet *set, double ratio, const RtTransform *to_world, uint32_t *index,
                           RtError *error);
/* Replaces the caps of a cone, as in RtSolid. Those of a moved cone differ from those of its transform by
 * rounding; rejects any other difference. */
RtStatus rt_solid_set_caps(RtSolidSet *set, uint32_t index, const RtPlane *caps, uint32_t count,
                           RtError *error);
RtStatus rt_solid_add_torus(RtSolidSet *set, double ratio, const RtTransform *to_world, uint32_t *index,
                            RtError *error);
/* planes[0..count) in object space, 1 <= count <= RT_SOLID_MAX_FACES. Rejects planes that leave no point,
 * or an inside less wide than 2^-40 of the largest distance of a plane from the origin. */
#define RT_SOLID_MAX_FACES 1024
RtStatus rt_solid_add_polyhedron(RtSolidSet *set, const RtPlane *planes, uint32_t count,
                                 const RtTransform *to_world, uint32_t *index, RtError *error);
/* triangles[0..count) in object space; the set reorders them. Rejects a mesh that is not closed (each edge
 * must occur equally often in both directions) and one turned inside out (volume not above 0). */
RtStatus rt_solid_add_mesh(RtSolidSet *set, const RtTriangle *triangles, uint32_t count,
                           const RtTransform *to_world, uint32_t *index, RtError *error);

/* The same, by the parameters of scene files. Half-space: through `point`, on the side away from `normal`.
 * Frustum: a cone given by its two circles; one radius may be 0. Ring: a torus given by the circle in its
 * middle, of radius `major`, and the radius `minor` < `major` of its tube. Hull: the convex hull of 4 to
 * RT_SOLID_MAX_VERTICES points (arb8: 8); points within a few float32 ulps of a plane through others count as
 * on it. Building a polyhedron takes time quadratic in its faces (40 ms for 500). */
#define RT_SOLID_MAX_VERTICES 256
RtStatus rt_solid_add_box(RtSolidSet *set, RtVec3 lo, RtVec3 hi, uint32_t *index, RtError *error);
RtStatus rt_solid_add_half_space(RtSolidSet *set, RtVec3 point, RtVec3 normal, uint32_t *index,
                                 RtError *error);
RtStatus rt_solid_add_ellipsoid(RtSolidSet *set, RtVec3 center, RtVec3 radii, uint32_t *index,
                                RtError *error);
RtStatus rt_solid_add_frustum(RtSolidSet *set, RtVec3 base, float base_radius, RtVec3 apex, float apex_radius,
                              uint32_t *index, RtError *error);
RtStatus rt_solid_add_ring(RtSolidSet *set, RtVec3 center, RtVec3 axis, float major, float minor,
                           uint32_t *index, RtError *error);
RtStatus rt_solid_add_hull(RtSolidSet *set, const RtVec3 *vertices, uint32_t count, uint32_t *index,
                           RtError *error);

/* Adds a copy of solid `from` of set `source` (which may be `set` itself), moved by `move` (NULL: in
 * place). Rejects a solid that rounding flattens there. */
RtStatus rt_solid_add_moved(RtSolidSet *set, const RtSolidSet *source, uint32_t from, const RtTransform *move,
                            uint32_t *index, RtError *error);

/* ---- rays ---- */

/* Its line in double, and the thick ray that tests the boxes of one tree. The thickness follows from the
 * tree's reach (csg.h), so answers do not depend on the rest of the scene. */
typedef struct RtSolidRay {
    RtVec3d org, dir;
    RtPreparedRay thick;
} RtSolidRay;

/* A point where a line enters or leaves a solid or a tree. */
typedef struct RtCrossing {
    float t;        /* -INFINITY and INFINITY where a span is unbounded */
    uint32_t solid; /* index in the set */
    uint32_t face;  /* of the solid: cone: 0 side, 1 base, 2 apex; polyhedron, mesh: plane or triangle from
                     * 0 */
} RtCrossing;

/* The most crossings of any line with the solid; even. */
uint32_t rt_solid_most_crossings(const RtSolid *solid);

/* The crossings of the whole line of the ray with the solid to out[0..rt_solid_most_crossings): alternately
 * opening and closing, t ascending, strictly so within a span. Returns their number, which is even. [near,
 * far] is the interval of t in which the thick ray is in the solid's box; a ray that misses it has no
 * crossing. */
uint32_t rt_solid_crossings(const RtSolidSet *set, uint32_t index, const RtSolidRay *ray, float near,
                            float far, RtCrossing *out);

/* Unit normal of a face at `point` on it, pointing out of the solid. */
RtVec3d rt_solid_normal(const RtSolidSet *set, uint32_t index, uint32_t face, RtVec3d point);

/* The largest dot product of `direction` with a point of the solid, and a ball around it; INFINITY where it
 * is unbounded. */
double rt_solid_support(const RtSolidSet *set, uint32_t index, RtVec3d direction);
RtBall rt_solid_ball(const RtSolidSet *set, uint32_t index);

#endif
