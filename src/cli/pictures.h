/* SPDX-License-Identifier: Apache-2.0 */
/* Options of `render` for pictures of structures and heatmaps. */
#ifndef RT_CLI_PICTURES_H
#define RT_CLI_PICTURES_H

#include "cli/options.h"
#include "picture/heatmap.h"
#include "picture/structure.h"

/* Zero before parsing, except `boxes` RT_ALL_LEVELS. */
typedef struct RtPictureOptions {
    const char *structure, *layer;                /* a path or NULL; a name or NULL */
    const char *heatmaps[RT_TALLY_COUNTER_COUNT]; /* paths, by counter */
    RtStructureOptions boxes;
    bool in_middle; /* the slice is in the middle of the scene; boxes.at is not set */
    RtHeatmapOptions heat;
    uint32_t kinds; /* of rays, bits; 0: all */
    uint32_t light; /* of an overlay for shadow rays */
    RtPixel pixel;  /* of the marked ray */
    /* The name of the last given option, or NULL, that needs a picture of boxes, a picture of a light's
     * cells, or --heatmap. */
    const char *of_boxes, *of_light, *thermal;
} RtPictureOptions;

extern const RtOption rt_picture_options[];

/* `finish` of the command, which has `accels` accelerators, calls this. */
void rt_pictures_finish(RtPictureOptions *o, uint32_t accels, struct argp_state *state);

bool rt_pictures_any_heatmap(const RtPictureOptions *o);

/* Appends the paths to be written to paths[0..count); returns the new count. */
size_t rt_pictures_list(const RtPictureOptions *o, const char **paths, size_t count);

/* With --structure: RT_BAD_INPUT if an option does not apply to the drawn layer. */
RtStatus rt_pictures_check(const RtPictureOptions *o, const RtAccel *accel, RtError *error);

/* With --structure, after rt_pictures_check: whether the picture needs the image of the scene; the cells of
 * an overlay do not. */
bool rt_pictures_need_frame(const RtPictureOptions *o, const RtAccel *accel);

/* Writes the picture of the structure, after rt_pictures_check. `frame` is of the accelerator's scene, and
 * empty if not needed. */
RtStatus rt_pictures_structure(const RtPictureOptions *o, const RtAccel *accel, const RtFrame *frame,
                               RtError *error);

/* Writes the heatmaps. The panels' frames are counted, with o->kinds. */
RtStatus rt_pictures_heatmaps(const RtPictureOptions *o, const RtHeatmapPanel *panels, uint32_t count,
                              RtError *error);

#endif
