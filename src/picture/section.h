/* SPDX-License-Identifier: Apache-2.0 */
/* A plane through a scene as a drawing: points are projected onto it, objects are cut by it. */
#ifndef RT_PICTURE_SECTION_H
#define RT_PICTURE_SECTION_H

#include "core/shape/geometry.h"
#include "picture/canvas.h"

typedef struct RtSection {
    RtVec3d on;                /* a point of the plane, drawn at `origin` */
    RtVec3d right, up, normal; /* orthonormal; to the right and upward in the drawing, and across it */
    RtPoint origin;            /* pixels */
    double scale;              /* pixels per unit */
} RtSection;

static inline RtPoint rt_section_point(const RtSection *section, RtVec3d p) {
    RtVec3d from = rt_subd(p, section->on);
    return (RtPoint){section->origin.x + rt_dotd(from, section->right) * section->scale,
                     section->origin.y - rt_dotd(from, section->up) * section->scale};
}

/* Adds the circle in which the plane cuts a ball to the path; false if it does not. */
bool rt_section_add_ball(const RtSection *section, cairo_t *cairo, RtVec3d center, double radius);

/* Adds the outline of object `id` in the plane: a circle, a line, or for cones and CSG trees short tangents
 * where lines of the plane enter and leave it, which enclose no area. Nothing if the plane misses it.
 * `crossings` is of rt_crossings_alloc. */
void rt_section_add_object(const RtSection *section, cairo_t *cairo, const RtGeometry *geometry, uint32_t id,
                           RtCrossing *crossings);

#endif
