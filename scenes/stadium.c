/* SPDX-License-Identifier: Apache-2.0 */
/* stadium: a teapot in a stadium: thousands of tiny triangles in the middle of a few thousand huge polygons.
 *
 * The classical case against a uniform grid (E. Haines, Ray Tracing News, 1988): voxels that suit the
 * stadium put the whole teapot into one of them. Lengths are in units of the teapot, which is 6.4 long and
 * stands at the origin; the stadium is `ratio` times as long. The bowl is an oval of SECTORS; each tier is
 * a step of two quads. */
#include "scenes/builtin.h"

#define PARAMS(X)                                                                                            \
    X(SIZE, "size", RT_INT("12", 1, RT_TEAPOT_MAX_SIZE, "1|6"),                                              \
      "cells along each edge of a patch of the teapot: 64 size^2 - 8 size triangles",                        \
      "as in the scene teapot")                                                                              \
    X(RATIO, "ratio", RT_FLOAT("1000", 50, 1e6, "50|100000"),                                                \
      "the stadium is this many times as long as the teapot", "a teapot of 25 cm in a stadium of 250 m")

enum { PARAMS(RT_PARAM_INDEX) };
static const RtParam params[] = {PARAMS(RT_PARAM_ENTRY)};

enum { SECTORS = 64, MASTS = 4, LAMPS = 12, STRIPES = 14 }; /* LAMPS of a mast */

enum {
    CHINA,
    WOOD,
    GRASS,
    LIGHT_GRASS,
    LINES,
    CONCRETE,
    RED_SEATS,
    WHITE_SEATS,
    BLUE_SEATS,
    ROOF,
    STEEL,
    LAMP,
    MATERIALS
};

static const RtMaterial materials[MATERIALS] = {
    [CHINA] = RT_MATERIAL("china", 0.95f, 0.93f, 0.88f, 0.15f, 0.7f, 0.6f, 60, 0.12f),
    [WOOD] = RT_MATTE("wood", 0.45f, 0.26f, 0.13f),
    [GRASS] = RT_MATTE("grass", 0.10f, 0.36f, 0.08f),
    [LIGHT_GRASS] = RT_MATTE("light grass", 0.16f, 0.46f, 0.12f),
    [LINES] = RT_MATTE("lines", 0.9f, 0.9f, 0.9f),
    [CONCRETE] = RT_MATTE("concrete", 0.55f, 0.54f, 0.5f),
    [RED_SEATS] = RT_MATTE("red seats", 0.75f, 0.1f, 0.08f),
    [WHITE_SEATS] = RT_MATTE("white seats", 0.85f, 0.85f, 0.85f),
    [BLUE_SEATS] = RT_MATTE("blue seats", 0.1f, 0.2f, 0.6f),
    [ROOF] = RT_MATTE("roof", 0.95f, 0.95f, 0.95f),
    [STEEL] = RT_MATTE("steel", 0.4f, 0.42f, 0.45f),
    [LAMP] = RT_MATERIAL("lamp", 1, 0.98f, 0.9f, 1, 0.2f, 0, 1, 0),
};

/* A ledge of the bowl, in half lengths of the stadium: distance from the pitch's oval, and height. */
typedef struct Ledge {
    double out, up;
} Ledge;

typedef struct Stadium {
    RtSceneBuilder *b;
    double half; /* half the length of the stadium */
} Stadium;

/* A point of the bowl over edge `i` of the oval. */
static RtVec3d on_bowl(const Stadium *s, uint32_t i, Ledge ledge) {
    RtVec3d turn = rt_on_circle(i, SECTORS);
    return rt_vec3d(turn.x * s->half * (0.55 + ledge.out), turn.y * s->half * (0.38 + ledge.out),
                    s->half * ledge.up);
}

/* One flat piece of the bowl, seen from the pitch: from ledge a, nearer or lower, to b. */
static void add_piece(Stadium *s, uint32_t sector, Ledge a, Ledge b) {
    const RtVec3d corners[4] = {on_bowl(s, sector + 1, a), on_bowl(s, sector, a), on_bowl(s, sector, b),
                                on_bowl(s, sector + 1, b)};
    rt_build_quad(s->b, corners);
}

