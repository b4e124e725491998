/* SPDX-License-Identifier: Apache-2.0 */
/* Heatmaps: the cost of each pixel as a colour; those of several accelerators share a scale. */
#ifndef RT_PICTURE_HEATMAP_H
#define RT_PICTURE_HEATMAP_H

#include "render/image.h"

typedef enum RtHeatmapScale { RT_HEATMAP_AUTO, RT_HEATMAP_LINEAR, RT_HEATMAP_LOG } RtHeatmapScale;

typedef struct RtHeatmapOptions {
    size_t counter;       /* as in rt_tally_get */
    RtHeatmapScale scale; /* AUTO: logarithmic if the mean is below an eighth of the maximum */
    double most;          /* value of the brightest colour and above; 0: the maximum */
    bool difference;      /* with two panels: a third shows the first minus the second */
    const char *rays;     /* the kind of rays counted, for the legend; NULL: all */
} RtHeatmapOptions;

/* A counted frame and its label. All frames of a heatmap have one size. */
typedef struct RtHeatmapPanel {
    const RtFrame *frame;
    const char *label;
} RtHeatmapPanel;

#define RT_MAX_PANELS 8

/* Draws 1..RT_MAX_PANELS panels side by side to `file` (canvas.h): each pixel's mean of the counter over
 * its ray trees, in the colours of rt_color_scale, linear from 0 to the maximum or by log(1 + value). All
 * panels share one scale, drawn as a bar below with the counter's name; each panel shows its mean and
 * maximum. A difference has its own linear scale: red where the first panel costs more, blue where the
 * second does. A single panel needs no label; an image narrower than its legend is padded. */
RtStatus rt_heatmap_draw(const char *file, const RtHeatmapPanel *panels, uint32_t count,
                         const RtHeatmapOptions *options, RtError *error);

#endif
