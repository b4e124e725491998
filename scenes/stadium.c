/* SPDX-License-Identifier: Apache-2.0 */
/* stadium: a teapot in a stadium: thousands of tiny triangles in the middle of a few thousand huge polygons.
 *
 * The classical case against a uniform grid (E. Haines, Ray Tracing News, 1988): voxels that suit the stadium
 * put the whole teapot into one of them. Lengths are in units of the teapot: it is 6.4 long and stands at the
 * origin, and the stadium is `ratio` times as long. The bowl is an oval of SECTORS, every tier a step of two
 * quads. */
#include "scenes/builtin.h"
#include "scenes/teapot_mesh.h"

#define PARAMS(X)                                                                                            \
    X(SIZE, "size", RT_INT("12", 1, RT_TEAPOT_MAX_SIZE, "1|6"),                                              \
      "cells along each edge of a patch of the teapot: 64 size^2 - 8 size triangles",                        \
      "as in the scene teapot")                                                                              \
    X(RATIO, "ratio", RT_FLOAT("1000", 50, 1e6, "50|100000"),                                                \
      "the stadium is this many times as long as the teapot", "a teapot of 25 cm in a stadium of 250 m")

enum { PARAMS(RT_PARAM_INDEX) };
static const RtParam params[] = {PARAMS(RT_PARAM_ENTRY)};

enum {
    SECTORS = 64,
    MASTS = 4,
    LAMPS = 12, /* of a mast */
    STRIPES = 14
};

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

/* Of the bowl, in half lengths of the stadium: how far out, over the pitch's oval, and how high. */
typedef struct Ledge {
    double out, up;
} Ledge;

typedef struct Stadium {
    RtForms *forms;
    double half; /* half the length of the stadium */
} Stadium;

/* A point of the bowl over edge `i` of the oval. */
static RtVec3d on_bowl(const Stadium *s, uint32_t i, Ledge ledge) {
    RtVec3d turn = rt_on_circle(i, SECTORS);
    return rt_vec3d(turn.x * s->half * (0.55 + ledge.out), turn.y * s->half * (0.38 + ledge.out),
                    s->half * ledge.up);
}

/* One flat piece of the bowl, seen from the pitch: from ledge a, near or below, to b. */
static RtStatus add_piece(Stadium *s, uint32_t sector, Ledge a, Ledge b, RtError *error) {
    const RtVec3d corners[4] = {on_bowl(s, sector + 1, a), on_bowl(s, sector, a), on_bowl(s, sector, b),
                                on_bowl(s, sector + 1, b)};
    return rt_forms_quad(s->forms, corners, error);
}

static RtStatus add_ring(Stadium *s, Ledge a, Ledge b, uint32_t material, RtError *error) {
    s->forms->material = material;
    for (uint32_t i = 0; i < SECTORS; i++) RT_TRY(add_piece(s, i, a, b, error));
    return RT_OK;
}

/* Steps from ledge `a` up to `b`, in blocks of coloured seats with aisles of concrete between them. */
static RtStatus add_tiers(Stadium *s, Ledge a, Ledge b, uint32_t tiers, uint32_t seats, RtError *error) {
    double tread = (b.out - a.out) / tiers, riser = (b.up - a.up) / tiers;
    for (uint32_t tier = 0; tier < tiers; tier++) {
        Ledge foot = {a.out + tread * tier, a.up + riser * tier};
        Ledge edge = {foot.out, a.up + riser * (tier + 1)};
        Ledge back = {a.out + tread * (tier + 1), edge.up};
        for (uint32_t i = 0; i < SECTORS; i++) {
            bool letters = (i / 8) % 2 == 0 && tier > tiers / 3 && tier < tiers - tiers / 3;
            s->forms->material = i % 8 == 7 ? CONCRETE : letters ? WHITE_SEATS : seats;
            RT_TRY(add_piece(s, i, foot, edge, error));
            s->forms->material = CONCRETE;
            RT_TRY(add_piece(s, i, edge, back, error));
        }
    }
    return RT_OK;
}

