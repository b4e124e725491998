/* Solids: the leaves of CSG trees. A ray's line meets a solid in closed intervals of t, its spans; a span is
 * given by the two crossings that open and close it.
 *
 * Each solid stands ready in world coordinates: its flat faces as planes of the world, its curved side behind
 * a map to a standard solid. So t is the ray's own everywhere, and two faces in one plane are met at the same
 * bits of t, whatever solids they belong to, if their numbers are the same up to sign.
 *
 *   sphere       the unit ball; with an uneven map an ellipsoid
 *   cone         between two parallel caps: x^2 + y^2 <= (1 + (ratio - 1) z)^2, 0 <= z <= 1; ratio 1 is a
 * cylinder, 0 a full cone torus        the points nearer than `ratio` to the unit circle of the xy plane, 0 <
 * ratio < 1 polyhedron   an intersection of half-spaces: half-space (1), box (6), arb8 (6), any convex
 * polyhedron mesh         the inside of a closed triangle mesh, by the rule of crossings
 *
 * The rule of rounding. t is computed in double, clamped to where the ray is within the box of the solid (on
 * the thick ray, base/ray.h), and rounded to float32; crossings of equal float32 t are at one place. Spans
 * have a length: what opens and closes at one place, a tangent or an edge, is no span. */
#ifndef RT_SHAPE_SOLID_H
#define RT_SHAPE_SOLID_H

#include "base/ray.h"
#include "base/status.h"
#include "base/transform.h"
#include "shape/ball.h"
#include "shape/triangle.h"

typedef enum RtSolidKind {
    RT_SOLID_SPHERE,
    RT_SOLID_CONE,
    RT_SOLID_TORUS,
    RT_SOLID_POLYHEDRON,
    RT_SOLID_MESH,
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
    uint32_t first, count; /* cone: its 2 caps (base first), polyhedron: its faces, in `planes`; mesh: in
                              `triangles` */
    double ratio;          /* cone, torus */
    RtTransform place;     /* from standard to world coordinates */
    RtTransform back;      /* its inverse */
    RtBox box;             /* outward; infinite sides where the solid has no end */
} RtSolid;

/* The solids of all trees of a geometry and what they are made of. Owns its arrays; a zeroed struct is empty.
 */
typedef struct RtSolidSet {
    uint32_t solid_count, solid_capacity;
    RtSolid *solids;
    uint32_t plane_count, plane_capacity;
    RtPlane *planes;
    uint32_t triangle_count, triangle_capacity;
    RtTriangle *triangles; /* in world coordinates, counter-clockwise seen from outside */
} RtSolidSet;

void rt_solid_set_clear(RtSolidSet *set);
uint64_t rt_solid_set_bytes(const RtSolidSet *set);

/* Each adds a solid of standard shape at `place` and gives its index. They refuse, with a message without a
 * place, what is not finite, flat or empty, and coordinates beyond RT_MAX_COORDINATE. */
RtStatus rt_solid_add_sphere(RtSolidSet *set, const RtTransform *place, uint32_t *index, RtError *error);
RtStatus rt_solid_add_cone(RtSolidSet *set, double ratio, const RtTransform *place, uint32_t *index,
                           RtError *error);
RtStatus rt_solid_add_torus(RtSolidSet *set, double ratio, const RtTransform *place, uint32_t *index,
                            RtError *error);
/* planes[0..count) in standard coordinates. Refuses a set without a point, and one whose inside is flat. */
RtStatus rt_solid_add_polyhedron(RtSolidSet *set, const RtPlane *planes, uint32_t count,
                                 const RtTransform *place, uint32_t *index, RtError *error);
/* triangles[0..count) in standard coordinates. Refuses a mesh that is not closed (each edge must be there as
 * often in one direction as in the other, naming one that is not) and one turned inside out (volume not above
 * 0). */
RtStatus rt_solid_add_mesh(RtSolidSet *set, const RtTriangle *triangles, uint32_t count,
                           const RtTransform *place, uint32_t *index, RtError *error);

/* A copy of solid `from` of set `source` (which may be `set` itself), moved by `move`, which may be NULL. */
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
    uint32_t
        face; /* of the solid: cone 0 side, 1 base, 2 apex; polyhedron and mesh: plane or triangle from 0 */
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
