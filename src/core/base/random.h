/* SPDX-License-Identifier: Apache-2.0 */
/* Counter-based random numbers (Philox 4x32-10, Salmon et al. 2011, through Random123): the nth number of
 * a stream depends on (seed, stream, n) alone, so any part of an experiment can be generated separately,
 * on any thread. Uniform numbers use + - * only and are the same bits everywhere. Never draw two numbers
 * in one initialiser or argument list, nor on both sides of an operator: C does not define their order. */
#ifndef RT_BASE_RANDOM_H
#define RT_BASE_RANDOM_H

#include "core/base/vec.h"

#include <stddef.h>
#include <stdint.h>

typedef struct RtRandom {
    uint64_t seed, stream;
    uint64_t next; /* block to generate next */
    uint32_t block[4];
    uint32_t used; /* words of `block` already used; 4 = all */
} RtRandom;

/* The stream numbered `stream` of `seed`, from its beginning. */
RtRandom rt_random(uint64_t seed, uint64_t stream);

/* 32 uniform bits. */
uint32_t rt_random_bits(RtRandom *random);

/* One of 0..count-1, count > 0; uniform to within count / 2^32. */
static inline uint32_t rt_random_below(RtRandom *random, uint32_t count) {
    return rt_random_bits(random) % count;
}

/* Puts order[0..count) into a random order. */
void rt_random_shuffle(RtRandom *random, size_t *order, size_t count);

/* Uniform in [0, 1), a multiple of 2^-24. */
float rt_random_unit(RtRandom *random);

/* Uniform in [lo, hi). */
static inline float rt_random_between(RtRandom *random, float lo, float hi) {
    return lo + (hi - lo) * rt_random_unit(random);
}

static inline double rt_random_betweend(RtRandom *random, double lo, double hi) {
    return lo + (hi - lo) * (double)rt_random_unit(random);
}

/* Uniform in the cube of points with coordinates in [-1, 1). */
static inline RtVec3d rt_random_in_cube(RtRandom *random) {
    RtVec3d p;
    for (int a = 0; a < 3; a++) p.at[a] = rt_random_betweend(random, -1, 1);
    return p;
}

/* Uniform on the unit sphere, by rejection from the cube: no sine or cosine, the same bits everywhere. */
RtVec3d rt_random_direction(RtRandom *random);

/* Cosine-distributed about the unit vector `normal`: normal + a uniform direction, normalised. */
RtVec3d rt_random_cosine(RtRandom *random, RtVec3d normal);

#endif
