/* SPDX-License-Identifier: Apache-2.0 */
#include "scenes/family_places.h"

RtPlacement rt_place_uniform(RtRandom *random, uint32_t i, uint32_t count) {
    (void)i, (void)count;
    RtVec3d p = rt_random_in_cube(random);
    return (RtPlacement){p, rt_random_betweend(random, 0.02, 0.2)};
}

RtPlacement rt_place_coincident(RtRandom *random, uint32_t i, uint32_t count) {
    (void)random, (void)i, (void)count;
    return (RtPlacement){{0.25, 0.5, -0.125}, 0.5};
}

RtPlacement rt_place_on_a_line(RtRandom *random, uint32_t i, uint32_t count) {
    (void)random;
    return (RtPlacement){{-1 + 2.0 * i / count, 0, 0}, 1.0 / count};
}

RtPlacement rt_place_in_a_plane(RtRandom *random, uint32_t i, uint32_t count) {
    (void)i, (void)count;
    RtVec3d p = rt_random_in_cube(random);
    return (RtPlacement){{p.x, p.y, 0.5}, rt_random_betweend(random, 0.02, 0.2)};
}

RtPlacement rt_place_huge_beside_tiny(RtRandom *random, uint32_t i, uint32_t count) {
    (void)count;
    RtVec3d p = rt_random_in_cube(random);
    return i % 8 == 0 ? (RtPlacement){rt_scaled(p, 3), 2} : (RtPlacement){rt_scaled(p, 1e-3), 1e-4};
}

/* Eight clusters, each a hundredth of the world. */
RtPlacement rt_place_clustered(RtRandom *random, uint32_t i, uint32_t count) {
    (void)count;
    RtVec3d corner = {i & 1 ? 0.75 : -0.75, i & 2 ? 0.75 : -0.75, i & 4 ? 0.75 : -0.75};
    RtVec3d p = rt_add_scaledd(corner, rt_random_in_cube(random), 0.01);
    return (RtPlacement){p, rt_random_betweend(random, 0.001, 0.005)};
}

/* Groups of four are identical. */
RtPlacement rt_place_duplicated(RtRandom *random, uint32_t i, uint32_t count) {
    (void)random, (void)count;
    RtRandom shared = rt_random(11, i / 4);
    return rt_place_uniform(&shared, i, count);
}

/* Corners and edges on multiples of 1/4, on the planes of a grid. */
RtPlacement rt_place_on_a_lattice(RtRandom *random, uint32_t i, uint32_t count) {
    (void)count, (void)i;
    RtVec3d p;
    for (int a = 0; a < 3; a++) p.at[a] = floor(rt_random_betweend(random, -4, 4)) / 4 + 0.125;
    return (RtPlacement){p, 0.125};
}

/* Spheres of diameter 1/4 on multiples of 1/4: neighbours touch. Some are half as large, and touch one
 * from inside. */
RtPlacement rt_place_touching(RtRandom *random, uint32_t i, uint32_t count) {
    (void)count;
    RtVec3d p;
    for (int a = 0; a < 3; a++) p.at[a] = floor(rt_random_betweend(random, -3, 3)) / 4;
    if (i % 4 > 0) return (RtPlacement){p, 0.125};
    p.at[i / 4 % 3] += 0.0625;
    return (RtPlacement){p, 0.0625};
}

/* Each half as large as the one before, and half as far from the origin. */
RtPlacement rt_place_in_progression(RtRandom *random, uint32_t i, uint32_t count) {
    (void)random, (void)count;
    double size = ldexp(1, -(int)i);
    return (RtPlacement){{size, size, size}, size / 4};
}

/* Nested: no plane separates them. */
RtPlacement rt_place_concentric(RtRandom *random, uint32_t i, uint32_t count) {
    (void)random;
    return (RtPlacement){{0.25, 0.5, -0.125}, (i + 1.0) / count};
}

/* As large as the world, in planes that many share. */
RtPlacement rt_place_stacked(RtRandom *random, uint32_t i, uint32_t count) {
    (void)i, (void)count;
    RtVec3d p;
    for (int a = 0; a < 3; a++) p.at[a] = floor(rt_random_betweend(random, -2, 2)) / 4;
    return (RtPlacement){p, 0.5 + 0.25 * rt_random_below(random, 3)};
}

/* Alternating: one has edges in the coordinate planes, which meet at the origin, the next lies in them:
 * the lattice, and the lattice moved by half its width. */
RtPlacement rt_place_around_the_origin(RtRandom *random, uint32_t i, uint32_t count) {
    RtPlacement at = rt_place_on_a_lattice(random, i, count);
    if (i / 2 % 2) at.center = rt_subd(at.center, rt_vec3d(0.125, 0.125, 0.125));
    return at;
}
