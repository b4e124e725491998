/* SPDX-License-Identifier: Apache-2.0 */
/* Newell's teapot as triangles. */
#ifndef RT_SCENES_TEAPOT_MESH_H
#define RT_SCENES_TEAPOT_MESH_H

#include "scenes/build.h"

/* The finest tessellation. */
#define RT_TEAPOT_MAX_SIZE 1000

/* Adds 64 n^2 - 8 n triangles with vertex normals (32 patches of n x n cells, 1 <= n <= RT_TEAPOT_MAX_SIZE),
 * patch by patch: a teapot 3.15 high and 6.43 long that stands on z = 0 about the z axis, its spout towards
 * +x, moved by b->transform. */
void rt_teapot(RtSceneBuilder *b, uint32_t n);

#endif
