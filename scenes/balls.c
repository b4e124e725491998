/* SPDX-License-Identifier: Apache-2.0 */
/* balls: the sphereflake over a floor, 9^0 + ... + 9^size spheres and one polygon.
 *
 * E. Haines, "A Proposal for Standard Graphics Environments", IEEE CG&A 7(11), 1987. Every sphere carries
 * nine of a third of its radius: six around its equator and three towards its tip. The root's tip is +Z, a
 * child's the direction in which it sits. Objects come depth first, in the order of the Standard
 * Procedural Databases. All angles have known sines and cosines, so only + - * / sqrt are used. */
#include "scenes/builtin.h"
#include "scenes/spd.h"

static const RtParam params[] = {
    {"size", RT_INT("4", 1, 7, "1|3"), "levels below the root: (9^(size+1) - 1) / 8 spheres",
     "SPD: 7381 spheres"},
};

enum { CHILDREN = 9 };

/* Unit directions of the children of a sphere that points to +Z. */
static void set_offsets(RtVec3d offsets[CHILDREN]) {
    double d = sqrt(0.5);
    const RtVec3d trio[3] = {{d, d, 0}, {d, 0, -d}, {0, d, -d}};
    const RtVec3d axis = {d, -d, 0}, z = {0, 0, 1};
    const RtTurn tilt = {.cosine = sqrt(1.0 / 3), .sine = sqrt(2.0 / 3)};
    const RtTurn thirds[3] = {{1, 0}, {-0.5, sqrt(0.75)}, {-0.5, -sqrt(0.75)}};
    for (int i = 0; i < CHILDREN; i++)
        offsets[i] = rt_spd_rotate(rt_spd_rotate(trio[i % 3], axis, tilt), z, thirds[i / 3]);
}

static void add_flake(RtSceneBuilder *b, const RtVec3d offsets[CHILDREN], RtVec3d center, double radius,
                      RtVec3d direction, int64_t levels) {
    rt_build_sphere(b, center, radius);
    for (int i = 0; levels > 0 && i < CHILDREN; i++) {
        RtVec3d towards = rt_spd_rotate_from_z(offsets[i], direction);
        RtVec3d child = rt_add_scaledd(center, towards, radius * (1 + 1.0 / 3));
        add_flake(b, offsets, child, radius / 3, towards, levels - 1);
    }
}

static void generate(RtSceneBuilder *b, const RtValue *values) {
    static const RtVec3d lights[3] = {{4, 3, 2}, {1, -4, 4}, {-3, 1, 5}};
    static const RtVec3d floor[4] = {{12, 12, -0.5}, {-12, 12, -0.5}, {-12, -12, -0.5}, {12, -12, -0.5}};
    RtVec3d offsets[CHILDREN];
    set_offsets(offsets);
    rt_spd_lights(b, lights, 3);
    b->scene->camera.from = rt_vec3(2.1f, 1.3f, 1.7f);
    b->scene->camera.near = 0.01f;
    rt_build_material(b, rt_nff_material("floor", rt_vec3(1, 0.75f, 0.33f), 0.8f, 0, 100000, 0, 1));
    rt_build_polygon(b, floor, 4);
    rt_build_material(b, rt_nff_material("balls", rt_vec3(1, 0.9f, 0.7f), 0.5f, 0.5f, 3.0827f, 0, 1));
    add_flake(b, offsets, rt_vec3d(0, 0, 0), 0.5, rt_vec3d(0, 0, 1), values[0].i);
}

const RtBuiltin rt_builtin_balls = {
    .name = "balls",
    .summary = "a sphereflake over a floor: reflective spheres of very different sizes, touching",
    .source = RT_SPD_SOURCE,
    RT_PARAMS_OF(params),
    .generate = generate,
};
