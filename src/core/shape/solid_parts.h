/* SPDX-License-Identifier: Apache-2.0 */
/* Shared by the solid_*.c files: the functions of each kind, planes, lines in object space, and how spans
 * become crossings. */
#ifndef RT_SHAPE_SOLID_PARTS_H
#define RT_SHAPE_SOLID_PARTS_H

#include "core/shape/solid.h"

/* The functions that solid.h promises, per kind. */
#define RT_SOLID_FUNCTIONS(CONSTANT, name)                                                                   \
    uint32_t rt_solid_##name##_crossings(const RtSolidSet *set, uint32_t index, const RtSolidRay *ray,       \
                                         float near, float far, RtCrossing *out);                            \
    RtVec3d rt_solid_##name##_normal(const RtSolidSet *set, const RtSolid *solid, uint32_t face,             \
                                     RtVec3d point);                                                         \
    double rt_solid_##name##_support(const RtSolidSet *set, const RtSolid *solid, RtVec3d direction);        \
    RtBall rt_solid_##name##_ball(const RtSolidSet *set, const RtSolid *solid);
RT_SOLID_KINDS(RT_SOLID_FUNCTIONS)
#undef RT_SOLID_FUNCTIONS

/* ---- building solids: in solid_parts.c unless another file is named ---- */

typedef double RtSolidSupport(const RtSolidSet *set, const RtSolid *solid, RtVec3d direction);

/* Adds `solid`, complete except for `inverse` and `box`. Its planes, triangles and boxes already lie behind
 * those of the set. */
RtStatus rt_solid_finish(RtSolidSet *set, RtSolid *solid, RtSolidSupport *support, uint32_t *index,
                         RtError *error);

/* In solid_mesh.c: builds the boxes of a mesh behind those of the set, and sets first_box and leaves. */
RtStatus rt_solid_mesh_boxes(RtSolidSet *set, RtSolid *solid, RtError *error);

/* Triangles per leaf. */
#define RT_SOLID_LEAF 4

/* In solid_round.c: fits the transform of a cone to its caps, which lie in the set; caps across a world
 * axis are rounded to float32. The cone may become flat, which rt_solid_finish rejects. */
void rt_solid_cone_to_caps(const RtSolidSet *set, RtSolid *solid);

/* Reject planes that leave no inside or a flat one (in solid_polyhedron.c), a closed mesh whose volume is not
 * above 0 (in solid_mesh.c), and a transform that is not finite or that flattens. */
RtStatus rt_solid_check_inside(const RtPlane *planes, uint32_t count, RtError *error);
RtStatus rt_solid_check_volume(const RtTriangle *triangles, uint32_t count, RtError *error);
RtStatus rt_solid_check_transform(const RtTransform *to_world, RtError *error);

/* The coordinate axis along which the vector lies, or -1. */
static inline int rt_axis_of(RtVec3d v) {
    if (v.y == 0 && v.z == 0) return v.x == 0 ? -1 : 0;
    if (v.x == 0 && v.z == 0) return 1;
    return v.x == 0 && v.y == 0 ? 2 : -1;
}

/* `normal` of any length but 0. */
RtPlane rt_plane_through(RtVec3d point, RtVec3d normal);
RtPlane rt_plane_moved(const RtPlane *plane, const RtTransform *move);

/* The largest factor by which the matrix with columns x, y, z stretches any vector, slightly rounded up. */
double rt_largest_stretch(RtVec3d x, RtVec3d y, RtVec3d z);

/* ---- spans ---- */

/* An interval of t in which a line is inside. */
typedef struct RtSpan {
    double open, close; /* t */
    uint32_t open_face, close_face;
} RtSpan;

/* Appends the crossings of a span, which opens at or after the end of the previous one, to the `count` so
 * far; returns the new number. */
static inline uint32_t rt_span_put(const RtSpan *span, uint32_t solid, float near, float far, RtCrossing *out,
                                   uint32_t count) {
    float open = (float)rt_clampd(span->open, (double)near, (double)far);
    float close = (float)rt_clampd(span->close, (double)near, (double)far);
    if (!(open < close)) return count;
    if (count > 0 && out[count - 1].t == open)
        count--;
    else
        out[count++] = (RtCrossing){open, solid, span->open_face};
    out[count++] = (RtCrossing){close, solid, span->close_face};
    return count;
}

/* Clips the span to the inner side of the plane. */
static inline void rt_span_cut(RtSpan *span, const RtPlane *plane, uint32_t face, const RtSolidRay *ray) {
    double gap = plane->offset - rt_dotd(plane->normal, ray->org);
    double rate = rt_dotd(plane->normal, ray->dir);
    if (rate == 0) {
        if (!(gap > 0)) span->close = -INFINITY;
        return;
    }
    double t = gap / rate;
    if (rate < 0 && t > span->open) span->open = t, span->open_face = face;
    if (rate > 0 && t < span->close) span->close = t, span->close_face = face;
}

/* ---- object space ---- */

static inline RtVec3d rt_solid_to_object(const RtSolid *solid, RtVec3d v) {
    return rt_vec3d(rt_dotd(solid->inverse[0], v), rt_dotd(solid->inverse[1], v),
                    rt_dotd(solid->inverse[2], v));
}

/* The origins are subtracted first, which is exact or nearly so; a product would lose digits. */
static inline RtVec3d rt_solid_point_to_object(const RtSolid *solid, RtVec3d point) {
    return rt_solid_to_object(solid, rt_subd(point, rt_transform_column(&solid->to_world, 3)));
}

static inline RtVec3d rt_solid_normal_to_world(const RtSolid *solid, RtVec3d normal) {
    RtVec3d sum = rt_scaled(solid->inverse[0], normal.x);
    sum = rt_add_scaledd(sum, solid->inverse[1], normal.y);
    return rt_normalized(rt_add_scaledd(sum, solid->inverse[2], normal.z));
}

/* The line of a ray in object space relative to `middle`: p(t) = near + (t - closest) dir, with `near` the
 * point nearest to the middle, so that distant origins cost no precision. */
typedef struct RtSolidLine {
    RtVec3d near, dir;
    double closest;
} RtSolidLine;

static inline RtSolidLine rt_solid_line(const RtSolid *solid, const RtSolidRay *ray, RtVec3d middle) {
    RtVec3d org = rt_subd(rt_solid_point_to_object(solid, ray->org), middle);
    RtVec3d dir = rt_solid_to_object(solid, ray->dir);
    double closest = -rt_dotd(org, dir) / rt_dotd(dir, dir);
    return (RtSolidLine){rt_add_scaledd(org, dir, closest), dir, closest};
}

#endif
