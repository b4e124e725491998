/* SPDX-License-Identifier: Apache-2.0 */
/* Positions and sizes of the objects in a family of scenes. */
#ifndef RT_SCENES_FAMILY_PLACES_H
#define RT_SCENES_FAMILY_PLACES_H

#include "core/base/random.h"

typedef struct RtPlacement {
    RtVec3d center;
    double size;
} RtPlacement;

typedef enum RtPlace {
    RT_PLACE_UNIFORM,
    RT_PLACE_COINCIDENT,
    RT_PLACE_ON_A_LINE,
    RT_PLACE_IN_A_PLANE,
    RT_PLACE_HUGE_BESIDE_TINY,
    RT_PLACE_CLUSTERED,    /* eight clusters, each a hundredth of the world */
    RT_PLACE_DUPLICATED,   /* groups of four are identical */
    RT_PLACE_ON_A_LATTICE, /* corners and edges on multiples of 1/4, on the planes of a grid */
    RT_PLACE_TOUCHING,     /* spheres of diameter 1/4 on multiples of 1/4: neighbours touch. Some are half as
                            * large, and touch one from inside */
    RT_PLACE_IN_PROGRESSION,   /* each half as large as the one before, and half as far from the origin */
    RT_PLACE_CONCENTRIC,       /* nested: no plane separates them */
    RT_PLACE_STACKED,          /* as large as the world, in planes that many share */
    RT_PLACE_AROUND_THE_ORIGIN /* the lattice, and by turns the lattice moved by half its width: one has edges
                                * in the coordinate planes, which meet at the origin, the next lies in them */
} RtPlace;

/* Centre and size of object `i` of `count`, in a world of about [-1, 1]^3. */
RtPlacement rt_place(RtPlace place, RtRandom *random, uint32_t i, uint32_t count);

#endif
