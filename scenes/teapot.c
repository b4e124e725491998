/* SPDX-License-Identifier: Apache-2.0 */
/* teapot: Newell's teapot on a checkerboard: many small triangles with vertex normals, a few large quads.
 *
 * As in the Standard Procedural Databases (E. Haines 1987): 64 size^2 - 8 size triangles (teapot_mesh.c) and
 * a board of size x size squares, all of them mirrors. The published tables are of size 12: 9264 objects. */
#include "scenes/builtin.h"
#include "scenes/spd.h"
#include "scenes/teapot_mesh.h"

static const RtParam params[] = {
    {"size", RT_INT("12", 1, RT_TEAPOT_MAX_SIZE, "1|6"),
     "cells along each edge of a patch, and squares along the board: 65 size^2 - 8 size objects",
     "the published tables: 9264 objects"},
};

enum { CHINA, LIGHT_SQUARES, DARK_SQUARES };

static void generate(RtSceneBuilder *b, const RtValue *values) {
    static const RtVec3d lights[2] = {{-3.1f, 9.8f, 12.1f}, {11.3f, 5.1f, 8.8f}};
    uint32_t size = (uint32_t)values[0].i;
    rt_spd_lights(b, lights, 2);
    b->scene->camera.from = rt_vec3(4.86f, 7.2f, 5.4f);
    rt_build_material(b, rt_nff_material("china", rt_vec3(1, 0.5f, 0.1f), 0.75f, 0.25f, 93, 0, 1));
    rt_build_material(b, rt_nff_material("light squares", rt_vec3(1, 0.9f, 0.8f), 0.5f, 0.5f, 300000, 0, 1));
    rt_build_material(b,
                      rt_nff_material("dark squares", rt_vec3(0.3f, 0.25f, 0.2f), 0.5f, 0.5f, 300000, 0, 1));
    b->transformed = true;
    b->material = CHINA;
    rt_teapot(b, size);
    double square = 8.0 / size;
    b->polygons = true;
    for (uint32_t row = 0; row < size; row++) {
        for (uint32_t column = 0; column < size; column++) {
            RtVec3d lo = {column * square - 4, row * square - 4, 0};
            RtVec3d hi = {(column + 1) * square - 4, (row + 1) * square - 4, 0};
            b->material = (row + column) % 2 ? DARK_SQUARES : LIGHT_SQUARES;
            rt_build_box(b, lo, hi, RT_SIDE_TOP);
        }
    }
}

const RtBuiltin rt_builtin_teapot = {
    .name = "teapot",
    .summary = "Newell's teapot on a checkerboard: small triangles with vertex normals, a few large quads",
    .source = RT_SPD_SOURCE,
    RT_PARAMS_OF(params),
    .generate = generate,
};
