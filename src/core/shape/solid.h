/* SPDX-License-Identifier: Apache-2.0 */
/* Solids: the leaves of CSG trees. A ray's line meets a solid in closed intervals of t, its spans; a span is
 * given by the two crossings that open and close it.
 *
 * Each solid stands ready in world coordinates: its flat faces as planes of the world, its curved side behind
 * a map to a standard solid. So t is the ray's own everywhere, and two faces in one plane are met at the same
 * bits of t, whatever solids they belong to, if their numbers are the same up to sign.
 *
 *   sphere       the unit ball; with an uneven map an ellipsoid
 *   cone         between two parallel caps: x^2 + y^2 <= (1 + (ratio - 1) z)^2, 0 <= z <= 1;
 *                ratio 1 is a cylinder, 0 a full cone
 *   torus        the points nearer than `ratio` to the unit circle of the xy plane, 0 < ratio < 1
 *   polyhedron   an intersection of half-spaces: half-space (1), box (6), any convex polyhedron
 *   mesh         the inside of a closed triangle mesh: where more of its surface has been entered than left
 *
 * Planes have normals of length 1. Those along an axis are exact: the normal is the axis, and the offset a
 * float32, as all coordinates of geometry are.
 *
 * The rule of rounding. t is computed in double, clamped to where the ray is within the box of the solid (on
 * the thick ray, core/base/ray.h), and rounded to float32; crossings of equal float32 t are at one place.
 * Spans have a length: what opens and closes at one place, a tangent or an edge, is no span, and spans that
 * touch are one. A ray in the plane of a flat face, or along a straight line of a curved one, is outside;
 * beside a mesh it is taken to pass by on one side, as if it were moved by less than any number. */
#ifndef RT_SHAPE_SOLID_H
#define RT_SHAPE_SOLID_H

#include "core/base/ray.h"
#include "core/base/status.h"
#include "core/base/transform.h"
#include "core/shape/ball.h"
#include "core/shape/triangle.h"

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

/* The half-space normal . p <= offset; `normal` of any length but 0, pointing outward. */
typedef struct RtPlane {
    RtVec3d normal;
    double offset;
} RtPlane;

typedef struct RtSolid {
    RtSolidKind kind;
    uint32_t material;     /* of the scene; nothing here reads it */
    bool subtracted;       /* from its tree: its faces look inward (csg.h); nothing here reads it */
    uint32_t first, count; /* cone: its caps (base first; no second where ratio is 0), polyhedron: its faces,
                              in `planes`; mesh: in `triangles` */
    uint32_t first_box, leaves; /* mesh: its tree of 2 leaves - 1 boxes, in `boxes` */
    double ratio;               /* cone, torus */
    RtTransform to_world;       /* from standard to world coordinates; of polyhedron and mesh the identity */
    RtVec3d inverse[3];         /* rows of the inverse of its linear part */
    RtBox box;                  /* outward; infinite sides where the solid has no end */
} RtSolid;

/* The solids of all trees of a geometry and what they are made of. Owns its arrays; a zeroed struct is
 * empty. */
typedef struct RtSolidSet {
    uint32_t solid_count, solid_capacity;
    RtSolid *solids;
    uint32_t plane_count, plane_capacity;
    RtPlane *planes;
    uint32_t triangle_count, triangle_capacity;
    RtTriangle *triangles; /* in world coordinates, counter-clockwise seen from outside */
    uint32_t box_count, box_capacity;
    RtBox *boxes; /* of the trees of meshes */
} RtSolidSet;

void rt_solid_set_clear(RtSolidSet *set);
uint64_t rt_solid_set_bytes(const RtSolidSet *set);

/* Each adds a solid of standard shape at `place` and gives its index. They refuse, with a message without a
 * place, what is not finite, flat or empty, and coordinates beyond RT_MAX_COORDINATE, and then change
 * nothing. */
RtStatus rt_solid_add_sphere(RtSolidSet *set, const RtTransform *to_world, uint32_t *index, RtError *error);
RtStatus rt_solid_add_cone(RtSolidSet *set, double ratio, const RtTransform *to_world, uint32_t *index,
                           RtError *error);
