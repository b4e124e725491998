/* SPDX-License-Identifier: Apache-2.0 */
/* lattice: a cube of (size + 1)^3 spheres, joined along the edges of the lattice by cylinders.
 *
 * Standard Procedural Databases of E. Haines, added to the set after its paper of 1987. The cube is that from
 * 0 to 1; the eye is half a spacing below its upper side. Cylinders reach from inside one sphere to inside
 * the next. Objects come in the order of the database: a sphere, and the cylinders to its upper
 * neighbours. */
#include "core/scene/nff.h"
#include "scenes/builtin.h"
#include "scenes/spd.h"

static const RtParam params[] = {
    {"size", RT_INT("12", 1, 400, "1|3"),
     "cells along an edge: (size+1)^3 spheres, 3 size (size+1)^2 cylinders",
     "SPD: 2197 spheres, 6084 cylinders"},
};

enum { JOINT, RODS = JOINT + 1, MATERIALS = RODS + 3 };

static uint64_t object_count(const RtValue *values) {
    uint64_t size = (uint64_t)values[0].i, nodes = size + 1;
    return nodes * nodes * nodes + 3 * size * nodes * nodes;
}

static RtStatus add_node(RtScene *scene, const int64_t node[3], int64_t size, RtError *error) {
    const double spacing = 1 / (double)size, radius = 0.25 * spacing, rod_radius = 0.0625 * spacing;
    const double inset = 0.495 * radius; /* from a sphere's centre to where its cylinders begin */
    RtVec3d center = rt_vec3d((double)node[0] / (double)size, (double)node[1] / (double)size,
                              (double)node[2] / (double)size);
    RT_TRY(rt_scene_add_sphere(scene, JOINT, rt_narrow(center), (float)radius, error));
    for (uint32_t a = 0; a < 3; a++) {
        if (node[a] == size) continue;
        RtVec3d base = center, apex = center;
        base.at[a] += inset;
        apex.at[a] += spacing - inset;
        RT_TRY(rt_scene_add_cone(scene, RODS + a, rt_narrow(base), (float)rod_radius, rt_narrow(apex),
                                 (float)rod_radius, error));
    }
    return RT_OK;
}

static RtStatus add_materials(RtScene *scene, RtError *error) {
    const RtMaterial materials[MATERIALS] = {
        rt_nff_material("joint", rt_vec3(0.9f, 0.9f, 0.9f), 0.5f, 0.5f, 3.0827f, 0, 1),
        rt_nff_material("rod x", rt_vec3(0.9f, 0.1f, 0.1f), 0.99f, 0, 100000, 0, 1),
        rt_nff_material("rod y", rt_vec3(0.1f, 0.9f, 0.1f), 0.99f, 0, 100000, 0, 1),
        rt_nff_material("rod z", rt_vec3(0.1f, 0.1f, 0.9f), 0.99f, 0, 100000, 0, 1)};
    for (int i = 0; i < MATERIALS; i++) {
        uint32_t index;
        RT_TRY(rt_scene_add_material(scene, &materials[i], &index, error));
    }
    return RT_OK;
}

static RtStatus generate(RtScene *scene, const RtValue *values, RtError *error) {
    static const RtVec3 lights[6] = {{2, 0.5f, 0.5f},  {-1, 0.5f, 0.5f}, {0.5f, 2, 0.5f},
                                     {0.5f, -1, 0.5f}, {0.5f, 0.5f, 2},  {0.5f, 0.5f, -1}};
    RT_TRY(rt_spd_add_lights(scene, lights, 6, error));
    const int64_t size = values[0].i;
    const double half = 0.5 / (double)size;
    scene->camera.from = rt_narrow(rt_vec3d(0.5 + half, 1, 1 - half));
    scene->camera.at = rt_narrow(rt_vec3d(0.5 + half, -1, -1 - half));
    scene->camera.up = rt_vec3(0.2f, 1, 0);
    scene->camera.fov = 60;
    RT_TRY(add_materials(scene, error));
    for (int64_t x = 0; x <= size; x++) {
        for (int64_t y = 0; y <= size; y++) {
            for (int64_t z = 0; z <= size; z++) {
                RT_TRY(add_node(scene, (const int64_t[3]){x, y, z}, size, error));
            }
        }
    }
    return RT_OK;
}

const RtBuiltin rt_builtin_lattice = {
    .name = "lattice",
    .summary = "spheres at the points of a cubic lattice, and the cylinders between them",
    .source = RT_SPD_LATER_SOURCE,
    RT_PARAMS_OF(params),
    .object_count = object_count,
    .generate = generate,
};
