/* SPDX-License-Identifier: Apache-2.0 */
/* The picture of a ray's path through an accelerator. */
#ifndef RT_PICTURE_PATH_PICTURE_H
#define RT_PICTURE_PATH_PICTURE_H

#include "render/path.h"

/* Draws the path to `file` (canvas.h), with `title` and `spec` above. */
RtStatus rt_path_draw(const RtPath *path, const RtScene *scene, const char *title, const char *spec,
                      const char *file, RtError *error);

#endif
