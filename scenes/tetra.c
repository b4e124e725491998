/* SPDX-License-Identifier: Apache-2.0 */
/* tetra: a Sierpinski tetrahedron of 4^size triangles.
 *
 * E. Haines, "A Proposal for Standard Graphics Environments", IEEE CG&A 7(11), 1987. A cube holds a regular
 * tetrahedron at the four corners whose signs have a product of +1; each level replaces it by four of half
 * its size in those corners. Objects come depth first, in the order of the Standard Procedural Databases. All
 * coordinates are exact. */
#include "core/scene/nff.h"
#include "scenes/builtin.h"
#include "scenes/spd.h"

static const RtParam params[] = {
    {"size", RT_INT("6", 1, 9, "1|3"), "levels: 4^size triangles", "SPD: 4096 triangles"},
};

static uint64_t object_count(const RtValue *values) {
    return UINT64_C(1) << 2 * values[0].i;
}

/* The corner of the cube about `center` at the signs (x, y, x * y). */
static RtVec3 corner(RtVec3d center, double half, double x, double y) {
    return rt_narrow(rt_addd(center, rt_vec3d(x * half, y * half, x * y * half)));
}

static RtStatus add_tetrahedron(RtScene *scene, RtVec3d center, double half, RtError *error) {
    static const double face_x[4] = {-1, 1, 1, -1}, face_y[4] = {-1, 1, -1, 1};
    for (int i = 0; i < 4; i++) {
        double x = face_x[i], y = face_y[i];
        RtVec3 vertices[3] = {corner(center, half, x, y), corner(center, half, x, -y),
                              corner(center, half, -x, y)};
        RT_TRY(rt_scene_add_triangle(scene, 0, vertices, NULL, error));
    }
    return RT_OK;
}

static RtStatus add_level(RtScene *scene, RtVec3d center, double half, int64_t levels, RtError *error) {
    if (levels == 1) return add_tetrahedron(scene, center, half, error);
    for (int x = -1; x <= 1; x += 2) {
        for (int y = -1; y <= 1; y += 2) {
            RtVec3d step = rt_scaled(rt_vec3d(x, y, x * y), half / 2);
            RT_TRY(add_level(scene, rt_addd(center, step), half / 2, levels - 1, error));
        }
    }
    return RT_OK;
}

static RtStatus generate(RtScene *scene, const RtValue *values, RtError *error) {
    uint32_t material;
    RtMaterial red = rt_nff_material("red", rt_vec3(1, 0.2f, 0.2f), 1, 0, 100000, 0, 1);
    RT_TRY(rt_scene_add_material(scene, &red, &material, error));
    static const RtVec3 lights[1] = {{2, -18, -5}};
    RT_TRY(rt_spd_add_lights(scene, lights, 1, error));
    scene->camera.from = rt_vec3(1.022846f, -3.177154f, -2.174512f);
    scene->camera.at = rt_vec3(-0.004103f, -0.004103f, 0.216539f);
    scene->camera.up = rt_vec3(-0.816497f, -0.816497f, 0.816497f);
    scene->camera.near = 1;
    return add_level(scene, rt_vec3d(0, 0, 0), 1, values[0].i, error);
}

const RtBuiltin rt_builtin_tetra = {
    .name = "tetra",
    .summary = "a Sierpinski tetrahedron of triangles, mostly empty space",
    .source = RT_SPD_SOURCE,
    RT_PARAMS_OF(params),
    .object_count = object_count,
    .generate = generate,
};