RtStatus rt_solid_add_torus(RtSolidSet *set, double ratio, const RtTransform *to_world, uint32_t *index,
                            RtError *error);
/* planes[0..count) in standard coordinates, 1 <= count <= RT_SOLID_MAX_FACES. Refuses a set without a point,
 * and one whose inside is flat: less wide than 2^-40 of the largest distance of a plane from the origin. */
#define RT_SOLID_MAX_FACES 1024
RtStatus rt_solid_add_polyhedron(RtSolidSet *set, const RtPlane *planes, uint32_t count,
                                 const RtTransform *to_world, uint32_t *index, RtError *error);
/* triangles[0..count) in standard coordinates; the set puts them in an order of its own. Refuses a mesh that
 * is not closed (each edge must be there as often in one direction as in the other, naming one that is not)
 * and one turned inside out (volume not above 0). */
RtStatus rt_solid_add_mesh(RtSolidSet *set, const RtTriangle *triangles, uint32_t count,
                           const RtTransform *to_world, uint32_t *index, RtError *error);

/* The same by what scenes give. Box: faces -x, x, -y, y, -z, z. Half-space: the side of the plane through
 * `point` that `normal` points away from. Frustum: a cone by its two circles, a cylinder where their radii
 * are equal; a radius may be 0. Ring: a torus by the circle in its middle, of radius `major`, and the radius
 * `minor` < `major` of its tube. Hull: the least convex polyhedron about 4 to RT_SOLID_MAX_VERTICES points
 * (arb8: 8); points within a few float32 ulps of a plane of others are on it, and those inside do nothing.
 * Making a polyhedron, and its support, take time as the square of its faces (40 ms for 500). */
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

/* A copy of solid `from` of set `source` (which may be `set` itself), moved by `move`, which may be NULL.
 * Refuses what rounding makes flat where it is moved to. */
RtStatus rt_solid_add_moved(RtSolidSet *set, const RtSolidSet *source, uint32_t from, const RtTransform *move,
                            uint32_t *index, RtError *error);

/* ---- rays ---- */

/* A ray as solids see it: its line in double, and the thick ray by which boxes of one tree are tested, with
 * the thickness of the tree's reach (see csg.h), so that answers do not depend on the scene around. */
typedef struct RtSolidRay {
    RtVec3d org, dir;
    RtPreparedRay thick;
} RtSolidRay;

/* Where a line goes in or out of a solid or of a tree of them. */
typedef struct RtCrossing {
    float t;        /* -INFINITY and INFINITY where a span has no end */
    uint32_t solid; /* index in the set */
    uint32_t face;  /* of the solid: cone 0 side, 1 base, 2 apex; polyhedron, mesh: plane, triangle from 0 */
} RtCrossing;

/* The most crossings that any line can have with the solid; even. */
uint32_t rt_solid_most_crossings(const RtSolid *solid);

/* The crossings of the ray's line with the solid, all along the line and not only within [tmin, tmax]:
 * opening and closing in turn, t ascending, strictly within a span; to out[0..rt_solid_most_crossings). Gives
 * their number, which is even. A bounded solid whose box the thick ray misses has none: that test is the
 * caller's, who hands over the interval [near, far] of t in which the ray is in the box. */
uint32_t rt_solid_crossings(const RtSolidSet *set, uint32_t index, const RtSolidRay *ray, float near,
                            float far, RtCrossing *out);

/* Unit normal of a face at `point` on it, away from the inside. */
RtVec3d rt_solid_normal(const RtSolidSet *set, uint32_t index, uint32_t face, RtVec3d point);

/* Largest dot product of `direction` with a point of the solid; INFINITY where it has no end that way. */
double rt_solid_support(const RtSolidSet *set, uint32_t index, RtVec3d direction);

/* A ball about the solid; of infinite radius where it has no end. */
RtBall rt_solid_ball(const RtSolidSet *set, uint32_t index);

#endif
