/* SPDX-License-Identifier: Apache-2.0 */
/* Pictures of the embedding interface. */
#include "library/library.h"
#include "render/image.h"

#include <string.h>

static void copy_pixels(const RtFrame *frame, float *rgb) {
    for (uint32_t y = 0; y < frame->sampling.height; y++) {
        for (uint32_t x = 0; x < frame->sampling.width; x++, rgb += 3) {
            RtVec3 color = rt_frame_pixel(frame, x, y);
            memcpy(rgb, &color, sizeof color);
        }
    }
}

raytally_status raytally_render(const raytally_accelerator *accelerator, uint32_t depth, int threads,
                                const char *png, float *rgb, raytally_error *error) {
    RtFrame frame = {0};
    RtFrameOptions options = {.depth = depth ? depth : RT_DEFAULT_DEPTH, .threads = threads};
    RT_C_LOCALE;
    RtStatus status = rt_threads_check(threads, rt_error_of(error));
    if (status == RT_OK) status = rt_frame_trace(&frame, accelerator->accel, &options, rt_error_of(error));
    if (status == RT_OK && png) status = rt_png_write(&frame, png, rt_error_of(error));
    if (status == RT_OK && rgb) copy_pixels(&frame, rgb);
    rt_frame_clear(&frame);
    return (raytally_status)status;
}
