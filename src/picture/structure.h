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
    bool slice;                       /* only boxes that the plane where `axis` is `at` cuts */
    int axis;
    double at;
} RtStructureOptions;

#define RT_ALL_LEVELS ((RtStructureOptions){.last_level = UINT32_MAX})

/* Finds the layer of `accel` that is called `name` or, if that is NULL, the topmost that can be drawn, by its
 * boxes or by its cells (picture/buffers.h). RT_BAD_INPUT if no layer has that name, RT_NOT_AVAILABLE if it
 * cannot be drawn. rt_structure_available asks the same of a spec, before anything is built. */
RtStatus rt_structure_layer(const RtAccel *accel, const char *name, const RtAccel **layer, RtError *error);
RtStatus rt_structure_available(const RtSpec *spec, const char *name, RtError *error);

/* Draws the boxes that `layer` shows (each_box), or the outlines of other extents, to `file` (canvas.h): over
 * a dimmed image of its scene, `frame`, with a legend below. Edges behind the surfaces of the frame are
 * faint. The colour of a box is its level (rt_color_scale, yellow for the first), deep levels are fainter; if
 * all boxes are on one level, the colour is their size on a logarithmic scale.
 *
 * With `slice` it draws a section along the axis instead, of what the camera sees at its aim: boxes that the
 * plane cuts are filled, spheres and flat objects that it cuts are outlined in white.
 *
 * RT_BAD_INPUT if no box is left to draw. */
RtStatus rt_structure_draw(const char *file, const RtAccel *layer, const RtFrame *frame,
                           const RtStructureOptions *options, RtError *error);

#endif
