/* SPDX-License-Identifier: Apache-2.0 */
/* Pictures of overlays that look rays up in cells (RtAccelOps.find_cell): the item buffer as an image of
 * object ids, a light buffer as an unfolded cube map of list lengths. */
#ifndef RT_PICTURE_BUFFERS_H
#define RT_PICTURE_BUFFERS_H

#include "accel/accel.h"

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
