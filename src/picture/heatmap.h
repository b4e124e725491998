/* SPDX-License-Identifier: Apache-2.0 */
/* Heatmaps: what each pixel cost, as a colour, above a legend; those of several accelerators on one scale. */
#ifndef RT_PICTURE_HEATMAP_H
#define RT_PICTURE_HEATMAP_H

#include "render/image.h"

typedef enum RtHeatmapScale { RT_HEATMAP_AUTO, RT_HEATMAP_LINEAR, RT_HEATMAP_LOG } RtHeatmapScale;

typedef struct RtHeatmapOptions {
    size_t counter;       /* as in rt_tally_get */
    RtHeatmapScale scale; /* AUTO: logarithmic where the mean is below an eighth of the most */
    double most;      /* value of the brightest colour, and of all above it; 0: the largest value there is */
    bool difference;  /* of two panels: a third has the first less the second */
    const char *rays; /* which rays the frames' costs are of, for the legend: "shadow"; NULL: all */
} RtHeatmapOptions;

/* A counted frame and what is written above it. Frames of one image are of one size. */
typedef struct RtHeatmapPanel {
    const RtFrame *frame;
    const char *label;
} RtHeatmapPanel;

#define RT_MAX_PANELS 8

/* Panels side by side, 1..RT_MAX_PANELS, in each the mean of the counter over a pixel's ray trees by
 * rt_color_scale: linear from 0 to the most, or by log(1 + value). Below are the mean and the most of each, a
 * bar with the values of the colours, which are those of all panels, the name of the counter and the scale. A
 * difference is red where the first panel costs more, blue where the second does, on a linear scale with a
 * bar of its own. A single panel without a label has none above it; an image narrower than its legend is
 * padded. Free with rt_image_clear. */
RtStatus rt_heatmap(RtImage *image, const RtHeatmapPanel *panels, uint32_t count,
                    const RtHeatmapOptions *options, RtError *error);

#endif
