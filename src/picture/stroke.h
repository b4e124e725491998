/* SPDX-License-Identifier: Apache-2.0 */
/* Lines, discs and arrows of drawings. */
#ifndef RT_PICTURE_STROKE_H
#define RT_PICTURE_STROKE_H

#include "picture/canvas.h"

typedef struct RtStroke {
    RtColor color;
    double width;   /* of the outline, 0: none */
    double opacity; /* of the filling, 0: none */
    double dash;    /* length of dashes and gaps, 0: a solid line */
} RtStroke;

/* Fills and outlines the path, and forgets it. */
void rt_paint_path(cairo_t *cairo, RtStroke stroke);

void rt_draw_disc(cairo_t *cairo, RtPoint center, double radius, RtColor color);

/* A line with a head at `to`, `head` long. */
void rt_draw_arrow(cairo_t *cairo, RtPoint from, RtPoint to, RtStroke stroke, double head);

#endif
