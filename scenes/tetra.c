/* SPDX-License-Identifier: Apache-2.0 */
/* tetra: a Sierpinski tetrahedron of 4^size triangles.
 *
 * E. Haines, "A Proposal for Standard Graphics Environments", IEEE CG&A 7(11), 1987. A cube holds a regular
 * tetrahedron at the four corners whose signs have a product of +1; each level replaces it by four of half
 * its size in those corners. Objects come depth first, in the order of the Standard Procedural Databases. All
 * coordinates are exact. */
#include "scenes/builtin.h"
#include "scenes/spd.h"

static const RtParam params[] = {
    {"size", RT_INT("6", 1, 9, "1|3"), "levels: 4^size triangles", "SPD: 4096 triangles"},
};

/* The corner of the cube about `center` at the signs (x, y, x * y). */
static RtVec3d corner(RtVec3d center, double half, double x, double y) {
    return rt_addd(center, rt_vec3d(x * half, y * half, x * y * half));
}

static void add_level(RtSceneBuilder *b, RtVec3d center, double half, int64_t levels) {
    static const double face_x[4] = {-1, 1, 1, -1}, face_y[4] = {-1, 1, -1, 1};
    for (int i = 0; i < 4; i++) {
        if (levels == 1) {
            double x = face_x[i], y = face_y[i];
            rt_build_triangle(b, corner(center, half, x, y), corner(center, half, x, -y),
                              corner(center, half, -x, y));
        } else {
            add_level(b, corner(center, half / 2, i / 2 ? 1 : -1, i % 2 ? 1 : -1), half / 2, levels - 1);
        }
    }
}

static void generate(RtSceneBuilder *b, const RtValue *values) {
    static const RtVec3d lights[1] = {{2, -18, -5}};
    rt_spd_lights(b, lights, 1);
    b->scene->camera.from = rt_vec3(1.022846f, -3.177154f, -2.174512f);
    b->scene->camera.at = rt_vec3(-0.004103f, -0.004103f, 0.216539f);
    b->scene->camera.up = rt_vec3(-0.816497f, -0.816497f, 0.816497f);
    b->scene->camera.near = 1;
    rt_build_material(b, rt_nff_material("red", rt_vec3(1, 0.2f, 0.2f), 1, 0, 100000, 0, 1));
    add_level(b, rt_vec3d(0, 0, 0), 1, values[0].i);
}

const RtBuiltin rt_builtin_tetra = {
    .name = "tetra",
    .summary = "a Sierpinski tetrahedron of triangles, mostly empty space",
    .source = RT_SPD_SOURCE,
    RT_PARAMS_OF(params),
    .generate = generate,
};