static void add_ring(Stadium *s, Ledge a, Ledge b, uint32_t material) {
    s->b->material = material;
    for (uint32_t i = 0; i < SECTORS; i++) add_piece(s, i, a, b);
}

/* Steps from ledge `a` up to `b`, in blocks of coloured seats with aisles of concrete between them. */
static void add_tiers(Stadium *s, Ledge a, Ledge b, uint32_t tiers, uint32_t seats) {
    double tread = (b.out - a.out) / tiers, riser = (b.up - a.up) / tiers;
    for (uint32_t tier = 0; tier < tiers; tier++) {
        Ledge foot = {a.out + tread * tier, a.up + riser * tier};
        Ledge edge = {foot.out, a.up + riser * (tier + 1)};
        Ledge back = {a.out + tread * (tier + 1), edge.up};
        for (uint32_t i = 0; i < SECTORS; i++) {
            bool letters = (i / 8) % 2 == 0 && tier > tiers / 3 && tier < tiers - tiers / 3;
            s->b->material = i % 8 == 7 ? CONCRETE : letters ? WHITE_SEATS : seats;
            add_piece(s, i, foot, edge);
            s->b->material = CONCRETE;
            add_piece(s, i, edge, back);
        }
    }
}

static void add_bowl(Stadium *s) {
    const Ledge fence = {0, 0}, top_of_fence = {0, 0.012}, walk = {0.01, 0.012};
    const Ledge lower_end = {0.16, 0.09}, balcony = {0.16, 0.125}, upper_end = {0.36, 0.29};
    const Ledge wall_top = {0.36, 0.36}, roof_end = {0.14, 0.385}, outside = {0.38, 0.36}, ground = {0.38, 0};
    add_ring(s, fence, top_of_fence, LINES);
    add_ring(s, top_of_fence, walk, CONCRETE);
    add_tiers(s, walk, lower_end, 20, RED_SEATS);
    add_ring(s, lower_end, balcony, BLUE_SEATS);
    add_tiers(s, balcony, upper_end, 28, BLUE_SEATS);
    add_ring(s, upper_end, wall_top, STEEL);
    add_ring(s, wall_top, roof_end, ROOF);
    add_ring(s, outside, wall_top, ROOF);
    add_ring(s, ground, outside, CONCRETE);
}

/* Level, from (x0, y0) to (x1, y1) at height z, in half lengths of the stadium. */
static void add_strip(Stadium *s, double x0, double y0, double x1, double y1, double z) {
    RtVec3d lo = {x0 * s->half, y0 * s->half, z * s->half}, hi = {x1 * s->half, y1 * s->half, z * s->half};
    rt_build_box(s->b, lo, hi, RT_SIDE_TOP);
}

/* Two posts and a bar. */
static void add_goal(Stadium *s, double x) {
    double h = s->half, post = 0.0015 * h;
    const RtVec3d feet[2] = {{x * h, -0.03 * h, 0}, {x * h, 0.03 * h, 0}};
    const RtVec3d tops[2] = {{x * h, -0.03 * h, 0.02 * h}, {x * h, 0.03 * h, 0.02 * h}};
    s->b->material = LINES;
    for (int i = 0; i < 2; i++) rt_build_cone(s->b, feet[i], post, tops[i], post);
    rt_build_cone(s->b, tops[0], post, tops[1], post);
}

/* Stripes of grass and, a little above them, the lines. */
static void add_pitch(Stadium *s) {
    const double x = 0.4, y = 0.24, line = 0.002, above = 1e-5;
    s->b->material = GRASS;
    add_strip(s, -1.2, -1.2, 1.2, 1.2, -2 * above);
    for (int i = 0; i < STRIPES; i++) {
        double x0 = -x + 2 * x * i / STRIPES, x1 = -x + 2 * x * (i + 1) / STRIPES;
        s->b->material = i % 2 ? GRASS : LIGHT_GRASS;
        add_strip(s, x0, -y, x1, y, -above);
    }
    s->b->material = LINES;
    for (int i = -1; i <= 1; i++) { /* goal lines and half-way line, then touch lines */
        add_strip(s, i * x - line, -y, i * x + line, y, 0);
    }
    for (int i = -1; i <= 1; i += 2) {
        add_strip(s, -x, i * y - line, x, i * y + line, 0);
        add_strip(s, i * (x - 0.12) - line, -0.13, i * (x - 0.12) + line, 0.13, 0);
        for (int j = -1; j <= 1; j += 2) {
            double x0 = i < 0 ? -x : x - 0.12;
            add_strip(s, x0, j * 0.13 - line, x0 + 0.12, j * 0.13 + line, 0);
        }
        add_goal(s, i * x);
    }
}

