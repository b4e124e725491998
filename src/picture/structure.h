/* SPDX-License-Identifier: Apache-2.0 */
/* Pictures of accelerators: the boxes of a structure over the scene, or in a section through it. */
#ifndef RT_PICTURE_STRUCTURE_H
#define RT_PICTURE_STRUCTURE_H

#include "render/image.h"

/* Which boxes. */
typedef struct RtStructureOptions {
    uint32_t first_level, last_level; /* depths below the root */
    bool leaves;                      /* only those */
    bool slice;                       /* only those that meet the plane where `axis` is `at` */
    int axis;
    double at;
} RtStructureOptions;

#define RT_ALL_LEVELS ((RtStructureOptions){.last_level = UINT32_MAX})

/* The layer of `accel` that is called `name`, or, if that is NULL, the topmost of which there can be a
 * picture, by boxes or by cells (picture/cells.h): to *layer. RT_BAD_INPUT if there is none of that name,
 * RT_NOT_AVAILABLE if there can be no picture. rt_structure_available asks the same of a spec, before
 * anything is built. */
RtStatus rt_structure_layer(const RtAccel *accel, const char *name, const RtAccel **layer, RtError *error);
RtStatus rt_structure_available(const RtSpec *spec, const char *name, RtError *error);

/* Draws the edges of the boxes that `layer` shows (each_box), or nets of what else extents are
 * (picture/net.h), over a dimmed picture of its scene, which `frame` is, with a legend below. What lies
 * behind the surfaces that the frame sees is faint: one looks at the scene through a net. The colour of a box
 * is its level (rt_color_scale, yellow for the first that is drawn), deep ones are fainter; where all are of
 * one level it is their size, on a logarithmic scale.
 *
 * With `slice` it is a section instead, seen along the axis, as large as what the camera sees at its aim:
 * each box that the plane cuts is filled, and objects are outlined in white where it cuts them (spheres and
 * what is flat).
 *
 * RT_BAD_INPUT where no box is left to draw. Free with rt_image_clear. */
RtStatus rt_structure_image(RtImage *image, const RtAccel *layer, const RtFrame *frame,
                            const RtStructureOptions *options, RtError *error);

#endif
