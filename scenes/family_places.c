/* SPDX-License-Identifier: Apache-2.0 */
#include "scenes/family_places.h"

/* Multiples of 1/4 from -most / 4 on, below most / 4. */
static RtVec3d on_quarters(RtRandom *random, double most) {
    RtVec3d p;
    for (int a = 0; a < 3; a++) p.at[a] = floor(rt_random_betweend(random, -most, most)) / 4;
    return p;
}

static RtPlacement of_any_size(RtVec3d center, RtRandom *random) {
    return (RtPlacement){center, rt_random_betweend(random, 0.02, 0.2)};
}

RtPlacement rt_place(RtPlace place, RtRandom *random, uint32_t i, uint32_t count) {
    const RtVec3d aside = {0.25, 0.5, -0.125}, half = {0.125, 0.125, 0.125};
    const double size = ldexp(1, -(int)i);
    RtRandom shared = rt_random(11, i / 4);
    RtVec3d p;
    switch (place) {
    case RT_PLACE_UNIFORM: return of_any_size(rt_random_in_cube(random), random);
    case RT_PLACE_COINCIDENT: return (RtPlacement){aside, 0.5};
    case RT_PLACE_ON_A_LINE: return (RtPlacement){{-1 + 2.0 * i / count, 0, 0}, 1.0 / count};
    case RT_PLACE_IN_A_PLANE:
        p = rt_random_in_cube(random);
        return of_any_size(rt_vec3d(p.x, p.y, 0.5), random);
    case RT_PLACE_HUGE_BESIDE_TINY:
        p = rt_random_in_cube(random);
        return i % 8 == 0 ? (RtPlacement){rt_scaled(p, 3), 2} : (RtPlacement){rt_scaled(p, 1e-3), 1e-4};
    case RT_PLACE_CLUSTERED:
        p = rt_vec3d(i & 1 ? 0.75 : -0.75, i & 2 ? 0.75 : -0.75, i & 4 ? 0.75 : -0.75);
        p = rt_add_scaledd(p, rt_random_in_cube(random), 0.01);
        return (RtPlacement){p, rt_random_betweend(random, 0.001, 0.005)};
    case RT_PLACE_DUPLICATED: return rt_place(RT_PLACE_UNIFORM, &shared, i, count);
    case RT_PLACE_ON_A_LATTICE: return (RtPlacement){rt_addd(on_quarters(random, 4), half), 0.125};
    case RT_PLACE_TOUCHING:
        p = on_quarters(random, 3);
        if (i % 4 > 0) return (RtPlacement){p, 0.125};
        p.at[i / 4 % 3] += 0.0625;
        return (RtPlacement){p, 0.0625};
    case RT_PLACE_IN_PROGRESSION: return (RtPlacement){{size, size, size}, size / 4};
    case RT_PLACE_CONCENTRIC: return (RtPlacement){aside, (i + 1.0) / count};
    case RT_PLACE_STACKED:
        p = on_quarters(random, 2);
        return (RtPlacement){p, 0.5 + 0.25 * rt_random_below(random, 3)};
    case RT_PLACE_AROUND_THE_ORIGIN:
        p = rt_addd(on_quarters(random, 4), half);
        return (RtPlacement){i / 2 % 2 ? rt_subd(p, half) : p, 0.125};
    }
    return (RtPlacement){aside, 0.5};
}
