/* SPDX-License-Identifier: Apache-2.0 */
/* What the pictures of structures in perspective and in section share. For structure*.c alone. */
#ifndef RT_PICTURE_STRUCTURE_PARTS_H
#define RT_PICTURE_STRUCTURE_PARTS_H

#include "picture/draw.h"
#include "picture/structure.h"

typedef struct RtStructureDrawing {
    RtImage *image;
    const RtFrame *frame;
    const RtAccel *layer;
    const RtStructureOptions *options;
    double width, height; /* of what is drawn on: the image without its legend */
    RtView view;
    double near;
    uint32_t first, last; /* levels that are drawn */
    uint32_t level;       /* the one that is being drawn */
    RtColor color;        /* of the box that is */
    double opacity;
    RtExtentKind kind;   /* of what is drawn */
    uint64_t drawn, all; /* boxes */
    double least, most;  /* their sizes: lengths of diagonals, but for points */
    int across, up;      /* of a section: axes of the image */
    double left, top, scale;
} RtStructureDrawing;

/* Is the box on the levels, and in the slice, that are asked for? */
bool rt_structure_shows(const RtStructureDrawing *d, const RtBoxView *view);

/* Of RtBoxViewer, `context` being the RtStructureDrawing: counts a box, and notes levels and sizes. */
void rt_structure_count(void *context, const RtBoxView *view);

/* Whether colours are those of sizes: where all boxes are of one level. */
bool rt_structure_is_by_size(const RtStructureDrawing *d);

RtColor rt_structure_level_color(const RtStructureDrawing *d, uint32_t depth);
RtColor rt_structure_size_color(const RtStructureDrawing *d, double size);

/* By its level or size. */
RtColor rt_structure_color(const RtStructureDrawing *d, const RtBoxView *view);

/* Chooses the window, and draws the section where the picture of the scene was. */
void rt_structure_draw_section(RtStructureDrawing *d);

#endif