static RtStatus add_bowl(Stadium *s, RtError *error) {
    const Ledge fence = {0, 0}, top_of_fence = {0, 0.012}, walk = {0.01, 0.012};
    const Ledge lower_end = {0.16, 0.09}, balcony = {0.16, 0.125}, upper_end = {0.36, 0.29};
    const Ledge wall_top = {0.36, 0.36}, roof_end = {0.14, 0.385}, outside = {0.38, 0.36}, ground = {0.38, 0};
    RT_TRY(add_ring(s, fence, top_of_fence, LINES, error));
    RT_TRY(add_ring(s, top_of_fence, walk, CONCRETE, error));
    RT_TRY(add_tiers(s, walk, lower_end, 20, RED_SEATS, error));
    RT_TRY(add_ring(s, lower_end, balcony, BLUE_SEATS, error));
    RT_TRY(add_tiers(s, balcony, upper_end, 28, BLUE_SEATS, error));
    RT_TRY(add_ring(s, upper_end, wall_top, STEEL, error));
    RT_TRY(add_ring(s, wall_top, roof_end, ROOF, error));
    RT_TRY(add_ring(s, outside, wall_top, ROOF, error));
    return add_ring(s, ground, outside, CONCRETE, error);
}

/* Level, from (x0, y0) to (x1, y1) at height z, in half lengths of the stadium. */
static RtStatus add_strip(Stadium *s, double x0, double y0, double x1, double y1, double z, RtError *error) {
    RtVec3d lo = {x0 * s->half, y0 * s->half, z * s->half}, hi = {x1 * s->half, y1 * s->half, z * s->half};
    return rt_forms_box(s->forms, lo, hi, RT_SIDE_TOP, error);
}

/* Two posts and a bar. */
static RtStatus add_goal(Stadium *s, double x, RtError *error) {
    double h = s->half, post = 0.0015 * h;
    const RtVec3d feet[2] = {{x * h, -0.03 * h, 0}, {x * h, 0.03 * h, 0}};
    const RtVec3d tops[2] = {{x * h, -0.03 * h, 0.02 * h}, {x * h, 0.03 * h, 0.02 * h}};
    s->forms->material = LINES;
    for (int i = 0; i < 2; i++) RT_TRY(rt_forms_cone(s->forms, feet[i], post, tops[i], post, error));
    return rt_forms_cone(s->forms, tops[0], post, tops[1], post, error);
}

/* Stripes of grass and, a little above them, the lines. */
static RtStatus add_pitch(Stadium *s, RtError *error) {
    const double x = 0.4, y = 0.24, line = 0.002, above = 1e-5;
    s->forms->material = GRASS;
    RT_TRY(add_strip(s, -1.2, -1.2, 1.2, 1.2, -2 * above, error));
    for (int i = 0; i < STRIPES; i++) {
        double x0 = -x + 2 * x * i / STRIPES, x1 = -x + 2 * x * (i + 1) / STRIPES;
        s->forms->material = i % 2 ? GRASS : LIGHT_GRASS;
        RT_TRY(add_strip(s, x0, -y, x1, y, -above, error));
    }
    s->forms->material = LINES;
    for (int i = -1; i <= 1; i++) { /* goal lines and half-way line, then touch lines */
        RT_TRY(add_strip(s, i * x - line, -y, i * x + line, y, 0, error));
    }
    for (int i = -1; i <= 1; i += 2) {
        RT_TRY(add_strip(s, -x, i * y - line, x, i * y + line, 0, error));
        RT_TRY(add_strip(s, i * (x - 0.12) - line, -0.13, i * (x - 0.12) + line, 0.13, 0, error));
        for (int j = -1; j <= 1; j += 2) {
            double x0 = i < 0 ? -x : x - 0.12;
            RT_TRY(add_strip(s, x0, j * 0.13 - line, x0 + 0.12, j * 0.13 + line, 0, error));
        }
        RT_TRY(add_goal(s, i * x, error));
    }
    return RT_OK;
}

/* Where the lamps of mast `i` hang. */
static RtVec3d top_of_mast(double half, uint32_t i) {
    RtVec3d corner = rt_on_circle(2 * i + 1, 2 * MASTS);
    return rt_vec3d(corner.x * 0.95 * half, corner.y * 0.9 * half, 0.62 * half);
}

