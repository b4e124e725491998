/* SPDX-License-Identifier: Apache-2.0 */
#include "core/base/random.h"

/* Random123's headers are not clean under our warnings. */
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wsign-conversion"
#pragma GCC diagnostic ignored "-Wundef"
#pragma GCC diagnostic ignored "-Wpedantic"
#pragma GCC diagnostic ignored "-Wstrict-prototypes"
#include <Random123/philox.h>
#pragma GCC diagnostic pop

RtRandom rt_random(uint64_t seed, uint64_t stream) {
    return (RtRandom){.seed = seed, .stream = stream, .next = 0, .used = 4};
}

uint32_t rt_random_bits(RtRandom *random) {
    if (random->used == 4) {
        philox4x32_ctr_t counter = {{(uint32_t)random->next, (uint32_t)(random->next >> 32),
                                     (uint32_t)random->stream, (uint32_t)(random->stream >> 32)}};
        philox4x32_key_t key = {{(uint32_t)random->seed, (uint32_t)(random->seed >> 32)}};
        philox4x32_ctr_t block = philox4x32(counter, key);
        for (int i = 0; i < 4; i++) random->block[i] = block.v[i];
        random->next++;
        random->used = 0;
    }
    return random->block[random->used++];
}

void rt_random_shuffle(RtRandom *random, size_t *order, size_t count) {
    for (size_t i = count; i > 1; i--) {
        size_t k = ((uint64_t)rt_random_bits(random) * i) >> 32, other = order[k];
        order[k] = order[i - 1];
        order[i - 1] = other;
    }
}

float rt_random_unit(RtRandom *random) {
    return (float)(rt_random_bits(random) >> 8) * 0x1p-24f;
}

RtVec3d rt_random_direction(RtRandom *random) {
    for (;;) {
        RtVec3d d = rt_random_in_cube(random);
        double dd = rt_dotd(d, d);
        if (dd > 1e-4 && dd <= 1) return rt_normalized(d);
    }
}

RtVec3d rt_random_cosine(RtRandom *random, RtVec3d normal) {
    for (;;) {
        RtVec3d sum = rt_addd(normal, rt_random_direction(random));
        if (rt_dotd(sum, sum) > 1e-6) return rt_normalized(sum);
    }
}
