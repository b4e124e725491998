/* SPDX-License-Identifier: Apache-2.0 */
/* Shared by tests of pictures: reading drawn pictures as pixels. */
#ifndef RT_TESTS_PICTURE_TESTING_H
#define RT_TESTS_PICTURE_TESTING_H

#include "testing.h"

#include "picture/canvas.h"

#include <png.h>

/* Reads PICTURE_FILE, which the file that includes this defines, and removes it. Free with rt_image_clear. */
static inline RtImage read_picture(void) {
    RtImage image;
    png_image png = {.version = PNG_IMAGE_VERSION};
    assert_true(png_image_begin_read_from_file(&png, PICTURE_FILE));
    png.format = PNG_FORMAT_RGB;
    assert_ok(rt_image_init(&image, png.width, png.height, error));
    assert_true(png_image_finish_read(&png, NULL, image.rgb, 0, NULL));
    unlink(PICTURE_FILE);
    return image;
}

static inline const uint8_t *pixel(const RtImage *image, int x, int y) {
    return image->rgb + 3 * ((size_t)y * image->width + (size_t)x);
}

static inline uint32_t count_color(const RtImage *image, RtColor color) {
    uint32_t count = 0;
    for (size_t i = 0; i < (size_t)image->width * image->height; i++) {
        const uint8_t *rgb = image->rgb + 3 * i;
        count += rgb[0] == color.rgb[0] && rgb[1] == color.rgb[1] && rgb[2] == color.rgb[2];
    }
    return count;
}

#endif
