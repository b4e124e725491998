/* SPDX-License-Identifier: Apache-2.0 */
/* jacks: jacks (three crossed cylinders with a sphere at each end) that carry smaller jacks between their
 * arms.
 *
 * Standard Procedural Databases of E. Haines, where it is later than the paper of 1987. Arms are 0.75
 * long; a jack has eight children of half its size, at the corners of the axis-aligned cube with edges of
 * 1 around it. Inferred from the numbers of the database: the axes are rotated by -20 degrees about Y and
 * by -30 about X; all lengths; and the order of the files: depth first, cylinders before spheres. */
#include "scenes/builtin.h"
#include "scenes/spd.h"

static const RtParam params[] = {
    {"size", RT_INT("3", 1, 8, "1|2"), "levels: (8^size - 1) / 7 jacks of 3 cylinders and 6 spheres",
     "SPD: 219 cylinders, 438 spheres"},
};

#define ARM        0.75
#define ROD_RADIUS 0.075
#define END_RADIUS 0.15

/* Three cylinders, then six spheres at their ends. */
static void add_arms(RtSceneBuilder *b, const RtVec3d axes[3], RtVec3d center, double scale) {
    RtVec3d ends[2][3]; /* along the axes, and against them */
    for (int i = 0; i < 6; i++)
        ends[i / 3][i % 3] = rt_add_scaledd(center, axes[i % 3], i < 3 ? ARM * scale : -ARM * scale);
    for (int a = 0; a < 3; a++)
        rt_build_cone(b, ends[1][a], ROD_RADIUS * scale, ends[0][a], ROD_RADIUS * scale);
    for (int i = 0; i < 6; i++) rt_build_sphere(b, ends[i / 3][i % 3], END_RADIUS * scale);
}

static void add_jack(RtSceneBuilder *b, const RtVec3d axes[3], RtVec3d center, double scale, int64_t levels) {
    add_arms(b, axes, center, scale);
    for (int corner = 0; levels > 1 && corner < 8; corner++) {
        RtVec3d child = center;
        for (int a = 0; a < 3; a++)
            child = rt_add_scaledd(child, axes[a], corner >> (2 - a) & 1 ? scale / 2 : -scale / 2);
        add_jack(b, axes, child, scale / 2, levels - 1);
    }
}

static void generate(RtSceneBuilder *b, const RtValue *values) {
    static const RtVec3d lights[1] = {{-10, 3, -20}}, axes[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    RtCamera *camera = &b->scene->camera;
    rt_spd_lights(b, lights, 1);
    b->scene->background = rt_vec3(0.2f, 0.05f, 0.2f);
    camera->from = rt_vec3(0, 0, -8);
    camera->up = rt_vec3(0, 1, 0);
    camera->fov = 25;
    camera->near = 0.001f;
    camera->width = camera->height = 256;
    rt_build_material(b,
                      rt_nff_material("jack", rt_vec3(0.737f, 0.561f, 0.561f), 0.7f, 0.7f, 11.1434f, 0, 1));
    RtVec3d turned[3];
    for (int a = 0; a < 3; a++) {
        turned[a] = rt_spd_rotate(axes[a], axes[1], rt_turn(-20));
        turned[a] = rt_spd_rotate(turned[a], axes[0], rt_turn(-30));
    }
    add_jack(b, turned, rt_vec3d(0, 0, 0), 1, values[0].i);
}

const RtBuiltin rt_builtin_jacks = {
    .name = "jacks",
    .summary = "crossed cylinders with spheres at their ends, among smaller ones: mirrors that touch",
    .source = RT_SPD_LATER_SOURCE,
    RT_PARAMS_OF(params),
    .generate = generate,
};