static RtStatus add_mast(Stadium *s, uint32_t i, RtError *error) {
    double h = s->half;
    RtVec3d top = top_of_mast(h, i), foot = {top.x, top.y, 0};
    s->forms->material = STEEL;
    RT_TRY(rt_forms_cone(s->forms, foot, 0.016 * h, top, 0.008 * h, error));
    RtVec3d across = rt_normalized(rt_vec3d(-top.y, top.x, 0));
    for (int lamp = 0; lamp < LAMPS; lamp++) {
        s->forms->material = LAMP;
        int row = lamp / 4, column = lamp % 4;
        RtVec3d at = rt_add_scaledd(top, across, (column - 1.5) * 0.026 * h);
        at.z += (row + 0.5) * 0.026 * h;
        RT_TRY(rt_forms_sphere(s->forms, at, 0.011 * h, error));
    }
    return RT_OK;
}

/* On a round table at the kick-off spot. */
static RtStatus add_teapot(RtForms *forms, uint32_t n, RtError *error) {
    forms->material = CHINA;
    rt_forms_at(forms, rt_vec3d(0, 0, 3), 1);
    RT_TRY(rt_teapot(forms, n, error));
    rt_forms_at(forms, rt_vec3d(0, 0, 0), 0);
    forms->material = WOOD;
    const RtVec3d foot = {0, 0, 0}, knee = {0, 0, 0.6}, under = {0, 0, 2.7}, top = {0, 0, 3};
    RT_TRY(rt_forms_disc(forms, top, 5, SECTORS, error));
    RT_TRY(rt_forms_cone(forms, under, 5, top, 5, error));
    RT_TRY(rt_forms_disc(forms, under, 5, SECTORS, error));
    RT_TRY(rt_forms_cone(forms, foot, 2.6, knee, 0.7, error));
    RT_TRY(rt_forms_cone(forms, knee, 0.7, under, 0.7, error));
    forms->material = LINES;
    return rt_forms_disc(forms, rt_vec3d(0, 0, 0.004), 6, SECTORS, error);
}

static double half_length(const RtValue *values) {
    const double teapot_length = 6.433594;
    return values[RATIO].f * teapot_length / 2;
}

static RtStatus make(RtForms *forms, const RtValue *values, RtError *error) {
    Stadium s = {.forms = forms, .half = half_length(values)};
    RT_TRY(rt_forms_materials(forms, materials, MATERIALS, error));
    forms->polygons = true;
    RT_TRY(add_pitch(&s, error));
    RT_TRY(add_bowl(&s, error));
    for (uint32_t i = 0; i < MASTS; i++) RT_TRY(add_mast(&s, i, error));
    RT_TRY(add_teapot(forms, (uint32_t)values[SIZE].i, error));
    return RT_OK;
}

static uint64_t object_count(const RtValue *values) {
    return rt_forms_count(make, values);
}

static RtStatus generate(RtScene *scene, const RtValue *values, RtError *error) {
    double half = half_length(values);
    scene->camera.from = rt_vec3(-12, -5, 5.6f);
    scene->camera.at = rt_vec3(0, 0, 7);
    scene->camera.fov = 60;
    scene->background = rt_vec3(0.35f, 0.55f, 0.85f);
    RtVec3 sun = rt_narrow(rt_vec3d(-1.5 * half, -2.2 * half, 3 * half));
    RT_TRY(rt_scene_add_light(scene, sun, rt_vec3(0.75f, 0.72f, 0.66f), error));
    for (uint32_t i = 1; i < MASTS; i += 2) {
        RtVec3 lamps = rt_narrow(rt_addd(top_of_mast(half, i), rt_vec3d(0, 0, -0.01 * half)));
        RT_TRY(rt_scene_add_light(scene, lamps, rt_vec3(0.25f, 0.25f, 0.28f), error));
    }
    return rt_forms_make(scene, make, values, error);
}

const RtBuiltin rt_builtin_stadium = {
    .name = "stadium",
    .summary = "a teapot in a stadium: tiny triangles close together amid a few thousand huge polygons",
    .source = "after E. Haines 1988, Ray Tracing News: the classical case against a uniform grid",
    RT_PARAMS_OF(params),
    .object_count = object_count,
    .generate = generate,
};
