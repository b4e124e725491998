/* SPDX-License-Identifier: Apache-2.0 */
/* The picture of a pixel's ray tree. */
#ifndef RT_PICTURE_RAY_TREE_PICTURE_H
#define RT_PICTURE_RAY_TREE_PICTURE_H

#include "render/ray_tree.h"

/* Draws the tree to `file` (canvas.h), with `title` above: the rays in a section of the scene, and a row for
 * each. */
RtStatus rt_ray_tree_draw(const RtRayTree *tree, const RtScene *scene, const char *title, const char *file,
                          RtError *error);

#endif
