/* SPDX-License-Identifier: Apache-2.0 */
/* tree: a binary tree of 2^(size+1) - 1 branches, each a cone with a sphere at its tip, on a field.
 *
 * E. Haines, "A Proposal for Standard Graphics Environments", IEEE CG&A 7(11), 1987. The trunk goes from
 * the origin to (0, 0, 1). A branch has two children: smaller copies of it, rotated and moved to its tip,
 * with a separate factor for radii. Objects come depth first, in the order of the Standard Procedural
 * Databases. */
#include "scenes/builtin.h"
#include "scenes/spd.h"

static const RtParam params[] = {
    {"size", RT_INT("11", 1, 20, "1|3"), "levels above the trunk: 2^(size+1) - 1 cones and as many spheres",
     "SPD: 4095 cones and spheres"},
};

#define TRUNK_RADIUS 0.15
#define TAPER        0.67 /* of radii, from a branch to the next */

/* Turns and scales: where a unit vector along each axis goes. */
typedef struct Frame {
    RtVec3d axis[3];
} Frame;

/* A vector of a frame, seen from outside it. */
static RtVec3d outward(const Frame *frame, RtVec3d v) {
    RtVec3d sum = rt_scaled(frame->axis[0], v.x);
    return rt_add_scaledd(rt_add_scaledd(sum, frame->axis[1], v.y), frame->axis[2], v.z);
}

/* A child within the frame of its parent: turned about X by `tilt` degrees, then about Z by `around`, and
 * scaled. */
static Frame child_frame(double tilt, double around, double scale) {
    static const RtVec3d axes[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    Frame frame;
    for (int a = 0; a < 3; a++) {
        RtVec3d tilted = rt_spd_rotate(axes[a], axes[0], rt_turn(tilt));
        frame.axis[a] = rt_scaled(rt_spd_rotate(tilted, axes[2], rt_turn(around)), scale);
    }
    return frame;
}

static void add_branch(RtSceneBuilder *b, const Frame children[2], RtVec3d base, const Frame *frame,
                       double radius, int64_t levels) {
    RtVec3d tip = rt_addd(base, frame->axis[2]);
    rt_build_cone(b, base, radius, tip, radius * TAPER);
    rt_build_sphere(b, tip, radius * TAPER);
    for (int i = 0; levels > 0 && i < 2; i++) {
        Frame child;
        for (int a = 0; a < 3; a++) child.axis[a] = outward(frame, children[i].axis[a]);
        add_branch(b, children, tip, &child, radius * TAPER, levels - 1);
    }
}

static void generate(RtSceneBuilder *b, const RtValue *values) {
    static const RtVec3d lights[7] = {{-5, 5, 50},   {30, -30, 30}, {-40, -30, 20}, {10, 30, 40},
                                      {-30, 40, 10}, {50, 25, 20},  {-10, -60, 30}};
    static const RtVec3d field[4] = {{50, 50, 0}, {-50, 50, 0}, {-50, -50, 0}, {50, -50, 0}};
    static const Frame upright = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    const Frame children[2] = {child_frame(40, 90, 0.65), child_frame(25, 230, 0.7)};
    rt_spd_lights(b, lights, 7);
    b->scene->camera.from = rt_vec3(4.5f, 0.4f, 2);
    b->scene->camera.at = rt_vec3(0, 0, 1.5f);
    b->scene->camera.near = 1;
    rt_build_material(b, rt_nff_material("field", rt_vec3(0.2f, 0.7f, 0.2f), 1, 0, 100000, 0, 1));
    rt_build_polygon(b, field, 4);
    rt_build_material(b, rt_nff_material("bark", rt_vec3(0.55f, 0.4f, 0.2f), 1, 0, 100000, 0, 1));
    add_branch(b, children, rt_vec3d(0, 0, 0), &upright, TRUNK_RADIUS, values[0].i);
}

const RtBuiltin rt_builtin_tree = {
    .name = "tree",
    .summary = "a tree of cones and spheres that get smaller and smaller, alone on a large field",
    .source = RT_SPD_SOURCE,
    RT_PARAMS_OF(params),
    .generate = generate,
};
