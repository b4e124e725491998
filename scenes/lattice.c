/* SPDX-License-Identifier: Apache-2.0 */
/* lattice: a cube of (size + 1)^3 spheres, joined along the edges of the lattice by cylinders.
 *
 * Standard Procedural Databases of E. Haines, added after its paper of 1987. The cube is that from 0 to 1;
 * the eye is half a spacing below its upper side. Cylinders reach from inside one sphere to inside the
 * next. Objects come in the order of the database: a sphere, then the cylinders to its upper neighbours. */
#include "scenes/builtin.h"
#include "scenes/spd.h"

static const RtParam params[] = {
    {"size", RT_INT("12", 1, 400, "1|3"),
     "cells along an edge: (size+1)^3 spheres, 3 size (size+1)^2 cylinders",
     "SPD: 2197 spheres, 6084 cylinders"},
};

enum { JOINT, RODS }; /* materials; a rod has that of its axis */

static uint64_t object_count(const RtValue *values) {
    uint64_t size = (uint64_t)values[0].i, nodes = size + 1;
    return nodes * nodes * nodes + 3 * size * nodes * nodes;
}

static void add_node(RtSceneBuilder *b, const int64_t node[3], int64_t size) {
    const double spacing = 1 / (double)size, radius = 0.25 * spacing, rod_radius = 0.0625 * spacing;
    const double inset = 0.495 * radius; /* from a sphere's centre to where its cylinders begin */
    RtVec3d center;
    for (int a = 0; a < 3; a++) center.at[a] = (double)node[a] / (double)size;
    b->material = JOINT;
    rt_build_sphere(b, center, radius);
    for (uint32_t a = 0; a < 3; a++) {
        if (node[a] == size) continue;
        RtVec3d base = center, apex = center;
        base.at[a] += inset;
        apex.at[a] += spacing - inset;
        b->material = RODS + a;
        rt_build_cone(b, base, rod_radius, apex, rod_radius);
    }
}

static void generate(RtSceneBuilder *b, const RtValue *values) {
    static const RtVec3d lights[6] = {{2, 0.5, 0.5},  {-1, 0.5, 0.5}, {0.5, 2, 0.5},
                                      {0.5, -1, 0.5}, {0.5, 0.5, 2},  {0.5, 0.5, -1}};
    const int64_t size = values[0].i, nodes = size + 1;
    const double half = 0.5 / (double)size;
    RtCamera *camera = &b->scene->camera;
    rt_spd_lights(b, lights, 6);
    camera->from = rt_narrow(rt_vec3d(0.5 + half, 1, 1 - half));
    camera->at = rt_narrow(rt_vec3d(0.5 + half, -1, -1 - half));
    camera->up = rt_vec3(0.2f, 1, 0);
    camera->fov = 60;
    rt_build_material(b, rt_nff_material("joint", rt_vec3(0.9f, 0.9f, 0.9f), 0.5f, 0.5f, 3.0827f, 0, 1));
    rt_build_material(b, rt_nff_material("rod x", rt_vec3(0.9f, 0.1f, 0.1f), 0.99f, 0, 100000, 0, 1));
    rt_build_material(b, rt_nff_material("rod y", rt_vec3(0.1f, 0.9f, 0.1f), 0.99f, 0, 100000, 0, 1));
    rt_build_material(b, rt_nff_material("rod z", rt_vec3(0.1f, 0.1f, 0.9f), 0.99f, 0, 100000, 0, 1));
    for (int64_t i = 0; i < nodes * nodes * nodes; i++)
        add_node(b, (const int64_t[3]){i / nodes / nodes, i / nodes % nodes, i % nodes}, size);
}

const RtBuiltin rt_builtin_lattice = {
    .name = "lattice",
    .summary = "spheres at the points of a cubic lattice, and the cylinders between them",
    .source = RT_SPD_LATER_SOURCE,
    RT_PARAMS_OF(params),
    .object_count = object_count,
    .generate = generate,
};
