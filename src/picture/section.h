/* SPDX-License-Identifier: Apache-2.0 */
/* A plane through a scene as a drawing: points are projected onto it, objects and extents are cut by it. And
 * the edges of extents in space. */
#ifndef RT_PICTURE_SECTION_H
#define RT_PICTURE_SECTION_H

#include "accel/extent.h"
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

/* The corners in the drawing, in order, of the convex polygon in which the plane cuts an extent other than a
 * sphere; 0 if it does not. The extent may be infinite. */
uint32_t rt_section_cut(const RtSection *section, const RtBoxView *view, RtPoint corners[RT_MAX_CORNERS]);

/* Adds the circle or the polygon in which the plane cuts an extent; false if it does not. Without `cairo` it
 * only says so. */
bool rt_section_add_extent(const RtSection *section, cairo_t *cairo, const RtBoxView *view);

/* Adds the outline of object `id` in the plane: a circle, a line, or for cones and CSG trees short tangents
 * where lines of the plane enter and leave it, which enclose no area. Nothing if the plane misses it.
 * `hit_memory` is of rt_hit_memory_alloc. */
void rt_section_add_object(const RtSection *section, cairo_t *cairo, const RtGeometry *geometry, uint32_t id,
                           RtHitMemory *hit_memory);

/* ---- extents in space ---- */

/* RT_EXTENT_BOX also for voxels and other boxes that are not extents. */
RtExtentKind rt_outline_kind(const RtBoxView *view);

/* Receives lines, one call of `line` per line. */
typedef struct RtLineViewer {
    void (*line)(void *context, RtVec3d from, RtVec3d to);
    void *context;
} RtLineViewer;

/* Emits the edges of a box, an oriented box or a slab polytope; for a sphere, its three axis-aligned circles,
 * of RT_CIRCLE_CORNERS lines each, and its silhouette as seen from `eye`. */
#define RT_CIRCLE_CORNERS 48
void rt_outline_edges(const RtBoxView *view, RtVec3d eye, RtLineViewer viewer);

#endif
