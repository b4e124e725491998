/* SPDX-License-Identifier: Apache-2.0 */
#include "render/frame.h"

#include "core/base/elementary.h"
#include "core/base/file.h"
#include "core/base/memory.h"

#include <png.h>

RtStatus rt_image_init(RtImage *image, uint32_t width, uint32_t height, RtError *error) {
    size_t pixels = (size_t)width * height;
    *image = (RtImage){width, height, rt_alloc(pixels, 3)};
    return image->rgb ? RT_OK : rt_fail_memory(error, "an image", pixels * 3);
}

void rt_image_clear(RtImage *image) {
    rt_free(image->rgb);
    *image = (RtImage){0};
}

RtFootprint rt_pixel_footprint(const RtSampling *sampling, uint32_t x, uint32_t y) {
    if (sampling->corners) return (RtFootprint){x, y, 2};
    return (RtFootprint){x * sampling->samples, y * sampling->samples, sampling->samples};
}

RtVec3 rt_frame_pixel(const RtFrame *frame, uint32_t x, uint32_t y) {
    RtFootprint f = rt_pixel_footprint(&frame->sampling, x, y);
    RtVec3d sum = {0, 0, 0};
    for (uint32_t row = f.row; row < f.row + f.span; row++) {
        const RtVec3 *samples = frame->color + (size_t)row * frame->sampling.columns + f.column;
        for (uint32_t i = 0; i < f.span; i++) sum = rt_addd(sum, rt_widen(samples[i]));
    }
    return rt_narrow(rt_scaled(sum, 1.0 / (f.span * f.span)));
}

double rt_frame_cost(const RtFrame *frame, size_t counter, uint32_t x, uint32_t y) {
    RtFootprint f = rt_pixel_footprint(&frame->sampling, x, y);
    uint64_t sum = 0;
    for (uint32_t row = f.row; row < f.row + f.span; row++) {
        const RtTally *samples = frame->cost + (size_t)row * frame->sampling.columns + f.column;
        for (uint32_t i = 0; i < f.span; i++) sum += rt_tally_get(&samples[i], counter);
    }
    return (double)sum / (f.span * f.span);
}

/* IEC 61966-2-1. */
uint8_t rt_srgb(float linear) {
    if (!(linear > 0)) return 0;
    if (linear >= 1) return 255;
    double x = (double)linear;
    double encoded = x <= 0.0031308 ? 12.92 * x : 1.055 * rt_power(x, 1 / 2.4) - 0.055;
    return (uint8_t)(encoded * 255 + 0.5);
}

RtStatus rt_image_from_frame(RtImage *image, const RtFrame *frame, RtError *error) {
    RT_TRY(rt_image_init(image, frame->sampling.width, frame->sampling.height, error));
    uint8_t *out = image->rgb;
    for (uint32_t y = 0; y < image->height; y++) {
        for (uint32_t x = 0; x < image->width; x++) {
            RtVec3 color = rt_frame_pixel(frame, x, y);
            for (int channel = 0; channel < 3; channel++) *out++ = rt_srgb(color.at[channel]);
        }
    }
    return RT_OK;
}

/* libpng's simplified interface, which uses no longjmp. */
static RtStatus write_png(const RtImage *image, const char *path, RtError *error) {
    RtOutput output;
    RT_TRY(rt_output_open(&output, path, error));
    png_image png = {.version = PNG_IMAGE_VERSION,
                     .width = image->width,
                     .height = image->height,
                     .format = PNG_FORMAT_RGB};
    if (!png_image_write_to_stdio(&png, output.file, 0, image->rgb, 0, NULL)) {
        rt_output_discard(&output);
        return rt_fail(error, RT_IO, "%s: writing the PNG failed: %s", path, png.message);
    }
    return rt_output_commit(&output, error);
}

RtStatus rt_png_write(const RtFrame *frame, const char *path, RtError *error) {
    RtImage image;
    RT_TRY(rt_image_from_frame(&image, frame, error));
    RtStatus status = write_png(&image, path, error);
    rt_image_clear(&image);
    return status;
}
