/* SPDX-License-Identifier: Apache-2.0 */
/* Random CSG trees, for testing accelerators and the trees themselves. */
#ifndef RT_SCENES_RANDOM_TREE_H
#define RT_SCENES_RANDOM_TREE_H

#include "core/base/random.h"
#include "core/shape/csg.h"

#define RT_MAX_RANDOM_TREE 64

typedef struct RtTreeRecipe {
    uint32_t solids; /* 1..RT_MAX_RANDOM_TREE; a half-space adds one more */
    bool coarse;     /* coordinates are multiples of 1/2 and turns of 90 degrees: many faces coincide */
} RtTreeRecipe;

/* A term of random solids of every kind with random operations and moves, within about 4 of the origin
 * along each axis; its inside may be empty. The solids get materials below `materials`. */
RtStatus rt_random_tree(RtCsgBuilder *builder, RtRandom *random, const RtTreeRecipe *recipe,
                        uint32_t materials, RtCsgTerm *root, RtError *error);

/* An axis-aligned box, with exactly these planes. */
RtStatus rt_add_box(RtCsgBuilder *builder, RtBox box, uint32_t material, RtCsgTerm *out, RtError *error);

#endif
