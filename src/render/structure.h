/* SPDX-License-Identifier: Apache-2.0 */
/* Pictures of accelerators: the boxes of a structure drawn over a dimmed image of the scene. */
#ifndef RT_RENDER_STRUCTURE_H
#define RT_RENDER_STRUCTURE_H

#include "render/image.h"

/* RT_NOT_AVAILABLE if accelerators of this kind have no boxes to show. */
RtStatus rt_structure_available(const RtAccelOps *ops, RtError *error);

/* Draws the edges of every box that the accelerator, or the base below overlays, has over `image`, which
 * shows the accelerator's scene through its camera, and which is dimmed first. The colour of a box is its
 * depth (rt_color_scale, yellow for the root, dark for the deepest); the many deep ones are drawn fainter.
 * Lines are clipped at the camera's near plane. */
RtStatus rt_draw_structure(RtImage *image, const RtAccel *accel, RtError *error);

#endif
