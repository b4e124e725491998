/* SPDX-License-Identifier: Apache-2.0 */
/* Pictures of accelerators: the boxes of a structure over the scene, or in a section through it. */
#ifndef RT_PICTURE_STRUCTURE_H
#define RT_PICTURE_STRUCTURE_H

#include "accel/accel.h"
#include "render/frame.h"

/* Which boxes to draw. */
typedef struct RtStructureOptions {
    uint32_t first_level, last_level; /* depths below the root */
    bool leaves;                      /* only leaves */
    bool slice;                       /* only boxes cut by the plane where `axis` is `at` */
    int axis;
    double at;
} RtStructureOptions;

#define RT_ALL_LEVELS ((RtStructureOptions){.last_level = UINT32_MAX})

/* Finds the layer of `accel` named `name`, or if that is NULL the topmost layer that can be drawn by its
 * boxes or cells (picture/buffers.h). RT_BAD_INPUT if no layer has that name, RT_NOT_AVAILABLE if it
 * cannot be drawn. rt_structure_available checks the same for a spec, before anything is built. */
RtStatus rt_structure_layer(const RtAccel *accel, const char *name, const RtAccel **layer, RtError *error);
RtStatus rt_structure_available(const RtSpec *spec, const char *name, RtError *error);

/* Draws the boxes of `layer` (each_box), or the outlines of other extents, to `file` (canvas.h), over a
 * pale image of its scene, `frame`, on white, with a legend below. Edges behind visible surfaces are faint.
 * Lines show the level: dark and thick at the first, lighter (rt_color_scale) and thinner below; if all boxes
 * are on one level, they show size on a logarithmic scale.
 *
 * With `slice` it draws a section along the axis instead, of the region that the camera aims at: boxes cut by
 * the plane are outlined, leaves also filled; objects are grey.
 *
 * RT_BAD_INPUT if no box is left to draw. */
RtStatus rt_structure_draw(const char *file, const RtAccel *layer, const RtFrame *frame,
                           const RtStructureOptions *options, RtError *error);

#endif
