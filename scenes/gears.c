/* SPDX-License-Identifier: Apache-2.0 */
/* gears: size^3 gears that mesh, some of glass, above a mirror.
 *
 * E. Haines, "A Proposal for Standard Graphics Environments", IEEE CG&A 7(11), 1987. A gear has two faces,
 * which are concave polygons of four corners per tooth, and a rectangle under each edge between them.
 * Angles are whole tenths of a degree, so both faces have the same corners, bit for bit. Colours, which
 * the paper does not specify, and the order of objects are those of the database. */
#include "scenes/builtin.h"
#include "scenes/spd.h"

static const RtParam params[] = {
    {"size", RT_INT("4", 1, 100, "1|2"), "gears along an edge: 146 size^3 + 1 polygons",
     "SPD: 9345 polygons"},
};

enum { TEETH = 36, CORNERS = 4 * TEETH, TOOTH = 3600 / TEETH }; /* TOOTH in tenths of a degree */

typedef struct Gear {
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

/* Counter-clockwise at the upper face, clockwise (`sense` -1) at the lower one. Each tooth has two corners at
 * its tip and two in the gap that follows. */
static void set_face(const Gear *gear, int sense, RtVec3d face[CORNERS]) {
    static const int tenths[4] = {-19, 19, 30, 70};
    for (int i = 0; i < CORNERS; i++) {
        int angle = gear->turn + sense * (i / 4 * TOOTH + tenths[i % 4]);
        RtTurn turn = rt_turn((angle + 3600) % 3600 / 10.0);
        double radius = i % 4 < 2 ? gear->outer : gear->inner;
        RtVec3d corner = {radius * turn.cosine, radius * turn.sine, sense < 0 ? -gear->thickness : 0};
        face[i] = rt_addd(corner, gear->center);
    }
}

static void add_gear(RtSceneBuilder *b, const Gear *gear) {
    RtVec3d upper[CORNERS], lower[CORNERS];
    set_face(gear, 1, upper);
    set_face(gear, -1, lower);
    rt_build_polygon(b, upper, CORNERS);
    const double bottom = lower[0].z;
    for (int i = 0; i < CORNERS; i++) {
        RtVec3d v = upper[i], w = upper[(i + 1) % CORNERS];
        const RtVec3d side[4] = {v, {v.x, v.y, bottom}, {w.x, w.y, bottom}, w};
        rt_build_polygon(b, side, 4);
    }
    rt_build_polygon(b, lower, CORNERS);
}

/* A varying hue whose largest component is 1. */
static RtVec3 gear_color(int64_t x, int64_t y, int64_t z) {
    double red = 0.01 + (double)((3 * x + 2 * y + z + 1) * 5 % 7) / 7;
    double green = 0.01 + (double)((3 * y + 2 * z + x + 1) * 3 % 7) / 7;
    double blue = 0.01 + (double)((3 * z + 2 * x + y + 1) * 2 % 7) / 7;
    double most = fmax(red, fmax(green, blue));
    return rt_narrow(rt_vec3d(red / most, green / most, blue / most));
}

static RtMaterial gear_material(int64_t x, int64_t y, int64_t z) {
    RtVec3 color = gear_color(x, y, z);
    if ((4 * x + 2 * y + z) % 5 != 0) return rt_nff_material("gear", color, 1, 0, 100000, 0, 1);
    RtMaterial glass = rt_nff_material("glass", color, 0.2f, 0, 100000, 0.8f, 1.1f);
    glass.reflection = 0.0023f; /* Fresnel's at normal incidence: ((1.1 - 1) / (1.1 + 1))^2 */
    return glass;
}

static void generate(RtSceneBuilder *b, const RtValue *values) {
    static const RtVec3d lights[5] = {
        {2, 4, 4}, {-2, 4, 3}, {2, -2.5, 2.5}, {-1, -4, 2}, {-1.111f, -2.121f, 2.626f}};
    static const RtVec3d ground[4] = {{2, 2, 0}, {-2, 2, 0}, {-2, -2, 0}, {2, -2, 0}};
    rt_spd_lights(b, lights, 5);
    b->scene->camera.from = rt_vec3(-1.1f, -2.1f, 2.6f);
    b->scene->camera.near = 1;
    rt_build_material(b, rt_nff_material("ground", rt_vec3(1, 0.85f, 0.7f), 0.3f, 0.6f, 3.0827f, 0, 1));
    rt_build_polygon(b, ground, 4);

    const int64_t size = values[0].i;
    const double count = (double)size, radius = 1 / (count - (count - 1) * 0.05);
    Gear gear = {.outer = 0.995 * radius, .inner = 0.9 * radius, .thickness = fmin(0.1, 1 / (2 * count))};
    for (int64_t i = 0; i < size * size * size; i++) {
        int64_t x = i % size, y = i / size % size, z = i / size / size;
        rt_build_material(b, gear_material(x, y, z));
        gear.center = rt_vec3d(radius - 1 + 1.9 * radius * (double)x, radius - 1 + 1.9 * radius * (double)y,
                               1 - (double)z / count);
        gear.turn = (x + y + z) % 2 == 1 ? TOOTH / 2 : 0;
        add_gear(b, &gear);
    }
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