/* Where the lamps of mast `i` hang. */
static RtVec3d top_of_mast(double half, uint32_t i) {
    RtVec3d corner = rt_on_circle(2 * i + 1, 2 * MASTS);
    return rt_vec3d(corner.x * 0.95 * half, corner.y * 0.9 * half, 0.62 * half);
}

static void add_mast(Stadium *s, uint32_t i) {
    double h = s->half;
    RtVec3d top = top_of_mast(h, i), foot = {top.x, top.y, 0};
    s->b->material = STEEL;
    rt_build_cone(s->b, foot, 0.016 * h, top, 0.008 * h);
    RtVec3d across = rt_normalized(rt_vec3d(-top.y, top.x, 0));
    for (int lamp = 0; lamp < LAMPS; lamp++) {
        s->b->material = LAMP;
        int row = lamp / 4, column = lamp % 4;
        RtVec3d at = rt_add_scaledd(top, across, (column - 1.5) * 0.026 * h);
        at.z += (row + 0.5) * 0.026 * h;
        rt_build_sphere(s->b, at, 0.011 * h);
    }
}

/* On a round table at the kick-off spot. */
static void add_teapot(RtSceneBuilder *b, uint32_t n) {
    b->material = CHINA;
    rt_build_origin(b, rt_vec3d(0, 0, 3), 1);
    rt_build_teapot(b, n);
    rt_build_origin(b, rt_vec3d(0, 0, 0), 0);
    b->material = WOOD;
    const RtVec3d foot = {0, 0, 0}, knee = {0, 0, 0.6}, under = {0, 0, 2.7}, top = {0, 0, 3};
    rt_build_disc(b, top, 5, SECTORS);
    rt_build_cone(b, under, 5, top, 5);
    rt_build_disc(b, under, 5, SECTORS);
    rt_build_cone(b, foot, 2.6, knee, 0.7);
    rt_build_cone(b, knee, 0.7, under, 0.7);
    b->material = LINES;
    rt_build_disc(b, rt_vec3d(0, 0, 0.004), 6, SECTORS);
}

static void generate(RtSceneBuilder *b, const RtValue *values) {
    const double teapot_length = 6.433594, half = values[RATIO].f * teapot_length / 2;
    Stadium s = {.b = b, .half = half};
    b->scene->camera.from = rt_vec3(-12, -5, 5.6f);
    b->scene->camera.at = rt_vec3(0, 0, 7);
    b->scene->camera.fov = 60;
    b->scene->background = rt_vec3(0.35f, 0.55f, 0.85f);
    rt_build_light(b, rt_vec3d(-1.5 * half, -2.2 * half, 3 * half), rt_vec3(0.75f, 0.72f, 0.66f));
    for (uint32_t i = 1; i < MASTS; i += 2) {
        RtVec3d lamps = rt_addd(top_of_mast(half, i), rt_vec3d(0, 0, -0.01 * half));
        rt_build_light(b, lamps, rt_vec3(0.25f, 0.25f, 0.28f));
    }
    b->transformed = true;
    rt_build_materials(b, materials, MATERIALS);
    b->polygons = true;
    add_pitch(&s);
    add_bowl(&s);
    for (uint32_t i = 0; i < MASTS; i++) add_mast(&s, i);
    add_teapot(b, (uint32_t)values[SIZE].i);
}

const RtBuiltin rt_builtin_stadium = {
    .name = "stadium",
    .summary = "a teapot in a stadium: tiny triangles close together amid a few thousand huge polygons",
    .source = "after E. Haines 1988, Ray Tracing News: the classical case against a uniform grid",
    RT_PARAMS_OF(params),
    .generate = generate,
};
