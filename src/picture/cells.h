/* SPDX-License-Identifier: Apache-2.0 */
/* Pictures of overlays that look rays up in cells (RtAccelOps.look_up): the item buffer as an image of object
 * ids, a light buffer as an unfolded cube of the lengths of its lists. */
#ifndef RT_PICTURE_CELLS_H
#define RT_PICTURE_CELLS_H

#include "render/image.h"

/* Of an overlay for primary rays: the sample in the middle of each pixel has the colour of the object that it
 * names, black for none, and magenta with white where it is undecided; a legend says how many samples are
 * what.
 *
 * Of one for shadow rays: the cells around light `light`, on six faces that are unfolded as they join, by the
 * lengths of their lists on a logarithmic scale; where nothing is seen it is grey; every fourth pixel of
 * lists that were cut is red. `marked`, a ray to this light, or NULL: the cell that it reads is outlined and
 * ringed, and the legend has its number and the length of its list.
 *
 * RT_BAD_INPUT if there is no such light, RT_NOT_AVAILABLE if the light has no cells. Free with
 * rt_image_clear. */
RtStatus rt_cells_image(RtImage *image, const RtAccel *layer, uint32_t light, const RtRay *marked,
                        RtError *error);

#endif
