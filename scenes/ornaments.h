/* SPDX-License-Identifier: Apache-2.0 */
/* The furniture of a hall, made of triangles: each stands on (or hangs at) the origin of b->transform and
 * has b->material. `size`, from 1, sets the tessellation: round parts have a few times as many sides.
 * Lengths are in metres. */
#ifndef RT_SCENES_ORNAMENTS_H
#define RT_SCENES_ORNAMENTS_H

#include "scenes/build.h"

#define RT_COLUMN_HEIGHT 4.9

/* A column of RT_COLUMN_HEIGHT on a plinth of 1.24 by 1.24: mouldings, a fluted shaft (long thin triangles),
 * a capital with two rows of leaves. */
void rt_ornament_column(RtSceneBuilder *b, uint32_t size);

/* A vase 1.3 high, of one of the `kinds` there are. */
enum { RT_VASE_KINDS = 3 };
void rt_ornament_vase(RtSceneBuilder *b, uint32_t size, uint32_t kind);

/* A baluster, .8 high and .2 thick. */
void rt_ornament_baluster(RtSceneBuilder *b, uint32_t size);

/* A chandelier, 2.3 across and hanging by a chain of `links` of .12 each; the origin is in the middle of its
 * ring. */
void rt_ornament_chandelier(RtSceneBuilder *b, uint32_t size, uint32_t links);

#endif
