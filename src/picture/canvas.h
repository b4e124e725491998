/* SPDX-License-Identifier: Apache-2.0 */
/* The surface that all pictures are drawn on: a cairo surface in pixels from the upper left, written as
 * PNG, SVG or PDF according to the extension of the file. */
#ifndef RT_PICTURE_CANVAS_H
#define RT_PICTURE_CANVAS_H

#include "core/base/file.h"
#include "render/frame.h"

#include <cairo.h>

typedef struct RtColor {
    uint8_t rgb[3]; /* sRGB */
} RtColor;

#define RT_BLACK ((RtColor){{0, 0, 0}})
#define RT_WHITE ((RtColor){{255, 255, 255}})
#define RT_GREY  ((RtColor){{150, 150, 150}})

/* The colour scale "viridis" (van der Walt & Smith 2015), from nine of its colours: dark violet at 0,
 * yellow at 1, with uniformly growing lightness. Clamps `position` to 0..1. */
RtColor rt_color_scale(double position);

/* A diverging scale: blue at -1, near white at 0, red at 1. */
RtColor rt_color_difference(double position);

/* A colour for an object id; neighbouring ids have very different colours. */
RtColor rt_color_of_id(uint32_t id);

/* ---- the file ---- */

typedef struct RtCanvas {
    cairo_t *cairo;
    RtOutput output;
    bool png;
} RtCanvas;

/* Opens `file`, with a white background; the font is DejaVu Sans of `font_size`, lines are 1 pixel wide. */
RtStatus rt_canvas_open(RtCanvas *canvas, const char *file, double width, double height, double font_size,
                        RtError *error);

/* Writes the file, or discards it if `drawn`, the status of the drawing, is not RT_OK. Returns `drawn`, or
 * why writing failed. */
RtStatus rt_canvas_close(RtCanvas *canvas, RtStatus drawn, RtError *error);

/* ---- drawing ---- */

void rt_set_color(cairo_t *cairo, RtColor color, double opacity);
void rt_fill_rectangle(cairo_t *cairo, double x, double y, double width, double height, RtColor color);

/* An image, pixel by pixel. */
typedef struct RtPixels {
    uint32_t width, height;
    RtColor (*color)(const void *context, uint32_t x, uint32_t y);
    const void *context;
} RtPixels;

/* Paints its pixels unscaled, the upper left at (x, y). RT_NO_MEMORY. */
RtStatus rt_paint_pixels(cairo_t *cairo, RtPixels pixels, double x, double y, RtError *error);

typedef struct RtPoint {
    double x, y;
} RtPoint;

/* Add a closed convex polygon, or a line, to the path, clipped far outside the picture, since cairo's
 * coordinates are limited. */
#define RT_MAX_CORNERS 56
void rt_add_polygon(cairo_t *cairo, const RtPoint *points, uint32_t count);
void rt_add_line(cairo_t *cairo, RtPoint from, RtPoint to);

/* Adds a circle of any size; one above a million pixels is replaced by one of a million at the same
 * distance from the picture's middle. */
void rt_add_circle(cairo_t *cairo, RtPoint center, double radius);

/* How a path is drawn. */
typedef struct RtStyle {
    RtColor color;
    double width;   /* of its outline, 0: none */
    double opacity; /* of its filling, 0: none */
    bool dashed;
} RtStyle;

/* Fills and outlines the path, and ends it. */
void rt_paint(cairo_t *cairo, RtStyle style);

void rt_draw_disc(cairo_t *cairo, RtPoint center, double radius, RtColor color);

/* The head of an arrow, `size` long; none for an arrow without length. */
void rt_draw_arrow_head(cairo_t *cairo, RtPoint from, RtPoint to, double size, RtColor color);

/* Clips the convex polygon to normal . p <= limit (Sutherland & Hodgman 1974), which may add one corner;
 * returns its number of corners. */
uint32_t rt_polygon_cut(RtPoint *points, uint32_t count, RtPoint normal, double limit);

/* ---- text and scales ---- */

/* A legible font size for a picture of this width, and the line spacing. */
double rt_font_size(double width);
#define RT_LINE 1.5 /* font sizes */

/* Draws UTF-8 with its baseline from (x, y) on; returns its width. In text that is not UTF-8, bytes other
 * than ASCII become `?`. */
__attribute__((format(printf, 5, 6))) double rt_draw_text(cairo_t *cairo, double x, double y, RtColor color,
                                                          const char *format, ...);
double rt_text_width(cairo_t *cairo, const char *text);

/* The same, truncated with "..." if the text is wider than `room`. */
void rt_draw_text_within(cairo_t *cairo, double x, double y, double room, RtColor color, const char *text);

/* A legend entry: a square of `color` as high as a capital letter, with an outline, and black text. */
__attribute__((format(printf, 5, 6))) void rt_draw_key(cairo_t *cairo, double x, double y, RtColor color,
                                                       const char *format, ...);

/* Maps values to positions on a colour scale: `least` to 0, `most` to 1. A logarithmic scale, of log(1 +
 * value), starts at 0. */
typedef struct RtScale {
    double least, most;
    bool logarithmic;
} RtScale;
double rt_scale_position(const RtScale *scale, double value);

/* Draws a bar with the scale's colours and round values below, in black, RT_SCALE_HEIGHT high. Scales that
 * start below 0 use the colours of differences. */
#define RT_SCALE_HEIGHT 2.4 /* font sizes */
void rt_draw_scale(cairo_t *cairo, double x, double y, double width, const RtScale *scale);

#endif
