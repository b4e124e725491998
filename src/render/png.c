/* SPDX-License-Identifier: Apache-2.0 */
/* PNG through libpng's simplified interface, which has no long jumps. */
#include "render/image.h"

#include "core/base/file.h"

#include <png.h>

RtStatus rt_png_write(const RtImage *image, const char *path, RtError *error) {
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
