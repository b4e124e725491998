/* SPDX-License-Identifier: Apache-2.0 */
/* The pictures of a ray's path through an accelerator, and of a pixel's ray tree. */
#ifndef RT_PICTURE_PATH_PICTURE_H
#define RT_PICTURE_PATH_PICTURE_H

#include "render/path.h"
#include "render/ray_tree.h"

/* Draws the path to `file` (canvas.h), with `title` and `spec` above. */
RtStatus rt_path_draw(const RtPath *path, const RtScene *scene, const char *title, const char *spec,
                      const char *file, RtError *error);

/* Draws the tree, with `title` above: the rays in a section of the scene, and a row for each. */
RtStatus rt_ray_tree_draw(const RtRayTree *tree, const RtScene *scene, const char *title, const char *file,
                          RtError *error);

#endif
