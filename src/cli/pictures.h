/* SPDX-License-Identifier: Apache-2.0 */
/* Options of `render` about pictures of what an accelerator is and costs: structures and heatmaps. A child
 * parser of argp. */
#ifndef RT_CLI_PICTURES_H
#define RT_CLI_PICTURES_H

#include "picture/heatmap.h"
#include "picture/structure.h"

#include <argp.h>

/* The input of the parser; zero at first, but for `boxes`, RT_ALL_LEVELS. */
typedef struct RtPictureOptions {
    const char *structure, *layer;                /* a path or NULL; a name or NULL */
    const char *heatmaps[RT_TALLY_COUNTER_COUNT]; /* paths, by counter */
    RtStructureOptions boxes;
    bool in_middle; /* the slice is in the middle of the scene, and boxes.at is not set */
    RtHeatmapOptions heat;
    uint32_t kinds;       /* of rays, bits; 0: all */
    uint32_t light, x, y; /* of an overlay for shadow rays; the pixel of the ray that is marked */
    bool aimed;           /* there is such a pixel */
    /* Options that were given, or NULL: one of pictures of boxes alone, one of pictures of the cells around a
     * light alone, and one that needs --heatmap. */
    const char *of_boxes, *of_light, *thermal;
} RtPictureOptions;

extern const struct argp rt_picture_argp;

/* To be called at ARGP_KEY_END of the parent, which has `accels` accelerators. */
void rt_pictures_finish(RtPictureOptions *o, uint32_t accels, struct argp_state *state);

bool rt_pictures_any_heatmap(const RtPictureOptions *o);

/* Appends the paths that will be written to paths[0..count); gives how many there are then. */
size_t rt_pictures_list(const RtPictureOptions *o, const char **paths, size_t count);

/* With --structure: RT_BAD_INPUT where an option was given that the layer to be drawn does not take. */
RtStatus rt_pictures_check(const RtPictureOptions *o, const RtAccel *accel, RtError *error);

/* With --structure, after rt_pictures_check: whether the picture shows the image of the scene, too, which
 * that of an overlay's cells does not. */
bool rt_pictures_need_frame(const RtPictureOptions *o, const RtAccel *accel);

/* Writes the picture of the structure, after rt_pictures_check. `frame` is of the accelerator's scene, and
 * empty where there is no need of it. */
RtStatus rt_pictures_structure(const RtPictureOptions *o, const RtAccel *accel, const RtFrame *frame,
                               RtError *error);

/* Writes the heatmaps that are asked for. Panels' frames are counted, with o->kinds. */
RtStatus rt_pictures_heatmaps(const RtPictureOptions *o, const RtHeatmapPanel *panels, uint32_t count,
                              RtError *error);

#endif
