/* SPDX-License-Identifier: Apache-2.0 */
/* mount: a fractal mountain of 2 * 4^size triangles, seen through four spheres of glass.
 *
 * E. Haines, "A Proposal for Standard Graphics Environments", IEEE CG&A 7(11), 1987; midpoint displacement
 * after A. Fournier, D. Fussell and L. Carpenter, CACM 25(6), 1982. Each level divides a square into four;
 * a new corner has the mean height of its neighbours plus a normal random number that depends on its
 * lattice position alone, so that adjacent squares fit. Above size 7 the random numbers of the database
 * are undefined (a shift by a negative amount); here the lattice coordinate is shifted the other way. */
#include "scenes/builtin.h"
#include "scenes/spd.h"

static const RtParam params[] = {
    {"size", RT_INT("6", 1, 9, "1|3"), "levels: 2 * 4^size triangles", "SPD: 8192 triangles"},
};

/* A corner of a square: its place in the lattice of 2^size by 2^size squares, and its height. */
typedef struct Corner {
    uint32_t x, y;
    double z;
} Corner;

typedef struct Mount {
    RtSceneBuilder *b;
    uint32_t size;
} Mount;

/* A normal random number that `seed` determines: Marsaglia's polar method over a linear congruential
 * generator. No two numbers of that generator in a row are 0, so `square` is not. */
static double normal_random(uint32_t seed) {
    uint32_t number = seed;
    double v[2], square;
    do {
        for (int i = 0; i < 2; i++) {
            number = (28411 + 8121 * number) % 134456;
            v[i] = 2 * (double)number / 134456 - 1;
        }
        square = v[0] * v[0] + v[1] * v[1];
    } while (square >= 1);
    return v[0] * sqrt(-2 * rt_log(square) / square);
}

static double displacement(const Mount *mount, uint32_t x, uint32_t y) {
    uint32_t size = mount->size;
    uint32_t low = size <= 7 ? x << (7 - size) : x >> (size - 7);
    return normal_random(21 + (((x << (23 - size)) + (y << (15 - size)) + low) & 0xffff));
}

static RtVec3d place(const Mount *mount, Corner corner) {
    double step = 2 / (double)(1u << mount->size);
    return rt_vec3d(corner.x * step - 1, corner.y * step - 1, corner.z);
}

/* The square between corners in counter-clockwise order, the first being the lower left; `half` its side. */
static void add_level(const Mount *mount, const Corner corners[4], double half, uint32_t levels) {
    for (int i = 0; levels == 0 && i < 4; i += 2)
        rt_build_triangle(mount->b, place(mount, corners[i]), place(mount, corners[i + 1]),
                          place(mount, corners[(i + 2) % 4]));
    if (levels == 0) return;
    const double root2 = 1.4142136,
                 roughness = half * sqrt(1.2599210498948731648 - 1); /* the cube root of 2 */
    Corner middle = {.x = (corners[0].x + corners[2].x) / 2, .y = (corners[0].y + corners[2].y) / 2};
    middle.z = (corners[0].z + corners[1].z + corners[2].z + corners[3].z) / 4 +
               roughness * root2 * displacement(mount, middle.x, middle.y);
    Corner sides[4];
    for (int i = 0; i < 4; i++) {
        const Corner *v = &corners[i], *w = &corners[(i + 1) % 4];
        sides[i] = (Corner){.x = (v->x + w->x) / 2, .y = (v->y + w->y) / 2, .z = (v->z + w->z) / 2};
        sides[i].z += roughness * displacement(mount, sides[i].x, sides[i].y);
    }
    for (int i = 0; i < 4; i++) {
        /* Each quarter keeps its own corner where the square has it. */
        Corner quarter[4];
        quarter[i] = corners[i];
        quarter[(i + 1) % 4] = sides[i];
        quarter[(i + 2) % 4] = middle;
        quarter[(i + 3) % 4] = sides[(i + 3) % 4];
        add_level(mount, quarter, half / 2, levels - 1);
    }
}

/* One over the mountain, and three below it, on the edges of a regular tetrahedron. */
static void add_spheres(RtSceneBuilder *b) {
    const double radius = 0.17;
    const RtVec3d center = {-0.8, 0.8, 1}, diagonal = {sqrt(0.5), sqrt(0.5), 0}, z = {0, 0, 1};
    const RtVec3d up = {0, 0, radius * sqrt(1.5)};
    const RtTurn tetrahedral = {.cosine = -1.0 / 3, .sine = sqrt(8.0 / 9)};
    rt_build_material(b, rt_nff_material("glass", rt_vec3(1, 1, 1), 0.1f, 0.1f, 101.148f, 0.9f, 1.5f));
    rt_build_sphere(b, rt_addd(center, up), radius);
    for (int i = 0; i < 3; i++) {
        RtVec3d offset = rt_spd_rotate(rt_spd_rotate(up, diagonal, tetrahedral), z, rt_turn(120.0 * i));
        rt_build_sphere(b, rt_addd(center, offset), radius);
    }
}

static void generate(RtSceneBuilder *b, const RtValue *values) {
    static const RtVec3d lights[1] = {{-100, -100, 100}};
    rt_spd_lights(b, lights, 1);
    b->scene->camera.from = rt_vec3(-1.6f, 1.6f, 1.7f);
    b->scene->camera.near = 0.01f;
    add_spheres(b);
    rt_build_material(b, rt_nff_material("rock", rt_vec3(0.5f, 0.45f, 0.35f), 1, 0, 100000, 0, 1));
    Mount mount = {.b = b, .size = (uint32_t)values[0].i};
    uint32_t side = 1u << mount.size;
    const Corner corners[4] = {{0, 0, 0}, {side, 0, 0}, {side, side, 0}, {0, side, 0}};
    add_level(&mount, corners, 1, mount.size);
}

const RtBuiltin rt_builtin_mount = {
    .name = "mount",
    .summary = "a fractal mountain of triangles of one size, seen through spheres of glass",
    .source = RT_SPD_SOURCE,
    RT_PARAMS_OF(params),
    .generate = generate,
};
