/* SPDX-License-Identifier: Apache-2.0 */
/* Pictures of accelerators: the boxes of a structure over the scene, or in a section through it; and overlays
 * that look rays up in cells (RtAccelOps.find_cell), the item buffer as an image of object ids, a light
 * buffer as an unfolded cube map of list lengths. */
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
 * boxes or cells. RT_BAD_INPUT if no layer has that name, RT_NOT_AVAILABLE if it
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

/* Draws an overlay to `file` (canvas.h).
 *
 * For primary rays: each pixel has the colour of the object in its middle sample, white for none. A legend
 * counts the samples of each kind.
 *
 * For shadow rays: the cells around light `light` on the six faces of an unfolded cube, coloured by the
 * lengths of their lists on a logarithmic scale. Directions without objects are grey; a truncated list has
 * every fourth pixel red. `marked` is a ray to this light, or NULL: its cell is outlined and circled, and the
 * legend shows its number and list length.
 *
 * RT_BAD_INPUT if there is no such light, RT_NOT_AVAILABLE if the light has no cells. */
RtStatus rt_buffer_draw(const char *file, const RtAccel *layer, uint32_t light, const RtRay *marked,
                        RtError *error);

#endif
