/* SPDX-License-Identifier: Apache-2.0 */
/* Positions and sizes of the objects in a family of scenes. */
#ifndef RT_SCENES_FAMILY_PLACES_H
#define RT_SCENES_FAMILY_PLACES_H

#include "core/base/random.h"

/* Centre and size of object `i` of `count`, in a world of about [-1, 1]^3. */
typedef struct RtPlacement {
    RtVec3d center;
    double size;
} RtPlacement;
typedef RtPlacement RtPlace(RtRandom *random, uint32_t i, uint32_t count);

RtPlace rt_place_uniform, rt_place_coincident, rt_place_on_a_line, rt_place_in_a_plane,
    rt_place_huge_beside_tiny, rt_place_clustered, rt_place_duplicated, rt_place_on_a_lattice,
    rt_place_touching, rt_place_in_progression, rt_place_concentric, rt_place_stacked,
    rt_place_around_the_origin;

#endif
