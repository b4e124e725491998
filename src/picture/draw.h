/* SPDX-License-Identifier: Apache-2.0 */
/* Drawing on images: filled rectangles, lines, text, scales of colours. What lies outside of the image is not
 * drawn. */
#ifndef RT_PICTURE_DRAW_H
#define RT_PICTURE_DRAW_H

#include "render/image.h"

typedef struct RtColor {
    uint8_t rgb[3]; /* sRGB */
} RtColor;

#define RT_BLACK ((RtColor){{0, 0, 0}})
#define RT_WHITE ((RtColor){{255, 255, 255}})
#define RT_GREY  ((RtColor){{150, 150, 150}})

/* A colour of a scale that grows evenly in lightness, dark violet at 0 to yellow at 1: "viridis", by van der
 * Walt & Smith 2015, from nine of its colours. Numbers outside 0..1 are brought inside. */
RtColor rt_color_scale(double position);

/* A colour of a scale with a middle: blue at -1, near white at 0, red at 1. */
RtColor rt_color_difference(double position);

/* A colour for an object or another thing with a number: neighbouring numbers have colours that are far
 * apart. */
RtColor rt_color_of_number(uint32_t number);

void rt_draw_pixel(RtImage *image, int x, int y, RtColor color, double opacity);
void rt_draw_rectangle(RtImage *image, int x, int y, int width, int height, RtColor color);

/* Blends a line of one pixel's width: `opacity` 0..1 of the colour over what is there. Both ends are to be
 * within a pixel of the image, or the line is long to draw. */
void rt_draw_line(RtImage *image, double x0, double y0, double x1, double y1, RtColor color, double opacity);

/* Text, each character of 5 x 7 dots of size `dot` pixels. (x, y) is the upper left. Letters are capitals,
 * whatever is asked for; characters without a glyph (there are digits and . _ = : , - + / ( ) % < >) are
 * blanks. */
void rt_draw_text(RtImage *image, int x, int y, int dot, const char *text, RtColor color);

#define RT_TEXT_HEIGHT 7 /* dots */
/* Width of `text` in dots. */
int rt_text_width(const char *text);

/* The size of dots, in pixels, at which text is legible on an image of this width. */
int rt_text_dot(uint32_t image_width);

/* Where values lie on a scale of colours: 0 at `least`, 1 at `most`. A logarithmic one, of log(1 + value),
 * begins at 0. */
typedef struct RtScale {
    double least, most;
    bool logarithmic;
} RtScale;
double rt_scale_position(const RtScale *scale, double value);

/* A bar with the colours of a scale, `width` wide, (x, y) being its upper left, and round values below; a
 * scale whose least is below 0 has the colours of differences. Gives the height that it takes, in pixels. */
int rt_draw_scale(RtImage *image, int x, int y, int width, int dot, const RtScale *scale);

#endif
