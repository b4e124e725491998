/* SPDX-License-Identifier: Apache-2.0 */
/* jacks: jacks (three crossed cylinders with a sphere at each end) that carry smaller jacks between their
 * arms.
 *
 * Standard Procedural Databases of E. Haines, in which it is later than the paper of 1987. Arms are 0.75
 * long; a jack has eight children, of half its size, at the corners of the cube with edges of 1 about it that
 * its arms are normal to. Inferred from the numbers of the database: the axes are turned by -20 degrees about
 * Y and by -30 about X; all lengths; and the order, which is that of the files: depth first, cylinders before
 * spheres. */
#include "core/scene/nff.h"
#include "scenes/builtin.h"
#include "scenes/spd.h"

static const RtParam params[] = {
    {"size", RT_INT("3", 1, 8, "1|2"), "levels: (8^size - 1) / 7 jacks of 3 cylinders and 6 spheres",
     "SPD: 219 cylinders, 438 spheres"},
};

#define ARM        0.75
#define ROD_RADIUS 0.075
#define TIP_RADIUS 0.15

typedef struct Jacks {
    RtScene *scene;
    RtVec3d axes[3]; /* unit, the directions of arms */
} Jacks;

static uint64_t object_count(const RtValue *values) {
    uint64_t jacks = 0;
    for (int64_t level = 0; level < values[0].i; level++) jacks = 8 * jacks + 1;
    return 9 * jacks;
}

static RtStatus add_arms(const Jacks *jacks, RtVec3d center, double scale, RtError *error) {
    RtVec3 tips[2][3]; /* along the axes, and against them */
    for (int side = 0; side < 2; side++) {
        double reach = side == 0 ? ARM * scale : -ARM * scale;
        for (int a = 0; a < 3; a++) tips[side][a] = rt_narrow(rt_add_scaledd(center, jacks->axes[a], reach));
    }
    float rod_radius = (float)(ROD_RADIUS * scale), tip_radius = (float)(TIP_RADIUS * scale);
    for (int a = 0; a < 3; a++) {
        RT_TRY(rt_scene_add_cone(jacks->scene, 0, tips[1][a], rod_radius, tips[0][a], rod_radius, error));
    }
    for (int i = 0; i < 6; i++) {
        RT_TRY(rt_scene_add_sphere(jacks->scene, 0, tips[i / 3][i % 3], tip_radius, error));
    }
    return RT_OK;
}

static RtStatus add_jack(const Jacks *jacks, RtVec3d center, double scale, int64_t levels, RtError *error) {
    RT_TRY(add_arms(jacks, center, scale, error));
    if (levels == 1) return RT_OK;
    for (int corner = 0; corner < 8; corner++) {
        RtVec3d child = center;
        for (int a = 0; a < 3; a++) {
            double along = corner >> (2 - a) & 1 ? scale / 2 : -scale / 2;
            child = rt_add_scaledd(child, jacks->axes[a], along);
        }
        RT_TRY(add_jack(jacks, child, scale / 2, levels - 1, error));
    }
    return RT_OK;
}

static RtStatus generate(RtScene *scene, const RtValue *values, RtError *error) {
    static const RtVec3 lights[1] = {{-10, 3, -20}};
    RT_TRY(rt_spd_add_lights(scene, lights, 1, error));
    scene->background = rt_vec3(0.2f, 0.05f, 0.2f);
    scene->camera.from = rt_vec3(0, 0, -8);
    scene->camera.up = rt_vec3(0, 1, 0);
    scene->camera.fov = 25;
    scene->camera.near = 0.001f;
    scene->camera.width = scene->camera.height = 256;
    uint32_t material;
    RtMaterial metal = rt_nff_material("jack", rt_vec3(0.737f, 0.561f, 0.561f), 0.7f, 0.7f, 11.1434f, 0, 1);
    RT_TRY(rt_scene_add_material(scene, &metal, &material, error));

    static const RtVec3d axes[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    Jacks jacks = {.scene = scene};
    for (int a = 0; a < 3; a++) {
        RtVec3d turned = rt_spd_rotate(axes[a], axes[1], rt_turn(-20));
        jacks.axes[a] = rt_spd_rotate(turned, axes[0], rt_turn(-30));
    }
    return add_jack(&jacks, rt_vec3d(0, 0, 0), 1, values[0].i, error);
}

const RtBuiltin rt_builtin_jacks = {
    .name = "jacks",
    .summary = "crossed cylinders with spheres at their ends, among smaller ones: mirrors that touch",
    .source = RT_SPD_LATER_SOURCE,
    RT_PARAMS_OF(params),
    .object_count = object_count,
    .generate = generate,
};
