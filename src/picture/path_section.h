/* SPDX-License-Identifier: Apache-2.0 */
/* A section through the plane of a ray and the scene axis along which the ray moves least: boxes are upright
 * rectangles, spheres are circles, and the ray crosses exactly those that it passes through, from left to
 * right. */
#ifndef RT_PICTURE_PATH_SECTION_H
#define RT_PICTURE_PATH_SECTION_H

#include "picture/canvas.h"
#include "render/path.h"

/* A rectangle of the picture that shows a part of the section. x shows s, the distance along the ray's
 * projection perpendicular to `axis`, in world units; y shows `axis`. */
typedef struct RtPathWindow {
    double x, y, width, height; /* pixels */
    double s0, v0;              /* the upper left */
    double scale;               /* pixels per unit */
} RtPathWindow;

typedef struct RtPathSection {
    const RtPath *path;
    const RtGeometry *geometry;
    RtVec3d org, along, normal; /* unit: along s; of the plane */
    int axis;
    double speed;                  /* of s per t */
    double farthest;               /* the largest t that is drawn */
    RtPathWindow detail, overview; /* overview.width is 0 if the detail shows the whole path */
    const RtPathWindow *window;    /* being drawn: one of these */
    cairo_t *cairo;
    RtCrossing *crossings; /* scratch memory, while drawing */
} RtPathSection;

/* The detail shows where objects are tested, and as much around it. If that is much less than the path, the
 * overview shows the whole path. Sets what both show; the caller has set their places. */
void rt_path_section_init(RtPathSection *section, const RtPath *path, const RtGeometry *geometry);

/* The pixel of t in the detail. */
double rt_path_section_x(const RtPathSection *section, double t);

/* Draws the detail, and the overview with the detail's outline. Objects that the ray does not test and leaves
 * that it does not visit are pale. RT_NO_MEMORY, or a failure of a remote accelerator. */
RtStatus rt_path_section_draw(RtPathSection *section, cairo_t *cairo, RtError *error);

/* ---- colours, shared with legends and bars ---- */

#define RT_PATH_DARK      ((RtColor){{85, 85, 85}})
#define RT_PATH_LIGHT     ((RtColor){{153, 153, 153}})
#define RT_PATH_HIT       ((RtColor){{204, 0, 0}})
#define RT_PATH_UNTESTED  ((RtStyle){{{170, 170, 170}}, 1, 0.2, false})
#define RT_PATH_UNVISITED ((RtStyle){{{200, 200, 200}}, 0.6, 0, false})

/* Of the order of rows: from dark to light. */
RtColor rt_path_row_color(const RtPath *path, uint32_t row);

bool rt_path_row_is_missed(const RtPathRow *row);

#endif
