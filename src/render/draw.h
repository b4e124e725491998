/* SPDX-License-Identifier: Apache-2.0 */
/* Drawing on images: filled rectangles, lines, text. What lies outside of the image is not drawn. */
#ifndef RT_RENDER_DRAW_H
#define RT_RENDER_DRAW_H

#include "render/image.h"

typedef struct RtColor {
    uint8_t rgb[3]; /* sRGB */
} RtColor;

/* A colour of a scale that grows evenly in lightness, dark violet at 0 to yellow at 1: "viridis", by van der
 * Walt & Smith 2015, from nine of its colours. Numbers outside 0..1 are brought inside. */
RtColor rt_color_scale(double position);

void rt_draw_rectangle(RtImage *image, int x, int y, int width, int height, RtColor color);

/* Blends a line of one pixel's width: `opacity` 0..1 of the colour over what is there. Both ends are to be
 * within a pixel of the image, or the line is long to draw. */
void rt_draw_line(RtImage *image, double x0, double y0, double x1, double y1, RtColor color, double opacity);

/* Letters (capitals, whatever is asked for), digits, '.', '_', '=' and blanks; each of 3 x 5 dots of size
 * `dot` pixels. (x, y) is the upper left. Other characters are blanks. */
void rt_draw_text(RtImage *image, int x, int y, int dot, const char *text, RtColor color);

#define RT_TEXT_HEIGHT 5 /* dots */
/* Width of `text` in dots. */
int rt_text_width(const char *text);

#endif
