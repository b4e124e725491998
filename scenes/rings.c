/* SPDX-License-Identifier: Apache-2.0 */
/* rings: a pyramid of objects made of six interlocked rings, seen from its tip before a wall.
 *
 * E. Haines, "A Proposal for Standard Graphics Environments", IEEE CG&A 7(11), 1987. A ring is a pentagon of
 * five cylinders, with spheres where they meet. The six go through the midpoints of the edges of a
 * dodecahedron, five each; cylinders of RADIUS about pentagons of circumradius 1 would just touch. Here the
 * pentagons are smaller by 1 + RADIUS, and the radius is not, so that cylinders of different rings overlap a
 * little. Layer n of the pyramid is n by n objects. Colours, of which the paper says nothing, and the order
 * of objects are those of the database. */
#include "core/scene/nff.h"
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
static void tie(Knot knot) {
    const RtVec3d x = {1, 0, 0}, z = {0, 0, 1};
    const RtTurn tilt = {.cosine = sqrt(1.0 / 5), .sine = sqrt(4.0 / 5)};
    for (int i = 0; i < CORNERS; i++) {
        RtTurn turn = rt_turn(72.0 * i);
        knot[0][i] = rt_scaled(rt_vec3d(turn.cosine, turn.sine, 0), 1 / (1 + RADIUS));
        RtVec3d tilted = rt_spd_rotate(knot[0][i], x, tilt);
        for (int ring = 1; ring < RINGS; ring++) {
            knot[ring][i] = rt_spd_rotate(tilted, z, rt_turn(72.0 * ring - 36));
        }
    }
}

static RtStatus add_knot(RtScene *scene, const Knot knot, RtVec3d center, RtError *error) {
    for (uint32_t ring = 0; ring < RINGS; ring++) {
        for (int i = 0; i < CORNERS; i++) {
            RtVec3 corner = rt_narrow(rt_addd(center, knot[ring][i]));
            RtVec3 last = rt_narrow(rt_addd(center, knot[ring][(i + CORNERS - 1) % CORNERS]));
            RT_TRY(rt_scene_add_cone(scene, ring, corner, (float)RADIUS, last, (float)RADIUS, error));
            RT_TRY(rt_scene_add_sphere(scene, ring, corner, (float)RADIUS, error));
        }
    }
    return RT_OK;
}

/* Of the rings first, in their order, and then of the wall. */
static RtStatus add_materials(RtScene *scene, uint32_t *wall, RtError *error) {
    static const RtVec3 colors[RINGS] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 1, 1}, {1, 0, 1}, {1, 1, 0}};
    static const char *const names[RINGS] = {"red", "green", "blue", "cyan", "magenta", "yellow"};
    uint32_t index;
    for (int i = 0; i < RINGS; i++) {
        RtMaterial shiny = rt_nff_material(names[i], colors[i], 0.5f, 0.2f, 45.2776f, 0, 1);
        RT_TRY(rt_scene_add_material(scene, &shiny, &index, error));
    }
    RtMaterial white = rt_nff_material("wall", rt_vec3(1, 1, 1), 1, 0, 100000, 0, 1);
    return rt_scene_add_material(scene, &white, wall, error);
}

/* Square, centred before the eye, and a hundredth larger than the picture. */
static RtStatus add_wall(RtScene *scene, uint32_t material, RtVec3d eye, double y, RtError *error) {
    RtTurn half_view = rt_turn(22.5);
    double half = 1.01 * (y - eye.y) * (half_view.sine / half_view.cosine);
    const double x[4] = {1, -1, -1, 1}, z[4] = {1, 1, -1, -1};
    RtVec3 corners[4];
    for (int i = 0; i < 4; i++) corners[i] = rt_narrow(rt_vec3d(eye.x + half * x[i], y, eye.z + half * z[i]));
    return rt_scene_add_polygon(scene, material, corners, 4, error);
}

static RtStatus generate(RtScene *scene, const RtValue *values, RtError *error) {
    const int64_t size = values[0].i;
    const double spread = 1 / rt_turn(22.5).sine; /* from layer to layer: the pyramid fills the view */
    const float front = (float)-spread;
    const RtVec3 lights[3] = {{3, front, 3}, {-4, front, 1}, {2, front, -4}};
    RT_TRY(rt_spd_add_lights(scene, lights, 3, error));
    const RtVec3d eye = {-1, -spread, 0.5};
    scene->camera.from = rt_narrow(eye);
    scene->camera.at = rt_narrow(rt_vec3d(eye.x, eye.y + 1, eye.z));
    scene->camera.near = 1;

    uint32_t wall;
    RT_TRY(add_materials(scene, &wall, error));
    RT_TRY(add_wall(scene, wall, eye, spread * (double)(size + 1), error));
    Knot knot;
    tie(knot);
    for (int64_t layer = 1; layer <= size; layer++) {
        for (int64_t z = 0; z < layer; z++) {
            for (int64_t x = 0; x < layer; x++) {
                RtVec3d center = {(double)(2 * x - layer + 1), spread * (double)layer,
                                  (double)(2 * z - layer + 1)};
                RT_TRY(add_knot(scene, (const RtVec3d(*)[CORNERS])knot, center, error));
            }
        }
    }
    return RT_OK;
}

const RtBuiltin rt_builtin_rings = {
    .name = "rings",
    .summary = "a pyramid of interlocked rings of cylinders and spheres, mirrors, before a wall",
    .source = RT_SPD_SOURCE,
    RT_PARAMS_OF(params),
    .object_count = object_count,
    .generate = generate,
};
