/* SPDX-License-Identifier: Apache-2.0 */
/* Images: from the samples of a frame to pixels and files. Files are written completely or not at all. */
#ifndef RT_RENDER_IMAGE_H
#define RT_RENDER_IMAGE_H

#include "render/frame.h"

/* 8-bit sRGB, as in a PNG. Owns its pixels. */
typedef struct RtImage {
    uint32_t width, height;
    uint8_t *rgb; /* [height][width][3], from the upper left */
} RtImage;

/* A linear value as 8 bits of sRGB, clipped to 0..1. */
uint8_t rt_srgb(float linear);

/* A black image. Free with rt_image_clear. */
RtStatus rt_image_init(RtImage *image, uint32_t width, uint32_t height, RtError *error);
void rt_image_clear(RtImage *image);

/* The samples of one pixel: `span` x `span` of the frame's grid, from (column, row) on. N x N of its own,
 * or, for samples at corners, its 4 corners, shared with its neighbours. */
typedef struct RtFootprint {
    uint32_t column, row, span;
} RtFootprint;
RtFootprint rt_pixel_footprint(const RtSampling *sampling, uint32_t x, uint32_t y);

/* The mean colour of a pixel's samples, linear. */
RtVec3 rt_frame_pixel(const RtFrame *frame, uint32_t x, uint32_t y);

/* The mean of one counter over a pixel's samples; `counter` as in rt_tally_get, the frame counted. */
double rt_frame_cost(const RtFrame *frame, size_t counter, uint32_t x, uint32_t y);

/* The frame as an image: mean colours, clipped to 0..1. */
RtStatus rt_image_from_frame(RtImage *image, const RtFrame *frame, RtError *error);

/* That image: 8 bits a channel, sRGB. */
RtStatus rt_png_write(const RtFrame *frame, const char *path, RtError *error);

#endif
