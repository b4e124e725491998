/* SPDX-License-Identifier: Apache-2.0 */
/* Heatmaps: what each pixel cost, as a colour, above a legend. */
#ifndef RT_RENDER_HEATMAP_H
#define RT_RENDER_HEATMAP_H

#include "render/image.h"

/* Maps the mean of counter `counter` (as in rt_tally_get) over a pixel's ray trees to rt_color_scale: linear
 * from 0 to the largest value, or, where the mean of the image is below an eighth of the largest value and a
 * linear scale would be one dark field, by log(1 + value). The legend below the image has a bar with the
 * values of its colours, the name of the counter, the mean and the scale; an image narrower than the legend
 * is padded. The frame is counted. Free with rt_image_clear. */
RtStatus rt_heatmap(RtImage *image, const RtFrame *frame, size_t counter, RtError *error);

#endif
