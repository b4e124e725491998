/* SPDX-License-Identifier: Apache-2.0 */
/* gears: size^3 gears that mesh, some of glass, above a mirror.
 *
 * E. Haines, "A Proposal for Standard Graphics Environments", IEEE CG&A 7(11), 1987. A gear has two faces,
 * which are concave polygons of four corners a tooth, and a rectangle under each edge between them. Angles
 * are whole tenths of a degree: so both faces have the same corners, bit for bit. Colours, of which the paper
 * says nothing, and the order of objects are those of the database. */
#include "core/scene/nff.h"
#include "scenes/builtin.h"
#include "scenes/spd.h"

static const RtParam params[] = {
    {"size", RT_INT("4", 1, 100, "1|2"), "gears along an edge: 146 size^3 + 1 polygons",
     "SPD: 9345 polygons"},
};

enum { TEETH = 36, CORNERS = 4 * TEETH, TOOTH = 3600 / TEETH }; /* TOOTH in tenths of a degree */

typedef struct Gear {
    RtScene *scene;
    uint32_t material;
    RtVec3d center;
    int turn; /* tenths of a degree */
    double outer, inner, thickness;
} Gear;

static uint64_t object_count(const RtValue *values) {
    uint64_t size = (uint64_t)values[0].i;
    return size * size * size * (CORNERS + 2) + 1;
}

/* A 73rd of them are faces of 144 corners. */
static uint64_t object_bytes(const RtValue *values) {
    (void)values;
    return 384;
}

/* Counter-clockwise at the upper face, or, with a `sense` of -1, clockwise at the lower one: a tooth at a
 * time, the two corners of its tip and two of the gap that follows. */
static void set_face(const Gear *gear, int sense, RtVec3 face[CORNERS]) {
    static const int tenths[4] = {-19, 19, 30, 70};
    for (int i = 0; i < CORNERS; i++) {
        int angle = gear->turn + sense * (i / 4 * TOOTH + tenths[i % 4]);
        RtTurn turn = rt_turn((angle + 3600) % 3600 / 10.0);
        double radius = i % 4 < 2 ? gear->outer : gear->inner;
        RtVec3d corner = {radius * turn.cosine, radius * turn.sine, sense < 0 ? -gear->thickness : 0};
        face[i] = rt_narrow(rt_addd(corner, gear->center));
    }
}

static RtStatus add_gear(const Gear *gear, RtError *error) {
    RtVec3 upper[CORNERS], lower[CORNERS];
    set_face(gear, 1, upper);
    set_face(gear, -1, lower);
    RT_TRY(rt_scene_add_polygon(gear->scene, gear->material, upper, CORNERS, error));
    const float bottom = lower[0].z;
    for (int i = 0; i < CORNERS; i++) {
        RtVec3 a = upper[i], b = upper[(i + 1) % CORNERS];
        const RtVec3 side[4] = {a, {a.x, a.y, bottom}, {b.x, b.y, bottom}, b};
        RT_TRY(rt_scene_add_polygon(gear->scene, gear->material, side, 4, error));
    }
    return rt_scene_add_polygon(gear->scene, gear->material, lower, CORNERS, error);
}

/* A colour of hues that vary, the largest component of which is 1. */
static RtVec3 gear_color(int64_t x, int64_t y, int64_t z) {
    double red = 0.01 + (double)((3 * x + 2 * y + z + 1) * 5 % 7) / 7;
    double green = 0.01 + (double)((3 * y + 2 * z + x + 1) * 3 % 7) / 7;
    double blue = 0.01 + (double)((3 * z + 2 * x + y + 1) * 2 % 7) / 7;
    double most = fmax(red, fmax(green, blue));
    return rt_narrow(rt_vec3d(red / most, green / most, blue / most));
}

static RtStatus add_gear_material(RtScene *scene, int64_t x, int64_t y, int64_t z, uint32_t *index,
                                  RtError *error) {
    RtVec3 color = gear_color(x, y, z);
    RtMaterial material = rt_nff_material("gear", color, 1, 0, 100000, 0, 1);
    if ((4 * x + 2 * y + z) % 5 == 0) {
        material = rt_nff_material("glass", color, 0.2f, 0, 100000, 0.8f, 1.1f);
        material.reflection = 0.0023f; /* Fresnel's at right angles: ((1.1 - 1) / (1.1 + 1))^2 */
    }
    return rt_scene_add_material(scene, &material, index, error);
}

static RtStatus add_ground(RtScene *scene, RtError *error) {
    uint32_t index;
    RtMaterial mirror = rt_nff_material("ground", rt_vec3(1, 0.85f, 0.7f), 0.3f, 0.6f, 181.81f, 0, 1);
    RT_TRY(rt_scene_add_material(scene, &mirror, &index, error));
    const RtVec3 corners[4] = {{2, 2, 0}, {-2, 2, 0}, {-2, -2, 0}, {2, -2, 0}};
    return rt_scene_add_polygon(scene, index, corners, 4, error);
}

static RtStatus generate(RtScene *scene, const RtValue *values, RtError *error) {
    static const RtVec3 lights[5] = {
        {2, 4, 4}, {-2, 4, 3}, {2, -2.5f, 2.5f}, {-1, -4, 2}, {-1.111f, -2.121f, 2.626f}};
    RT_TRY(rt_spd_add_lights(scene, lights, 5, error));
    scene->background = rt_vec3(0, 0, 0);
    scene->camera.from = rt_vec3(-1.1f, -2.1f, 2.6f);
    scene->camera.near = 1;
    RT_TRY(add_ground(scene, error));

    const int64_t size = values[0].i;
    const double count = (double)size, radius = 1 / (count - (count - 1) * 0.05);
    Gear gear = {.scene = scene, .outer = 0.995 * radius, .inner = 0.9 * radius};
    gear.thickness = fmin(0.1, 1 / (2 * count));
    for (int64_t z = 0; z < size; z++) {
        for (int64_t y = 0; y < size; y++) {
            for (int64_t x = 0; x < size; x++) {
                RT_TRY(add_gear_material(scene, x, y, z, &gear.material, error));
                gear.center = rt_vec3d(radius - 1 + 1.9 * radius * (double)x,
                                       radius - 1 + 1.9 * radius * (double)y, 1 - (double)z / count);
                gear.turn = (x + y + z) % 2 == 1 ? TOOTH / 2 : 0;
                RT_TRY(add_gear(&gear, error));
            }
        }
    }
    return RT_OK;
}

const RtBuiltin rt_builtin_gears = {
    .name = "gears",
    .summary = "gears of concave polygons with 144 corners, some of glass, above a mirror",
    .source = RT_SPD_SOURCE,
    RT_PARAMS_OF(params),
    .object_count = object_count,
    .object_bytes = object_bytes,
    .generate = generate,
};
