/* SPDX-License-Identifier: Apache-2.0 */
#include "core/scene/texture.h"

#include "core/base/elementary.h"
#include "core/base/memory.h"

#include <png.h>
#include <stdlib.h>

enum { MOST_BYTES = 1 << 28, MOST_TEXELS = 1 << 26 };

/* libpng's simplified interface, which uses no longjmp. */
static RtStatus decode(const char *bytes, size_t size, RtTexels *texels, RtError *error) {
    png_image png = {.version = PNG_IMAGE_VERSION};
    if (!png_image_begin_read_from_memory(&png, bytes, size))
        return rt_fail_at(error, texels->path, 0, 0, "expected a PNG image: %s", png.message);
    const size_t count = (size_t)png.width * png.height;
    RtStatus status = RT_OK;
    png.format = PNG_FORMAT_RGB;
    png.flags |= PNG_IMAGE_FLAG_16BIT_sRGB;
    texels->width = png.width;
    texels->height = png.height;
    if (count > MOST_TEXELS)
        status =
            rt_fail_at(error, texels->path, 0, 0, "%u x %u pixels are too many: make it smaller, %d at most",
                       png.width, png.height, MOST_TEXELS);
    else if (!(texels->rgb = rt_alloc(count, 3)))
        status = rt_fail_memory(error, "an image", 3 * count);
    else if (!png_image_finish_read(&png, NULL, texels->rgb, 0, NULL))
        status = rt_fail_at(error, texels->path, 0, 0, "the PNG image is damaged: %s", png.message);
    png_image_free(&png);
    return status;
}

/* IEC 61966-2-1. */
static float linear_of(int byte) {
    const double encoded = byte / 255.0;
    return (float)(encoded <= 0.04045 ? encoded / 12.92 : rt_power((encoded + 0.055) / 1.055, 2.4));
}

RtStatus rt_texels_load(const char *path, RtTexels **out, RtError *error) {
    char *bytes;
    size_t size;
    RT_TRY(rt_file_read(path, MOST_BYTES, &bytes, &size, error));
    RtTexels *texels = rt_alloc(1, sizeof *texels);
    RtStatus status = RT_OK;
    if (texels) {
        texels->users = 1;
        if (!realpath(path, texels->path)) snprintf(texels->path, sizeof texels->path, "%s", path);
        for (int byte = 0; byte < 256; byte++) texels->linear[byte] = linear_of(byte);
        status = decode(bytes, size, texels, error);
    } else {
        status = rt_fail_memory(error, "an image", sizeof *texels);
    }
    rt_free(bytes);
    if (status == RT_OK)
        *out = texels;
    else
        rt_texels_release(texels);
    return status;
}

void rt_texels_share(RtTexels *texels) {
    if (texels) texels->users++;
}

void rt_texels_release(RtTexels *texels) {
    if (!texels || --texels->users > 0) return;
    rt_free(texels->rgb);
    rt_free(texels);
}

/* Which of `count` texels a coordinate lies in. */
static uint32_t texel_at(double coordinate, uint32_t count) {
    const double at = (coordinate - floor(coordinate)) * count;
    return at < count ? (uint32_t)at : count - 1;
}

RtVec3 rt_texture_color(const RtTexture *texture, RtVec3 color, double u, double v) {
    const RtTexels *texels = texture->texels;
    u /= (double)texture->size;
    v /= (double)texture->size;
    if (!texels) return fmod(floor(u) + floor(v), 2) == 0 ? color : texture->color;
    const size_t row = texels->height - 1 - texel_at(v, texels->height);
    const uint8_t *rgb = texels->rgb + 3 * (row * texels->width + texel_at(u, texels->width));
    return rt_mul(color, rt_vec3(texels->linear[rgb[0]], texels->linear[rgb[1]], texels->linear[rgb[2]]));
}
