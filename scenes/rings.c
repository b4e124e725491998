/* SPDX-License-Identifier: Apache-2.0 */
/* rings: a pyramid of objects made of six interlocked rings, seen from its tip in front of a wall.
 *
 * E. Haines, "A Proposal for Standard Graphics Environments", IEEE CG&A 7(11), 1987. A ring is a pentagon
 * of five cylinders, with spheres where they meet. The six pass through the midpoints of the edges of a
 * dodecahedron, five each; cylinders of RADIUS around pentagons of circumradius 1 would just touch. Here
 * the pentagons are smaller by the factor 1 + RADIUS, and the radius is not, so that cylinders of
 * different rings overlap slightly. Layer n of the pyramid is n by n objects. Colours, which the paper
 * does not specify, and the order of objects are those of the database. */
#include "scenes/builtin.h"
#include "scenes/spd.h"

static const RtParam params[] = {
    {"size", RT_INT("7", 1, 200, "1|2"), "layers: 5 size (size+1) (2 size+1) spheres and as many cylinders",
     "SPD: 4200 spheres and cylinders"},
};

enum { RINGS = 6, CORNERS = 5 };

#define RADIUS 0.07412

typedef RtVec3d Knot[RINGS][CORNERS];

static uint64_t object_count(const RtValue *values) {
    uint64_t size = (uint64_t)values[0].i;
    return 10 * size * (size + 1) * (2 * size + 1) + 1;
}

/* One pentagon lies in the plane of X and Y, the others in planes normal to axes of a dodecahedron next to Z,
 * at the angle whose cosine is 1 / sqrt 5. */
static void set_knot(Knot knot) {
    const RtVec3d x = {1, 0, 0}, z = {0, 0, 1};
    const RtTurn tilt = {.cosine = sqrt(1.0 / 5), .sine = sqrt(4.0 / 5)};
    for (int i = 0; i < CORNERS; i++) {
        RtTurn turn = rt_turn(72.0 * i);
        knot[0][i] = rt_scaled(rt_vec3d(turn.cosine, turn.sine, 0), 1 / (1 + RADIUS));
        RtVec3d tilted = rt_spd_rotate(knot[0][i], x, tilt);
        for (int ring = 1; ring < RINGS; ring++)
            knot[ring][i] = rt_spd_rotate(tilted, z, rt_turn(72.0 * ring - 36));
    }
}

static void add_knot(RtSceneBuilder *b, const Knot knot, RtVec3d center) {
    for (uint32_t ring = 0; ring < RINGS; ring++) {
        b->material = ring;
        for (int i = 0; i < CORNERS; i++) {
            RtVec3d corner = rt_addd(center, knot[ring][i]);
            RtVec3d last = rt_addd(center, knot[ring][(i + CORNERS - 1) % CORNERS]);
            rt_build_cone(b, corner, RADIUS, last, RADIUS);
            rt_build_sphere(b, corner, RADIUS);
        }
    }
}

/* Materials of the rings, in their order, and then of the wall. */
static void add_materials(RtSceneBuilder *b) {
    static const RtVec3 colors[RINGS] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 1, 1}, {1, 0, 1}, {1, 1, 0}};
    static const char *const names[RINGS] = {"red", "green", "blue", "cyan", "magenta", "yellow"};
    for (int i = 0; i < RINGS; i++)
        rt_build_material(b, rt_nff_material(names[i], colors[i], 0.5f, 0.2f, 3.0827f, 0, 1));
    rt_build_material(b, rt_nff_material("wall", rt_vec3(1, 1, 1), 1, 0, 100000, 0, 1));
}

/* Square, centred before the eye, and a hundredth larger than the picture. */
static void add_wall(RtSceneBuilder *b, RtVec3d eye, double y) {
    RtTurn half_view = rt_turn(22.5);
    double half = 1.01 * (y - eye.y) * (half_view.sine / half_view.cosine);
    const double x[4] = {1, -1, -1, 1}, z[4] = {1, 1, -1, -1};
    RtVec3d corners[4];
    for (int i = 0; i < 4; i++) corners[i] = rt_vec3d(eye.x + half * x[i], y, eye.z + half * z[i]);
    rt_build_polygon(b, corners, 4);
}

static void generate(RtSceneBuilder *b, const RtValue *values) {
    const int64_t size = values[0].i;
    const double spacing = 1 / rt_turn(22.5).sine; /* from layer to layer: the pyramid fills the view */
    const RtVec3d eye = {-1, -spacing, 0.5};
    const RtVec3d lights[3] = {{3, -spacing, 3}, {-4, -spacing, 1}, {2, -spacing, -4}};
    rt_spd_lights(b, lights, 3);
    b->scene->camera.from = rt_narrow(eye);
    b->scene->camera.at = rt_narrow(rt_vec3d(eye.x, eye.y + 1, eye.z));
    b->scene->camera.near = 1;
    add_materials(b);
    add_wall(b, eye, spacing * (double)(size + 1));
    Knot knot;
    set_knot(knot);
    for (int64_t layer = 1; layer <= size; layer++) {
        for (int64_t i = 0; i < layer * layer; i++) {
            const int64_t x = 2 * (i % layer) - layer + 1, z = 2 * (i / layer) - layer + 1;
            RtVec3d center = {(double)x, spacing * (double)layer, (double)z};
            add_knot(b, (const RtVec3d(*)[CORNERS])knot, center);
        }
    }
}

const RtBuiltin rt_builtin_rings = {
    .name = "rings",
    .summary = "a pyramid of interlocked rings of cylinders and spheres, mirrors, before a wall",
    .source = RT_SPD_SOURCE,
    RT_PARAMS_OF(params),
    .object_count = object_count,
    .generate = generate,
};
